//! Subscribes to velocity commands, as `TwistStamped` or as `Twist`.

use futures::stream::{LocalBoxStream, StreamExt};
use ros2_client::{Node, Subscription};
use surepose::kinematics::Twist;

use crate::dds::{NodeError, reliable, subscribe};
use crate::message::{self, TwistStamped};
use crate::names::Names;
use crate::velocity::{BARE, NAME, STAMPED};

/// Subscription to velocity commands.
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

    /// Stream of commands; undecodable messages are skipped.
    pub(crate) fn twists(&self) -> LocalBoxStream<'_, Twist<f64>> {
        let plane = |twist: &message::Twist| {
            let twist = Twist::new(twist.linear.x, twist.angular.z);
            (twist.v.is_finite() && twist.omega.is_finite()).then_some(twist)
        };
        let known = futures::future::ready;
        match self {
            Self::Stamped(subscription) => subscription
                .async_stream()
                .filter_map(move |command| known(command.ok().and_then(|(stamped, _)| plane(&stamped.twist))))
                .boxed_local(),
            Self::Bare(subscription) => subscription
                .async_stream()
                .filter_map(move |command| known(command.ok().and_then(|(twist, _)| plane(&twist))))
                .boxed_local(),
        }
    }
}
