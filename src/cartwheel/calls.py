"""Functions that one thread runs for another."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from typing import TypeVar

S = TypeVar("S")
T = TypeVar("T")
Post = Callable[[Callable[[], None]], None]
"""Leaves a function with the thread that is to run it."""


def answered(post: Post, function: Callable[[], T]) -> Future[T]:
    """Has a function run, and gives its result or its error as soon as it is there.

    A caller that loses patience may cancel it: it is then not run, unless it has begun.
    """
    future: Future[T] = Future()

    def run() -> None:
        if not future.set_running_or_notify_cancel():
            return
        try:
            future.set_result(function())
        except Exception as error:  # noqa: BLE001 - it is the caller's to handle
            future.set_exception(error)

    post(run)
    return future


def mapped(future: Future[S], function: Callable[[S], T]) -> Future[T]:
    """What a function makes of another future's result, or that one's error or its own."""
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
