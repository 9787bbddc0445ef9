"""Wheel separations and sizes stated by plugins and controllers."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from cartwheel.description.check import control_claims as claimed
from cartwheel.description.check import nodes
from cartwheel.description.check.control_files import Controller, Value
from cartwheel.description.check.subject import Robot, Subject
from cartwheel.description.model import PluginTag
from cartwheel.errors import Origin, Place

Measure = Literal["apart", "base", "reach", "radius", "diameter"]
"""``apart`` is across the robot, ``base`` is along it, and ``reach`` is half their sum."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Stated:
    """A stated size."""

    robot: Robot
    measure: Measure
    label: str
    """The parameter's name in the file."""
    value: float
    written: bool
    """False for a plugin's default."""
    first: tuple[str, ...]
    """Joints of the left or front wheels, or of the measured wheels."""
    second: tuple[str, ...] = ()
    skids: bool = False
    """Whether several wheels on a side slide during turns."""
    origin: Origin
    mark: str
    write: Callable[[str], str]
    """Formats a number as replacement text."""
    place: Place


@dataclass(frozen=True, kw_only=True, slots=True)
class _Size:
    measure: Measure
    tags: tuple[str, ...]
    first: tuple[str, ...]
    """Joint tags; the first spelling present is used."""
    second: tuple[str, ...] = ()
    default: float | None = None
    """Default value; None if the plugin does not work without the tag."""


_SIDES = (("leftJoint", "left_joint"), ("rightJoint", "right_joint"))
_SEPARATION = ("wheelSeparation", "wheel_separation")
_CORNERS = tuple(f"{corner}_joint" for corner in claimed.CORNERS)
_SKID = ("leftFrontJoint", "leftRearJoint"), ("rightFrontJoint", "rightRearJoint")
_ENCODERS = (
    ("encoderWheelLeftJoint", "encoder_wheel_left_joint"),
    ("encoderWheelRightJoint", "encoder_wheel_right_joint"),
)
_STEERING = ("left_steering_joint",), ("right_steering_joint",)

_PLUGINS: Mapping[str, tuple[_Size, ...]] = {
    "gazebo_ros_diff_drive": (
        _Size(measure="apart", tags=_SEPARATION, first=_SIDES[0], second=_SIDES[1], default=0.34),
        _Size(
            measure="diameter", tags=("wheelDiameter", "wheel_diameter"), first=_SIDES[0],
            default=0.15,
        ),
    ),
    "gz-sim-diff-drive": (
        _Size(measure="apart", tags=_SEPARATION, first=_SIDES[0], second=_SIDES[1], default=1.0),
        _Size(measure="radius", tags=("wheel_radius",), first=_SIDES[0], default=0.2),
    ),
    "gazebo_ros_skid_steer_drive": (
        _Size(measure="apart", tags=_SEPARATION, first=_SKID[0], second=_SKID[1], default=0.34),
        _Size(measure="diameter", tags=("wheelDiameter",), first=_SKID[0], default=0.15),
    ),
    "diffdrive_plugin_multi_wheel": (
        _Size(
            measure="apart", tags=_SEPARATION, first=("leftJoints",), second=("rightJoints",),
            default=0.34,
        ),
        _Size(measure="diameter", tags=("wheelDiameter",), first=("leftJoints",), default=0.15),
    ),
    "gazebo_ros_kobuki": (
        _Size(
            measure="apart", tags=("wheel_separation",), first=("left_wheel_joint_name",),
            second=("right_wheel_joint_name",),
        ),
        _Size(measure="diameter", tags=("wheel_diameter",), first=("left_wheel_joint_name",)),
    ),
    "gazebo_ros_tricycle_drive": (
        _Size(
            measure="apart", tags=("encoderWheelSeparation", "wheel_separation"),
            first=_ENCODERS[0], second=_ENCODERS[1], default=0.5,
        ),
        _Size(
            measure="diameter", tags=("encoderWheelDiameter", "encoder_wheel_diameter"),
            first=_ENCODERS[0], default=0.15,
        ),
        _Size(
            measure="diameter", tags=("actuatedWheelDiameter", "actuated_wheel_diameter"),
            first=("actuatedWheelJoint", "actuated_wheel_joint"), default=0.15,
        ),
    ),
    "gz-sim-ackermann-steering": (
        _Size(measure="apart", tags=_SEPARATION, first=_SIDES[0], second=_SIDES[1], default=1.0),
        _Size(
            measure="apart", tags=("kingpin_width",), first=_STEERING[0], second=_STEERING[1],
            default=0.8,
        ),
        _Size(
            measure="base", tags=("wheel_base",), first=_STEERING[0], second=_SIDES[0], default=1.0
        ),
        _Size(measure="radius", tags=("wheel_radius",), first=_SIDES[0], default=0.2),
    ),
    "gz-sim-mecanum-drive": (
        _Size(
            measure="apart", tags=_SEPARATION, first=_CORNERS[:1], second=_CORNERS[1:2], default=1.0
        ),
        _Size(
            measure="base", tags=("wheelbase",), first=_CORNERS[:1], second=_CORNERS[2:3],
            default=1.0,
        ),
        _Size(measure="radius", tags=("wheel_radius",), first=_CORNERS[:1], default=0.2),
    ),
}  # fmt: skip
"""Sizes by a part of the plugin's file name, with the plugins' defaults."""


