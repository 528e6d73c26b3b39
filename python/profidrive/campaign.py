"""Campaigns: one plant with many seeds and varied values, on any executor."""

from __future__ import annotations

import hashlib
import json
import math
import os
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, ProcessPoolExecutor, wait
from dataclasses import dataclass, field
from itertools import product
from multiprocessing import get_context
from typing import Any, Literal, NamedTuple

from profidrive import _profidrive
from profidrive._values import document, optional_span, span, value_text
from profidrive.errors import ProfidriveError, UsageError
from profidrive.events import ExpectationResult
from profidrive.plant import Plant
from profidrive.trace import Trace
from profidrive.types import Duration, Path, Value

_TRIED = 16
"""Runs that are measured to choose the size of chunks."""
_LASTS = 2.0
"""Seconds that a chunk is to last."""
_MOST = 10_000
_IN_FLIGHT = 32

Measure = Callable[[Trace], Mapping[str, float]]


@dataclass(frozen=True, slots=True)
class Distribution:
    """How a value is drawn. It depends on the seed of the run and the path of the value alone."""

    kind: str
    values: tuple[str, ...]


def uniform(low: Value, high: Value) -> Distribution:
    """Any value between two, with a unit or without."""
    return Distribution("uniform", (value_text(low), value_text(high)))


def log_uniform(low: Value, high: Value) -> Distribution:
    """Any value between two above 0, each order of magnitude as often as the others."""
    return Distribution("log_uniform", (value_text(low), value_text(high)))


def normal(mean: Value, deviation: Value) -> Distribution:
    """Values around a mean, with this standard deviation."""
    return Distribution("normal", (value_text(mean), value_text(deviation)))


def choice(*values: object) -> Distribution:
    """One of these values, each as often as the others."""
    # as the value of an object, in which quantities are read
    return Distribution("choice", tuple(json.dumps(json.loads(document({"value": value}))["value"]) for value in values))


class Progress(NamedTuple):
    """How far a sweep is."""

    done: int
    """Runs that are done."""
    total: int
    failures: int


@dataclass(frozen=True)
class Row:
    """A run of a sweep."""

    seed: int
    variables: Mapping[str, Any]
    """The values that varied, by path."""
    failed: tuple[str, ...]
    """Names of the expectations that did not come true."""
    measures: Mapping[str, float]
    digest: str
    """The same for the same run."""
    wall: float
    """Seconds of a computer that it took."""

    @property
    def passed(self) -> bool:
        """Whether every expectation came true."""
        return not self.failed


@dataclass(frozen=True)
class Failure:
    """A run in which an expectation did not come true."""

    seed: int
    variables: Mapping[str, Any]
    results: tuple[ExpectationResult, ...]
    """The expectations that did not come true."""
    digest: str
    _job: _Job = field(repr=False)

    def plant(self) -> Plant:
        """Returns the plant of this run, with its seed and its values."""
        return Plant(self._job.campaign().plant(self.seed))

    def trace(self) -> Trace:
        """Runs it again here and returns what happened.

        Raises:
            UsageError: when it is not the same run: this package is another one than that of the worker.
        """
        [again] = json.loads(self._job.campaign().run([self.seed]))
        if again["digest"] != self.digest:
            raise UsageError(f"seed {self.seed} is another run here: {again['digest']} in place of {self.digest}")
        return self.plant().run(self._job.until)

    def shrink(self, *, expectation: str | None = None, budget: Duration = 60.0) -> Reproduction:
        """Returns the smallest plant in which the same expectation of the same drive still fails.

        Events, controllers, other drives and other expectations are removed, varied values become those of the file, and the run
        ends when the expectation is decided.

        Args:
            expectation: its name; the first one that failed where it is None.
            budget: seconds of this computer. Then the smallest plant so far is returned.
        """
        name = self.results[0].name if expectation is None else expectation
        plant, reason, runs, smallest = self._job.campaign().shrink(self.seed, name, span(budget))
        return Reproduction(Plant(plant), self.seed, reason, runs, smallest)


@dataclass(frozen=True)
class Reproduction:
    """A small plant in which an expectation fails."""

    plant: Plant
    """It has the seed and the duration of the run."""
    seed: int
    reason: str
    """What fails, where and when, in one line."""
    runs: int
    """Runs that it took to find it."""
    is_smallest: bool
    """Whether nothing is left that can be removed; otherwise the time or the number of runs was up."""

    def save(self, path: Path) -> None:
        """Writes a plant file, with the reason as a comment. An existing file is replaced."""
        with open(path, "w", encoding="utf-8") as file:
            file.write(f"# {self.reason}\n{self.plant.to_toml()}")


