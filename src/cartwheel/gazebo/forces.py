"""Services for wrenches on links and efforts on joints."""

from __future__ import annotations

from typing import Any

import numpy as np

from cartwheel.codes.graph import ENTITY_FIXED
from cartwheel.errors import GraphError
from cartwheel.gazebo.entities import INERTIAL, Entities
from cartwheel.gazebo.requests import Answer, Offer, named, vector
from cartwheel.geometry import cross, rotate
from cartwheel.messages import nanoseconds
from cartwheel.simulation import Simulation
from cartwheel.simulation.limits import STRONGEST, number


class Pushes:
    """Wrenches on links and efforts on joints, with the services of ROS 1 and ROS 2.

    A wrench is converted to world axes when it is requested, and does not rotate with the body. In
    the world frame and in the body's own frame, the reference point is relative to the body's
    centre of mass. In any other frame, it is a point in that frame. Source: gazebo_ros,
    ``applyBodyWrench``; gazebo_ros_force_system.
    """

    def __init__(self, simulation: Simulation, entities: Entities) -> None:
        self._simulation = simulation
        self._entities = entities

    def offers(self) -> list[Offer]:
        """The ROS 1 services."""
        return [
            *named(self.apply_body_wrench, self.apply_joint_effort),
            Offer("clear_body_wrenches", "gazebo_msgs/srv/BodyRequest", self.clear_body_wrenches),
            Offer("clear_joint_forces", "gazebo_msgs/srv/JointRequest", self.clear_joint_efforts),
        ]

    def ros2_offers(self) -> list[Offer]:
        """The ROS 2 services."""
        return [
            *named(self.apply_link_wrench, self.apply_joint_effort),
            Offer("clear_link_wrenches", "gazebo_msgs/srv/LinkRequest", self.clear_link_wrenches),
            Offer("clear_joint_efforts", "gazebo_msgs/srv/JointRequest", self.clear_joint_efforts),
        ]

    def apply_body_wrench(self, request: Any) -> Answer:
        self._push(request.body_name, request)
        return Answer("ApplyBodyWrench: wrench set")

    def apply_link_wrench(self, request: Any) -> Answer:
        self._push(request.link_name, request)
        return Answer("ApplyLinkWrench: wrench set")

    def _push(self, name: str, request: Any) -> None:
        simulation = self._simulation
        model, link = self._entities.link(name)
        force = vector(request.wrench.force, "wrench.force", most=STRONGEST)
        torque = vector(request.wrench.torque, "wrench.torque", most=STRONGEST)
        point = vector(request.reference_point, "reference_point")
        simulation.refresh()
        body = simulation.engine.body_id(model, link.name)
        if simulation.model.body_treeid[body] < 0:
            raise GraphError(
                f'link "{link.name}" of "{model}" is fixed to the world',
                code=ENTITY_FIXED,
                values={"model": model, "link": link.name},
            )
        frame = self._entities.frame(request.reference_frame).pose
        own = self._entities.link_motion(model, link.name).pose
        turned = rotate(frame.orientation, force)
        if request.reference_frame in INERTIAL or frame == own:
            arm = np.array(rotate(frame.orientation, point))
        else:
            arm = np.subtract(frame.apply(point), simulation.data.xipos[body])
        moment = np.add(rotate(frame.orientation, torque), cross(arm, turned))
        x, y, z = moment.tolist()
        start, duration = _span(request)
        simulation.forces.wrench(
            model, link.name, force=turned, torque=(x, y, z), start_ns=start, duration_ns=duration
        )

    def clear_body_wrenches(self, request: Any) -> Answer:
        return self._clear_wrenches(request.body_name)

    def clear_link_wrenches(self, request: Any) -> Answer:
        return self._clear_wrenches(request.link_name)

    def _clear_wrenches(self, name: str) -> Answer:
        model, link = self._entities.link(name)
        self._simulation.forces.clear_wrenches(model, link.name)
        return Answer()

    def apply_joint_effort(self, request: Any) -> Answer:
        model, joint = self._entities.joint(request.joint_name)
        effort = number(request.effort, "effort", most=STRONGEST)
        if (model, joint.name) not in self._simulation.scene.joints:
            raise GraphError(
                f'joint "{joint.name}" of "{model}" cannot be moved by a force or torque because '
                f"it is {joint.type} or its model is static",
                code=ENTITY_FIXED,
                values={"model": model, "joint": joint.name},
            )
        notes: tuple[str, ...] = ()
        limit = joint.axis.effort
        if limit is not None and 0 < limit < abs(effort):
            effort = float(np.copysign(limit, effort))
            notes = (f"the joint's effort limit reduces the effort to {effort:g}",)
        start, duration = _span(request)
        self._simulation.forces.effort(
            model, joint.name, effort, start_ns=start, duration_ns=duration
        )
        return Answer("ApplyJointEffort: effort set", notes=notes)

    def clear_joint_efforts(self, request: Any) -> Answer:
        model, joint = self._entities.joint(request.joint_name)
        self._simulation.forces.clear_efforts(model, joint.name)
        return Answer()


def _span(request: Any) -> tuple[int, int | None]:
    """Start and duration, ns; None for no end."""
    duration = nanoseconds(request.duration)
    return nanoseconds(request.start_time), None if duration < 0 else duration
