"""Tables for notebooks: bounded, without scripts and external resources, every text escaped."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

LAST = 100
"""Rows of a table at most."""
_OCTETS = 50_000
"""Octets of a page at most."""


def table(heads: Sequence[str], rows: Iterable[Sequence[object]], caption: str) -> str:
    """The last rows under their heads."""
    all_rows = list(rows)
    shown = all_rows[-LAST:]
    left_out = f", the last {len(shown)}" if len(shown) < len(all_rows) else ""
    head = "".join(f"<th>{escape(text)}</th>" for text in heads)
    body = "".join("<tr>" + "".join(f"<td>{escape(_text(value))}</td>" for value in row) + "</tr>" for row in shown)
    return f"<table><caption>{escape(caption + left_out)}</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _text(value: object) -> str:
    return f"{value:.7g}" if isinstance(value, float) else str(value)


def page(*parts: str) -> str:
    """The parts below each other; those that do not fit are left out."""
    found = ""
    for part in parts:
        if len((found + part).encode()) <= _OCTETS:
            found += part
        else:
            found += "<p>too large to be shown here</p>"
    return found
