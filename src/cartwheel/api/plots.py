"""Plots of numbers over time, drawn by matplotlib."""

from __future__ import annotations

import io
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from cartwheel.codes.command import OPTION_INVALID
from cartwheel.codes.wires import PACKAGE_MISSING
from cartwheel.errors import CartwheelError
from cartwheel.geometry import Array

_SIZE = (8.0, 3.0)
"""Inches."""


class Plot:
    """Curves over the simulation time, which notebooks display.

    Args:
        times: s, shape (n,).
        series: Values by name, each of shape (n,).
        title: Title.

    Raises:
        CartwheelError: There are no series, or matplotlib is not installed.
    """

    def __init__(self, times: Array, series: Mapping[str, Array], *, title: str = "") -> None:
        if not series:
            raise CartwheelError("a plot needs at least one field", code=OPTION_INVALID)
        _figures()
        self.times = times
        """s, shape (n,)."""
        self.series = dict(series)
        """Values by name, each of shape (n,)."""
        self.title = title

    def __repr__(self) -> str:
        return f"<Plot of {', '.join(self.series)}, {len(self.times)} points>"

    def figure(self) -> Any:
        """A new ``matplotlib.figure.Figure``, to be changed or saved."""
        figure = _figures()(figsize=_SIZE, layout="constrained")
        axes = figure.subplots()
        for name, values in self.series.items():
            axes.plot(self.times, values, label=name)
        axes.set(xlabel="simulation time (s)", title=self.title)
        axes.grid(visible=True, alpha=0.3)
        axes.legend()
        return figure

    def save(self, file: str | Path) -> None:
        """Writes the plot to a file.

        Args:
            file: The suffix selects the format: ``.png``, ``.svg``, ``.pdf`` and others.

        Raises:
            ValueError: The suffix is unknown.
            OSError: The file cannot be written.
        """
        self.figure().savefig(file)

    def _repr_png_(self) -> bytes:
        file = io.BytesIO()
        self.figure().savefig(file, format="png")
        return file.getvalue()


def _figures() -> Any:
    """The class of matplotlib's figures, without the global state of pyplot."""
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise CartwheelError(
            f"plots require the package matplotlib: {error}",
            code=PACKAGE_MISSING,
            hint='pip install "cartwheel[notebook]"',
            values={"package": "matplotlib", "extra": "notebook"},
        ) from None
    return Figure
