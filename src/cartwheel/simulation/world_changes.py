"""Changes gravity and lights in a compiled model."""

from __future__ import annotations

from dataclasses import replace

from cartwheel.description.model import Light, WorldDescription
from cartwheel.simulation.engine import Engine
from cartwheel.simulation.models.waking import wake_all
from cartwheel.world.lights import shine


def adjust(engine: Engine, world: WorldDescription) -> bool:
    """Applies a world to the engine's model if they differ only in gravity and lights.

    Returns:
        Whether the world was applied; otherwise the model is unchanged.
    """
    before = engine.world
    if replace(world, gravity=before.gravity, lights=before.lights) != before:
        return False
    if [_kept(light) for light in world.lights] != [_kept(light) for light in before.lights]:
        return False
    engine.world = world
    engine.revisions += 1
    engine.note_change()
    model = engine.model
    if world.gravity != before.gravity:
        model.opt.gravity[:] = world.gravity
        wake_all(engine)
    for index, light in enumerate(world.lights):
        for name, value in shine(light).items():
            getattr(model, f"light_{name}")[index] = value
    engine.note_change()
    engine.refresh()
    return True


def _kept(light: Light) -> tuple[object, ...]:
    """The properties of a light that are compiled into the model."""
    spot = (light.spot_angle, light.spot_inner, light.spot_falloff)
    return light.name, light.type, light.range, *spot
