"""Pictures of results with matplotlib."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from .result import Result


def plot(result: Result, ax: Axes | None = None) -> Axes:
    """Draws a drive as its true and estimated path, and a sweep as a histogram of the time over the least possible."""
    if ax is None:
        import matplotlib.pyplot as plt

        _, ax = plt.subplots()
    if result.command == "run":
        return _drive(result, ax)
    if result.command == "sweep":
        return _times(result, ax)
    raise ValueError(f"plot: no picture for the command {result.command} (expected run or sweep)")


def _drive(result: Result, ax: Axes) -> Axes:
    arrays = result.arrays
    ax.plot(arrays["x_m"], arrays["y_m"], label="true path")
    ax.plot(arrays["estimated_x_m"], arrays["estimated_y_m"], "--", label="estimate")
    heading = np.radians(arrays["heading_deg"])
    for index, label in ((0, "start"), (-1, "end")):
        x, y, angle = arrays["x_m"][index], arrays["y_m"][index], heading[index]
        ax.annotate("", (x + 0.2 * np.cos(angle), y + 0.2 * np.sin(angle)), (x, y), arrowprops={"arrowstyle": "->"})
        ax.annotate(label, (x, y), textcoords="offset points", xytext=(6, -10))
    ax.set_aspect("equal", adjustable="datalim")
    ax.set_xlabel("x [m]")
    ax.set_ylabel("y [m]")
    ax.set_title(f"{result.outcome} after {result.time_s:.1f} s")
    ax.legend()
    return ax


def _times(result: Result, ax: Axes) -> Axes:
    ratio = result.arrays["time_ratio"]
    ratio = ratio[np.isfinite(ratio)]
    ax.hist(ratio, bins=np.linspace(1.0, max(1.6, float(np.quantile(ratio, 0.999))), 60).tolist())
    ax.axvline(float(np.median(ratio)), color="black", linestyle="--", label=f"median {np.median(ratio):.3f}")
    ax.set_xlabel("time over least possible time")
    ax.set_ylabel("trials")
    ax.set_title(f"{result.runs} trials, {100 * result.success_rate:.2f} % succeed")
    ax.legend()
    return ax
