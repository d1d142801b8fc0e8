"""Tests the node with ROS 2: `conversation.py SUREPOSE`, with the rclpy wheels in the environment.

Starts `SUREPOSE ros2 --simulate`, and uses the topics, service and action of RViz and Nav2. Tests that need nav2_msgs or
tf2_msgs, which the wheels lack, run if these are installed and are reported as skipped otherwise. Fails by assertion.
"""

import math
import os
import signal
import subprocess
import sys
import tempfile
import threading
import time

import rclpy
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import PoseStamped, PoseWithCovarianceStamped, TransformStamped, TwistStamped
from nav_msgs.msg import Odometry
from rcl_interfaces.msg import Parameter, ParameterType, ParameterValue
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.action import ActionClient
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import Imu, LaserScan
from std_srvs.srv import Empty
from visualization_msgs.msg import Marker

try:
    from nav2_msgs.action import NavigateToPose
except ImportError:
    NavigateToPose = None
try:
    from tf2_msgs.msg import TFMessage
except ImportError:
    TFMessage = None

SUCCEEDED, CANCELED, ABORTED = 4, 5, 6


def yaw(rotation):
    return math.degrees(2.0 * math.atan2(rotation.z, rotation.w))


def pose_message(x, y, degrees, frame="map"):
    message = PoseStamped()
    message.header.frame_id = frame
    message.pose.position.x, message.pose.position.y = float(x), float(y)
    message.pose.orientation.z = math.sin(math.radians(degrees) / 2)
    message.pose.orientation.w = math.cos(math.radians(degrees) / 2)
    return message


