"""Plots of tables with matplotlib, where that is installed."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING

from profidrive._values import chosen
from profidrive.errors import UnsupportedError
from profidrive.table import Table

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_MARKS = 100
"""Marks at most: more of them hide what they mark."""


def plot(
    table: Table,
    drives: Sequence[str],
    signals: Sequence[str],
    ax: Axes | None,
    *,
    gaps: Iterable[float] = (),
    faults: Iterable[tuple[float, str]] = (),
) -> Axes:
    """Plots columns of drives over the time, marks gaps and faults, and returns the axes."""
    try:
        from matplotlib import pyplot
    except ImportError as error:
        raise UnsupportedError("plots need matplotlib", hint='pip install "profidrive[plot]"') from error
    axes = pyplot.gca() if ax is None else ax
    for signal in signals:
        chosen(table.columns, signal, "column")
    seconds, names, units = table["t"].astype("int64") / 1e9, table["drive"], table.units
    for drive in drives:
        rows = names == drive
        for signal in signals:
            axes.plot(seconds[rows], table[signal][rows], drawstyle="steps-post", label=f"{drive} {signal}")
    for time in list(gaps)[:_MARKS]:
        axes.axvline(time, color="0.6", linestyle=":", linewidth=0.8)
    for time, text in list(faults)[:_MARKS]:
        axes.axvline(time, color="tab:red", linestyle="--", linewidth=0.8)
        axes.annotate(text, (time, 1), xycoords=("data", "axes fraction"), rotation=90, va="top", fontsize="small")
    axes.set_xlabel("time (s)")
    labels = [f"{signal} ({units[signal]})" if units[signal] else signal for signal in signals]
    axes.set_ylabel(", ".join(labels))
    if drives and signals:
        axes.legend()
    return axes
