"""The robots, links and worlds that a test names."""

from __future__ import annotations

from typing import TYPE_CHECKING

from cartwheel.api.values import instance, invalid

if TYPE_CHECKING:
    from cartwheel.api import Link, Model, World


def side_of(given: Model | Link | str, name: str) -> str:
    """The name of a model, the scoped name of a link, or a pattern for the other side."""
    from cartwheel.api import Link, Model

    if isinstance(given, Model | Link):
        return given.scoped_name
    if name == "other" and isinstance(given, str):
        return given
    error = invalid(name, "must be a Model or a Link", given)
    error.hint = 'Write world.model("cart"), or one of its links.'
    raise error


def name_of(model: Model) -> str:
    """The name of a model."""
    from cartwheel.api import Link, Model

    name = model.model if isinstance(model, Link) else "cart"
    return instance(model, Model, "robot", f'world.model("{name}")').name


def topic_of(world: World | Model, topic: str) -> str:
    """The name of a topic, for a model in its namespace."""
    from cartwheel.api import Model
    from cartwheel.graph import resolve_name

    return resolve_name(topic, world.namespace) if isinstance(world, Model) else topic


def world_of(given: World | Model | Link, name: str = "robot") -> World:
    from cartwheel.api import Link, Model, World

    if isinstance(given, World) and name == "world":
        return given
    if isinstance(given, Link):
        return given._world
    example = "the world or one of its models" if name == "world" else 'world.model("cart")'
    return instance(given, Model, name, example)._world
