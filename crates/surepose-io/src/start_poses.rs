//! Start poses for a sweep: one per line, `x_m,y_m,heading_deg`, seen from the goal.
//!
//! A first line with these names may be there; empty lines and lines that begin with `#` are left out.

use std::path::Path;

use surepose::geometry::{Angle, Body, Goal, Pose};

use crate::error::{DataError, Problem};
use crate::lines::LineReader;
use crate::quantity::{ANGLE, POSITION};

const LAYOUT: &str = "x_m,y_m,heading_deg";

/// Reads a list of start poses, plain or gzip.
///
/// # Errors
/// A missing, unreadable or malformed file, by name and line; a list without a pose.
pub fn read(path: &Path) -> Result<Vec<Pose<Goal, Body, f64>>, DataError> {
    parse(LineReader::open(path)?)
}

/// Reads a list of start poses from its lines.
///
/// # Errors
/// A malformed line, by number; a list without a pose.
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
    fn poses_with_and_without_a_header() {
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
    fn what_is_no_list_is_refused_with_its_line() {
        for (text, complaint) in [
            ("", "starts.csv: holds no start poses"),
            ("x_m,y_m,heading_deg\n", "starts.csv: holds no start poses"),
            ("1,2\n", "starts.csv:1: expected 3 columns (x_m,y_m,heading_deg), found 2"),
            ("1,2,3,4\n", "starts.csv:1: expected 3 columns (x_m,y_m,heading_deg), found 4"),
            ("1 2 3\n", "starts.csv:1: expected 3 columns"),
            ("1,2,3\nx_m,y_m,heading_deg\n", "starts.csv:2: column 1 (x_m) is not a number: 'x_m'"),
            ("1,nan,3\n", "starts.csv:1: column 2 (y_m) is not finite: 'nan'"),
            ("1,2,\n", "starts.csv:1: column 3 (heading_deg) is not a number: ''"),
            ("1e9,2,3\n", "starts.csv:1: column 1 (x_m) is '1e9', outside"),
            ("1,2,3\n\u{0}\u{1}\n", "starts.csv:2: expected 3 columns"),
        ] {
            let found = list(text).expect_err(text);
            assert!(found.starts_with(complaint), "{text:?}: {found}");
        }
    }
}
