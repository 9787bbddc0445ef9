"""Random numbers for noise, which depend only on the seed, the time and their purpose."""

from __future__ import annotations

import zlib
from typing import Any

import numpy as np


class RandomNumbers:
    """Counter-based generators: the seed and the purpose are the key, and time is the counter.

    Other random numbers have no effect on them, and neither have subscribers, other worlds or
    processes.

    Args:
        owner: The name of the model that draws them.
    """

    def __init__(self, owner: str) -> None:
        self._owner = zlib.crc32(owner.encode())
        self._seed: int | None = None
        self._seed_word = 0
        self._made: dict[str, tuple[np.random.Philox, np.random.Generator, Any]] = {}

    def at(self, purpose: str, *, seed: int, time_ns: int) -> np.random.Generator:
        """The generator of a purpose, set to a time. It is valid until the next call.

        Args:
            purpose: Names what the numbers are for.
            seed: The seed of all noise.
            time_ns: Simulation time, ns.
        """
        found = self._made.get(purpose)
        if found is None or seed != self._seed:
            found = self._made[purpose] = self._make(purpose, seed)
        source, generator, state = found
        state["state"]["counter"][2] = time_ns
        source.state = state
        return generator

    def stream(self, purpose: str, *, seed: int, time_ns: int) -> np.random.Generator:
        """A generator of its own, which continues independently of all others; see `at`."""
        source, generator, state = self._make(purpose, seed)
        state["state"]["counter"][2:] = (time_ns, 1)
        source.state = state
        return generator

    def _make(self, purpose: str, seed: int) -> tuple[np.random.Philox, np.random.Generator, Any]:
        if seed != self._seed:
            self._made.clear()
            self._seed = seed
            # Seeds may be larger than a word.
            self._seed_word = int(np.random.SeedSequence(seed).generate_state(1, np.uint64)[0])
        source = np.random.Philox(key=0)
        state: Any = dict(source.state)
        state["state"]["key"][:] = (
            self._seed_word,
            (self._owner << 32) | zlib.crc32(purpose.encode()),
        )
        return source, np.random.Generator(source), state
