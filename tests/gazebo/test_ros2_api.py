"""The services and topics of gazebo_ros's ROS 2 branch, on a world that the test's thread owns."""

import math

import pytest
from tests.coded import coded
from tests.gazebo.conftest import Gazebo

import cartwheel as cw
from cartwheel.codes.graph import ENTITY_UNKNOWN, SERVICE_FAILED
from cartwheel.description import load_text
from cartwheel.description.model import Light
from cartwheel.errors import Origin
from cartwheel.gazebo.ros2_api import Ros2Api
from cartwheel.geometry import Pose

# Of gazebo_ros_init, gazebo_ros_factory, gazebo_ros_force_system and, in the root or in a namespace
# of their own, gazebo_ros_state and gazebo_ros_properties. Types in the graph's spelling.
ALWAYS = {
    "pause_physics": "std_srvs/srv/Empty",
    "unpause_physics": "std_srvs/srv/Empty",
    "reset_simulation": "std_srvs/srv/Empty",
    "reset_world": "std_srvs/srv/Empty",
    "spawn_entity": "gazebo_msgs/srv/SpawnEntity",
    "delete_entity": "gazebo_msgs/srv/DeleteEntity",
    "get_model_list": "gazebo_msgs/srv/GetModelList",
    "apply_link_wrench": "gazebo_msgs/srv/ApplyLinkWrench",
    "clear_link_wrenches": "gazebo_msgs/srv/LinkRequest",
    "apply_joint_effort": "gazebo_msgs/srv/ApplyJointEffort",
    "clear_joint_efforts": "gazebo_msgs/srv/JointRequest",
}
STATES = {
    "get_entity_state": "gazebo_msgs/srv/GetEntityState",
    "set_entity_state": "gazebo_msgs/srv/SetEntityState",
}
PROPERTIES = {
    "get_model_properties": "gazebo_msgs/srv/GetModelProperties",
    "get_joint_properties": "gazebo_msgs/srv/GetJointProperties",
    "get_link_properties": "gazebo_msgs/srv/GetLinkProperties",
    "get_light_properties": "gazebo_msgs/srv/GetLightProperties",
    "set_joint_properties": "gazebo_msgs_ros2/srv/SetJointProperties",
    "set_link_properties": "gazebo_msgs/srv/SetLinkProperties",
    "set_light_properties": "gazebo_msgs_ros2/srv/SetLightProperties",
}
CONTROLS = {
    "create": "ros_gz_interfaces/srv/SpawnEntity",
    "remove": "ros_gz_interfaces/srv/DeleteEntity",
    "set_pose": "ros_gz_interfaces/srv/SetEntityPose",
    "control": "ros_gz_interfaces/srv/ControlWorld",
}
WORLD = """<sdf version="1.6"><world name="w">
  <plugin name="state" filename="libgazebo_ros_state.so">
    <ros><namespace>/states</namespace></ros></plugin>
  <plugin name="properties" filename="libgazebo_ros_properties.so">
    <ros><namespace>/demo</namespace></ros></plugin>
</world></sdf>"""
ARM = """<model name="arm"><link name="base"/>
    <joint name="fix" type="fixed"><parent>world</parent><child>base</child></joint>
    <link name="bar"><inertial><mass>1</mass>
      <inertia><ixx>.5</ixx><iyy>.5</iyy><izz>.5</izz></inertia></inertial>
      <collision name="c"><geometry><sphere><radius>0.1</radius></sphere></geometry></collision>
    </link>
    <joint name="hinge" type="revolute"><parent>base</parent><child>bar</child>
      <axis><xyz>0 0 1</xyz><limit><lower>-2</lower><upper>2</upper></limit></axis></joint>
  </model>"""
LAMP = Light(name="lamp", type="point", pose=Pose((0, 0, 3)), origin=Origin(file="test.sdf"))
FOREVER = {"sec": -1}


def ros2(world: cw.World) -> Gazebo:
    return Gazebo(world, api=Ros2Api, prefix="")


def offered(api: Gazebo) -> dict[str, str]:
    services = api.world.graph.services()
    return {one.name: one.type for one in services if not one.name.startswith("/gz_server/")}


def below(prefix: str, names: dict[str, str]) -> dict[str, str]:
    return {f"{prefix}/{name}": kind for name, kind in names.items()}


def test_all_is_offered_without_plugins(make):
    api = ros2(make.world())
    assert offered(api) == (
        below("", ALWAYS | STATES | PROPERTIES)
        | below("/gazebo", STATES)
        | below("/world/test", CONTROLS)
    )
    topics = {info.name: info.type for info in api.world.graph.topics()}
    assert topics.items() >= {
        ("/model_states", "gazebo_msgs/msg/ModelStates"),
        ("/link_states", "gazebo_msgs/msg/LinkStates"),
        ("/performance_metrics", "gazebo_msgs/msg/PerformanceMetrics"),
    }
    api.api.close()
    assert not api.world.graph.services()


def test_plugins_of_the_world_add_their_namespaces():
    with cw.World(load_text(WORLD, file="w.world")) as world:
        api = ros2(world)
        names = offered(api)
        assert names.items() >= below("/states", STATES).items()
        assert names.items() >= below("/demo", PROPERTIES).items()
        assert names.items() >= below("", STATES | PROPERTIES).items()
        assert "/demo/get_entity_state" not in names
        topics = {info.name for info in world.graph.topics()}
        assert {"/states/model_states", "/states/link_states", "/model_states"} <= topics
        assert not [one for one in world.diagnostics if one.severity != "info"]


