"""Campaigns: many runs of one plant, in other processes."""

from __future__ import annotations

import io
import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from pathlib import Path

import polars
import pyarrow
import pytest
from pyarrow import ipc, parquet

from profidrive import Plant, Trace, build_info, choice, log_uniform, normal, sweep, uniform
from profidrive.campaign import Distribution, Progress, Row, _jobs, _run
from profidrive.errors import UsageError
from profidrive.events import FaultRaised

from .conftest import PRESS, output_when_interrupted

LOSSY = """
duration = "4s"
expect = [{ name = "no fault", never = true, drive = "akd-1", fault = "any" }]
[[drive]]
name = "akd-1"
ip = "10.0.0.1/24"
event = [{ at = "1s", do = "loss=12%" }]
[[controller]]
drive = "akd-1"
telegram = 1
step = [
    { at = "200ms", send = { STW1 = "0x047E" } },
    { at = "600ms", send = { STW1 = "0x047F", NSOLL_A = "300rpm" } },
]
"""


@pytest.fixture(scope="module")
def pool() -> Iterator[Executor]:
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        yield pool


@pytest.fixture(scope="module")
def plant() -> Plant:
    return Plant.from_file(PRESS)


def seeds_of(folder: Path) -> list[int]:
    """The seeds of the runs that a folder has."""
    return [seed for file in folder.glob("*.parquet") for seed in parquet.read_table(file)["seed"].to_pylist()]


def same(rows: Iterable[Row]) -> list[tuple[object, ...]]:
    return [(row.seed, dict(row.variables), row.failed, dict(row.measures), row.digest) for row in rows]


def highest(trace: Trace) -> dict[str, float]:
    return {"highest": max(abs(sample.speed) for sample in trace.at("5s").values())}


def test_rows_do_not_depend_on_the_executor_or_the_size_of_chunks(plant: Plant, pool: Executor) -> None:
    vary: dict[str, Sequence[object] | Distribution] = {
        "drive.press-1.load.friction": uniform(0.1, 0.4),
        "drive.press-1.load.inertia": [0.001, 0.002],
    }
    seen: list[Progress] = []
    first = sweep(plant, seeds=range(12), vary=vary, until="6s", measure=highest, executor=pool, chunk=5, progress=seen.append)
    assert len(first) == 24
    assert first.versions == (build_info().version,)
    assert (seen[-1].done, seen[-1].total) == (24, 24)
    with ThreadPoolExecutor(2) as threads:
        second = sweep(PRESS, seeds=range(12), vary=vary, until="6s", measure=highest, executor=threads)
    assert same(first) == same(second)
    frictions = {row.variables["drive.press-1.load.friction"] for row in first}
    assert len(frictions) == 12, "of a seed it is the same for each value of the list"
    assert {row.variables["drive.press-1.load.inertia"] for row in first} == {0.001, 0.002}
    columns = pyarrow.table(first).to_pydict()
    assert columns["seed"] == [*range(12), *range(12)]
    assert len(columns["highest"]) == 24


def test_what_is_measured_has_a_name_and_a_text_or_a_function_and_each_plant_runs_once(plant: Plant, tmp_path: Path) -> None:
    texts = {
        "peak": "max load.speed of press-1",
        "early": "last speed of press-1 in ..1s",
        "lost": 'time of { drive = "feeder-1", connected = false }',
        "never": 'time of { drive = "press-1", warning = 107 }',
    }
    traces: list[Trace] = []

    def function(trace: Trace) -> dict[str, float]:
        traces.append(trace)
        return {"peak": float(trace.of("press-1").samples["load_speed"].max())}

    with ThreadPoolExecutor(1) as threads:
        named = sweep(plant, seeds=range(3), until="5s", measure=texts, executor=threads, chunk=2)
        made = sweep(plant, seeds=range(3), until="5s", measure=function, executor=threads, chunk=2)
        for wrong in ({"peak": 5}, {5: "max speed of press-1"}, "max speed of press-1"):
            with pytest.raises(UsageError, match="measure.*max speed of press-1"):
                sweep(plant, seeds=[1], until="1s", measure=wrong, executor=threads)  # type: ignore[arg-type]
        with pytest.raises(UsageError, match="measure peak.*there are: .*press-1"):
            sweep(plant, seeds=[1], until="1s", measure={"peak": "max speed of press-9"}, executor=threads)
        with pytest.raises(UsageError, match="^two columns are named `seed`"):
            sweep(plant, seeds=[1], until="1s", measure={"seed": "max speed of press-1"}, executor=threads)
        # another measure is another campaign
        for peak in ("max speed of press-1", "min speed of press-1"):
            sweep(plant, seeds=[1], until="1s", measure={"peak": peak}, executor=threads, out=tmp_path)
    assert len(list(tmp_path.glob("*.parquet"))) == 2
    assert [row.measures["peak"] for row in named] == [row.measures["peak"] for row in made]
    assert [trace.digest for trace in traces] == [row.digest for row in made] == [row.digest for row in named]
    assert (named.units["peak"], named.units["lost"], named[0].measures["early"]) == ("rpm", "s", 0)
    columns = pyarrow.table(named)
    assert columns["never"].null_count == 3
    assert "never" not in named[0].measures
    assert columns.schema.metadata[b"plant_hash"].decode() == traces[0].samples.metadata["plant_hash"]


