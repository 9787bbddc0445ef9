"""Forward passes and steps of a model: MuJoCo's, and what Cartwheel adds to them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mujoco

from cartwheel.simulation.dynamics.carried import Carried
from cartwheel.simulation.dynamics.followers import Followers
from cartwheel.simulation.dynamics.moved import Moved
from cartwheel.simulation.dynamics.restitution import Bounces
from cartwheel.simulation.limits import too_many_contacts
from cartwheel.world.contact import Bounce


class Stepping:
    """Computes the physics of a model.

    Args:
        model: The MuJoCo model.
        data: Its data.
        surfaces: Surfaces with restitution.
    """

    def __init__(self, model: Any, data: Any, surfaces: Sequence[Bounce]) -> None:
        self._model = model
        self._data = data
        self.bounces = Bounces(model, surfaces) if len(surfaces) > 1 else None
        carried = Carried(model)
        self.carried = carried if carried.possible else None
        followers = Followers(model)
        self.followers = followers if followers.any else None
        self.moved: Moved | None = None
        """Models that are fixed to the world and move at a velocity."""

    def forward(self, data: Any, *, carries: bool) -> None:
        """Computes poses, contacts and forces for the current state, which does not change.

        Args:
            data: The data, or a copy with the state.
            carries: Whether bodies turn together; see `Carried`.

        Raises:
            SimulationError: There is not enough memory for the contacts.
        """
        if self.followers is not None:
            self.followers.apply(data)
        try:
            mujoco.mj_forward(self._model, data)
            if carries and self.carried is not None:
                self.carried.apply(self._model, data)
            if self.moved is not None:
                self.moved.apply(self._model, data)
        except mujoco.FatalError as error:
            raise too_many_contacts(data.ncon, error) from None

    def run(self, count: int, forwarded: bool, carries: bool) -> None:
        """Runs steps. The results are the same bits with and without `forwarded`.

        Args:
            count: At least 1.
            forwarded: Whether the forward pass of the current state is done, so that the first step
                only integrates.
            carries: As for `forward`.

        Raises:
            SimulationError: There is not enough memory for the contacts.
        """
        model, data = self._model, self._data
        by_step = self.bounces is not None or self.moved is not None
        if by_step or self.followers is not None or carries:
            for each in range(count):
                if each or not forwarded:
                    self.forward(data, carries=carries)
                if self.bounces is not None and self.bounces.apply(
                    model, data, moved=self.moved is not None
                ):
                    self.forward(data, carries=carries)
                self._integrate()
            return
        try:
            if forwarded:
                self._integrate()
                count -= 1
            if count:
                mujoco.mj_step(model, data, count)
        except mujoco.FatalError as error:
            raise too_many_contacts(data.ncon, error) from None

    def _integrate(self) -> None:
        mujoco.mj_Euler(self._model, self._data)
        # MuJoCo clears it only in a forward pass.
        self._data.flg_rnepost = False
