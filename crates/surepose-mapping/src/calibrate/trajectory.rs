//! Joint least-squares problem of poses, walls and geometry, solved by Gauss–Newton.

use std::collections::HashMap;
use std::ops::Range;

use nalgebra::{DMatrix, DVector, Matrix3};
use surepose::kinematics::Integration;
use surepose::scalar::Dual;

use super::frontal::{FrontalSolver, Key, Singular};
use super::line_observation::LineObservation;
use super::model::{
    FROM, GEOMETRY, LOCAL, Local, PoseVector, TO, WALL, compass_reading, during, fraction, known_pose,
    motion, odometry, odometry_covariance, seen, unknown_geometry, unknown_pose, unknown_wall,
};
use super::parameter::{COUNT, CalibrationParameter, Geometry};
use super::recording::{OdometryStep, StampedHeading, locate};

/// Standard deviations beyond which residuals count linearly. [Huber1964]
const HUBER: f64 = 3.0;

/// Step of the finite differences of the likelihood by a latency \[s].
const LATENCY_STEP: f64 = 0.005;

/// Standard deviation of the first pose, which defines the map's origin \[m, rad].
const ANCHOR: f64 = 1e-4;

/// Standard deviation of a heading without measurements \[rad].
const FREE: f64 = 1.0;

/// Poses at the ends of the steps, and walls.
#[derive(Clone, Debug)]
pub(super) struct Trajectory {
    pub(super) poses: Vec<PoseVector>,
    pub(super) walls: Vec<[f64; 2]>,
}

/// Noise levels of the measurements.
#[derive(Clone, Copy, Debug)]
pub(super) struct NoiseLevels {
    /// δ of [Tran2012] Eq. (15).
    pub(super) delta: f64,
    /// Variance of the walls over the variance expected from the laser's noise.
    pub(super) wall: f64,
    /// Standard deviation of the compass \[rad].
    pub(super) compass: f64,
}

/// Recorded data with the wall of each observation.
#[derive(Clone, Debug)]
pub(super) struct FitData<'a> {
    pub(super) steps: &'a [OdometryStep],
    pub(super) line_observations: &'a [LineObservation],
    pub(super) wall_of: Vec<usize>,
    pub(super) headings: &'a [StampedHeading],
    /// Rotation of one tick \[rad].
    pub(super) tick: f64,
}

/// A linearized residual.
#[derive(Clone, Debug)]
struct Factor<const M: usize> {
    residual: [f64; M],
    jacobian: [[f64; M]; LOCAL],
    information: [[f64; M]; M],
    /// Index of the record that it comes from.
    record: usize,
    /// Robust weight; below 1 for outliers.
    weight: f64,
}

/// The least-squares problem, linearized about a trajectory and a geometry.
#[derive(Clone, Debug)]
pub(super) struct Linear {
    /// Odometry factor of each step, with the two parts of its covariance.
    odometry: Vec<(Factor<3>, [[[f64; 3]; 3]; 2])>,
    /// Walls observed during each step.
    walls: Vec<Vec<(usize, Factor<2>)>>,
    /// Headings read during each step.
    headings: Vec<Vec<Factor<1>>>,
}

impl Trajectory {
    /// Integrates the wheel motion from the origin.
    pub(super) fn dead_reckoned(steps: &[OdometryStep], geometry: &Geometry<f64>, start: f64) -> Self {
        let mut poses: Vec<PoseVector> = vec![[0.0, 0.0, start]];
        for step in steps {
            let motion = motion(geometry, step.turned);
            let [x, y, heading] = poses.last().copied().unwrap_or_default();
            let pose = known_pose([x, y, heading]).integrate(motion, Integration::Arc);
            poses.push([pose.x, pose.y, heading + motion.turn]);
        }
        Self { poses, walls: Vec::new() }
    }
}

fn factor<const M: usize>(record: usize, residual: [Local; M], information: [[f64; M]; M]) -> Factor<M> {
    Factor {
        residual: residual.map(|r| r.value),
        jacobian: core::array::from_fn(|v| core::array::from_fn(|i| residual[i].slope[v])),
        information,
        record,
        weight: 1.0,
    }
}

