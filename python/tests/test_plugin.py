"""The pytest plugin, in pytest runs of its own."""

from __future__ import annotations

import json
import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

from .conftest import PRESS

LOST = """
import pytest

@pytest.mark.plant("press.toml")
def test_lost(world):
    world.run("5s").expect({"at": "4s", "drive": "press-1", "speed": "130rpm", "tolerance": "1%"})
"""


@pytest.fixture(autouse=True)
def _press(pytester: pytest.Pytester) -> None:
    pytester.path.joinpath("press.toml").write_text(PRESS.read_text())


def test_the_fixtures_have_the_plant_of_the_marker(pytester: pytest.Pytester) -> None:
    pytester.makepyfile("""
        import pytest

        def test_without_a_marker(plant, world):
            assert plant.drives == ("akd-1",)
            assert world.now == 0

        @pytest.mark.plant("press.toml")
        def test_of_a_file(world):
            assert world.seed == 7

        @pytest.mark.plant("press.toml", changes={"drive": 5})
        def test_with_changes(plant, world):
            pass
    """)
    result = pytester.runpytest("-p", "no:cacheprovider")
    result.assert_outcomes(passed=2, errors=1)
    result.stdout.fnmatch_lines(["*drive: *path ends at one value*"])


def test_seed_and_changes_of_the_marker(pytester: pytest.Pytester) -> None:
    pytester.makepyfile("""
        import pytest

        @pytest.mark.plant("press.toml", seed=9, changes={"drive.press-1.load.friction": 0.4})
        def test_it(plant, world):
            assert "friction = 0.4" in plant.to_toml()
            assert (plant.seed, world.seed) == (9, 9)
    """)
    pytester.runpytest().assert_outcomes(passed=1)


def test_seeds_run_a_test_once_for_each(pytester: pytest.Pytester) -> None:
    pytester.makepyfile("""
        import pytest

        @pytest.mark.seeds(range(3))
        def test_it(world):
            assert world.seed != 1
    """)
    result = pytester.runpytest("-v", "-n", "2")
    result.assert_outcomes(passed=2, failed=1)
    result.stdout.fnmatch_lines(
        ["*reproduce: pytest 'test_seeds_run_a_test_once_for_each.py::test_it[[]seed=1[]]' --profidrive-seed 1*"]
    )
    # as the report says
    again = pytester.runpytest("test_seeds_run_a_test_once_for_each.py::test_it[seed=1]", "--profidrive-seed", "1")
    again.assert_outcomes(failed=1)
    pytester.runpytest("--profidrive-seed", "5").assert_outcomes(passed=1)


