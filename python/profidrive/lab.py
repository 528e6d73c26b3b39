"""A laboratory on one computer: a network of its own with a cable between two interfaces, without root.

`python -m profidrive.lab -- pytest` runs a command in there. Virtual drives are put on `dev0`, with addresses 192.168.77.x/24;
a client uses `ctl0`, which has the address 192.168.77.11/24. When the command ends, the network is gone.
"""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Sequence
from functools import cache
from threading import Timer
from types import TracebackType

from profidrive.errors import UnsupportedError

CLIENT = "ctl0"
"""The interface for a client."""
DRIVES = "dev0"
"""The interface for virtual drives."""

_LIMIT = 20.0
"""Seconds that each step of its begin and its end may take."""

_SET_UP = """set -e
for where in all default; do
    (echo 1 > /proc/sys/net/ipv6/conf/$where/disable_ipv6) 2>/dev/null || true
done
ip link set lo up
ip link add name ctl0 address 02:50:4e:00:00:02 type veth peer name dev0 address 02:50:4e:00:00:01
ip addr add 192.168.77.11/24 dev ctl0
ip link set ctl0 up
ip link set dev0 up
"""


@cache
def _ways() -> tuple[list[str], list[str]]:
    """How to make namespaces and how to enter them: with those of a user, else as root."""
    complaint = b""
    for user, enters in ((["--user", "--map-root-user"], ["--user", "--preserve-credentials"]), ([], [])):
        unshare = ["unshare", *user, "--net"]
        try:
            tried = subprocess.run([*unshare, "true"], capture_output=True, check=False, timeout=_LIMIT)
        except FileNotFoundError as error:
            raise UnsupportedError("a laboratory needs the programs unshare, nsenter and ip (util-linux, iproute2)") from error
        if tried.returncode == 0:
            return unshare, ["nsenter", *enters, "--net"]
        complaint = complaint or tried.stderr
    raise UnsupportedError(f"this system permits no network namespaces: {complaint.decode(errors='replace').strip()}")


class Lab:
    """A network that lives as long as the `with` block. Programs run in it by their command lines."""

    def __init__(self) -> None:
        self._first: subprocess.Popen[str] | None = None

    def __enter__(self) -> Lab:
        unshare, _ = _ways()
        script = f"{_SET_UP}echo ready\nexec cat"
        self._first = subprocess.Popen([*unshare, "sh", "-c", script], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        assert self._first.stdout is not None
        # its end ends the wait for its line
        limit = Timer(_LIMIT, self._first.kill)
        limit.daemon = True
        limit.start()
        line = self._first.stdout.readline()
        limit.cancel()
        if line != "ready\n":
            self.__exit__(None, None, None)
            raise UnsupportedError("this system permits no pair of network interfaces (veth)")
        return self

    def command(self, command: Sequence[str]) -> list[str]:
        """Returns the command line that runs a command in there. The program itself is the process that is started."""
        assert self._first is not None, "in a with block"
        _, nsenter = _ways()
        return [*nsenter, "--target", str(self._first.pid), "--", *command]

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        assert self._first is not None
        try:
            self._first.communicate(timeout=_LIMIT)
        except subprocess.TimeoutExpired:
            # a copy of this process (fork) has the other end of its input
            self._first.kill()
            self._first.communicate()


def main() -> None:
    command = sys.argv[1:]
    if command[:1] == ["--"]:
        del command[0]
    if not command:
        sys.exit("usage: python -m profidrive.lab -- COMMAND [ARGUMENT ..]")
    unshare, _ = _ways()
    os.execvp(unshare[0], [*unshare, "sh", "-c", f'{_SET_UP}exec "$@"', "sh", *command])


if __name__ == "__main__":
    main()

__all__ = ["CLIENT", "DRIVES", "Lab"]