impl FitData<'_> {
    /// Linearizes the problem about this trajectory and geometry.
    pub(super) fn linear(&self, trajectory: &Trajectory, geometry: &Geometry<f64>) -> Linear {
        let unknown = unknown_geometry(geometry);
        let ends = |step: usize| {
            let (from, to) = (trajectory.poses[step], trajectory.poses[step + 1]);
            (unknown_pose(from, FROM), unknown_pose(to, TO))
        };
        let odometry = self.steps.iter().enumerate().map(|(k, step)| {
            let (from, to) = ends(k);
            let residual = odometry(from, to, motion(&unknown, step.turned));
            (factor(k, residual, [[0.0; 3]; 3]), odometry_covariance(geometry, step.turned, self.tick))
        });
        let mut linear = Linear {
            odometry: odometry.collect(),
            walls: vec![Vec::new(); self.steps.len()],
            headings: vec![Vec::new(); self.steps.len()],
        };
        let latency = geometry.get(CalibrationParameter::LaserLatency);
        for (record, (line_observation, wall)) in self.line_observations.iter().zip(&self.wall_of).enumerate()
        {
            let Some(known) = trajectory.walls.get(*wall) else { continue };
            let Some(k) = self.step_at(line_observation.stamp - latency) else { continue };
            let (from, to) = ends(k);
            let part = fraction(
                &self.steps[k],
                line_observation.stamp,
                unknown.get(CalibrationParameter::LaserLatency),
            );
            let line = seen(during(from, to, part), &unknown, unknown_wall(*known));
            let constant = |value: f64| Dual::constant(value);
            let residual = [
                line.distance - constant(line_observation.line.distance),
                line.direction.rotated_by(constant(-line_observation.line.direction.radians())).radians(),
            ];
            linear.walls[k].push((*wall, factor(record, residual, line_observation.information)));
        }
        let latency = geometry.get(CalibrationParameter::CompassLatency);
        for (record, reading) in self.headings.iter().enumerate() {
            let Some(k) = self.step_at(reading.time - latency) else { continue };
            let (from, to) = ends(k);
            let part =
                fraction(&self.steps[k], reading.time, unknown.get(CalibrationParameter::CompassLatency));
            let expected = compass_reading(during(from, to, part), &unknown);
            let residual = [expected.rotated_by(Dual::constant(-reading.heading.radians())).radians()];
            linear.headings[k].push(factor(record, residual, [[1.0]]));
        }
        linear
    }

    /// Returns the derivative of ½·(−2 log likelihood) by each latency, for each of `ranges`; 0 for other
    /// parameters.
    ///
    /// A latency determines between which two poses a scan lies. Its least-squares estimate is biased:
    /// halfway between two poses the odometry errors average out and appear smaller. The determinant of the
    /// normal matrix, which least squares omits, compensates for this. Both terms have a kink where a scan
    /// coincides with a pose, and the kinks cancel only in their sum. Finite differences therefore span the
    /// kinks.
    pub(super) fn latency_slopes(
        &self,
        linear: &Linear,
        trajectory: &Trajectory,
        geometry: &Geometry<f64>,
        noise: NoiseLevels,
        ranges: &[Range<usize>],
    ) -> Result<Vec<[f64; COUNT]>, Singular> {
        let mut slopes = vec![[0.0; COUNT]; ranges.len()];
        let latencies = [
            (CalibrationParameter::LaserLatency, self.line_observations.is_empty()),
            (CalibrationParameter::CompassLatency, self.headings.is_empty()),
        ];
        for (latency, _) in latencies.into_iter().filter(|(_, absent)| !absent) {
            let moved = |by: f64| {
                let mut geometry = *geometry;
                geometry.0[latency as usize] += by;
                let mut moved = self.linear(trajectory, &geometry);
                moved.weigh_as(linear);
                moved
            };
            let (mut before, mut after) = (moved(-LATENCY_STEP), moved(LATENCY_STEP));
            before.keep_common(&mut after, ranges);
            for (range, slopes) in ranges.iter().zip(&mut slopes) {
                let rise = after.reduced(range.clone(), noise)?.misfit
                    - before.reduced(range.clone(), noise)?.misfit;
                slopes[latency as usize] = 0.5 * rise / (2.0 * LATENCY_STEP);
            }
        }
        Ok(slopes)
    }

    /// Returns the step that contains `time`; `None` if it is more than one step outside the recording.
    fn step_at(&self, time: f64) -> Option<usize> {
        let (index, part) = locate(self.steps, time);
        (-1.0..=2.0).contains(&part).then_some(index)
    }
}

