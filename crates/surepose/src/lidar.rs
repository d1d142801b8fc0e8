//! Laser scan → wall lines → matched walls.
//!
//! [`LineExtractor`] turns a [`Scan`] into [`ExtractedLine`]s without a map and without knowing the pose:
//!
//! 1. *beams*: what did not come back, or came from outside the laser's reach, is left out;
//! 2. *segments*: seven beams that agree on a line start one, beam after beam joins it as long as the χ² test of
//!    its own variance says so, a few that do not fit are stepped over;
//! 3. *join*: segments of one line are one wall, seen in several runs; beams left between them are offered to every wall;
//! 4. *boundaries*: a beam next to an edge or so near a corner that it may belong to either wall belongs to none;
//! 5. *fit*: maximum likelihood with the full covariance; where things stand before the walls, likelihood of the
//!    mixture of both.
//!
//! [`LineAssociator`] then finds which wall of the map each line is: inside a χ² gate, one to one, where the wall really is.
//!
//! [`ScanMatcher`] lays a scan on the walls of a map beam by beam, where rooms are so full that few walls are long enough to be
//! found without one.
//!
//! [`BeamModelMatcher`] asks where the first wall in the way of each beam is, and what the beams together say of the pose.
//!
//! [`ScanProcessor`] is the whole way from a scan to the measurements of the filter, by lines, by scan matching or by the beam model.
//!
//! # The coordinates
//! A line that does not pass through the laser is a·x + b·y = 1, with (a, b) = (cos ψ, sin ψ)/r. A beam at bearing φ
//! meets it at the range 1/u, u(φ) = a·cos φ + b·sin φ: the *inverse* range is linear in the line, so that nothing is
//! iterated to start a fit, a line through two beams costs a division, and an error ε of the bearing changes u by u′ε.
//! With range noise σ_r and bearing noise σ_φ the variance of the inverse range is u⁴σ_r² + u′²σ_φ²: the same as
//! the perpendicular residual ρ·cos(φ−ψ) − r with its variance cos²(φ−ψ)·σ_r² + ρ²·sin²(φ−ψ)·σ_φ², divided by r·ρ.

mod beam;
mod beam_model_matcher;
mod beam_stats;
mod beam_subset;
mod boundary;
mod fit;
mod fixed_vec;
mod grow;
mod inverse_range_line;
mod line_associator;
mod line_extractor;
mod line_normal_equations;
mod merge;
mod missed_returns;
mod pose_normal_equations;
mod scan;
mod scan_event;
mod scan_matcher;
mod scan_processor;
mod segment;

pub use beam_model_matcher::BeamModelMatcher;
pub use beam_stats::BeamStats;
pub use beam_subset::BeamSubset;
pub use line_associator::{Association, Associations, LineAssociator};
pub use line_extractor::{ExtractedLine, LineExtraction, LineExtractor, MAX_LINES, RejectedLines};
pub use missed_returns::MissedReturns;
pub(crate) use pose_normal_equations::PoseNormalEquations;
pub use scan::{LaserGeometry, RangeFinder, Scan, ScanError};
pub use scan_event::ScanEvent;
pub use scan_matcher::{ScanMatch, ScanMatchResult, ScanMatcher, ScanMatcherWorkspace};
pub use scan_processor::{ScanModel, ScanObservation, ScanProcessor};
