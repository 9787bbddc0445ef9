"""The visuals of the models, for cameras and for sensors that measure visuals.

They are in a MuJoCo model of their own, which is compiled when it is first used: the meshes of
visuals take most of the time of a compilation, and physics does not need them.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import mujoco

from cartwheel.description.model import Rgba
from cartwheel.world.visuals import VISUAL_GROUP

_PLACES = ("body_pos", "body_quat")
_LIGHTS = ("light_pos", "light_dir", "light_diffuse", "light_attenuation")


class VisualModel:
    """A MuJoCo model with the bodies of the simulated model and their visuals."""

    def __init__(self) -> None:
        self._physics: tuple[Any, Any] = (None, None)
        self._compile: Callable[[], Any] | None = None
        self._model: Any = None
        self._data: Any = None
        self._paints: dict[str, Rgba] = {}
        """Colours of bodies that differ from the compiled visuals."""
        self.paintings = 0
        """Number of changes of colours."""

    def bind(self, model: Any, data: Any, compile_visuals: Callable[[], Any] | None) -> None:
        """Sets the simulated model and its data.

        Args:
            model: The simulated model.
            data: Its data.
            compile_visuals: Compiles the same bodies with their visuals. None if `model` itself
                has them.
        """
        self._physics = (model, data)
        self.replace(compile_visuals)

    def replace(self, compile_visuals: Callable[[], Any] | None) -> None:
        """Changes the visuals of the simulated model; see `bind`."""
        self._compile = compile_visuals
        self._model = self._data = None
        self._paints = {}

    def paint(self, body: str, rgba: Rgba) -> None:
        """Gives all visuals of a body one colour, without a texture.

        Args:
            body: Scoped name of the link.
            rgba: See `plain_colour`.
        """
        self._paints[body] = rgba
        model = self._physics[0] if self._compile is None else self._model
        if model is not None:
            _apply(model, body, rgba)
            self.paintings += 1

    def forget(self) -> None:
        """Frees the compiled visuals, which are compiled again at the next use."""
        self._model = self._data = None

    def current(self) -> tuple[Any, Any]:
        """The model with visuals and its data, at the current positions of the joints.

        Raises:
            WorldError: A visual cannot be built.
        """
        if self._compile is None:
            return self._physics
        model, data = self._physics
        if self._model is None:
            self._model = self._compile()
            self._data = mujoco.MjData(self._model)
            for body, rgba in self._paints.items():
                _apply(self._model, body, rgba)
        for name in (*_PLACES, *_LIGHTS):
            getattr(self._model, name)[:] = getattr(model, name)
        self._data.qpos[:] = data.qpos
        mujoco.mj_kinematics(self._model, self._data)
        mujoco.mj_camlight(self._model, self._data)
        return self._model, self._data


def _apply(model: Any, body: str, rgba: Rgba) -> None:
    geoms = (model.geom_bodyid == model.body(body).id) & (model.geom_group == VISUAL_GROUP)
    model.geom_rgba[geoms] = rgba
    # Without a material, there is no texture.
    model.geom_matid[geoms] = -1
