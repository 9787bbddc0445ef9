"""The robots, links and worlds that a test names."""

from __future__ import annotations

import fnmatch
from typing import TYPE_CHECKING

from cartwheel.api.values import instance, invalid
from cartwheel.codes.world import UNKNOWN_MODEL
from cartwheel.errors import UnknownNameError

if TYPE_CHECKING:
    from cartwheel.api import Link, Model, World
    from cartwheel.geometry import Pose


def side_of(given: Model | Link | str, name: str) -> str:
    """The name of a model, the scoped name of a link, or a pattern for the other side."""
    return given if name == "other" and isinstance(given, str) else frame_of(given, name)


def frame_of(given: object, name: str = "robot") -> str:
    """The name of a model, or the scoped name of a link."""
    from cartwheel.api import Link, Model

    if isinstance(given, Model | Link):
        return given.scoped_name
    error = invalid(name, "must be a Model or a Link", given)
    error.hint = 'Write world.model("cart"), or one of its links.'
    raise error


def name_of(model: Model) -> str:
    """The name of a model."""
    from cartwheel.api import Link, Model

    name = model.model if isinstance(model, Link) else "cart"
    return instance(model, Model, "robot", f'world.model("{name}")').name


def pose_of(world: World, name: str) -> Pose:
    """The pose of a model, or of a link by its scoped name, such as ``arm::hand``.

    Raises:
        UnknownNameError: It does not exist.
    """
    model, separator, link = name.partition("::")
    if not separator or name in world.models:
        return world.model(name).pose
    return world.model(model).link(link).pose


def matching(world: World, pattern: str) -> list[str]:
    """The models, or with ``::`` the scoped names of the links, that match a pattern.

    Raises:
        UnknownNameError: There are none.
    """
    model, separator, _ = pattern.partition("::")
    models = fnmatch.filter(world.models, model)
    if not models:
        raise UnknownNameError("model", model, world.models, code=UNKNOWN_MODEL)
    if not separator:
        return models
    links = [f"{each}::{link}" for each in models for link in world.model(each).links]
    found = fnmatch.filter(links, pattern)
    if not found:
        raise UnknownNameError("link", pattern, links)
    return found


def others(world: World, name: str, pattern: str) -> list[str]:
    """The models or links that match a pattern, and differ from a model or link with a name.

    The other links of the same model are only among them if the pattern names links.

    Raises:
        UnknownNameError: No model or link matches the pattern.
    """
    own = name.partition("::")[0]
    return [each for each in matching(world, pattern) if each not in (own, name)]


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
