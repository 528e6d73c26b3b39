"""What notebooks show."""

from __future__ import annotations

import re
from dataclasses import fields, is_dataclass, replace
from enum import Enum
from typing import Any

import matplotlib
import pytest
from matplotlib import pyplot

from profidrive import Plant, sweep
from profidrive._render import page
from profidrive.errors import UsageError


def test_a_trace_is_a_picture_and_its_last_events(press: Plant) -> None:
    html = press.run()._repr_html_()
    assert html.count("<svg") == 1
    assert "702 Fieldbus communication lost" in html
    assert len(html.encode()) < 60_000
    assert not re.search(r"<script|src=|href=", html)


def test_texts_of_drives_are_escaped() -> None:
    world = Plant.of("vlt").start()
    world["vlt-1"].write({"p37": "<script>x"})
    html = world.run(for_="10ms")._repr_html_()
    assert "&lt;script&gt;x" in html
    assert "<script" not in html


def test_samples_are_their_last_rows_with_units(press: Plant) -> None:
    html = press.run("3s").samples._repr_html_()
    assert "<th>speed (rpm)</th>" in html
    assert html.count("<tr>") == 101
    assert ", the last 100" in html or "rows" in html


def test_what_is_too_large_is_left_out() -> None:
    html = page("<p>x</p>", "y" * 60_000, "<p>z</p>")
    assert html == "<p>x</p><p>too large to be shown here</p><p>z</p>"


HOSTILE = "<script>alert('x')</script>" + "<b>&" * 200


def assert_is_safe(html: str) -> None:
    assert len(html.encode()) <= 50_000
    assert html.count("<tr>") <= 2 * 101
    assert not re.search(r"<script|<b>&<|<iframe|javascript:|\bon\w+=|src=|href=", html)


def hostile(value: Any) -> Any:
    """The same report with another text in each field, a hundred times in each list."""
    if isinstance(value, tuple) and value:
        return tuple(hostile(one) for one in value) * 150
    if isinstance(value, str) and not isinstance(value, Enum):
        return HOSTILE
    if is_dataclass(value) and not isinstance(value, type):
        return replace(value, **{field.name: hostile(getattr(value, field.name)) for field in fields(value)})
    return value


def test_reports_are_tables_whose_texts_are_escaped_and_bounded() -> None:
    world = Plant.of("akd", "vlt").start()
    network = world.network
    drive = network["akd-1"]
    saved = drive.backup()
    drive.write({"DRV.ACC": "5000rpm/s"})
    world["akd-1"].inject("fault=439")
    shown: dict[str, Any] = {
        "akd-1": network.scan(wait="1s"),
        "439": drive.status(),
        "DRV.ACC": drive.diff(saved),
        "5000": drive.read(["DRV.ACC", "DRV.ACX"], errors="collect"),
    }
    for what, report in shown.items():
        html = report._repr_html_()
        assert what in html, html
        assert "<table>" in html
        assert_is_safe(html)
    for report in list(shown.values())[:3]:
        html = hostile(report)._repr_html_()
        assert "&lt;script&gt;" in html
        assert_is_safe(html)
    readings = drive.read(["DRV.ACC"])
    html = type(readings)(hostile(tuple(readings)), [UsageError(HOSTILE)] * 200)._repr_html_()
    assert "&lt;script&gt;" in html
    assert "the first" in html
    assert_is_safe(html)


def test_a_recording_is_a_picture_and_its_last_rows() -> None:
    drive = Plant.of("akd").start().network["akd-1"]
    html = drive.record(["DRV.ACC", "p922"], for_="2s", every="10ms")._repr_html_()
    assert html.count("<svg") == 1
    assert "the last 1" in html
    assert_is_safe(html)


def test_a_sweep_is_its_failures(press: Plant) -> None:
    name = "<script>x"
    expect = [{"name": name, "never": True, "drive": "press-1", "speed": ">50rpm"}]
    result = sweep(press.with_changes({"expect": expect}), seeds=range(3), until="3s", chunk=3)
    html = result._repr_html_()
    assert "3 runs, 3 failed" in html
    assert "&lt;script&gt;x" in html
    assert_is_safe(html)


def test_plots_have_units_gaps_and_faults(press: Plant) -> None:
    matplotlib.use("agg")
    figure = pyplot.figure()
    axes = press.run("21s").plot(("speed", "position"), ax=figure.add_subplot(2, 1, 1))
    assert axes.get_ylabel() == "speed (rpm), position (rev)"
    assert any("702" in text.get_text() for text in axes.texts)
    world = Plant.of("akd").start()
    drive = world.network["akd-1"]
    with drive.record(["DRV.ACC", "p922"], every="100ms") as recording:
        world.run(for_="500ms")
        world["akd-1"].inject("cable=pulled", for_="1s")
        world.run(for_="2s")
    assert recording.gaps()
    axes = recording.plot(["DRV.ACC"], ax=figure.add_subplot(2, 1, 2))
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("time (s)", "DRV.ACC (rpm/s)")
    dotted = [line for line in axes.lines if line.get_linestyle() == ":"]
    assert len(dotted) == len(recording.gaps())
    assert recording.plot(ax=axes) is axes
    with pytest.raises(UsageError, match="column"):
        recording.plot(["speeed"], ax=axes)
    pyplot.close(figure)
