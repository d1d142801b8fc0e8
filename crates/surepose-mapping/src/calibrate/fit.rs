//! Maximum-likelihood geometry and scatter of the measurements.

use core::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

use super::association::{AssociationThresholds, associate};
use super::error::CalibrationError;
use super::frontal::Singular;
use super::line_observation::LineObservation;
use super::options::Options;
use super::parameter::{CalibrationParameter, Geometry};
use super::recording::{CalibrationRecording, OdometryStep};
use super::trajectory::{FitData, Linear, NoiseLevels, Reduced, Trajectory};

/// Maximum parameter change of a converged step, in standard errors.
const CONVERGED: f64 = 0.05;

/// Maximum number of Gauss–Newton steps of one round.
const STEPS: usize = 40;

/// Number of initial steps, without robust weights, in which the walls converge.
const SETTLING: usize = 4;

/// Maximum change of a latency in one step \[s].
const LATENCY_REACH: f64 = 0.03;

/// Maximum relative change of the wheel separation in one step.
const TRACK_REACH: f64 = 0.2;

/// The parameters that are latencies.
const LATENCIES: [CalibrationParameter; 2] =
    [CalibrationParameter::LaserLatency, CalibrationParameter::CompassLatency];

/// State of a fit: data, trajectory, geometry and noise.
pub(super) struct Fit<'a> {
    pub(super) data: FitData<'a>,
    pub(super) trajectory: Trajectory,
    pub(super) geometry: Geometry<f64>,
    pub(super) noise: NoiseLevels,
    pub(super) nominal: Geometry<f64>,
}

/// Gradient and Hessian of −2 log likelihood by ln δ and by the logarithm of the walls' scatter.
#[derive(Clone, Copy, Debug)]
pub(super) struct NoiseCurvature {
    pub(super) slope: [f64; 2],
    pub(super) curvature: [[f64; 2]; 2],
}

impl<'a> Fit<'a> {
    /// Starts from dead reckoning with nominal geometry and noise.
    pub(super) fn begin(
        recording: &'a CalibrationRecording,
        steps: &'a [OdometryStep],
        line_observations: &'a [LineObservation],
        options: &Options,
    ) -> Self {
        let start = options.start_heading.map_or(0.0, |start| start.heading.radians());
        Self {
            data: FitData {
                steps,
                line_observations,
                wall_of: Vec::new(),
                headings: &recording.headings,
                tick: TAU / recording.ticks_per_turn,
            },
            trajectory: Trajectory::dead_reckoned(steps, &options.nominal, start),
            geometry: options.nominal,
            noise: NoiseLevels { delta: options.delta, wall: 1.0, compass: options.compass_std },
            nominal: options.nominal,
        }
    }

    /// Associates line observations with walls again, from the current trajectory.
    pub(super) fn associate(&mut self, thresholds: AssociationThresholds) {
        let (steps, line_observations) = (self.data.steps, self.data.line_observations);
        let (wall_of, walls) =
            associate(line_observations, steps, &self.trajectory, &self.geometry, thresholds);
        self.data.wall_of = wall_of;
        self.trajectory.walls = walls;
    }

    /// Takes Gauss–Newton steps until convergence. If `robust`, weights are robust from the first step;
    /// otherwise after the first `SETTLING` steps.
    pub(super) fn converge(&mut self, robust: bool) -> Result<(), CalibrationError> {
        let (mut before, mut damping) = (None, 1.0);
        for number in 0..STEPS {
            let linear = self.linear(robust || number >= SETTLING);
            let (mut a, b, reduced) = self.normal(&linear)?;
            let rough = !robust && number < SETTLING;
            if rough {
                // Latencies are held while walls are wrong by meters: residuals of that size bias them.
                for latency in LATENCIES {
                    a[(latency as usize, latency as usize)] += 1e12;
                }
            }
            let factor = a.clone().cholesky().ok_or(Singular)?;
            let mut step = factor.solve(&b);
            let covariance = factor.inverse();
            let size = self.size(&step, &covariance);
            if !step.iter().all(|change| change.is_finite()) {
                return Err(CalibrationError::Diverged);
            }
            // A latency is linear only within one step of the recording.
            let farthest = LATENCIES.iter().map(|latency| step[*latency as usize].abs()).fold(0.0, f64::max);
            step *= (LATENCY_REACH / farthest).min(1.0);
            // Limits the wheel separation, too: without turns in the recording the fit would drift.
            let wheel_separation = CalibrationParameter::WheelSeparation as usize;
            step *= (TRACK_REACH * self.geometry.0[wheel_separation] / step[wheel_separation].abs()).min(1.0);
            // A step against the previous one is an overshoot: the robust weights alternate, or the
            // likelihood is more curved in a latency than the normal matrix. Damping then ensures
            // convergence.
            let back = before.as_ref().is_some_and(|last: &DVector<f64>| last.dot(&(&a * &step)) < 0.0);
            damping = if back { damping * 0.5 } else { (damping * 1.2_f64).min(1.0) };
            step *= damping;
            before = Some(step.clone());
            self.trajectory = reduced.moved(&self.trajectory, &step);
            for (value, change) in self.geometry.0.iter_mut().zip(step.iter()) {
                *value += change;
            }
            if !self.is_sound() {
                return Err(CalibrationError::Diverged);
            }
            if size < CONVERGED && !rough {
                return Ok(());
            }
        }
        Err(CalibrationError::Unsettled)
    }

