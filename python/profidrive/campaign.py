"""Campaigns: one plant with many seeds and varied values, on any executor."""

from __future__ import annotations

import hashlib
import json
import math
import os
import sys
import time
from collections import deque
from collections.abc import Callable, Container, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Executor, Future, ProcessPoolExecutor, wait
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache, cached_property
from itertools import product
from multiprocessing import get_context
from types import CodeType
from typing import Any, Literal, NamedTuple, overload

from profidrive import _profidrive
from profidrive._render import page, table
from profidrive._values import document, optional_span, seed_of, span, value_text
from profidrive.errors import LocalError, ProfidriveError, UsageError
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

_ENDED = (
    'call sweep below `if __name__ == "__main__":`, because each process imports the program; where it does, look for what ended '
    "the process, such as too little memory"
)

Measure = Mapping[str, str] | Callable[[Trace], Mapping[str, float]]
"""What is measured: texts such as `max speed of press-1` by name, or a function that makes numbers of a trace."""


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


class _Line:
    """The progress of a sweep as a line of the terminal, written twice a second at most."""

    def __init__(self) -> None:
        self._next = 0.0
        self._is_open = False

    def __call__(self, progress: Progress) -> None:
        now = time.monotonic()
        if now < self._next and progress.done < progress.total:
            return
        self._next, self._is_open = now + 0.5, True
        text = f"{progress.done} of {progress.total} runs, {progress.failures} failed"
        # what is left of a longer line is erased
        print(f"\r{text}\x1b[K", end="", file=sys.stderr, flush=True)

    def close(self) -> None:
        """Ends the line, if there is one."""
        if self._is_open:
            print(file=sys.stderr, flush=True)
        self._is_open = False


def _is_terminal() -> bool:
    return sys.stderr is not None and sys.stderr.isatty()


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
    """That of the `Trace` of this run."""
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
    """That of its `Trace`."""
    _job: _Job = field(repr=False)

    def plant(self) -> Plant:
        """Returns the plant of this run, with its seed and its values."""
        return Plant(self._job.campaign().plant(self.seed))

    def trace(self) -> Trace:
        """Runs it again here and returns what happened.

        Raises:
            UsageError: when it is not the same run: this package is another one than that of the worker.
        """
        trace = self.plant().run(self._job.until)
        if trace.digest != self.digest:
            raise UsageError(f"seed {self.seed} is another run here: {trace.digest} in place of {self.digest}")
        return trace

    def shrink(self, *, expectation: str | None = None, executor: Executor | None = None, budget: Duration = 60.0) -> Reproduction:
        """Returns the smallest plant in which the same expectation of the same drive still fails.

        Events, controllers, other drives and other expectations are removed, varied values become those of the file, and the run
        ends when the expectation is decided.

        Args:
            expectation: its name; the first one that failed where it is None.
            executor: where it is searched, as one task; here where it is None.
            budget: seconds of the computer that searches. Then the smallest plant so far is returned.
        """
        name = self.results[0].name if expectation is None else expectation
        if executor is None:
            found = _shrink(self._job, self.seed, name, span(budget))
        else:
            found = executor.submit(_shrink, self._job, self.seed, name, span(budget)).result()
        text, reason, runs, smallest = found
        return Reproduction(Plant.from_toml(text), self.seed, reason, runs, smallest)


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


