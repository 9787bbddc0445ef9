"""The battery of gz-sim."""

import math

import pytest
from tests.coded import coded

from cartwheel.codes import devices, running
from cartwheel.errors import PluginError
from cartwheel.messages.singles import single

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
    reported = read(world, STATE, 20.0)[-1]
    assert reported.current == pytest.approx(0.5, rel=1e-6)
    seconds = reported.header.stamp.sec + reported.header.stamp.nanosec * 1e-9
    assert reported.charge * 3600 == pytest.approx(36 - 0.5 * seconds, abs=1e-3)
    assert reported.percentage == pytest.approx(reported.charge / 0.01)
    assert reported.voltage == 12
    assert reported.power_supply_status == reported.POWER_SUPPLY_STATUS_DISCHARGING


def test_its_voltage_falls_with_its_charge_and_its_load(make, read):
    tags = """<open_circuit_voltage_constant_coef>12.6</open_circuit_voltage_constant_coef>
      <open_circuit_voltage_linear_coef>-3</open_circuit_voltage_linear_coef>
      <resistance>0.2</resistance><initial_charge>0.006</initial_charge>"""
    world = cart(make, NOW + tags)
    reported = read(world, STATE, 3.0)[-1]
    assert reported.voltage == pytest.approx(
        12.6 - 3 * (1 - reported.percentage) - 0.2 * reported.current
    )
    assert reported.current == pytest.approx(6 / reported.voltage, rel=1e-3)


def test_the_current_is_smoothed_by_its_time_constant(make, read):
    tags = "<start_draining>1</start_draining><smooth_current_tau>2</smooth_current_tau>"
    world = cart(make, tags)
    reported = read(world, STATE, 2.0)[-1]
    assert reported.header.stamp.sec == 2
    seconds = 2 + reported.header.stamp.nanosec * 1e-9
    assert reported.current == pytest.approx(0.5 * (1 - math.exp(-seconds / 2)), rel=1e-6)


def test_it_drains_from_when_the_robot_is_driven(make, read):
    world = cart(make, "<smooth_current_tau>1e-4</smooth_current_tau>")
    reported = read(world, STATE, 1.0)[-1]
    assert reported.charge == single(0.01)
    assert reported.power_supply_status == reported.POWER_SUPPLY_STATUS_FULL
    world.publish("/model/cart/joint/axle/cmd_vel", data=1.0)
    assert read(world, STATE, 1.0)[-1].charge < single(0.01)
    world.reset()
    assert read(world, STATE, 1.0)[-1].charge == single(0.01)


def test_topics_of_any_type_start_and_stop_it(make, read):
    tags = """<power_draining_topic>/model/cart/joint/axle/cmd_vel</power_draining_topic>
      <stop_power_draining_topic>/rest</stop_power_draining_topic>"""
    world = cart(make, tags)
    world.run(0.1)
    world.publish("/model/cart/joint/axle/cmd_vel", data=0.0)
    world.run(1.0)
    assert read(world, STATE, 0.1)[-1].charge < single(0.01)
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
    reported = read(world, STATE, 5.0)[-1]
    assert reported.current == pytest.approx(-1.0)
    assert reported.power_supply_status == reported.POWER_SUPPLY_STATUS_CHARGING
    assert reported.charge == pytest.approx(0.005 + 5.0 / 3600, abs=2e-5)
    assert read(world, STATE, 15.0)[-1].percentage == pytest.approx(0.9, abs=0.002)
    world.publish("/model/cart/battery/main/recharge/stop", data=True)
    reported = read(world, STATE, 0.5)[-1]
    assert reported.power_supply_status == reported.POWER_SUPPLY_STATUS_FULL


def test_an_empty_battery_is_reported_once_and_gives_nothing(make, read):
    world = cart(make, NOW + "<initial_charge>0.0001</initial_charge>")
    reported = read(world, STATE, 2.0)[-1]
    assert (reported.charge, reported.current, reported.percentage) == (0, 0, 0)
    assert len(coded(world, running.BATTERY_EMPTY)) == 1


def test_a_battery_that_cannot_be_is_refused(make):
    tags = "<smooth_current_tau>0</smooth_current_tau>"
    model = make.sdf(CART.format(BATTERY.format(tags)))
    with pytest.raises(PluginError) as caught:
        make.world().session.spawn(model)
    assert caught.value.code is devices.PLUGIN_PARAMETER_INVALID
    assert caught.value.values["parameter"] == "smooth_current_tau"


def test_without_a_charging_time_it_cannot_be_charged_and_that_is_reported(make):
    world = cart(make, "<enable_recharge>1</enable_recharge>")
    assert coded(world, devices.PLUGIN_PARAMETER_IGNORED, parameter="enable_recharge")
    assert not any("recharge" in topic.name for topic in world.graph.topics())
