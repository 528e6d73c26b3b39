"""What happened in a plant."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, TypeVar

from profidrive._render import page, table
from profidrive._values import chosen, expectation_text, span
from profidrive.errors import ExpectationFailed, UsageError
from profidrive.events import Event, ExpectationResult, FaultRaised, Outcome, Sample, event_of
from profidrive.table import Table
from profidrive.types import Duration, Path

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from profidrive import _profidrive

E = TypeVar("E")


class Trace:
    """A run of a plant from its start to `end`. The same plant, seed and calls give the same `digest`."""

    def __init__(self, trace: _profidrive.Trace, drive: str | None = None) -> None:
        self._trace = trace
        self._drive = drive

    @property
    def seed(self) -> int:
        """The seed of the run."""
        return self._trace.seed

    @property
    def end(self) -> float:
        """Seconds from the start to the end of the trace."""
        return self._trace.end

    @property
    def cut(self) -> float | None:
        """The time up to which there was room for the trace, when the run went on longer."""
        return self._trace.cut

    @cached_property
    def digest(self) -> str:
        """The same for the same run: of its events, its frames and all drives, whatever was `cut`."""
        return self._trace.digest()

    @property
    def drives(self) -> tuple[str, ...]:
        """Names of the drives that the trace has."""
        return tuple(self._trace.drives) if self._drive is None else (self._drive,)

    @cached_property
    def events(self) -> Sequence[Event]:
        """The events in their order."""
        events: list[dict[str, Any]] = json.loads(self._trace.events())
        return tuple(event_of(event) for event in events if self._drive in (None, event["drive"]))

    @cached_property
    def samples(self) -> Table:
        """Words and quantities of the drives at each time at which they changed."""
        samples = self._trace.samples(self._drive)
        return Table(lambda: samples, self.write)

    def of(self, drive: str) -> Trace:
        """Returns what the trace has of one drive."""
        return Trace(self._trace, chosen(self.drives, drive, "drive"))

    def only(self, kind: type[E]) -> Sequence[E]:
        """Returns the events of one class."""
        return tuple(event for event in self.events if isinstance(event, kind))

    def at(self, time: Duration) -> Mapping[str, Sample]:
        """Returns each drive by name as it was at a time, after everything that happened until then."""
        found: list[dict[str, Any]] = json.loads(self._trace.at(span(time), self._drive))
        if not found:
            raise UsageError(f"the trace ends at {self.end} s and has nothing at {time}")
        return {sample["drive"]: Sample._of(sample) for sample in found}

    def check(self, *expectations: str | Mapping[str, object]) -> tuple[ExpectationResult, ...]:
        """Returns what came of expectations; of those of the plant file where none is given."""
        return tuple(result for result, _ in self._checked(expectations))

    def expect(self, *expectations: str | Mapping[str, object]) -> tuple[ExpectationResult, ...]:
        """Checks expectations as plant files have them, as mappings or as texts; those of the plant file where none is given.

        Returns the results.

        Raises:
            ExpectationFailed: when one did not come true; it has all results.
        """
        return judged(self._checked(expectations))

    def _checked(self, expectations: tuple[str | Mapping[str, object], ...]) -> list[tuple[ExpectationResult, str]]:
        texts = [expectation_text(expectation) for expectation in expectations]
        results = read_results(self._trace.expect(texts))
        mine = [pair for pair in results if self._drive in (None, pair[0].drive)]
        if self._drive is not None and results and not mine:
            raise UsageError(f"nothing is expected of {self._drive}", drive=self._drive)
        return mine

    def write(self, path: Path) -> None:
        """Writes the samples to a new file whose name decides its form: `.csv`, `.arrow`, `.arrows`, `.feather` or `.parquet`."""
        self._trace.write(os.fspath(path), self._drive)

    def write_events(self, path: Path) -> None:
        """Writes the events to a file, a JSON document a line."""
        with open(path, "w", encoding="utf-8") as file:
            for event in json.loads(self._trace.events()):
                if self._drive in (None, event["drive"]):
                    file.write(json.dumps(event) + "\n")

    def draw(self, path: Path, columns: Sequence[str] = ("speed", "position"), title: str = "") -> None:
        """Draws columns of the samples to a file (SVG), with a mark for each fault. Needs no other package."""
        for column in columns:
            chosen(self.samples.columns, column, "column")
        with open(path, "w", encoding="utf-8") as file:
            file.write(self._trace.picture(title, list(columns), self._drive))

    def plot(self, signals: Sequence[str] = ("speed",), ax: Axes | None = None) -> Axes:
        """Plots columns of the samples with matplotlib, marks the faults, and returns the axes."""
        from profidrive._plot import plot

        faults = [(event.time, f"{event.drive} fault {event.fault.number}") for event in self.only(FaultRaised)]
        return plot(self.samples, self.drives, signals, ax, faults=faults)

    def lines(self) -> tuple[str, ...]:
        """Returns the events as lines of text."""
        pairs = zip(self._trace.lines(), json.loads(self._trace.events()), strict=True)
        return tuple(line for line, event in pairs if self._drive in (None, event["drive"]))

    def _repr_html_(self) -> str:
        """The speeds as a picture and the last events, for notebooks."""
        events = list(zip((event.drive for event in self.events), self.lines(), strict=True))
        rows = [(line.split(maxsplit=2)[0], drive, line.split(maxsplit=3)[-1]) for drive, line in events]
        picture = self._trace.picture(repr(self), ["speed"], self._drive)
        return page(picture, table(("s", "drive", "event"), rows, f"{len(rows)} events"))

    def __repr__(self) -> str:
        return f"<Trace of {', '.join(self.drives)}: {self.end} s, seed {self.seed}>"


def read_results(pairs: list[tuple[str, str]]) -> list[tuple[ExpectationResult, str]]:
    """Returns results with their texts."""
    return [(ExpectationResult._of(json.loads(result)), text) for result, text in pairs]


def judged(results: list[tuple[ExpectationResult, str]]) -> tuple[ExpectationResult, ...]:
    """Returns the results when all came true."""
    lost = [text for result, text in results if result.outcome is not Outcome.MET]
    found = tuple(result for result, _ in results)
    if lost:
        head = f"{len(lost)} of {len(results)} expectations lost"
        raise ExpectationFailed("\n".join([head, *lost]), results=found)
    return found


__all__ = ["Trace"]
