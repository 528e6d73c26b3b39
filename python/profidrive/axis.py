"""An axis under control: the only thing here that moves anything."""

from __future__ import annotations

import json
import warnings
from types import TracebackType
from typing import NamedTuple

from profidrive import _profidrive
from profidrive._values import optional_span, span, value_text
from profidrive.errors import MisuseError, ProfidriveError
from profidrive.reports import AxisState, MotionReport
from profidrive.types import Duration, State, Value
from profidrive.words import Zsw1


class CycleStats(NamedTuple):
    """Frames of a connection."""

    received: int
    missed: int
    """Lost between them, by their counter."""


class Axis:
    """An axis under control, in a `with` block of `Drive.control`.

    Motions wait until they have ended, and leave the axis holding, or at rest where they fail. The first one enables it. A motion
    that a limit forbids raises `SafetyError`, and the axis goes on as before. An axis that stopped by itself, by the end of its
    lease for example, is not started again: the next call raises why.

    Ctrl-C stops the axis along its ramp; again, at least a second later, by quick stop (OFF3); a third time ends the wait.

    Raises:
        AxisFault: when the drive reports a fault.
        NotReached: when a target or a speed is not reached in time.
        ConnectionLost: when the connection is lost. The axis cannot be used again, the drive can.
        InterruptedCall: when another thread stops it.
    """

    __slots__ = ("_axis", "_drive")

    def __init__(self, axis: _profidrive.Axis, drive: str) -> None:
        self._axis = axis
        self._drive = drive

    def run(self, speed: Value, *, for_: Duration | None = None) -> MotionReport:
        """Turns at a speed. Returns at that speed and leaves it turning; with `for_` it keeps the speed for that time and halts."""
        return _motion(self._axis.run(value_text(speed), optional_span(for_)))

    def jog(self, speed: Value | None = None, *, for_: Duration) -> MotionReport:
        """Jogs for a time and halts: at a speed (real-time jogging, position mode), or at the jog speed 1 of the drive."""
        return _motion(self._axis.jog(None if speed is None else value_text(speed), span(for_)))

    def move_to(
        self,
        position: Value,
        *,
        speed: Value,
        acceleration: Value | None = None,
        deceleration: Value | None = None,
        wait: bool = True,
        timeout: Duration | None = None,
    ) -> MotionReport:
        """Goes to a position, such as `10rev`, and holds there. Without `wait` it returns once the drive has accepted the move.

        Ramps are those of the drive where none are given. Without a timeout it may take some multiple of its computed time.
        """
        return self._go(position, False, speed, acceleration, deceleration, wait, timeout)

    def move_by(
        self,
        distance: Value,
        *,
        speed: Value,
        acceleration: Value | None = None,
        deceleration: Value | None = None,
        wait: bool = True,
        timeout: Duration | None = None,
    ) -> MotionReport:
        """Goes by a distance; see `move_to`."""
        return self._go(distance, True, speed, acceleration, deceleration, wait, timeout)

    def _go(
        self,
        target: Value,
        is_distance: bool,
        speed: Value,
        acceleration: Value | None,
        deceleration: Value | None,
        wait: bool,
        timeout: Duration | None,
    ) -> MotionReport:
        ramps = [None if ramp is None else value_text(ramp) for ramp in (acceleration, deceleration)]
        moved = self._axis.move_to(
            value_text(target), is_distance, value_text(speed), ramps[0], ramps[1], wait, optional_span(timeout)
        )
        return _motion(moved)

    def home(self, *, timeout: Duration = 60.0) -> MotionReport:
        """Sets the home position by the homing procedure of the drive."""
        return _motion(self._axis.home(span(timeout)))

    def task(self, number: int, *, wait: bool = True, timeout: Duration = 60.0) -> MotionReport:
        """Carries out a motion task of the drive, or the chain that begins with it.

        Without `wait` it returns once the drive has accepted it.
        """
        return _motion(self._axis.task(number, wait, span(timeout)))

    def stop(self, *, quick: bool = False, timeout: Duration | None = None) -> MotionReport:
        """Stops along the ramp (OFF1) or by quick stop (OFF3), ends operation and keeps control. Returns at standstill.

        Any thread may call it while another one waits for a motion, which raises `InterruptedCall` then.

        Raises:
            NotReached: when it is not at rest after `timeout`; it goes on stopping.
        """
        return _motion(self._axis.stop(quick, optional_span(timeout)))

    def ack(self) -> None:
        """Acknowledges faults by an edge of STW1 bit 7."""
        self._axis.ack()

    def keep_alive(self) -> None:
        """Renews the lease, as every other call that waits does."""
        self._axis.keep_alive()

    @property
    def status(self) -> AxisState:
        """What the last frame reported: words, speed, position. Without any I/O, from any thread."""
        document = self._axis.status()
        if document is None:
            raise MisuseError("the axis was released", drive=self._drive)
        return AxisState._of(json.loads(document))

    @property
    def state(self) -> State | None:
        """State of the general state machine."""
        state = self.status.state
        return None if state is None else State[state.value]

    @property
    def zsw1(self) -> Zsw1 | None:
        """Status word of the last frame, in the bits of the profile that the drive is set to; None before the first one."""
        word = self.status.zsw1
        return None if word is None else Zsw1(word.number)

    @property
    def speed(self) -> float | None:
        """Speed of the motor, rpm; None where the telegram does not carry it."""
        speed = self.status.speed_actual
        return None if speed is None else speed.value

    @property
    def position(self) -> float | None:
        """Position in revolutions; None where the telegram does not carry it."""
        position = self.status.position
        return None if position is None else position.value

    @property
    def stats(self) -> CycleStats | None:
        """Frames of the connection; None on a serial line, and while another thread waits for a motion."""
        frames = self._axis.frames()
        return None if frames is None else CycleStats(*frames)

    def __repr__(self) -> str:
        return f"<Axis of {self._drive}>"

    def __del__(self) -> None:
        # it cannot be reached any more: the network brings it to rest
        axis = getattr(self, "_axis", None)
        if axis is not None and axis.abandon():
            warnings.warn(
                f"{self!r} was under control and is stopped: use a with block", ResourceWarning, stacklevel=2, source=self
            )


def _motion(document: str) -> MotionReport:
    return MotionReport._of(json.loads(document))


class Control:
    """Takes control of an axis in a `with` block. However the block ends, the axis is ramped down and released."""

    __slots__ = ("_arguments", "_axis", "_network")

    def __init__(
        self,
        network: _profidrive.Network,
        drive: str,
        max_speed: str,
        mode: str | None,
        telegram: int | None,
        cycle: float | str | None,
        lease: float | str,
        set_mode: bool,
        accept_no_timeout: bool,
    ) -> None:
        self._network = network
        self._arguments = (drive, max_speed, mode, telegram, cycle, lease, set_mode, accept_no_timeout)
        self._axis: Axis | None = None

    def __enter__(self) -> Axis:
        if self._axis is not None:
            raise MisuseError("control is for one block", drive=self._arguments[0])
        self._axis = Axis(self._network.control(*self._arguments), self._arguments[0])
        return self._axis

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        axis = self._axis
        if axis is None or not axis._axis.is_held:
            return
        try:
            axis._axis.release(isinstance(error, KeyboardInterrupt))
        except ProfidriveError as unreleased:
            if error is None:
                raise
            # what ended the block is the cause; this comes on top of it
            if hasattr(error, "add_note") and type(unreleased) is not type(error):
                error.add_note(f"then: {unreleased}")


__all__ = ["Axis", "Control", "CycleStats"]
