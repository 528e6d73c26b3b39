"""What calls of the package cost, each beside its anchor and its budget; `make bench ARGS=python` runs it.

An anchor is measured in the same run: what this computer needs without the package. A budget that was set on another computer is
as many times higher as the anchor is here.
"""

from __future__ import annotations

import asyncio
import os
import resource
import signal
import socket
import statistics
import subprocess
import sys
import threading
import time
from collections.abc import Awaitable, Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy
import polars
from pymodbus.client import AsyncModbusTcpClient, ModbusTcpClient

import profidrive
from profidrive import Plant, aio
from profidrive._waiting import asynchronous
from profidrive.lab import CLIENT, DRIVES

ROOT = Path(__file__).parents[2]
PROGRAM = Path(os.environ["PROFIDRIVE"])
PRESS = ROOT / "examples" / "plants" / "press.toml"
ROUNDS = 5
PORT = 15020

SERVER = f"""
import asyncio
from pymodbus.datastore import ModbusDeviceContext, ModbusSequentialDataBlock, ModbusServerContext
from pymodbus.server import StartAsyncTcpServer

device = ModbusDeviceContext(hr=ModbusSequentialDataBlock(1, [7] * 200))
asyncio.run(StartAsyncTcpServer(ModbusServerContext(devices=device, single=True), address=("127.0.0.1", {PORT})))
"""

late = 0


def row(what: str, measured: float, anchor: float | None, budget: float | None, unit: str) -> None:
    """Prints a line. A budget is the highest time, in the unit of the line; for a ratio the lowest one."""
    global late
    shown = "" if anchor is None else f"{anchor:.4g} {unit}"
    verdict = ""
    if budget is not None:
        fits = measured >= budget if unit == "x" else measured <= budget
        verdict = "within" if fits else "OVER"
        late += not fits
    limit = "" if budget is None else f"{budget:.4g} {unit}"
    print(f"{what:<58} {f'{measured:.4g} {unit}':>12} {shown:>12} {limit:>12} {verdict}", flush=True)


def median(work: Callable[[], object], times: int) -> float:
    """Seconds of one call: the median of rounds of so many."""
    work()
    rounds = []
    for _ in range(ROUNDS):
        begin = time.perf_counter()
        for _ in range(times):
            work()
        rounds.append((time.perf_counter() - begin) / times)
    return statistics.median(rounds)


async def median_of(work: Callable[[], Awaitable[object]], times: int) -> float:
    await work()
    rounds = []
    for _ in range(ROUNDS):
        begin = time.perf_counter()
        for _ in range(times):
            await work()
        rounds.append((time.perf_counter() - begin) / times)
    return statistics.median(rounds)


@contextmanager
def running(*command: str) -> Iterator[subprocess.Popen[str]]:
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


@contextmanager
def drives(count: int) -> Iterator[None]:
    """So many virtual drives in another process, at the other end of the cable."""
    name = ["--name", "akd-1"] if count == 1 else ["--name", "akd", "--count", str(count)]
    command = [str(PROGRAM), "simulate", "--json", "-i", DRIVES, "--ip", "192.168.77.50/24", *name]
    with running(*command) as process:
        assert process.stdout is not None
        for _ in range(count):
            assert "ready" in process.stdout.readline()
        threading.Thread(target=process.stdout.read, daemon=True).start()
        yield


def nothing() -> None:
    """What a thread is woken for."""


def calls() -> None:
    network = Plant.of("akd").start().network
    network["akd-1"].read("DRV.ACC")
    us = 1e6
    row("a call that does nothing", us * median(network.stop_all, 2000), 8, 15, "us")
    waited = asyncio.run(median_of(lambda: asynchronous.call(network.stop_all), 1000))
    thread = asyncio.run(median_of(lambda: asyncio.to_thread(nothing), 1000))
    # the budget was 60 us where this took 60
    row("a call that does nothing, asyncio, and a thread of it", us * waited, us * thread, us * thread, "us")


async def modbus_of_loop() -> float:
    client = AsyncModbusTcpClient("127.0.0.1", port=PORT)
    await client.connect()
    found = await median_of(lambda: client.read_holding_registers(0, count=1), 200)
    client.close()
    return found


def modbus() -> tuple[float, float, float]:
    """Reading one register, one with asyncio, and 100."""
    with running(sys.executable, "-c", SERVER):
        client = ModbusTcpClient("127.0.0.1", port=PORT)
        end = time.monotonic() + 10
        while not client.connect():
            assert time.monotonic() < end
        one = median(lambda: client.read_holding_registers(0, count=1), 200)
        many = median(lambda: client.read_holding_registers(0, count=100), 200)
        looped = asyncio.run(modbus_of_loop())
        client.close()
        return one, looped, many


def program(*arguments: str) -> float:
    """Seconds of a process of the program that reads the parameter."""
    command = [str(PROGRAM), "read", *arguments, "DRV.ACC", "--json"]
    return median(lambda: subprocess.run(command, check=True, capture_output=True), 2)


def reads() -> None:
    us = 1e6
    one, looped, many = modbus()
    with drives(1), profidrive.open(ip=True) as network:
        drive = network["192.168.77.50"]
        chosen = [parameter.name for parameter in drive.parameters("DRV.").parameters if parameter.name][:39]
        sync = median(lambda: drive.read("DRV.ACC"), 100)
        row("read a parameter by IP", us * sync, us * one, us * 2 * one, "us")
        awaited = aio.Network(network._network)["192.168.77.50"]
        asynchronously = asyncio.run(median_of(lambda: awaited.read("DRV.ACC"), 100))
        row("read a parameter by IP, asyncio", us * asynchronously, us * looped, us * 2 * looped, "us")
        row(
            f"read {len(chosen)} parameters in one call",
            us * median(lambda: drive.read(chosen), 50),
            us * many,
            us * 2.5 * many,
            "us",
        )

        row("the same by a process of the program, by IP", program("192.168.77.50") / sync, None, 10, "x")


