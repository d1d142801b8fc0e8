//! The navigator that is recorded: program version, configuration, setup, map and initial belief.

use surepose::estimation::Belief;
use surepose::time::Stamp;
use surepose_config::{
    Config, NavigatorSetup, ParameterSet, RobotNavigator, Setting, ValueSource, option_setting,
};
use surepose_io::owned_map::OwnedMap;
use surepose_io::wall_map::WallMap;

/// Version of this program.
pub(crate) const VERSION: &str = env!("CARGO_PKG_VERSION");

/// All that a navigator is built from.
#[derive(Clone, Debug, PartialEq)]
pub struct Session {
    /// Version of the program that recorded.
    pub version: String,
    /// Configuration.
    pub config: Config,
    /// Setup of the navigator.
    pub setup: NavigatorSetup,
    /// Map of the robot; `None` without one.
    pub map: Option<WallMap>,
    /// Stamp that the navigator starts at.
    pub stamp: Stamp,
    /// Belief that it starts with.
    pub belief: Belief<f64>,
}

impl Session {
    /// Session of this program.
    pub fn new(
        config: Config,
        setup: NavigatorSetup,
        map: Option<WallMap>,
        stamp: Stamp,
        belief: Belief<f64>,
    ) -> Self {
        Self { version: VERSION.to_owned(), config, setup, map, stamp, belief }
    }

    /// Builds the navigator and its map.
    pub fn navigator(&self) -> (Box<RobotNavigator>, OwnedMap) {
        let no_map = || OwnedMap::from_walls(Vec::new());
        let map = self.map.as_ref().map_or_else(no_map, OwnedMap::from_wall_map);
        (self.config.navigator(&self.setup, self.stamp, self.belief), map)
    }
}

/// Text of a setting, with its source: `law.k_v=3 # command line`.
pub(crate) fn text_of(setting: &Setting) -> String {
    let (section, key) = (setting.parameter.section, setting.parameter.key);
    let source = match setting.origin {
        ValueSource::Default => "default",
        ValueSource::Preset(_) => "preset",
        ValueSource::File { .. } => "file",
        ValueSource::CommandLine => "command line",
    };
    format!("{section}.{key}={} # {source}", setting.value)
}

/// The configuration with the setting of [`text_of`]; as it was, where this program does not know the setting.
pub(crate) fn with_text(config: Config, text: &str) -> Config {
    let Some((assignment, source)) = text.rsplit_once(" # ") else { return config };
    // A default that is the same needs no parsing: some defaults lie outside the bounds of a given value.
    let known = config.settings().iter().map(text_of).any(|known| known == text);
    let setting = option_setting("recording", assignment, &ParameterSet::robot());
    match setting {
        Ok(setting) if !known => {
            let origin = match source {
                "default" => ValueSource::Default,
                "preset" => ValueSource::Preset("recording"),
                _ => ValueSource::CommandLine,
            };
            config.with_setting(Setting { origin, ..setting })
        }
        _ => config,
    }
}

/// Parts of two sessions that differ: name, value in the first and value in the second.
pub(crate) fn differences(first: &Session, second: &Session) -> Vec<(String, String, String)> {
    let walls = |session: &Session| session.map.as_ref().map_or(0, |map| map.walls.len());
    let start = |session: &Session| {
        let (at, stamp) = (session.belief.pose, session.stamp.seconds());
        format!("{} m, {} m, {} rad at {stamp} s", at.x, at.y, at.heading.radians())
    };
    let others = [
        ("setup", first.setup == second.setup, [first, second].map(|s| format!("{:?}", s.setup))),
        ("map", first.map == second.map, [first, second].map(|s| format!("{} walls", walls(s)))),
        ("start", first.belief == second.belief && first.stamp == second.stamp, [first, second].map(start)),
    ];
    let others = others.into_iter().filter(|(_, is_same, _)| !is_same);
    let others = others.map(|(name, _, [a, b])| (name.to_owned(), a, b));
    settings_of_both(&first.config, &second.config).chain(others).collect()
}

fn settings_of_both(first: &Config, second: &Config) -> impl Iterator<Item = (String, String, String)> {
    let pairs = first.settings().iter().zip(second.settings());
    pairs.filter(|(a, b)| a.value != b.value).map(|(a, b)| {
        (format!("{}.{}", a.parameter.section, a.parameter.key), a.value.to_string(), b.value.to_string())
    })
}
