"""Captures: what happened on a network, frame by frame."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator, Mapping
from typing import BinaryIO, Literal

from profidrive import _profidrive
from profidrive._values import optional_span
from profidrive.frames import CaptureEvent, DeviceSummary, FrameNode
from profidrive.types import Duration, Path


class Pdu:
    """A decoded frame: its event in words and numbers, and its fields."""

    __slots__ = ("_capture", "_octets", "event")

    def __init__(self, event: CaptureEvent, octets: bytes | None, capture: _profidrive.Capture) -> None:
        self.event = event
        """All of it: sender and receiver, weight, and `data` with the numbers."""
        self._octets = octets
        self._capture = capture

    @property
    def frame(self) -> int:
        """Number of the frame in the capture, from 1."""
        return self.event.frame

    @property
    def time(self) -> float:
        """Seconds since the first frame."""
        return self.event.time

    @property
    def source(self) -> str:
        """Name or address of the sender."""
        return self.event.from_

    @property
    def summary(self) -> str:
        """What happened, in words."""
        return self.event.text

    @property
    def tree(self) -> FrameNode | None:
        """The fields of the frame with their octets, named by what the capture has shown until this is called. None for what is
        reported when a time is over or the capture ends, such as an answer that did not come."""
        return None if self._octets is None else FrameNode._of(json.loads(self._capture.tree(self._octets)))

    def __repr__(self) -> str:
        return f"<Pdu {self.frame} {self.time:.6f} {self.source}: {self.summary}>"


class Decoded(Iterator[Pdu]):
    """What happened in a capture, in its order. It is read while this is iterated, and no frame is kept.

    Raises:
        LocalError: where the capture is damaged, after everything that is before.
    """

    __slots__ = ("_capture",)

    def __init__(self, capture: _profidrive.Capture) -> None:
        self._capture = capture

    def __next__(self) -> Pdu:
        found = self._capture.next()
        if found is None:
            raise StopIteration
        event, octets = found
        return Pdu(CaptureEvent._of(json.loads(event)), octets, self._capture)

    def summary(self) -> tuple[DeviceSummary, ...]:
        """Returns the devices with cyclic connections until now: restarts, alarms, faults, and how regular their frames are."""
        return tuple(DeviceSummary._of(device) for device in json.loads(self._capture.summary())["devices"])

    @property
    def counts(self) -> Mapping[str, int]:
        """Frames until now: all of them, `cyclic`, `dcp`, `rpc`, `alarms`, and those that are `malformed`."""
        counts: dict[str, int] = json.loads(self._capture.summary())["counts"]
        return counts


def decode(
    source: Path | bytes | BinaryIO,
    *,
    drive: str | None = None,
    only: Literal["all", "trouble"] = "all",
    since: Duration | None = None,
    until: Duration | None = None,
    model: str | None = None,
) -> Decoded:
    """Explains the frames of a capture (pcap, pcapng).

    Args:
        source: a file, its octets, or an open binary file, such as the output of a program that captures.
        drive: only what is from, to or about this station: its name, IP address or MAC address. In a stream a name is known once a
            frame has shown it.
        only: `"trouble"` for what points to a fault.
        since: leaves out what is before this time from the first frame.
        until: ends at this time.
        model: how drives are decoded whose identity is not in the capture, such as `vlt`; as `akd` where it is None.

    Raises:
        LocalError: when the file cannot be read or is not a capture.
    """
    origin = source if isinstance(source, bytes) or hasattr(source, "read") else os.fspath(source)
    return Decoded(_profidrive.Capture(origin, drive, only == "trouble", optional_span(since), optional_span(until), model))


__all__ = ["Decoded", "Pdu", "decode"]
