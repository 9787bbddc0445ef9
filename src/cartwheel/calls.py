"""Functions that one thread runs for another thread."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from typing import TypeVar

S = TypeVar("S")
T = TypeVar("T")
Post = Callable[[Callable[[], None]], None]
"""Queues a function for the thread that runs it."""


def answered(post: Post, function: Callable[[], T]) -> Future[T]:
    """Queues a function and returns a future for its result or error.

    The caller can cancel the future as long as the function has not started.
    """
    future: Future[T] = Future()

    def run() -> None:
        if not future.set_running_or_notify_cancel():
            return
        try:
            future.set_result(function())
        except BaseException as error:
            future.set_exception(error)
            if not isinstance(error, Exception):
                raise

    post(run)
    return future


def mapped(future: Future[S], function: Callable[[S], T]) -> Future[T]:
    """A future for the result of a function applied to another future's result, or for an error."""
    made: Future[T] = Future()

    def take(done: Future[S]) -> None:
        if not made.set_running_or_notify_cancel():
            return
        try:
            made.set_result(function(done.result()))
        except Exception as error:  # noqa: BLE001 - it is the caller's to handle
            made.set_exception(error)

    future.add_done_callback(take)
    return made


def raise_exit(error: BaseException) -> None:
    """Raises the SystemExit of a signal handler again; does nothing for other errors.

    ``sys.exit`` in a plugin is an error of the plugin. A signal handler that calls it may interrupt
    the code of any plugin, and must end the program.
    """
    if not isinstance(error, SystemExit):
        return
    import signal

    handlers = [signal.getsignal(number) for number in signal.valid_signals()]
    functions = [getattr(each, "func", each) for each in handlers]  # of `functools.partial`
    codes = {getattr(each, "__code__", None) for each in functions} - {None}
    trace = error.__traceback__
    while trace is not None:
        if trace.tb_frame.f_code in codes:
            raise error
        trace = trace.tb_next
