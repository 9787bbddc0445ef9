"""``gz-sim-apply-link-wrench-system``: commanded forces on any link in the world."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar, cast

from cartwheel.component import Shared
from cartwheel.description.model import Element, PluginTag
from cartwheel.devices.contact.entity_wrench import (
    EntityWrench,
    EntityWrenchConfig,
    StatedWrench,
)
from cartwheel.dialects.gz.bridge_file import gz_topic
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import invalid, required, tag, vector
from cartwheel.errors import PluginError
from cartwheel.geometry import Vec3
from cartwheel.simulation import Part


@dataclass(frozen=True, kw_only=True, slots=True)
class ApplyLinkWrenchParameters:
    persistent: tuple[str, ...] = tag(
        "persistent",
        default=(),
        nested=True,
        doc="Wrench that acts from the beginning: `<entity_name>` is `model`, for its canonical "
        "link, or `model::link`, `<entity_type>` is `model` or `link`, and `<force>` in N and "
        "`<torque>` in N m are in the world. Repeat the tag for several.",
    )


class ApplyLinkWrench(Plugin[ApplyLinkWrenchParameters]):
    """Applies commanded forces and torques to the links of any model in the world.

    `/world/<world>/wrench` applies a wrench for one step, and `/world/<world>/wrench/persistent`
    until `/world/<world>/wrench/clear` removes all those of the link. Wrenches are in the world,
    and forces act at the centre of mass. Entities are stated by `name` and `type`, not by `id`:
    `model` or `model::link`. Original plugin: ``ApplyLinkWrench`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-apply-link-wrench-system",)
    for_world: ClassVar[bool] = True

    def configure(self) -> None:
        for element in self.tag.element.find_all("persistent"):
            _stated(element)

    @classmethod
    def added_to(cls, part: Part, shared: Shared, tag: PluginTag) -> Iterator[EntityWrench]:
        """Creates the wrenches on a model."""
        description = part.description
        names = [link.name for link in description.links]
        if description.static or not names:
            return
        canonical = description.canonical_link
        links = (canonical, *(name for name in names if name != canonical))
        try:
            stated = [_stated(each) for each in tag.element.find_all("persistent")]
        except PluginError:
            # The world reports it.
            return
        scope = cls._scope_on(part, shared, tag, "apply_link_wrench", "wrenches on")
        config = EntityWrenchConfig(
            links=links,
            topic=gz_topic(f"/world/{part.world.name}/wrench"),
            stated=tuple(
                StatedWrench(link=link or canonical, force=force, torque=torque)
                for model, link, force, torque in stated
                if model == part.name and (not link or link in links)
            ),
        )
        yield part.made(lambda: EntityWrench(scope, config))


def _stated(element: Element) -> tuple[str, str, Vec3, Vec3]:
    """Returns the model, the link, the force and the torque of a persistent wrench.

    Raises:
        PluginError: A tag is missing or invalid.
    """
    name = required(element, "entity_name").text.strip()
    kind = required(element, "entity_type")
    if kind.text.strip() not in ("model", "link"):
        raise invalid("entity_type", kind.text.strip(), "model or link", kind.origin)
    vectors = []
    for each in ("force", "torque"):
        child = element.find(each)
        vectors.append(cast("Vec3", vector(child, 3)) if child is not None else (0.0, 0.0, 0.0))
    model, _, link = name.partition("::")
    return model, link, vectors[0], vectors[1]
