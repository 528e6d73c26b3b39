"""How a call waits: in the thread that makes it, or in one beside an event loop."""

from __future__ import annotations

import os
from _thread import start_new_thread
from collections.abc import Callable
from queue import SimpleQueue
from typing import TYPE_CHECKING, ParamSpec, TypeVar

if TYPE_CHECKING:
    import asyncio

P = ParamSpec("P")
T = TypeVar("T")

_KEPT = 64
"""Threads that are kept for later calls."""
_IDLE: list[SimpleQueue[Callable[[], None]]] = []
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
    def motion(interrupt: Callable[[], None], function: Callable[P, T], /, *arguments: P.args, **named: P.kwargs) -> T:
        """Carries out a motion, which `interrupt` ends."""
        del interrupt
        return function(*arguments, **named)

    @staticmethod
    def lasting(function: Callable[P, T], /, *arguments: P.args, **named: P.kwargs) -> T:
        """Carries out a call that is never given up, such as a stop."""
        return function(*arguments, **named)


class asynchronous:
    """A thread waits, and an event loop goes on."""

    @staticmethod
    async def call(function: Callable[P, T], /, *arguments: P.args, **named: P.kwargs) -> T:
        """Carries out a call. Where its task is cancelled it goes on to its end, which no one waits for."""
        return await _begun(lambda: function(*arguments, **named))

    @staticmethod
    async def motion(interrupt: Callable[[], None], function: Callable[P, T], /, *arguments: P.args, **named: P.kwargs) -> T:
        """Carries out a motion. Where its task is cancelled the motion is interrupted."""
        from asyncio import CancelledError

        try:
            return await _begun(lambda: function(*arguments, **named))
        except CancelledError:
            interrupt()
            raise

    @staticmethod
    async def lasting(function: Callable[P, T], /, *arguments: P.args, **named: P.kwargs) -> T:
        """Carries out a call that is never given up: a task that is cancelled meanwhile is so when the call has ended."""
        from asyncio import CancelledError, shield

        begun = _begun(lambda: function(*arguments, **named))
        cancelled: CancelledError | None = None
        while True:
            try:
                result = await shield(begun)
            except CancelledError as error:
                cancelled = error
                continue
            if cancelled is not None:
                raise cancelled
            return result


def _begun(work: Callable[[], T]) -> asyncio.Future[T]:
    """Begins to work in a thread that holds up neither the event loop nor the end of the program."""
    import asyncio

    loop = asyncio.get_running_loop()
    future: asyncio.Future[T] = loop.create_future()

    def settle(result: T | None, error: BaseException | None) -> None:
        if future.cancelled():
            return
        if error is not None:
            future.set_exception(error)
        else:
            future.set_result(result)  # type: ignore[arg-type]

    def carry_out() -> None:
        result: T | None = None
        failed: BaseException | None = None
        try:
            result = work()
        except BaseException as error:
            failed = error
        try:
            loop.call_soon_threadsafe(settle, result, failed)
        except RuntimeError:
            # the loop was closed meanwhile: no one waits any more
            return

    try:
        inbox = _IDLE.pop()
    except IndexError:
        inbox = SimpleQueue()
        start_new_thread(_wait_for_work, (inbox,))
    inbox.put(carry_out)
    return future


def _wait_for_work(inbox: SimpleQueue[Callable[[], None]]) -> None:
    while True:
        inbox.get()()
        if len(_IDLE) >= _KEPT:
            return
        _IDLE.append(inbox)
