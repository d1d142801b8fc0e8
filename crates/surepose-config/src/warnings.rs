//! Configurations that can be used, but should perhaps not.

use surepose::param;

use super::{Config, Value};

impl Config {
    /// What a careful user wants to know of these values, as sentences.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        let sampled = self.gains().k_alpha * self.number(&param::PERIOD);
        if sampled >= 1.0 {
            // With the command held for ΔT, a bearing error α becomes (1 − k_α·ΔT)·α.
            let fate = if sampled > 2.0 { "grows" } else { "overshoots" };
            warnings.push(format!(
                "law.k_alpha × loop.period_s is {sampled:.3}: the bearing error {fate} from tick to tick; keep it well \
                 under 1"
            ));
        }
        for (noise, most) in [(&param::LASER_RANGE_STD, 0.1), (&param::LASER_BEARING_STD, 1.0)] {
            let unit = noise.unit.symbol();
            if let Value::Number(std) = self.value(noise)
                && std > most
            {
                warnings.push(format!(
                    "{}.{} is {std} {unit}: beyond {most} {unit} one wall is taken for another, and the filter is too sure \
                     of itself",
                    noise.section, noise.key
                ));
            }
        }
        let history = self.number(&param::HISTORY);
        for latency in [&param::COMPASS_LATENCY, &param::LASER_LATENCY] {
            let late = self.number(latency);
            if late > history {
                warnings.push(format!(
                    "{}.{} is {late} s, and filter.history_s {history} s: each measurement will be refused as stale; \
                     let the history reach back farther",
                    latency.section, latency.key
                ));
            }
        }
        warnings
    }
}