def test_a_wrench_acts_until_it_is_cleared(make):
    cube = make.box("cube", (0.5,) * 3, mass=2.0, pose=Pose((0, 0, 5)))
    api = ros2(make.world(cube, ground=None, gravity=0.0))
    api.done(
        "apply_link_wrench",
        link_name="cube::link",
        wrench={"force": {"x": 3.0}},
        duration=FOREVER,
    )
    api.world.run(1.0)
    api("clear_link_wrenches", link_name="cube::link")
    api.world.run(1.0)
    twist = api.done("get_entity_state", name="cube").state.twist
    assert twist.linear.x == pytest.approx(3.0 * 1.0 / 2.0, rel=1e-9)
    meant = {"kind": "link", "name": "cube::lnk", "meant": "cube::link"}
    wrench = {"force": {"x": 1.0}}
    api.fails("apply_link_wrench", ENTITY_UNKNOWN, meant, link_name="cube::lnk", wrench=wrench)
    api("clear_link_wrenches", link_name="nobody")
    assert coded(api.world.diagnostics, SERVICE_FAILED, name="nobody")


def test_an_effort_acts_until_it_is_cleared(make):
    api = ros2(make.world(make.sdf(ARM), ground=None, gravity=0.0))
    api.done("apply_joint_effort", joint_name="hinge", effort=0.5, duration=FOREVER)
    api.world.run(1.0)
    api("clear_joint_efforts", joint_name="hinge")
    api.world.run(0.1)
    rate = api.done("get_joint_properties", joint_name="hinge").rate
    assert rate == pytest.approx([0.5 * 1.0 / 0.5], rel=1e-9)


def test_links_of_a_model_are_reported_with_its_name(make):
    api = ros2(make.world(make.sdf(ARM), ground=None))
    found = api.done("get_model_properties", model_name="arm")
    assert found.canonical_body_name == "arm::base"
    assert found.body_names == ["arm::base", "arm::bar"]
    assert found.joint_names == ["fix", "hinge"]
    assert found.geom_names == ["c"]
    assert not found.is_static


@pytest.mark.wording
def test_stops_are_set_by_ros2s_names(make):
    api = ros2(make.world(make.sdf(ARM), ground=None, gravity=0.0))
    api.done(
        "set_joint_properties",
        joint_name="hinge",
        ode_joint_config={"hi_stop": [0.4], "lo_stop": [-0.2], "damping": [0.3]},
    )
    (joint,) = [one for one in api.simulation.scene.models[0].description.joints if one.axis.upper]
    assert (joint.axis.lower, joint.axis.upper) == (-0.2, 0.4)
    assert api.done("get_joint_properties", joint_name="hinge").damping == [0.3]
    assert api.refused(
        "set_joint_properties",
        joint_name="hinge",
        ode_joint_config={"hi_stop": [math.nan]},
    )
    assert api.done("get_joint_properties", joint_name="hinge").damping == [0.3]


def test_a_light_keeps_what_ros2_does_not_set(make):
    api = ros2(make.world(lights=(LAMP,)))
    api.done(
        "set_light_properties",
        light_name="lamp",
        diffuse={"r": 0.1, "g": 0.2, "b": 0.3, "a": 1.0},
        attenuation_constant=0.5,
    )
    (changed,) = api.simulation.world.lights
    assert changed.diffuse == pytest.approx((0.1, 0.2, 0.3, 1.0))
    assert changed.attenuation == (0.5, 0.0, 0.0)
    assert (changed.pose, changed.specular) == (LAMP.pose, LAMP.specular)
    assert (changed.direction, changed.cast_shadows) == (LAMP.direction, LAMP.cast_shadows)
    meant = {"kind": "light", "name": "lump", "meant": "lamp"}
    api.fails("set_light_properties", ENTITY_UNKNOWN, meant, light_name="lump")


STOPPED, PLAYING, PAUSED = range(3)
OK, ALREADY = 1, 101


def test_a_stopped_simulation_is_at_its_start_until_it_is_paused_or_plays(make):
    api = ros2(make.world())
    name = "gz_server/set_simulation_state"

    def put(state: int) -> int:
        return api(name, state={"state": state}).result.result

    def state() -> int:
        return api("gz_server/get_simulation_state").state.state

    api.world.run(0.5)
    assert state() == PLAYING
    assert put(STOPPED) == OK
    assert (state(), api.simulation.time_ns) == (STOPPED, 0)
    assert put(STOPPED) == ALREADY
    assert put(PAUSED) == OK
    assert (state(), put(PAUSED)) == (PAUSED, ALREADY)
    assert put(STOPPED) == OK
    assert put(PLAYING) == OK
    api.world.run(0.5)
    assert state() == PLAYING
    assert put(STOPPED) == OK
    api.simulation.step(2)
    api.world.run(0.5)
    assert (state(), api.simulation.current_step) == (PAUSED, 2)


@pytest.mark.parametrize(
    ("prefix", "service", "fields"),
    [
        ("", "spawn_entity", lambda text: {"name": "arm", "xml": text}),
        ("/gz_server", "spawn_entity", lambda text: {"entity_resource": {"resource_string": text}}),
        ("/world/test", "create", lambda text: {"entity_factory": {"sdf": text}}),
    ],
)
def test_what_is_spawned_without_a_namespace_is_at_the_root(make, prefix, service, fields):
    """As a node of ROS 2 is: only a world's own models in ROS 1's spelling are under their name."""
    plugin = '<plugin name="p" filename="libgazebo_ros_joint_state_publisher.so"/></model>'
    text = f'<sdf version="1.6">{ARM.replace("</model>", plugin)}</sdf>'
    api = Gazebo(make.world(), api=Ros2Api, prefix=prefix)
    api(service, **fields(text))
    assert "arm" in api.simulation.models
    topics = {topic.name for topic in api.world.graph.topics()}
    assert "/joint_states" in topics
    assert "/arm/joint_states" not in topics
