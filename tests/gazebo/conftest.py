"""The API on a world that the test's thread owns."""

import threading

import numpy as np
import pytest
from tests.coded import coded

from cartwheel.codes.graph import SERVICE_FAILED
from cartwheel.errors import one_line
from cartwheel.gazebo import GazeboApi, requests, resources, results, simulation_interfaces
from cartwheel.messages import encode_cdr, from_dict

# As a Gazebo 11 lists them, types in ROS 2's spelling.
SERVICES = {
    "apply_body_wrench": "ApplyBodyWrench",
    "apply_joint_effort": "ApplyJointEffort",
    "clear_body_wrenches": "BodyRequest",
    "clear_joint_forces": "JointRequest",
    "delete_light": "DeleteLight",
    "delete_model": "DeleteModel",
    "get_joint_properties": "GetJointProperties",
    "get_light_properties": "GetLightProperties",
    "get_link_properties": "GetLinkProperties",
    "get_link_state": "GetLinkState",
    "get_model_properties": "GetModelProperties",
    "get_model_state": "GetModelState",
    "get_physics_properties": "GetPhysicsProperties",
    "get_world_properties": "GetWorldProperties",
    "set_joint_properties": "SetJointProperties",
    "set_light_properties": "SetLightProperties",
    "set_link_properties": "SetLinkProperties",
    "set_link_state": "SetLinkState",
    "set_model_configuration": "SetModelConfiguration",
    "set_model_state": "SetModelState",
    "set_physics_properties": "SetPhysicsProperties",
    "spawn_sdf_model": "SpawnModel",
    "spawn_urdf_model": "SpawnModel",
}
EMPTY = ("pause_physics", "unpause_physics", "reset_simulation", "reset_world")
URDF = """<?xml version="1.0"?>
<robot name="brick">
  <link name="body">
    <inertial><mass value="2"/>
      <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision>
  </link>
</robot>"""
SDF = """<sdf version="1.6"><model name="brick"><pose>0 0 0.5 0 0 0</pose>
  <link name="body"><inertial><mass>2</mass></inertial>
    <collision name="c"><geometry><box><size>0.2 0.2 0.2</size></box></geometry></collision>
  </link></model></sdf>"""
CHAIN = """<model name="chain"><pose>0 0 4 0 0 0</pose>
    <link name="body"><inertial><mass>2</mass>
      <inertia><ixx>.1</ixx><iyy>.1</iyy><izz>.1</izz></inertia></inertial></link>
    <link name="arm"><pose>1 0 0 0 0 0</pose><inertial><mass>1</mass>
      <inertia><ixx>.1</ixx><iyy>.1</iyy><izz>.1</izz></inertia></inertial></link>
    <joint name="elbow" type="revolute"><pose>-0.5 0 0 0 0 0</pose>
      <parent>body</parent><child>arm</child>
      <axis><xyz>0 0 1</xyz><limit><lower>-2</lower><upper>2</upper></limit></axis></joint>
    <link name="tip"><pose>1.5 0 0 0 0 0</pose></link>
    <joint name="glue" type="fixed"><parent>arm</parent><child>tip</child></joint></model>"""


class Gazebo:
    """Calls services as another thread would, while this one owns the simulation."""

    def __init__(self, world, *, api=GazeboApi, prefix="/gazebo", **more):
        self.world = world
        self.prefix = prefix
        self.simulation = world.session.simulation
        self.api = api(world.session, **more)
        self.api.start()

    def request(self, name, /, **fields):
        service = self.world.graph.service(f"{self.prefix}/{name}")
        return from_dict(f"{service.type}_Request", fields)

    def __call__(self, name, /, request=None, **fields):
        request = self.request(name, **fields) if request is None else request
        found = []
        thread = threading.Thread(
            target=lambda: found.append(self.world.graph.call(f"{self.prefix}/{name}", request))
        )
        thread.start()
        while thread.is_alive():
            self.simulation.drain()
            thread.join(0.001)
        self.simulation.drain()
        answer = found[0].result(timeout=60)
        # Whichever wire it goes out on.
        encode_cdr(answer)
        return answer

    def done(self, name, /, **fields):
        """The answer of a call that must succeed."""
        answer = self(name, **fields)
        assert answer.success, answer.status_message
        return answer

    def fails(self, name, code, /, values=None, **fields):
        """A call that must fail with an error of this code, and these values among its own.

        The answer must contain the error's text, or the error must be reported.
        """
        errors = []

        def recorded(error):
            errors.append(error)
            return one_line(error)

        with pytest.MonkeyPatch.context() as patch:
            for module in (requests, resources, results, simulation_interfaces):
                patch.setattr(module, "one_line", recorded)
            answer = self(name, **fields)
        (error,) = errors
        assert error.code is code, repr(error)
        assert {**error.values, **(values or {})} == dict(error.values)
        if hasattr(answer, "result"):
            assert one_line(error) in answer.result.error_message
            return
        assert not answer.success
        if hasattr(answer, "status_message"):
            assert answer.status_message.endswith(one_line(error))
        else:
            assert coded(self.world, SERVICE_FAILED, cause=code.number, **(values or {}))

    def refused(self, name, /, **fields):
        """The message of a call that must fail, and changes nothing."""
        before = self.simulation.data.qpos.copy(), self.simulation.data.qvel.copy()
        models = self.simulation.models
        answer = self(name, **fields)
        assert not answer.success
        assert self.simulation.models == models
        assert (self.simulation.data.qpos == before[0]).all()
        assert (self.simulation.data.qvel == before[1]).all()
        return answer.status_message


def notes(answer):
    """What a successful answer says besides Gazebo's own status."""
    return answer.status_message.split("; ")[1:]


def vec(v):
    return np.array([v.x, v.y, v.z])


def xyz(v):
    return dict(zip("xyz", map(float, v), strict=True))


def pose_fields(position, orientation=(0, 0, 0, 1)):
    return {
        "position": xyz(position),
        "orientation": dict(zip("xyzw", map(float, orientation), strict=True)),
    }


@pytest.fixture
def gazebo():
    """Makes an API for a world."""
    return Gazebo
