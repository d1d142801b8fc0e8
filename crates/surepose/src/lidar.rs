//! Laser scans to wall lines, matched walls and pose measurements.
//!
//! [`LineExtractor`] extracts [`ExtractedLine`]s from a [`Scan`]. It uses neither a map nor a pose:
//!
//! 1. *beams*: returns outside the range limits of the laser are discarded;
//! 2. *segments*: five of seven neighboring beams on a line seed a segment. It grows beam by beam by a χ² test with
//!    the variance of the line, and steps over a few outliers;
//! 3. *merge*: collinear segments form one wall with several runs. Beams left between the runs are tested against
//!    every wall;
//! 4. *boundaries*: beams next to an edge, and beams near a corner that may lie on either wall, are discarded;
//! 5. *fit*: maximum likelihood with full covariance. Where clutter stands before the walls, the likelihood is that of
//!    the mixture of both.
//!
//! [`LineAssociator`] matches each line with a wall of the map, one to one and inside a χ² gate. The line must overlap
//! the wall.
//!
//! [`BeamModelMatcher`] casts a ray for each beam to the first wall, and estimates the pose from all beams together. It
//! serves cluttered rooms, where few walls are long enough for line extraction, and walls traced from a grid or a log.
//!
//! [`Deskewer`] moves the beams of a scan that took time to where they would be in a scan of one moment.
//!
//! [`ScanProcessor`] turns a scan into measurements for the filter by one of these two models.
//!
//! # Coordinates
//! A line that does not pass through the laser is a·x + b·y = 1, with (a, b) = (cos ψ, sin ψ)/r. A beam at bearing φ
//! meets it at the range 1/u, u(φ) = a·cos φ + b·sin φ. The *inverse* range is linear in (a, b): a fit needs no
//! iteration to start, and a line through two beams needs one division. A bearing error ε changes u by u′ε.
//! With range noise σ_r and bearing noise σ_φ the variance of the inverse range is u⁴σ_r² + u′²σ_φ². This equals the
//! perpendicular residual ρ·cos(φ−ψ) − r with its variance cos²(φ−ψ)·σ_r² + ρ²·sin²(φ−ψ)·σ_φ², divided by r·ρ.

mod beam;
mod beam_model_matcher;
mod beam_stats;
mod beam_subset;
mod boundary;
mod deskew;
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
mod scan_processor;
mod scan_timing;
mod segment;

pub use beam_model_matcher::{BeamMatch, BeamModelMatcher};
pub use beam_stats::BeamStats;
pub use beam_subset::BeamSubset;
pub use deskew::Deskewer;
pub use line_associator::{Association, Associations, LineAssociator};
pub use line_extractor::{ExtractedLine, LineExtraction, LineExtractor, MAX_LINES, RejectedLines};
pub use missed_returns::MissedReturns;
pub(crate) use pose_normal_equations::PoseNormalEquations;
pub use scan::{LaserGeometry, MAX_SWEEP_DURATION, RangeFinder, Scan, ScanError};
pub use scan_event::ScanEvent;
pub use scan_processor::{ScanModel, ScanObservation, ScanProcessor};
pub use scan_timing::{ScanTiming, StampedBeam};
