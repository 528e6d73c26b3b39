from __future__ import annotations

import signal
import subprocess
import sys
from pathlib import Path

import pytest

from profidrive import Plant

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
        assert child.stdout is not None
        assert child.stdout.readline() == "runs\n"
        child.send_signal(signal.SIGINT)
        try:
            output, _ = child.communicate(timeout=30)
        finally:
            child.kill()
    return output
