"""Settings of a drive as a text."""

from __future__ import annotations

import os

from profidrive.errors import LocalError
from profidrive.types import Path


class Backup:
    """The settings of a drive: the text of a file that `profidrive restore` and `diff` take too."""

    __slots__ = ("missing", "text")

    def __init__(self, text: str, *, missing: str | None = None) -> None:
        self.text = text
        self.missing = missing
        """What the drive did not report, in words; None where nothing is missing."""

    @classmethod
    def load(cls, path: Path) -> Backup:
        """Reads a file. What is in it is checked where it is used."""
        try:
            with open(path, encoding="utf-8") as file:
                return cls(file.read())
        except (OSError, UnicodeDecodeError) as error:
            raise LocalError(f"cannot read {os.fspath(path)}: {error}") from error

    def save(self, path: Path) -> None:
        """Writes a file, which must not exist."""
        try:
            with open(path, "x", encoding="utf-8") as file:
                file.write(self.text)
        except OSError as error:
            raise LocalError(f"cannot write {os.fspath(path)}: {error}") from error

    def __str__(self) -> str:
        return self.text

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Backup) and self.text == other.text

    def __hash__(self) -> int:
        return hash(self.text)

    def __repr__(self) -> str:
        return f"<Backup of {self.text.count(chr(10))} lines>"


__all__ = ["Backup"]
