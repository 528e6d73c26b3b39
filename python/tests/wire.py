"""A virtual drive in a process of its own, at the other end of a cable."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable
from pathlib import Path

from profidrive.events import Event, StateChanged, event_of
from profidrive.lab import DRIVES, Lab

PROGRAM = Path(__file__).parents[2] / "target" / "debug" / "profidrive"
SECONDS = 20.0
"""How long anything of a test may last; then the test fails with what there was until then."""

BEGIN = """
import os, signal, sys, threading, time
import profidrive
from profidrive.errors import *

def say(*words):
    print(*words, flush=True)

network = profidrive.open("ctl0")
drive = network["akd-1"]
"""


class Simulation:
    """`profidrive simulate` with the events that it prints."""

    def __init__(self, wire: Wire, options: list[str]) -> None:
        self.events: list[Event] = []
        self._news = threading.Condition()
        command = [str(PROGRAM), "simulate", "--json", "--quiet", "-i", DRIVES, *options]
        self.process = wire.start(command)
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        self._begun = time.monotonic()

    def now(self) -> float:
        """Seconds since it was started, which is a little more than the time of its events."""
        return time.monotonic() - self._begun

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            if line.startswith("{"):
                with self._news:
                    self.events.append(event_of(json.loads(line)))
                    self._news.notify_all()

    def wait_for(self, what: Callable[[Event], bool], *, after: float = -1.0) -> Event:
        """Waits for an event."""

        def found() -> Event | None:
            return next((event for event in self.events if event.time > after and what(event)), None)

        with self._news:
            assert self._news.wait_for(found, SECONDS), self.events
        event = found()
        assert event is not None
        return event

    def wait_for_state(self, new: int, *, after: float = -1.0) -> Event:
        return self.wait_for(lambda event: isinstance(event, StateChanged) and event.new == new, after=after)


class Wire:
    """A laboratory with the programs that run in it."""

    def __init__(self, folder: Path) -> None:
        self._lab = Lab()
        self._folder = folder
        self._started: list[subprocess.Popen[str]] = []

    def __enter__(self) -> Wire:
        self._lab.__enter__()
        return self

    def __exit__(self, *_: object) -> None:
        for process in self._started:
            process.kill()
            process.wait(SECONDS)
            for stream in (process.stdin, process.stdout):
                if stream is not None:
                    stream.close()
        self._lab.__exit__(None, None, None)

    def start(self, command: list[str]) -> subprocess.Popen[str]:
        folders = {f"XDG_{name}": str(self._folder) for name in ("RUNTIME_DIR", "STATE_HOME", "CONFIG_HOME", "CACHE_HOME")}
        process = subprocess.Popen(
            self._lab.command(command), stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env={**os.environ, **folders}
        )
        self._started.append(process)
        return process

    def simulate(self, *options: str) -> Simulation:
        simulation = Simulation(self, list(options) or ["--name", "akd-1", "--ip", "192.168.77.50/24"])
        simulation.wait_for(lambda event: "ready" in getattr(event, "text", ""))
        return simulation

    def python(self, program: str) -> Program:
        return Program(self.start([sys.executable, "-W", "error", "-c", BEGIN + program]))

    def run(self, *command: str) -> None:
        assert self.start(list(command)).wait(SECONDS) == 0, command


def line_of(process: subprocess.Popen[str]) -> str:
    """Returns the next line that a process prints; fails where it prints none in time."""
    assert process.stdout is not None
    limit = threading.Timer(SECONDS, process.kill)
    limit.start()
    line = process.stdout.readline()
    limit.cancel()
    # nothing but the limit kills it
    assert line, f"it printed no line within {SECONDS} s, or has ended ({process.poll()}): {process.args!r}"
    return line.rstrip("\n")


class Program:
    """A program in Python that uses the drive."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self.process = process

    def line(self) -> str:
        return line_of(self.process)

    def interrupt(self) -> None:
        self.process.send_signal(signal.SIGINT)

    def end(self) -> tuple[int, list[str]]:
        """Waits for its end; returns its exit code and what it has printed since."""
        output, _ = self.process.communicate(timeout=SECONDS)
        return self.process.returncode, output.splitlines()
