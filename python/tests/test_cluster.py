"""Campaigns on a Dask cluster of this computer."""

from __future__ import annotations

import dataclasses
import os
import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from pathlib import Path

import pytest
from distributed import Client

from profidrive import Plant, build_info, sweep, uniform
from profidrive.campaign import Progress, SweepResult, _jobs, _run
from profidrive.errors import UsageError

from .conftest import PRESS, output_when_interrupted
from .test_campaign import LOSSY


class Cluster:
    """A scheduler and two workers, each in a session of its own: one that outlived the test would hold its output open."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._processes: dict[str, subprocess.Popen[bytes]] = {}

    def start(self) -> Client:
        known = str(self._folder / "scheduler.json")
        local = ["--host", "127.0.0.1", "--scheduler-file", known]
        self._start("scheduler", [*local, "--port", "0", "--no-dashboard"])
        for name in ("worker-1", "worker-2"):
            once = ["--name", name, "--nthreads", "1", "--no-nanny", "--no-dashboard", "--death-timeout", "10"]
            self._start(name, [*local, *once, "--local-directory", str(self._folder)])
        client = Client(scheduler_file=known, timeout=10)  # type: ignore[no-untyped-call]
        client.wait_for_workers(2, timeout=10)
        return client

    def _start(self, name: str, arguments: list[str]) -> None:
        command = [sys.executable, "-m", "dask", name.split("-")[0], *arguments]
        with open(self._folder / f"{name}.txt", "wb") as output:
            self._processes[name] = subprocess.Popen(
                command, stdin=subprocess.DEVNULL, stdout=output, stderr=output, start_new_session=True
            )

    def kill(self, name: str) -> None:
        process = self._processes.pop(name)
        os.killpg(process.pid, signal.SIGKILL)
        process.wait(30)

    def end(self) -> None:
        for name in list(self._processes):
            self.kill(name)


@contextmanager
def running(folder: Path) -> Iterator[tuple[Cluster, Client]]:
    cluster = Cluster(folder)
    try:
        with cluster.start() as client:
            yield cluster, client
    finally:
        cluster.end()


def rows(result: SweepResult) -> list[tuple[object, ...]]:
    return [(row.seed, dict(row.variables), row.failed, row.digest) for row in result]


@pytest.mark.filterwarnings("default")
def test_rows_of_a_cluster_are_those_of_a_pool_when_a_worker_is_killed(tmp_path: Path) -> None:
    plant, vary = Plant.from_toml(LOSSY), {"drive.akd-1.load.friction": uniform(0.1, 0.4)}
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        expected = rows(sweep(plant, seeds=range(100), vary=vary, executor=pool, chunk=5))
    with running(tmp_path) as (cluster, client):
        executor: Executor = client.get_executor()  # type: ignore[no-untyped-call]
        whole = sweep(plant, seeds=range(100), vary=vary, executor=executor, chunk=5)
        assert rows(whole) == expected
        done: list[int] = []

        def kill_one(progress: Progress) -> None:
            done.append(progress.done)
            if len(done) == 1:
                # it has tasks that it did not begin, one that it carries out, and results that were not fetched
                cluster.kill("worker-2")

        # tasks of another size than before: the scheduler keeps what it has done
        halved = sweep(plant, seeds=range(100), vary=vary, executor=executor, chunk=2, progress=kill_one)
        assert rows(halved) == expected
        assert done == list(range(2, 101, 2)), "each task is counted once"
        assert 0 < len(whole.failures) < 100
        assert len(client.scheduler_info()["workers"]) == 1
        [job] = _jobs(Plant.from_file(PRESS), "10ms", {}, None)
        with pytest.raises(UsageError, match=rf"{re.escape(build_info().version)}.*0\.0\.1"):
            executor.submit(_run, dataclasses.replace(job, build=("0.0.1", "0")), [1]).result(30)
        program = f"""
from distributed import Client
import profidrive
def note(progress):
    if progress.done == 10:
        print("runs", flush=True)
with Client(scheduler_file={str(tmp_path / "scheduler.json")!r}, timeout=10) as client:
    try:
        profidrive.sweep({str(PRESS)!r}, seeds=range(1_000_000), until="1s", chunk=5, progress=note, executor=client.get_executor())
    except KeyboardInterrupt:
        print("ended", flush=True)
"""
        assert "ended\n" in output_when_interrupted(program)
        # the cluster goes on
        assert rows(sweep(plant, seeds=range(2), vary=vary, executor=executor, chunk=1)) == expected[:2]
