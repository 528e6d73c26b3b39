"""How a call waits: in the thread that makes it, or in one beside an event loop."""

from __future__ import annotations

import os
from _thread import allocate_lock, start_new_thread
from collections.abc import Callable, Iterable, Sequence
from queue import SimpleQueue
from typing import TYPE_CHECKING, Any, Generic, ParamSpec, TypeVar

from profidrive.errors import PartialWrite, RefusedError, SafetyError, UsageError

if TYPE_CHECKING:
    import asyncio

P = ParamSpec("P")
T = TypeVar("T")
Parts = Callable[[T], Iterable[tuple[str, object]]]
"""The drives of a result, each with its error."""

_KEPT = 64
"""Threads that are kept for later calls."""
_IDLE: list[SimpleQueue[_Begun[Any]]] = []
"""Where those that wait for work get it."""
# a copy of the process has no threads
os.register_at_fork(after_in_child=_IDLE.clear)


class synchronous:
    """The caller waits."""

    @staticmethod
    def call(function: Callable[P, T], /, *arguments: P.args, **named: P.kwargs) -> T:
        """Carries out a call."""
        return function(*arguments, **named)

    @staticmethod
    def change(
        drive: str, what: Sequence[str], parts: Parts[T], function: Callable[P, T], /, *arguments: P.args, **named: P.kwargs
    ) -> T:
        """Carries out a call that changes this of a drive."""
        del drive, what, parts
        return function(*arguments, **named)

    @staticmethod
    def motion(drive: str, interrupt: Callable[[], None], function: Callable[P, T], /, *arguments: P.args, **named: P.kwargs) -> T:
        """Carries out a motion, which `interrupt` ends."""
        del drive, interrupt
        return function(*arguments, **named)

    @staticmethod
    def lasting(function: Callable[P, T], /, *arguments: P.args, **named: P.kwargs) -> T:
        """Carries out a call that is never given up, such as a stop."""
        return function(*arguments, **named)


class asynchronous:
    """A thread waits, and an event loop goes on."""

    @staticmethod
    async def call(function: Callable[P, T], /, *arguments: P.args, **named: P.kwargs) -> T:
        """Carries out a call. Where its task is cancelled it is dropped, or goes on to its end if it was begun."""
        from asyncio import CancelledError

        begun = _Begun(function, *arguments, **named)
        try:
            return await begun.future
        except CancelledError:
            begun.give_up()
            raise

    @staticmethod
    async def change(
        drive: str, what: Sequence[str], parts: Parts[T], function: Callable[P, T], /, *arguments: P.args, **named: P.kwargs
    ) -> T:
        """Carries out a call that changes this of a drive. Where its task is cancelled notes say what became of it.

        `parts` names the drives of a result, each with its error.
        """
        from asyncio import CancelledError

        begun = _Begun(function, *arguments, **named)
        try:
            return await begun.future
        except CancelledError as cancelled:
            fates = begun.fates(drive, parts)
            if what:
                for name, fate in fates:
                    _note(cancelled, f"{name}: {', '.join(what)}: {fate}")
            raise

    @staticmethod
    async def motion(
        drive: str, interrupt: Callable[[], None], function: Callable[P, T], /, *arguments: P.args, **named: P.kwargs
    ) -> T:
        """Carries out a motion. Where its task is cancelled the motion is interrupted, and a note says so."""
        from asyncio import CancelledError

        begun = _Begun(function, *arguments, **named)
        try:
            return await begun.future
        except CancelledError as cancelled:
            if begun.give_up():
                _note(cancelled, f"{drive}: the motion was not begun")
            else:
                interrupt()
                _note(cancelled, f"{drive}: the axis is stopped along its ramp")
            raise

    @staticmethod
    async def lasting(function: Callable[P, T], /, *arguments: P.args, **named: P.kwargs) -> T:
        """Carries out a call that is never given up: a task that is cancelled meanwhile is so when the call has ended."""
        from asyncio import CancelledError, shield

        begun = _Begun(function, *arguments, **named)
        cancelled: CancelledError | None = None
        while True:
            try:
                result = await shield(begun.future)
            except CancelledError as error:
                cancelled = error
                continue
            if cancelled is not None:
                raise cancelled
            return result


def _became(error: object) -> str:
    """What became of a change that ended so."""
    if error is None:
        return "written"
    if isinstance(error, PartialWrite):
        return f"written in part: {error}"
    # each of them comes before the first value is written, or refuses the only one
    is_clear = isinstance(error, UsageError | SafetyError | RefusedError)
    return f"{'not written' if is_clear else 'in doubt'}: {error}"


def _note(error: BaseException, text: str) -> None:
    # from Python 3.11 on
    if hasattr(error, "add_note"):
        error.add_note(text)


class _Begun(Generic[T]):
    """Work in a thread that holds up neither the event loop nor the end of the program."""

    __slots__ = ("_claim", "_error", "_is_done", "_loop", "_result", "_work", "future")

    def __init__(self, function: Callable[P, T], /, *arguments: P.args, **named: P.kwargs) -> None:
        import asyncio

        self._loop = asyncio.get_running_loop()
        self._work = (function, arguments, named)
        self._claim = allocate_lock()
        self._is_done = False
        self._error: BaseException | None = None
        self._result: T | None = None
        self.future: asyncio.Future[T] = self._loop.create_future()
        try:
            inbox = _IDLE.pop()
        except IndexError:
            inbox = SimpleQueue()
            start_new_thread(_wait_for_work, (inbox,))
        inbox.put(self)

    def carry_out(self) -> T | None:
        """Does the work, in its thread, unless it was given up."""
        function, arguments, named = self._work
        try:
            if self._claim.acquire(False):
                self._result = function(*arguments, **named)
            return self._result
        except BaseException as error:
            self._error = error
            return None
        finally:
            self._is_done = True

    def announce(self, result: T | None) -> None:
        """Hands the result to the event loop."""
        try:
            self._loop.call_soon_threadsafe(self._settle, result)
        except RuntimeError:
            # the loop was closed meanwhile: no one waits any more
            return

    def _settle(self, result: T | None) -> None:
        if self.future.cancelled():
            return
        if self._error is not None:
            self.future.set_exception(self._error)
        else:
            self.future.set_result(result)  # type: ignore[arg-type]

    def give_up(self) -> bool:
        """Gives the work up; false where it was begun."""
        return self._claim.acquire(False)

    def fates(self, drive: str, parts: Parts[T]) -> list[tuple[str, str]]:
        """What became of a change whose task was cancelled, by drives."""
        if self.give_up():
            return [(drive, "not written: nothing was sent")]
        if not self._is_done:
            return [(drive, "in doubt: it goes on, and the log will have its result")]
        if self._result is None:
            return [(drive, _became(self._error))]
        return [(name, _became(error)) for name, error in parts(self._result)]


def _wait_for_work(inbox: SimpleQueue[_Begun[Any]]) -> None:
    is_kept = True
    while is_kept:
        begun = inbox.get()
        result = begun.carry_out()
        is_kept = len(_IDLE) < _KEPT
        if is_kept:
            # first: the event loop runs as soon as it has the result, and its next call is for this thread
            _IDLE.append(inbox)
        begun.announce(result)
        del begun, result
