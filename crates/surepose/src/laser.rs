//! Laser scan → wall lines → matched walls.
//!
//! [`LineExtractor`] turns a [`Scan`] into [`SeenLine`]s without a map and without knowing the pose:
//!
//! 1. *beams*: what did not come back, or came from outside the laser's reach, is left out;
//! 2. *segments*: seven beams that agree on a line start one, beam after beam joins it as long as the χ² test of
//!    its own variance says so, a few that do not fit are stepped over;
//! 3. *join*: segments of one line are one wall, seen in pieces; beams left between them are offered to every wall;
//! 4. *boundaries*: a beam next to an edge or so near a corner that it may belong to either wall belongs to none;
//! 5. *fit*: maximum likelihood with the full covariance; where things stand before the walls, likelihood of the
//!    mixture of both.
//!
//! [`Matcher`] then finds which wall of the map each line is: inside a χ² gate, one to one, where the wall really is.
//!
//! [`Aligner`] lays a scan on the walls of a map beam by beam, where rooms are so full that few walls are long enough to be
//! found without one.
//!
//! [`Rays`] asks where the first wall in the way of each beam is, and what the beams together say of the pose.
//!
//! [`Eye`] is the whole way from a scan to what the filter is told, by lines, by beams or by rays.
//!
//! # The coordinates
//! A line that does not pass through the laser is a·x + b·y = 1, with (a, b) = (cos ψ, sin ψ)/r. A beam at bearing φ
//! meets it at the range 1/u, u(φ) = a·cos φ + b·sin φ: the *inverse* range is linear in the line, so that nothing is
//! iterated to start a fit, a line through two beams costs a division, and an error ε of the bearing changes u by u′ε.
//! With range noise σ_r and bearing noise σ_φ the variance of the inverse range is u⁴σ_r² + u′²σ_φ²: the same as
//! the perpendicular residual ρ·cos(φ−ψ) − r with its variance cos²(φ−ψ)·σ_r² + ρ²·sin²(φ−ψ)·σ_φ², divided by r·ρ.

mod agreement;
mod align;
mod beam;
mod boundary;
mod evidence;
mod extract;
mod eye;
mod fit;
mod glance;
mod grow;
mod join;
mod list;
mod matching;
mod pull;
mod ray_line;
mod rays;
mod scan;
mod segment;
mod silence;
mod wall;

pub use agreement::Agreement;
pub use align::{Aligned, Aligner, AlignerMemory, Alignment};
pub use extract::{Extracted, LineExtractor, MOST_LINES, RefusedLines, SeenLine};
pub use eye::{Eye, Recognition, Seen};
pub use glance::Glance;
pub use matching::{Fate, Matched, Matcher};
pub(crate) use pull::Pull;
pub use rays::Rays;
pub use scan::{RangeFinder, Scan, ScanRefusal};
pub use silence::Silence;
pub use wall::{NotAWall, Wall};
