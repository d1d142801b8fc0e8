//! Native module `surepose._surepose` of the Python package.
//!
//! Classes wrap types of the core one to one: SI units and radians. `call` runs a command of the program, in whose units the
//! result is. Arguments are checked here; the core then cannot fail.

mod belief;
mod checks;
mod command;
mod control;
mod filter;
mod navigator;
mod readings;
mod settings;
mod simulator;

use pyo3::prelude::*;

/// Native part of the package `surepose`.
#[pymodule]
fn _surepose(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<belief::PyBelief>()?;
    module.add_class::<control::PyController>()?;
    module.add_class::<control::PyControlStep>()?;
    module.add_class::<filter::PyEkf>()?;
    module.add_class::<navigator::PyNavigator>()?;
    module.add_class::<navigator::PyStepReport>()?;
    module.add_class::<readings::PyMeasurement>()?;
    module.add_class::<readings::PyScan>()?;
    module.add_class::<readings::PyYawRate>()?;
    module.add_class::<settings::PyConfig>()?;
    module.add_class::<simulator::PySensorFrame>()?;
    module.add_class::<simulator::PySimulator>()?;
    module.add("CommandError", module.py().get_type::<command::CommandError>())?;
    module.add_function(wrap_pyfunction!(command::call, module)?)?;
    module.add_function(wrap_pyfunction!(command::sweep_figures, module)?)?;
    module.add("__version__", env!("CARGO_PKG_VERSION"))
}
