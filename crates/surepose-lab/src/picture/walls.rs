//! A wall map.

use surepose_data::wall_map::WallMap;
use surepose_plot::{Map, Picture};

/// The walls of a map.
pub fn wall_map(map: &WallMap) -> Picture {
    let title = map.name.clone().unwrap_or_else(|| format!("{} walls", map.walls.len()));
    Map::new(title).walls(map.walls.iter().map(|wall| [wall.from.into(), wall.to.into()])).picture()
}
