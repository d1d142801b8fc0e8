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
fn both_lengths_of_line_give_682_ranges() {
    for ranges in [682, 683] {
        let recording = read(&line("2500000", "42", ["0", "19", "20"], ranges)).unwrap();
        assert_eq!(recording.odometry, [StampedTicks { time: 2.5, left: 42, right: -7 }]);
        let scan = &recording.scans[0];
        assert_eq!(scan.ranges.len(), 682);
        assert_eq!(scan.ranges[..4], [f64::INFINITY, f64::INFINITY, 0.020, 1.0]);
        assert!(scan.angle(340).abs() < 1e-12, "step 384 looks ahead");
        assert_eq!(scan.odometry_before, 1);
    }
}

#[test]
fn each_damage_names_line_and_remedy() {
    let good = ["1", "1", "1"];
    let message = |text: &str| read(text).unwrap_err().to_string();
    for ranges in [681, 684] {
        let found = format!("found {}", ranges + 24);
        let error = message(&line("1", "1", good, ranges));
        assert!(error.starts_with("log:1: expected 707 columns") && error.ends_with(&found), "{error}");
    }
    assert!(message("1 2 3\n").ends_with("found 3"));
    assert!(
        message(&line("1", "1.5", good, 682)).contains("column 3 (left ticks) is not a whole number: '1.5'")
    );
    assert!(message(&line("1", "3000000000", good, 682)).contains("column 3 (left ticks)"));
    assert!(message(&line("1", "1", ["1", "inf", "1"], 682)).contains("column 26 (range) is not finite"));
    assert!(message(&line("1", "1", ["-5", "1", "1"], 682)).contains("column 25 (range) is '-5', outside"));
    assert!(message(&line("1e30", "1", good, 682)).contains("column 1 (time) is '1e30', outside"));
    let back = line("2", "1", good, 682) + &line("1", "1", good, 682);
    assert!(message(&back).starts_with("log:2: time goes back"));
    assert!(message("").starts_with("log: holds no lines of ticks and ranges"));
}

proptest! {
    #[test]
    fn any_bytes_are_a_recording_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..512)) {
        let _ = parse(LineReader::from_bytes(Path::new("log"), &bytes));
    }
}
