"""Gravity and lights of a compiled model, changed in place."""

from __future__ import annotations

from dataclasses import replace

from cartwheel.description.model import Light, WorldDescription
from cartwheel.simulation.engine import Engine
from cartwheel.world.lights import shine


def adjust(engine: Engine, world: WorldDescription) -> bool:
    """Makes the engine's model one of another world, where no more differs than can be changed.

    Returns:
        Whether it could; nothing has changed where not.
    """
    before = engine.world
    if replace(world, gravity=before.gravity, lights=before.lights) != before:
        return False
    if [_kept(light) for light in world.lights] != [_kept(light) for light in before.lights]:
        return False
    engine.world = world
    model = engine.model
    if world.gravity != before.gravity:
        model.opt.gravity[:] = world.gravity
        # What the engine finds awake and asleep at once, it wakes.
        engine.data.tree_awake[:] = 1
    for index, light in enumerate(world.lights):
        for name, value in shine(light).items():
            getattr(model, f"light_{name}")[index] = value
    engine.forward()
    return True


def _kept(light: Light) -> tuple[object, ...]:
    """What of a light is compiled in."""
    spot = (light.spot_angle, light.spot_inner, light.spot_falloff)
    return light.name, light.type, light.range, *spot
