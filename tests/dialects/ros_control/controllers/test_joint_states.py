"""Joint states as ROS 2's broadcaster publishes them."""

import math

import pytest
import yaml
from tests.coded import coded
from tests.dialects.ros_control.arms import (
    beam,
    robot,
    ros2_joint,
    ros2_parameters,
    ros2_plugin,
    ros2_system,
)

from cartwheel.codes import devices
from cartwheel.messages import encode_cdr

TYPE = "joint_state_broadcaster/JointStateBroadcaster"
UPRIGHT = "0 0 1"


@pytest.fixture
def reported(bench, tmp_path):
    """The last message of a broadcaster of two joints, the first of them at 0.4 rad."""

    def make(topic, **settings):
        file = tmp_path / "own.yaml"
        group = {"type": "position_controllers/JointGroupPositionController", "joints": ["a_joint"]}
        file.write_text(yaml.safe_dump(ros2_parameters(states={"type": TYPE, **settings}, c=group)))
        body = beam("a", "world", axis=UPRIGHT) + beam("b", "world", axis=UPRIGHT, origin="0 1 1")
        system = ros2_system(
            ros2_joint("a_joint", extra='<state_interface name="effort"/>'), ros2_joint("b_joint")
        )
        made = bench(robot(body + system, ros2_plugin(file)))
        made.publish("/c/commands", "std_msgs/msg/Float64MultiArray", data=[0.4])
        box = made.box(topic)
        made.world.run(1.0)
        messages = box.drain()
        box.close()
        return messages[-1], made

    return make


def test_all_interfaces_are_reported_by_name(reported):
    message, made = reported("/dynamic_joint_states", extra_joints=["wheel"])
    assert message.joint_names == ["a_joint", "b_joint", "wheel"]
    first, second, extra = message.interface_values
    assert first.interface_names == ["position", "velocity", "effort"]
    assert list(first.values) == pytest.approx([0.4, 0.0, 0.0], abs=0.01)
    assert second.interface_names == ["position", "velocity"]
    assert list(extra.values) == [0.0, 0.0, 0.0]
    assert message.header.frame_id == "base_link"
    assert made.warnings == []


@pytest.mark.parametrize("topic", ["/joint_states", "/dynamic_joint_states"])
def test_recorders_receive_the_bytes_of_the_same_message(reported, topic):
    message, made = reported(topic, extra_joints=["wheel"])
    taken = []
    made.world.graph.subscribe(topic, print, take_values=lambda *given: taken.append(given))
    made.world.run(0.1)
    form, values = taken[-1]
    same = form.message(values)
    assert form.encode(values) == encode_cdr(same)
    assert same.header.frame_id == message.header.frame_id
    assert len(encode_cdr(same)) == len(encode_cdr(message))  # the same names and lengths


def test_joints_and_interfaces_are_chosen_together(reported):
    message, made = reported("/joint_states", joints=["a_joint"], interfaces=["position"])
    assert message.name == ["a_joint"]
    assert list(message.position) == pytest.approx([0.4], abs=1e-3)
    assert [math.isnan(each) for each in (*message.velocity, *message.effort)] == [True, True]
    assert made.warnings == []


def test_joints_alone_choose_nothing(reported):
    message, made = reported("/joint_states", joints=["a_joint"])
    assert message.name == ["a_joint", "b_joint"]
    (reported,) = coded(made.warnings, devices.CONTROLLER_PARAMETER_UNKNOWN)
    assert reported.values["parameters"][0] == "joints"


def test_topics_may_be_below_the_broadcaster(reported):
    message, _ = reported("/states/joint_states", use_local_topics=True, frame_id="torso")
    assert message.header.frame_id == "torso"
    message, _ = reported("/states/dynamic_joint_states", use_local_topics=True)
    assert message.joint_names == ["a_joint", "b_joint"]


def test_a_field_may_be_another_interface(reported):
    message, made = reported(
        "/joint_states",
        map_interface_to_joint_state={"velocity": "position", "effort": "current"},
    )
    assert list(message.velocity) == list(message.position)
    assert all(math.isnan(each) for each in message.effort)
    assert coded(made.warnings, devices.INTERFACE_UNKNOWN, interface="current")


def test_the_interfaces_need_not_be_stated(reported):
    _, made = reported("/joint_states", publish_dynamic_joint_states=False)
    assert "/dynamic_joint_states" not in {each.name for each in made.world.graph.topics()}
