use std::path::Path;

use proptest::prelude::*;

use crate::error::{DataError, Problem};
use crate::lines::LineReader;

use super::{Files, RobotLog, Target, parse, read, robots};

/// The texts of a small data set; each test damages one of them.
#[derive(Clone)]
struct Texts<'a> {
    barcodes: &'a [u8],
    landmarks: &'a [u8],
    odometry: &'a [u8],
    sightings: &'a [u8],
    reference: &'a [u8],
}

const GOOD: Texts<'static> = Texts {
    barcodes: b"# Subject #    Barcode #\r\n  1 \t   5 \r\n  6 \t  63 \r\n",
    landmarks: b"# x y\r\n  6 \t 0.5 \t -4.25 \t 0.0001 \t 0.0006 \r\n",
    odometry: b"# head\r\n10.5 \t 0.086 \t -0.398 \r\n10.6 \t 0.085 \t -0.4\r\n",
    sightings:
        b"# head\r\n10.5 \t 63 \t 1.682 \t 0.032\r\n10.5 \t 5 \t 2 \t -0.1\r\n10.7 \t 99 \t 3 \t 0\r\n",
    reference: b"# head\r\n10.4 \t 2.5 \t 4.25 \t -1.75\r\n",
};

impl<'a> Texts<'a> {
    fn parse(&self) -> Result<RobotLog, DataError> {
        let lines = |name: &str, text: &'a [u8]| LineReader::from_bytes(Path::new(name), text);
        parse(Files {
            barcodes: lines("barcodes", self.barcodes),
            landmarks: lines("landmarks", self.landmarks),
            odometry: lines("odometry", self.odometry),
            sightings: lines("sightings", self.sightings),
            reference: Some(lines("reference", self.reference)),
        })
    }

    fn message(&self) -> String {
        self.parse().unwrap_err().to_string()
    }
}

#[test]
fn small_data_set_is_parsed() {
    let log = GOOD.parse().unwrap();
    assert_eq!((log.odometry.len(), log.sightings.len(), log.reference.len()), (2, 3, 1));
    assert_eq!(log.odometry[1].turn_rate.to_bits(), (-0.4_f64).to_bits());
    assert_eq!(log.reference[0].heading.to_bits(), (-1.75_f64).to_bits());
    let targets: Vec<_> = log.sightings.iter().map(|sighting| sighting.target).collect();
    assert_eq!(targets, [Target::Landmark(6), Target::Robot(1), Target::Unknown { barcode: 99 }]);
    assert_eq!(log.landmark(6).unwrap().y.to_bits(), (-4.25_f64).to_bits());
    assert!(log.landmark(1).is_none());
}

#[test]
fn malformed_files_name_file_line_and_problem() {
    let odometry = Texts { odometry: b"# head\n1 2 3\n1 nan 3\n", ..GOOD };
    assert_eq!(
        odometry.message(),
        "odometry:3: column 2 (forward speed): not finite (got 'nan'); remove the line or correct the value"
    );
    let sightings = Texts { sightings: b"1 63 2\n", ..GOOD };
    assert_eq!(
        sightings.message(),
        "sightings:1: columns: wrong number (got 3, expected 4: time, barcode, range, bearing)"
    );
    let sightings = Texts { sightings: b"1 6.5 2 0\n", ..GOOD };
    assert_eq!(sightings.message(), "sightings:1: column 2 (barcode): not an integer (got '6.5')");
    let reference = Texts { reference: b"2 0 0 0\n1 0 0 0\n", ..GOOD };
    assert_eq!(
        reference.message(),
        "reference:2: time: decreases (got 1 s after 2 s); sort the file by time"
    );
    let reference = Texts { reference: b"# only a head\n", ..GOOD };
    assert_eq!(reference.message(), "reference: no reference poses found; check that this is the right file");
    let landmarks = Texts { landmarks: b"6 1 1 -1 0\n", ..GOOD };
    assert!(
        landmarks
            .message()
            .starts_with("landmarks:1: column 4 (x std): out of range (got '-1', expected 0e0 to 1e5 m)")
    );
    let barcodes = Texts { barcodes: b"1 5\n2 5\n", ..GOOD };
    assert_eq!(barcodes.message(), "barcodes:2: barcode 5: duplicate; keep one of the two lines");
    let landmarks = Texts { landmarks: b"6 1 1 0 0\n6 1 1 0 0\n", ..GOOD };
    assert_eq!(landmarks.message(), "landmarks:2: landmark 6: duplicate; keep one of the two lines");
}

#[test]
fn directory_without_robots_is_an_error() {
    let error = robots(Path::new(env!("CARGO_MANIFEST_DIR"))).unwrap_err();
    assert!(matches!(error.problem, Problem::Empty { .. }), "{error}");
    let error = read(Path::new("no such folder"), 1).unwrap_err();
    assert!(matches!(error.problem, Problem::Unreadable(_)), "{error}");
}

proptest! {
    #[test]
    fn any_bytes_give_a_log_or_an_error(bytes in prop::collection::vec(any::<u8>(), 0..256)) {
        let _ = Texts { barcodes: &bytes, ..GOOD }.parse();
        let _ = Texts { landmarks: &bytes, ..GOOD }.parse();
        let _ = Texts { odometry: &bytes, ..GOOD }.parse();
        let _ = Texts { sightings: &bytes, ..GOOD }.parse();
        let _ = Texts { reference: &bytes, ..GOOD }.parse();
    }

    #[test]
    fn any_lines_give_a_log_or_an_error(
        text in "([0-9.eE+-]{1,6}|nan|inf|1e400|#)( ([0-9.eE+-]{1,6}|nan|inf)){0,4}(\r?\n[0-9]{1,3}( [0-9.]{1,4}){3})?"
    ) {
        let bytes = text.as_bytes();
        let _ = Texts { odometry: bytes, ..GOOD }.parse();
        let _ = Texts { sightings: bytes, ..GOOD }.parse();
        let _ = Texts { reference: bytes, ..GOOD }.parse();
    }
}
