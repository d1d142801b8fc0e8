//! Tests node and simulated robot over DDS on the loopback interface, as a client of the action and the topics.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "tests panic on failed preconditions"
)]

use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use futures::future::{Either, select};
use futures::{StreamExt, pin_mut};
use ros2_client::action::{ActionClient, ActionClientQosPolicies};
use ros2_client::action_msgs::GoalStatusEnum;
use ros2_client::qos::{Durability, History, QosProfile, Reliability, WhenFull};
use ros2_client::{
    ActionTypeName, MessageTypeName, Name, Node, NodeName, NodeOptions, ServiceMapping, Subscription,
};
use surepose::geometry::{Angle, Goal, Map, Pose};
use surepose::param;
use surepose_ros2::convert::{header, pose_message, pose_of};
use surepose_ros2::message::{
    NavigateToPoseFeedback, NavigateToPoseGoal, NavigateToPoseResult, PoseStamped, TwistStamped,
};
use surepose_ros2::network::Network;
use surepose_ros2::node::{self, NodeSettings};
use surepose_ros2::robot::{self, RobotSettings};
use surepose_ros2::{Names, NodeDriverSettings};
use surepose_sim::robot::Scenario;

type Client = ActionClient<NavigateToPoseGoal, NavigateToPoseResult, NavigateToPoseFeedback>;

static STOP: AtomicBool = AtomicBool::new(false);

fn stops() -> bool {
    STOP.load(Ordering::Relaxed)
}

/// Domain that a concurrent run of this test is unlikely to use.
fn network() -> Network {
    Network { domain: 60 + (std::process::id() % 40) as u16, local: true }
}

fn reliable() -> QosProfile {
    QosProfile {
        reliability: Reliability::Reliable { when_full: WhenFull::DEFAULT },
        durability: Durability::Volatile,
        history: History::KeepLast { depth: 10 },
        ..QosProfile::publisher_default()
    }
}

/// Robot whose laser pose is known only from its `/tf_static`.
fn settings() -> (RobotSettings, NodeSettings) {
    let driver = NodeDriverSettings::in_scenario(&Scenario::default());
    let laser_extrinsics = [(&param::LASER_X, 0.15), (&param::LASER_Y, -0.05), (&param::LASER_HEADING, 30.0)];
    let scenario = Scenario::configured(driver.config.clone().with_preset("mounting", &laser_extrinsics));
    let (names, map_frame, stamped) = (Names::new("robot1", &[]).unwrap(), "map".to_owned(), true);
    let network = network();
    let node = NodeSettings {
        driver,
        names: names.clone(),
        map_frame: map_frame.clone(),
        stamped,
        network,
        warnings: vec![],
        recorder: None,
    };
    (RobotSettings { scenario, seed: 3, names, stamped, map_frame, network }, node)
}

fn subscribe<M: 'static>(node: &mut Node, name: &str, kind: &str) -> Subscription<M> {
    let name = Name::new("/robot1", name).unwrap();
    let topic = node.create_topic(&name, MessageTypeName::new("geometry_msgs", kind), &reliable()).unwrap();
    node.create_subscription(&topic, Some(reliable())).unwrap()
}

fn request(x: f64, y: f64, degrees: f64, frame: &str) -> NavigateToPoseGoal {
    let goal: Pose<Map, Goal, f64> = Pose::new(x, y, Angle::from_degrees(degrees));
    let pose =
        PoseStamped { header: header(surepose::time::Stamp::default(), frame), pose: pose_message(goal) };
    NavigateToPoseGoal { pose, behavior_tree: String::new() }
}

/// Output of `future`; `None` after `seconds`.
async fn within<T>(seconds: u64, future: impl Future<Output = T>) -> Option<T> {
    pin_mut!(future);
    match select(future, smol::Timer::after(Duration::from_secs(seconds))).await {
        Either::Left((value, _)) => Some(value),
        Either::Right(_) => None,
    }
}

/// Requests a goal until the server answers: requests during discovery can be lost.
async fn ask(client: &Client, goal: NavigateToPoseGoal) -> (ros2_client::action::GoalId, bool) {
    for _ in 0..20 {
        if let Some(Ok((id, answer))) = within(2, client.async_send_goal(goal.clone())).await {
            return (id, answer.accepted);
        }
    }
    panic!("the node does not answer");
}

