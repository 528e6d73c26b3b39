"""The pytest plugin: plants of virtual drives as fixtures, and what happened in them when a test fails.

The fixture `plant` is the plant of the marker `plant`, `world` the same at its start. With the marker `seeds` a test runs once
for each seed. The binding is loaded only when a fixture is used.
"""

from __future__ import annotations

import re
import shlex
from collections.abc import Generator, Iterable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from profidrive.errors import ExpectationFailed, ProfidriveError, UsageError

if TYPE_CHECKING:
    from profidrive import Network, Plant, Served, Trace, World
    from profidrive.events import ExpectationResult

_SHOWN = 20
"""Events that a failure shows."""

_PARTS = (r"^\s*(expect\s*=|\[\[\s*expect\s*\]\])", r"^\s*(drive\s*=\s*\[\s*(\{|#|$)|\[\[\s*drive\s*\]\])")
"""What a plant file that is a test has: expectations and drives."""

_WATCHES = pytest.StashKey["list[_Watch]"]()


class _Watch:
    """A world of a test, with the file for its frames."""

    def __init__(self, world: World, capture: Path | None) -> None:
        self.world = world
        self.capture = capture


def pytest_addoption(parser: pytest.Parser) -> None:
    group = parser.getgroup("profidrive", "virtual PROFIdrive drives")
    group.addoption(
        "--profidrive-seed",
        type=int,
        metavar="N",
        help="seed of all plants, in place of those of the markers and plant files",
    )
    group.addoption(
        "--profidrive-report",
        metavar="DIR",
        help="folder for what happened in the plant of a test that fails: events, samples, a plot, all frames",
    )
    group.addoption(
        "--profidrive-interface",
        metavar="IFACE",
        help="network interface: of real drives for the fixture profidrive_network, for virtual ones of served_plant",
    )
    group.addoption(
        "--profidrive-allow-motion",
        action="store_true",
        help="let tests change and move real drives; without it they only read, and those with the marker moves_axis are skipped",
    )
    parser.addini(
        "profidrive_collect_plants",
        type="bool",
        default=False,
        help="collect plant files (.toml) that have expectations as tests",
    )


def pytest_configure(config: pytest.Config) -> None:
    config.addinivalue_line(
        "markers",
        "plant(file, *, seed=None, changes=None): plant file of the fixtures `plant` and `world`, found beside the test",
    )
    config.addinivalue_line("markers", "seeds(seeds): run the test once for each of these seeds")
    config.addinivalue_line("markers", "moves_axis: the test moves a real axis; skipped without --profidrive-allow-motion")


def pytest_runtest_setup(item: pytest.Item) -> None:
    if item.get_closest_marker("moves_axis") and not item.config.getoption("--profidrive-allow-motion"):
        pytest.skip("it moves a real axis: --profidrive-allow-motion permits that")


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    marker = metafunc.definition.get_closest_marker("seeds")
    if marker is None:
        return
    if "profidrive_seed" not in metafunc.fixturenames:
        raise UsageError(f"{metafunc.definition.nodeid}: `seeds` belongs to a test with the fixture plant or world")
    only = metafunc.config.getoption("--profidrive-seed")
    seeds: Iterable[int] = marker.args[0] if only is None else [only]
    metafunc.parametrize("profidrive_seed", list(seeds), indirect=True, ids=lambda seed: f"seed={seed}")


@pytest.fixture
def profidrive_seed(request: pytest.FixtureRequest) -> int | None:
    """The seed of the plant: of `--profidrive-seed`, else of the marker `seeds`, else of the marker `plant`; None for that of the
    plant file."""
    only: int | None = request.config.getoption("--profidrive-seed")
    if only is not None:
        return only
    if hasattr(request, "param"):
        return int(request.param)
    marker = request.node.get_closest_marker("plant")
    seed: int | None = None if marker is None else marker.kwargs.get("seed")
    return seed


