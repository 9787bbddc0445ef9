"""Every service and state topic under /gazebo, called from a node of ROS 1, by its effect."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import pytest

CLIENT = """
import json, time, rospy
from gazebo_msgs.msg import LinkState, ModelState, ModelStates, ODEJointProperties, ODEPhysics
from gazebo_msgs.srv import *
from geometry_msgs.msg import Point, Pose, Quaternion, Twist, Vector3, Wrench
from std_msgs.msg import ColorRGBA
from std_srvs.srv import Empty

rospy.init_node("client")
known = {
    "apply_body_wrench": ApplyBodyWrench, "apply_joint_effort": ApplyJointEffort,
    "clear_body_wrenches": BodyRequest, "clear_joint_forces": JointRequest,
    "delete_light": DeleteLight, "delete_model": DeleteModel,
    "get_joint_properties": GetJointProperties, "get_light_properties": GetLightProperties,
    "get_link_properties": GetLinkProperties, "get_link_state": GetLinkState,
    "get_model_properties": GetModelProperties, "get_model_state": GetModelState,
    "get_physics_properties": GetPhysicsProperties, "get_world_properties": GetWorldProperties,
    "pause_physics": Empty, "reset_simulation": Empty, "reset_world": Empty,
    "set_joint_properties": SetJointProperties, "set_light_properties": SetLightProperties,
    "set_link_properties": SetLinkProperties, "set_link_state": SetLinkState,
    "set_model_configuration": SetModelConfiguration, "set_model_state": SetModelState,
    "set_physics_properties": SetPhysicsProperties, "spawn_sdf_model": SpawnModel,
    "spawn_urdf_model": SpawnModel, "unpause_physics": Empty,
}
called, reported = set(), {}

def call(name, *arguments, **fields):
    called.add(name)
    rospy.wait_for_service("/gazebo/" + name, 30)
    return rospy.ServiceProxy("/gazebo/" + name, known[name])(*arguments, **fields)

def yes(name, *arguments, **fields):
    answer = call(name, *arguments, **fields)
    assert answer.success, (name, answer.status_message)
    return answer

def no(name, *arguments, **fields):
    answer = call(name, *arguments, **fields)
    assert not answer.success, name
    return answer.status_message

def at(x=0.0, y=0.0, z=0.0):
    return Pose(Point(x, y, z), Quaternion(0, 0, 0, 1))

def place(model, frame=""):
    return yes("get_model_state", model, frame)

def now():
    return yes("get_world_properties").sim_time

URDF = '''<robot name="box"><link name="base"><inertial><mass value="2"/>
  <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><geometry><box size="0.4 0.4 0.4"/></geometry></collision></link>
  <gazebo reference="base"><mu1>0</mu1><mu2>0</mu2></gazebo></robot>'''
SDF = '''<sdf version="1.6"><model name="arm"><link name="foot"/>
  <joint name="stand" type="fixed"><parent>world</parent><child>foot</child></joint>
  <link name="bar"><pose>0 0 1 0 0 0</pose><inertial><mass>1</mass>
  <inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial></link>
  <joint name="hinge" type="revolute"><parent>foot</parent><child>bar</child>
  <axis><xyz>0 0 1</xyz></axis></joint></model></sdf>'''

yes("spawn_urdf_model", "box", URDF, "", at(3, 0, 0.2), "world")
yes("spawn_sdf_model", "arm", SDF, "", at(0, 3, 0), "box")
reported["taken"] = no("spawn_urdf_model", "box", URDF, "", at(), "world")
reported["broken"] = no("spawn_urdf_model", "worse", URDF.replace("</link>", ""), "", at(), "world")
world = yes("get_world_properties")
reported["models"] = list(world.model_names)
reported["arm"] = place("arm").pose.position.x, place("arm").pose.position.y
reported["in the box"] = place("arm", "box").pose.position.y
model = yes("get_model_properties", "arm")
reported["bodies"], reported["joints"] = list(model.body_names), list(model.joint_names)
reported["who"] = no("get_model_state", "bax", "")

# States.
call("pause_physics")
held = now()
time.sleep(0.3)
reported["held"] = now() == held
moving = Twist(Vector3(1, 0, 0), Vector3())
yes("set_model_state", ModelState("box", at(1, 1, 0.2), moving, "world"))
reported["set"] = place("box").pose.position.x, place("box").twist.linear.x
reported["link"] = yes("get_link_state", "box::base", "").link_state.pose.position.y
yes("set_link_state", LinkState("box::base", at(2, 1, 0.2), Twist(), "world"))
reported["moved"] = place("box").pose.position.x
yes("set_model_configuration", "arm", "", ["hinge"], [0.5])
reported["turned"] = yes("get_joint_properties", "hinge").position[0]
for topic, kind, message in (
    ("set_model_state", ModelState, ModelState("box", at(5, 1, 0.2), Twist(), "world")),
    ("set_link_state", LinkState, LinkState("box::base", at(6, 2, 0.2), Twist(), "world")),
):
    publisher = rospy.Publisher("/gazebo/" + topic, kind, queue_size=1)
    until = time.monotonic() + 120
    while publisher.get_num_connections() == 0 and time.monotonic() < until:
        time.sleep(0.05)
    publisher.publish(message)
    while place("box").pose.position.x < 4.9 + (topic == "set_link_state"):
        assert time.monotonic() < until, topic
        time.sleep(0.05)