def test_loads_vary_with_units(plant: Plant) -> None:
    vary = {"drive.press-1.load.inertia": uniform("5kgcm2", "20kgcm2"), "drive.press-1.load.friction": choice("200mNm", "0.3Nm")}
    with ThreadPoolExecutor(1) as threads:
        varied = sweep(plant, seeds=range(4), until="2s", vary=vary, executor=threads)
        with pytest.raises(UsageError, match=r"5000000 kgm\^2 is outside 0 to 1000 kgm\^2"):
            plant.with_changes({"drive.press-1.load.inertia": "50000000000kgcm2"})
        with pytest.raises(UsageError, match="accepted: kgcm"):
            sweep(plant, seeds=[1], until="1s", vary={"drive.press-1.load.inertia": ["5rpm"]}, executor=threads)
    assert varied.units["drive.press-1.load.inertia"] == "kgcm2"
    for row in varied:
        inertia, friction = (str(row.variables[f"drive.press-1.load.{name}"]) for name in ("inertia", "friction"))
        plain = plant.with_changes(
            {
                "drive.press-1.load.inertia": float(inertia.removesuffix("kgcm2")) * 1e-4,
                "drive.press-1.load.friction": 0.2 if friction == "200mNm" else 0.3,
            },
            seed=row.seed,
        )
        written = plant.with_changes(row.variables, seed=row.seed).run("2s")
        assert written.digest == row.digest
        speeds = [trace.at("2s")["press-1"].speed for trace in (written, plain.run("2s"))]
        assert speeds[0] == pytest.approx(speeds[1])


def test_a_failure_is_run_again_here(pool: Executor, tmp_path: Path) -> None:
    plant = Plant.from_toml(LOSSY)
    result = sweep(plant, seeds=range(40), executor=pool)
    assert 0 < len(result.failures) < 40, result
    failure = result.failures[0]
    trace = failure.trace()
    assert trace.seed == failure.seed
    assert failure.results[0].name == "no fault"
    assert trace.only(FaultRaised)
    assert failure.plant().seed == failure.seed
    few = sweep(plant, seeds=range(1000), executor=pool, chunk=10, stop_after=1, out=tmp_path)
    assert 0 < len(few) < 1000
    assert not (tmp_path / "manifest.json").exists(), "it is not complete"
    assert len(few.failures) >= 1


def test_a_failure_is_shrunk_to_a_file(pool: Executor, tmp_path: Path) -> None:
    extra = """
[[drive]]
name = "akd-2"
event = [{ at = "1s", do = "warning=107" }]
"""
    vary: dict[str, Sequence[object] | Distribution] = {
        "drive.akd-1.load.friction": [0.1, 0.2],
        "drive.akd-1.load.torque": uniform(0, 0.1),
    }
    result = sweep(Plant.from_toml(LOSSY + extra), seeds=range(40), vary=vary, executor=pool)
    small = result.failures[0].shrink()
    assert small.is_smallest
    assert result.failures[0].shrink(executor=pool).plant.to_toml() == small.plant.to_toml()
    assert small.reason.startswith("akd-1: no fault: not met")
    small.save(tmp_path / "repro.toml")
    saved = Plant.from_file(tmp_path / "repro.toml")
    assert (saved.seed, saved.drives) == (small.seed, ("akd-1",))
    assert "torque" not in saved.to_toml(), "a varied value has no part in it"
    assert saved.run().only(FaultRaised)
    again = sweep(saved, seeds=[small.seed], executor=pool)
    assert [lost.name for lost in again.failures[0].results] == ["no fault"]
    with pytest.raises(UsageError, match="no expectation `other` fails"):
        result.failures[0].shrink(expectation="other")


def test_every_distribution_is_within_its_bounds(plant: Plant) -> None:
    path = "drive.press-1.load.friction"
    ways = {
        "uniform": uniform(0.1, 0.2),
        "log": log_uniform(0.1, 10),
        "normal": normal(0.3, 0.01),
        "choice": choice(0.1, 0.2),
    }
    for way in ways.values():
        [job] = _jobs(plant, "10ms", {path: way}, None)
        values = set(ipc.open_stream(_run(job, range(30))).read_all()[path].to_pylist())
        assert len(values) == (2 if way.kind == "choice" else 30)
    with pytest.raises(UsageError, match="not below"):
        sweep(plant, seeds=[1], vary={path: uniform(2, 1)})
    with pytest.raises(UsageError):
        sweep(plant, seeds=[1], vary={"drive.press-9.load.friction": uniform(0, 1)})