def stated(subject: Subject) -> Iterator[Stated]:
    """All wheel sizes stated in a description."""
    for robot in subject.robots:
        for tag in robot.description.plugins:
            name = tag.filename.replace("ignition-gazebo", "gz-sim")
            for part, sizes in _PLUGINS.items():
                if part in name:
                    for size in sizes:
                        yield from _of_plugin(robot, tag, size)
    for robot, file in subject.control:
        for controller in file.controllers:
            yield from _of_controller(robot, controller)


def _of_plugin(robot: Robot, tag: PluginTag, size: _Size) -> Iterator[Stated]:
    first = _joints(robot, tag, size.first)
    second = _joints(robot, tag, size.second)
    if not first or (size.second and not second):
        return
    name = next((name for name in size.tags if tag.element.find(name) is not None), "")
    written = list(tag.element.find_all(name)) if name else []
    for index, element in enumerate(written):
        value = nodes.number(element.text)
        # Repeated tags apply to one wheel pair each.
        pick = slice(index, index + 1) if len(written) > 1 else slice(None)
        if value is None or not first[pick] or (second and not second[pick]):
            continue
        yield Stated(
            robot=robot,
            measure=size.measure,
            label=f"<{name}>",
            value=value,
            written=True,
            first=first[pick],
            second=second[pick],
            skids=len(first[pick]) > 1,
            origin=element.origin,
            mark=element.text.strip(),
            write=lambda number, name=name: nodes.written(name, {}, number),  # type: ignore[misc]
            place="element",
        )
    if not written and size.default is not None:
        name = size.tags[-1] if "gazebo_ros" in tag.filename and _is_new(tag) else size.tags[0]
        yield Stated(
            robot=robot,
            measure=size.measure,
            label=f"<{name}>",
            value=size.default,
            written=False,
            first=first,
            second=second,
            skids=len(first) > 1,
            origin=tag.origin,
            mark=tag.filename,
            write=lambda number: nodes.written(name, {}, number),
            place="inside",
        )


def _is_new(tag: PluginTag) -> bool:
    """Whether the plugin uses ROS 2 tag names."""
    return any("_" in child.tag for child in tag.element.children)


def _joints(robot: Robot, tag: PluginTag, names: Sequence[str]) -> tuple[str, ...]:
    found = [
        word
        for name in names
        for element in tag.element.find_all(name)
        for word in element.text.split()
    ]
    return tuple(name for name in found if name in robot.joints)


def _of_controller(robot: Robot, controller: Controller) -> Iterator[Stated]:
    kind, ros2 = controller.kind, controller.file.is_ros2

    def say(
        measure: Measure,
        names: Sequence[str],
        first: Sequence[Value | None],
        second: Sequence[Value | None] = (),
    ) -> Iterator[Stated]:
        value = controller.value(*names)
        number = value.number if value is not None else None
        sides = [tuple(_known(robot, side)) for side in (first, second)]
        if value is None or number is None or not sides[0] or (second and not sides[1]):
            return
        yield Stated(
            robot=robot,
            measure=measure,
            label=f'"{next(name for name in names if controller.has(name)).rpartition("/")[2]}"',
            value=number,
            written=True,
            first=sides[0],
            second=sides[1],
            skids=len(sides[0]) > 1 and kind == claimed.DIFF_DRIVE,
            origin=value.origin,
            mark=value.text,
            write=value.replaced,
            place="line",
        )

    if kind == claimed.DIFF_DRIVE:
        left, right = (claimed.wheels_of(controller, side) for side in ("left", "right"))
        yield from say("apart", ["wheel_separation"], left, right)
        yield from say("radius", ["wheel_radius"], left)
    elif kind == claimed.MECANUM:
        corners = claimed.ROS2_CORNERS if ros2 else claimed.CORNERS
        wheels = [claimed.wheel_at(controller, corner) for corner in corners]
        yield from say("base", ["wheel_separation_x"], wheels[:1], wheels[2:3])
        yield from say("apart", ["wheel_separation_y"], wheels[:1], wheels[1:2])
        reach = "kinematics/sum_of_robot_center_projection_on_X_Y_axis"
        yield from say("reach", [reach], wheels[:1], wheels[3:])
        yield from say("radius", ["kinematics/wheels_radius", "wheel_radius"], wheels[:1])
    elif ros2 and kind in claimed.STEERED:
        driven, steered = (
            ("rear", "front") if claimed.front_steers(controller) else ("front", "rear")
        )
        axles = {driven: claimed.traction(controller), steered: claimed.steering(controller)}
        yield from say("base", ["wheelbase"], axles[steered], axles[driven])
        for axle, role in ((driven, "traction"), (steered, "steering")):
            names = [f"{role}_track_width", "wheel_track", f"{axle}_wheel_track"]
            if len(axles[axle]) == 2:
                yield from say("apart", names, axles[axle][:1], axles[axle][1:])
        radii = ("traction_wheels_radius", "wheels_radius", f"{driven}_wheels_radius")
        yield from say("radius", radii, axles[driven])
    elif not ros2 and kind in claimed.STEERED_BY_ONE:
        wheel, steer = claimed.traction(controller), claimed.steering(controller)
        yield from say("base", ["wheel_separation_h"], steer, wheel)
        yield from say("radius", ["wheel_radius"], wheel)
    elif kind == claimed.TRICYCLE:
        yield from say("radius", ["wheel_radius"], claimed.traction(controller))


def _known(robot: Robot, values: Sequence[Value | None]) -> Iterator[str]:
    for value in values:
        if value is not None and value.text.strip() in robot.joints:
            yield value.text.strip()
