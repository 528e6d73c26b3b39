"""A station that lies: it answers a search with hostile texts, and each call of its records with something else.

Arguments: interface, IP address, name of the station, type of the station. Prints a line for each call.
"""

import random
import socket
import struct
import sys

interface, address, name, kind = sys.argv[1:5]
PROFINET, IPV4, ARP = 0x8892, 0x0800, 0x0806
MAC = bytes.fromhex("020066000001")
IP = socket.inet_aton(address)
# a drive that the server would know and read: vendor and device of an AKD
VENDOR, DEVICE = 0x0105, 0x0001
seed = random.Random(7)


def block(option: int, suboption: int, data: bytes) -> bytes:
    content = b"\0\0" + data
    return struct.pack(">BBH", option, suboption, len(content)) + content + b"\0" * (len(content) % 2)


def identified(transaction: bytes) -> bytes:
    blocks = b"".join(
        (
            block(2, 1, kind.encode()),
            block(2, 2, name.encode()),
            block(2, 3, struct.pack(">HH", VENDOR, DEVICE)),
            block(2, 4, b"\1\0"),
            block(1, 2, IP + socket.inet_aton("255.255.255.0") + IP),
        )
    )
    return struct.pack(">HBB", 0xFEFF, 5, 1) + transaction + struct.pack(">HH", 0, len(blocks)) + blocks


def packet(to: bytes, source: int, target: int, data: bytes) -> bytes:
    head = struct.pack(">BBHHHBBH", 0x45, 0, 28 + len(data), 0, 0, 64, 17, 0) + IP + to
    total = sum(struct.unpack(">10H", head))
    total = (total & 0xFFFF) + (total >> 16)
    checksum = ~((total & 0xFFFF) + (total >> 16)) & 0xFFFF
    head = head[:10] + struct.pack(">H", checksum) + head[12:]
    return head + struct.pack(">HHHH", source, target, 8 + len(data), 0) + data


def lies(call: bytes, count: int) -> list[bytes]:
    """Returns what this call is answered with: nothing, noise, a head that fits noise, a length that does not, or far too much."""
    noise = seed.randbytes(seed.randrange(1, 1400))
    # the head of the call as that of an answer
    head = bytes((call[0], 2)) + call[2:76]
    fits = head[:74] + struct.pack("<H" if call[4] & 0x10 else ">H", len(noise)) + b"\0" * 4 + noise
    return [
        [],
        [noise],
        [head + b"\0" * 4 + noise],
        [fits],
        [fits[: seed.randrange(1, 80)]],
        [fits] * 200,
    ][count % 6]


link = socket.socket(socket.AF_PACKET, socket.SOCK_RAW, socket.htons(3))
link.bind((interface, 0))
calls = 0
while True:
    frame = link.recv(2048)
    sender, protocol, data = frame[6:12], int.from_bytes(frame[12:14], "big"), frame[14:]

    def send(to_protocol: int, content: bytes, to: bytes = sender) -> None:
        link.send((to + MAC + struct.pack(">H", to_protocol) + content).ljust(60, b"\0"))

    if sender == MAC:
        continue
    if protocol == PROFINET and data[:4] == b"\xfe\xfe\5\0":
        send(PROFINET, identified(data[4:8]))
    elif protocol == ARP and data[6:8] == b"\0\1" and data[24:28] == IP:
        send(ARP, data[:6] + b"\0\2" + MAC + IP + data[8:18])
    elif protocol == IPV4 and data[9] == 17 and data[16:20] == IP and len(data) >= 28 + 80:
        source, target = struct.unpack(">HH", data[20:24])
        for lie in lies(data[28:], calls):
            send(IPV4, packet(data[12:16], target, source, lie))
        calls += 1
        print(f"call {calls}", flush=True)