class SweepResult(Sequence[Row]):
    """The runs of a sweep: by the lists that vary, then by seed."""

    def __init__(self, rows: Sequence[Row], failures: Sequence[Failure]) -> None:
        self._rows = tuple(rows)
        self.failures = tuple(failures)
        """The runs in which an expectation did not come true."""

    def __getitem__(self, place: Any) -> Any:
        return self._rows[place]

    def __len__(self) -> int:
        return len(self._rows)

    @property
    def columns(self) -> dict[str, list[Any]]:
        """The rows as columns, which `polars.DataFrame` and `pandas.DataFrame` take."""
        columns: dict[str, list[Any]] = {
            "seed": [row.seed for row in self._rows],
            "passed": [row.passed for row in self._rows],
            "failed": [list(row.failed) for row in self._rows],
            "digest": [row.digest for row in self._rows],
            "wall": [row.wall for row in self._rows],
        }
        for kind in ("variables", "measures"):
            names = dict.fromkeys(name for row in self._rows for name in getattr(row, kind))
            columns.update({name: [getattr(row, kind).get(name) for row in self._rows] for name in names})
        return columns

    def __repr__(self) -> str:
        return f"<SweepResult of {len(self)} runs, {len(self.failures)} failed>"


@dataclass(frozen=True)
class _Job:
    """Runs of one plant: all that a worker has to know."""

    text: str
    until: float | str | None
    vary: tuple[tuple[str, str, list[str]], ...]
    measure: Measure | None
    build: tuple[str, str | None, str]

    def campaign(self) -> _profidrive.Campaign:
        return _profidrive.Campaign(_profidrive.Plant.from_toml(self.text), self.until, list(self.vary))

    def key(self) -> str:
        """What decides over its rows."""
        measure = None if self.measure is None else f"{self.measure.__module__}.{self.measure.__qualname__}"
        known = json.dumps([self.text, str(self.until), self.vary, measure, self.build])
        return hashlib.sha256(known.encode()).hexdigest()[:16]


def _run(job: _Job, seeds: Sequence[int]) -> list[dict[str, Any]]:
    """Carries out a chunk. It depends on its arguments alone."""
    own = _profidrive.build_info()
    if tuple(own) != tuple(job.build):
        raise UsageError(f"a worker has profidrive {own}, the program has {job.build}: install the same on all of them")
    campaign = job.campaign()
    rows: list[dict[str, Any]] = json.loads(campaign.run(list(seeds)))
    for row in rows:
        traced = {} if job.measure is None else job.measure(Plant(campaign.plant(row["seed"])).run(job.until))
        row["measures"] = dict(traced)
    return rows


@dataclass
class _Chunk:
    place: int
    seeds: Sequence[int]
    tries: int = 0


class _Folder:
    """Rows of chunks that are done, a file for each, so that the same sweep goes on where it ended."""

    def __init__(self, path: Path | None) -> None:
        self._path = None if path is None else os.fspath(path)
        if self._path is not None:
            os.makedirs(self._path, exist_ok=True)

    def rows(self, job: _Job) -> Iterator[dict[str, Any]]:
        if self._path is None:
            return
        for name in sorted(os.listdir(self._path)):
            if name.startswith(job.key()) and name.endswith(".json"):
                with open(os.path.join(self._path, name), encoding="utf-8") as file:
                    yield from json.load(file)

    def keep(self, job: _Job, rows: list[dict[str, Any]]) -> None:
        if self._path is not None and rows:
            self._write(f"{job.key()}-{rows[0]['seed']}-{len(rows)}.json", rows)

    def finish(self, build: object, total: int, failures: int) -> None:
        if self._path is not None:
            self._write("manifest.json", {"build": build, "runs": total, "failures": failures})

    def _write(self, name: str, content: object) -> None:
        assert self._path is not None
        path = os.path.join(self._path, name)
        with open(f"{path}.part", "w", encoding="utf-8") as file:
            json.dump(content, file)
        os.replace(f"{path}.part", path)


def _jobs(
    plant: Plant, until: Duration | None, vary: Mapping[str, Sequence[object] | Distribution], measure: Measure | None
) -> list[_Job]:
    drawn = tuple((path, how.kind, list(how.values)) for path, how in vary.items() if isinstance(how, Distribution))
    # each value of a list is the only choice of a job, so that the text stays that of the file
    crossed = [
        [(path, one.kind, list(one.values)) for one in map(choice, how)]
        for path, how in vary.items()
        if not isinstance(how, Distribution)
    ]
    build = _profidrive.build_info()
    text, end = plant.to_toml(), optional_span(until)
    return [_Job(text, end, (*point, *drawn), measure, build) for point in product(*crossed)]


