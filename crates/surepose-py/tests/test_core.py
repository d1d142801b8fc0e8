"""Classes of the core."""

import math
import os
import threading

import numpy as np
import pytest
import surepose
from surepose import Belief, Config, Controller, Ekf, Measurement, Navigator, Scan, Simulator


def test_controller_parks_on_exact_arcs() -> None:
    controller = Controller()
    x = y = heading = 0.0
    goal = (1.0, 0.5, math.pi / 2)
    for _ in range(2000):
        step = controller.step((x, y, heading), goal)
        dt = controller.period
        middle = heading + 0.5 * step.omega * dt
        x, y, heading = x + step.v * dt * math.cos(middle), y + step.v * dt * math.sin(middle), heading + step.omega * dt
        if step.is_reached:
            break
    assert step.is_reached
    assert math.hypot(x - goal[0], y - goal[1]) < 0.01
    assert abs(heading - goal[2]) < math.radians(1.0)


def test_lyapunov_function_falls(config: Config) -> None:
    controller = Controller(config)
    far = controller.step((0.0, 0.0, 0.0), (2.0, 1.0, 0.0)).lyapunov
    controller.reset()
    assert controller.step((1.0, 0.5, 0.0), (2.0, 1.0, 0.0)).lyapunov < far


def test_filter_is_the_textbook_filter_for_one_position() -> None:
    ekf = Ekf(belief=Belief((0.0, 0.0, 0.0), (0.1, 0.2, 0.1)))
    ekf.predict(0.1, 0.0, 0.0)
    nis = ekf.update(Measurement.position(0.1, 0.0, 0.1))
    # Variances 0.01 and 0.01: half of the innovation, half of the variance.
    assert isinstance(nis, float) and nis == pytest.approx(0.1**2 / 0.02)
    assert ekf.belief.x == pytest.approx(0.05)
    assert ekf.belief.std[0] == pytest.approx(math.sqrt(0.005))
    covariance = ekf.belief.covariance
    assert np.array_equal(covariance, covariance.T) and np.linalg.eigvalsh(covariance).min() > 0


@pytest.mark.parametrize(
    ("measurement", "reason"),
    [
        (Measurement.heading(math.nan, 0.1), "not_finite"),
        (Measurement.heading(0.1, 1e-13), "bad_variance"),
        (Measurement.position(50.0, 0.0, 0.01), "outlier"),
        (Measurement.position(0.0, 0.0, 0.01, stamp=9.0), "future"),
        (Measurement.position(0.0, 0.0, 0.01, stamp=-9.0), "stale"),
    ],
)
def test_bad_measurements_are_rejected_by_reason(measurement: Measurement, reason: str) -> None:
    ekf = Ekf()
    ekf.predict(0.1, 0.01, 0.01)
    before = ekf.belief.pose
    assert ekf.update(measurement) == reason
    assert ekf.belief.pose == before


def test_navigator_parks_the_simulated_robot(config: Config) -> None:
    world = Simulator(config, seed=3)
    robot = Navigator(config, map=world.walls, start=Belief(world.pose))
    robot.set_goal(world.goal)
    command, result = (0.0, 0.0), None
    for _ in range(3000):
        frame = world.step(*command)
        report = robot.step(frame.stamp, frame.wheel_travel, frame.readings)
        command, result = report.command or (0.0, 0.0), report.result
        if result:
            break
    assert result == "reached"
    assert math.hypot(world.pose[0] - 1.0, world.pose[1] - 0.5) < 0.003
    assert robot.measurement_stats["accepted"] > 50


def test_a_lost_robot_localizes_itself(config: Config) -> None:
    world = Simulator(config, seed=1)
    robot = Navigator(config, map=world.walls)
    robot_is_lost = [robot.step(0.0, (0.0, 0.0)).health]
    robot.set_goal(world.goal)
    command = (0.0, 0.0)
    for _ in range(3000):
        frame = world.step(*command)
        report = robot.step(frame.stamp, frame.wheel_travel, frame.readings)
        command = report.command or (0.0, 0.0)
        robot_is_lost.append(report.health)
        if report.health == "healthy":
            break
    assert robot_is_lost[0] == "lost" and robot_is_lost[-1] == "healthy"
    assert report.belief.nees(world.pose) < 30


def test_a_custom_sensor_replaces_the_laser(config: Config) -> None:
    """An indoor positioning system: 2 cm, 5 Hz, 0.1 s late."""
    world, noise = Simulator(config, seed=2), np.random.default_rng(2)
    robot = Navigator(config, start=Belief(world.pose, (0.01, 0.01, 0.01)))
    robot.set_goal(world.goal)
    command, pending = (0.0, 0.0), []
    for tick in range(3000):
        frame = world.step(*command)
        if tick % 4 == 0:
            x, y = np.array(world.pose[:2]) + noise.normal(0, 0.02, 2)
            pending.append((world.time, Measurement.position(x, y, 0.02, stamp=world.time)))
        readings = [measurement for time, measurement in pending if time <= world.time - 0.1]
        pending = [(time, measurement) for time, measurement in pending if time > world.time - 0.1]
        headings = [reading for reading in frame.readings if isinstance(reading, Measurement)]
        report = robot.step(frame.stamp, frame.wheel_travel, readings + headings)
        command = report.command or (0.0, 0.0)
        if report.result:
            break
    assert report.result == "reached"
    assert math.hypot(world.pose[0] - 1.0, world.pose[1] - 0.5) < 0.03


