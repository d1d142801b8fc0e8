//! How far apart are the places where the local law takes over and where it hands back?

use core::f64::consts::PI;

use surepose::Scalar;

use crate::descent::Descent;
use crate::interval::Interval;
use crate::region::Region;
use crate::subject::Subject;

/// Into how many distances and directions the seen goal is cut.
const RINGS: usize = 40;
const RAYS: usize = 96;

/// A place of the goal in the robot's axes: everything within `radius` of (x, y) \[m].
struct Spot {
    x: f64,
    y: f64,
    radius: f64,
}

/// The gap between the two sets of places as seen, and what one tick of motion and the noise of two can bridge \[m].
pub(crate) fn gap<L: Subject>(descent: &Descent<'_, L>, near: Interval) -> (f64, f64) {
    let all = Interval::new(0.0, 1.5 * near.hi().max(1e-6));
    let (mut taken, mut handed) = (Vec::new(), Vec::new());
    let (mut farthest, mut fastest, mut turn) = (0.0_f64, 0.0_f64, 0.0_f64);
    for ring in 0..RINGS {
        for ray in 0..RAYS {
            let region = Region {
                rho: all.piece(ring, RINGS),
                drift: Interval::point(0.0),
                alpha: Interval::new((-PI).next_up(), PI).piece(ray, RAYS),
                phi: Interval::new((-PI).next_up(), PI),
            };
            if descent.local_possible(&region, false) {
                taken.push(spot(&region));
                farthest = farthest.max(region.rho.hi());
                let told = descent.told(&region);
                let twist = descent.noise.driven(&descent.drive.cast(), told);
                fastest = fastest.max(twist.v.magnitude());
                turn = turn.max(twist.omega.magnitude());
            }
            if descent.global_possible(&region) {
                handed.push(spot(&region));
            }
        }
    }
    let mut least = f64::INFINITY;
    for a in &taken {
        for b in &handed {
            least = least.min((a.x - b.x).hypot(a.y - b.y) - a.radius - b.radius);
        }
    }
    let noise = 2.0 * descent.noise.position;
    let motion = fastest * descent.period + farthest * (turn * descent.period + 2.0 * descent.noise.heading);
    (least.max(0.0), (noise + motion) * (1.0 + 1e-9))
}

fn spot(region: &Region) -> Spot {
    let (sin, cos) = region.alpha.sin_cos();
    let (x, y) = (region.rho * cos, region.rho * sin);
    Spot { x: x.mid(), y: y.mid(), radius: 0.5 * x.width().hypot(y.width()) * (1.0 + 1e-9) }
}
