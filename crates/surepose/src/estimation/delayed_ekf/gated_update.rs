//! Update of the filter's state by a measurement of any type, inside the gate.

use crate::estimation::considered::{Considered, InnovationSums};
use crate::estimation::ekf::Ekf;
use crate::estimation::gate::Gate;
use crate::estimation::gyroscope::FilterState;
use crate::estimation::measurement::Measurement;
use crate::scalar::Float;
use crate::time::Stamp;

/// Corrects the state by a measurement; `sums` take its innovations, with their time. Returns what
/// [`Ekf::correct_state`] does.
pub(super) fn correct<S: Float>(
    (ekf, gate): (&Ekf<S>, &Gate<S>),
    state: &mut FilterState<S>,
    considered: Option<Considered<'_, S>>,
    measurement: &Measurement<S>,
    sums: Option<(Stamp, &mut InnovationSums<S>)>,
) -> (S, bool) {
    /// Computes the update by the innovation of one type of measurement.
    macro_rules! correct {
        ($innovation:expr) => {{
            let threshold = gate.threshold(measurement.dimension());
            ekf.correct_state(state, measurement, &$innovation, threshold, considered, sums)
        }};
    }
    let belief = &{ state.belief };
    match measurement {
        Measurement::Heading(compass) => correct!(compass.innovation(belief)),
        Measurement::Line(wall) => correct!(wall.innovation(belief)),
        Measurement::RangeBearing(landmark) => correct!(landmark.innovation(belief)),
        Measurement::Position(position) => correct!(position.innovation(belief)),
        Measurement::Pose(pose) => correct!(pose.innovation(belief)),
    }
}
