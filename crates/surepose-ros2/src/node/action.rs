//! Server of the action `navigate_to_pose`.

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
use surepose_config::describe_abort;

use crate::convert::{header, pose_message};
use crate::dds::{NodeError, latched, refused, reliable};
use crate::driver::DriverReport;
use crate::message::{NavigateToPoseFeedback, NavigateToPoseGoal, NavigateToPoseResult, PoseStamped};
use crate::names::Names;

/// Action server, shared with the results that clients have not requested yet.
pub(super) type Served =
    Arc<AsyncActionServer<NavigateToPoseGoal, NavigateToPoseResult, NavigateToPoseFeedback>>;

/// Requested goal.
pub(super) type NewGoal = NewGoalHandle<NavigateToPoseGoal>;

/// Request to cancel goals.
pub(super) type CancelRequest = CancelHandle;

/// Error codes of [Nav2](https://docs.nav2.org): no error, and an error that only the message describes.
const NONE: u16 = 0;
const UNKNOWN: u16 = 9000;

/// Number and duration of the polls for a result request, after which the result is dropped.
const LOOKS: u32 = 600;
const LOOK: Duration = Duration::from_millis(100);

/// Action server and its active goal.
pub(super) struct NavigateAction {
    server: Served,
    current: Option<Current>,
}

struct Current {
    handle: ExecutingGoalHandle<NavigateToPoseGoal>,
    since: Stamp,
}

/// Delivery of a result to the client.
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

    /// Requested pose; `None` if the middleware has lost the request.
    pub(super) fn goal_of(&self, handle: &NewGoal) -> Option<NavigateToPoseGoal> {
        self.server.get_new_goal(handle.clone())
    }

    /// Accepts `goal` as the active goal.
    pub(super) async fn accept(&mut self, handle: NewGoal, now: Stamp) {
        if let Ok(accepted) = self.server.accept_goal(handle).await
            && let Ok(handle) = self.server.start_executing_goal(accepted).await
        {
            self.current = Some(Current { handle, since: now });
        }
    }

    pub(super) async fn reject(&self, handle: NewGoal) {
        // A client that has left receives no answer.
        let _sent = self.server.reject_goal(handle).await;
    }

    /// Accepts a goal and aborts it at once, so that its result has a message; an active goal stays active.
    ///
    /// Returns `None` if the client has left.
    pub(super) async fn refuse(&self, handle: NewGoal, message: String) -> Option<ResultDelivery> {
        let accepted = self.server.accept_goal(handle).await.ok()?;
        let handle = self.server.start_executing_goal(accepted).await.ok()?;
        let result = NavigateToPoseResult { error_code: UNKNOWN, error_msg: message };
        Some(ResultDelivery { server: self.server(), handle, status: GoalEndStatus::Aborted, result })
    }

    /// Answers a cancel request, and returns whether it cancels the active goal.
    pub(super) async fn cancels(&self, request: &CancelRequest) -> bool {
        let goal = self.current.as_ref().map(|current| current.handle.goal_id());
        let meant = goal.filter(|goal| request.contains_goal(goal));
        let _sent = self.server.respond_to_cancel_requests(request, meant.into_iter()).await;
        meant.is_some()
    }

    /// Publishes feedback; `least` \[s] is the shortest possible remaining time.
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
        // A goal that is being canceled takes no feedback.
        let _sent = self.server.publish_feedback(current.handle.clone(), feedback).await;
    }

    /// Ends the active goal and returns its result; `None` if the goal is not from this action.
    pub(super) fn ended(&mut self, ended: GoalResult) -> Option<ResultDelivery> {
        let current = self.current.take()?;
        let (status, code, message) = match ended {
            GoalResult::Reached => (GoalEndStatus::Succeeded, NONE, String::new()),
            GoalResult::Canceled => (GoalEndStatus::Canceled, NONE, String::new()),
            GoalResult::Preempted => {
                (GoalEndStatus::Aborted, UNKNOWN, "preempted by another goal".to_owned())
            }
            GoalResult::Aborted(reason) => (GoalEndStatus::Aborted, UNKNOWN, describe_abort(reason)),
            _ => (GoalEndStatus::Aborted, UNKNOWN, "unknown".to_owned()),
        };
        let result = NavigateToPoseResult { error_code: code, error_msg: message };
        Some(ResultDelivery { server: self.server(), handle: current.handle, status, result })
    }
}

impl ResultDelivery {
    /// Delivers the result to the first request for it.
    ///
    /// The server waits for one request at a time and keeps those for other goals, so each poll is short.
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

/// Stream of requested goals.
pub(super) fn goals(server: &Served) -> impl Stream<Item = ReadResult<NewGoal>> + '_ {
    unfold(server, |server| async move { Some((server.receive_new_goal().await, server)) }).fuse()
}

/// Stream of cancel requests.
pub(super) fn cancels(server: &Served) -> impl Stream<Item = ReadResult<CancelRequest>> + '_ {
    unfold(server, |server| async move { Some((server.receive_cancel_request().await, server)) }).fuse()
}

fn duration(seconds: f64) -> RosDuration {
    RosDuration::from_nanos(Stamp::from_seconds(seconds).nanoseconds())
}
