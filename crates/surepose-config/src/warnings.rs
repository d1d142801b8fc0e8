//! Warnings about valid but doubtful configurations.

use surepose::param;

use super::{Config, Value};

impl Config {
    /// Returns warnings about doubtful values, as sentences.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        let sampled = self.gains().k_alpha * self.number(&param::PERIOD);
        if sampled >= 1.0 {
            // With the command held for ΔT, a bearing error α becomes (1 − k_α·ΔT)·α.
            let fate = if sampled > 2.0 { "grows" } else { "overshoots" };
            warnings.push(format!(
                "law.k_alpha × loop.period_s: too large (got {sampled:.3}); the bearing error {fate} from tick to tick; use a value \
                 well below 1"
            ));
        }
        for (noise, most) in [(&param::LASER_RANGE_STD, 0.1), (&param::LASER_BEARING_STD, 1.0)] {
            let unit = noise.unit.symbol();
            if let Value::Number(std) = self.value(noise)
                && std > most
            {
                warnings.push(format!(
                    "{}.{}: above {most} {unit} (got {std} {unit}); walls may be confused and the estimate may be overconfident",
                    noise.section, noise.key
                ));
            }
        }
        let history = self.number(&param::HISTORY);
        for latency in [&param::COMPASS_LATENCY, &param::LASER_LATENCY] {
            let late = self.number(latency);
            if late > history {
                warnings.push(format!(
                    "{}.{}: longer than filter.history_s (got {late} s, history {history} s); every measurement is rejected as stale; \
                     increase filter.history_s",
                    latency.section, latency.key
                ));
            }
        }
        warnings.extend(self.actuator_warnings());
        warnings
    }
}
