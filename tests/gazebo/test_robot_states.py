"""The published transforms of links, compared with the simulation."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
import pytest
from tests.coded import coded

from cartwheel.codes.graph import FRAMES_SHARED
from cartwheel.description import load_robot, load_text, load_world
from cartwheel.gazebo.robot_descriptions import RobotDescriptions
from cartwheel.gazebo.robot_states import RobotStates
from cartwheel.geometry import Pose
from cartwheel.session import Session
from cartwheel.simulation.simulation import Simulation

TF = "tf2_msgs/msg/TFMessage"
ARM = """<?xml version="1.0"?>
<robot name="arm">
  <link name="base"/>
  <link name="upper"><inertial><mass value="1"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="tip"/>
  <joint name="shoulder" type="revolute">
    <parent link="base"/><child link="upper"/><origin xyz="0 0 1" rpy="0 0 0.5"/>
    <axis xyz="0 0 1"/><limit lower="-3" upper="3" effort="1" velocity="1"/>
  </joint>
  <joint name="glue" type="fixed">
    <parent link="upper"/><child link="tip"/><origin xyz="0.4 0 0"/>
  </joint>
</robot>"""


class Listener:
    """All transforms of a session."""

    def __init__(self, session: Session) -> None:
        self.moving: list[Any] = []
        self.static: list[Any] = []
        session.graph.subscribe("/tf", self._moving, type_name=TF, node="test")
        session.graph.subscribe("/tf_static", self._static, type_name=TF, node="test")

    def _moving(self, message: Any) -> None:
        self.moving += message.transforms

    def _static(self, message: Any) -> None:
        self.static = list(message.transforms)

    def pose(self, child: str) -> Pose:
        """Of a frame in the root of its tree, by the last transforms."""
        last = {one.child_frame_id: one for one in (*self.static, *self.moving)}
        pose = Pose()
        while child in last:
            one = last[child].transform
            t, q = one.translation, one.rotation
            pose = Pose((t.x, t.y, t.z), (q.x, q.y, q.z, q.w)) @ pose
            child = last[child].header.frame_id
        return pose


def states_of(session: Session) -> RobotStates:
    descriptions = RobotDescriptions(session.simulation, session.graph)
    return RobotStates(session.simulation, session.graph, descriptions)


def session_with(*robots: tuple[str, Any]) -> Session:
    session = Session(load_world("empty"))
    for name, robot in robots:
        session.spawn(robot, name=name)
    return session


def test_the_cart_is_one_tree_and_nothing_is_reported_twice() -> None:
    session = session_with(("rosbots", load_robot("rosbots.xacro")))
    states_of(session)
    heard = Listener(session)
    session.simulation.advance(2 * 10**9)
    parents: dict[str, set[str]] = {}
    for one in (*heard.moving, *heard.static):
        parents.setdefault(one.child_frame_id, set()).add(one.header.frame_id)
    assert all(len(names) == 1 for names in parents.values()), parents
    links = {link.name for link in load_robot("rosbots.xacro").links}
    assert set(parents) == links, "the root's parent is odom"
    roots = {next(iter(names)) for names in parents.values()} - set(parents)
    assert roots == {"odom"}
    reported = Counter(
        (one.child_frame_id, one.header.stamp.sec, one.header.stamp.nanosec) for one in heard.moving
    )
    assert max(reported.values()) == 1
    assert Counter(one.child_frame_id for one in heard.static).most_common(1)[0][1] == 1
    static = {one.child_frame_id for one in heard.static}
    assert not static & {one.child_frame_id for one in heard.moving}
    session.close()


def test_a_joint_is_where_it_was_turned_to() -> None:
    session = session_with(("arm", load_text(ARM, file="arm.urdf")))
    states_of(session)
    heard = Listener(session)
    session.simulation.set_joint_positions("arm", {"shoulder": 0.7})
    session.simulation.advance(10**8)
    angle = session.simulation.joint_position("arm", "shoulder")
    assert angle == pytest.approx(0.7, abs=0.05)
    # 0.5 rad of the joint's origin and what it turned, about z, 0.4 m out and 1 m up.
    expected = (0.4 * np.cos(0.5 + angle), 0.4 * np.sin(0.5 + angle), 1.0)
    assert heard.pose("tip").position == pytest.approx(expected, abs=1e-3)
    session.close()


def test_it_makes_way_and_steps_in() -> None:
    session = session_with(("arm", load_text(ARM, file="arm.urdf")))
    states = states_of(session)
    heard = Listener(session)
    descriptions: list[Any] = []
    session.graph.subscribe("/robot_description", descriptions.append, node="test")
    session.simulation.advance(10**8)
    assert [each.data for each in descriptions] == [load_text(ARM, file="arm.urdf").text]
    assert {one.child_frame_id for one in heard.static} == {"tip"}
    states.leave_to_others(frozenset({"/robot_description"}))
    before = len(heard.moving)
    session.simulation.advance(3 * 10**8)
    assert (len(heard.moving), heard.static) == (before, [])
    # Those who show the robot, or record it, go by it still.
    assert session.graph.topic("/robot_description").publishers
    assert not session.graph.topic("/tf").publishers
    states.leave_to_others(frozenset())
    session.simulation.advance(5 * 10**8)
    assert len(heard.moving) > before
    assert {one.child_frame_id for one in heard.static} == {"tip"}
    session.close()


def test_a_robot_that_another_describes_is_left_to_it_alone() -> None:
    session = Session(load_world("empty"))
    robot = load_text(ARM, file="arm.urdf")
    for name in ("a", "b"):
        session.spawn(robot, name=name, namespace=name, frame_prefix=f"{name}/")
    states = states_of(session)
    heard = Listener(session)
    session.simulation.advance(10**8)
    assert {one.child_frame_id for one in heard.static} == {"a/tip", "b/tip"}
    states.leave_to_others(frozenset({"/b/robot_description"}))
    heard.moving.clear()
    session.simulation.advance(3 * 10**8)
    assert {one.child_frame_id for one in (*heard.static, *heard.moving)} == {"a/upper", "a/tip"}
    session.close()


def test_a_second_robot_of_the_same_frames_is_left_out_and_reported() -> None:
    arm = load_text(ARM, file="arm.urdf")
    session = session_with(("one", arm), ("two", arm))
    states_of(session)
    (shared,) = coded(session.diagnostics, FRAMES_SHARED)
    assert shared.values["model"] == "two"
    session.close()


def test_nothing_is_made_for_nobody_and_a_deleted_robot_is_gone(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    session = session_with(("arm", load_text(ARM, file="arm.urdf")))
    states = states_of(session)
    asked: list[str] = []
    position = Simulation.joint_position

    def counted(simulation: Simulation, model: str, joint: str) -> float:
        asked.append(joint)
        return position(simulation, model, joint)

    monkeypatch.setattr(Simulation, "joint_position", counted)
    session.simulation.advance(10**8)
    assert not asked
    heard = Listener(session)
    session.simulation.advance(2 * 10**8)
    assert asked
    assert heard.moving
    session.simulation.delete("arm")
    session.simulation.advance(5 * 10**8)
    assert heard.static == []
    states.close()
    session.close()


def test_nothing_is_computed_if_plugins_publish_all_joints(monkeypatch: pytest.MonkeyPatch) -> None:
    session = session_with(("rosbots", load_robot("rosbots.xacro")))
    states_of(session)
    asked: list[bool] = []
    transforms = RobotStates.transforms
    monkeypatch.setattr(
        RobotStates, "transforms", lambda *given, **named: asked.append(True) or transforms(*given)
    )
    heard = Listener(session)
    session.simulation.advance(10**8)
    assert heard.moving
    assert not asked
    session.spawn(load_text(ARM, file="arm.urdf"), name="arm")
    session.simulation.advance(2 * 10**8)
    assert asked
    session.close()