def test_world_differs_from_the_configuration(config: Config) -> None:
    world = Simulator(config, world={"motor.model": "ideal", "filter.delta": 1e-12, "robot.track_m": 0.3})
    for _ in range(20):
        world.step(0.0, 0.5)
    # The robot assumes 0.6 m between the wheels: half the separation turns twice as far.
    assert world.pose[2] == pytest.approx(20 * world.period * 0.5 * 2, rel=1e-4)


def test_walls_rule_a_goal_out(config: Config) -> None:
    robot = Navigator(config, map=Simulator(config).walls, start=Belief())
    with pytest.raises(ValueError, match="goal: .*wall"):
        robot.set_goal((4.45, 0.0, 0.0))


def test_configuration_names_and_errors(config: Config, tmp_path: os.PathLike[str]) -> None:
    assert config["scenario.goal_x_m"] == 1.0 and "law.k_v" in list(config) and len(config) > 60
    assert "scenario.goal_x_m" in repr(config)
    assert "m" in Config.explain("track_m")
    with pytest.raises(ValueError, match=r"(?s)k_v.*negative value \(got -1.*write a value"):
        Config({"law.k_v": -1})
    with pytest.raises(KeyError, match="no such parameter"):
        config["law.nothing"]
    file = os.path.join(tmp_path, "robot.toml")
    with open(file, "w") as robot:
        robot.write("[robot]\ntrack_m = 0.4\n")
    assert Config(file=file).wheel_separation == 0.4
    assert Config({"robot.track_m": 0.5}, file=file).wheel_separation == 0.5


@pytest.mark.parametrize(
    ("ranges", "error", "message"),
    [
        (np.ones(5, dtype=np.int32), TypeError, "ranges: .*float32 or float64, got dtype int32"),
        (np.ones((5, 2)), ValueError, r"ranges: .*one-dimensional array, got shape \[5, 2\]"),
        (np.array([]), ValueError, "ranges: empty"),
        ([1.0, 2.0], TypeError, "ranges: .*got list"),
        (None, TypeError, "ranges: .*got NoneType"),
        (np.ones(5, dtype=np.complex128), TypeError, "ranges: .*complex128"),
    ],
)
def test_wrong_arrays_are_named(ranges: object, error: type[Exception], message: str) -> None:
    with pytest.raises(error, match=message):
        Scan(ranges, 0.0, 0.1)  # type: ignore[arg-type]


def test_strided_read_only_and_float32_arrays_are_read() -> None:
    base = np.arange(20, dtype=np.float32)
    strided = base[::-2]
    strided.flags.writeable = False
    assert Scan(strided, 0.0, 0.1).ranges.tolist() == base[::-2].tolist()
    big_endian = np.arange(5, dtype=">f8")
    with pytest.raises(TypeError, match="ranges"):
        Scan(big_endian, 0.0, 0.1)


def test_nan_ranges_are_missing_returns(config: Config) -> None:
    world = Simulator(config)
    robot = Navigator(config, map=world.walls, start=Belief(world.pose))
    frame = world.step(0.0, 0.0)
    blind = Scan(np.full(181, np.nan), -math.pi / 2, math.pi / 180)
    report = robot.step(frame.stamp, frame.wheel_travel, blind)
    assert np.isfinite(report.belief.covariance).all()


@pytest.mark.parametrize("pose", [(math.nan, 0.0, 0.0), (0.0, math.inf, 0.0)])
def test_poses_must_be_finite(config: Config, pose: tuple[float, float, float]) -> None:
    with pytest.raises(ValueError, match=r"goal\.[xy]: not a finite number"):
        Navigator(config).set_goal(pose)
    with pytest.raises(ValueError, match="not a finite number"):
        Belief(pose)


@pytest.mark.parametrize("std", [0.0, -1.0, math.nan, math.inf])
def test_standard_deviations_are_positive(std: float) -> None:
    with pytest.raises(ValueError, match="std: a standard deviation must be positive and finite"):
        Measurement.heading(0.0, std)


def test_wrong_readings_are_named(config: Config) -> None:
    robot = Navigator(config)
    with pytest.raises(TypeError, match="readings: expected Scan, Measurement or YawRate.*got str"):
        robot.step(0.1, (0.0, 0.0), ["scan"])  # type: ignore[list-item]
    with pytest.raises(TypeError, match=r"stamp: expected seconds \(float\) or nanoseconds \(int\)"):
        robot.step("now", (0.0, 0.0))  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="stamp: not a finite number"):
        robot.step(math.nan, (0.0, 0.0))


def test_seconds_and_nanoseconds_are_the_same_time() -> None:
    one, two = Ekf(), Ekf()
    one.predict(0.1, 0.01, 0.02)
    two.predict(100_000_000, 0.01, 0.02)
    assert one.belief.pose == two.belief.pose and one.stamp == two.stamp


def test_two_threads_share_a_navigator(config: Config) -> None:
    robot, errors = Navigator(config), []

    def work(offset: int) -> None:
        for tick in range(2000):
            try:
                robot.step((2 * tick + offset) * 10_000_000, (1e-4, 1e-4))
            except Exception as error:  # noqa: BLE001
                errors.append(error)

    threads = [threading.Thread(target=work, args=(offset,)) for offset in (0, 1)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not errors and np.isfinite(robot.belief.covariance).all()


def test_a_forked_process_goes_on(config: Config) -> None:
    robot = Navigator(config)
    robot.step(0.1, (0.01, 0.01))
    child = os.fork()
    if child == 0:
        robot.step(0.2, (0.01, 0.01))
        os._exit(0 if robot.belief.x > 0.015 and surepose.sweep(10).success_rate == 1.0 else 1)
    assert os.waitpid(child, 0)[1] == 0
