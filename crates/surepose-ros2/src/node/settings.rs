//! Settings of the node.

use surepose_recorder::RecorderHandle;

use crate::driver::NodeDriverSettings;
use crate::names::Names;
use crate::network::Network;

/// Configures a node.
#[derive(Clone, Debug)]
pub struct NodeSettings {
    /// Settings of the driver.
    pub driver: NodeDriverSettings,
    /// Names of its topics, services and actions.
    pub names: Names,
    /// The frame of the map.
    pub map_frame: String,
    /// Whether `cmd_vel` is a `TwistStamped`, as since Jazzy, or a `Twist`.
    pub stamped: bool,
    /// The network.
    pub network: Network,
    /// Warnings about the configuration, published in the diagnostics: that it is not certified, for example.
    pub warnings: Vec<String>,
    /// Recorder of the driver, whose session is [`NodeDriverSettings::session`]; `None` records nothing.
    pub recorder: Option<RecorderHandle>,
}
