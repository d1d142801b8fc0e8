//! Parameters with named options: each is an enum whose options and names stand in one list.

/// An enum whose variants are the options of a parameter.
///
/// Code that handles a parameter matches on its enum without a wildcard, so that a new option without handling does not
/// compile.
pub trait Choice: Copy + PartialEq + 'static {
    /// The options. The first is the default.
    const ALL: &'static [Self];
    /// The names of the options, in the order of [`Choice::ALL`].
    const NAMES: &'static [&'static str];

    /// Returns the name in configurations, messages and JSON.
    fn name(self) -> &'static str;

    /// Finds an option by its name; `None` for another text.
    fn from_name(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|option| option.name() == name)
    }
}

/// Implements [`Choice`] for an enum. A variant without a name, or a name without a variant, does not compile.
#[macro_export]
macro_rules! impl_choice {
    ($type:ty { $($variant:ident = $name:literal),+ $(,)? }) => {
        impl $crate::param::Choice for $type {
            const ALL: &'static [Self] = &[$(Self::$variant),+];
            const NAMES: &'static [&'static str] = &[$($name),+];

            fn name(self) -> &'static str {
                match self {
                    $(Self::$variant => $name),+
                }
            }
        }
    };
}
pub(crate) use impl_choice;

/// Control law of the configuration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LawName {
    /// The hybrid law of this library.
    Surepose,
    /// The law of [Tran2012].
    Paper,
}

impl_choice!(LawName { Surepose = "surepose", Paper = "paper" });

/// Braking before the goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BrakingMode {
    /// `Even` with fitted gains, `Gains` with gains that are set and with the law of the paper.
    Auto,
    /// Deceleration within the wheel acceleration limit.
    Even,
    /// Unmodified gains: deceleration grows with speed.
    Gains,
}

impl_choice!(BrakingMode { Auto = "auto", Even = "even", Gains = "gains" });

/// Source of the mounting of a sensor of a ROS 2 robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MountingSource {
    /// The configuration where it differs from the default, else `/tf_static`.
    Auto,
    /// The configuration.
    Config,
    /// The topic `/tf_static`.
    TfStatic,
}

impl_choice!(MountingSource { Auto = "auto", Config = "config", TfStatic = "tf_static" });

/// Environment of the simulation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArenaName {
    /// The arena of [Tran2012], Sec. 5.2.
    Paper,
    /// The arena of [Tran2012] without its plates.
    Open,
    /// The reference environment for localization.
    Loop,
}

impl_choice!(ArenaName { Paper = "paper", Open = "open", Loop = "loop" });

#[cfg(test)]
mod tests {
    use super::{BrakingMode, Choice};

    #[test]
    fn options_are_found_by_their_names() {
        for (option, name) in BrakingMode::ALL.iter().zip(BrakingMode::NAMES) {
            assert_eq!((option.name(), BrakingMode::from_name(name)), (*name, Some(*option)));
        }
        assert_eq!(BrakingMode::from_name("evenly"), None);
    }
}
