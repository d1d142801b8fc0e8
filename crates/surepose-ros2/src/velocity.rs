//! Velocity commands, in the two ways in which robots take them.

use futures::stream::{LocalBoxStream, StreamExt};
use ros2_client::{Node, Publisher, Subscription};
use surepose::kinematics::Twist;
use surepose::time::Stamp;

use crate::convert::{header, twist_message};
use crate::dds::{NodeError, advertise, publish_result, reliable, subscribe};
use crate::message::{self, TwistStamped};
use crate::names::Names;

const NAME: &str = "cmd_vel";
const STAMPED: (&str, &str) = ("geometry_msgs", "TwistStamped");
const BARE: (&str, &str) = ("geometry_msgs", "Twist");

/// Gives commands.
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

    /// How the body with the frame `base` shall move.
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

/// Takes commands.
pub(crate) enum CmdVelSubscriber {
    Stamped(Subscription<TwistStamped>),
    Bare(Subscription<message::Twist>),
}

impl CmdVelSubscriber {
    pub(crate) fn new(node: &mut Node, names: &Names, stamped: bool) -> Result<Self, NodeError> {
        let name = names.of(NAME)?;
        Ok(if stamped {
            Self::Stamped(subscribe(node, &name, STAMPED, reliable(1))?)
        } else {
            Self::Bare(subscribe(node, &name, BARE, reliable(1))?)
        })
    }

    /// Commands as they come; what is none is left out.
    pub(crate) fn twists(&self) -> LocalBoxStream<'_, Twist<f64>> {
        let plane = |twist: &message::Twist| {
            let twist = Twist::new(twist.linear.x, twist.angular.z);
            (twist.v.is_finite() && twist.omega.is_finite()).then_some(twist)
        };
        let known = futures::future::ready;
        match self {
            Self::Stamped(heard) => heard
                .async_stream()
                .filter_map(move |command| known(command.ok().and_then(|(stamped, _)| plane(&stamped.twist))))
                .boxed_local(),
            Self::Bare(heard) => heard
                .async_stream()
                .filter_map(move |command| known(command.ok().and_then(|(twist, _)| plane(&twist))))
                .boxed_local(),
        }
    }
}
