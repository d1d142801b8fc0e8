//! Caches certificates during a search, and abandons them on Ctrl-C.

use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use surepose::control::Law;
use surepose_cert::NoiseBounds;
use surepose_config::Config;

use crate::certification::{self, BaseDelay, CertifiedBounds};
use crate::interrupt;

/// Interval at which the completion of a certificate is checked.
const LOOK: Duration = Duration::from_millis(10);

/// Certificates of the configured loop, by control law.
pub(super) struct Certificates<'a> {
    config: &'a Config,
    noise: NoiseBounds,
    known: Mutex<Vec<(Law<f64>, Option<CertifiedBounds>)>>,
}

impl<'a> Certificates<'a> {
    /// Creates an empty cache for these noise bounds.
    pub(super) fn new(config: &'a Config, noise: NoiseBounds) -> Self {
        let noise = certification::with_actuators(config, noise, BaseDelay::Configured);
        Self { config, noise, known: Mutex::default() }
    }

    /// Returns the certified bounds for this law; `None` if the certificate is refused or the user interrupts.
    pub(super) fn bounds(&self, law: &Law<f64>) -> Option<CertifiedBounds> {
        let known = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let found = known().iter().find(|(it, _)| it == law).map(|(_, bounds)| *bounds);
        if let Some(bounds) = found {
            return bounds;
        }
        let (config, noise, law) = (self.config.clone(), self.noise, *law);
        // A certificate takes a second or more and cannot be canceled. An abandoned thread ends with the process.
        let asked = thread::spawn(move || certification::bounds(&config, &law, noise));
        while !asked.is_finished() {
            if interrupt::asked() {
                return None;
            }
            thread::sleep(LOOK);
        }
        // A panic in the thread has already been reported.
        let bounds = asked.join().ok()?;
        known().push((law, bounds));
        bounds
    }
}
