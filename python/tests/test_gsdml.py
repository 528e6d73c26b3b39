"""Device descriptions."""

from __future__ import annotations

import subprocess
from pathlib import Path

import pytest

from profidrive import gsdml
from profidrive.errors import LocalError, UsageError

from .wire import PROGRAM


@pytest.fixture
def akd(tmp_path: Path) -> Path:
    subprocess.run([PROGRAM, "gsdml", "export", "--model", "akd", "-o", tmp_path], check=True, capture_output=True, timeout=30)
    [file] = tmp_path.glob("*.xml")
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
