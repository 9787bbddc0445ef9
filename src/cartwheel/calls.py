"""Functions that one thread runs for another."""

from __future__ import annotations

from collections.abc import Callable
from concurrent.futures import Future
from typing import TypeVar

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
