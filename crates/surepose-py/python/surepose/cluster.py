"""Sweeps, certificates and tuning over the nodes of a Ray cluster, with the results of one machine, bit for bit.

>>> import ray, surepose.cluster                                   # doctest: +SKIP
>>> ray.init(address="auto")                                       # doctest: +SKIP
>>> surepose.cluster.sweep(10**9, noise="bench").success_rate      # doctest: +SKIP

Each trial draws its start and its noise from the seed and its own number, so that the split does not matter. A worker that dies
loses its part, which another worker repeats.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from . import commands
from .result import Array, Result

PART = 100_000
"""Default number of trials of a part: about a third of a second on two cores."""


def sweep(runs: int, *, first: int = 0, part: int = PART, keep_trials: bool = True, **options: Any) -> Result:
    """Runs a sweep in parts over the cluster; the arguments are those of :func:`surepose.sweep`, with random starts.

    ``keep_trials=False`` keeps no trial after its part: then the quantiles, which need all trials, are those of a histogram with a
    resolution of 0.1 %, and a sweep of any length fits into memory.
    """
    import ray

    if part < 1:
        raise ValueError(f"part: expected at least 1 trial (got {part})")
    remote = ray.remote(max_retries=-1)(_part)
    ranges = [(start, min(part, first + runs - start)) for start in range(first, first + runs, part)]
    # A few parts per core are under way; the rest waits here, not in the object store.
    limit = max(4, 2 * int(ray.cluster_resources().get("CPU", 1)))
    pending: dict[Any, int] = {}
    results: list[dict[str, Array] | None] = [None] * len(ranges)
    summary: dict[str, Any] = {}
    histogram = Histogram()
    for index in range(len(ranges) + 1):
        while pending and (len(pending) >= limit or index == len(ranges)):
            done, _ = ray.wait(list(pending), num_returns=1)
            arrays, summary = ray.get(done[0])
            number = pending.pop(done[0])
            if keep_trials:
                results[number] = arrays
            else:
                histogram.add(arrays)
        if index < len(ranges):
            pending[remote.remote(*ranges[index], options)] = index
    if not keep_trials:
        return Result("sweep", histogram.figures(summary), {}, 0, [])
    parts = [arrays for arrays in results if arrays is not None]
    names = dict.fromkeys(name for arrays in parts for name in arrays)
    trials = {name: np.concatenate([_column(arrays, name) for arrays in parts]) for name in names}
    return Result("sweep", figures(trials, summary), trials, 0, [])


def certify(cases: Iterable[Mapping[str, Any]]) -> list[Result]:
    """Runs :func:`surepose.certify` for each case, a mapping of its arguments; the results are in the order of the cases."""
    return _each(commands.certify, cases)


def tune(cases: Iterable[Mapping[str, Any]]) -> list[Result]:
    """Runs :func:`surepose.tune` for each case, a mapping of its arguments; the results are in the order of the cases."""
    return _each(commands.tune, cases)


def _each(command: Callable[..., Result], cases: Iterable[Mapping[str, Any]]) -> list[Result]:
    import ray

    remote = ray.remote(max_retries=-1)(lambda case: command(**case))
    results: list[Result] = ray.get([remote.remote(dict(case)) for case in cases])
    return results


def _part(first: int, count: int, options: dict[str, Any]) -> tuple[dict[str, Array], dict[str, Any]]:
    result = commands.sweep(count, first=first, **{"threads": 1, **options})
    return result.arrays, result.summary


def _column(arrays: dict[str, Array], name: str) -> Array:
    """A column of a part; NaN where no trial of the part has the value."""
    return arrays.get(name, np.full(len(arrays["success"]), np.nan))


def figures(trials: dict[str, Array], part: dict[str, Any]) -> dict[str, Any]:
    """The figures of ``surepose sweep`` for these trials; ``part`` has the settings."""
    success = trials["success"]
    time, optimal = trials.get("time_s", np.full(len(success), np.nan)), trials["optimal_time_s"]
    distance = np.hypot(trials["start_x_m"], trials["start_y_m"])
    with np.errstate(divide="ignore", invalid="ignore"):
        time_ratio = np.where(optimal > 0, time / optimal, np.nan)
        path_ratio = np.where(distance > 0, trials.get("path_m", np.full(len(success), np.nan)) / distance, np.nan)
    steps = int(trials["steps"].sum())
    summary = {
        "runs": len(success),
        "success_rate": _mean(success.astype(float)),
        "steps": steps,
        "time_s": quantiles(time),
        "time_ratio": quantiles(time_ratio),
        "path_ratio": quantiles(path_ratio),
        "final_position_error_m": quantiles(trials["final_position_error_m"]),
        "final_heading_error_deg": quantiles(trials["final_heading_error_deg"]),
        "cusps_mean": _mean(trials.get("cusps", np.array([]))),
    }
    weights = trials["steps"].astype(float)
    for name, power in (("nees_mean", 1), ("position_rmse_m", 2), ("heading_rmse_deg", 2), ("refused_part", 1)):
        if name in trials:
            total = _sum(trials[name] ** power * weights) / steps
            summary[name] = total if power == 1 else float(np.sqrt(total))
    settings = ("seed", "loop", "noise", "period_s", "law", "precision")
    return {**summary, **{name: part[name] for name in settings if name in part}}


def quantiles(values: Array) -> dict[str, float] | None:
    """Median, 95 % quantile and maximum: the smallest value that is not below that fraction of all; NaN values are left out."""
    values = np.sort(values[np.isfinite(values)])
    if not len(values):
        return None
    p50, p95 = (float(values[max(int(np.ceil(part * len(values))) - 1, 0)]) for part in (0.5, 0.95))
    return {"p50": p50, "p95": p95, "max": float(values[-1])}


def _sum(values: Array) -> float:
    """Sum from the first to the last, as the program adds: numpy's pairwise sum has other bits."""
    return float(np.add.accumulate(values)[-1]) if len(values) else 0.0