    /// Returns the maximum parameter change in standard errors; parameters that are not excited are ignored.
    fn size(&self, step: &DVector<f64>, covariance: &DMatrix<f64>) -> f64 {
        let excited = CalibrationParameter::ALL.into_iter().filter_map(|parameter| {
            let i = parameter as usize;
            let std = covariance[(i, i)].sqrt();
            parameter.is_excited(std, &self.nominal).then(|| (step[i] / std).abs())
        });
        excited.fold(0.0, f64::max)
    }

    /// Fits δ and the walls' scatter by restricted maximum likelihood, all other variables integrated out.
    /// [Harville1977]
    pub(super) fn fit_scatter(&mut self) -> Result<(), CalibrationError> {
        let linear = self.linear(true);
        for _ in 0..8 {
            let whole = 0..linear.len();
            let NoiseCurvature { slope: [d, w], curvature: [[dd, dw], [_, ww]] } =
                self.bend(|noise| self.likelihood(&linear, noise, whole.clone()))?;
            let determinant = dd * ww - dw * dw;
            let (by_d, by_w) = if dd > 0.0 && determinant > 0.0 {
                ((dw * w - ww * d) / determinant, (dw * d - dd * w) / determinant)
            } else {
                (-d.signum(), -w.signum())
            };
            self.noise.delta = (self.noise.delta * by_d.clamp(-1.0, 1.0).exp()).clamp(1e-8, 1.0);
            self.noise.wall = (self.noise.wall * by_w.clamp(-1.0, 1.0).exp()).clamp(1e-4, 1e6);
            if by_d.abs() < 0.01 && by_w.abs() < 0.01 {
                break;
            }
        }
        Ok(())
    }

    /// Computes gradient and Hessian of `likelihood` by ln δ and the logarithm of the walls' scatter, by
    /// finite differences.
    pub(super) fn bend(
        &self,
        likelihood: impl Fn(NoiseLevels) -> Result<f64, Singular>,
    ) -> Result<NoiseCurvature, Singular> {
        const H: f64 = 0.1;
        let at = |d: f64, w: f64| {
            let NoiseLevels { delta, wall, compass } = self.noise;
            likelihood(NoiseLevels { delta: delta * d.exp(), wall: wall * w.exp(), compass })
        };
        let middle = at(0.0, 0.0)?;
        let (d_up, d_down, w_up, w_down) = (at(H, 0.0)?, at(-H, 0.0)?, at(0.0, H)?, at(0.0, -H)?);
        let both = at(H, H)?;
        let mixed = (both - d_up - w_up + middle) / (H * H);
        Ok(NoiseCurvature {
            slope: [(d_up - d_down) / (2.0 * H), (w_up - w_down) / (2.0 * H)],
            curvature: [
                [(d_up + d_down - 2.0 * middle) / (H * H), mixed],
                [mixed, (w_up + w_down - 2.0 * middle) / (H * H)],
            ],
        })
    }

    /// −2 log likelihood of the scatter, with geometry, poses and walls integrated out.
    pub(super) fn likelihood(
        &self,
        linear: &Linear,
        noise: NoiseLevels,
        range: std::ops::Range<usize>,
    ) -> Result<f64, Singular> {
        let Reduced { mut a, mut b, misfit, .. } = linear.reduced(range, noise)?;
        self.add_prior(&mut a, &mut b);
        let factor = a.cholesky().ok_or(Singular)?;
        let spread: f64 = factor.l_dirty().diagonal().iter().map(|d| d.ln()).sum();
        Ok(misfit - b.dot(&factor.solve(&b)) + 2.0 * spread)
    }

    /// Linearizes the problem about the current estimate.
    pub(super) fn linear(&self, robust: bool) -> Linear {
        let mut linear = self.data.linear(&self.trajectory, &self.geometry);
        if robust {
            linear.weigh(self.noise);
        }
        linear
    }

    /// Returns normal matrix, right-hand side and reduced problem of the geometry, with the prior.
    pub(super) fn normal(&self, linear: &Linear) -> Result<(DMatrix<f64>, DVector<f64>, Reduced), Singular> {
        let whole = 0..linear.len();
        let reduced = linear.reduced(whole.clone(), self.noise)?;
        let (mut a, mut b) = (reduced.a.clone(), reduced.b.clone());
        let slopes =
            self.data.latency_slopes(linear, &self.trajectory, &self.geometry, self.noise, &[whole])?;
        for latency in LATENCIES {
            b[latency as usize] = -slopes.iter().map(|slope| slope[latency as usize]).sum::<f64>();
        }
        self.add_prior(&mut a, &mut b);
        Ok((a, b, reduced))
    }

    /// Adds the prior of the geometry.
    pub(super) fn add_prior(&self, a: &mut DMatrix<f64>, b: &mut DVector<f64>) {
        for parameter in CalibrationParameter::ALL {
            let i = parameter as usize;
            let information = 1.0 / parameter.prior_std(&self.nominal).powi(2);
            a[(i, i)] += information;
            b[i] -= information * (self.geometry.0[i] - self.nominal.0[i]);
        }
    }

    /// Returns whether the geometry is plausible for a robot.
    fn is_sound(&self) -> bool {
        let positive = [
            CalibrationParameter::LeftWheelRadius,
            CalibrationParameter::RightWheelRadius,
            CalibrationParameter::WheelSeparation,
        ];
        positive.iter().all(|parameter| self.geometry.get(*parameter) > 0.0)
            && self.geometry.0.iter().all(|value| value.is_finite())
    }
}
