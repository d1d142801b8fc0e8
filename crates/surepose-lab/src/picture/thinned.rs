//! What of a long drive is drawn.

use crate::drive::Sample;

/// More samples than this lie closer together than a picture has pixels.
const MOST: usize = 4000;

/// Evenly chosen samples, the first and the last among them; all, where they are no more than a picture shows.
pub fn thinned(samples: &[Sample]) -> Vec<Sample> {
    let (count, last) = (samples.len().min(MOST), samples.len().saturating_sub(1));
    (0..count).filter_map(|k| samples.get(k * last / (count - 1).max(1))).copied().collect()
}

#[cfg(test)]
mod tests {
    use super::{MOST, thinned};
    use crate::drive::drive;
    use crate::rig::Scenario;

    #[test]
    fn long_drives_are_thinned_and_short_ones_are_not() {
        let (short, _) = drive(&Scenario::default(), 1);
        assert_eq!(thinned(&short), short);
        assert!(thinned(&[]).is_empty());
        for count in [MOST, MOST + 1, 2 * MOST - 1, 2 * MOST, 10 * MOST + 7] {
            let long: Vec<_> = short.iter().cycle().take(count).copied().collect();
            let thin = thinned(&long);
            assert_eq!(thin.len(), MOST, "of {count}");
            assert_eq!((thin.first(), thin.last()), (long.first(), long.last()));
        }
    }
}