/// The problem of a segment, reduced to the geometry.
#[derive(Clone, Debug)]
pub(super) struct Reduced {
    /// Normal matrix of the geometry.
    pub(super) a: DMatrix<f64>,
    /// Right-hand side.
    pub(super) b: DVector<f64>,
    /// −2 log likelihood at the minimum over poses and walls, up to a constant.
    pub(super) misfit: f64,
    solver: FrontalSolver,
}

impl Linear {
    /// Eliminates the poses and walls of the steps in `range`.
    pub(super) fn reduced(&self, range: Range<usize>, noise: NoiseLevels) -> Result<Reduced, Singular> {
        let mut solver = FrontalSolver::new();
        let geometry = solver.add_variable(Key::Geometry, COUNT);
        let first = solver.add_variable(Key::Pose(range.start), 3);
        // The first pose defines the map's origin; the pose of a later segment is free, and its heading is
        // held by the compass.
        let free = range.start > 0;
        for (i, std) in [ANCHOR, ANCHOR, if free { FREE } else { ANCHOR }].into_iter().enumerate() {
            solver.add_factor(&[0.0], &[[1.0]], &[first + i], &[[1.0 / (std * std)]]);
        }
        let mut last_seen = HashMap::new();
        for k in range.clone() {
            for (wall, _) in &self.walls[k] {
                last_seen.insert(*wall, k);
            }
        }
        let mut misfit = 0.0;
        let mut columns = [0; LOCAL];
        for i in 0..COUNT {
            columns[GEOMETRY + i] = geometry + i;
        }
        for k in range.clone() {
            let to = solver.add_variable(Key::Pose(k + 1), 3);
            let from = solver.add_variable(Key::Pose(k), 3);
            for i in 0..3 {
                columns[FROM + i] = from + i;
                columns[TO + i] = to + i;
            }
            let (step, [by_slip, constant]) = &self.odometry[k];
            let covariance = Matrix3::from_fn(|i, j| noise.delta * by_slip[i][j] + constant[i][j]);
            let factor = covariance.cholesky().ok_or(Singular)?;
            misfit += 2.0 * factor.l_dirty().diagonal().iter().map(|d| d.ln()).sum::<f64>();
            let information = factor.inverse();
            let information = core::array::from_fn(|i| core::array::from_fn(|j| information[(i, j)]));
            add(&mut solver, step, &information, &columns, false);
            for heading in &self.headings[k] {
                let scaled = heading.scaled(noise.compass * noise.compass);
                add(&mut solver, heading, &scaled, &columns, false);
                misfit += 2.0 * noise.compass.ln();
            }
            for (wall, line_observation) in &self.walls[k] {
                let at = solver.add_variable(Key::Wall(*wall), 2);
                columns[WALL] = at;
                columns[WALL + 1] = at + 1;
                let scaled = line_observation.scaled(noise.wall);
                add(&mut solver, line_observation, &scaled, &columns, true);
                misfit += 2.0 * noise.wall.ln();
            }
            solver.eliminate(Key::Pose(k))?;
            for (wall, _) in &self.walls[k] {
                if last_seen.get(wall) == Some(&k) {
                    solver.eliminate(Key::Wall(*wall))?;
                }
            }
        }
        solver.eliminate(Key::Pose(range.end))?;
        let (a, b) = solver.remaining();
        let (a, b) = (a.clone(), b.clone());
        let misfit = misfit + solver.chi_squared + solver.log_determinant;
        Ok(Reduced { a, b, misfit, solver })
    }

    /// Sets the robust weights of all residuals for the given noise.
    pub(super) fn weigh(&mut self, noise: NoiseLevels) {
        for (_, factor) in self.walls.iter_mut().flatten() {
            factor.weigh(noise.wall);
        }
        for factor in self.headings.iter_mut().flatten() {
            factor.weigh(noise.compass * noise.compass);
        }
    }

