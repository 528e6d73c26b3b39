"""Captures, decoded."""

from __future__ import annotations

import io
import os
import threading
from pathlib import Path

import pytest

from profidrive import Decoded, Plant, decode
from profidrive.errors import LocalError, UsageError
from profidrive.frames import CaptureDcp, DeviceSummary, FrameNode, Unanswered, Weight

CAPTURES = Path(__file__).parents[2] / "captures"
FULL = CAPTURES / "pnio-profinetpy-full.pcapng"


@pytest.fixture(scope="module")
def loss(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The frames of a press whose cable is pulled."""
    file = tmp_path_factory.mktemp("loss") / "loss.pcapng"
    world = Plant.from_file(CAPTURES.parent / "examples" / "plants" / "press.toml").start(capture=file)
    world.run(for_="1s")
    world["press-1"].inject("cable=pulled", for_="400ms")
    world.run(for_="2s")
    world.finish_capture()
    return file


def nodes(tree: FrameNode) -> list[FrameNode]:
    return [tree, *(node for child in tree.children for node in nodes(child))]


def lines(decoded: Decoded) -> list[str]:
    return [repr(pdu) for pdu in decoded]


@pytest.mark.parametrize("file", sorted(CAPTURES.glob("*.pcapng")), ids=lambda file: file.stem)
def test_every_capture_is_explained_with_its_fields(file: Path) -> None:
    decoded = decode(file)
    topics = set()
    for pdu in decoded:
        topics.add(pdu.event.topic)
        if pdu.tree is not None:
            assert all(node.start <= node.end <= pdu.tree.end for node in nodes(pdu.tree))
    assert len(topics) > 2
    assert decoded.counts["frames"] > 0
    assert decoded.counts["malformed"] == 0


def test_numbers_are_no_texts() -> None:
    names = [pdu.event.data for pdu in decode(FULL) if isinstance(pdu.event.data, CaptureDcp)]
    assert any(name.response and name.vendor for name in names)
    assert next(decode(FULL)).event.weight is Weight.NORMAL


def test_file_octets_and_stream_are_the_same(loss: Path) -> None:
    whole = lines(decode(loss))
    assert len(whole) > 10
    assert lines(decode(loss.read_bytes())) == whole
    with loss.open("rb") as stream:
        assert lines(decode(stream)) == whole
    reads, writes = os.pipe()

    def write() -> None:
        with open(writes, "wb") as pipe:
            pipe.write(loss.read_bytes())

    thread = threading.Thread(target=write, daemon=True)
    thread.start()
    with open(reads, "rb") as pipe:
        assert lines(decode(pipe)) == whole
    thread.join(30)
    assert not thread.is_alive()


def test_the_wanted_part_is_shown(loss: Path) -> None:
    trouble = list(decode(loss, only="trouble"))
    assert trouble
    assert all(pdu.event.weight is not Weight.NORMAL or pdu.event.kind == "trouble" for pdu in trouble)
    of_feeder = decode(loss, drive="feeder-1")
    assert all("press-1" not in (pdu.source, pdu.event.to) for pdu in of_feeder)
    [device] = of_feeder.summary()
    assert isinstance(device, DeviceSummary)
    assert device.streams[0].frames > 100
    early = list(decode(loss, until="500ms"))
    assert 0 < early[-1].time <= 0.5
    assert next(decode(loss, since="500ms")).time >= 0.5


def test_damage_is_raised_after_what_is_before_it(loss: Path) -> None:
    cut = decode(loss.read_bytes()[:-50])
    seen = []
    with pytest.raises(LocalError, match="ends in the middle"):
        for pdu in cut:
            seen.append(pdu)
    assert seen
    assert list(cut) == []
    for source in (b"", b"nothing", loss.with_name("none")):
        with pytest.raises(LocalError):
            decode(source)
    with pytest.raises(UsageError, match="model"):
        decode(loss, model="x")


def test_an_error_of_a_stream_is_raised() -> None:
    class Broken(io.RawIOBase):
        def read(self, size: int = -1) -> bytes:
            raise KeyError("broken")

    with pytest.raises(KeyError, match="broken"):
        decode(Broken())  # type: ignore[arg-type]


def test_what_did_not_come_has_no_frame() -> None:
    request = bytes.fromhex("020000000002 020000000001 8892 fefd 03 00 00000007 0000 0002 0202").ljust(60, b"\0")
    unanswered = list(decode(pcap(request, *9 * [bytes(60)])))
    assert [pdu.tree is None for pdu in unanswered] == [False, True]
    assert isinstance(unanswered[-1].event.data, Unanswered)


def pcap(*frames: bytes) -> bytes:
    """A capture with these frames, a second between them."""
    head = bytes.fromhex("d4c3b2a1 0200 0400 00000000 00000000 00000400 01000000")
    octets = head
    for place, frame in enumerate(frames):
        for number in (place, 0, len(frame), len(frame)):
            octets += number.to_bytes(4, "little")
        octets += frame
    return octets