def test_a_sweep_goes_on_where_it_ended(plant: Plant, tmp_path: Path) -> None:
    class Ends(ThreadPoolExecutor):
        left = 2

        def submit(self, *arguments, **named):  # type: ignore[no-untyped-def]
            if Ends.left == 0:
                raise BrokenProcessPool("a worker is gone")
            Ends.left -= 1
            return super().submit(*arguments, **named)

    with Ends(1) as pool, pytest.raises(BrokenProcessPool):
        sweep(plant, seeds=range(20), until="1s", executor=pool, chunk=4, in_flight=1, out=tmp_path)
    assert not (tmp_path / "manifest.json").exists()
    kept = seeds_of(tmp_path)
    assert len(kept) == len(set(kept)) > 0
    asked: list[Progress] = []
    with ThreadPoolExecutor(1) as threads:
        whole = sweep(plant, seeds=range(20), until="1s", executor=threads, chunk=4, out=tmp_path, progress=asked.append)
        alone = sweep(plant, seeds=range(20), until="1s", executor=threads)
    assert asked[0].done > len(kept)
    assert same(whole) == same(alone)
    assert json.loads((tmp_path / "manifest.json").read_text())["runs"] == 20


def dies_at_seven(trace: Trace) -> dict[str, float]:
    if trace.seed == 7:
        raise RuntimeError("seed 7")
    return {}


def kills_at_seven(trace: Trace) -> dict[str, float]:
    if trace.seed == 7:
        os.kill(os.getpid(), signal.SIGKILL)
    return {}


def test_a_task_that_fails_is_repeated_and_divided(plant: Plant, tmp_path: Path) -> None:
    with ThreadPoolExecutor(2) as pool, pytest.raises(RuntimeError, match="seed 7"):
        sweep(plant, seeds=range(10), until="100ms", measure=dies_at_seven, executor=pool, chunk=10, out=tmp_path)
    done = set(seeds_of(tmp_path))
    assert 7 not in done
    assert done >= {0, 1, 2, 3, 4}


def test_a_killed_worker_loses_nothing_that_is_done(plant: Plant, tmp_path: Path) -> None:
    spawn = get_context("spawn")
    with ProcessPoolExecutor(2, mp_context=spawn) as pool, pytest.raises(BrokenProcessPool):
        sweep(plant, seeds=range(10), until="100ms", measure=kills_at_seven, executor=pool, chunk=2, out=tmp_path, in_flight=1)
    done = seeds_of(tmp_path)
    assert sorted(done) == [0, 1, 2, 3, 4, 5]


def test_a_worker_with_another_version_is_refused(plant: Plant) -> None:
    [job] = _jobs(plant, "10ms", {}, None)
    other = type(job)(job.text, job.until, job.vary, None, ("0.0.1", "0"))
    with pytest.raises(UsageError, match=rf"{re.escape(build_info().version)}.*0\.0\.1"):
        _run(other, [1])


def test_what_happens_at_the_start_of_a_plant_happens_in_a_sweep(pool: Executor) -> None:
    plant = Plant.from_toml(LOSSY)
    plant["akd-1"].inject("fault=439")
    for how in ({"chunk": 1}, {}):
        result = sweep(plant, seeds=[1, 2], until="100ms", executor=pool, **how)  # type: ignore[arg-type]
        assert [failure.seed for failure in result.failures] == [1, 2]
    [first, _] = result.failures
    assert first.digest == result[0].digest == first.trace().digest == plant.run("100ms", seed=1).digest


def test_a_row_has_the_digest_of_the_trace_of_its_run(press: Plant) -> None:
    path = "drive.press-1.load.inertia"
    [row] = sweep(press, seeds=[7], vary={path: [0.02]}, until="4s", chunk=1)
    changed = press.with_changes({path: 0.02}, seed=7)
    world = changed.start()
    world.run(for_="1s")
    assert world.trace.digest != row.digest
    assert world.run("4s").digest == row.digest
    assert press.run("4s", seed=7).digest != row.digest