    /// Copies the weights of `other`, a linearization about another geometry.
    fn weigh_as(&mut self, other: &Self) {
        let known: HashMap<usize, f64> =
            other.walls.iter().flatten().map(|(_, factor)| (factor.record, factor.weight)).collect();
        for (_, factor) in self.walls.iter_mut().flatten() {
            factor.weight = known.get(&factor.record).copied().unwrap_or(factor.weight);
        }
        let known: HashMap<usize, f64> =
            other.headings.iter().flatten().map(|factor| (factor.record, factor.weight)).collect();
        for factor in self.headings.iter_mut().flatten() {
            factor.weight = known.get(&factor.record).copied().unwrap_or(factor.weight);
        }
    }

    /// Drops measurements that do not fall into the same one of `ranges` in both problems. Likelihoods are
    /// comparable only if they are of the same measurements.
    fn keep_common(&mut self, other: &mut Self, ranges: &[Range<usize>]) {
        let range_of = |k: usize| ranges.iter().position(|range| range.contains(&k));
        let walls = |linear: &Self| -> HashMap<usize, Option<usize>> {
            let all = linear.walls.iter().enumerate();
            all.flat_map(|(k, here)| here.iter().map(move |(_, f)| (f.record, range_of(k)))).collect()
        };
        let headings = |linear: &Self| -> HashMap<usize, Option<usize>> {
            let all = linear.headings.iter().enumerate();
            all.flat_map(|(k, here)| here.iter().map(move |f| (f.record, range_of(k)))).collect()
        };
        let poses = [(walls(self), headings(self)), (walls(other), headings(other))];
        for linear in [self, other] {
            for here in &mut linear.walls {
                here.retain(|(_, f)| poses[0].0.get(&f.record) == poses[1].0.get(&f.record));
            }
            for here in &mut linear.headings {
                here.retain(|f| poses[0].1.get(&f.record) == poses[1].1.get(&f.record));
            }
        }
    }

    /// Number of steps.
    pub(super) fn len(&self) -> usize {
        self.odometry.len()
    }
}

impl<const M: usize> Factor<M> {
    /// Returns the weighted inverse covariance for a variance of `scale` times the stated one.
    fn scaled(&self, scale: f64) -> [[f64; M]; M] {
        self.information.map(|row| row.map(|entry| entry * self.weight / scale))
    }

    /// Sets the robust weight from the size of the residual.
    fn weigh(&mut self, scale: f64) {
        let mut squared = 0.0;
        for i in 0..M {
            for j in 0..M {
                squared += self.residual[i] * self.information[i][j] * self.residual[j] / scale;
            }
        }
        self.weight = (HUBER / squared.max(0.0).sqrt()).min(1.0);
    }
}

/// Number of variables of a factor without a wall.
const SHORT: usize = LOCAL + WALL - GEOMETRY;

/// Adds a factor to the front; a factor without a wall has no columns for it.
fn add<const M: usize>(
    solver: &mut FrontalSolver,
    factor: &Factor<M>,
    information: &[[f64; M]; M],
    columns: &[usize; LOCAL],
    with_wall: bool,
) {
    if with_wall {
        return solver.add_factor(&factor.residual, &factor.jacobian, columns, information);
    }
    let at = |i: usize| if i < WALL { i } else { i + GEOMETRY - WALL };
    let jacobian: [[f64; M]; SHORT] = core::array::from_fn(|i| factor.jacobian[at(i)]);
    let columns: [usize; SHORT] = core::array::from_fn(|i| columns[at(i)]);
    solver.add_factor(&factor.residual, &jacobian, &columns, information);
}

impl Reduced {
    /// Updates the trajectory for a change of the geometry by `step`.
    pub(super) fn moved(&self, trajectory: &Trajectory, step: &DVector<f64>) -> Trajectory {
        let mut moved = trajectory.clone();
        self.solver.back_substitute(step, |key, change| match key {
            Key::Pose(k) => {
                for (value, change) in moved.poses[k].iter_mut().zip(change.iter()) {
                    *value += change;
                }
            }
            Key::Wall(w) => {
                for (value, change) in moved.walls[w].iter_mut().zip(change.iter()) {
                    *value += change;
                }
            }
            Key::Geometry => {}
        });
        moved
    }
}
