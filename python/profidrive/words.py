# Generated from data/profile/words.csv by `cargo run -p xtask -- gen`. Do not edit.
"""Control and status words of PROFIdrive as flags."""

from __future__ import annotations

from enum import IntFlag


class Stw1(IntFlag):
    """Control word 1: what a controller commands. `NO_` is of a bit whose 1 is the quiet state."""

    ON = 0x0001
    """Bit 0: ON."""
    NO_OFF2 = 0x0002
    """Bit 1: OFF2 not active."""
    NO_OFF3 = 0x0004
    """Bit 2: OFF3 not active."""
    EN_OP = 0x0008
    """Bit 3: operation enabled."""
    EN_RAMP = 0x0010
    """Bit 4: ramp generator enabled."""
    NO_REJECT = 0x0010
    """Bit 4: traversing task not rejected."""
    UNFREEZE = 0x0020
    """Bit 5: ramp generator runs."""
    NO_INT_STOP = 0x0020
    """Bit 5: no intermediate stop."""
    EN_SETPOINT = 0x0040
    """Bit 6: setpoint enabled."""
    START_TASK = 0x0040
    """Bit 6: activate traversing task (the 0 to 1 edge counts)."""
    ACK = 0x0080
    """Bit 7: acknowledge fault (the 0 to 1 edge counts)."""
    JOG1 = 0x0100
    """Bit 8: jog 1."""
    JOG2 = 0x0200
    """Bit 9: jog 2."""
    CTRL_PLC = 0x0400
    """Bit 10: control by PLC: process data valid."""
    HOMING = 0x0800
    """Bit 11: start homing."""
    RT_JOG = 0x1000
    """Bit 12: real-time jogging with the MDI values (AKD)."""
    RT_JOG_CCW = 0x2000
    """Bit 13: real-time jogging counter-clockwise (AKD)."""
    BIT14 = 0x4000
    """Bit 14: device specific."""
    BIT15 = 0x8000
    """Bit 15: device specific."""


class Zsw1(IntFlag):
    """Status word 1: what a drive reports. `NO_` is of a bit whose 1 is the quiet state."""

    READY_ON = 0x0001
    """Bit 0: ready for switching on."""
    READY_OP = 0x0002
    """Bit 1: ready for operation."""
    OPERATION = 0x0004
    """Bit 2: operation enabled, the drive follows the setpoint."""
    FAULT = 0x0008
    """Bit 3: fault present."""
    NO_OFF2 = 0x0010
    """Bit 4: OFF2 not active."""
    NO_OFF3 = 0x0020
    """Bit 5: OFF3 not active."""
    INHIBIT = 0x0040
    """Bit 6: switching on inhibited: OFF first, then ON."""
    WARNING = 0x0080
    """Bit 7: warning present."""
    IN_TOLERANCE = 0x0100
    """Bit 8: speed error within tolerance."""
    CTRL_REQ = 0x0200
    """Bit 9: control requested from the PLC."""
    REACHED = 0x0400
    """Bit 10: comparison speed reached."""
    HOMED = 0x0800
    """Bit 11: home position set."""
    TASK_ACK = 0x1000
    """Bit 12: traversing task acknowledged."""
    STOPPED = 0x2000
    """Bit 13: axis stands still."""
    TASK_ACTIVE = 0x4000
    """Bit 14: motion task active (AKD)."""
    BIT15 = 0x8000
    """Bit 15: device specific."""


__all__ = ["Stw1", "Zsw1"]