def test_a_program_that_its_processes_cannot_import_is_named(tmp_path: Path) -> None:
    program = tmp_path / "unguarded.py"
    program.write_text(f"import profidrive\nprofidrive.sweep({str(PRESS)!r}, seeds=range(40), until='1s', chunk=20)\n")
    ended = subprocess.run([sys.executable, str(program)], capture_output=True, text=True, check=False, timeout=60)
    assert ended.returncode == 1
    last = ended.stderr[ended.stderr.rindex("profidrive.errors.") :]
    assert last.startswith("profidrive.errors.LocalError: a process of the sweep ended")
    assert 'if __name__ == "__main__":' in last


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_progress_is_a_line_of_a_terminal(pool: Executor, monkeypatch: pytest.MonkeyPatch) -> None:
    plant = Plant.from_toml(LOSSY)
    terminal, file, quiet = Terminal(), io.StringIO(), Terminal()
    monkeypatch.setattr(sys, "stderr", terminal)
    result = sweep(plant, seeds=range(8), executor=pool, chunk=4)
    shown = terminal.getvalue()
    assert shown.startswith("\r4 of 8 runs, ")
    assert shown.endswith(f"\r8 of 8 runs, {len(result.failures)} failed\x1b[K\n")
    monkeypatch.setattr(sys, "stderr", file)
    sweep(plant, seeds=range(1), executor=pool, chunk=4)
    monkeypatch.setattr(sys, "stderr", quiet)
    sweep(plant, seeds=range(1), executor=pool, chunk=4, progress=False)
    assert (file.getvalue(), quiet.getvalue()) == ("", "")


def one(trace: Trace) -> dict[str, float]:
    return {"number": 1.0}


def two(trace: Trace) -> dict[str, float]:
    return {"number": 2.0}


def test_rows_of_a_folder_are_those_of_the_same_measure(plant: Plant, tmp_path: Path) -> None:
    two.__qualname__ = one.__qualname__
    with ThreadPoolExecutor(1) as threads:
        found = [
            [
                row.measures["number"]
                for row in sweep(plant, seeds=[1], until="100ms", measure=measure, executor=threads, out=tmp_path)
            ]
            for measure in (one, two, one)
        ]
    assert found == [[1.0], [2.0], [1.0]]
    assert len(list(tmp_path.glob("*.parquet"))) == 2, "the last one was read"


def test_values_and_seeds_are_lists(plant: Plant) -> None:
    with pytest.raises(UsageError, match=r"friction = 0\.2: give a list"):
        sweep(plant, seeds=[1], vary={"drive.press-1.load.friction": 0.2})  # type: ignore[dict-item]
    with pytest.raises(UsageError, match=r"seeds=5: give a range"):
        sweep(plant, seeds=5)  # type: ignore[arg-type]


def test_ctrl_c_ends_a_sweep() -> None:
    program = f"""
import profidrive
def note(progress):
    if progress.done == 5:
        print("runs", flush=True)
if __name__ == "__main__":
    try:
        profidrive.sweep({str(PRESS)!r}, seeds=range(1_000_000), until="1s", chunk=5, progress=note)
    except KeyboardInterrupt:
        print("ended", flush=True)
"""
    assert output_when_interrupted(program).endswith("ended\n")


def test_a_result_is_a_table_with_typed_columns(pool: Executor, tmp_path: Path) -> None:
    vary: dict[str, Sequence[object] | Distribution] = {
        "drive.akd-1.event.1.at": uniform("900ms", "1100ms"),
        "drive.akd-1.load.friction": [0, 0.1],
    }
    result = sweep(Plant.from_toml(LOSSY), seeds=range(10), vary=vary, executor=pool, chunk=3, out=tmp_path)
    found = pyarrow.table(result)
    assert found.column_names == [*result.columns]
    types = {"seed": pyarrow.uint64(), "passed": pyarrow.bool_(), "failed": pyarrow.list_(pyarrow.string())}
    types |= {name: pyarrow.float64() for name in (*vary, "wall")}
    for name, kind in types.items():
        assert found.schema.field(name).type.equals(kind), name
    assert (result.units["drive.akd-1.event.1.at"], result.units["wall"]) == ("ms", "s")
    assert result[0].variables["drive.akd-1.event.1.at"] == f"{found['drive.akd-1.event.1.at'][0].as_py()}ms"
    assert [row.passed for row in result] == found["passed"].to_pylist()
    assert result[-1].seed == 9
    assert [row.seed for row in result[:2]] == [0, 1]
    frame = polars.DataFrame(result)
    assert frame.shape == found.shape
    # the folder is the same table
    kept = polars.read_parquet(tmp_path / "*.parquet").sort("drive.akd-1.load.friction", "seed")
    assert kept.drop("wall").equals(frame.drop("wall"))
    result.write(tmp_path / "whole.parquet")
    assert parquet.read_table(tmp_path / "whole.parquet").equals(found)
    assert "runs, " in result._repr_html_()
    assert len(sweep(Plant.from_toml(LOSSY), seeds=[], vary=vary, executor=pool)) == 0
    for seed in (-1, 1 << 63, 1 << 64):
        with pytest.raises(UsageError, match="seed"):
            sweep(Plant.from_toml(LOSSY), seeds=[seed], executor=pool)
    with pytest.raises(UsageError, match="empty"):
        sweep(Plant.from_toml(LOSSY), seeds=[1], vary={"seed": []})
