"""Systems of new Gazebo that hold, tell and run down: detachable joint, poses, battery."""

import math

import pytest
from tests.coded import coded

from cartwheel.codes import devices, running
from cartwheel.errors import PluginError, UnknownNameError
from cartwheel.geometry import Pose

G = 9.8


def post(make, plugin, *, name="post"):
    """A link that stands 1 m above the ground."""
    return make.sdf(f"""<model name="{name}"><pose>0 0 1 0 0 0</pose><link name="hand">
      <inertial><mass>1</mass></inertial></link>
      <joint name="bolt" type="fixed"><parent>world</parent><child>hand</child></joint>{plugin}
      </model>""")


JOINT = """<plugin name="d" filename="gz-sim-detachable-joint-system">
  <parent_link>hand</parent_link><child_model>load</child_model><child_link>link</child_link>
  {}</plugin>"""


def load(make, z=1.0):
    return make.box("load", (0.1, 0.1, 0.1), mass=2.0, pose=Pose((0.3, 0, z)))


def test_a_detachable_joint_holds_until_it_is_told_to_part_and_joins_again(make):
    world = make.world(post(make, JOINT.format("")), load(make), ground=None)
    states = world.mailbox("/model/load/detachable_joint/state")
    world.run(1.0)
    assert world.model("load").pose.z == pytest.approx(1.0, abs=1e-3)
    world.publish("/model/post/detachable_joint/detach")
    world.run(0.5)
    fallen = world.model("load").pose.z
    assert fallen == pytest.approx(1.0 - G * 0.5**2 / 2, abs=0.03)
    world.publish("/model/post/detachable_joint/attach")
    world.run(0.5)
    held = world.model("load").pose.z
    world.run(0.5)
    # Held where it was caught, at rest.
    assert world.model("load").pose.z == pytest.approx(held, abs=1e-3)
    assert [message.data for message in states.drain()] == ["attached", "detached", "attached"]


def test_a_child_that_comes_later_is_joined_then_and_missed_once(make):
    world = make.world(post(make, JOINT.format("")), ground=None)
    world.run(1.0)
    missed = coded(world, running.ATTACHMENT_FAILED)
    assert len(missed) == 1
    world.session.spawn(load(make))
    world.run(1.0)
    assert world.model("load").pose.z == pytest.approx(1.0, abs=1e-3)
    quiet = make.world(
        post(make, JOINT.format("<suppress_child_warning>1</suppress_child_warning>"))
    )
    quiet.run(0.1)
    assert not coded(quiet, running.ATTACHMENT_FAILED)


def test_topics_have_the_names_that_they_are_given(make):
    tags = "<topic>/let/go</topic><output_topic>/how/is/it</output_topic>"
    world = make.world(post(make, JOINT.format(tags)), load(make), ground=None)
    states = world.mailbox("/how/is/it")
    world.run(0.1)
    world.publish("/let/go")
    world.run(0.1)
    assert [message.data for message in states.drain()] == ["attached", "detached"]


def test_a_model_in_the_model_can_be_its_child(make):
    model = make.sdf(f"""<model name="outer"><pose>0 0 1 0 0 0</pose>
      <link name="hand"><inertial><mass>1</mass></inertial></link>
      <joint name="bolt" type="fixed"><parent>world</parent><child>hand</child></joint>
      <model name="load"><pose>0.2 0 0 0 0 0</pose><link name="link"><inertial><mass>1</mass>
      </inertial></link></model>{JOINT.format("")}</model>""")
    world = make.world(model, ground=None)
    link = world.session.simulation.engine
    world.run(1.0)
    assert link.link_pose("outer", "load::link").z == pytest.approx(1.0, abs=1e-3)


def test_a_parent_that_is_not_there_is_refused(make):
    with pytest.raises(UnknownNameError) as caught:
        make.world().session.spawn(post(make, JOINT.format("").replace(">hand<", ">hnd<")))
    assert caught.value.code is running.UNKNOWN_LINK
    assert caught.value.values["name"] == "hnd"


POSES = """<plugin name="p" filename="gz-sim-pose-publisher-system">
  <update_frequency>50</update_frequency>{}</plugin>"""