def test_a_failure_shows_the_last_events_and_how_to_repeat_it(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(LOST)
    result = pytester.runpytest()
    result.assert_outcomes(failed=1)
    # where `CI` is set, pytest repeats the whole message in its summary at the end
    section = "\n".join(result.outlines).split("profidrive trace")[1].split("short test summary")[0]
    lines = section.splitlines()
    marked = [line for line in lines if line.startswith("> ")]
    assert len(marked) == 1
    assert float(re.findall(r"[0-9.]+", marked[0])[0]) <= 4.0
    assert len([line for line in lines if " s  " in line]) <= 21
    assert "reproduce: pytest" in section
    assert "--profidrive-seed 7" in section
    assert not list(pytester.path.glob("*.pcapng"))


def test_a_report_has_events_samples_picture_and_frames(pytester: pytest.Pytester, tmp_path: Path) -> None:
    pytester.makepyfile(LOST + "\n\ndef test_met(world):\n    world.run(for_=0.1)\n")
    folder = tmp_path / "a" / "b"
    for times in (1, 2):
        result = pytester.runpytest(
            "--profidrive-report", str(folder), "--junit-xml", "junit.xml", "-o", "junit_logging=system-out"
        )
        result.assert_outcomes(failed=1, passed=1)
        names = sorted(file.name for file in folder.iterdir())
        # nothing of a test that passed, and nothing of an earlier run is replaced
        assert len(names) == 4 * times
        assert all("test_lost" in name for name in names)
    cases = ElementTree.parse(pytester.path / "junit.xml").getroot().iter("testcase")
    lost = next(case for case in cases if case.get("name") == "test_lost")
    attached = re.findall(r"\[\[ATTACHMENT\|(.*?)\]\]", lost.findtext("system-out") or "")
    assert [Path(path).suffix for path in attached] == [".jsonl", ".arrow", ".svg", ".pcapng"]
    assert [entry.get("value") for entry in lost.iter("property")] == attached
    events = [json.loads(line) for line in Path(attached[0]).read_text().splitlines()]
    assert events[-1]["time"] <= 5
    assert Path(attached[3]).read_bytes()[:4] == b"\x0a\x0d\x0d\x0a"


def test_a_fixture_that_fails_has_a_report_too(pytester: pytest.Pytester) -> None:
    pytester.makepyfile("""
        import pytest

        @pytest.fixture
        def ready(world):
            world.run_until("press-1", fault=702, timeout="100ms")

        @pytest.fixture
        def absent(world):
            pytest.skip("not here")

        def test_ready(ready):
            pass

        def test_absent(absent):
            pass
    """)
    result = pytester.runpytest("--profidrive-report", "report")
    result.assert_outcomes(errors=1, skipped=1)
    result.stdout.fnmatch_lines(["*profidrive trace*"])
    assert len(list(pytester.path.joinpath("report").iterdir())) == 4


def test_a_report_that_cannot_be_written_does_not_hide_the_failure(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(LOST)
    pytester.path.joinpath("taken").write_text("a file")
    result = pytester.runpytest("--profidrive-report", "taken")
    result.assert_outcomes(errors=1)
    result.stdout.fnmatch_lines(["*taken*"])


def test_plant_files_with_expectations_are_tests_where_they_are_wanted(pytester: pytest.Pytester) -> None:
    pytester.path.joinpath("other.toml").write_text('[[drive]]\nname = "akd-1"\n')
    # of `simulate --expect`
    pytester.path.joinpath("alone.toml").write_text('[[expect]]\nnever = true\ndrive = ["press-1"]\nfault = 439\n')
    pytester.runpytest().assert_outcomes()
    pytester.makeini("[pytest]\nprofidrive_collect_plants = true\n")
    result = pytester.runpytest("-v")
    result.assert_outcomes(passed=5)
    result.stdout.fnmatch_lines(["*press.toml::reaches speed PASSED*"])
    changed = PRESS.read_text().replace('speed = "120rpm", tolerance', 'speed = "130rpm", tolerance')
    pytester.path.joinpath("press.toml").write_text(changed)
    result = pytester.runpytest()
    result.assert_outcomes(passed=4, failed=1)
    result.stdout.fnmatch_lines(["*line 7: press-1: reaches speed: not met", "*actual: *", "*profidrive trace*"])
    # expectations as tables
    pytester.path.joinpath("press.toml").unlink()
    pytester.path.joinpath("other.toml").write_text(
        'duration = "1s"\n[[expect]]\nname = "rests"\nalways = true\ndrive = "akd-1"\nmoving = false\n[[drive]]\nname = "akd-1"\n'
    )
    pytester.runpytest("--override-ini", "python_files=none").assert_outcomes(passed=1)


def test_mistakes_of_markers_are_errors_of_the_test(pytester: pytest.Pytester) -> None:
    pytester.makepyfile("""
        import pytest

        @pytest.mark.plant("no-such.toml")
        def test_no_file(world):
            pass

        @pytest.mark.plant("press.toml", sede=7)
        def test_misspelled(world):
            pass
    """)
    result = pytester.runpytest()
    result.assert_outcomes(errors=2)
    result.stdout.fnmatch_lines(["*no-such.toml: *", "*write @pytest.mark.plant*"])
    pytester.makepyfile("import pytest\n\n@pytest.mark.seeds([1])\ndef test_it():\n    pass\n")
    pytester.runpytest().stdout.fnmatch_lines(["*`seeds` belongs to a test with the fixture plant or world*"])


def test_the_plugin_loads_nothing_before_a_fixture_is_used(pytester: pytest.Pytester) -> None:
    pytester.makepyfile("""
        import sys

        def test_it():
            assert "profidrive.pytest_plugin" in sys.modules
            assert "profidrive._profidrive" not in sys.modules
    """)
    pytester.runpytest_subprocess(timeout=60).assert_outcomes(passed=1)