#[test]
fn action_client_parks_the_simulated_robot() {
    let (robot, node) = settings();
    let robot = thread::spawn(move || robot::run(&robot, stops).unwrap());
    let node = thread::spawn(move || {
        let mut said = Vec::new();
        node::run(node, stops, |line| said.push(line.to_owned())).unwrap();
        said
    });
    let context = network().join().unwrap();
    let mut tester = context
        .new_node(NodeName::new("/", "tester").unwrap(), NodeOptions::new().enable_rosout(false))
        .unwrap();
    let client: Client = tester
        .create_action_client(
            ServiceMapping::Enhanced,
            &Name::new("/robot1", "navigate_to_pose").unwrap(),
            &ActionTypeName::new("nav2_msgs", "NavigateToPose"),
            ActionClientQosPolicies {
                goal_service: reliable(),
                result_service: reliable(),
                cancel_service: reliable(),
                feedback_subscription: reliable(),
                status_subscription: QosProfile { durability: Durability::TransientLocal, ..reliable() },
            },
        )
        .unwrap();
    let truth = subscribe::<PoseStamped>(&mut tester, "truth", "PoseStamped");
    let commands = subscribe::<TwistStamped>(&mut tester, "cmd_vel", "TwistStamped");
    let spinner = tester.spinner().unwrap();
    let spinning = smol::spawn(async move { spinner.spin().await });

    smol::block_on(async {
        assert!(!ask(&client, request(2.0, 2.0, 30.0, "odom")).await.1, "a goal in another frame");
        // Goals that the walls rule out end with the reason: outside of the room, and 8 cm from a wall.
        for (x, y) in [(50.0, 0.0), (4.42, 1.0)] {
            let (id, accepted) = ask(&client, request(x, y, 0.0, "map")).await;
            assert!(accepted);
            let (status, result) = within(10, client.async_request_result(id)).await.unwrap().unwrap();
            assert_eq!(status, GoalStatusEnum::Aborted);
            assert!(result.error_msg.starts_with("wall"), "{}", result.error_msg);
        }

        // A canceled goal ends as canceled, and the wheels stop.
        let (id, accepted) = ask(&client, request(2.0, 2.0, 30.0, "map")).await;
        assert!(accepted);
        smol::Timer::after(Duration::from_secs(2)).await;
        within(5, client.async_cancel_goal(id, ros2_client::builtin_interfaces::Time::ZERO))
            .await
            .unwrap()
            .unwrap();
        let (status, _) = within(10, client.async_request_result(id)).await.unwrap().unwrap();
        assert_eq!(status, GoalStatusEnum::Canceled);

        // The next goal is reached, with feedback.
        let (id, accepted) = ask(&client, request(2.0, 2.0, 60.0, "map")).await;
        assert!(accepted);
        let feedback = client.feedback_stream(id);
        pin_mut!(feedback);
        let first = within(5, feedback.next()).await.unwrap().unwrap().unwrap();
        assert!(first.distance_remaining > 0.5 && first.distance_remaining < 4.0);
        let (status, result) = within(60, client.async_request_result(id)).await.unwrap().unwrap();
        assert_eq!((status, result.error_code), (GoalStatusEnum::Succeeded, 0), "{}", result.error_msg);
    });

    let mut last_truth = None;
    while let Ok(Some((pose, _))) = truth.take() {
        last_truth = Some(pose);
    }
    let parked: Pose<Map, Goal, f64> =
        pose_of(&last_truth.expect("the robot publishes its true pose").pose).unwrap();
    let goal: Pose<Map, Goal, f64> = Pose::new(2.0, 2.0, Angle::from_degrees(60.0));
    assert!(parked.origin().distance(goal.origin()) < 0.01, "{parked:?}");
    assert!((parked.heading - goal.heading).degrees().abs() < 1.0, "{parked:?}");
    let mut last_command = None;
    while let Ok(Some((command, _))) = commands.take() {
        last_command = Some(command.twist);
    }
    let twist = last_command.expect("the node publishes commands");
    assert_eq!((twist.linear.x, twist.angular.z), (0.0, 0.0), "the last command is to rest");

    STOP.store(true, Ordering::Relaxed);
    let said = node.join().unwrap();
    robot.join().unwrap();
    assert!(said.iter().any(|line| line.starts_with("rests ")), "{said:?}");
    let sits = "the laser 'laser' sits on 'base_link' at (0.150, -0.050) facing 30.0°, by /tf_static";
    assert!(said.iter().any(|line| line == sits), "{said:?}");
    drop((tester, spinning));
}
