//! Parses the scan lines of a CARMEN log: `FLASER`, `ROBOTLASER1` and `RAWLASER1`.

use std::ops::Range;

use surepose::geometry::{Angle, Body, Map, Pose};

use crate::error::{DataError, Problem};
use crate::half_circle;
use crate::lines::{Field, TextLine};
use crate::quantity::{ANGLE, POSITION};

/// Ranges that count as returns \[m\]. Without a return the laser reports 81.9 m; values from 50 m to that are beyond its
/// rated range.
const RETURNS: Range<f64> = f64::MIN_POSITIVE..50.0;

/// Number of columns of a `FLASER` line that are not ranges.
const FLASER_OTHERS: usize = 11;

/// Columns of a `RAWLASER1` or `ROBOTLASER1` line before the number of ranges: type, first angle, field of view,
/// resolution, maximum range, accuracy, remission mode.
const HEADER: usize = 7;

/// Fewest columns after the remissions: of `RAWLASER1` time, host and log time; of `ROBOTLASER1` two poses before them.
const RAW_REST: usize = 3;
const ROBOT_REST: usize = 9;

/// A pose of the log.
pub(super) type MapFromBody = Pose<Map, Body, f64>;

/// One parsed scan line.
pub(super) struct ScanLine<'l> {
    /// Ranges \[m\]; infinite without a return.
    pub(super) ranges: Vec<f64>,
    /// First angle and increment \[rad\].
    pub(super) angles: (f64, f64),
    /// Pose on the line; `None` for a `RAWLASER1` line.
    pub(super) pose: Option<MapFromBody>,
    /// Column of the stamp.
    pub(super) time: Field<'l>,
}

impl<'l> ScanLine<'l> {
    /// Parses the `values` after the name of a `FLASER` line.
    pub(super) fn from_flaser(line: TextLine<'l>, values: &[Field<'l>]) -> Result<Self, DataError> {
        let layout = "FLASER, number of ranges, ranges, x, y, heading, x, y, heading, time, host, log time";
        let too_few =
            |found: usize| line.error(Problem::Columns { expected: FLASER_OTHERS + 1, found, layout });
        let (count, values) = values.split_first().ok_or_else(|| too_few(1))?;
        let declared: u64 = count.whole("number of ranges")?;
        let found = (2 + values.len()).checked_sub(FLASER_OTHERS);
        let found = found.ok_or_else(|| too_few(2 + values.len()))?;
        check_count(line, "ranges", declared, found)?;
        let (ranges, rest) = values.split_at(found);
        let [x, y, heading, .., time, _host, _log_time] = rest else {
            return Err(too_few(2 + values.len()));
        };
        let ranges = returns(ranges, f64::INFINITY)?;
        let pose = Some(pose(x, y, heading)?);
        Ok(Self { ranges, angles: half_circle::beams(found), pose, time: *time })
    }

    /// Parses the `values` after the name of a `ROBOTLASER1` line, or of a `RAWLASER1` line, which has no pose.
    pub(super) fn from_laser1(
        line: TextLine<'l>,
        values: &[Field<'l>],
        has_pose: bool,
    ) -> Result<Self, DataError> {
        let layout = "type, first angle, field of view, resolution, maximum range, accuracy, remission mode, \
                      number of ranges, ranges, number of remissions, remissions, [poses,] time, host, log time";
        let rest_len = if has_pose { ROBOT_REST } else { RAW_REST };
        let expected = HEADER + 3 + rest_len;
        let too_few = || line.error(Problem::Columns { expected, found: 1 + values.len(), layout });
        let (header, values) = values.split_at_checked(HEADER).ok_or_else(too_few)?;
        let (ranges, values) = counted(line, "ranges", values, too_few)?;
        if ranges.is_empty() {
            return Err(line.error(Problem::Empty { what: "ranges" }));
        }
        let (_remissions, rest) = counted(line, "remissions", values, too_few)?;
        if rest.len() < rest_len {
            return Err(too_few());
        }
        let [_, first, field_of_view, resolution, farthest, ..] = header else { return Err(too_few()) };
        let first = first.read("first angle", &ANGLE)?;
        let field_of_view = field_of_view.read("field of view", &ANGLE)?;
        let resolution = resolution.read("resolution", &ANGLE)?;
        let farthest = farthest.finite("maximum range")?;
        let steps = ranges.len().saturating_sub(1).max(1) as f64;
        // Some loggers leave the angles unset.
        let angles = if resolution > 0.0 {
            (first, resolution)
        } else if field_of_view > 0.0 {
            (first, field_of_view / steps)
        } else {
            half_circle::beams(ranges.len())
        };
        let time = rest[rest.len() - 3];
        let pose = match rest {
            [x, y, heading, ..] if has_pose => Some(pose(x, y, heading)?),
            _ => None,
        };
        let ranges = returns(ranges, if farthest > 0.0 { farthest } else { f64::INFINITY })?;
        Ok(Self { ranges, angles, pose, time })
    }
}

/// Splits off as many columns as the first one declares.
fn counted<'v, 'l>(
    line: TextLine<'l>,
    what: &'static str,
    values: &'v [Field<'l>],
    too_few: impl Fn() -> DataError,
) -> Result<(&'v [Field<'l>], &'v [Field<'l>]), DataError> {
    let (count, values) = values.split_first().ok_or_else(too_few)?;
    let declared: u64 = count.whole(what)?;
    let split = usize::try_from(declared).ok().and_then(|count| values.split_at_checked(count));
    split.ok_or_else(|| line.error(Problem::Count { what, declared, found: values.len() as u64 }))
}

fn check_count(line: TextLine<'_>, what: &'static str, declared: u64, found: usize) -> Result<(), DataError> {
    if declared != found as u64 {
        return Err(line.error(Problem::Count { what, declared, found: found as u64 }));
    }
    if found == 0 { Err(line.error(Problem::Empty { what })) } else { Ok(()) }
}

/// Parses ranges; those from `farthest` \[m\] on are no returns.
fn returns(ranges: &[Field<'_>], farthest: f64) -> Result<Vec<f64>, DataError> {
    let within = RETURNS.start..RETURNS.end.min(farthest);
    ranges.iter().map(|range| range.laser_range(1.0, &within)).collect()
}

/// Parses a pose from its three columns.
pub(super) fn pose(x: &Field<'_>, y: &Field<'_>, heading: &Field<'_>) -> Result<MapFromBody, DataError> {
    let heading = Angle::from_radians(heading.read("heading", &ANGLE)?);
    Ok(Pose::new(x.read("x", &POSITION)?, y.read("y", &POSITION)?, heading))
}