class Conversation:
    def __init__(self):
        self.node = rclpy.create_node("tester")
        self.last, self.count = {}, {}
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        topics = [
            (Odometry, "odom", 10), (PoseStamped, "truth", 10), (TwistStamped, "cmd_vel", 10),
            (PoseWithCovarianceStamped, "pose", 10), (LaserScan, "scan", qos_profile_sensor_data),
            (Imu, "imu", qos_profile_sensor_data), (DiagnosticArray, "/diagnostics", 10), (Marker, "walls", latched),
        ]
        if TFMessage:
            topics += [(TFMessage, "/tf", 100), (TFMessage, "/tf_static", latched)]
        self.transforms = {}
        for kind, name, qos in topics:
            self.node.create_subscription(kind, name, lambda message, name=name: self.heard(name, message), qos)
        self.goals = self.node.create_publisher(PoseStamped, "goal_pose", 1)

    def heard(self, name, message):
        self.last[name] = message
        self.count[name] = self.count.get(name, 0) + 1
        for transform in getattr(message, "transforms", []):
            self.transforms[transform.header.frame_id, transform.child_frame_id] = transform

    def until(self, is_so, seconds, what):
        end = time.monotonic() + seconds
        while not is_so():
            assert time.monotonic() < end, f"not within {seconds} s: {what}"
            rclpy.spin_once(self.node, timeout_sec=0.05)

    def listen(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            rclpy.spin_once(self.node, timeout_sec=0.05)

    def call(self, kind, name, request):
        client = self.node.create_client(kind, name)
        assert client.wait_for_service(timeout_sec=10), f"no service {name}"
        for _ in range(5):  # calls during discovery can be lost
            answer = client.call_async(request)
            rclpy.spin_until_future_complete(self.node, answer, timeout_sec=3)
            if answer.done():
                return answer.result()
        raise AssertionError(f"{name} does not answer")

    def error(self, x, y, degrees):
        pose = self.last["truth"].pose
        turn = (yaw(pose.orientation) - degrees + 180.0) % 360.0 - 180.0
        return math.hypot(pose.position.x - x, pose.position.y - y), abs(turn)

    def rests(self):
        twist = self.last["cmd_vel"].twist
        return twist.linear.x == 0.0 and twist.angular.z == 0.0

    def diagnostics(self):
        return {pair.key: pair.value for pair in self.last["/diagnostics"].status[0].values}

    def has_parked(self, x, y, degrees, what):
        position, heading = self.error(x, y, degrees)
        print(f"{what}: {1e3 * position:.1f} mm, {heading:.2f} deg")
        assert position < 0.01 and heading < 1.0, what


def topics(talk):
    names = ["odom", "truth", "pose", "scan", "imu", "/diagnostics", "walls"]
    talk.until(lambda: all(name in talk.last for name in names), 20, f"{names}, and got {list(talk.last)}")
    assert len(talk.last["scan"].ranges) == 181 and len(talk.last["walls"].points) == 16
    pose = talk.last["pose"]
    assert pose.header.frame_id == "map" and 0.0 < pose.pose.covariance[0] < 0.01 < 1.0
    assert pose.pose.covariance[35] > 0.0 and pose.pose.covariance[14] == 0.0
    assert "cmd_vel" not in talk.last, "no command without a goal"
    if TFMessage:
        talk.until(lambda: ("map", "odom") in talk.transforms, 5, "map to odom")
        talk.until(lambda: ("base_link", "laser") in talk.transforms, 5, "the laser extrinsics")
        assert ("odom", "base_link") in talk.transforms


def transforms(talk):
    """map to odom, and odom to base_link: the pose by /tf matches the true pose."""
    def composed(a, b):
        turn = math.radians(yaw(a.rotation))
        x = a.translation.x + math.cos(turn) * b.translation.x - math.sin(turn) * b.translation.y
        y = a.translation.y + math.sin(turn) * b.translation.x + math.cos(turn) * b.translation.y
        return x, y, yaw(a.rotation) + yaw(b.rotation)

    corrected = talk.transforms["map", "odom"]
    ahead = talk.node.get_clock().now().nanoseconds * 1e-9 - corrected.header.stamp.sec
    x, y, degrees = composed(corrected.transform, talk.transforms["odom", "base_link"].transform)
    position, heading = talk.error(x, y, degrees)
    print(f"/tf: {1e3 * position:.1f} mm, {heading:.2f} deg, {ahead:.1f} s old")
    assert position < 0.01 and heading < 1.0 and abs(ahead) < 3.0


def parameters(talk):
    request = GetParameters.Request(names=["law.k_v", "robot.track_m", "law.name"])
    values = talk.call(GetParameters, "/surepose/get_parameters", request).values
    assert values[0].type == ParameterType.PARAMETER_DOUBLE and values[0].double_value > 0.0
    assert abs(values[1].double_value - 0.6) < 1e-12 and values[2].string_value == "surepose"
    value = ParameterValue(type=ParameterType.PARAMETER_DOUBLE, double_value=100.0)
    request = SetParameters.Request(parameters=[Parameter(name="law.k_v", value=value)])
    result = talk.call(SetParameters, "/surepose/set_parameters", request).results[0]
    assert not result.successful and "--set law.k_v" in result.reason, result


def goal_by_topic(talk):
    unfilled = PoseStamped()
    unfilled.header.frame_id = "map"
    unfilled.pose.orientation.w = 0.0
    talk.goals.publish(unfilled)
    talk.goals.publish(pose_message(1, 1, 0, frame="odom"))
    talk.listen(2)
    rejected = [key for key in talk.diagnostics() if key.startswith("goal_pose rejected")]
    assert len(rejected) == 2 and "cmd_vel" not in talk.last, rejected
    talk.goals.publish(pose_message(2, 2, 30))
    talk.until(lambda: "cmd_vel" in talk.last and not talk.rests(), 5, "a command to move")
    talk.until(talk.rests, 60, "a command to rest")
    talk.listen(2)
    talk.has_parked(2, 2, 30, "goal_pose")


def lost_and_found(talk):
    talk.call(Empty, "reinitialize_global_localization", Empty.Request())
    talk.listen(1)
    before = talk.count["pose"]
    talk.listen(1)
    assert talk.count["pose"] == before, "no pose is published while the robot is lost"
    talk.goals.publish(pose_message(1, 1, -90))
    talk.until(lambda: talk.count["pose"] > before, 60, "to be found")
    talk.until(lambda: talk.rests() and talk.error(1, 1, -90)[0] < 0.01, 90, "to park after that")
    talk.listen(2)
    talk.has_parked(1, 1, -90, "lost, found and parked")


def action(talk):
    client = ActionClient(talk.node, NavigateToPose, "navigate_to_pose")
    assert client.wait_for_server(timeout_sec=10)

    def send(pose):
        feedback = []
        for _ in range(5):
            sent = client.send_goal_async(
                NavigateToPose.Goal(pose=pose), feedback_callback=lambda message: feedback.append(message.feedback)
            )
            rclpy.spin_until_future_complete(talk.node, sent, timeout_sec=3)
            if sent.done():
                return sent.result(), feedback
        raise AssertionError("no answer to a goal")

    assert not send(pose_message(1, 1, 0, frame="odom"))[0].accepted
    # A rejected goal carries no reason: one outside of the room is accepted and aborted.
    handle, _ = send(pose_message(50, 0, 0))
    refused = handle.get_result_async()
    rclpy.spin_until_future_complete(talk.node, refused, timeout_sec=10)
    assert refused.result().status == ABORTED and refused.result().result.error_msg.startswith("wall"), refused.result()
    handle, _ = send(pose_message(2, 1, 0))
    result = handle.get_result_async()
    talk.listen(2)
    cancelled = handle.cancel_goal_async()
    rclpy.spin_until_future_complete(talk.node, cancelled, timeout_sec=5)
    assert len(cancelled.result().goals_canceling) == 1
    rclpy.spin_until_future_complete(talk.node, result, timeout_sec=10)
    assert result.result().status == CANCELED
    handle, feedback = send(pose_message(2, 2, 90))
    result = handle.get_result_async()
    rclpy.spin_until_future_complete(talk.node, result, timeout_sec=60)
    assert result.result().status == SUCCEEDED and result.result().result.error_code == 0
    assert len(feedback) > 20 and feedback[-1].distance_remaining < 0.01 < feedback[0].distance_remaining
    talk.has_parked(2, 2, 90, "navigate_to_pose")


def mounting(talk, program, environment):
    """Laser upside down and facing back: the node reads it from a latched /tf_static."""
    hanging, sits = TransformStamped(), "the laser 'laser' sits on 'base' at (-0.200, 0.100) facing 180.0°, upside down"
    hanging.header.frame_id, hanging.child_frame_id = "base", "laser"
    hanging.transform.translation.x, hanging.transform.translation.y = -0.2, 0.1
    hanging.transform.rotation.y, hanging.transform.rotation.w = 1.0, 0.0
    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    joints = talk.node.create_publisher(TFMessage, "/tf_static", latched)
    joints.publish(TFMessage(transforms=[hanging]))
    odometry = talk.node.create_publisher(Odometry, "/other/odom", 10)
    scans = talk.node.create_publisher(LaserScan, "/other/scan", qos_profile_sensor_data)
    odom, scan = Odometry(), LaserScan(angle_min=-1.5, angle_increment=0.1, range_max=30.0, ranges=[1.0] * 31)
    odom.child_frame_id, odom.pose.pose.orientation.w, scan.header.frame_id = "base", 1.0, "laser"
    with tempfile.TemporaryDirectory() as folder:
        walls = os.path.join(folder, "walls.toml")
        with open(walls, "w") as file:
            file.write("[[wall]]\nfrom_m = [0.0, 0.0]\nto_m = [6.0, 0.0]\n")
        other = subprocess.Popen(
            [program, "ros2", "--namespace", "other", "--map", walls], env=environment, stderr=subprocess.PIPE, text=True
        )
        said = []
        listener = threading.Thread(target=lambda: said.extend(iter(other.stderr.readline, "")))
        listener.start()

        def is_reported():
            odom.header.stamp = scan.header.stamp = talk.node.get_clock().now().to_msg()
            odometry.publish(odom)
            scans.publish(scan)
            return any(sits in line and "by /tf_static" in line for line in said)

        try:
            talk.until(is_reported, 15, f"{sits}; said was {said}")
        finally:
            other.send_signal(signal.SIGTERM)
            listener.join(timeout=10)
            other.kill()
    print("/tf_static:", sits)


def ends_at_rest(talk, program):
    talk.goals.publish(pose_message(1, 1, 0))
    talk.until(lambda: not talk.rests(), 5, "a command to move")
    program.send_signal(signal.SIGTERM)
    talk.until(talk.rests, 5, "a command to rest before the end")
    assert program.wait(timeout=10) == 0


def main():
    os.environ.setdefault("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    os.environ.setdefault("ROS_DOMAIN_ID", str(10 + os.getpid() % 40))
    # The program must not load the libraries of ROS.
    environment = {key: value for key, value in os.environ.items() if key != "LD_LIBRARY_PATH"}
    program = subprocess.Popen([sys.argv[1], "ros2", "--simulate"], env=environment)
    try:
        rclpy.init()
        talk = Conversation()
        topics(talk)
        parameters(talk)
        goal_by_topic(talk)
        if TFMessage:
            transforms(talk)
            mounting(talk, sys.argv[1], environment)
        else:
            print("skipped: /tf and /tf_static, tf2_msgs is not installed")
        lost_and_found(talk)
        if NavigateToPose:
            action(talk)
        else:
            print("skipped: the action, nav2_msgs is not installed (tests/parks.rs tests it without rclpy)")
        ends_at_rest(talk, program)
        rclpy.shutdown()
    finally:
        program.kill()


if __name__ == "__main__":
    main()