class SweepResult:
    """The runs of a sweep: by the lists that vary, then by seed.

    It is a table: `pyarrow.table(result)`, `polars.DataFrame(result)` and duckdb take it without a copy. Its columns are `seed`,
    each value that varied, `passed`, `failed`, each measure, `digest`, `wall`, and `results` with the JSON of expectations that
    failed.
    """

    def __init__(self, runs: _profidrive.Runs, jobs: Sequence[_Job]) -> None:
        self._runs = runs
        self._table = runs.table()
        self._jobs = jobs
        """The job of each row."""

    @overload
    def __getitem__(self, place: int) -> Row: ...
    @overload
    def __getitem__(self, place: slice) -> tuple[Row, ...]: ...
    def __getitem__(self, place: int | slice) -> Row | tuple[Row, ...]:
        chosen = range(len(self))[place]
        return self._row(chosen) if isinstance(chosen, int) else tuple(map(self._row, chosen))

    def __len__(self) -> int:
        return len(self._runs)

    def __iter__(self) -> Iterator[Row]:
        return map(self._row, range(len(self)))

    def _document(self, place: int) -> dict[str, Any]:
        document: dict[str, Any] = json.loads(self._runs.row(place) or "{}")
        return document

    def _row(self, place: int) -> Row:
        row = self._document(place)
        return Row(row["seed"], row["variables"], tuple(row["failed"]), row["measures"], row["digest"], row["wall"])

    @cached_property
    def failures(self) -> Sequence[Failure]:
        """The runs in which an expectation did not come true."""
        return tuple(map(self._failure, self._runs.failures()))

    def _failure(self, place: int) -> Failure:
        row = self._document(place)
        results = tuple(ExpectationResult._of(result) for result in row["results"])
        return Failure(row["seed"], row["variables"], results, row["digest"], self._jobs[place])

    @property
    def versions(self) -> tuple[str, ...]:
        """Versions of the package that the runs are of. There is one: a worker with another build is refused."""
        return tuple(dict.fromkeys(job.build[0] for job in self._jobs))

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the columns."""
        return tuple(name for name, _ in self._table.columns())

    @property
    def units(self) -> Mapping[str, str]:
        """Units of the columns, empty for none."""
        return dict(self._table.columns())

    def __arrow_c_stream__(self, requested_schema: object = None) -> object:
        """The Arrow stream of the PyCapsule interface."""
        return self._table.__arrow_c_stream__(requested_schema)

    def write(self, path: Path) -> None:
        """Writes a new Parquet file."""
        self._runs.write(os.fspath(path))

    def _repr_html_(self) -> str:
        """The failures, for notebooks."""
        rows = [(one.seed, one.variables, ", ".join(result.name for result in one.results)) for one in self.failures]
        return page(table(("seed", "varied", "failed"), rows, f"{len(self)} runs, {len(rows)} failed"))

    def __repr__(self) -> str:
        return f"<SweepResult of {len(self)} runs, {len(self._runs.failures())} failed>"


@cache
def _build() -> tuple[str, str]:
    """What must be equal where runs are to be: the version, and the library itself, whatever its version says."""
    digest = hashlib.sha256()
    with open(_profidrive.__file__, "rb") as library:
        while part := library.read(1 << 20):
            digest.update(part)
    return _profidrive.build_info()[0], digest.hexdigest()[:16]


def _identity(measure: Callable[..., object] | tuple[tuple[str, str], ...] | None) -> object:
    """What a function is and does, but for what it calls."""
    if measure is None or isinstance(measure, tuple):
        return measure
    code = getattr(measure, "__code__", None)
    return [measure.__module__, getattr(measure, "__qualname__", ""), None if code is None else _content(code)]


def _content(code: CodeType) -> list[object]:
    constants = [
        _content(one) if isinstance(one, CodeType) else sorted(map(repr, one)) if isinstance(one, frozenset) else repr(one)
        for one in code.co_consts
    ]
    return [code.co_code.hex(), list(code.co_names), constants]


@dataclass(frozen=True)
class _Job:
    """Runs of one plant: everything a worker needs."""

    text: str
    until: float | str | None
    vary: tuple[tuple[str, str, list[str], int | None], ...]
    measure: Callable[[Trace], Mapping[str, float]] | tuple[tuple[str, str], ...] | None
    build: tuple[str, str]

    def campaign(self) -> _profidrive.Campaign:
        """The campaign, where this computer has the same build."""
        own = _build()
        if own != self.build:
            found, wanted = (f"{version} (library {digest})" for version, digest in (own, self.build))
            raise UsageError(f"a worker has profidrive {found}, the program has {wanted}: install the same on all of them")
        texts = list(self.measure) if isinstance(self.measure, tuple) else []
        return _profidrive.Campaign(_profidrive.Plant.from_toml(self.text), self.until, list(self.vary), texts)

    def key(self) -> str:
        """What decides over its rows."""
        known = json.dumps([self.text, str(self.until), self.vary, _identity(self.measure), self.build])
        return hashlib.sha256(known.encode()).hexdigest()[:16]


def _run(job: _Job, seeds: Sequence[int]) -> bytes:
    """Carries out a chunk, and returns its runs as an Arrow IPC stream. It depends on its arguments alone."""
    measure = job.measure
    if measure is None or isinstance(measure, tuple):
        return job.campaign().run(list(seeds)).to_ipc()

    def numbers(trace: _profidrive.Trace) -> list[tuple[str, float]]:
        return [(name, float(number)) for name, number in measure(Trace(trace)).items()]

    return job.campaign().run(list(seeds), numbers).to_ipc()


def _shrink(job: _Job, seed: int, expectation: str, budget: float | str) -> tuple[str, str, int, bool]:
    plant, reason, runs, smallest = job.campaign().shrink(seed, expectation, budget)
    return plant.to_toml(), reason, runs, smallest


@dataclass
class _Chunk:
    place: int
    seeds: Sequence[int]
    tries: int = 0


class _Folder:
    """Runs of chunks that are done, a Parquet file for each, so that the same sweep goes on where it ended."""

    def __init__(self, path: Path | None) -> None:
        self._path = None if path is None else os.fspath(path)
        if self._path is not None:
            os.makedirs(self._path, exist_ok=True)

    def parts(self, job: _Job) -> Iterator[_profidrive.Runs]:
        if self._path is None:
            return
        for name in sorted(os.listdir(self._path)):
            if name.startswith(job.key()) and name.endswith(".parquet"):
                yield _profidrive.Runs.read(os.path.join(self._path, name))

    def keep(self, job: _Job, runs: _profidrive.Runs) -> None:
        if self._path is None or len(runs) == 0:
            return
        path = os.path.join(self._path, f"{job.key()}-{runs.seeds()[0]}-{len(runs)}.parquet")
        part = f"{path}.part"
        with suppress(FileNotFoundError):
            # of a sweep that was killed
            os.remove(part)
        runs.write(part)
        os.replace(part, path)

    def finish(self, build: object, total: int, failures: int) -> None:
        if self._path is None:
            return
        path = os.path.join(self._path, "manifest.json")
        with open(f"{path}.part", "w", encoding="utf-8") as file:
            json.dump({"build": build, "runs": total, "failures": failures}, file)
        os.replace(f"{path}.part", path)


class _Done:
    """The runs of a job that are done."""

    def __init__(self) -> None:
        self.parts: list[_profidrive.Runs] = []
        self.places: dict[int, tuple[int, int]] = {}
        """Part and row of each seed."""
        self.failures = 0

    def add(self, runs: _profidrive.Runs, wanted: Container[int]) -> None:
        failed = set(runs.failures())
        for row, seed in enumerate(runs.seeds()):
            if seed in wanted and seed not in self.places:
                self.places[seed] = (len(self.parts), row)
                self.failures += row in failed
        self.parts.append(runs)


def _jobs(
    plant: Plant, until: Duration | None, vary: Mapping[str, Sequence[object] | Distribution], measure: Measure | None
) -> list[_Job]:
    drawn = tuple((path, how.kind, list(how.values), None) for path, how in vary.items() if isinstance(how, Distribution))
    # each value of a list is that of a job, so that the text stays that of the file
    lists = {path: list(choice(*_listed(path, how)).values) for path, how in vary.items() if not isinstance(how, Distribution)}
    crossed = [[(path, "choice", values, place) for place in range(len(values))] for path, values in lists.items()]
    build = _build()
    text, end = plant.to_toml(), optional_span(until)
    wanted = _measured(measure)
    return [_Job(text, end, (*point, *drawn), wanted, build) for point in product(*crossed)]


def _measured(measure: object) -> Any:
    """What is measured, as a job has it."""
    if measure is None or callable(measure):
        return measure
    if not isinstance(measure, Mapping):
        peak = {"peak": "max speed of press-1"}
        raise UsageError(f"measure = {measure!r}: give texts by name, such as {peak}, or a function of a trace")
    for name, text in measure.items():
        if not isinstance(name, str) or not isinstance(text, str):
            raise UsageError(f"measure {name!r} = {text!r}: give a name and a text, such as 'max speed of press-1'")
    return tuple(measure.items())


def _listed(path: str, values: object) -> Sequence[object]:
    if isinstance(values, Sequence) and not isinstance(values, str | bytes):
        return values
    raise UsageError(f"{path} = {values!r}: give a list of values, or a distribution such as uniform(1, 2)")


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
    progress: bool | Callable[[Progress], None] = True,
) -> SweepResult:
    """Runs a plant with many seeds and checks the expectations of its file, in other processes.

    The rows do not depend on the executor, the size of chunks, the order in which they end, or on what is repeated.

    Args:
        plant: a plant, or its file.
        seeds: a range, or a list.
        vary: values by their paths: a list, all of whose values are combined with those of the other lists, or a distribution.
        until: how long each run lasts; the `duration` of the plant where it is None. An expectation that is not decided by then
            did not come true (`not_ended`).
        measure: numbers that are made of each run, a column each. A mapping has them by name: `{"peak": "max speed of press-1 in
            2s..5s", "trip": 'time of { drive = "press-1", fault = 702 }'}`, with `min`, `max`, `mean` or `last` of a quantity of
            expectations, or the time at which conditions hold first; null where there is none. Or a function of a module makes them
            of a trace. With `out` rows of an earlier call are used again where the text of that function is the same, whatever the
            functions that it calls do.
        executor: any executor of `concurrent.futures`; a pool of processes of this computer where it is None.
        chunk: runs of one task; `"auto"` makes tasks of some 2 s.
        in_flight: tasks that wait in the executor.
        retries: how often a task that failed is repeated. Then it is divided, to find the seed.
        out: a folder for what is done: the same sweep goes on there where it ended. `manifest.json` is there when it is complete.
        stop_after: ends after so many failures.
        progress: is called after each task; True writes a line where standard error is a terminal, False nothing.

    Raises:
        LocalError: when a process of its own pool ended.
        UsageError: for a value or a seed that does not fit.
    """
    source = plant if isinstance(plant, Plant) else Plant.from_file(plant)
    jobs = _jobs(source, until, vary or {}, measure)
    if not jobs:
        raise UsageError("a list of values that vary is empty")
    line = _Line() if progress is True and _is_terminal() else None
    report = line if isinstance(progress, bool) else progress
    if not isinstance(seeds, Iterable):
        raise UsageError(f"seeds={seeds!r}: give a range or a list, such as range(1000)")
    folder = _Folder(out)
    wanted = dict.fromkeys(map(seed_of, seeds))
    done = [_Done() for _ in jobs]
    for job, one in zip(jobs, done, strict=True):
        for part in folder.parts(job):
            one.add(part, wanted)

    def failures() -> int:
        return sum(one.failures for one in done)

    def total() -> int:
        return sum(len(one.places) for one in done)

    def note(place: int, octets: bytes) -> None:
        runs = _profidrive.Runs.from_ipc(octets)
        folder.keep(jobs[place], runs)
        done[place].add(runs, wanted)
        if report is not None:
            report(Progress(total(), len(jobs) * len(wanted), failures()))

    def enough() -> bool:
        return stop_after is not None and failures() >= stop_after

    left = [[seed for seed in wanted if seed not in one.places] for one in done]
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
        except BrokenExecutor as error:
            if executor is not None:
                raise
            raise LocalError(f"a process of the sweep ended: {error}", hint=_ENDED) from error
        finally:
            if line is not None:
                line.close()
            if executor is None:
                pool.shutdown(cancel_futures=True)
    elif line is not None:
        line.close()
    if total() == len(jobs) * len(wanted):
        folder.finish(_build(), total(), failures())
    return _result(jobs, done, list(wanted))


def _carry_out(
    pool: Executor,
    jobs: Sequence[_Job],
    chunks: deque[_Chunk],
    in_flight: int | None,
    retries: int,
    note: Callable[[int, bytes], None],
    enough: Callable[[], bool],
) -> None:
    workers = getattr(pool, "_max_workers", None)
    most = in_flight or (2 * workers if isinstance(workers, int) else _IN_FLIGHT)
    pending: dict[Future[bytes], _Chunk] = {}
    try:
        while (chunks or pending) and not enough():
            while chunks and len(pending) < most:
                one = chunks.popleft()
                pending[pool.submit(_run, jobs[one.place], one.seeds)] = one
            for future in wait(pending, return_when=FIRST_COMPLETED).done:
                one = pending.pop(future)
                try:
                    runs = future.result()
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
                    note(one.place, runs)
    finally:
        for future in pending:
            future.cancel()


def _result(jobs: Sequence[_Job], done: Sequence[_Done], seeds: Sequence[int]) -> SweepResult:
    parts: list[_profidrive.Runs] = []
    firsts: list[int] = []
    rows: list[int] = []
    of_rows: list[_Job] = []
    for job, one in zip(jobs, done, strict=True):
        own = len(parts)
        for part in one.parts:
            firsts.append(firsts[-1] + len(parts[-1]) if parts else 0)
            parts.append(part)
        found = [one.places[seed] for seed in seeds if seed in one.places]
        rows += [firsts[own + part] + row for part, row in found]
        of_rows += [job] * len(found)
    if not parts:
        # the columns are known all the same
        parts.append(jobs[0].campaign().run([]))
    return SweepResult(_profidrive.Runs.of_parts(parts, rows), of_rows)


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
