"""Sweeps, certificates and tuning over the nodes of a Ray cluster, with the results of one machine, bit for bit.

>>> import ray, surepose.cluster                                   # doctest: +SKIP
>>> ray.init(address="auto")                                       # doctest: +SKIP
>>> surepose.cluster.sweep(10**9, noise="bench").success_rate      # doctest: +SKIP

Each trial draws its start and its noise from the seed and its own number, so that the split does not matter. A worker that dies
loses its part, which another worker repeats.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np

from . import commands
from ._surepose import sweep_figures
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
    """The figures of ``surepose sweep`` for these trials, computed by the same code; ``part`` has the settings."""
    summary = json.loads(sweep_figures(trials, part["seed"]))
    for time in ("wall_s", "steps_per_s"):
        del summary[time]
    return {**summary, **_settings(part)}


def _settings(part: dict[str, Any]) -> dict[str, Any]:
    names = ("seed", "loop", "noise", "period_s", "law", "precision")
    return {name: part[name] for name in names if name in part}


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
        for name in self.NAMES:
            values = trials.get(name, np.array([]))
            finite = values[np.isfinite(values)]
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
        return {**summary, **_settings(part)}
