//! DDS topics: publishers, subscriptions, quality of service and errors.

use ros2_client::qos::{Durability, History, QosProfile, Reliability, WhenFull};
use ros2_client::{
    Context, MessageTypeName, Name, Node, NodeName, NodeOptions, Publisher, Subscription, WriteError,
};
use serde::Serialize;
use smol::Task;

use crate::names::{NameProblem, Names};
use crate::network::NetworkError;

/// Error that stops a node.
#[derive(Debug, thiserror::Error)]
pub enum NodeError {
    /// The network is unavailable.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// A name is invalid.
    #[error(transparent)]
    Name(#[from] NameProblem),
    /// The middleware cannot create an entity.
    #[error("middleware: cannot create {what}: {why}")]
    Middleware {
        /// Entity.
        what: String,
        /// Error of the middleware.
        why: String,
    },
}

pub(crate) fn refused(what: &str, why: impl std::fmt::Debug) -> NodeError {
    NodeError::Middleware { what: what.to_owned(), why: format!("{why:?}") }
}

/// Creates a node in the namespace of `names`.
pub(crate) fn node(
    context: &Context,
    names: &Names,
    name: &str,
    options: NodeOptions,
) -> Result<Node, NodeError> {
    let named = NodeName::new(names.namespace(), name).map_err(|why| refused(name, why))?;
    context.new_node(named, options).map_err(|why| refused(name, why))
}

/// Runs the node's background task until the result is dropped.
pub(crate) fn spinning(node: &mut Node) -> Result<Task<()>, NodeError> {
    let spinner = node.spinner().map_err(|why| refused("a spinner", why))?;
    Ok(smol::spawn(async move {
        // The task ends with the node.
        let _ended = spinner.spin().await;
    }))
}

/// Reliable and volatile. A slow subscriber loses messages, because the loop does not block.
pub(crate) fn reliable(depth: usize) -> QosProfile {
    QosProfile {
        reliability: Reliability::Reliable { when_full: WhenFull::Fail },
        durability: Durability::Volatile,
        history: History::KeepLast { depth },
        ..QosProfile::publisher_default()
    }
}

/// Reliable and transient local, for late subscribers.
pub(crate) fn latched(depth: usize) -> QosProfile {
    QosProfile { durability: Durability::TransientLocal, ..reliable(depth) }
}

/// Best effort, for sensor topics; also matches reliable publishers.
pub(crate) fn sensor(depth: usize) -> QosProfile {
    QosProfile { history: History::KeepLast { depth }, ..QosProfile::subscription_default() }
}

/// Subscribes to a topic.
pub(crate) fn subscribe<M: 'static>(
    node: &mut Node,
    name: &Name,
    (package, kind): (&str, &str),
    qos: QosProfile,
) -> Result<Subscription<M>, NodeError> {
    let refused = |why| refused(&format!("a subscription of {name}"), why);
    let topic = node.create_topic(name, MessageTypeName::new(package, kind), &qos).map_err(refused)?;
    node.create_subscription(&topic, Some(qos)).map_err(refused)
}

/// Creates a publisher on a topic.
pub(crate) fn advertise<M: Serialize>(
    node: &mut Node,
    name: &Name,
    (package, kind): (&str, &str),
    qos: QosProfile,
) -> Result<Publisher<M>, NodeError> {
    let refused = |why| refused(&format!("a publisher of {name}"), why);
    let topic = node.create_topic(name, MessageTypeName::new(package, kind), &qos).map_err(refused)?;
    node.create_publisher(&topic, Some(qos)).map_err(refused)
}

/// Ignores the result of publishing: the next message replaces a lost one.
pub(crate) fn publish_result<T, E>(result: Result<T, WriteError<E>>) {
    drop(result);
}
