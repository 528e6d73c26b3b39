"""Device descriptions."""

from __future__ import annotations

from pathlib import Path

import pytest

from profidrive import gsdml
from profidrive.errors import LocalError, UsageError


@pytest.fixture
def akd(tmp_path: Path) -> Path:
    file, *pictures = gsdml.export("akd", tmp_path)
    assert file.suffix == ".xml"
    assert {file, *pictures} == set(tmp_path.iterdir())
    return file


def test_a_description_is_read_and_checked(akd: Path) -> None:
    found = gsdml.load(akd)
    assert found.access_points
    assert any(module.ident for module in found.modules)
    checked = gsdml.check(akd)
    assert (checked.sound, checked.usable, checked.problems) == (True, True, ())
    with pytest.raises(UsageError):
        gsdml.load(akd, language="xx")


def test_a_wrong_description_has_its_problems(akd: Path) -> None:
    akd.write_text(akd.read_text().replace("<ModuleList>", "<ModulList>", 1))
    checked = gsdml.check(akd)
    assert not checked.sound
    assert checked.problems[0].line > 1
    with pytest.raises(LocalError):
        gsdml.load(akd)
    with pytest.raises(LocalError):
        gsdml.check(akd.with_name("none.xml"))


def test_a_description_has_the_cycle_of_its_drive(tmp_path: Path) -> None:
    [file] = (file for file in gsdml.export("vlt", tmp_path, min_cycle="8ms") if file.suffix == ".xml")
    assert gsdml.check(file).sound
    with pytest.raises(UsageError, match="akd, vlt, vacon"):
        gsdml.export("x", tmp_path)
    with pytest.raises(UsageError, match="3"):
        gsdml.export("vlt", tmp_path, min_cycle="3ms")
    with pytest.raises(LocalError):
        gsdml.export("vlt", file)
