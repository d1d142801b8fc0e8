//! One piece of work, many times: for counting instructions under callgrind, see `cargo xtask instructions`.
//!
//! `instructions NAME COUNT` does the work NAME (`extract181`, `extract361`, `match181`) COUNT times, on scans from all
//! round the loop world.

use std::hint::black_box;
use std::process::ExitCode;

use surepose::{LineExtractor, Matcher};
use surepose_lab::reproduce::{LoopWorld, as_scan};
use surepose_sim::{Clutter, Seed};

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let (name, count) = (arguments.next(), arguments.next().and_then(|n| n.parse::<usize>().ok()));
    let (beams, matching) = match name.as_deref() {
        Some("extract181") => (181, false),
        Some("extract361") => (361, false),
        Some("match181") => (181, true),
        _ => (0, false),
    };
    let (Ok(world), Some(count), true) = (LoopWorld::new(beams, Clutter::default()), count, beams > 0) else {
        eprintln!("usage: instructions extract181|extract361|match181 COUNT");
        return ExitCode::from(2);
    };
    let scans = world.scans(Seed(1));
    let (laser, ekf, matcher) = (world.range_finder(), world.ekf(), Matcher::default());
    let mut extractor = Box::<LineExtractor<f64, 361>>::default();
    // Lines are extracted once before the work that is counted, so that matching is counted alone.
    let lines: Vec<_> = scans
        .iter()
        .map(|(scan, _)| {
            extractor.extract(&laser, &as_scan(scan)).map_or(Vec::new(), |seen| seen.lines.to_vec())
        })
        .collect();
    for ((scan, belief), lines) in scans.iter().zip(&lines).cycle().take(count) {
        if matching {
            let mount = &laser.body_from_laser;
            black_box(matcher.matched(&ekf, belief, mount, black_box(lines), world.map()));
        } else if let Ok(seen) = extractor.extract(&laser, &as_scan(black_box(scan))) {
            black_box(seen.lines);
        }
    }
    ExitCode::SUCCESS
}
