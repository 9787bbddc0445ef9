"""Draws the models with one browser's display settings."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from cartwheel.viewer.display import Display
from cartwheel.viewer.model_view import ModelView
from cartwheel.viewer.seat import Seat

_SEE_THROUGH = 0.35


@dataclass
class _Layer:
    view: ModelView
    style: object
    nodes: list[Any]


class Look:
    """Adds a browser's differences from the shared scene.

    Args:
        seat: The browser.
    """

    def __init__(self, seat: Seat) -> None:
        self._seat = seat
        self._layers: dict[tuple[str, str], _Layer] = {}
        self._through: str | None = None

    def show(self, models: Mapping[str, ModelView], *, through: str | None = None) -> None:
        """Draws models with the current toggles.

        Args:
            models: All models, by name.
            through: The model that clicks pass through, because a gizmo is inside it.
        """
        wanted: dict[tuple[str, str], tuple[ModelView, object, Callable[[], list[Any]]]] = {}
        for name, view in models.items():
            for layer, (style, add) in self._styles(view, name != through).items():
                if style is not None:
                    wanted[name, layer] = view, style, add
        for key, layer_now in list(self._layers.items()):
            found = wanted.get(key)
            if found is None or (layer_now.view, layer_now.style) != found[:2]:
                for node in self._layers.pop(key).nodes:
                    node.remove()
        for key, (view, style, add) in wanted.items():
            if key not in self._layers:
                self._layers[key] = _Layer(view, style, add())
        display = self._seat.display
        hidden = () if display.visual else (n for v in models.values() for n in v.visual_nodes)
        self._seat.hide("visual", hidden)
        if through != self._through:
            for model, clickable in ((self._through, True), (through, False)):
                if model is not None and model in models:
                    self._seat.set_clickable(models[model].solids, clickable)
            self._through = through

    def _styles(
        self, view: ModelView, clickable: bool
    ) -> dict[str, tuple[object, Callable[[], list[Any]]]]:
        """The style of each layer, and a function that adds it; a style of None is not drawn."""
        display: Display = self._seat.display
        scene = self._seat.scene
        opacity = _SEE_THROUGH if display.transparent else 1.0
        wireframe = display.wireframe
        altered = display.visual and (display.transparent or wireframe)
        return {
            "visual": (
                (opacity, wireframe, clickable) if altered else None,
                lambda: view.add_visuals(
                    scene, opacity=opacity, wireframe=wireframe, clickable=clickable
                ),
            ),
            "collision": (
                (wireframe, clickable) if display.collision else None,
                lambda: view.add_collisions(scene, wireframe=wireframe, clickable=clickable),
            ),
            "inertia": (display.inertia or None, lambda: view.add_inertias(scene)),
            "names": (display.names or None, lambda: view.add_names(scene)),
            "axes": (display.axes or None, lambda: view.add_axes(scene)),
        }
