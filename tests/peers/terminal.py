"""Runs a program in a pseudo terminal of 100 columns and 30 rows, sends keys once a text is on the screen, and reports what it left.

terminal.py TEXT KEYS PROGRAM ARGUMENT ..

Prints a JSON document: the exit code, the text written after the alternate screen was left, and whether the settings of the terminal
are those from before.
"""

import fcntl
import json
import os
import pty
import select
import struct
import sys
import termios

text, keys, program = sys.argv[1].encode(), sys.argv[2].encode().decode("unicode_escape").encode(), sys.argv[3:]
master, slave = pty.openpty()
fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", 30, 100, 0, 0))
before = termios.tcgetattr(slave)
child = os.fork()
if child == 0:
    os.close(master)
    os.setsid()
    fcntl.ioctl(slave, termios.TIOCSCTTY, 0)
    for descriptor in range(3):
        os.dup2(slave, descriptor)
    os.environ["TERM"] = "xterm"
    os.execv(program[0], program)

screen = b""
sent = False
status = None
while True:
    ready, _, _ = select.select([master], [], [], 0.2)
    if ready:
        screen += os.read(master, 65536)
    elif status is not None:
        break
    if not sent and text in screen:
        os.write(master, keys)
        sent = True
    if status is None:
        done, ended = os.waitpid(child, os.WNOHANG)
        status = ended if done else None
code = os.waitstatus_to_exitcode(status)
left = screen.rpartition(b"\x1b[?1049l")
print(json.dumps({
    "code": code,
    "sent": sent,
    "left": bool(left[1]),
    "rest": left[2].decode(errors="replace"),
    "restored": termios.tcgetattr(slave) == before,
}))
