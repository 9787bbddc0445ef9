"""Services and topics for the poses and velocities of models and links."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from cartwheel.codes.graph import REQUEST_INVALID
from cartwheel.description.model import Joint
from cartwheel.errors import CartwheelError, Diagnostic
from cartwheel.gazebo.entities import Entities, Motion
from cartwheel.gazebo.requests import (
    Answer,
    Offer,
    failed,
    named,
    pose,
    pose_message,
    twist_message,
    vector,
)
from cartwheel.geometry import Pose, from_wxyz, rotate
from cartwheel.graph import Graph, Subscription
from cartwheel.messages import header, message_class
from cartwheel.simulation import Simulation
from cartwheel.simulation.limits import number
from cartwheel.world.entry import scoped


def bounded(joint: Joint, position: float) -> float:
    """A position that Gazebo sets, within the limits of the joint, rad or m."""
    if joint.type not in ("revolute", "prismatic"):
        return position
    lower = -math.inf if joint.axis.lower is None else joint.axis.lower
    upper = math.inf if joint.axis.upper is None else joint.axis.upper
    return float(min(max(position, lower), upper))


class States:
    """``get_`` and ``set_`` of model_state and link_state, and set_model_configuration.

    A model is moved as a rigid body: its joints keep their positions and stop. Source: gazebo_ros,
    gazebo_ros_api_plugin.
    """

    def __init__(self, simulation: Simulation, entities: Entities) -> None:
        self._simulation = simulation
        self._entities = entities

    def offers(self) -> list[Offer]:
        """The services."""
        return named(
            self.get_model_state,
            self.set_model_state,
            self.get_link_state,
            self.set_link_state,
            self.set_model_configuration,
        )

    def model(self, name: str, frame: str) -> Motion:
        """Motion of a model relative to the world, a model or a link."""
        self._entities.model(name)
        self._simulation.refresh()
        return self._entities.model_motion(name).seen_from(self._entities.frame(frame))

    def link(self, name: str, frame: str) -> Motion:
        """Motion of a link relative to the world, a model or a link."""
        model, link = self._entities.link(name)
        self._simulation.refresh()
        motion = self._entities.link_motion(model, link.name)
        return motion.seen_from(self._entities.frame(frame))

    def put_model(self, name: str, where: Any, twist: Any, frame: str) -> tuple[str, ...]:
        """Sets a model's pose and velocity.

        Args:
            name: Model name.
            where: ``geometry_msgs/Pose`` in the frame.
            twist: ``geometry_msgs/Twist`` in the frame's axes, relative to the world.
            frame: The world, a model or a link.

        Returns:
            Parameters without effect.
        """
        self._entities.model(name)
        return self._put(name, self._target(where, twist, frame))

    def put_link(self, name: str, where: Any, twist: Any, frame: str) -> tuple[str, ...]:
        """Moves a model so that its link gets a pose and twist; see `put_model`."""
        model, link = self._entities.link(name)
        target = self._target(where, twist, frame)
        base = self._entities.model_motion(model).pose
        offset = self._entities.link_motion(model, link.name).pose.inverse() @ base
        return self._put(model, target.carried(offset))

    def get_model_state(self, request: Any) -> Answer:
        seen = self.model(request.model_name, request.relative_entity_name)
        fields = {
            "header": header(self._simulation.time_ns, request.relative_entity_name),
            "pose": pose_message(seen.pose),
            "twist": twist_message(seen.linear, seen.angular),
        }
        return Answer("GetModelState: got properties", fields)

    def get_link_state(self, request: Any) -> Answer:
        seen = self.link(request.link_name, request.reference_frame)
        state = message_class("gazebo_msgs/msg/LinkState")(
            request.link_name,
            pose_message(seen.pose),
            twist_message(seen.linear, seen.angular),
            request.reference_frame,
        )
        return Answer("GetLinkState: got state", {"link_state": state})

    def set_model_state(self, request: Any) -> Answer:
        state = request.model_state
        notes = self.put_model(state.model_name, state.pose, state.twist, state.reference_frame)
        return Answer("SetModelState: set model state done", notes=notes)

    def set_link_state(self, request: Any) -> Answer:
        state = request.link_state
        notes = self.put_link(state.link_name, state.pose, state.twist, state.reference_frame)
        return Answer("SetLinkState: success", notes=notes)

    def _target(self, where: Any, twist: Any, frame: str) -> Motion:
        """The requested motion in the world. Source for the twist's axes: gazebo_ros."""
        placed = pose(where, "pose")
        linear = vector(twist.linear, "twist.linear")
        angular = vector(twist.angular, "twist.angular")
        self._simulation.refresh()
        base = self._entities.frame(frame).pose
        turn = base.orientation
        return Motion(base @ placed, rotate(turn, linear), rotate(turn, angular))

    def _put(self, model: str, target: Motion) -> tuple[str, ...]:
        for value in target.pose.position:
            number(value, "the pose in the world")
        self._simulation.set_state(model, target.pose, linear=target.linear, angular=target.angular)
        if not self._simulation.moves(model) and any((*target.linear, *target.angular)):
            return (f'the twist has no effect because model "{model}" is fixed to the world',)
        return ()

    def set_model_configuration(self, request: Any) -> Answer:
        description = self._entities.model(request.model_name)
        names, positions = list(request.joint_names), list(request.joint_positions)
        if len(names) != len(positions):
            raise CartwheelError(
                f"the numbers of joint names ({len(names)}) and positions "
                f"({len(positions)}) differ",
                code=REQUEST_INVALID,
                values={"names": len(names), "positions": len(positions)},
            )
        wanted: dict[str, float] = {}
        notes = []
        for name, position in zip(names, positions, strict=True):
            own = name.removeprefix(f"{request.model_name}::")
            value = number(position, f'the position of "{name}"')
            joint = description.joint(own)
            if joint is not None and joint.type == "fixed":
                notes.append(f'joint "{own}" is fixed')
                continue
            wanted[own] = value if joint is None else bounded(joint, value)
            if wanted[own] != value:
                notes.append(f'joint "{own}" stops at its limit of {wanted[own]:g}')
        self._simulation.set_joint_positions(request.model_name, wanted)
        return Answer("SetModelConfiguration: success", notes=tuple(notes))


