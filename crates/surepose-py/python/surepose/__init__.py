"""Pose stabilization and localization of differential-drive robots.

Two groups of functions:

- Classes of the core, in SI units and radians: :class:`Navigator`, :class:`Ekf`, :class:`Controller`, :class:`Simulator`.
- Commands of the program ``surepose``, with its options, units and numbers: :func:`simulate`, :func:`sweep`, :func:`certify`,
  :func:`tune`, :func:`replay`, :func:`calibrate`, :func:`map_from_grid`, :func:`map_from_log`.

>>> import surepose
>>> surepose.simulate(goal=(2, 2, 90), seed=7).outcome
'reached'
"""

from ._surepose import (
    Belief,
    CommandError,
    Config,
    Controller,
    ControlStep,
    Ekf,
    Measurement,
    Navigator,
    Scan,
    SensorFrame,
    Simulator,
    StepReport,
    YawRate,
    __version__,
)
from .commands import calibrate, certify, map_from_grid, map_from_log, replay, simulate, sweep, tune
from .result import Result

__all__ = [
    "Belief",
    "CommandError",
    "Config",
    "ControlStep",
    "Controller",
    "Ekf",
    "Measurement",
    "Navigator",
    "Result",
    "Scan",
    "SensorFrame",
    "Simulator",
    "StepReport",
    "YawRate",
    "__version__",
    "calibrate",
    "certify",
    "map_from_grid",
    "map_from_log",
    "replay",
    "simulate",
    "sweep",
    "tune",
]
