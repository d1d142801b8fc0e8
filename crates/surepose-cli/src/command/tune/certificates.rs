//! Certificates for a search: one for each law, and none that the user does not wait for.

use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use surepose::control::Law;
use surepose_cert::NoiseBounds;
use surepose_config::Config;

use crate::certification::{self, CertifiedBounds};
use crate::interrupt;

/// How often is looked whether a certificate is there.
const LOOK: Duration = Duration::from_millis(10);

/// What is certified of the configured loop, with one law or another.
pub(super) struct Certificates<'a> {
    config: &'a Config,
    noise: NoiseBounds,
    known: Mutex<Vec<(Law<f64>, Option<CertifiedBounds>)>>,
}

impl<'a> Certificates<'a> {
    /// Those for these noise bounds.
    pub(super) fn new(config: &'a Config, noise: NoiseBounds) -> Self {
        Self { config, noise, known: Mutex::default() }
    }

    /// What is bounded with this law; nothing where its certificate is refused, or the user asks to stop before it is there.
    pub(super) fn bounds(&self, law: &Law<f64>) -> Option<CertifiedBounds> {
        let known = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let found = known().iter().find(|(it, _)| it == law).map(|(_, bounds)| *bounds);
        if let Some(bounds) = found {
            return bounds;
        }
        let (config, noise, law) = (self.config.clone(), self.noise, *law);
        // A certificate takes a second or more, and cannot be stopped: one that nobody waits for ends with the program.
        let asked = thread::spawn(move || certification::bounds(&config, &law, noise));
        while !asked.is_finished() {
            if interrupt::asked() {
                return None;
            }
            thread::sleep(LOOK);
        }
        // A thread that panicked has said so.
        let bounds = asked.join().ok()?;
        known().push((law, bounds));
        bounds
    }
}
