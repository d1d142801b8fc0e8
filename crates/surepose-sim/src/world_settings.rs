//! Differences between a simulated world and the configuration of its robot.

use surepose::param::{Choice, Parameter};
use surepose::time::Stamp;
use surepose_config::{Config, ConfigError, ParameterSet, Setting, Value, option_setting};

use crate::fault::{Fault, FaultKind, ScanFault, Sensor};
use crate::gyroscope::GyroscopeModel;
use crate::laser::Clutter;
use crate::slip::Traction;
use crate::world_parameters::{
    self as table, CompassFault, HeldWheels, Installed, LaserFault, world_parameters,
};

/// The option of the command line that sets them.
const OPTION: &str = "--world";

/// Values of a world that differ from the configuration of its robot; by default none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WorldSettings {
    given: Vec<Setting>,
}

impl WorldSettings {
    /// Parses options of the form `SECTION.KEY=VALUE`, for [`world_parameters`].
    ///
    /// # Errors
    /// An unknown key, a key that describes no world, a value outside its range, two values for one key, or a value
    /// without effect.
    pub fn from_options<'a>(options: impl IntoIterator<Item = &'a str>) -> Result<Self, ConfigError> {
        Self::from_options_in(&world_parameters(), options)
    }

    /// Like [`WorldSettings::from_options`], for the parameters in `known`, a part of [`world_parameters`].
    ///
    /// # Errors
    /// As [`WorldSettings::from_options`].
    pub fn from_options_in<'a>(
        known: &ParameterSet,
        options: impl IntoIterator<Item = &'a str>,
    ) -> Result<Self, ConfigError> {
        let mut result = Self::default();
        for option in options {
            let name = option.split('=').next().unwrap_or_default().trim();
            if known.find_by_name(name).is_none() {
                reject_other_parameter(known, name)?;
            }
            result.add(option_setting(OPTION, option, known)?)?;
        }
        result.check()?;
        Ok(result)
    }

    /// Returns the settings, in the order of the options.
    pub fn settings(&self) -> &[Setting] {
        &self.given
    }

    /// Returns the true values: the configuration `told` to the robot, with these differences.
    #[must_use]
    pub fn over(&self, told: &Config) -> Config {
        self.given.iter().cloned().fold(told.clone(), Config::with_setting)
    }

    /// Returns whether a parameter is set.
    pub fn is_given(&self, parameter: &Parameter) -> bool {
        self.given.iter().any(|setting| setting.parameter == parameter)
    }

    /// Returns the number of a parameter that only a world has, in SI units and radians; 0 for a choice.
    pub fn number(&self, parameter: &Parameter) -> f64 {
        self.value(parameter).number_of(parameter)
    }

    /// Returns the option of a parameter that only a world has and whose options are those of `C`.
    pub fn choice<C: Choice>(&self, parameter: &Parameter) -> C {
        self.value(parameter).option()
    }

    /// Returns the grip of the wheels.
    pub(crate) fn traction(&self) -> Traction {
        let limit = &table::TRACTION_LIMIT;
        Traction {
            slip_ratio: self.number(&table::SLIP_RATIO),
            acceleration: if self.is_given(limit) { self.number(limit) } else { f64::INFINITY },
        }
    }

    /// Returns the obstacles that are on no map; `None` if they are not set.
    pub(crate) fn clutter(&self) -> Option<Clutter> {
        self.is_given(&table::CLUTTER).then(|| Clutter {
            fraction: self.number(&table::CLUTTER),
            width: self.number(&table::CLUTTER_WIDTH),
        })
    }

    /// Returns the gyroscope with the true noise; `None` if the robot has none.
    pub(crate) fn gyroscope(&self, truth: &Config) -> Option<GyroscopeModel> {
        let noise = truth.gyroscope();
        (self.choice::<Installed>(&table::GYROSCOPE) == Installed::Yes).then(|| GyroscopeModel {
            std: noise.std,
            bias: self.number(&table::GYROSCOPE_BIAS),
            bias_std: noise.bias_std,
            bias_walk: noise.bias_walk,
        })
    }

    /// Returns the faults.
    pub(crate) fn faults(&self) -> Vec<Fault> {
        let wheels = |right, left| Some(FaultKind::WheelsHeld { right, left });
        let held = match self.choice(&table::HELD_WHEELS) {
            HeldWheels::None => None,
            HeldWheels::Left => wheels(false, true),
            HeldWheels::Right => wheels(true, false),
            HeldWheels::Both => wheels(true, true),
        };
        let laser = match self.choice(&table::LASER_FAULT) {
            LaserFault::None => None,
            LaserFault::Infinite => Some(FaultKind::Scan(ScanFault::Infinite)),
            LaserFault::NotANumber => Some(FaultKind::Scan(ScanFault::NotANumber)),
            LaserFault::Zero => Some(FaultKind::Scan(ScanFault::Zero)),
            LaserFault::Negative => Some(FaultKind::Scan(ScanFault::Negative)),
            LaserFault::Empty => Some(FaultKind::Scan(ScanFault::Empty)),
            LaserFault::Frozen => Some(FaultKind::Scan(ScanFault::Frozen)),
            LaserFault::Silent => Some(FaultKind::Dropout(Sensor::Laser)),
        };
        let compass = match self.choice(&table::COMPASS_FAULT) {
            CompassFault::None => None,
            CompassFault::NotANumber => Some(FaultKind::NotANumber(Sensor::Compass)),
            CompassFault::Silent => Some(FaultKind::Dropout(Sensor::Compass)),
        };
        [
            (held, &table::HELD_FROM, None),
            (laser, &table::LASER_FAULT_FROM, Some(&table::LASER_FAULT_DURATION)),
            (compass, &table::COMPASS_FAULT_FROM, Some(&table::COMPASS_FAULT_DURATION)),
        ]
        .into_iter()
        .filter_map(|(kind, from, duration)| Some(self.fault(kind?, from, duration)))
        .collect()
    }

    /// Creates a fault that begins at `from`; without a given `duration` it lasts to the end.
    fn fault(&self, kind: FaultKind, from: &Parameter, duration: Option<&Parameter>) -> Fault {
        let mut fault = Fault::from(self.number(from), kind);
        if let Some(duration) = duration.filter(|duration| self.is_given(duration)) {
            fault.during.end = Stamp::from_seconds(self.number(from)).after(self.number(duration));
        }
        fault
    }

    fn value(&self, parameter: &Parameter) -> Value {
        let given = self.given.iter().find(|setting| setting.parameter == parameter);
        given.map_or_else(|| Value::default_of(parameter), |setting| setting.value.clone())
    }

    fn add(&mut self, setting: Setting) -> Result<(), ConfigError> {
        let earlier = self.given.iter().find(|given| given.parameter == setting.parameter);
        match earlier {
            None => self.given.push(setting),
            Some(earlier) if earlier.value == setting.value => {}
            Some(earlier) => {
                let what = format!(
                    "`{}`: two values (got {} and {})",
                    name(earlier.parameter),
                    earlier.value,
                    setting.value
                );
                return Err(ConfigError::of_option(OPTION, what, "leave out one of the two options"));
            }
        }
        Ok(())
    }

    /// Rejects values without effect.
    fn check(&self) -> Result<(), ConfigError> {
        for (parameter, switch) in table::DEPENDENT {
            let switched = self.value(switch);
            if self.is_given(parameter) && switched == Value::default_of(switch) {
                let what = format!(
                    "`{}`: without effect, because `{}` is {switched}",
                    name(parameter),
                    name(switch)
                );
                let help = format!("add `{OPTION} {}=…`, or leave this option out", name(switch));
                return Err(ConfigError::of_option(OPTION, what, &help));
            }
        }
        Ok(())
    }
}

/// Rejects the name of a parameter that is not in `known`, but of the robot or of a whole world.
fn reject_other_parameter(known: &ParameterSet, name: &str) -> Result<(), ConfigError> {
    let robot = ParameterSet::robot().find_by_name(name);
    let Some(found) = robot.or_else(|| world_parameters().find_by_name(name)) else { return Ok(()) };
    let what = format!("`{}.{}`: not a property of the simulated world", found.section, found.key);
    let listing = format!("`{}` lists these properties", known.listing());
    let help = match robot {
        Some(_) => format!("use `--set {}.{}=…` for the robot; {listing}", found.section, found.key),
        None => listing,
    };
    Err(ConfigError::of_option(OPTION, what, &help))
}

fn name(parameter: &Parameter) -> String {
    format!("{}.{}", parameter.section, parameter.key)
}

#[cfg(test)]
mod tests;
