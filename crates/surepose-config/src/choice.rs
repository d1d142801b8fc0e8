//! Choices of the configuration: the parameter of each enum of options.

use surepose::control::Direction;
use surepose::kinematics::Integration;
use surepose::lidar::StampedBeam;
use surepose::param::{self, ArenaName, BrakingMode, Choice, LawName, Parameter};

/// The options of one parameter.
pub trait ConfigChoice: Choice {
    /// The parameter, whose options have the names of this enum.
    const PARAMETER: &'static Parameter;
    /// The option unless the configuration sets another.
    const DEFAULT: Self = Self::ALL[0];
}

macro_rules! config_choices {
    ($($type:ty = $parameter:ident),+ $(,)?) => {
        $(
            impl ConfigChoice for $type {
                const PARAMETER: &'static Parameter = &param::$parameter;
            }
        )+

        /// The parameters above, with the names of their enums.
        #[cfg(test)]
        const PAIRS: &[(&Parameter, &[&str])] = &[$((&param::$parameter, <$type>::NAMES)),+];
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
