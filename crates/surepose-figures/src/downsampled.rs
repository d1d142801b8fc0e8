//! What of a long drive is drawn.

use surepose_sim::simulation::Sample;

/// More samples than this lie closer together than a picture has pixels.
const MAX_SAMPLES: usize = 4000;

/// Evenly chosen samples, the first and the last among them; all, where they are no more than a picture shows.
pub fn downsampled(samples: &[Sample]) -> Vec<Sample> {
    let (count, last) = (samples.len().min(MAX_SAMPLES), samples.len().saturating_sub(1));
    (0..count).filter_map(|k| samples.get(k * last / (count - 1).max(1))).copied().collect()
}

#[cfg(test)]
mod tests {
    use surepose_sim::robot::Scenario;
    use surepose_sim::simulation::simulate;

    use super::{MAX_SAMPLES, downsampled};

    #[test]
    fn long_drives_are_thinned_and_short_ones_are_not() {
        let (short, _) = simulate(&Scenario::default(), 1);
        assert_eq!(downsampled(&short), short);
        assert!(downsampled(&[]).is_empty());
        for count in
            [MAX_SAMPLES, MAX_SAMPLES + 1, 2 * MAX_SAMPLES - 1, 2 * MAX_SAMPLES, 10 * MAX_SAMPLES + 7]
        {
            let long: Vec<_> = short.iter().cycle().take(count).copied().collect();
            let thin = downsampled(&long);
            assert_eq!(thin.len(), MAX_SAMPLES, "of {count}");
            assert_eq!((thin.first(), thin.last()), (long.first(), long.last()));
        }
    }
}
