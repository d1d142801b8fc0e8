//! Outcome of a replay: consistency decides, the size of the errors does not.

use surepose_replay::ReplayReport;

/// Largest mean and median of the NEES of a consistent estimate, whose expectations are 3 and 2.37.
const MAX_NEES_MEAN: f64 = 10.0;
const MAX_NEES_MEDIAN: f64 = 6.0;
/// Smallest fraction of a recording with reference that must be judged.
const MIN_JUDGED_SHARE: f64 = 0.2;

/// Returns why the estimate is inconsistent or cannot be judged; `None` if it is neither.
///
/// A low NEES is no failure: a robot at rest and perfect odometry have one.
pub(super) fn failure(report: &ReplayReport) -> Option<String> {
    let nothing = |why: &str| Some(format!("nothing could be evaluated: {why}"));
    if report.steps == 0 {
        return nothing("the recording has no step of odometry");
    }
    // Several remaining hypotheses count as a failed localization.
    if !report.hypotheses_left.is_none_or(|left| left == 1 && report.found_s.is_some()) {
        return nothing("the robot was not localized");
    }
    if report.accepted == 0 {
        return nothing("no measurement was accepted; the result is dead reckoning");
    }
    if let Some(share) = report.judged_share.filter(|share| *share < MIN_JUDGED_SHARE) {
        return Some(format!(
            "only {:.0} % of the recording could be judged (expected at least {:.0} %): elsewhere the robot was lost, or the \
             reference is absent; see `skipped` in the output of --json",
            share * 100.0,
            MIN_JUDGED_SHARE * 100.0
        ));
    }
    let above = |what: &str, nees: Option<f64>, limit: f64| {
        nees.filter(|nees| nees.is_nan() || *nees > limit)
            .map(|nees| format!("{what} {nees:.1}, expected at most {limit}"))
    };
    let why = above("NEES mean", report.nees_mean, MAX_NEES_MEAN)
        .or_else(|| above("NEES median", report.nees_median, MAX_NEES_MEDIAN))?;
    Some(format!("the estimate is inconsistent ({why}); check that the map and the settings match the robot"))
}

#[cfg(test)]
mod tests {
    use surepose_replay::ReplayReport;

    use super::failure;

    #[test]
    fn consistency_decides_and_a_low_nees_is_no_failure() {
        let report = |mean: f64, median: f64, share: f64| ReplayReport {
            steps: 10,
            accepted: 5,
            nees_mean: Some(mean),
            nees_median: Some(median),
            judged_share: Some(share),
            position_rmse_m: Some(3.0),
            dead_reckoning_position_rmse_m: Some(0.1),
            ..ReplayReport::default()
        };
        for (mean, median, share, reason) in [
            (3.0, 2.4, 1.0, None),
            (0.0, 0.0, 0.2, None),
            (10.0, 6.0, 0.2, None),
            (10.1, 2.0, 1.0, Some("NEES mean")),
            (f64::INFINITY, 2.0, 1.0, Some("NEES mean")),
            (9.0, 6.1, 1.0, Some("NEES median")),
            (3.0, 2.4, 0.19, Some("could be judged")),
        ] {
            let found = failure(&report(mean, median, share));
            assert_eq!(found.is_some(), reason.is_some(), "{mean} {median} {share}: {found:?}");
            assert!(reason.is_none_or(|reason| found.is_some_and(|found| found.contains(reason))));
        }
    }
}
