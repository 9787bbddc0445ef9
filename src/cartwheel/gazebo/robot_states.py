"""Publishes link poses on ``/tf`` like robot_state_publisher, unless another node does."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from cartwheel.codes.graph import FRAMES_SHARED
from cartwheel.description.kinematics import JointPose, joint_positions
from cartwheel.description.model import Joint, RobotDescription
from cartwheel.gazebo.robot_descriptions import (
    TOPIC,
    RobotDescriptions,
    hold_descriptions,
    is_robot,
    release_descriptions,
)
from cartwheel.graph import Graph, Publisher, resolve_frame
from cartwheel.messages import header, message_class
from cartwheel.session import Session
from cartwheel.simulation import Simulation

NODE = "robot_state_publisher"
RATE = 50.0
"""Publish rate for moving joints, Hz of simulation time."""
_LOOK = 10.0
"""Rate of checks for new models, Hz of simulation time."""


@dataclass(frozen=True, slots=True)
class _Robot:
    """A robot whose link frames are published."""

    description: RobotDescription
    prefix: str
    moving: tuple[JointPose, ...]
    others: tuple[JointPose, ...]
    """Moving joints whose transforms plugins publish."""
    read: tuple[str, ...]
    """Names of the joints whose positions are read, also those that others mimic."""
    mimics: bool
    children: frozenset[str]


class RobotStates:
    """Publishes the pose of each robot link in its parent link.

    Fixed joints are published on ``/tf_static``, others on ``/tf``. Transforms that plugins publish
    are omitted, such as wheels whose drive publishes them. So is the root link: its drive publishes
    it in ``odom``. Two robots with the same frames need a namespace or prefix: the second robot's
    frames are omitted, and reported. `hold_states` provides the instance of a session. Use it on
    the owner's thread. Source: robot_state_publisher.

    Args:
        simulation: The simulation.
        graph: The graph to publish on.
        descriptions: The published robot descriptions.
        reports: Whether omitted frames are reported.
    """

    def __init__(
        self,
        simulation: Simulation,
        graph: Graph,
        descriptions: RobotDescriptions,
        *,
        reports: bool = True,
    ) -> None:
        self.holders = 0
        """Number of calls of `hold_states` that have not ended."""
        self._reports = reports
        self._simulation = simulation
        self._graph = graph
        self._descriptions = descriptions
        self._publisher: Publisher | None = None
        self._others: frozenset[str] = frozenset()
        self._robots: dict[str, _Robot] = {}
        self._moves = False
        """Whether one of the robots has joints whose transforms are published again and again."""
        self._version = -1
        self._warned: set[str] = set()
        self._looking = simulation.schedule(_LOOK, before=self._look, active=self._is_due)
        self._telling = simulation.schedule(RATE, after=self._publish, active=self._wanted)
        self._look()

    def leave_to_others(self, topics: frozenset[str]) -> None:
        """Stops publishing for robots described by other nodes, and publishes for the rest.

        Args:
            topics: Topics on which other nodes publish descriptions; ``/robot_description`` may be
                any robot's.
        """
        if topics != self._others:
            self._others = topics
            self._look()

    def report(self) -> None:
        """Reports omitted frames from now on, also those of present robots."""
        if not self._reports:
            self._reports = True
            self._look()

    def update(self) -> None:
        """Publishes for new robots at once, which otherwise happens during the next run."""
        if self._is_due():
            self._look()

    def close(self) -> None:
        """Stops publishing."""
        self._tell_of({})
        self._simulation.unschedule(self._looking)
        self._simulation.unschedule(self._telling)

    def forget(self) -> None:
        """Clears the references of the tasks of a closed simulation."""
        self._looking.forget()
        self._telling.forget()

    def _is_due(self) -> bool:
        return self._version != self._simulation.scene.version

    def _wanted(self) -> bool:
        return self._moves and self._publisher is not None and self._publisher.wanted

    def _is_anothers(self, name: str) -> bool:
        return TOPIC in self._others or self._descriptions.topic(name) in self._others

    def _look(self) -> None:
        scene = self._simulation.scene
        self._version = scene.version
        self._tell_of(
            {
                one.name: one.description
                for one in scene.models
                if is_robot(one.description) and not self._is_anothers(one.name)
            }
        )

    def _tell_of(self, robots: Mapping[str, RobotDescription]) -> None:
        static = self._graph.static_transforms
        for name in list(self._robots):
            if robots.get(name) is not self._robots[name].description:
                del self._robots[name]
                static.remove((NODE, name))
        for name, description in robots.items():
            if name in self._robots:
                continue
            prefix = self._simulation.frame_prefix(name)
            joints = _tree(description)
            children = frozenset(resolve_frame(joint.child, prefix) for joint in joints)
            if self._are_told(name, children):
                continue
            by_plugins = _told_by_plugins(description)
            turning = [
                JointPose(description, joint)
                for joint in joints
                if joint.drivable or joint.type == "screw"
            ]
            moving = tuple(each for each in turning if each.joint.name not in by_plugins)
            others = tuple(each for each in turning if each.joint.name in by_plugins)
            mimics = any(each.joint.mimic is not None for each in moving)
            read = description.joints if mimics else [each.joint for each in moving]
            names = tuple(joint.name for joint in read)
            self._robots[name] = _Robot(
                description, prefix, moving, others, names, mimics, children
            )
            fixed = [JointPose(description, joint) for joint in joints if joint.type == "fixed"]
            if fixed:
                static.put((NODE, name), _transforms(0, fixed, {}, prefix))
        self._moves = any(robot.moving for robot in self._robots.values())
        # Advertise only if there is something to publish, so that /tf shows the actual publisher.
        if self._robots and self._publisher is None:
            self._publisher = self._graph.advertise(
                "/tf", "tf2_msgs/msg/TFMessage", node=NODE, rate=RATE
            )
        elif not self._robots and self._publisher is not None:
            self._publisher.close()
            self._publisher = None

    def _are_told(self, name: str, children: frozenset[str]) -> bool:
        for other, robot in self._robots.items():
            shared = sorted(robot.children & children)
            if not shared:
                continue
            if self._reports and name not in self._warned:
                self._warned.add(name)
                self._simulation.engine.report(
                    FRAMES_SHARED.diagnostic(
                        f'the models "{name}" and "{other}" have frames with the same names, such '
                        f'as {shared[0]}, so the links of "{name}" are not published on /tf',
                        values={"model": name, "other": other, "frame": shared[0]},
                    )
                )
            return True
        return False

    def _publish(self) -> None:
        assert self._publisher is not None
        if transforms := self.transforms():
            self._publisher.publish(message_class("tf2_msgs/msg/TFMessage")(transforms))

    def transforms(self, *, every: bool = False) -> list[Any]:
        """The ``TransformStamped`` messages of the moving joints, for the current positions.

        Args:
            every: Also of the joints whose transforms plugins publish.
        """
        simulation = self._simulation
        placed = set(simulation.scene.joints)
        transforms: list[Any] = []
        for name, robot in self._robots.items():
            joints, read = robot.moving, robot.read
            if every and robot.others:
                joints += robot.others
                read += tuple(each.joint.name for each in robot.others)
            if not joints or name not in simulation.models:
                continue
            positions = {
                joint: simulation.joint_position(name, joint)
                for joint in read
                if (name, joint) in placed
            }
            if robot.mimics:
                positions = joint_positions(robot.description, positions)
            transforms += _transforms(simulation.time_ns, joints, positions, robot.prefix)
        return transforms


def hold_states(session: Session, *, reports: bool = True) -> Callable[[], None]:
    """Publishes the descriptions of all robots and, unless other nodes do, their transforms.

    Call it on the thread that owns the simulation.

    Args:
        session: The session.
        reports: Whether robots with the same frames are reported.

    Returns:
        A function that ends it, to be called once. After the last one, nothing is published.
    """
    descriptions = hold_descriptions(session)
    states = session.states
    if states is None and not session.others_publish_states:
        session.states = states = RobotStates(
            session.simulation, session.graph, descriptions, reports=reports
        )
    if isinstance(states, RobotStates):
        states.holders += 1
        states.update()
        if reports:
            states.report()

    def release() -> None:
        if isinstance(states, RobotStates):
            states.holders -= 1
            if not states.holders:
                session.states = None
                states.close()
        release_descriptions(session)

    return release


def _tree(description: RobotDescription) -> list[Joint]:
    """The joints in the link tree: one for each link except the root."""
    inbound: dict[str, Joint] = {}
    for joint in description.joints:
        if joint.parent != "world":
            inbound.setdefault(joint.child, joint)
    return list(inbound.values())


def _told_by_plugins(description: RobotDescription) -> set[str]:
    """Joints whose transforms a plugin publishes, according to its tags."""
    names = {joint.name for joint in description.joints}
    found: set[str] = set()
    for tag in description.plugins:
        says = (tag.element.find(word) for word in ("publishWheelTF", "publish_wheel_tf"))
        if any(one is not None and one.text.strip().lower() in ("true", "1") for one in says):
            found |= {each.text.strip() for each in tag.element.children} & names
    return found


def _transforms(
    time_ns: int, joints: Iterable[JointPose], positions: Mapping[str, float], prefix: str
) -> list[Any]:
    Stamped, Transform, Vector3, Quaternion = (
        message_class(f"geometry_msgs/msg/{name}")
        for name in ("TransformStamped", "Transform", "Vector3", "Quaternion")
    )
    made = []
    for each in joints:
        joint, pose = each.joint, each.at(positions.get(each.joint.name, 0.0))
        made.append(
            Stamped(
                header(time_ns, resolve_frame(joint.parent, prefix)),
                resolve_frame(joint.child, prefix),
                Transform(Vector3(*pose.position), Quaternion(*pose.orientation)),
            )
        )
    return made
