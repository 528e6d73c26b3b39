"""Tables of columns in the memory of the library."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING

from profidrive._render import LAST, page, table
from profidrive.errors import UnsupportedError
from profidrive.types import Path

if TYPE_CHECKING:
    import numpy

    from profidrive import _profidrive


OF_ALL = ("t", "wall", "drive", "gap")
"""Columns that every table has."""


class Table:
    """Samples of drives, a row for each time at which something of a drive changed.

    The columns are `t` (time from the start), `wall` (time of day, UTC; null in virtual time), `drive`, `gap` (true where values
    are missing), then one for each signal; `units` has their units. `pyarrow.table(t)`, `polars.DataFrame(t)` and duckdb take a
    table as it is, without a copy. `t["speed"]` is a read-only numpy array of the same memory.
    """

    __slots__ = ("_look", "_write")

    def __init__(self, look: Callable[[], _profidrive.Table], write: Callable[[str], None]) -> None:
        self._look = look
        self._write = write

    @property
    def _table(self) -> _profidrive.Table:
        return self._look()

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns."""
        return tuple(name for name, _ in self._table.columns())

    @property
    def units(self) -> Mapping[str, str]:
        """Units of the columns, empty for none."""
        return dict(self._table.columns())

    @property
    def metadata(self) -> Mapping[str, str]:
        """The form of the table and the version of the library; of a run its seed, and a hash of its plant whatever its seed."""
        return dict(self._table.metadata())

    def __len__(self) -> int:
        return len(self._table)

    def __iter__(self) -> Iterator[str]:
        return iter(self.columns)

    def __contains__(self, column: object) -> bool:
        return column in self.columns

    def __getitem__(self, column: str) -> numpy.ndarray:
        """A column as a numpy array: a view of numbers and times, a copy of names, flags and times of day.

        Times of day are UTC, `NaT` where they are not known.
        """
        try:
            import numpy
        except ImportError as error:
            raise UnsupportedError("columns as arrays need numpy", hint='pip install "profidrive[numpy]"') from error
        table = self._table
        if column == "gap":
            return numpy.array(table.bits(column), bool)
        numbers = numpy.asarray(table.column(column))
        texts = table.texts(column)
        return numpy.array(texts)[numbers] if texts else numbers

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        """The Arrow stream of the PyCapsule interface."""
        return self._table.__arrow_c_stream__(requested_schema)

    def write(self, path: Path) -> None:
        """Writes a new file whose name decides its form: `.csv`, `.arrow`, `.arrows`, `.feather` or `.parquet`."""
        self._write(os.fspath(path))

    def _repr_html_(self) -> str:
        """The last rows, for notebooks."""
        columns = [name for name in self.columns if name not in ("wall", "gap")]
        values = [self[name][-LAST:].tolist() for name in columns]
        units = [f"{name} ({self.units[name]})" if self.units[name] else name for name in columns]
        caption = f"{len(self)} rows" + (f", the last {LAST}" if len(self) > LAST else "")
        return page(table(["t (ns)", *units[1:]], zip(*values, strict=True), caption))

    def __repr__(self) -> str:
        return f"<Table of {len(self)} rows: {', '.join(self.columns)}>"


__all__ = ["Table"]
