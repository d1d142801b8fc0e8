//! The action `navigate_to_pose`: goals with feedback, a result and a way to call them off.

use std::sync::Arc;
use std::time::Duration;

use futures::future::{Either, LocalBoxFuture, select};
use futures::stream::{Stream, StreamExt, unfold};
use futures::{FutureExt, pin_mut};
use ros2_client::action::{
    ActionServerQosPolicies, AsyncActionServer, CancelHandle, ExecutingGoalHandle, GoalEndStatus,
    NewGoalHandle,
};
use ros2_client::builtin_interfaces::Duration as RosDuration;
use ros2_client::{ActionTypeName, Node, ReadResult, ServiceMapping};
use surepose::navigator::GoalResult;
use surepose::time::Stamp;

use crate::convert::{header, pose_message};
use crate::dds::{NodeError, latched, refused, reliable};
use crate::driver::DriverReport;
use crate::message::{NavigateToPoseFeedback, NavigateToPoseGoal, NavigateToPoseResult, PoseStamped};
use crate::names::Names;

/// The action server, shared with those results that nobody has fetched yet.
pub(super) type Served =
    Arc<AsyncActionServer<NavigateToPoseGoal, NavigateToPoseResult, NavigateToPoseFeedback>>;

/// A goal that somebody asks for.
pub(super) type NewGoal = NewGoalHandle<NavigateToPoseGoal>;

/// Somebody calls goals off.
pub(super) type CancelRequest = CancelHandle;

/// No error, as of [Nav2's codes](https://docs.nav2.org), and one that has no code of its own: the message says it.
const NONE: u16 = 0;
const UNKNOWN: u16 = 9000;

/// A result that nobody asks for is kept for so many looks, of which each lasts so long.
const LOOKS: u32 = 600;
const LOOK: Duration = Duration::from_millis(100);

/// The server, and the goal that the robot drives to because of it.
pub(super) struct NavigateAction {
    server: Served,
    current: Option<Current>,
}

struct Current {
    handle: ExecutingGoalHandle<NavigateToPoseGoal>,
    since: Stamp,
}

/// A result under way to who asked for the goal.
pub(super) struct ResultDelivery {
    server: Served,
    handle: ExecutingGoalHandle<NavigateToPoseGoal>,
    status: GoalEndStatus,
    result: NavigateToPoseResult,
}

impl NavigateAction {
    pub(super) fn new(node: &mut Node, names: &Names) -> Result<Self, NodeError> {
        let qos = ActionServerQosPolicies {
            goal_service: reliable(10),
            result_service: reliable(10),
            cancel_service: reliable(10),
            feedback_publisher: reliable(10),
            status_publisher: latched(1),
        };
        let kind = ActionTypeName::new("nav2_msgs", "NavigateToPose");
        let server = node
            .create_action_server(ServiceMapping::Enhanced, &names.of("navigate_to_pose")?, &kind, qos)
            .map_err(|error| refused("the action navigate_to_pose", error))?;
        Ok(Self { server: Arc::new(AsyncActionServer::new(server)), current: None })
    }

    pub(super) fn server(&self) -> Served {
        Arc::clone(&self.server)
    }

    /// What is asked for; nothing where the middleware has lost it.
    pub(super) fn goal_of(&self, handle: &NewGoal) -> Option<NavigateToPoseGoal> {
        self.server.get_new_goal(handle.clone())
    }

    /// The robot drives to this goal now.
    pub(super) async fn accept(&mut self, handle: NewGoal, now: Stamp) {
        if let Ok(accepted) = self.server.accept_goal(handle).await
            && let Ok(handle) = self.server.start_executing_goal(accepted).await
        {
            self.current = Some(Current { handle, since: now });
        }
    }

    pub(super) async fn reject(&self, handle: NewGoal) {
        // Who is gone hears nothing.
        let _sent = self.server.reject_goal(handle).await;
    }

    /// Whether this calls off what the robot drives to; who asks is told.
    pub(super) async fn cancels(&self, request: &CancelRequest) -> bool {
        let goal = self.current.as_ref().map(|current| current.handle.goal_id());
        let meant = goal.filter(|goal| request.contains_goal(goal));
        let _sent = self.server.respond_to_cancel_requests(request, meant.into_iter()).await;
        meant.is_some()
    }

    /// Tells who asked for the goal how far the robot is: `least` \[s] is the least time that the rest can take.
    pub(super) async fn feed_back(&self, report: &DriverReport, distance: f64, least: f64, frame: &str) {
        let Some(current) = &self.current else { return };
        let pose =
            PoseStamped { header: header(report.stamp, frame), pose: pose_message(report.belief.pose) };
        let feedback = NavigateToPoseFeedback {
            current_pose: pose,
            navigation_time: duration(report.stamp.since(current.since)),
            estimated_time_remaining: duration(least),
            number_of_recoveries: 0,
            distance_remaining: distance as f32,
        };
        // A goal that is being called off takes none.
        let _sent = self.server.publish_feedback(current.handle.clone(), feedback).await;
    }

    /// The goal is over: what is to be delivered, where it was this action's.
    pub(super) fn ended(&mut self, ended: GoalResult) -> Option<ResultDelivery> {
        let current = self.current.take()?;
        let (status, code, message) = match ended {
            GoalResult::Reached => (GoalEndStatus::Succeeded, NONE, ""),
            GoalResult::Canceled => (GoalEndStatus::Canceled, NONE, ""),
            GoalResult::Preempted => (GoalEndStatus::Aborted, UNKNOWN, "preempted by another goal"),
            GoalResult::Aborted(reason) => (GoalEndStatus::Aborted, UNKNOWN, reason.name()),
            _ => (GoalEndStatus::Aborted, UNKNOWN, "unknown"),
        };
        let result = NavigateToPoseResult { error_code: code, error_msg: message.to_owned() };
        Some(ResultDelivery { server: self.server(), handle: current.handle, status, result })
    }
}

impl ResultDelivery {
    /// Delivers the result as soon as somebody asks for it.
    ///
    /// The server waits for one request at a time and keeps those for other goals, so each look is short.
    pub(super) fn made(self) -> LocalBoxFuture<'static, ()> {
        let Self { server, handle, status, result } = self;
        let made = async move {
            for _ in 0..LOOKS {
                let publish_result = server.send_result_response(handle.clone(), status, result.clone());
                pin_mut!(publish_result);
                if let Either::Left(_) = select(publish_result, smol::Timer::after(LOOK)).await {
                    return;
                }
            }
            let _forgotten = server.abort_executing_goal(handle).await;
        };
        made.boxed_local()
    }
}

/// Goals as they are asked for.
pub(super) fn goals(server: &Served) -> impl Stream<Item = ReadResult<NewGoal>> + '_ {
    unfold(server, |server| async move { Some((server.receive_new_goal().await, server)) }).fuse()
}

/// Goals as they are called off.
pub(super) fn cancels(server: &Served) -> impl Stream<Item = ReadResult<CancelRequest>> + '_ {
    unfold(server, |server| async move { Some((server.receive_cancel_request().await, server)) }).fuse()
}

fn duration(seconds: f64) -> RosDuration {
    RosDuration::from_nanos(Stamp::from_seconds(seconds).nanoseconds())
}
