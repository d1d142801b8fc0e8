//! Topics: how they are heard and spoken on, and what goes wrong with that.

use ros2_client::qos::{Durability, History, QosProfile, Reliability, WhenFull};
use ros2_client::{
    Context, MessageTypeName, Name, Node, NodeName, NodeOptions, Publisher, Subscription, WriteError,
};
use serde::Serialize;
use smol::Task;

use crate::names::{NameProblem, Names};
use crate::network::NetworkError;

/// Why a node does not run.
#[derive(Debug, thiserror::Error)]
pub enum NodeError {
    /// There is no network.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// A name is none.
    #[error(transparent)]
    Name(#[from] NameProblem),
    /// The middleware refuses something that the node needs.
    #[error("the middleware refuses {what}: {why}")]
    Middleware {
        /// What was asked for.
        what: String,
        /// What it says.
        why: String,
    },
}

pub(crate) fn refused(what: &str, why: impl std::fmt::Debug) -> NodeError {
    NodeError::Middleware { what: what.to_owned(), why: format!("{why:?}") }
}

/// A node of this name in the namespace of `names`.
pub(crate) fn node(
    context: &Context,
    names: &Names,
    name: &str,
    options: NodeOptions,
) -> Result<Node, NodeError> {
    let named = NodeName::new(names.namespace(), name).map_err(|why| refused(name, why))?;
    context.new_node(named, options).map_err(|why| refused(name, why))
}

/// What a node does in the background, as long as this is kept.
pub(crate) fn spinning(node: &mut Node) -> Result<Task<()>, NodeError> {
    let spinner = node.spinner().map_err(|why| refused("a spinner", why))?;
    Ok(smol::spawn(async move {
        // It ends with the node.
        let _ended = spinner.spin().await;
    }))
}

/// Reliable, and for whoever is there. Who does not read in time misses something: the loop waits for nobody.
pub(crate) fn reliable(depth: usize) -> QosProfile {
    QosProfile {
        reliability: Reliability::Reliable { when_full: WhenFull::Fail },
        durability: Durability::Volatile,
        history: History::KeepLast { depth },
        ..QosProfile::publisher_default()
    }
}

/// Reliable, and for whoever comes later, too.
pub(crate) fn latched(depth: usize) -> QosProfile {
    QosProfile { durability: Durability::TransientLocal, ..reliable(depth) }
}

/// As sensors send; who listens so hears those that send reliably as well.
pub(crate) fn sensor(depth: usize) -> QosProfile {
    QosProfile { history: History::KeepLast { depth }, ..QosProfile::subscription_default() }
}

/// Listens to a topic of messages of a package's type.
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

/// Speaks on a topic, in messages of a package's type.
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

/// A name that is by convention the same for all robots.
pub(crate) fn global_name(name: &str) -> Result<Name, NodeError> {
    Name::new("/", name).map_err(|why| refused(name, why))
}

/// What was published was published: who does not read in time misses a message, and the next one says it better.
pub(crate) fn publish_result<T, E>(result: Result<T, WriteError<E>>) {
    drop(result);
}
