//! Choices of the configuration: the parameter of each enum of options.

use surepose::control::Direction;
use surepose::kinematics::Integration;
use surepose::lidar::StampedBeam;
use surepose::param::{self, ArenaName, BrakingMode, Choice, LawName, MountingSource, Parameter};

use super::Config;

/// The options of one parameter.
pub trait ConfigChoice: Choice {
    /// The parameter, whose options have the names of this enum.
    const PARAMETER: &'static Parameter;
}

macro_rules! config_choices {
    ($($type:ty = $parameter:ident),+ $(,)?) => {
        $(
            impl ConfigChoice for $type {
                const PARAMETER: &'static Parameter = &param::$parameter;
            }
        )+

        /// The parameters above and the mountings, with the names of their enums.
        #[cfg(test)]
        const PAIRS: &[(&Parameter, &[&str])] = &[
            (&param::LASER_MOUNTING, MountingSource::NAMES),
            (&param::COMPASS_MOUNTING, MountingSource::NAMES),
            $((&param::$parameter, <$type>::NAMES)),+
        ];
    };
}

config_choices! {
    LawName = LAW_NAME,
    BrakingMode = BRAKING,
    Direction = DIRECTION,
    Integration = INTEGRATION,
    StampedBeam = LASER_STAMP,
    ArenaName = ARENA,
}

impl Config {
    /// Returns the option in effect.
    pub fn choice<C: ConfigChoice>(&self) -> C {
        self.value(C::PARAMETER).option()
    }

    /// Returns the source of the pose of the laser.
    pub fn laser_mounting(&self) -> MountingSource {
        self.value(&param::LASER_MOUNTING).option()
    }

    /// Returns the source of the rotation of the compass.
    pub fn compass_mounting(&self) -> MountingSource {
        self.value(&param::COMPASS_MOUNTING).option()
    }
}

#[cfg(test)]
mod tests {
    use surepose::param::Kind;

    use super::{PAIRS, param};

    /// Every choice of the table has an enum, and its options are the names of this enum.
    #[test]
    fn every_choice_has_its_enum() {
        for parameter in param::ALL {
            if let Kind::Choice { options } = parameter.kind {
                let found = PAIRS.iter().find(|(of, _)| *of == parameter);
                assert_eq!(found.map(|(_, names)| *names), Some(options), "{}", parameter.key);
            }
        }
    }
}