def _mean(values: Array) -> float | None:
    values = values[np.isfinite(values)]
    return _sum(values) / len(values) if len(values) else None


class Histogram:
    """Mergeable figures of any number of trials: exact counts and maxima, quantiles within 0.1 %."""

    NAMES = ("time_s", "time_ratio", "path_ratio", "final_position_error_m", "final_heading_error_deg")
    EDGES = np.concatenate([[0.0], np.geomspace(1e-6, 1e4, 23_040), [np.inf]])

    def __init__(self) -> None:
        self.counts = {name: np.zeros(len(self.EDGES) - 1, dtype=np.int64) for name in self.NAMES}
        self.maxima = dict.fromkeys(self.NAMES, 0.0)
        self.runs = self.successes = self.steps = 0
        self.cusps = 0.0

    def add(self, trials: dict[str, Array]) -> None:
        """Adds the trials of a part. The order of parts does not change the figures: all sums are of integers."""
        success = trials["success"]
        distance = np.hypot(trials["start_x_m"], trials["start_y_m"])
        missing = np.full(len(success), np.nan)
        time, path = trials.get("time_s", missing), trials.get("path_m", missing)
        with np.errstate(divide="ignore", invalid="ignore"):
            values = {
                **trials,
                "time_s": time,
                "time_ratio": time / trials["optimal_time_s"],
                "path_ratio": path / distance,
            }
        for name in self.NAMES:
            finite = values[name][np.isfinite(values[name])]
            self.counts[name] += np.histogram(finite, self.EDGES)[0]
            self.maxima[name] = max(self.maxima[name], float(finite.max(initial=0.0)))
        self.runs += len(success)
        self.successes += int(success.sum())
        self.steps += int(trials["steps"].sum())
        self.cusps += float(np.nansum(trials.get("cusps", np.array([]))))

    def figures(self, part: dict[str, Any]) -> dict[str, Any]:
        """The figures so far; a quantile is the upper edge of its bin."""
        summary: dict[str, Any] = {"runs": self.runs, "success_rate": self.successes / max(self.runs, 1), "steps": self.steps}
        for name in self.NAMES:
            cumulative = self.counts[name].cumsum()
            if cumulative[-1]:
                bins = [int(np.searchsorted(cumulative, np.ceil(q * cumulative[-1]))) for q in (0.5, 0.95)]
                p50, p95 = (min(float(self.EDGES[bin + 1]), self.maxima[name]) for bin in bins)
                summary[name] = {"p50": p50, "p95": p95, "max": self.maxima[name]}
        summary["cusps_mean"] = self.cusps / self.successes if self.successes else None
        settings = ("seed", "loop", "noise", "period_s", "law", "precision")
        return {**summary, **{name: part[name] for name in settings if name in part}}
