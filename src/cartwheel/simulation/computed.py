"""What the engine's data contain of its current state: poses, velocities, contacts and forces."""

from __future__ import annotations

from typing import Any

import mujoco
import numpy as np

from cartwheel.geometry import Array
from cartwheel.simulation.dynamics.stepping import Stepping

_STATE = int(mujoco.mjtState.mjSTATE_INTEGRATION)


class Computed:
    """The part of the engine that computes results of the current state, each once for a state."""

    def __init__(self) -> None:
        self.model: Any = None
        self.data: Any = None
        self.stepping: Stepping
        self.carries = False
        """Whether bodies that touch turn together; see `Carried`."""
        self.serving = False
        """Whether tasks run that read a forward pass, which the next step uses."""
        self.changes = 0
        """Changes of the model and of forces outside of the state."""
        self.refreshed = b""
        """The state whose contacts and forces are in the data; empty after a step."""
        self._posed = self._located = b""
        """The states whose poses, and whose poses and velocities, are in the data."""
        self._state: Array

    def _bind(self, stepping: Stepping) -> None:
        """Continues with a new model and data, whose steps `stepping` makes."""
        self.stepping = stepping
        self._state = np.empty(mujoco.mj_stateSize(self.model, _STATE))
        self._posed = self._located = self.refreshed = b""

    def note_change(self) -> None:
        """Makes the next `refresh` compute a forward pass, after a change of the model.

        While tasks read the forward pass of a step, it is computed at once.
        """
        self.changes += 1
        if self.serving:
            self.forward()

    def refresh(self) -> None:
        """As `forward`, but only if the state differs from that of the last call.

        Neither the state nor any later state depends on it.

        Raises:
            SimulationError: There is not enough memory for the contacts.
        """
        if self.serving:
            return
        state = self.signature()
        if state != self.refreshed:
            self.forward()
            self._posed = self._located = self.refreshed = state

    def signature(self) -> bytes:
        """Differs for any two states with different poses, contacts or forces."""
        mujoco.mj_getState(self.model, self.data, self._state, _STATE)
        return self._state.tobytes() + self.changes.to_bytes(8)

    def forward(self, data: Any = None) -> None:
        """Computes poses, contacts and forces for the current state, which does not change.

        Args:
            data: A copy of the data with the state; None for the data itself.

        Raises:
            SimulationError: There is not enough memory for the contacts.
        """
        if data is None:
            data = self.data
            self._posed = self._located = self.refreshed = b""
        self.stepping.forward(data, carries=self.carries)

    def refresh_poses(self) -> None:
        """Computes poses, but only if the state differs from that of the last call."""
        if self.serving:
            return
        state = self.signature()
        if state != self._posed:
            mujoco.mj_kinematics(self.model, self.data)
            self._posed, self._located, self.refreshed = state, b"", b""

    def refresh_motion(self) -> None:
        """As `locate`, but only if the state differs from that of the last call."""
        if self.serving:
            return
        state = self.signature()
        if state != self._located:
            self.locate(poses=state != self._posed)
            self._posed, self._located, self.refreshed = state, state, b""

    def keep(self) -> None:
        """Lets the next step and `refresh` use the forward pass that was just made, unless the
        state changes before.
        """
        self._posed = self._located = self.refreshed = self.signature()

    def is_refreshed(self) -> bool:
        """Whether the results of the last forward pass are those of the current state."""
        return bool(self.refreshed) and self.refreshed == self.signature()

    def locate(self, *, poses: bool = True) -> None:
        """Computes only poses and velocities for the current state.

        Args:
            poses: False if the poses have been computed.
        """
        if poses:
            mujoco.mj_kinematics(self.model, self.data)
        mujoco.mj_comPos(self.model, self.data)
        mujoco.mj_comVel(self.model, self.data)
        if self.stepping.moved is not None:
            self.stepping.moved.set_velocities(self.data)
