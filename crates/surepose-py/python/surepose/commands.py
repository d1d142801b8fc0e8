"""Commands of the program, with the same options and numbers.

Angles are in degrees and keys carry their unit, as on the command line. ``config`` is a mapping of ``section.key`` to a value, or the
path of a TOML file. A command that fails raises :class:`surepose.CommandError` with the message of the program.
"""

from __future__ import annotations

import json
import os
import tempfile
import warnings as python_warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Union

import numpy as np
import numpy.typing as npt

from ._surepose import call
from .result import Result

Value = Union[float, int, str, bool]
ConfigLike = Union[Mapping[str, Value], str, "os.PathLike[str]", None]
PoseLike = Union[tuple[float, float, float], Sequence[float]]


def simulate(
    *,
    start: PoseLike | None = None,
    goal: PoseLike | None = None,
    seed: int = 1,
    scenario: str | os.PathLike[str] | None = None,
    config: ConfigLike = None,
    world: Mapping[str, Value] | None = None,
    out: str | os.PathLike[str] | None = None,
) -> Result:
    """Simulates one closed-loop drive of the robot to a goal pose: ``surepose run``.

    ``start`` and ``goal`` are (x [m], y [m], heading [deg]). ``world`` makes the world differ from the configuration. The arrays are the
    time series, one value per period.
    """
    arguments = [*_option("--start", _pose("start", start)), *_option("--goal", _pose("goal", goal))]
    arguments += [*_option("--scenario", scenario), *_option("--out", out), "--seed", str(seed), *_world(world)]
    return _run(["run"], arguments, config)


def sweep(
    runs: int | None = None,
    *,
    first: int = 0,
    starts: npt.ArrayLike | None = None,
    period: float | None = None,
    noise: str | None = None,
    loop: str | None = None,
    precision: str = "f64",
    threads: int | None = None,
    seed: int = 1,
    config: ConfigLike = None,
    world: Mapping[str, Value] | None = None,
) -> Result:
    """Runs many closed-loop trials and compares them with the minimum time: ``surepose sweep``.

    ``starts`` has rows x [m], y [m], heading [deg]; without it the starts are random. Trials ``first`` to ``first + runs - 1`` are those of
    a longer sweep with the same seed. The arrays are the trials.
    """
    arguments = ["--precision", precision, "--seed", str(seed), *_option("--period", period)]
    arguments += [*_option("--noise", noise), *_option("--loop", loop), *_option("--threads", threads), *_world(world)]
    if starts is None:
        arguments += [*_option("--runs", runs), *(["--first", str(first)] if first else [])]
        return _run(["sweep"], arguments, config)
    rows = np.asarray(starts, dtype=np.float64)
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise ValueError(f"starts: expected shape (n, 3), got {rows.shape}")
    if not np.isfinite(rows).all():
        raise ValueError("starts: not finite (got NaN or infinity, expected finite numbers)")
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "starts.csv"
        # 17 digits keep every bit.
        np.savetxt(file, rows, delimiter=",", header="x_m,y_m,heading_deg", comments="", fmt="%.17g")
        return _run(["sweep"], [*arguments, "--starts", str(file)], config)


def certify(
    *,
    period: float | None = None,
    noise_position: float | None = None,
    noise_heading: float | None = None,
    noise_speed: float | None = None,
    gaussian: bool = False,
    config: ConfigLike = None,
    out: str | os.PathLike[str] | None = None,
) -> Result:
    """Proves that the closed loop reaches the goal, or says where it fails: ``surepose certify``.

    Noise bounds are in meters, degrees and meters per second. ``result.certified`` is the verdict.
    """
    arguments = [*_option("--period", period), *_option("--noise-position", noise_position)]
    arguments += [*_option("--noise-heading", noise_heading), *_option("--noise-speed", noise_speed)]
    arguments += [*(["--gaussian"] if gaussian else []), *_option("--out", out)]
    return _run(["certify"], arguments, config)


def tune(*arguments: str, config: ConfigLike = None, **options: Value) -> Result:
    """Finds certified gains with minimum time: ``surepose tune``. Options are keywords: ``period=0.05`` is ``--period 0.05``."""
    return _run(["tune"], [*arguments, *_options(options)], config)


def replay(format: str, path: str | os.PathLike[str], *, config: ConfigLike = None, **options: Value) -> Result:
    """Runs the estimator on a recording: ``surepose replay FORMAT PATH``.

    Options are keywords: ``map="walls.toml"`` is ``--map walls.toml``, and ``compass=True`` is ``--compass``.
    """
    return _run(["replay", format, os.fspath(path)], _options(options), config)


def calibrate(format: str, path: str | os.PathLike[str], *, config: ConfigLike = None, **options: Value) -> Result:
    """Calibrates wheels and sensors from a recording: ``surepose calibrate FORMAT PATH``. Options as in :func:`replay`."""
    return _run(["calibrate", format, os.fspath(path)], _options(options), config)


def map_from_grid(grid: str | os.PathLike[str], out: str | os.PathLike[str]) -> Result:
    """Traces the walls of an occupancy grid of map_server (.yaml) and writes a wall map: ``surepose map from-grid``."""
    return _run(["map", "from-grid", os.fspath(grid)], ["--out", os.fspath(out)], None)


def map_from_log(format: str, path: str | os.PathLike[str], out: str | os.PathLike[str], **options: Value) -> Result:
    """Fits walls to the scans of a recording and writes a wall map: ``surepose map from-log``."""
    return _run(["map", "from-log", format, os.fspath(path)], ["--out", os.fspath(out), *_options(options)], None)


def _run(command: list[str], arguments: list[str], config: ConfigLike) -> Result:
    text, exit_code, messages, arrays = call([*command, *arguments, *_config(config)])
    for message in messages:
        python_warnings.warn(message, stacklevel=3)
    summary = json.loads(text) if text.strip() else {}
    return Result(command[0], summary, arrays, exit_code, messages)


def _config(config: ConfigLike) -> list[str]:
    if config is None:
        return []
    if isinstance(config, (str, os.PathLike)):
        return ["--config", os.fspath(config)]
    if isinstance(config, Mapping):
        return [word for key, value in config.items() for word in ("--set", f"{key}={_text(value)}")]
    raise TypeError(f"config: expected a mapping or the path of a TOML file, got {type(config).__name__}")


def _world(world: Mapping[str, Value] | None) -> list[str]:
    return [word for key, value in (world or {}).items() for word in ("--world", f"{key}={_text(value)}")]


def _option(name: str, value: object) -> list[str]:
    return [] if value is None else [name, _text(value)]


def _options(options: Mapping[str, Value]) -> list[str]:
    words: list[str] = []
    for key, value in options.items():
        name = "--" + key.replace("_", "-")
        if value is True:
            words.append(name)
        elif value is not False and value is not None:
            words += [name, _text(value)]
    return words


def _text(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    if isinstance(value, os.PathLike):
        return str(Path(value))
    return str(value)


def _pose(name: str, pose: PoseLike | None) -> str | None:
    if pose is None:
        return None
    numbers: list[Any] = list(pose)
    if len(numbers) != 3:
        raise ValueError(f"{name}: expected (x, y, heading_deg), got {len(numbers)} values")
    return ",".join(_text(float(number)) for number in numbers)
