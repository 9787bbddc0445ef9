"""Responses to clients while a program does not run its simulation."""

from __future__ import annotations

import threading

from cartwheel.assembly.turns import Turns
from cartwheel.simulation.run_state import Run

_LOOK = 0.1
"""Interval in s at which `close` is checked while another thread uses the simulation."""


class Attendant:
    """A thread that serves the functions of `Run.post_read` between two runs.

    Args:
        simulation: The simulation.
        turns: Held while a thread uses the simulation.
    """

    def __init__(self, simulation: Run, turns: Turns) -> None:
        self._simulation = simulation
        self._turns = turns
        self._due = threading.Event()
        self._closed = False
        self._thread = threading.Thread(target=self._serve, name="attendant", daemon=True)
        self._thread.start()
        simulation.attendant = self._due.set

    def close(self) -> None:
        """Ends the thread."""
        self._simulation.attendant = None
        self._closed = True
        self._due.set()
        self._thread.join()

    def _serve(self) -> None:
        while True:
            self._due.wait()
            self._due.clear()
            while not self._turns.acquire_within(_LOOK):
                if self._closed:
                    return
            try:
                if self._closed or self._simulation.closed:
                    return
                self._simulation.serve_reads()
            finally:
                self._turns.release()