def names() -> None:
    with drives(1):
        process = program("akd-1", "-i", CLIENT)
        with profidrive.open(CLIENT) as network:
            by_name = median(lambda: network["akd-1"].read("DRV.ACC"), 50)
        row("the same by a process of the program, by name", process / by_name, None, 300, "x")


ECHO = f"""
import socket
echo = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
echo.bind(("127.0.0.1", {PORT}))
print("ready", flush=True)
while True:
    echo.sendto(*echo.recvfrom(2048))
"""


def echoes() -> float:
    """How much faster 100 datagrams and their echoes are at once than one after the other: what this computer has to give."""
    with running(sys.executable, "-c", ECHO) as process, socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as client:
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        client.connect(("127.0.0.1", PORT))
        client.settimeout(10)

        def at_once(count: int) -> None:
            for _ in range(count):
                client.send(bytes(200))
            for _ in range(count):
                client.recv(2048)

        def one_by_one() -> None:
            for _ in range(100):
                at_once(1)

        return median(one_by_one, 5) / median(lambda: at_once(100), 5)


def fleet() -> None:
    most = echoes()
    with drives(100), profidrive.open(CLIENT) as network:
        found = network.select("all")
        assert len(found) == 100
        found.read("DRV.ACC")
        at_once = median(lambda: found.read("DRV.ACC"), 1)
        one_by_one = median(lambda: [drive.read("DRV.ACC") for drive in found], 1)
        row("100 drives at once, against one after the other", one_by_one / at_once, most, 10, "x")


def record() -> None:
    with drives(1), profidrive.open(CLIENT) as network:
        drive = network["akd-1"]

        def used(work: Callable[[], object]) -> float:
            begin = resource.getrusage(resource.RUSAGE_SELF)
            work()
            end = resource.getrusage(resource.RUSAGE_SELF)
            return end.ru_utime + end.ru_stime - begin.ru_utime - begin.ru_stime

        # the begin and the end of a connection are those of an hour too
        around = used(lambda: drive.record("all", every="cycle", for_=1))
        recordings = []
        whole = used(lambda: recordings.append(drive.record("all", every="cycle", for_=21)))
        [recording] = recordings
        print(f"  recorded {len(recording)} rows, {recording.drives[0].missed} missed")
        with drive.control(max_speed="10rpm", lease=60):
            alone = used(lambda: time.sleep(20))
        row("record all signals with each cycle, and the connection alone", 100 * (whole - around) / 20, 100 * alone / 20, 1, "%")


def tables() -> None:
    world = Plant.from_file(PRESS).with_changes({"sample": "1ms"}).start()
    samples = world.run(until="19s").samples
    us = 1e6
    print(f"  a table of {len(samples)} rows")
    row("a column as a numpy array", us * median(lambda: samples["speed"], 500), 3, 100, "us")
    row("the table in polars", us * median(lambda: polars.DataFrame(samples), 200), 19, 100, "us")
    assert isinstance(samples["speed"], numpy.ndarray)


def plants() -> None:
    ms = 1e3
    plant = Plant.from_file(PRESS)
    command = [str(PROGRAM), "simulate", str(PRESS), "--virtual-time", "--quiet"]
    process = median(lambda: subprocess.run(command, check=False, capture_output=True), 3)
    whole = median(plant.run, 10)
    # the budget was 15 ms where the process took 17
    row("a run of the press plant, 30 s, and a process of it", ms * whole, ms * process, ms * process * 15 / 17, "ms")
    inside = median(lambda: plant._plant.start().run(), 10)
    row("the same and the call of the library alone", ms * whole, ms * inside, ms * inside * 1.1, "ms")

    def together() -> None:
        threads = [threading.Thread(target=lambda: [plant.run() for _ in range(20)]) for _ in range(2)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()

    alone = median(lambda: [plant.run() for _ in range(40)], 1)
    row("the same by two threads", alone / median(together, 1), None, 1.8, "x")


INTERRUPTED = """
import time
import profidrive
world = profidrive.Plant.of("akd").start()
with world.network["akd-1"].control(max_speed="600rpm") as axis:
    print("runs", flush=True)
    try:
        axis.run("300rpm", for_="10000000s")
    except KeyboardInterrupt:
        print(time.time(), flush=True)
"""


def interrupts() -> None:
    took = []
    for _ in range(ROUNDS):
        with running(sys.executable, "-c", INTERRUPTED) as process:
            assert process.stdout is not None
            assert process.stdout.readline() == "runs\n"
            time.sleep(0.2)
            begin = time.time()
            process.send_signal(signal.SIGINT)
            took.append(float(process.stdout.readline()) - begin)
    row("Ctrl-C to the end of the call, the axis at rest", 1e3 * statistics.median(took), 2, 76, "ms")


def main() -> int:
    print(f"{'':<58} {'here':>12} {'anchor':>12} {'budget':>12}")
    for part in (calls, reads, names, fleet, record, tables, plants, interrupts):
        part()
    return int(late > 0)


if __name__ == "__main__":
    sys.exit(main())
