"""Poses of the links of recorded robots, from transforms and joint states."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cartwheel.codes.recording import RECORDED_ROBOT_NOT_SHOWN
from cartwheel.description import load_plain
from cartwheel.description.files.readable_files import Reach, run_folders
from cartwheel.description.kinematics import joint_positions, link_poses
from cartwheel.description.model import RobotDescription, WorldDescription
from cartwheel.errors import CartwheelError, Diagnostic
from cartwheel.geometry import Pose, to_wxyz
from cartwheel.options import PACKAGE_PATH
from cartwheel.simulation.snapshot import PlacedModel, RunState, Scene, Snapshot

TRANSFORMS = "tf2_msgs/msg/TFMessage"
JOINTS = "sensor_msgs/msg/JointState"
STRING = "std_msgs/msg/String"
STATE = frozenset({TRANSFORMS, JOINTS})
"""Message types that change the displayed scene."""


@dataclass(slots=True)
class _Robot:
    name: str
    namespace: str
    description: RobotDescription


class PlayedScene:
    """The displayed scene and its poses.

    The frame at the root of the transforms is the world frame.

    Args:
        world: World file whose objects are shown at the poses in that file.
        package_path: Directories that are searched first for meshes.
    """

    def __init__(self, world: WorldDescription, package_path: Sequence[Path] = ()) -> None:
        self.world = world
        self.diagnostics: list[Diagnostic] = []
        self._package_path = package_path
        self._robots: dict[str, _Robot] = {}
        """Robots by topic."""
        self._texts: dict[str, str] = {}
        self._parents: dict[str, tuple[str, Pose]] = {}
        self._joints: dict[str, dict[str, float]] = {}
        """Joint positions by namespace and joint."""
        self._version = 0
        self.scene = self._made()
        """The objects that are currently shown."""

    def robot_near(self, topic: str) -> str | None:
        """Name of the robot whose namespace contains a topic, or of the first robot."""
        robots = sorted(self._robots.values(), key=lambda r: (-len(r.namespace), r.name))
        for robot in robots:
            if topic.startswith(f"{robot.namespace}/"):
                return robot.name
        return robots[0].name if robots else None

    def describe(self, topic: str, text: str) -> None:
        """Adds or replaces a robot from its description."""
        if self._texts.get(topic) == text:
            return
        self._texts[topic] = text
        try:
            found = load_plain(
                text,
                file=f"<{topic}>",
                package_path=self._package_path,
                reach=Reach(
                    folders=tuple(run_folders(())),
                    hint=f"Add the folder of the package: {PACKAGE_PATH.given('FOLDER')}",
                ),
            )
        except CartwheelError as error:
            self.diagnostics.append(
                RECORDED_ROBOT_NOT_SHOWN.because(
                    f"the robot of {topic} is not shown", error, values={"topic": topic}
                )
            )
            return
        if isinstance(found, WorldDescription):
            self.diagnostics.append(
                RECORDED_ROBOT_NOT_SHOWN.diagnostic(
                    f"{topic} contains a world description, but only robots are shown",
                    values={"topic": topic},
                )
            )
            return
        self.diagnostics += [d for d in found.diagnostics if d.severity != "info"]
        namespace = topic.rpartition("/")[0]
        taken = {robot.name for key, robot in self._robots.items() if key != topic}
        name = namespace.strip("/") or found.name
        if name in taken:
            name = next(
                f"{name}_{i}" for i in range(2, len(taken) + 3) if f"{name}_{i}" not in taken
            )
        self._robots[topic] = _Robot(name, namespace, found)
        self.scene = self._made()

    def take(self, topic: str, message: Any) -> None:
        """Applies a message with transforms or joint states."""
        if message.__msgtype__ == TRANSFORMS:
            for each in message.transforms:
                where, turn = each.transform.translation, each.transform.rotation
                pose = Pose((where.x, where.y, where.z), (turn.x, turn.y, turn.z, turn.w))
                child = each.child_frame_id.lstrip("/")
                self._parents[child] = (each.header.frame_id.lstrip("/"), pose)
        elif message.__msgtype__ == JOINTS:
            known = self._joints.setdefault(topic.rpartition("/")[0], {})
            known.update(zip(message.name, map(float, message.position), strict=False))

    def forget(self) -> None:
        """Deletes all later transforms and joint states, because playback jumped back in time."""
        self._parents.clear()
        self._joints.clear()

    def pose(self, name: str) -> Pose:
        """Pose of a model."""
        for placed in self.scene.models:
            if placed.name == name:
                robot = next((r for r in self._robots.values() if r.name == name), None)
                return self._links(robot)[0] if robot else placed.pose
        raise KeyError(name)

    def snapshot(
        self, time_ns: int, run_state: RunState, speed: float | None, factor: float
    ) -> Snapshot:
        """Snapshot of the scene at a time."""
        poses: list[Pose] = []
        positions: list[float] = []
        for placed in self.scene.models:
            robot = next((r for r in self._robots.values() if r.name == placed.name), None)
            description = placed.description
            if robot is None:
                found = link_poses(description, {})
                poses += [placed.pose @ found[link.name] for link in description.links]
                values = joint_positions(description, {})
            else:
                poses += self._links(robot)[1]
                values = joint_positions(description, self._positions(robot))
            positions += [
                values[joint.name] for joint in description.joints if joint.type != "fixed"
            ]
        return Snapshot(
            scene=self.scene,
            time_ns=time_ns,
            run_state=run_state,
            speed=speed,
            real_time_factor=factor,
            positions=np.array([pose.position for pose in poses], dtype=float).reshape(-1, 3),
            quaternions=np.array(
                [to_wxyz(pose.orientation) for pose in poses], dtype=float
            ).reshape(-1, 4),
            joint_positions=np.array(positions, dtype=float),
        )

    def _links(self, robot: _Robot) -> tuple[Pose, list[Pose]]:
        """Poses of a robot's base frame and of its links."""
        local = link_poses(robot.description, self._positions(robot))
        known: dict[str, Pose] = {}
        for name in local:
            pose = self._in_world(robot, name)
            if pose is not None:
                known[name] = pose
        root = robot.description.canonical_link
        anchor = root if root in known else next(iter(known), None)
        base = Pose() if anchor is None else known[anchor] @ local[anchor].inverse()
        return base, [
            known.get(link.name, base @ local[link.name]) for link in robot.description.links
        ]

    def _positions(self, robot: _Robot) -> dict[str, float]:
        if robot.namespace in self._joints:
            return self._joints[robot.namespace]
        return {joint: value for each in self._joints.values() for joint, value in each.items()}

    def _in_world(self, robot: _Robot, link: str) -> Pose | None:
        prefixes = (f"{robot.namespace.strip('/')}/", f"{robot.name}/", "")
        frame = next((p + link for p in prefixes if p != "/" and p + link in self._parents), None)
        if frame is None:
            return None
        pose = Pose()
        seen = set()
        while frame in self._parents and frame not in seen:
            seen.add(frame)
            frame, step = self._parents[frame]
            pose = step @ pose
        return pose

    def _made(self) -> Scene:
        self._version += 1
        robots = [(robot.name, robot.description, Pose()) for robot in self._robots.values()]
        things = [(model.name, model, model.pose) for model in self.world.models]
        models = tuple(
            PlacedModel(name=name, description=description, pose=pose)
            for name, description, pose in (*things, *robots)
        )
        return Scene(
            version=self._version,
            world=self.world,
            models=models,
            links=tuple((m.name, link.name) for m in models for link in m.description.links),
            joints=tuple(
                (m.name, joint.name)
                for m in models
                for joint in m.description.joints
                if joint.type != "fixed"
            ),
        )
