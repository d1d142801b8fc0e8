use std::path::Path;

use proptest::prelude::*;

use crate::error::DataError;
use crate::lines::LineReader;
use crate::recording::{Recording, StampedTicks};

use super::parse;

/// A line with `ranges` ranges, the first three of them `head`.
fn line(time: &str, left: &str, head: [&str; 3], ranges: usize) -> String {
    let others = ["0"; 20].join(" ");
    let rest = vec!["1000"; ranges - 3].join(" ");
    format!("{time} 14710 {left} -7 {others}  {} {rest}\n", head.join(" "))
}

fn read(text: &str) -> Result<Recording<StampedTicks>, DataError> {
    parse(LineReader::from_bytes(Path::new("log"), text.as_bytes()))
}

#[test]
fn both_line_lengths_give_682_ranges() {
    for ranges in [682, 683] {
        let recording = read(&line("2500000", "42", ["0", "19", "20"], ranges)).unwrap();
        assert_eq!(recording.odometry, [StampedTicks { time: 2.5, left: 42, right: -7 }]);
        let scan = &recording.scans[0];
        assert_eq!(scan.ranges.len(), 682);
        assert_eq!(scan.ranges[..4], [f64::INFINITY, f64::INFINITY, 0.020, 1.0]);
        assert!(scan.angle(340).abs() < 1e-12, "step 384 points forward");
        assert_eq!(scan.odometry_before, 1);
    }
}

#[test]
fn malformed_lines_name_line_and_problem() {
    let good = ["1", "1", "1"];
    let message = |text: &str| read(text).unwrap_err().to_string();
    for ranges in [681, 684] {
        let found = format!("log:1: columns: wrong number (got {}, expected 707", ranges + 24);
        let error = message(&line("1", "1", good, ranges));
        assert!(error.starts_with(&found), "{error}");
    }
    assert!(message("1 2 3\n").contains("(got 3, "));
    assert!(
        message(&line("1", "1.5", good, 682)).contains("column 3 (left ticks): not an integer (got '1.5')")
    );
    assert!(message(&line("1", "3000000000", good, 682)).contains("column 3 (left ticks)"));
    assert!(message(&line("1", "1", ["1", "inf", "1"], 682)).contains("column 26 (range): not finite"));
    assert!(
        message(&line("1", "1", ["-5", "1", "1"], 682))
            .contains("column 25 (range): out of range (got '-5',")
    );
    assert!(message(&line("1e30", "1", good, 682)).contains("column 1 (time): out of range (got '1e30',"));
    let back = line("2", "1", good, 682) + &line("1", "1", good, 682);
    assert!(message(&back).starts_with("log:2: time: decreases"));
    assert!(message("").starts_with("log: no lines of ticks and ranges found"));
}

proptest! {
    #[test]
    fn any_bytes_give_a_recording_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..512)) {
        let _ = parse(LineReader::from_bytes(Path::new("log"), &bytes));
    }
}