SWING = """<model name="swing"><pose>1 2 3 0 0 0.5</pose>
  <link name="base"><inertial><mass>1</mass></inertial></link>
  <link name="arm"><pose>0.5 0 0 0 0 0</pose><inertial><mass>1</mass></inertial>
    <collision name="c"><pose>0 0 0.2 0 0 0</pose><geometry><sphere><radius>0.01</radius></sphere>
    </geometry></collision></link>
  <joint name="bolt" type="fixed"><parent>world</parent><child>base</child></joint>
  <joint name="turn" type="revolute"><parent>base</parent><child>arm</child>
    <pose>-0.5 0 0 0 0 0</pose><axis><xyz>0 0 1</xyz></axis></joint>{}</model>"""


def transforms(message):
    return {each.child_frame_id: each for each in message.transforms}


def test_poses_are_told_in_the_frame_of_what_a_part_belongs_to(make, read):
    tags = """<use_pose_vector_msg>1</use_pose_vector_msg><publish_model_pose>1</publish_model_pose>
      <publish_collision_pose>1</publish_collision_pose>"""
    world = make.world(make.sdf(SWING.format(POSES.format(tags))), ground=None)
    world.session.simulation.set_joint_positions("swing", {"turn": 0.7})
    told = transforms(read(world, "/model/swing/pose", 0.1)[-1])
    assert set(told) == {"swing", "swing/base", "swing/arm", "swing/arm/c"}
    arm = told["swing/arm"]
    assert arm.header.frame_id == "swing"
    place = arm.transform.translation
    assert (place.x, place.y) == pytest.approx((0.5 * math.cos(0.7), 0.5 * math.sin(0.7)), abs=1e-3)
    model = told["swing"]
    assert model.header.frame_id == "test"
    assert model.transform.translation.z == pytest.approx(3)
    assert model.transform.rotation.z == pytest.approx(math.sin(0.25))
    shape = told["swing/arm/c"]
    assert shape.header.frame_id == "swing/arm"
    assert shape.transform.translation.z == 0.2


def test_what_no_joint_moves_can_go_on_a_topic_of_its_own(make, read):
    tags = """<static_publisher>1</static_publisher>
      <static_update_frequency>10</static_update_frequency>"""
    world = make.world(make.sdf(SWING.format(POSES.format(tags))), ground=None)
    still = world.mailbox("/model/swing/pose_static")
    moved = read(world, "/model/swing/pose", 1.0)
    assert {message.child_frame_id for message in moved} == {"swing/arm"}
    assert len(moved) == 50
    told = still.drain()
    assert {message.child_frame_id for message in told} == {"swing/base"}
    assert len(told) == 10


BATTERY = """<plugin name="b" filename="gz-sim-linearbatteryplugin-system">
  <battery_name>main</battery_name><voltage>12</voltage><capacity>0.01</capacity>
  <power_load>6</power_load>{}</plugin>"""
STATE = "/model/cart/battery/main/state"
CART = """<model name="cart"><link name="base"><inertial><mass>1</mass></inertial></link>
  <link name="wheel"><inertial><mass>1</mass></inertial></link>
  <joint name="axle" type="continuous"><parent>base</parent><child>wheel</child>
  <axis><xyz>0 1 0</xyz></axis></joint>
  <plugin name="j" filename="gz-sim-joint-controller-system"><joint_name>axle</joint_name></plugin>
  {}</model>"""
NOW = "<start_draining>1</start_draining><smooth_current_tau>1e-4</smooth_current_tau>"


def cart(make, tags):
    return make.world(make.sdf(CART.format(BATTERY.format(tags))), ground=None, gravity=0.0)


def test_a_battery_loses_the_integral_of_its_current(make, read):
    """6 W at 12 V are 0.5 A: in 20 s 10 of its 36 C."""
    world = cart(make, NOW)
    told = read(world, STATE, 20.0)[-1]
    assert told.current == pytest.approx(0.5, rel=1e-6)
    seconds = told.header.stamp.sec + told.header.stamp.nanosec * 1e-9
    assert told.charge * 3600 == pytest.approx(36 - 0.5 * seconds, abs=1e-3)
    assert told.percentage == pytest.approx(told.charge / 0.01)
    assert told.voltage == 12
    assert told.power_supply_status == told.POWER_SUPPLY_STATUS_DISCHARGING


