//! Options that many commands share: the configuration.

use std::path::PathBuf;

use clap::Args;
use surepose_data::Config;

use crate::failure::Failure;

/// Where the configuration comes from.
#[derive(Clone, Debug, Default, Args)]
pub(crate) struct ConfigArgs {
    /// A TOML file with parameters; the others keep their defaults
    #[arg(long, value_name = "FILE")]
    pub(crate) config: Option<PathBuf>,

    /// One parameter, over the file's: law.k_v=3. May be repeated
    #[arg(long, value_name = "SECTION.KEY=VALUE")]
    pub(crate) set: Vec<String>,
}

impl ConfigArgs {
    /// `base`, with the file's values and the options' over it.
    pub(crate) fn over(&self, base: Config) -> Result<Config, Failure> {
        let mut config = base;
        if let Some(file) = &self.config {
            config = config.with_file(file)?;
        }
        for option in &self.set {
            config = config.with_option(option)?;
        }
        Ok(config)
    }
}
