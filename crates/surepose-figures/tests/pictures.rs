//! Tests of deterministic output and of robustness to unusual data.

use surepose_figures::plot::{Color, MapPlot, Mark, Panel, Picture, Stroke, XyPlot, hstack};

fn way() -> Vec<(f64, f64)> {
    (0..50).map(|i| f64::from(i) * 0.1).map(|s| (s, s.sin())).collect()
}

fn map() -> Picture {
    MapPlot::new("a < b & c")
        .walls([[(0.0, -1.0), (5.0, -1.0)]])
        .trace("way", way(), Stroke::solid(Color::Blue))
        .pose("goal", (5.0, -0.9), 1.0, Color::Purple)
        .picture()
}

fn chart(points: Vec<(f64, f64)>) -> Picture {
    let panel = Panel::new("speed", "v [m/s]").series("v", points, Stroke::solid(Color::Blue));
    XyPlot::over("time [s]")
        .panel(
            panel
                .clone()
                .marks([Mark::At(1.0, "switch".to_owned()), Mark::Level(0.0)])
                .shaded([(1.0, 2.0)], Color::Sky),
        )
        .panel(panel.logarithmic())
        .picture()
}

fn is_png(bytes: &[u8]) -> bool {
    bytes.starts_with(b"\x89PNG\r\n\x1a\n") && bytes.ends_with(b"IEND\xaeB`\x82")
}

#[test]
fn equal_input_gives_equal_bytes() {
    assert_eq!(map().svg(), map().svg());
    assert_eq!(map().png().unwrap(), map().png().unwrap());
    assert_eq!(chart(way()).svg(), chart(way()).svg());
    assert_ne!(map().svg(), chart(way()).svg());
}

#[test]
fn text_is_escaped_and_legends_are_drawn() {
    let svg = map().svg();
    assert!(svg.contains("a &lt; b &amp; c") && !svg.contains("a < b"));
    for label in ["walls", "way", "goal", "x [m]", "y [m]"] {
        assert!(svg.contains(&format!(">{label}<")), "{label}");
    }
}

#[test]
fn map_axes_have_equal_scales() {
    // The four corners of a square are drawn at equal distances.
    let square = vec![(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
    let far = vec![(0.0, 0.0), (7.0, 2.0)];
    let drawn = MapPlot::new("square")
        .trace("square", square, Stroke::solid(Color::Blue))
        .trace("far", far, Stroke::thin(Color::Grey))
        .picture()
        .svg();
    let path = drawn.split("d=\"").skip(2).find(|rest| rest.contains("stroke=\"#0072b2\"")).unwrap();
    let numbers: Vec<f64> = path.split(['M', 'L', ' ', '"']).filter_map(|word| word.parse().ok()).collect();
    let (width, height) = (numbers[2] - numbers[0], numbers[3] - numbers[5]);
    assert!(width > 10.0 && (width - height).abs() < 0.1, "{width} × {height}");
}

/// A longer label would overlap adjacent elements.
#[test]
fn tick_labels_of_tiny_and_huge_values_are_short() {
    for size in [2e-5, 3e-7, 0.3, 3e7, 2e200] {
        let svg = chart(vec![(0.0, 0.0), (1.0, 0.5 * size), (2.0, size)]).svg();
        let texts = svg.split(['<', '>']).map(|text| text.replace('−', "-"));
        let numbers = texts.filter(|text| text.parse::<f64>().is_ok());
        let longest = numbers.max_by_key(String::len).unwrap();
        assert!(longest.len() <= 8, "{size}: {longest}");
    }
}

#[test]
fn small_counts_have_integer_tick_labels() {
    let panel = Panel::new("", "trials").bars(vec![10.0, 20.0, 30.0], vec![3.0, 1.0], Color::Sky);
    let svg = XyPlot::over("x").panel(panel).picture().svg();
    assert!(svg.contains(">2<") && svg.contains(">3<") && !svg.contains(">1.5<"), "{svg}");
}

#[test]
fn unusual_data_gives_valid_images() {
    let odd = [
        vec![],
        vec![(0.0, 0.0)],
        vec![(f64::NAN, 1.0), (1.0, f64::INFINITY)],
        vec![(1.0, -1.0), (1.0, -1.0)],
    ];
    for points in odd {
        assert!(is_png(&chart(points.clone()).png().unwrap()), "{points:?}");
        let map = MapPlot::new("").trace("", points.clone(), Stroke::thin(Color::Grey));
        assert!(is_png(&hstack(vec![map.clone().cell(), map.cell()]).png().unwrap()), "{points:?}");
    }
}
