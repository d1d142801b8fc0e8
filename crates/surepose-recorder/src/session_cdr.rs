//! Sessions in CDR, as `surepose_msgs/msg/Session`.

use surepose::time::Stamp;
use surepose_config::{Config, NavigatorSetup, ScanMethod};
use surepose_io::wall_map::{MapWall, WallCovariance, WallMap};

use crate::cdr::{CdrReader, CdrWriter};
use crate::event::{belief_of, numbers_of};
use crate::session::{Session, text_of, with_text};

/// Most settings of a session; each is compared with all that are known.
const MAX_SETTINGS: usize = 4096;

/// Numbers of a wall: ends and covariance.
const WALL: usize = 7;

/// Encodes a session.
pub(crate) fn encoded(session: &Session) -> Vec<u8> {
    let mut cdr = CdrWriter::new();
    cdr.text(&session.version);
    let settings = session.config.settings();
    cdr.u32(settings.len() as u32);
    for setting in settings {
        cdr.text(&text_of(setting));
    }
    let setup = &session.setup;
    let number = |yes: bool| f64::from(u8::from(yes));
    cdr.array(&[
        number(setup.scan_method == ScanMethod::Beams),
        setup.map_std,
        number(setup.has_laser),
        number(setup.is_aided),
        setup.safety_radius.unwrap_or(f64::NAN),
        number(setup.hold_goal),
        number(session.map.is_some()),
    ]);
    let walls = session.map.iter().flat_map(|map| &map.walls);
    let walls = walls.flat_map(|wall| {
        let covariance = wall.covariance.map_or([0.0; 3], |c| [c.r_r, c.r_psi, c.psi_psi]);
        [&wall.from[..], &wall.to[..], &covariance[..]].concat()
    });
    cdr.sequence(&walls.collect::<Vec<_>>());
    cdr.i64(session.stamp.nanoseconds());
    cdr.array(&numbers_of(&session.belief));
    cdr.finished()
}

/// Decodes a session; `None` where the message is none.
pub(crate) fn decoded(message: &[u8]) -> Option<Session> {
    let mut cdr = CdrReader::new(message)?;
    let version = cdr.text()?;
    let settings = cdr.list(CdrReader::text)?;
    if settings.len() > MAX_SETTINGS {
        return None;
    }
    let config = settings.iter().fold(Config::default(), |config, text| with_text(config, text));
    let mut numbers = || cdr.f64();
    let scan_method = if numbers()? > 0.0 { ScanMethod::Beams } else { ScanMethod::Lines };
    let setup = NavigatorSetup {
        scan_method,
        map_std: numbers()?,
        has_laser: numbers()? > 0.0,
        is_aided: numbers()? > 0.0,
        safety_radius: numbers().map(|radius| (!radius.is_nan()).then_some(radius))?,
        hold_goal: numbers()? > 0.0,
    };
    let has_map = numbers()? > 0.0;
    let walls = cdr.sequence()?;
    let walls = walls.chunks_exact(WALL).filter_map(|wall| {
        let [ax, ay, bx, by, r_r, r_psi, psi_psi] = wall.try_into().ok()?;
        let covariance = Some(WallCovariance { r_r, r_psi, psi_psi });
        Some(MapWall { name: None, from: [ax, ay], to: [bx, by], covariance })
    });
    let map = has_map.then(|| WallMap { name: None, walls: walls.collect() });
    let stamp = Stamp::from_nanoseconds(cdr.i64()?);
    let mut belief = [0.0; 9];
    for number in &mut belief {
        *number = cdr.f64()?;
    }
    Some(Session { version, config, setup, map, stamp, belief: belief_of(belief) })
}
