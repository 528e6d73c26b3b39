"""The package as a whole: what importing it does, and the examples of its README."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

import profidrive

ROOT = Path(__file__).parents[2]


def run(program: str) -> str:
    return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True, timeout=60).stdout


def test_importing_loads_neither_the_binding_nor_other_packages() -> None:
    loaded = run("import profidrive, profidrive.errors, sys, threading; print(*sys.modules); assert threading.active_count() == 1")
    assert not {"profidrive._profidrive", "numpy", "pytest", "pyarrow", "matplotlib", "asyncio"} & set(loaded.split())
    assert "profidrive._profidrive" in run("import profidrive, sys; profidrive.Plant; print(*sys.modules)").split()


def test_every_public_name_exists() -> None:
    for name in profidrive.__all__:
        assert getattr(profidrive, name) is not None
    assert set(profidrive.__all__) <= set(dir(profidrive))
    with pytest.raises(AttributeError, match="no attribute 'Plent'"):
        profidrive.Plent  # noqa: B018


def test_the_build_is_described() -> None:
    info = profidrive.build_info()
    version = re.search(r'^version = "(.*)"', (ROOT / "Cargo.toml").read_text(), re.M)
    assert version is not None
    assert info.version == version[1]
    assert info.profile in ("dev", "release")


@pytest.mark.parametrize(("page", "tests"), [("python/README.md", 3), ("docs/src/python.md", 5)])
def test_the_examples_of_the_pages_run(page: str, tests: int, pytester: pytest.Pytester) -> None:
    text = (ROOT / page).read_text()
    programs = re.findall(r"^```python\n(.*?)^```", text, re.M | re.S)
    for plant in re.findall(r"^```toml\n(.*?)^```", text, re.M | re.S):
        pytester.path.joinpath("line.toml").write_text(plant)
    pytester.path.joinpath("press.toml").write_text((ROOT / "examples/plants/press.toml").read_text())
    pytester.path.joinpath("full.pcapng").write_bytes((ROOT / "captures/pnio-profinetpy-full.pcapng").read_bytes())
    for number, program in enumerate(programs):
        if "def test_" in program:
            pytester.makepyfile(**{f"test_page_{number}": program})
        else:
            subprocess.run([sys.executable, "-c", program], check=True, timeout=60, cwd=pytester.path)
    pytester.runpytest_subprocess("-p", "no:cacheprovider").assert_outcomes(passed=tests)