@pytest.fixture
def plant(request: pytest.FixtureRequest, profidrive_seed: int | None) -> Plant:
    """The plant of the marker `plant`: of a file beside the test, with its changes and its seed. Without a marker an AKD as it is
    delivered."""
    from profidrive import Plant

    marker = request.node.get_closest_marker("plant")
    if marker is None:
        found, changes = Plant.of("akd"), None
    else:
        changes = marker.kwargs.get("changes")
        strange = set(marker.kwargs) - {"seed", "changes"}
        if len(marker.args) != 1 or strange:
            raise UsageError(f"{request.node.nodeid}: write @pytest.mark.plant(file, seed=.., changes=..)")
        found = Plant.from_file(_beside(request.path, request.config.rootpath, marker.args[0]))
    found = found.with_changes(changes or {}, seed=profidrive_seed)
    return _watched(found, request.node)


@pytest.fixture
def world(plant: Plant) -> World:
    """The plant at its start, in virtual time."""
    return plant.start()


@pytest.fixture
def virtual_network(world: World) -> Network:
    """The network of the plant, for code under test: in virtual time, without root and without a sleep."""
    return world.network


@pytest.fixture
def served_plant(request: pytest.FixtureRequest, plant: Plant) -> Iterator[Served]:
    """The drives of the plant on the interface of `--profidrive-interface`, in real time, for a controller.

    Without an interface, or without permission for raw sockets, its tests are skipped.
    """
    from profidrive.errors import PermissionMissing

    interface = request.config.getoption("--profidrive-interface")
    if interface is None:
        pytest.skip("it puts drives on a network: --profidrive-interface IFACE")
    served = plant.serve(interface)
    try:
        served.__enter__()
    except PermissionMissing as error:
        pytest.skip(f"{error}; {error.hint}")
    with ExitStack() as stack:
        stack.push(served.__exit__)
        yield served


@pytest.fixture(scope="session")
def profidrive_network(request: pytest.FixtureRequest) -> Iterator[Network]:
    """The network of `--profidrive-interface`: for reading, unless `--profidrive-allow-motion` is given.

    Without an interface, or without permission for raw sockets, its tests are skipped.
    """
    import profidrive
    from profidrive.errors import PermissionMissing

    interface = request.config.getoption("--profidrive-interface")
    if interface is None:
        pytest.skip("it needs real drives: --profidrive-interface IFACE")
    try:
        network = profidrive.open(interface, read_only=not request.config.getoption("--profidrive-allow-motion"))
    except PermissionMissing as error:
        pytest.skip(f"{error}; {error.hint}")
    with network:
        yield network


def _beside(test: Path, root: Path, name: str) -> Path:
    """A plant file beside the test, else one below the root of the tests."""
    beside = test.parent / name
    return beside if beside.exists() or not (root / name).exists() else root / name


def _watched(plant: Plant, item: pytest.Item) -> Plant:
    """Makes a plant whose worlds are reported when the test fails."""
    watches = item.stash.setdefault(_WATCHES, [])
    folder = item.config.getoption("--profidrive-report")
    start = plant.start

    def started(*, seed: int | None = None, capture: Any = None, machine: Any = None) -> World:
        if capture is None and folder is not None:
            Path(folder).mkdir(parents=True, exist_ok=True)
            capture = _free(Path(folder) / _name(item), ".pcapng")
            watches.append(_Watch(start(seed=seed, capture=capture, machine=machine), capture))
        else:
            watches.append(_Watch(start(seed=seed, capture=capture, machine=machine), None))
        return watches[-1].world

    # its `run` starts it by this too
    plant.start = started  # type: ignore[method-assign]
    return plant


def _name(item: pytest.Item) -> str:
    return re.sub(r"[^A-Za-z0-9_.=-]+", "-", item.nodeid).strip("-.")


def _free(stem: Path, end: str) -> Path:
    """A name that no file has."""
    for number in range(1, 10_000):
        path = stem.with_name(stem.name + ("" if number == 1 else f"-{number}") + end)
        if not path.exists():
            return path
    raise UsageError(f"{stem.parent} is full of reports; give another folder")


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    watches = item.stash.get(_WATCHES, [])
    failed = call.excinfo is not None and not call.excinfo.errisinstance((pytest.skip.Exception,))
    # what a fixture of the test does with its plant fails before the test is called
    if watches and (call.when == "call" or (call.when == "setup" and call.excinfo is not None)):
        if failed and call.excinfo is not None:
            error = call.excinfo.value
            try:
                _report(item, call.when, watches[-1], error.results if isinstance(error, ExpectationFailed) else ())
            except (ProfidriveError, OSError) as wrong:
                item.add_report_section(call.when, "profidrive trace", f"the report cannot be written: {wrong}\n")
        for watch in watches:
            if watch.capture is not None and not (failed and watch is watches[-1]):
                watch.capture.unlink(missing_ok=True)
        watches.clear()
    return (yield)


