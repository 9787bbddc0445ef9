"""Bytes between two connections, in both directions, until both have ended."""

from __future__ import annotations

import asyncio
import contextlib
import socket

CHUNK = 1 << 18
"""Bytes that are held for each direction, and no more: a slow reader holds up the sender."""
_LINGER = 10.0
"""s that one direction may go on once the other has ended."""


async def relay(one: socket.socket, other: socket.socket) -> None:
    """Copies until both directions have ended, or one breaks."""
    tasks = [asyncio.create_task(_copy(one, other)), asyncio.create_task(_copy(other, one))]
    try:
        done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
        if not any(task.exception() for task in done):
            await asyncio.wait(tasks, timeout=_LINGER)
    finally:
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)


async def _copy(source: socket.socket, target: socket.socket) -> None:
    loop = asyncio.get_running_loop()
    chunk = bytearray(CHUNK)
    view = memoryview(chunk)
    while size := await loop.sock_recv_into(source, chunk):
        await loop.sock_sendall(target, view[:size])
    with contextlib.suppress(OSError):
        target.shutdown(socket.SHUT_WR)
