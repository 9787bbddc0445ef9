"""Targets with a fault each, which the harness must find; only its tests run them."""

from __future__ import annotations

import ctypes
import sys
import threading

from tests.campaign.target import Target

_SEEDS = [b"good", b"also good"]


def _is_bad(data: bytes) -> bool:
    return data not in _SEEDS


def _raises(data: bytes) -> None:
    if _is_bad(data):
        raise ZeroDivisionError(data)


def _refuses(data: bytes) -> None:
    if _is_bad(data):
        raise ValueError("refused")


def _hangs(data: bytes) -> None:
    while _is_bad(data):
        pass


def _devours(data: bytes) -> None:
    if _is_bad(data):
        bytearray(1 << 30)


def _dies(data: bytes) -> None:
    if _is_bad(data):
        ctypes.string_at(0)


def _prints(data: bytes) -> None:
    if _is_bad(data):
        thread = threading.Thread(target=_raises, args=(data,))
        thread.start()
        thread.join()


def _leaves(data: bytes) -> None:
    if _is_bad(data):
        sys.exit("left")


def _target(name: str, run_one: object, *, seconds: float = 0.5) -> Target:
    return Target(
        name=f"planted-{name}",
        seeds=lambda: list(_SEEDS),
        run_one=run_one,  # type: ignore[arg-type]
        allowed=(ValueError,),
        seconds=seconds,
        memory_mb=256,
    )


TARGETS = (
    _target("exception", _raises),
    _target("none", _refuses),
    _target("time", _hangs, seconds=0.2),
    _target("memory", _devours),
    _target("death", _dies),
    _target("traceback", _prints),
    _target("exit", _leaves),
)