def sweep(
    plant: Plant | Path,
    *,
    seeds: Sequence[int],
    vary: Mapping[str, Sequence[object] | Distribution] | None = None,
    until: Duration | None = None,
    measure: Measure | None = None,
    executor: Executor | None = None,
    chunk: int | Literal["auto"] = "auto",
    in_flight: int | None = None,
    retries: int = 2,
    out: Path | None = None,
    stop_after: int | None = None,
    progress: Callable[[Progress], None] | None = None,
) -> SweepResult:
    """Runs a plant with many seeds and checks the expectations of its file, in other processes.

    The rows do not depend on the executor, the size of chunks, the order in which they end, or on what is repeated.

    Args:
        plant: a plant, or its file.
        seeds: a range, or a list.
        vary: values by their paths: a list, all of whose values are combined with those of the other lists, or a distribution.
        until: how long each run lasts; the `duration` of the plant where it is None.
        measure: a function of a module that makes numbers of a trace.
        executor: any executor of `concurrent.futures`; a pool of processes of this computer where it is None.
        chunk: runs of one task; `"auto"` makes tasks of some 2 s.
        in_flight: tasks that wait in the executor.
        retries: how often a task that failed is repeated. Then it is divided, to find the seed.
        out: a folder for what is done: the same sweep goes on there where it ended.
        stop_after: ends after so many failures.
        progress: is called after each task.
    """
    source = plant if isinstance(plant, Plant) else Plant.from_file(plant)
    jobs = _jobs(source, until, vary or {}, measure)
    folder = _Folder(out)
    wanted = dict.fromkeys(seeds)
    done: list[dict[int, dict[str, Any]]] = []
    for job in jobs:
        kept = (row for row in folder.rows(job) if row["seed"] in wanted)
        done.append({row["seed"]: row for row in kept})
    failures = sum(bool(row["failed"]) for rows in done for row in rows.values())

    def note(place: int, rows: list[dict[str, Any]]) -> None:
        nonlocal failures
        folder.keep(jobs[place], rows)
        done[place].update({row["seed"]: row for row in rows})
        failures += sum(bool(row["failed"]) for row in rows)
        if progress is not None:
            progress(Progress(sum(map(len, done)), len(jobs) * len(wanted), failures))

    def enough() -> bool:
        return stop_after is not None and failures >= stop_after

    left = [[seed for seed in wanted if seed not in rows] for rows in done]
    size = chunk if chunk != "auto" else 1
    if chunk == "auto":
        place = next((place for place, seeds in enumerate(left) if seeds), None)
        if place is not None:
            tried, left[place] = left[place][:_TRIED], left[place][_TRIED:]
            begin = time.monotonic()
            note(place, _run(jobs[place], tried))
            each = (time.monotonic() - begin) / len(tried)
            size = min(max(math.ceil(_LASTS / max(each, 1e-6)), 1), _MOST)
    if size < 1:
        raise UsageError(f"a chunk of {size} runs")
    chunks = deque(
        _Chunk(place, seeds[first : first + size]) for place, seeds in enumerate(left) for first in range(0, len(seeds), size)
    )
    if chunks and not enough():
        pool = executor or ProcessPoolExecutor(mp_context=get_context("spawn"))
        try:
            _carry_out(pool, jobs, chunks, in_flight, retries, note, enough)
        finally:
            if executor is None:
                pool.shutdown(cancel_futures=True)
    total = sum(map(len, done))
    folder.finish(_profidrive.build_info(), total, failures)
    return _result(jobs, done, list(wanted))


def _carry_out(
    pool: Executor,
    jobs: Sequence[_Job],
    chunks: deque[_Chunk],
    in_flight: int | None,
    retries: int,
    note: Callable[[int, list[dict[str, Any]]], None],
    enough: Callable[[], bool],
) -> None:
    workers = getattr(pool, "_max_workers", None)
    most = in_flight or (2 * workers if isinstance(workers, int) else _IN_FLIGHT)
    pending: dict[Future[list[dict[str, Any]]], _Chunk] = {}
    try:
        while (chunks or pending) and not enough():
            while chunks and len(pending) < most:
                one = chunks.popleft()
                pending[pool.submit(_run, jobs[one.place], one.seeds)] = one
            for future in wait(pending, return_when=FIRST_COMPLETED).done:
                one = pending.pop(future)
                try:
                    rows = future.result()
                except (BrokenExecutor, ProfidriveError):
                    # no repetition helps; what is done is in the folder
                    raise
                except Exception:
                    one.tries += 1
                    if one.tries <= retries:
                        chunks.append(one)
                    elif len(one.seeds) > 1:
                        half = len(one.seeds) // 2
                        chunks.extend(_Chunk(one.place, part) for part in (one.seeds[:half], one.seeds[half:]))
                    else:
                        raise
                else:
                    note(one.place, rows)
    finally:
        for future in pending:
            future.cancel()


def _result(jobs: Sequence[_Job], done: Sequence[Mapping[int, dict[str, Any]]], seeds: Sequence[int]) -> SweepResult:
    rows = []
    failures = []
    for job, found in zip(jobs, done, strict=True):
        for seed in seeds:
            if (row := found.get(seed)) is None:
                continue
            variables = row["variables"]
            rows.append(Row(seed, variables, tuple(row["failed"]), row["measures"], row["digest"], row["wall"]))
            if row["failed"]:
                results = tuple(ExpectationResult._of(result) for result in row["results"])
                failures.append(Failure(seed, variables, results, row["digest"], job))
    return SweepResult(rows, failures)


__all__ = [
    "Distribution",
    "Failure",
    "Progress",
    "Reproduction",
    "Row",
    "SweepResult",
    "choice",
    "log_uniform",
    "normal",
    "sweep",
    "uniform",
]
