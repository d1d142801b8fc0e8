use std::path::Path;

use proptest::prelude::*;

use super::{Image, parse};

/// Gray values of a test image of 5 by 2 pixels.
const GRAY: [u8; 10] = [0, 51, 100, 205, 254, 255, 255, 0, 0, 205];

fn image(bytes: &[u8]) -> Result<Image, String> {
    parse(Path::new("map.img"), bytes).map_err(|error| error.to_string())
}

/// Brightness of the pixels, 0 to 255.
fn brightness(image: &Image) -> Vec<u8> {
    image.pixels.iter().map(|&pixel| (u32::from(pixel) * 255 / u32::from(image.white)) as u8).collect()
}

fn png(color: png::ColorType, depth: png::BitDepth, data: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, 5, 2);
    encoder.set_color(color);
    encoder.set_depth(depth);
    encoder.write_header().unwrap().write_image_data(data).unwrap();
    bytes
}

/// A bitmap of 5 by 2 pixels from its rows, which are padded to four bytes.
fn bmp(bits: u32, height: i32, palette: &[u8], rows: [&[u8]; 2]) -> Vec<u8> {
    let start = 54 + palette.len() as u32;
    let mut bytes = b"BM".to_vec();
    for long in [0, 0, start, 40, 5, height.cast_unsigned(), bits << 16 | 1, 0, 0, 0, 0, 0, 0] {
        bytes.extend(long.to_le_bytes());
    }
    bytes.extend(palette);
    for row in rows {
        bytes.extend(row);
        bytes.extend(vec![0; row.len().next_multiple_of(4) - row.len()]);
    }
    bytes
}

#[test]
fn formats_give_the_same_image() {
    let (gray, rgb) = (png::ColorType::Grayscale, png::ColorType::Rgb);
    let colors: Vec<u8> = GRAY.iter().flat_map(|&gray| [gray; 3]).collect();
    let wide: Vec<u8> = GRAY.iter().flat_map(|&gray| [gray; 2]).collect();
    let levels: Vec<u8> = (0..=255).flat_map(|level| [level, level, level, 0]).collect();
    for (kind, bytes) in [
        ("gray PNG", png(gray, png::BitDepth::Eight, &GRAY)),
        ("16-bit PNG", png(gray, png::BitDepth::Sixteen, &wide)),
        ("color PNG", png(rgb, png::BitDepth::Eight, &colors)),
        ("PGM", [b"P5 5 2 255\n".as_slice(), &GRAY].concat()),
        ("BMP", bmp(24, 2, &[], [&colors[15..], &colors[..15]])),
        ("BMP from the top", bmp(24, -2, &[], [&colors[..15], &colors[15..]])),
        ("BMP with a palette", bmp(8, 2, &levels, [&GRAY[5..], &GRAY[..5]])),
    ] {
        let image = image(&bytes).unwrap();
        assert_eq!((image.width, image.height, image.alpha.len()), (5, 2, 0), "{kind}");
        assert_eq!(brightness(&image), GRAY, "{kind}");
    }
}

#[test]
fn small_palettes_are_unpacked() {
    let palette = [0, 0, 0, 0, 255, 255, 255, 0];
    let one_bit = bmp(1, 2, &palette, [&[0b0101_0000], &[0b1000_1000]]);
    assert_eq!(brightness(&image(&one_bit).unwrap()), [255, 0, 0, 0, 255, 0, 255, 0, 255, 0]);
    let four_bits = bmp(4, 2, &palette, [&[0x10, 0x10, 0x10], &[0x00, 0x01, 0x00]]);
    assert_eq!(brightness(&image(&four_bits).unwrap()), [0, 0, 0, 255, 0, 255, 0, 255, 0, 255]);
}

#[test]
fn opacity_is_read() {
    let data: Vec<u8> = (0..10).flat_map(|k| [10 * k, k]).collect();
    let with_alpha = image(&png(png::ColorType::GrayscaleAlpha, png::BitDepth::Eight, &data)).unwrap();
    assert_eq!(with_alpha.alpha, (0..10).collect::<Vec<u8>>());
    assert_eq!(brightness(&with_alpha)[9], 90);
}

#[test]
fn sizes_are_checked_before_memory_is_allocated() {
    let mut huge = bmp(24, 2, &[], [&[], &[]]);
    huge[18..22].copy_from_slice(&2_000_000_000_u32.to_le_bytes());
    assert!(image(&huge).unwrap_err().starts_with("map.img: image: too large (got 2000000000 x 2,"));
    let mut huge = png(png::ColorType::Grayscale, png::BitDepth::Eight, &GRAY);
    huge[16..20].copy_from_slice(&1_000_000_u32.to_be_bytes());
    huge[20..24].copy_from_slice(&1_000_000_u32.to_be_bytes());
    // The checksum of the header no longer fits; the size is refused in either case.
    assert!(image(&huge).is_err());
    let cut = &bmp(24, 2, &[], [&[1; 15], &[1; 15]])[..70];
    assert_eq!(image(cut).unwrap_err(), "map.img: BMP image: cut off (got 70 bytes)");
    let rle = bmp(4, 2, &[], [&[], &[]]);
    let rle = [&rle[..30], &2_u32.to_le_bytes(), &rle[34..]].concat();
    assert!(image(&rle).unwrap_err().contains("got 4 bits, compression 2"));
}

#[test]
fn other_files_name_the_formats() {
    let expected =
        "map.img: record: unknown (got 'GIF89a', expected a PGM image (P5 or P2), a PNG or a BMP image)";
    assert_eq!(image(b"GIF89a 1").unwrap_err(), expected);
    assert!(image(b"").is_err());
}

proptest! {
    #[test]
    fn any_bytes_give_an_image_or_an_error(
        kind in 0_usize..3,
        at in 0_usize..60,
        change in prop::collection::vec(any::<u8>(), 0..8),
        length in 0_usize..120,
    ) {
        let bytes = [
            bmp(24, 2, &[], [&[7; 15], &[9; 15]]),
            bmp(4, 2, &[1; 64], [&[7; 3], &[9; 3]]),
            png(png::ColorType::Grayscale, png::BitDepth::Eight, &GRAY),
        ];
        let mut bytes = bytes[kind].clone();
        for (byte, new) in bytes.iter_mut().skip(at).zip(change) {
            *byte = new;
        }
        bytes.truncate(length);
        if let Ok(image) = image(&bytes) {
            prop_assert_eq!(image.pixels.len(), image.width * image.height);
        }
    }
}
