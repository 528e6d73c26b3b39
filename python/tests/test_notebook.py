"""What notebooks show."""

from __future__ import annotations

import re

from profidrive import Plant
from profidrive._render import page, table


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
    html = page("<p>x</p>", table(["a"], [["y" * 60_000]], "large"), "<p>z</p>")
    assert html == "<p>x</p><p>too large to be shown here</p><p>z</p>"
