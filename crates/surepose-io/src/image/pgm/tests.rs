use std::path::Path;

use proptest::prelude::*;

use super::super::Image;
use super::parse;

fn image(bytes: &[u8]) -> Result<Image, String> {
    parse(Path::new("map.pgm"), bytes).map_err(|error| error.to_string())
}

fn message(bytes: &[u8]) -> String {
    image(bytes).unwrap_err()
}

#[test]
fn binary_and_plain_give_the_same_image() {
    let expected =
        Image { width: 3, height: 2, white: 200, pixels: vec![0, 35, 200, 32, 10, 7], alpha: vec![] };
    assert_eq!(image(b"P5\n# made by hand\n3 2\n200\n\x00\x23\xc8\x20\x0a\x07").unwrap(), expected);
    assert_eq!(image(b"P2 #c\n3 2 200\n0 35 200 # row\n32\t10 7\n").unwrap(), expected);
}

#[test]
fn values_above_255_take_two_bytes() {
    let wide = image(b"P5 1 2 1000 \x03\xe8\x00\x01").unwrap();
    assert_eq!(wide.pixels, [1000, 1]);
}

#[test]
fn malformed_images_name_the_problem() {
    assert_eq!(message(b""), "map.pgm:1: record: unknown (got '', expected a PGM image: P5 or P2)");
    assert!(message(b"\x89PNG\r\n").contains("expected a PGM image"));
    assert!(message(b"P6\n1 1\n255\n\0\0\0").contains("record: unknown (got 'P6'"));
    assert_eq!(message(b"P5 3 2 255 \0\0\0"), "map.pgm: pixels: wrong count (got 3, expected 6 as declared)");
    assert_eq!(
        message(b"P2\n3 2\n255\n1 2\n3"),
        "map.pgm:5: pixels: wrong count (got 3, expected 6 as declared)"
    );
    assert_eq!(message(b"P2\n1 1\n255\nx"), "map.pgm:4: pixel: not a gray value (got 'x')");
    assert_eq!(
        message(b"P2\n1 1\n100\n101"),
        "map.pgm:4: pixel: above white (got 101, expected at most 100)"
    );
    assert_eq!(message(b"P5 1 1 100 \xff"), "map.pgm: pixel: above white (got 255, expected at most 100)");
    assert!(
        message(b"P5\n-1 1 255\n")
            .starts_with("map.pgm:2: width: invalid (got '-1', expected an integer up to")
    );
    assert!(message(b"P5\n99999 99999 255\n").starts_with("map.pgm:2: image: too large"));
    assert!(message(b"P5\n99999999999999999999 1 255\n").contains("width: invalid"));
    assert!(message(b"P5\n0 1 255\n").contains("image: empty (got 0 x 1 pixels)"));
    assert!(
        message(b"P5\n1 1 65536\n")
            .contains("white value: invalid (got '65536', expected an integer up to 65535)")
    );
    assert_eq!(message(b"P5\n1 1 255"), "map.pgm: pixels: wrong count (got 0, expected 1 as declared)");
}

proptest! {
    #[test]
    fn any_bytes_give_an_image_or_an_error(
        head in "(P[25])?[ \n#]{0,2}([0-9]{1,9}[ \n]){0,3}",
        bytes in prop::collection::vec(any::<u8>(), 0..64),
    ) {
        let _ = image(&[head.as_bytes(), &bytes].concat());
        let _ = image(&bytes);
    }
}