def test_its_voltage_falls_with_its_charge_and_its_load(make, read):
    tags = """<open_circuit_voltage_constant_coef>12.6</open_circuit_voltage_constant_coef>
      <open_circuit_voltage_linear_coef>-3</open_circuit_voltage_linear_coef>
      <resistance>0.2</resistance><initial_charge>0.006</initial_charge>"""
    world = cart(make, NOW + tags)
    told = read(world, STATE, 3.0)[-1]
    assert told.voltage == pytest.approx(12.6 - 3 * (1 - told.percentage) - 0.2 * told.current)
    assert told.current == pytest.approx(6 / told.voltage, rel=1e-3)


def test_the_current_is_smoothed_by_its_time_constant(make, read):
    tags = "<start_draining>1</start_draining><smooth_current_tau>2</smooth_current_tau>"
    world = cart(make, tags)
    told = read(world, STATE, 2.0)[-1]
    assert told.header.stamp.sec == 1
    seconds = 1 + told.header.stamp.nanosec * 1e-9
    assert told.current == pytest.approx(0.5 * (1 - math.exp(-seconds / 2)), rel=1e-6)


def test_it_drains_from_when_the_robot_is_driven(make, read):
    world = cart(make, "<smooth_current_tau>1e-4</smooth_current_tau>")
    told = read(world, STATE, 1.0)[-1]
    assert told.charge == 0.01
    assert told.power_supply_status == told.POWER_SUPPLY_STATUS_FULL
    world.publish("/model/cart/joint/axle/cmd_vel", data=1.0)
    assert read(world, STATE, 1.0)[-1].charge < 0.01
    world.reset()
    assert read(world, STATE, 1.0)[-1].charge == 0.01


def test_topics_of_any_type_start_and_stop_it(make, read):
    tags = """<power_draining_topic>/model/cart/joint/axle/cmd_vel</power_draining_topic>
      <stop_power_draining_topic>/rest</stop_power_draining_topic>"""
    world = cart(make, tags)
    world.run(0.1)
    world.publish("/model/cart/joint/axle/cmd_vel", data=0.0)
    world.run(1.0)
    assert read(world, STATE, 0.1)[-1].charge < 0.01
    world.publish("/rest")
    world.run(0.1)
    before = read(world, STATE, 0.1)[-1].charge
    assert read(world, STATE, 1.0)[-1].charge == before


def test_it_is_charged_up_to_nine_tenths(make, read):
    """From half: at 0.01 A h in 0.01 h it takes 1 A, and 4 mA h are 14.4 s of it."""
    tags = """<enable_recharge>1</enable_recharge><charging_time>0.01</charging_time>
      <initial_charge>0.005</initial_charge><smooth_current_tau>1e-4</smooth_current_tau>"""
    world = cart(make, tags)
    world.run(0.1)
    world.publish("/model/cart/battery/main/recharge/start", data=True)
    told = read(world, STATE, 5.0)[-1]
    assert told.current == pytest.approx(-1.0)
    assert told.power_supply_status == told.POWER_SUPPLY_STATUS_CHARGING
    assert told.charge == pytest.approx(0.005 + 5.0 / 3600, abs=2e-5)
    assert read(world, STATE, 15.0)[-1].percentage == pytest.approx(0.9, abs=0.002)
    world.publish("/model/cart/battery/main/recharge/stop", data=True)
    told = read(world, STATE, 0.5)[-1]
    assert told.power_supply_status == told.POWER_SUPPLY_STATUS_FULL


def test_an_empty_battery_is_told_once_and_gives_nothing(make, read):
    world = cart(make, NOW + "<initial_charge>0.0001</initial_charge>")
    told = read(world, STATE, 2.0)[-1]
    assert (told.charge, told.current, told.percentage) == (0, 0, 0)
    assert len(coded(world, running.BATTERY_EMPTY)) == 1


def test_a_battery_that_cannot_be_is_refused(make):
    tags = "<smooth_current_tau>0</smooth_current_tau>"
    model = make.sdf(CART.format(BATTERY.format(tags)))
    with pytest.raises(PluginError) as caught:
        make.world().session.spawn(model)
    assert caught.value.code is devices.PLUGIN_PARAMETER_INVALID
    assert caught.value.values["parameter"] == "smooth_current_tau"


def test_without_a_charging_time_it_cannot_be_charged_and_that_is_told(make):
    world = cart(make, "<enable_recharge>1</enable_recharge>")
    assert coded(world, devices.PLUGIN_PARAMETER_IGNORED, parameter="enable_recharge")
    assert not any("recharge" in topic.name for topic in world.graph.topics())
