"""Tables for notebooks: bounded, without scripts and external resources, every text escaped."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from profidrive.reports import DiffReport, Parameter, ScanReport, StatusReport

LAST = 100
"""Rows of a table at most."""
_OCTETS = 50_000
"""Octets of a page at most."""
_OF_TABLE = 24_000
"""Octets of the rows of a table at most."""
_OF_TEXT = 300
"""Characters of a text at most."""

_SHAPES = {"runs": ("green", "\u25cf"), "waits": ("gray", "\u25cb"), "held": ("firebrick", "\u25a0")}
"""What a verdict looks like: colours alone are not seen by all."""


def table(heads: Sequence[str], rows: Iterable[Sequence[object]], caption: str, *, first: bool = False) -> str:
    """The last rows under their heads, or the first ones."""
    all_rows = list(rows)
    chosen = all_rows[:LAST] if first else all_rows[-LAST:]
    shown: list[str] = []
    octets = 0
    for row in chosen if first else reversed(chosen):
        cells = "<tr>" + "".join(f"<td>{escape(_text(value))}</td>" for value in row) + "</tr>"
        octets += len(cells.encode())
        if octets > _OF_TABLE:
            break
        shown.append(cells)
    body = "".join(shown if first else reversed(shown))
    left_out = f", the {'first' if first else 'last'} {len(shown)}" if len(shown) < len(all_rows) else ""
    head = "".join(f"<th>{escape(text)}</th>" for text in heads)
    return f"<table><caption>{escape(caption + left_out)}</caption><thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"


def _text(value: object) -> str:
    text = f"{value:.7g}" if isinstance(value, float) else str(value)
    return text if len(text) <= _OF_TEXT else text[:_OF_TEXT] + "\u2026"


def page(*parts: str) -> str:
    """The parts below each other; those that do not fit are left out."""
    found = ""
    for part in parts:
        if len((found + part).encode()) <= _OCTETS:
            found += part
        else:
            found += "<p>too large to be shown here</p>"
    return found


def stations(report: ScanReport) -> str:
    """Stations of a network."""
    heads = ("name", "model", "IP address", "MAC address", "vendor", "remarks")
    rows = [
        (
            one.name or "",
            one.model or one.type,
            one.ip or "",
            one.mac,
            one.vendor or f"{one.vendor_id:#06x}",
            ", ".join(remark.value.replace("_", " ") for remark in one.remarks),
        )
        for one in report.stations
    ]
    return page(table(heads, rows, f"{len(rows)} stations", first=True))


def status(report: StatusReport) -> str:
    """How a drive is, and why it does not run."""
    colour, shape = _SHAPES.get(report.verdict, _SHAPES["waits"])
    sentence = (
        f'<p><span style="color:{colour}">{shape}</span> <b>{escape(_text(report.drive))}</b> {escape(_text(report.sentence))}</p>'
    )
    quantities = {
        "speed": report.speed_actual,
        "position": report.position,
        "bus voltage": report.bus_voltage,
    }
    rows: list[tuple[str, object]] = [("what to do", report.next)] if report.next else []
    rows.append(("state", report.state_text or ""))
    rows += [(name, f"{_text(one.value)} {one.unit}") for name, one in quantities.items() if one is not None]
    rows += [("fault", f"{one.number} {one.meaning or ''}") for one in report.faults]
    rows += [("warning", f"{one.number} {one.meaning or ''}") for one in report.warnings]
    return page(sentence, table(("", ""), rows, report.drive, first=True))


def differences(report: DiffReport) -> str:
    """Settings that differ."""

    def shown(side: Parameter | None) -> str:
        return "" if side is None else f"{_text(side.text or '')} {side.unit}".strip()

    rows: list[tuple[str, str, str]] = []
    for one in report.differences:
        known = one.left or one.right
        rows.append((one.name or (known.number if known else ""), shown(one.left), shown(one.right)))
    rows += [(f"motion task {task.number}", "", "") for task in report.tasks]
    return page(table(("setting", report.left, report.right), rows, f"{len(rows)} differences", first=True))
