"""The package as a whole: what importing it does, and the examples of its README."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import tarfile
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


def test_it_needs_no_other_package() -> None:
    """As in a fresh environment without extras: nothing but the package and the standard library can be imported."""
    program = f"""
import sys
sys.path = [path for path in sys.path if "site-packages" not in path] + [{str(ROOT / "python")!r}]
import profidrive
for name in profidrive.__all__:
    getattr(profidrive, name)
world = profidrive.Plant.of("akd").start()
with world.network["akd-1"].control(max_speed="600rpm") as axis:
    axis.run("300rpm", for_="1s")
world.run(for_="1s").expect({{"at": f"{{world.now}}s", "drive": "akd-1", "speed": "0rpm", "tolerance": "1rpm"}})
for needs in (lambda: world.trace.samples["speed"], world.trace.plot):
    try:
        needs()
    except profidrive.errors.UnsupportedError as error:
        print(error.hint)
try:
    import numpy
except ImportError:
    print("alone")
"""
    alone = subprocess.run([sys.executable, "-I", "-S", "-c", program], capture_output=True, text=True, check=False, timeout=60)
    assert alone.stderr == ""
    assert alone.stdout.splitlines() == ['pip install "profidrive[numpy]"', 'pip install "profidrive[plot]"', "alone"]


def test_the_source_distribution_has_what_its_build_needs(tmp_path: Path) -> None:
    subprocess.run(["maturin", "sdist", "--out", tmp_path], check=True, capture_output=True, timeout=60, cwd=ROOT / "python")
    [archive] = tmp_path.glob("profidrive-*.tar.gz")
    with tarfile.open(archive) as file:
        file.extractall(tmp_path, filter="data")
    [folder] = [path for path in tmp_path.iterdir() if path.is_dir()]
    metadata = subprocess.run(
        ["cargo", "metadata", "--offline", "--no-deps", "--format-version", "1"],
        capture_output=True,
        check=True,
        timeout=60,
        cwd=folder,
    )
    packages = {package["name"]: package for package in json.loads(metadata.stdout)["packages"]}
    own = packages["profidrive-python"]["dependencies"]
    needed = {dependency["name"] for dependency in own if dependency.get("path")}
    assert needed <= set(packages)
    assert {"profidrive", "profidrive-plant"} <= needed
    sources = {path.name for path in (ROOT / "python" / "profidrive").iterdir() if path.suffix in (".py", ".pyi", ".typed")}
    assert {path.name for path in (folder / "profidrive").iterdir()} == sources | {"py.typed"}


def test_the_binding_has_no_unsafe_code() -> None:
    sources = sorted((ROOT / "python" / "src").glob("*.rs"))
    assert len(sources) > 10
    assert [source.name for source in sources if "unsafe" in source.read_text()] == []


def test_the_reference_is_up_to_date() -> None:
    subprocess.run([sys.executable, ROOT / "tools" / "py-api", "--check"], check=True, timeout=30)


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
    assert {"gsdml", "raw-ethernet", "recording", "simulate"} <= set(info.features)


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
    pytester.runpytest_subprocess("-p", "no:cacheprovider", timeout=60).assert_outcomes(passed=tests)
