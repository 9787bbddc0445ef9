"""Models that have been read but not placed in the world."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from cartwheel.codes.tags import NAME_TAKEN
from cartwheel.description.model import Element, Joint, Link, PluginTag, RobotDescription
from cartwheel.description.sdf.context import Context
from cartwheel.description.sdf.frames import Frames
from cartwheel.description.sdf.loops import with_roots
from cartwheel.description.sdf.parts import judge
from cartwheel.errors import Origin
from cartwheel.geometry import Pose


@dataclass(slots=True)
class Model:
    """A model before it is placed."""

    name: str
    frames: Frames
    links: list[Link]
    joints: list[Joint]
    plugins: list[PluginTag]
    static: bool
    self_collide: bool
    pose: Pose
    """Relative to `relative_to`, with the placement frame already applied."""
    relative_to: str
    origin: Origin
    merge: bool = False
    transmissions: tuple[Element, ...] = ()
    """For a URDF, like the following fields."""
    ros2_control: tuple[Element, ...] = ()
    text: str = ""

    def describe(self, pose: Pose, ctx: Context, text: str = "") -> RobotDescription:
        """The model as a robot description, placed in the world.

        Raises:
            DescriptionError: A movable link has an impossible inertia.
        """
        self.links = judge(self.links, self.joints, ctx, static=self.static)
        canonical = self.frames.link_of("", self.origin) if self.links else ""
        return RobotDescription(
            name=self.name,
            links=tuple(self.links),
            joints=with_roots(self.links, self.joints, canonical),
            plugins=tuple(self.plugins),
            static=self.static,
            self_collide=self.self_collide,
            pose=pose,
            canonical_link=canonical,
            transmissions=self.transmissions,
            ros2_control=self.ros2_control,
            text=text or self.text,
            origin=self.origin,
        )


def name_apart(models: Iterable[Model], ctx: Context) -> None:
    """Renames models with duplicate names, as Gazebo Classic does."""
    models = list(models)
    taken = {model.name for model in models}
    numbers: dict[str, Iterator[int]] = {}
    for model in models:
        name = model.name
        if name not in numbers:
            numbers[name] = itertools.count(1)
            continue
        model.name = next(free for i in numbers[name] if (free := f"{name}_{i}") not in taken)
        ctx.warn(
            NAME_TAKEN,
            f'model "{name}" has the same name as another model and is renamed "{model.name}"',
            origin=model.origin,
            severity="warning",
            values={"name": name, "renamed": model.name},
        )
