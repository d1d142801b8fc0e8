"""Sweeps over a cluster of two nodes on this machine."""

import os
import signal
import time
from collections.abc import Iterator

import numpy as np
import pytest
import surepose
from surepose.cluster import Histogram, figures

ray = pytest.importorskip("ray")
from ray.cluster_utils import Cluster  # noqa: E402

TIMES = ("wall_s", "steps_per_s")


@pytest.fixture(scope="module")
def cluster() -> Iterator[None]:
    nodes = Cluster(initialize_head=True, head_node_args={"num_cpus": 1})
    nodes.add_node(num_cpus=1)
    ray.init(address=nodes.address, log_to_driver=False)
    yield
    ray.shutdown()
    nodes.shutdown()


def expected(runs: int, **options: object) -> surepose.Result:
    return surepose.sweep(runs, noise="bench", seed=9, **options)  # type: ignore[arg-type]


def check(result: surepose.Result, one: surepose.Result) -> None:
    for name, column in one.arrays.items():
        assert np.array_equal(column, result.arrays[name], equal_nan=column.dtype == float), name
    assert result.summary == {key: value for key, value in one.summary.items() if key not in TIMES}


def test_figures_of_trials_are_those_of_the_program() -> None:
    for options in ({}, {"loop": "ekf"}):
        one = expected(3000, **options)
        assert figures(one.arrays, one.summary) == {k: v for k, v in one.summary.items() if k not in TIMES}


def test_two_nodes_have_the_bits_of_one(cluster: None) -> None:
    check(surepose.cluster.sweep(30_000, part=7000, noise="bench", seed=9), expected(30_000))


def test_a_killed_worker_costs_no_result(cluster: None) -> None:
    killed = []

    def kill_one() -> None:
        for line in os.popen("pgrep -f ray::_part").read().split():
            os.kill(int(line), signal.SIGKILL)
            killed.append(line)
            return

    import threading

    def later() -> None:
        deadline = time.monotonic() + 60
        while not killed and time.monotonic() < deadline:
            time.sleep(0.2)
            kill_one()

    thread = threading.Thread(target=later)
    thread.start()
    result = surepose.cluster.sweep(400_000, part=50_000, noise="bench", seed=9)
    thread.join()
    assert killed, "no worker was found"
    check(result, expected(400_000))


def test_certificates_run_on_the_cluster(cluster: None) -> None:
    periods = (0.02, 0.1)
    results = surepose.cluster.certify({"period": period, "noise_position": 0.005} for period in periods)
    local = [surepose.certify(period=period, noise_position=0.005) for period in periods]
    assert [result.capture_radius_m for result in results] == [result.capture_radius_m for result in local]


def test_histogram_needs_no_trials() -> None:
    one, histogram = expected(4000), Histogram()
    for first in (0, 2000):
        histogram.add(expected(2000, first=first).arrays)
    merged = histogram.figures(one.summary)
    for name in Histogram.NAMES:
        for quantile in ("p50", "p95", "max"):
            assert merged[name][quantile] == pytest.approx(one.summary[name][quantile], rel=1.1e-3), name
    assert merged["runs"] == 4000 and merged["success_rate"] == one.success_rate
