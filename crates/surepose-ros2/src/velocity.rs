//! Publishes velocity commands, as `TwistStamped` or as `Twist`.

use ros2_client::{Node, Publisher};
use surepose::kinematics::Twist;
use surepose::time::Stamp;

use crate::convert::{header, twist_message};
use crate::dds::{NodeError, advertise, publish_result, reliable};
use crate::message::{self, TwistStamped};
use crate::names::Names;

pub(crate) const NAME: &str = "cmd_vel";
pub(crate) const STAMPED: (&str, &str) = ("geometry_msgs", "TwistStamped");
pub(crate) const BARE: (&str, &str) = ("geometry_msgs", "Twist");

/// Publisher of velocity commands.
pub(crate) enum CmdVelPublisher {
    Stamped(Publisher<TwistStamped>),
    Bare(Publisher<message::Twist>),
}

impl CmdVelPublisher {
    pub(crate) fn new(node: &mut Node, names: &Names, stamped: bool) -> Result<Self, NodeError> {
        let name = names.of(NAME)?;
        Ok(if stamped {
            Self::Stamped(advertise(node, &name, STAMPED, reliable(1))?)
        } else {
            Self::Bare(advertise(node, &name, BARE, reliable(1))?)
        })
    }

    /// Publishes a twist of the body with the frame `base`.
    pub(crate) fn command(&self, stamp: Stamp, base: &str, twist: Twist<f64>) {
        let twist = twist_message(twist);
        match self {
            Self::Stamped(stamped) => {
                publish_result(stamped.publish(TwistStamped { header: header(stamp, base), twist }));
            }
            Self::Bare(bare) => publish_result(bare.publish(twist)),
        }
    }
}
