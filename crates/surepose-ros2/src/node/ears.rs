//! What the node hears, as one stream of events.

use std::time::Duration;

use futures::stream::{self, FusedStream, LocalBoxStream, StreamExt};
use ros2_client::{Node, RmwRequestId, Server, ServiceMapping, ServiceTypeName, Subscription};
use serde::de::DeserializeOwned;

use crate::message::{Empty, Imu, LaserScan, Odometry, PoseStamped, PoseWithCovarianceStamped, TfMessage};

use crate::wire::{NodeError, everywhere, hear, latched, refused, reliable, sensor};

use super::NodeSettings;
use super::action::{CancelRequest, NewGoal, Served, cancels, goals};

/// Something happened.
pub(super) enum Event {
    Odometry(Box<Odometry>),
    Scan(LaserScan),
    /// How frames that do not move sit on others.
    Joints(TfMessage),
    Imu(Box<Imu>),
    Goal(PoseStamped),
    Told(Box<PoseWithCovarianceStamped>),
    /// Somebody asks the robot to find out where it is.
    Lose(RmwRequestId),
    NewGoal(NewGoal),
    Cancel(CancelRequest),
    /// Time passed.
    Beat,
    /// A message on this topic is not what its type says.
    Unreadable(&'static str),
}

/// Subscriptions and the service.
pub(super) struct Ears {
    odometry: Subscription<Odometry>,
    scans: Option<Subscription<LaserScan>>,
    joints: Option<Subscription<TfMessage>>,
    imu: Option<Subscription<Imu>>,
    goals: Subscription<PoseStamped>,
    told: Subscription<PoseWithCovarianceStamped>,
    lose: Server<Empty, Empty>,
}

impl Ears {
    pub(super) fn new(node: &mut Node, settings: &NodeSettings) -> Result<Self, NodeError> {
        let names = &settings.names;
        let lose = names.of("reinitialize_global_localization")?;
        let service = ServiceTypeName::new("std_srvs", "Empty");
        let (request, answer) = (reliable(10), reliable(10));
        Ok(Self {
            odometry: hear(node, &names.of("odom")?, ("nav_msgs", "Odometry"), sensor(50))?,
            scans: match &settings.pilot.map {
                Some(_) => Some(hear(node, &names.of("scan")?, ("sensor_msgs", "LaserScan"), sensor(5))?),
                None => None,
            },
            joints: match &settings.pilot.map {
                Some(_) => {
                    Some(hear(node, &everywhere("tf_static")?, ("tf2_msgs", "TFMessage"), latched(100))?)
                }
                None => None,
            },
            imu: if settings.pilot.compass {
                Some(hear(node, &names.of("imu")?, ("sensor_msgs", "Imu"), sensor(50))?)
            } else {
                None
            },
            goals: hear(node, &names.of("goal_pose")?, ("geometry_msgs", "PoseStamped"), reliable(1))?,
            told: hear(
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

    /// All that happens, in the order in which it does.
    pub(super) fn events<'a>(
        &'a self,
        action: &'a Served,
        beat: Duration,
    ) -> impl FusedStream<Item = Event> + 'a {
        let lose = self.lose.receive_request_stream().map(|request| match request {
            Ok((id, _)) => Event::Lose(id),
            Err(_) => Event::Unreadable("reinitialize_global_localization"),
        });
        let unreadable = || Event::Unreadable("navigate_to_pose");
        let goals = goals(action).map(move |goal| goal.map_or_else(|_| unreadable(), Event::NewGoal));
        let cancels = cancels(action).map(move |cancel| cancel.map_or_else(|_| unreadable(), Event::Cancel));
        let beats = smol::Timer::interval(beat).map(|_| Event::Beat);
        let mut all: Vec<LocalBoxStream<'a, Event>> = vec![
            on("odom", &self.odometry, |odometry| Event::Odometry(Box::new(odometry))),
            on("goal_pose", &self.goals, Event::Goal),
            on("initialpose", &self.told, |told| Event::Told(Box::new(told))),
            lose.boxed_local(),
            goals.boxed_local(),
            cancels.boxed_local(),
            beats.boxed_local(),
        ];
        all.extend(self.scans.as_ref().map(|scans| on("scan", scans, Event::Scan)));
        all.extend(self.joints.as_ref().map(|joints| on("tf_static", joints, Event::Joints)));
        all.extend(self.imu.as_ref().map(|imu| on("imu", imu, |imu| Event::Imu(Box::new(imu)))));
        stream::select_all(all)
    }

    /// Tells who asked that it was heard.
    pub(super) fn answer(&self, request: RmwRequestId) {
        // Who does not wait for the answer gets none.
        let _sent = self.lose.send_response(request, Empty { structure_needs_at_least_one_member: 0 });
    }
}

fn on<'a, M: DeserializeOwned + 'static>(
    topic: &'static str,
    heard: &'a Subscription<M>,
    event: impl Fn(M) -> Event + 'a,
) -> LocalBoxStream<'a, Event> {
    let stream = heard.async_stream().map(move |message| match message {
        Ok((message, _)) => event(message),
        Err(_) => Event::Unreadable(topic),
    });
    stream.boxed_local()
}
