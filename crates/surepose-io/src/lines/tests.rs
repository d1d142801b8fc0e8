use std::io::Write;
use std::path::Path;

use flate2::{Compression, write::GzEncoder};
use proptest::prelude::*;

use crate::error::{DataError, Problem};
use crate::quantity::{RANGE, TIME};

use super::{Clock, LineReader, MAX_LINE_BYTES};

fn lines(text: &[u8]) -> LineReader<'_> {
    LineReader::from_bytes(Path::new("log"), text)
}

fn gzip(text: &[u8]) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(text).unwrap();
    encoder.finish().unwrap()
}

fn all(text: &[u8]) -> Result<Vec<(u64, Vec<u8>)>, DataError> {
    let (mut lines, mut found) = (lines(text), Vec::new());
    while let Some(line) = lines.next_record()? {
        found.push((line.number, line.text.to_vec()));
    }
    Ok(found)
}

fn first_column(text: &[u8]) -> Result<f64, DataError> {
    let mut lines = lines(text);
    let line = lines.next_record()?.unwrap();
    line.columns().next().unwrap().read("range", &RANGE)
}

#[test]
fn plain_and_gzip_give_the_same_lines() {
    let text = b"# head\r\n\r\n 1 \t2 \r\n#tail\n3";
    let expected = vec![(3, b"1 \t2".to_vec()), (5, b"3".to_vec())];
    assert_eq!(all(text).unwrap(), expected);
    assert_eq!(all(&gzip(text)).unwrap(), expected);
}

/// Spreadsheets write a byte-order mark; inside a text it is invalid.
#[test]
fn byte_order_mark_at_the_start_is_removed() {
    let marked = "\u{feff}# head\n1\n\u{feff}2".as_bytes();
    let expected = vec![(2, b"1".to_vec()), (3, "\u{feff}2".as_bytes().to_vec())];
    assert_eq!(all(marked).unwrap(), expected);
    assert_eq!(all(&gzip(marked)).unwrap(), expected);
    assert!(all("\u{feff}".as_bytes()).unwrap().is_empty());
}

#[test]
fn concatenated_gzip_members_are_one_text() {
    let members = [gzip(b"1\n"), gzip(b"2\n")].concat();
    assert_eq!(all(&members).unwrap().len(), 2);
}

#[test]
fn truncated_gzip_is_an_error() {
    let whole = gzip(b"1 2 3\n4 5 6\n7 8 9\n");
    for length in 2..whole.len() {
        let error = all(&whole[..length]).unwrap_err();
        assert!(matches!(error.problem, Problem::Compression(_)), "{length}: {error}");
        assert!(error.line.is_some());
    }
}

#[test]
fn flipped_bit_in_gzip_is_an_error() {
    let mut damaged = gzip(b"1 2 3\n4 5 6\n7 8 9\n");
    let checksum = damaged.len() - 8;
    damaged[checksum] ^= 1;
    assert!(matches!(all(&damaged).unwrap_err().problem, Problem::Compression(_)));
}

#[test]
fn gzip_bomb_stops_at_the_line_limit() {
    let bomb = gzip(&vec![b'1'; 2 * MAX_LINE_BYTES]);
    let error = all(&bomb).unwrap_err();
    assert!(matches!(error.problem, Problem::LineTooLong { .. }), "{error}");
}

#[test]
fn too_long_text_is_an_error() {
    let mut lines = lines(b"1\n2\n3\n");
    lines.bytes_left = 4;
    assert!(lines.next_line().unwrap().is_some());
    assert!(lines.next_line().unwrap().is_some());
    let error = lines.next_line().unwrap_err();
    assert!(matches!(error.problem, Problem::TooLarge { .. }), "{error}");
    assert_eq!(error.line, Some(3));
}

#[test]
fn missing_file_is_an_error_with_its_name() {
    let error = LineReader::open(Path::new("no such file")).err().unwrap();
    assert!(matches!(error.problem, Problem::Unreadable(_)));
    assert!(error.to_string().starts_with("no such file: cannot be read"), "{error}");
}

#[test]
fn directory_is_an_error() {
    let error = LineReader::open(Path::new(env!("CARGO_MANIFEST_DIR"))).err().unwrap();
    assert!(matches!(error.problem, Problem::Unreadable(_)), "{error}");
}

#[test]
fn wrong_number_of_columns_is_reported() {
    let mut lines = lines(b"\n1 2 3\n");
    let line = lines.next_record().unwrap().unwrap();
    let error = line.split::<4>("time, x, y, heading").unwrap_err();
    assert_eq!(error.to_string(), "log:2: columns: wrong number (got 3, expected 4: time, x, y, heading)");
    let error = line.split::<2>("time, x").unwrap_err();
    assert_eq!(error.to_string(), "log:2: columns: wrong number (got 3, expected 2: time, x)");
}

#[test]
fn numbers_are_finite_and_within_bounds() {
    for text in ["nan", "NaN", "inf", "-inf", "1e400", "-infinity"] {
        let error = first_column(text.as_bytes()).unwrap_err();
        let expected = format!("log:1: column 1 (range): not finite (got '{text}')");
        assert!(error.to_string().starts_with(&expected), "{error}");
    }
    for text in ["", "abc", "1,5", "0x10", "--1", "1e", "\u{fffd}"] {
        let error = first_column(format!("{text}; 1").as_bytes()).unwrap_err();
        assert!(matches!(error.problem, Problem::NotANumber { .. }), "{error}");
    }
    for text in ["-1e-9", "1e300", "1e6"] {
        let error = first_column(text.as_bytes()).unwrap_err();
        assert!(matches!(error.problem, Problem::OutOfBounds { .. }), "{error}");
    }
    assert!((first_column(b"+1.25e1").unwrap() - 12.5).abs() < 1e-15);
}

#[test]
fn stamps_may_repeat_but_not_decrease() {
    let mut clock = Clock::default();
    let mut lines = lines(b"1.5\n1.5\n1.25\n");
    let mut next = || clock.stamp(lines.next_record().unwrap().unwrap().columns().next().unwrap(), 1.0);
    assert!(next().is_ok());
    assert!(next().is_ok());
    let error = next().unwrap_err();
    assert_eq!(error.to_string(), "log:3: time: decreases (got 1.25 s after 1.5 s); sort the file by time");
}

#[test]
fn stamp_in_a_wrong_unit_is_rejected() {
    assert!(TIME.admits(1.25e9));
    assert!(!TIME.admits(1.25e12));
    assert!(!TIME.admits(-1.0));
    assert!(!TIME.admits(f64::NAN));
}

proptest! {
    #[test]
    fn any_bytes_give_lines_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..512)) {
        let _ = all(&bytes);
        let _ = all(&[&[0x1f, 0x8b], bytes.as_slice()].concat());
    }

    #[test]
    fn printed_numbers_round_trip(value in 0.0..1e5_f64) {
        let read = first_column(value.to_string().as_bytes()).unwrap();
        prop_assert_eq!(read.to_bits(), value.to_bits());
    }
}
