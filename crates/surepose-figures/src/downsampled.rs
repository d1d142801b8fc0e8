//! Downsampling of long drives for pictures.

use surepose_sim::simulation::Sample;

/// Maximum number of samples; more would be closer together than pixels.
const MAX_SAMPLES: usize = 4000;

/// Returns evenly spaced samples, including the first and the last; all, if there are at most `MAX_SAMPLES`.
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
    fn only_long_drives_are_downsampled() {
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