def _report(item: pytest.Item, when: str, watch: _Watch, results: tuple[ExpectationResult, ...]) -> None:
    trace = watch.world.trace
    item.add_report_section(when, "profidrive trace", _last_events(item, trace, results))
    folder = item.config.getoption("--profidrive-report")
    if folder is None:
        return
    stem = Path(folder) / _name(item)
    if watch.capture is not None:
        watch.world.finish_capture()
        stem = watch.capture.with_suffix("")
    stem.parent.mkdir(parents=True, exist_ok=True)
    files = [stem.with_name(stem.name + end) for end in (".trace.jsonl", ".arrow", ".svg")]
    for file in files:
        file.unlink(missing_ok=True)
    trace.write_events(files[0])
    trace.write(files[1])
    trace.draw(files[2], title=item.nodeid)
    files += [] if watch.capture is None else [watch.capture]
    for file in files:
        item.user_properties.append(("profidrive", str(file)))
        # GitLab and Jenkins take attachments from the output of a test
        item.add_report_section(when, "stdout", f"[[ATTACHMENT|{file.resolve()}]]\n")


def _last_events(item: pytest.Item, trace: Trace, results: tuple[ExpectationResult, ...]) -> str:
    """The last events, with a mark at the first one at which an expectation was lost."""
    from profidrive.events import Outcome

    lost = [result.time for result in results if result.outcome is not Outcome.MET]
    events, texts = trace.events, trace.lines()
    marked = None
    if lost and events:
        first = min(lost)
        until = [number for number, event in enumerate(events) if event.time <= first]
        marked = until[-1] if until else 0
    lines = [("> " if number == marked else "  ") + text for number, text in enumerate(texts)]
    shown = lines[-_SHOWN:]
    if marked is not None and marked < len(lines) - _SHOWN:
        shown = [lines[marked], "  ..", *shown]
    if trace.cut is not None:
        shown.append(f"  the trace was full at {trace.cut} s")
    return "\n".join([*shown, f"reproduce: pytest {shlex.quote(item.nodeid)} --profidrive-seed {trace.seed}", ""])


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> PlantFile | None:
    if file_path.suffix != ".toml" or not parent.config.getini("profidrive_collect_plants"):
        return None
    text = file_path.read_text(encoding="utf-8", errors="replace")
    # a file with expectations alone is for plants of other files
    if all(re.search(part, text, re.M) for part in _PARTS):
        found: PlantFile = PlantFile.from_parent(parent, path=file_path)
        return found
    return None


class PlantFile(pytest.File):
    """A plant file whose expectations are tests; one run decides all of them."""

    _results: list[tuple[ExpectationResult, str]] | None = None
    _world: World | None = None

    def collect(self) -> Iterator[PlantExpectation]:
        from profidrive import Plant

        for name in Plant.from_file(self.path).expectations:
            item: PlantExpectation = PlantExpectation.from_parent(self, name=name)
            yield item

    def results(self, item: pytest.Item) -> list[tuple[ExpectationResult, str]]:
        """Runs the plant once; returns all results with their texts."""
        from profidrive import Plant
        from profidrive.plant import results_of

        if self._results is None:
            self._world = Plant.from_file(self.path).start(seed=self.config.getoption("--profidrive-seed"))
            self._world.run()
            self._results = results_of(self._world)
        if self._world is not None:
            item.stash[_WATCHES] = [_Watch(self._world, None)]
        return self._results


class PlantExpectation(pytest.Item):
    """One expectation of a plant file."""

    def runtest(self) -> None:
        from profidrive.trace import judged

        assert isinstance(self.parent, PlantFile)
        results = self.parent.results(self)
        judged([pair for pair in results if pair[0].name == self.name])

    def repr_failure(self, excinfo: pytest.ExceptionInfo[BaseException], style: Any = None) -> str:
        if isinstance(excinfo.value, ExpectationFailed):
            return str(excinfo.value)
        return str(super().repr_failure(excinfo, style))

    def reportinfo(self) -> tuple[Path, int | None, str]:
        return self.path, None, self.name
