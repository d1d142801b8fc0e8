"""Result of a command: figures by name, arrays, and a picture."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy.typing as npt

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Array = npt.NDArray[Any]


class Result:
    """Figures of a command, as attributes and in :attr:`summary`, with its arrays in :attr:`arrays`.

    ``result.outcome`` and ``result["outcome"]`` are the same figure; the names are the JSON keys of the program. A figure that
    does not exist raises ``AttributeError`` or ``KeyError``.
    """

    def __init__(
        self,
        command: str,
        summary: Mapping[str, Any],
        arrays: Mapping[str, Array],
        exit_code: int,
        warnings: list[str],
    ) -> None:
        self.command = command
        self.summary = dict(summary)
        self.arrays = dict(arrays)
        self.exit_code = exit_code
        self.warnings = warnings

    def __getattr__(self, name: str) -> Any:
        summary = self.__dict__.get("summary", {})
        if name in summary:
            return summary[name]
        raise AttributeError(f"{name}: no such figure (available: {', '.join(summary)})")

    def __getitem__(self, name: str) -> Any:
        if name in self.summary:
            return self.summary[name]
        if name in self.arrays:
            return self.arrays[name]
        raise KeyError(f"{name}: no such figure or array")

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self.summary]

    def __repr__(self) -> str:
        shown = ", ".join(f"{key}={value!r}" for key, value in list(self.summary.items())[:6])
        return f"Result({self.command}: {shown}{', …' if len(self.summary) > 6 else ''})"

    @property
    def ok(self) -> bool:
        """Whether the outcome is positive: goal reached, certificate holds, estimate consistent."""
        return self.exit_code == 0

    def to_dict(self) -> dict[str, Array]:
        """Columns of equal length, for ``pandas.DataFrame`` or ``polars.DataFrame``."""
        return dict(self.arrays)

    def plot(self, ax: Axes | None = None) -> Axes:
        """Draws the result on matplotlib axes: the path of a drive, or the times of a sweep."""
        from .plot import plot

        return plot(self, ax)