reported["by topic"] = place("box").pose.position.x, place("box").pose.position.y

# Properties.
link = yes("get_link_properties", "box::base")
reported["mass"] = link.mass
yes("set_link_properties", "box::base", link.com, False, 4.0, 0.2, 0, 0, 0.2, 0, 0.2)
link = yes("get_link_properties", "box::base")
reported["heavier"] = link.mass, link.ixx, link.gravity_mode
yes("set_joint_properties", "hinge", ODEJointProperties(damping=[0.5]))
reported["damping"] = yes("get_joint_properties", "hinge").damping[0]
light = yes("get_light_properties", "sun")
yes("set_light_properties", "sun", True, ColorRGBA(0.1, 0.2, 0.3, 1),
    ColorRGBA(0, 0, 0, 1), light.attenuation_constant, light.attenuation_linear,
    light.attenuation_quadratic,
    Vector3(0.2, 0.1, -0.9), at(0, 0, 10))
reported["light"] = yes("get_light_properties", "sun").diffuse.b
yes("delete_light", "sun")
reported["dark"] = no("get_light_properties", "sun")
physics = yes("get_physics_properties")
reported["paused"], reported["gravity"] = physics.pause, physics.gravity.z
yes("set_physics_properties", physics.time_step, physics.max_update_rate, Vector3(0, 0, -1.6),
    physics.ode_config)
reported["moon"] = yes("get_physics_properties").gravity.z

# Forces: the momentum of 8 N for 0.5 s on 4 kg without friction or weight.
start = rospy.Time(now())
yes("apply_body_wrench", "box::base", "", Point(), Wrench(Vector3(8, 0, 0), Vector3()),
    rospy.Time(0), rospy.Duration(0.5))
yes("apply_body_wrench", "box::base", "", Point(), Wrench(Vector3(0, 8, 0), Vector3()),
    rospy.Time(0), rospy.Duration(-1))
yes("apply_joint_effort", "hinge", 0.3, rospy.Time(0), rospy.Duration(-1))
call("unpause_physics")
while now() < start.to_sec() + 1.0:
    time.sleep(0.05)
moving = place("box").twist.linear
reported["speed"] = moving.x, moving.y > 0.5
call("clear_body_wrenches", "box::base")
call("clear_joint_forces", "hinge")
reported["effort"] = yes("get_joint_properties", "hinge").rate[0] > 0.1
first = place("box").twist.linear.y
began = now()
while now() < began + 0.3:
    time.sleep(0.05)
reported["coasts"] = abs(place("box").twist.linear.y - first) < 0.05

# Time and the end.
call("reset_world")
reported["back"] = abs(place("box").pose.position.x - 3.0) < 0.05
reported["goes on"] = now() > 1.0
last = now()
call("reset_simulation")
reported["again"] = now() < last - 0.5
yes("delete_model", "box")
reported["gone"] = no("delete_model", "box")
reported["left"] = sorted(set(known) - called)
print(json.dumps(reported))
"""


@pytest.fixture
def reported(ros: Any, tmp_path: Path) -> dict[str, Any]:
    ros.master()
    program = Path(sys.executable).with_name("cartwheel")
    ros.start(program, "run", "empty", "--headless", "--ros1")
    file = tmp_path / "client.py"
    file.write_text(CLIENT)
    done = ros.run("/usr/bin/python3", file)
    answer: dict[str, Any] = json.loads(done.stdout.strip().splitlines()[-1])
    return answer


def test_each_service_acts(reported: dict[str, Any]) -> None:
    assert reported["left"] == []
    assert "box" in reported["taken"]
    assert "line" in reported["broken"] or ":" in reported["broken"]
    assert {"ground_plane", "box", "arm"} <= set(reported["models"])
    assert reported["arm"] == pytest.approx((3.0, 3.0))
    assert reported["in the box"] == pytest.approx(3.0, abs=1e-6)
    assert {"foot", "bar"} <= set(reported["bodies"])
    assert "hinge" in reported["joints"]
    assert "box" in reported["who"]
    assert reported["held"]
    assert reported["set"] == pytest.approx((1.0, 1.0))
    assert reported["link"] == pytest.approx(1.0)
    assert reported["moved"] == pytest.approx(2.0)
    assert reported["turned"] == pytest.approx(0.5)
    assert reported["by topic"] == pytest.approx((6.0, 2.0))
    assert reported["mass"] == 2.0
    assert reported["heavier"] == [4.0, 0.2, False]
    assert reported["damping"] == 0.5
    assert reported["light"] == pytest.approx(0.3)
    assert "sun" in reported["dark"]
    assert reported["paused"] is True
    assert reported["gravity"] == -9.8
    assert reported["moon"] == -1.6
    speed, pushed = reported["speed"]
    assert speed == pytest.approx(8 * 0.5 / 4, rel=1e-3)
    assert pushed
    assert reported["effort"]
    assert reported["coasts"]
    assert reported["back"]
    assert reported["goes on"]
    assert reported["again"]
    assert "box" in reported["gone"]
