from __future__ import annotations

from pathlib import Path

import pytest

from profidrive import Plant

PRESS = Path(__file__).parents[2] / "examples" / "plants" / "press.toml"

pytest_plugins = ["pytester"]


@pytest.fixture
def press() -> Plant:
    return Plant.from_file(PRESS)
