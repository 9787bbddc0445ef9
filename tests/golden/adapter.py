"""The names of Cartwheel that this program uses. When one of them moves, only this file changes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import cartwheel
from cartwheel import CartwheelError, Pose, World, check
from cartwheel.corpus import survey
from cartwheel.description import load_robot
from cartwheel.messages import encode_cdr, message_class, service_classes, to_dict, zero

try:
    from cartwheel.dialects.ros_control.files import for_robot, read_parameters
    from cartwheel.dialects.ros_control.suggestion import suggested
except ModuleNotFoundError:  # a source tree from before these packages were named
    from cartwheel.plugins.control.files import for_robot, read_parameters
    from cartwheel.plugins.control.suggestion import suggested

__all__ = [
    "CartwheelError",
    "Pose",
    "World",
    "call",
    "check",
    "command_joints",
    "compiled",
    "controller_files",
    "encode_cdr",
    "joint_inputs",
    "load_robot",
    "message_class",
    "now_ns",
    "request",
    "robots_in",
    "run_with",
    "subscribe",
    "to_dict",
    "tree",
    "zero",
]


def robots_in(folder: Path) -> list[Path]:
    """The robots in a folder and its subfolders, and the models without plugins and sensors."""
    found = survey(folder)
    return sorted([*found.robots, *(path for path, kind in found.skipped if kind == "scenery")])


def tree() -> Path:
    """The source tree that is measured."""
    return Path(cartwheel.__file__).resolve().parents[2]


def compiled(world: World) -> tuple[Any, Any]:
    """MuJoCo's model and data of a world, with poses of the present state."""
    simulation = world.session.simulation
    simulation.refresh()
    return simulation.model, simulation.data


def run_with(
    world: World, times: Sequence[float], act: Callable[[float], None], look: Callable[[], None]
) -> None:
    """Runs from each time to the next, with an action at each, before the step that starts there.

    Args:
        world: The world, at the first of the times.
        times: At equal distances, s.
        act: Called with each time.
        look: Called before each run.
    """
    if hasattr(world, "on"):
        for time in times:
            world.on(time, partial(act, time))
    for time in times:
        look()
        if not hasattr(world, "on"):
            act(time)
        world.run(times[1] - times[0])


def now_ns(world: World) -> int:
    """Simulation time, ns."""
    return world.session.simulation.time_ns


def controller_files(description: Any) -> list[Path]:
    """The controller files near a robot that `cartwheel run` suggests and that are complete."""
    files = []
    for path in suggested(description):
        try:
            for_robot(read_parameters(path), path, description)
        except CartwheelError:
            continue
        files.append(path)
    return files


def joint_inputs(world: World) -> list[tuple[str, tuple[str, ...], Any]]:
    """Owner, joints and handle of everything that takes joint positions."""
    return [(each.owner, each.joints, each) for each in world.graph.joint_inputs.all()]


def command_joints(handle: Any, targets: Mapping[str, float], seconds: float) -> None:
    """Commands joint positions of an input."""
    handle.put(targets, seconds)


def subscribe(
    world: World, topic: str, type_name: str, callback: Callable[[Any], None]
) -> Callable[[], None]:
    """Subscribes; returns the function that ends the subscription."""
    return world.graph.subscribe(topic, callback, type_name=type_name, node="golden").close


def request(type_name: str) -> Any:
    """A request of a service in which all fields are zero."""
    kind, _ = service_classes(type_name)
    return zero(kind.__msgtype__)


def call(world: World, service: str, message: Any) -> Any:
    """Calls a service; the future is done when the world has run."""
    return world.graph.call(service, message)