class StateTopics:
    """``model_states`` and ``link_states``, published at every step while there are subscribers."""

    def __init__(
        self, simulation: Simulation, graph: Graph, node: str, *, prefix: str = "/gazebo"
    ) -> None:
        self._simulation = simulation
        rate = 1e9 / simulation.step_ns
        self._models = graph.advertise(
            f"{prefix}/model_states", "gazebo_msgs/msg/ModelStates", node=node, rate=rate
        )
        self._links = graph.advertise(
            f"{prefix}/link_states", "gazebo_msgs/msg/LinkStates", node=node, rate=rate
        )
        self._version = -1
        self._Pose = message_class("geometry_msgs/msg/Pose")
        self._Point = message_class("geometry_msgs/msg/Point")
        self._Quaternion = message_class("geometry_msgs/msg/Quaternion")
        self._Twist = message_class("geometry_msgs/msg/Twist")
        self._Vector3 = message_class("geometry_msgs/msg/Vector3")
        self._ModelStates = message_class("gazebo_msgs/msg/ModelStates")
        self._LinkStates = message_class("gazebo_msgs/msg/LinkStates")
        self._task = simulation.schedule(0, after=self._publish, topics=[self._models, self._links])

    def close(self) -> None:
        """Removes the topics."""
        self._simulation.unschedule(self._task)
        self._models.close()
        self._links.close()

    def _publish(self) -> None:
        if self._version != self._simulation.scene.version:
            self._resolve()
        data = self._simulation.data
        bodies = self._bodies
        # MuJoCo stores a body's velocity at the centre of mass of its kinematic tree.
        arms = data.xpos[bodies] - data.subtree_com[self._roots]
        spatial = data.cvel[bodies]
        positions = data.xpos[bodies].tolist()
        quaternions = data.xquat[bodies].tolist()
        linear = (spatial[:, 3:] + np.cross(spatial[:, :3], arms)).tolist()
        angular = spatial[:, :3].tolist()
        if self._links.wanted:
            poses = [
                self._pose(position, quaternion)
                for position, quaternion in zip(positions, quaternions, strict=True)
            ]
            twists = [
                self._twist(moving, turning)
                for moving, turning in zip(linear, angular, strict=True)
            ]
            self._links.publish(self._LinkStates(self._link_names, poses, twists))
        if self._models.wanted:
            poses, twists = [], []
            for row, offset in self._canonical:
                if offset is None:
                    poses.append(self._pose(positions[row], quaternions[row]))
                    twists.append(self._twist(linear[row], angular[row]))
                    continue
                place = Pose(tuple(positions[row]), from_wxyz(quaternions[row]))
                link = Motion(place, tuple(linear[row]), tuple(angular[row]))
                motion = link.carried(offset)
                poses.append(pose_message(motion.pose))
                twists.append(twist_message(motion.linear, motion.angular))
            self._models.publish(self._ModelStates(self._model_names, poses, twists))

    def _pose(self, position: list[float], quaternion: list[float]) -> Any:
        qw, qx, qy, qz = quaternion
        return self._Pose(self._Point(*position), self._Quaternion(qx, qy, qz, qw))

    def _twist(self, linear: list[float], angular: list[float]) -> Any:
        return self._Twist(self._Vector3(*linear), self._Vector3(*angular))

    def _resolve(self) -> None:
        simulation = self._simulation
        scene = simulation.scene
        self._version = scene.version
        self._bodies = [simulation.engine.body_id(*names) for names in scene.links]
        self._roots = simulation.model.body_rootid[self._bodies]
        self._link_names = [scoped(*names) for names in scene.links]
        self._model_names = [placed.name for placed in scene.models]
        self._canonical: list[tuple[int, Pose | None]] = []
        for placed in scene.models:
            description = placed.description
            row = scene.links.index((placed.name, description.canonical_link))
            offset = description.canonical_pose.inverse()
            self._canonical.append((row, None if offset == Pose() else offset))


class StateCommands:
    """The ``set_model_state`` and ``set_link_state`` topics."""

    def __init__(
        self, states: States, graph: Graph, node: str, report: Callable[[Diagnostic], None]
    ) -> None:
        self._report = report
        self._subscriptions: list[Subscription] = []
        for name, kind, field, handler in (
            ("set_model_state", "ModelState", "model_state", states.set_model_state),
            ("set_link_state", "LinkState", "link_state", states.set_link_state),
        ):
            request = message_class(f"gazebo_msgs/srv/Set{kind}_Request")
            self._subscriptions.append(
                graph.subscribe(
                    f"/gazebo/{name}",
                    self._callback(name, field, request, handler),
                    type_name=f"gazebo_msgs/msg/{kind}",
                    node=node,
                )
            )

    def close(self) -> None:
        """Removes both subscriptions."""
        for subscription in self._subscriptions:
            subscription.close()

    def _callback(
        self, name: str, field: str, request: Any, handler: Callable[[Any], Answer]
    ) -> Callable[[Any], None]:
        def take(message: Any) -> None:
            try:
                handler(request(**{field: message}))
            except CartwheelError as error:
                self._report(failed(f"/gazebo/{name}", error))

        return take
