//! Subscriptions of the node, merged into one stream of events.

use std::time::Duration;

use futures::stream::{self, FusedStream, LocalBoxStream, StreamExt};
use ros2_client::{Node, RmwRequestId, Server, ServiceMapping, ServiceTypeName, Subscription};
use serde::de::DeserializeOwned;

use crate::dds::{NodeError, latched, refused, reliable, sensor, subscribe};
use crate::message::{Empty, Imu, LaserScan, Odometry, PoseStamped, PoseWithCovarianceStamped, TfMessage};

use super::action::{CancelRequest, NewGoal, Served, cancels, goals};
use super::settings::NodeSettings;

/// Event that the node handles.
pub(super) enum NodeEvent {
    Odometry(Box<Odometry>),
    Scan(LaserScan),
    /// Static transforms.
    StaticTransforms(TfMessage),
    Imu(Box<Imu>),
    Goal(PoseStamped),
    InitialPose(Box<PoseWithCovarianceStamped>),
    /// Request for global localization.
    GlobalLocalization(RmwRequestId),
    ActionGoal(NewGoal),
    Cancel(CancelRequest),
    /// Period of the timer.
    Timer,
    /// Message on this topic that cannot be decoded.
    Unreadable(&'static str),
}

/// Subscriptions and the service.
pub(super) struct Subscriptions {
    odometry: Subscription<Odometry>,
    scans: Option<Subscription<LaserScan>>,
    static_transforms: Option<Subscription<TfMessage>>,
    imu: Option<Subscription<Imu>>,
    goals: Subscription<PoseStamped>,
    told: Subscription<PoseWithCovarianceStamped>,
    lose: Server<Empty, Empty>,
}

impl Subscriptions {
    pub(super) fn new(node: &mut Node, settings: &NodeSettings) -> Result<Self, NodeError> {
        let names = &settings.names;
        let lose = names.of("reinitialize_global_localization")?;
        let service = ServiceTypeName::new("std_srvs", "Empty");
        let (request, answer) = (reliable(10), reliable(10));
        Ok(Self {
            odometry: subscribe(node, &names.of("odom")?, ("nav_msgs", "Odometry"), sensor(50))?,
            scans: match &settings.driver.map {
                Some(_) => {
                    Some(subscribe(node, &names.of("scan")?, ("sensor_msgs", "LaserScan"), sensor(5))?)
                }
                None => None,
            },
            static_transforms: if settings.driver.map.is_some() || settings.driver.hears_imu() {
                let name = names.of("tf_static")?;
                Some(subscribe(node, &name, ("tf2_msgs", "TFMessage"), latched(100))?)
            } else {
                None
            },
            imu: if settings.driver.hears_imu() {
                Some(subscribe(node, &names.of("imu")?, ("sensor_msgs", "Imu"), sensor(50))?)
            } else {
                None
            },
            goals: subscribe(node, &names.of("goal_pose")?, ("geometry_msgs", "PoseStamped"), reliable(1))?,
            told: subscribe(
                node,
                &names.of("initialpose")?,
                ("geometry_msgs", "PoseWithCovarianceStamped"),
                reliable(1),
            )?,
            lose: node
                .create_server(ServiceMapping::Enhanced, &lose, &service, request, answer)
                .map_err(|error| refused("a service", error))?,
        })
    }

    /// Merges all events in the order of arrival.
    pub(super) fn events<'a>(
        &'a self,
        action: &'a Served,
        timer: Duration,
    ) -> impl FusedStream<Item = NodeEvent> + 'a {
        let lose = self.lose.receive_request_stream().map(|request| match request {
            Ok((id, _)) => NodeEvent::GlobalLocalization(id),
            Err(_) => NodeEvent::Unreadable("reinitialize_global_localization"),
        });
        let unreadable = || NodeEvent::Unreadable("navigate_to_pose");
        let goals = goals(action).map(move |goal| goal.map_or_else(|_| unreadable(), NodeEvent::ActionGoal));
        let cancels =
            cancels(action).map(move |cancel| cancel.map_or_else(|_| unreadable(), NodeEvent::Cancel));
        let timer_ticks = smol::Timer::interval(timer).map(|_| NodeEvent::Timer);
        let mut all: Vec<LocalBoxStream<'a, NodeEvent>> = vec![
            on("odom", &self.odometry, |odometry| NodeEvent::Odometry(Box::new(odometry))),
            on("goal_pose", &self.goals, NodeEvent::Goal),
            on("initialpose", &self.told, |told| NodeEvent::InitialPose(Box::new(told))),
            lose.boxed_local(),
            goals.boxed_local(),
            cancels.boxed_local(),
            timer_ticks.boxed_local(),
        ];
        all.extend(self.scans.as_ref().map(|scans| on("scan", scans, NodeEvent::Scan)));
        all.extend(
            self.static_transforms
                .as_ref()
                .map(|static_transforms| on("tf_static", static_transforms, NodeEvent::StaticTransforms)),
        );
        all.extend(self.imu.as_ref().map(|imu| on("imu", imu, |imu| NodeEvent::Imu(Box::new(imu)))));
        stream::select_all(all)
    }

    /// Answers a request for global localization.
    pub(super) fn answer(&self, request: RmwRequestId) {
        // A client that no longer waits receives no answer.
        let _sent = self.lose.send_response(request, Empty { structure_needs_at_least_one_member: 0 });
    }
}

fn on<'a, M: DeserializeOwned + 'static>(
    topic: &'static str,
    subscription: &'a Subscription<M>,
    event: impl Fn(M) -> NodeEvent + 'a,
) -> LocalBoxStream<'a, NodeEvent> {
    let stream = subscription.async_stream().map(move |message| match message {
        Ok((message, _)) => event(message),
        Err(_) => NodeEvent::Unreadable(topic),
    });
    stream.boxed_local()
}
