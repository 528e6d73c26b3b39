"""Plants of virtual drives, in virtual time."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from types import TracebackType
from typing import Any

from profidrive import _profidrive
from profidrive._sync import Network, network_of
from profidrive._values import chosen, document, goal_text, optional_span, seed_of, span, value_text
from profidrive.errors import MisuseError
from profidrive.events import (
    DriveMessage,
    Event,
    ExpectationResult,
    ParameterReading,
    event_of,
)
from profidrive.trace import Trace, judged, read_results
from profidrive.types import Duration, Path, State, Value
from profidrive.words import Stw1, Zsw1


class Plant:
    """Virtual drives, what happens to them, and the controllers that run them. Nothing runs before `start` or `run`."""

    def __init__(self, plant: _profidrive.Plant) -> None:
        self._plant = plant

    @classmethod
    def from_file(cls, path: Path) -> Plant:
        """Reads a plant file."""
        return cls(_profidrive.Plant.from_file(os.fspath(path)))

    @classmethod
    def from_toml(cls, text: str) -> Plant:
        """Reads the text of a plant file."""
        return cls(_profidrive.Plant.from_toml(text))

    @classmethod
    def of(cls, *models: str) -> Plant:
        """Returns drives of these models as they are delivered: `Plant.of("akd", "vlt")` has `akd-1` and `vlt-1`."""
        return cls(_profidrive.Plant.of(list(models)))

    @property
    def drives(self) -> tuple[str, ...]:
        """Names of the drives."""
        return tuple(self._plant.drives)

    @property
    def seed(self) -> int:
        """Seed of all random events."""
        return self._plant.seed

    @property
    def duration(self) -> float | None:
        """Seconds of a run where none is given."""
        return self._plant.duration

    @property
    def expectations(self) -> tuple[str, ...]:
        """Names of the expectations of the plant file."""
        return tuple(self._plant.expectations)

    def with_changes(self, changes: Mapping[str, object], *, seed: int | None = None) -> Plant:
        """Returns the plant with other values, such as `{"drive.press-1.load.friction": 0.4}`. Comments of the file stay."""
        values = dict(changes) if seed is None else {**changes, "seed": seed_of(seed)}
        return Plant(self._plant.with_changes(document(values)))

    def to_toml(self) -> str:
        """Returns the text of a plant file of this plant."""
        return self._plant.to_toml()

    def start(self, *, seed: int | None = None, capture: Path | None = None, machine: Path | None = None) -> World:
        """Returns the plant at its start.

        Args:
            seed: seed of all random events; that of the plant where it is None.
            capture: a new file for all frames (`.pcapng`).
            machine: the machine file of `World.network`, as `profidrive.open` has it.
        """
        chance = None if seed is None else seed_of(seed)
        files = [None if file is None else os.fspath(file) for file in (capture, machine)]
        return World(self._plant.start(chance, *files))

    def run(self, until: Duration | None = None, *, seed: int | None = None) -> Trace:
        """Runs the plant from its start, until its `duration` where no time is given, and returns what happened."""
        return self.start(seed=seed).run(until)

    def serve(self, interface: str, *, state: Path | None = None) -> Served:
        """Puts the drives on a network interface in a `with` block, where a controller finds them, in real time.

        They are ready when the block begins, and run until it ends, whatever the `duration` of the plant. Its controllers and its
        expectations are left out.

        Args:
            interface: a network interface; raw sockets are required there.
            state: a folder that keeps names, addresses and saved parameters; without one they are discarded at the end.

        Raises:
            PermissionMissing: when raw sockets are not permitted (CAP_NET_RAW).
            UnreachableError: when the interface is not there or is down.
        """
        return Served(self, interface, None if state is None else os.fspath(state))

    def __getitem__(self, drive: str) -> PlantDrive:
        return PlantDrive(self, chosen(self.drives, drive, "drive"))

    def __repr__(self) -> str:
        return f"<Plant of {', '.join(self.drives)}>"


class PlantDrive:
    """A drive of a plant that does not run."""

    __slots__ = ("_plant", "name")

    def __init__(self, plant: Plant, name: str) -> None:
        self._plant = plant
        self.name = name

    def inject(self, action: str, *, for_: Duration | None = None) -> None:
        """Injects an event at the start of every later run of this plant: it is at 0 s in its text."""
        self._plant._plant = self._plant._plant.with_event(self.name, action, optional_span(for_))


class Served:
    """A plant on a network interface, in real time; see `Plant.serve`."""

    def __init__(self, plant: Plant, interface: str, state: str | None) -> None:
        self._plant = plant
        self._interface = interface
        self._state = state
        self._served: _profidrive.Served | None = None

    def __enter__(self) -> Served:
        if self._served is not None:
            raise MisuseError("a plant is served in one block")
        self._served = self._plant._plant.serve(self._interface, self._state)
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._running.close()

    @property
    def _running(self) -> _profidrive.Served:
        if self._served is None:
            raise MisuseError("the plant runs in a with block")
        return self._served

    @property
    def drives(self) -> tuple[str, ...]:
        """Names of the drives."""
        return self._plant.drives

    @property
    def events(self) -> tuple[Event, ...]:
        """What has happened until now, with times from the start; the last 100,000 events."""
        return tuple(event_of(event) for event in json.loads(self._running.events()))

    @property
    def trace(self) -> Trace:
        """What has happened until now, and the states of the drives, with times from the start.

        The run is one in real time: its `digest` is that of its events, and another run has another one. `cut` is the time up to
        which there was room.
        """
        return Trace(self._running.trace())

    def wait_until(self, drive: str, *, timeout: Duration, **condition: object) -> Event:
        """Waits until conditions hold of a drive, as `World.run_until` has them, and returns the event that reports it.

        That may be from before the call, where they held already; a sample of now where no event reports it. A condition on a
        parameter cannot be waited for.

        Raises:
            ExpectationFailed: when they did not hold in time.
        """
        chosen(self.drives, drive, "drive")
        return event_of(json.loads(self._running.wait_until(goal_text(drive, condition), span(timeout))))

    def __getitem__(self, drive: str) -> ServedDrive:
        return ServedDrive(self, chosen(self.drives, drive, "drive"))

    def __repr__(self) -> str:
        return f"<Served {', '.join(self.drives)} on {self._interface}>"


class SimulatedDrive:
    """What a drive is like now: the simulated state, without a frame on the network."""

    __slots__ = ("name",)

    name: str

    def _look(self) -> dict[str, Any]:
        raise NotImplementedError

    @property
    def state(self) -> State:
        """State of the general state machine."""
        return State(self._look()["state"])

    @property
    def stw1(self) -> Stw1:
        """Control word in force."""
        return Stw1(self._look()["stw1"])

    @property
    def zsw1(self) -> Zsw1:
        """Status word that the drive sends."""
        return Zsw1(self._look()["zsw1"])

    @property
    def speed(self) -> float:
        """True speed of the shaft, rpm."""
        return float(self._look()["speed"])

    @property
    def position(self) -> float:
        """Position that the drive reports, rev."""
        return float(self._look()["position"])

    @property
    def current(self) -> float:
        """Current of the motor, A."""
        return float(self._look()["current"])

    @property
    def torque(self) -> float:
        """Torque of the motor, Nm."""
        return float(self._look()["torque"])

    @property
    def moving(self) -> bool:
        """Whether the axis turns."""
        return bool(self._look()["moving"])

    @property
    def connected(self) -> bool | None:
        """Whether a controller exchanges data with the drive; None before the first one did."""
        connected: bool | None = self._look()["connected"]
        return connected

    @property
    def faults(self) -> tuple[DriveMessage, ...]:
        """Faults that are present."""
        return _messages(self._look()["faults"])

    @property
    def warnings(self) -> tuple[DriveMessage, ...]:
        """Warnings that are present."""
        return _messages(self._look()["warnings"])


class ServedDrive(SimulatedDrive):
    """A virtual drive on a network interface."""

    __slots__ = ("_served",)

    def __init__(self, served: Served, name: str) -> None:
        self._served = served
        self.name = name

    def _look(self) -> dict[str, Any]:
        seen: dict[str, Any] = json.loads(self._served._running.look(self.name))
        return seen

    @property
    def events(self) -> tuple[Event, ...]:
        """What has happened to the drive until now."""
        return tuple(event for event in self._served.events if event.drive == self.name)

    def inject(self, action: str, *, for_: Duration | None = None) -> None:
        """Injects an event now: `"sto=on"`, `"cable=pulled"`, `"load=0.8Nm"`; with `for_` for this time."""
        self._served._running.inject(self.name, action, optional_span(for_))

    def __repr__(self) -> str:
        return f"<ServedDrive {self.name}: {self.state}>"


class World:
    """A plant in virtual time, which passes only while `run` or `run_until` waits."""

    def __init__(self, world: _profidrive.World) -> None:
        self._world = world

    @property
    def now(self) -> float:
        """Seconds since the start."""
        return self._world.now

    @property
    def seed(self) -> int:
        """The seed of this run."""
        return self._world.seed

    @property
    def drives(self) -> tuple[str, ...]:
        """Names of the drives."""
        return tuple(self._world.drives)

    @property
    def trace(self) -> Trace:
        """What has happened until now."""
        return Trace(self._world.trace())

    @property
    def network(self) -> Network:
        """The network of the plant, for the code of a client: its waiting calls pass virtual time. It joins at its first use."""
        return network_of(self)

    def run(self, until: Duration | None = None, *, for_: Duration | None = None) -> Trace:
        """Runs until a time since the start, or for a time; until the `duration` of the plant where neither is given.

        Returns what has happened until then.
        """
        self._world.run(optional_span(until), optional_span(for_))
        return self.trace

    def run_until(self, drive: str, *, timeout: Duration, **condition: object) -> Event:
        """Runs until conditions hold of a drive, such as `fault=702` or `state="S4"`, and returns the event that reports it.

        The conditions are those of expectations, with `_` for `-`; with `for_` they must hold for that time.

        Raises:
            ExpectationFailed: when they did not hold in time.
        """
        chosen(self.drives, drive, "drive")
        return event_of(json.loads(self._world.run_until(goal_text(drive, condition), span(timeout))))

    def check(self) -> tuple[ExpectationResult, ...]:
        """Ends the checks of the expectations of the plant file, parameters included, and returns what came of them."""
        return tuple(result for result, _ in results_of(self))

    def expect(self) -> tuple[ExpectationResult, ...]:
        """Ends the checks of the expectations of the plant file, parameters included.

        Raises:
            ExpectationFailed: when one did not come true; it has all results.
        """
        return judged(results_of(self))

    def finish_capture(self) -> None:
        """Completes the file with the frames."""
        self._world.finish_capture()

    def __getitem__(self, drive: str) -> VirtualDrive:
        return VirtualDrive(self._world, chosen(self.drives, drive, "drive"))

    def __repr__(self) -> str:
        return f"<World of {', '.join(self.drives)} at {self.now} s>"


class VirtualDrive(SimulatedDrive):
    """A drive in virtual time."""

    __slots__ = ("_world",)

    def __init__(self, world: _profidrive.World, name: str) -> None:
        self._world = world
        self.name = name

    def _look(self) -> dict[str, Any]:
        seen: dict[str, Any] = json.loads(self._world.look(self.name))
        return seen

    def inject(self, action: str, *, for_: Duration | None = None) -> None:
        """Injects an event now: `"sto=on"`, `"cable=pulled"`, `"load=0.8Nm"`; with `for_` for this time."""
        self._world.inject(self.name, action, optional_span(for_))

    def read(self, parameter: str) -> ParameterReading:
        """Returns a parameter as the drive reports it now."""
        return ParameterReading._of(json.loads(self._world.read(self.name, parameter)))

    def write(self, values: Mapping[str, Value]) -> tuple[ParameterReading, ...]:
        """Writes parameters in this order, not saved, and returns them as read back."""
        written = [self._world.write(self.name, name, value_text(value)) for name, value in values.items()]
        return tuple(ParameterReading._of(json.loads(reading)) for reading in written)

    def __repr__(self) -> str:
        return f"<VirtualDrive {self.name}: {self.state}>"


def results_of(world: World) -> list[tuple[ExpectationResult, str]]:
    """Ends the checks of a world; returns the results with their texts."""
    return read_results(world._world.finish_expectations())


def _messages(found: Sequence[Mapping[str, Any]]) -> tuple[DriveMessage, ...]:
    return tuple(DriveMessage._of(message) for message in found)


__all__ = ["Plant", "PlantDrive", "Served", "ServedDrive", "SimulatedDrive", "VirtualDrive", "World"]
