from __future__ import annotations

import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from profidrive import Plant

from .wire import line_of

PRESS = Path(__file__).parents[2] / "examples" / "plants" / "press.toml"

pytest_plugins = ["pytester"]

# what a shell runs in the background ignores it, and so would the programs of the tests
signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture
def press() -> Plant:
    return Plant.from_file(PRESS)


def output_when_interrupted(program: str) -> str:
    """Runs a program until it prints `runs`, sends it the signal of Ctrl-C and returns what it prints after that."""
    with subprocess.Popen([sys.executable, "-c", program], stdout=subprocess.PIPE, text=True) as child:
        try:
            assert line_of(child) == "runs"
            child.send_signal(signal.SIGINT)
            output, _ = child.communicate(timeout=30)
        finally:
            # the end of the block waits for it
            child.kill()
    return output


def until(happens: Callable[[], bool], what: str) -> None:
    """Waits for something that another thread brings about."""
    end = time.monotonic() + 30
    while not happens():
        assert time.monotonic() < end, f"not within 30 s: {what}"
