"""Commands of the program."""

import json
import os
import shutil
import signal
import subprocess
import sys
import threading
import time
from typing import Any

import numpy as np
import pytest
import surepose

PROGRAM = os.environ.get("SUREPOSE_PROGRAM") or shutil.which("surepose")
needs_program = pytest.mark.skipif(PROGRAM is None, reason="no program: set SUREPOSE_PROGRAM to its path")
TIMES = ("wall_s", "steps_per_s")


def printed(*arguments: str) -> dict[str, Any]:
    assert PROGRAM is not None
    ran = subprocess.run([PROGRAM, "--json", *arguments], capture_output=True, check=False, text=True)
    return {key: value for key, value in json.loads(ran.stdout).items() if key not in TIMES}


def figures(result: surepose.Result) -> dict[str, Any]:
    return {key: value for key, value in result.summary.items() if key not in TIMES}


@needs_program
def test_numbers_are_those_of_the_program() -> None:
    run = surepose.simulate(goal=(2, 2, 90), seed=7)
    assert figures(run) == printed("run", "--goal", "2,2,90", "--seed", "7")
    sweep = surepose.sweep(2000, noise="bench", period=0.1, seed=5)
    assert figures(sweep) == printed("sweep", "--runs", "2000", "--noise", "bench", "--period", "0.1", "--seed", "5")
    proof = surepose.certify(period=0.1, noise_position=0.007)
    assert figures(proof) == printed("certify", "--period", "0.1", "--noise-position", "0.007")


def test_a_drive_has_arrays() -> None:
    run = surepose.simulate(seed=3)
    assert run.ok and run.outcome == "reached" == run["outcome"]
    assert run.arrays["x_m"].shape == run.arrays["time_s"].shape
    end = np.hypot(run["x_m"][-1] - 2.0, run["y_m"][-1] - 2.0)
    assert end == pytest.approx(run.final_position_error_m, abs=1e-12)
    with pytest.raises(AttributeError, match="no such figure"):
        run.nothing
    assert "outcome" in dir(run) and "reached" in repr(run)


def test_a_world_that_ignores_small_speeds_stalls() -> None:
    small_speeds = {"robot.min_speed_m_s": 0.02, "robot.min_turn_rate_deg_s": 4.6}
    with pytest.warns(UserWarning, match="min_speed_m_s"):
        run = surepose.simulate(world=small_speeds)
    assert not run.ok and run.exit_code == 4 and run.reason == "stalled"
    told = surepose.simulate(config=small_speeds)
    assert told.outcome == "reached"


def test_parts_of_a_sweep_are_its_trials() -> None:
    whole = surepose.sweep(300, noise="bench", seed=4)
    parts = [surepose.sweep(100, first=first, noise="bench", seed=4) for first in (0, 100, 200)]
    for name, column in whole.arrays.items():
        assert np.array_equal(column, np.concatenate([part.arrays[name] for part in parts])), name


def test_given_starts_keep_their_bits() -> None:
    starts = np.array([[1.0, 0.1 + 0.2, 30.0], [-0.5, 1e-3, -170.0]])
    sweep = surepose.sweep(starts=starts)
    assert np.array_equal(sweep["start_x_m"], starts[:, 0]) and np.array_equal(sweep["start_y_m"], starts[:, 1])
    with pytest.raises(ValueError, match=r"starts: expected shape \(n, 3\), got \(2, 2\)"):
        surepose.sweep(starts=starts[:, :2])
    with pytest.raises(ValueError, match="starts: not finite"):
        surepose.sweep(starts=[[0.0, np.nan, 0.0]])


def test_tables_take_the_trials() -> None:
    pandas = pytest.importorskip("pandas")
    table = pandas.DataFrame(surepose.sweep(50).to_dict())
    assert len(table) == 50 and table["success"].all()


def test_errors_have_the_words_of_the_program() -> None:
    with pytest.raises(surepose.CommandError, match=r"k_v.*negative value \(got -1"):
        surepose.sweep(10, config={"law.k_v": -1})
    with pytest.raises(surepose.CommandError, match="nothing.log") as caught:
        surepose.replay("carmen", "nothing.log")
    assert caught.value.args[1] == 3
    with pytest.raises(surepose.CommandError, match="--nothing"):
        surepose.replay("carmen", "a.log", nothing=3)
    with pytest.raises(TypeError, match="config: expected a mapping"):
        surepose.sweep(10, config=3)  # type: ignore[arg-type]


def test_refused_gains_have_a_reason() -> None:
    proof = surepose.certify(period=0.1, config={"law.k_v": 10, "law.k_alpha": 100, "law.h": 1})
    assert not proof.ok and proof.certified is False and proof.reason


def test_maps_are_traced_and_written(tmp_path: os.PathLike[str]) -> None:
    width, height = 60, 40
    grid = np.full((height, width), 254, dtype=np.uint8)
    grid[[4, -5], 4:-4] = 0
    grid[4:-4, [4, -5]] = 0
    image = os.path.join(tmp_path, "room.pgm")
    with open(image, "wb") as file:
        file.write(f"P5 {width} {height} 255\n".encode() + grid.tobytes())
    yaml = os.path.join(tmp_path, "room.yaml")
    with open(yaml, "w") as file:
        file.write("image: room.pgm\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.2\n")
    out = os.path.join(tmp_path, "room.toml")
    assert surepose.map_from_grid(yaml, out).walls >= 4
    surepose.Navigator(map=out, start=surepose.Belief((1.5, 1.0, 0.0)))


def test_other_threads_run_during_a_sweep() -> None:
    ticks, done = [], threading.Event()

    def tick() -> None:
        while not done.is_set():
            ticks.append(time.monotonic())
            time.sleep(0.005)

    thread = threading.Thread(target=tick)
    thread.start()
    begin = time.monotonic()
    surepose.sweep(200_000, noise="bench")
    taken = time.monotonic() - begin
    done.set()
    thread.join()
    during = [at for at in ticks if at < begin + taken]
    assert len(during) > 5 * taken, (len(during), taken)


def test_ctrl_c_ends_a_sweep() -> None:
    code = "import surepose\nprint('begins', flush=True)\nsurepose.sweep(50_000_000, noise='bench')"
    child = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    assert child.stdout is not None and child.stdout.readline() == "begins\n"
    time.sleep(1.0)
    child.send_signal(signal.SIGINT)
    _, errors = child.communicate(timeout=30)
    assert "KeyboardInterrupt" in errors


def test_pictures(tmp_path: os.PathLike[str]) -> None:
    matplotlib = pytest.importorskip("matplotlib")
    matplotlib.use("Agg")
    pytest.importorskip("matplotlib.pyplot")
    for name, result in (("drive", surepose.simulate()), ("sweep", surepose.sweep(2000, noise="bench"))):
        figure, axes = matplotlib.pyplot.subplots()
        assert result.plot(axes) is axes
        figure.savefig(os.path.join(tmp_path, f"{name}.png"))
        assert axes.get_xlabel()
    with pytest.raises(ValueError, match="no picture"):
        surepose.certify().plot()
