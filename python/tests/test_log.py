"""What is logged: by a thread of its own, bounded, and only what is wanted."""

from __future__ import annotations

import logging
import subprocess
import sys
import threading
from collections.abc import Iterator

import pytest

from profidrive import Plant
from profidrive.errors import UnknownParameter


class Records(logging.Handler):
    """Collects records; can be made to wait."""

    def __init__(self) -> None:
        super().__init__()
        self.news = threading.Condition()
        self.seen: list[logging.LogRecord] = []
        self.goes_on = threading.Event()
        self.goes_on.set()

    def emit(self, record: logging.LogRecord) -> None:
        self.goes_on.wait(20)
        with self.news:
            self.seen.append(record)
            self.news.notify_all()

    def wait_for(self, name: str, text: str) -> logging.LogRecord:
        def found() -> logging.LogRecord | None:
            fits = (record for record in self.seen if record.name == name and text in record.getMessage())
            return next(fits, None)

        with self.news:
            self.news.wait_for(found, 20)
            record = found()
        assert record is not None, [record.getMessage() for record in self.seen]
        return record


@pytest.fixture
def records() -> Iterator[Records]:
    logger = logging.getLogger("profidrive")
    records = Records()
    logger.addHandler(records)
    logger.setLevel(logging.DEBUG)
    yield records
    records.goes_on.set()
    logger.removeHandler(records)
    logger.setLevel(logging.NOTSET)


def test_calls_motions_and_plants_are_logged_by_their_loggers(records: Records) -> None:
    world = Plant.of("akd").start()
    drive = world.network["akd-1"]
    with pytest.raises(UnknownParameter):
        drive.read("DRV.NONE")
    drive.write({"DRV.ACC": 5000})
    with drive.control(max_speed="100rpm") as axis:
        axis.run(50, for_="100ms")
    world["akd-1"].inject("fault=439")
    world.run(for_="100ms")
    for name, level, text in [
        ("network", logging.INFO, "DRV.NONE"),
        ("network", logging.INFO, "akd-1: write: done"),
        ("axis", logging.INFO, "akd-1: run: done"),
        ("plant", logging.DEBUG, "S4"),
        ("plant", logging.INFO, "F439"),
    ]:
        found = records.wait_for(f"profidrive.{name}", text)
        assert found.levelno == level, found.getMessage()
    assert {record.threadName for record in records.seen} != {threading.current_thread().name}


def test_nothing_is_logged_below_the_level(records: Records) -> None:
    logging.getLogger("profidrive.plant").setLevel(logging.ERROR)
    try:
        world = Plant.of("akd").start()
        world["akd-1"].inject("fault=439")
        world.run(for_="100ms")
        world.network["akd-1"].read("p922")
        records.wait_for("profidrive.network", "read")
    finally:
        logging.getLogger("profidrive.plant").setLevel(logging.NOTSET)
    assert {record.name for record in records.seen} == {"profidrive.network"}


def test_records_without_room_are_counted(records: Records) -> None:
    records.goes_on.clear()
    world = Plant.of("akd").start()
    drive = world["akd-1"]
    for _ in range(1500):
        drive.inject("warning=107", for_="4ms")
        world.run(for_="8ms")
    records.goes_on.set()
    found = records.wait_for("profidrive", "dropped")
    assert found.levelno == logging.WARNING
    assert int(found.getMessage().split()[0]) > 100


def test_a_handler_that_never_returns_does_not_hold_up_the_end_of_a_program() -> None:
    program = """
import logging, threading
from profidrive import Plant
class Waits(logging.Handler):
    def createLock(self):
        # Python itself waits for it at its end
        self.lock = None
    def emit(self, record):
        print("waits", flush=True)
        threading.Event().wait()
logging.getLogger("profidrive").addHandler(Waits())
logging.getLogger("profidrive").setLevel("DEBUG")
world = Plant.of("akd").start()
world["akd-1"].inject("fault=439")
world.run(for_=1)
"""
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=30)
    assert (ended.returncode, ended.stdout) == (0, "waits\n"), ended.stderr
