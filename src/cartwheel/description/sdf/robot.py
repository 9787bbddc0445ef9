"""A URDF in an ``<include>``, which Gazebo converts to a model."""

from __future__ import annotations

from pathlib import Path

from cartwheel.description.elements.xml import needs_xacro, read_bytes
from cartwheel.description.sdf.context import read_pose, reference_of
from cartwheel.description.sdf.include import Included
from cartwheel.description.sdf.parts import frames_of
from cartwheel.description.sdf.unplaced import Model
from cartwheel.description.urdf import read_urdf
from cartwheel.description.xml_text import write_xml


def read_robot(included: Included) -> Model:
    """The model in a URDF, with the includer's changes.

    Raises:
        DescriptionError: The URDF cannot be used.
    """
    root, ctx = included.root, included.ctx
    if needs_xacro(root):
        # Imported here, as in `loading`, because the import is slow.
        from cartwheel.description.xacro import expand

        file = root.origin.file
        expansion = expand(read_bytes(Path(file)), file, ctx.packages, {})
        ctx.diagnostics.extend(expansion.diagnostics)
        root = expansion.root
    robot = read_urdf(root, ctx.packages)
    ctx.diagnostics.extend(robot.diagnostics)
    name = included.name or robot.name
    frames = frames_of(name, robot.canonical_link, robot.links, robot.joints)
    return Model(
        name=name,
        frames=frames,
        links=list(robot.links),
        joints=list(robot.joints),
        plugins=[*robot.plugins, *included.plugins],
        static=robot.static if included.static is None else included.static,
        self_collide=robot.self_collide,
        pose=read_pose(included.pose)
        @ frames.pose(included.placement_frame, included.origin).inverse(),
        relative_to=reference_of(included.pose),
        origin=included.origin,
        merge=included.merge,
        transmissions=robot.transmissions,
        ros2_control=robot.ros2_control,
        text=write_xml(root),
    )
