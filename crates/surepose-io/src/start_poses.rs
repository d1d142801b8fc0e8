//! Reads start poses of a sweep: CSV lines `x_m,y_m,heading_deg`, relative to the goal.
//!
//! The first line may hold these names; blank lines and lines that begin with `#` are ignored.

use std::path::Path;

use surepose::geometry::{Angle, Body, Goal, Pose};

use crate::error::{DataError, Problem};
use crate::lines::LineReader;
use crate::quantity::{ANGLE, POSITION};

const LAYOUT: &str = "x_m,y_m,heading_deg";

/// Reads a list of start poses, plain or compressed.
///
/// # Errors
/// A missing, unreadable or malformed file, with name and line, or an empty list.
pub fn read(path: &Path) -> Result<Vec<Pose<Goal, Body, f64>>, DataError> {
    parse(LineReader::open(path)?)
}

/// Parses the lines of a list of start poses.
///
/// # Errors
/// A malformed line, with its number, or an empty list.
pub fn parse(mut lines: LineReader<'_>) -> Result<Vec<Pose<Goal, Body, f64>>, DataError> {
    let mut starts = Vec::new();
    let mut header_allowed = true;
    while let Some(line) = lines.next_record()? {
        let columns = line.split_at_commas::<3>(LAYOUT)?;
        let is_header =
            LAYOUT.split(',').zip(&columns).all(|(name, column)| column.text() == name.as_bytes());
        if !(header_allowed && is_header) {
            let [x, y, heading] = columns;
            starts.push(Pose::new(
                x.read("x_m", &POSITION)?,
                y.read("y_m", &POSITION)?,
                Angle::from_radians(heading.read_in("heading_deg", &ANGLE, 1f64.to_radians())?),
            ));
        }
        header_allowed = false;
    }
    if starts.is_empty() {
        return Err(lines.error(Problem::Empty { what: "start poses" }));
    }
    Ok(starts)
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use surepose::geometry::{Body, Goal, Pose};

    use crate::lines::LineReader;

    use super::parse;

    fn list(text: &str) -> Result<Vec<Pose<Goal, Body, f64>>, String> {
        parse(LineReader::from_bytes(Path::new("starts.csv"), text.as_bytes()))
            .map_err(|error| error.to_string())
    }

    #[test]
    fn header_is_optional() {
        let with =
            list("x_m,y_m,heading_deg\n-1.5, 0.25 ,90\r\n\n# the second\n1e-3,0,-450\n").expect("right");
        assert_eq!(with, list("-1.5,0.25,90\n0.001,0,-450").expect("right"));
        assert_eq!((with[0].x, with[0].y), (-1.5, 0.25));
        assert!(
            with.iter()
                .zip([90.0, -90.0])
                .all(|(pose, degrees)| (pose.heading.degrees() - degrees).abs() < 1e-9)
        );
    }

    #[test]
    fn malformed_lists_are_rejected_with_the_line() {
        for (text, complaint) in [
            ("", "starts.csv: no start poses found"),
            ("x_m,y_m,heading_deg\n", "starts.csv: no start poses found"),
            ("1,2\n", "starts.csv:1: columns: wrong number (got 2, expected 3: x_m,y_m,heading_deg)"),
            ("1,2,3,4\n", "starts.csv:1: columns: wrong number (got 4, expected 3: x_m,y_m,heading_deg)"),
            ("1 2 3\n", "starts.csv:1: columns: wrong number"),
            ("1,2,3\nx_m,y_m,heading_deg\n", "starts.csv:2: column 1 (x_m): not a number (got 'x_m')"),
            ("1,nan,3\n", "starts.csv:1: column 2 (y_m): not finite (got 'nan')"),
            ("1,2,\n", "starts.csv:1: column 3 (heading_deg): not a number (got '')"),
            ("1e9,2,3\n", "starts.csv:1: column 1 (x_m): out of range (got '1e9',"),
            ("1,2,3\n\u{0}\u{1}\n", "starts.csv:2: columns: wrong number"),
        ] {
            let found = list(text).expect_err(text);
            assert!(found.starts_with(complaint), "{text:?}: {found}");
        }
    }
}
