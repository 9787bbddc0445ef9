"""Wheels that slip: the speed of slip against compliance, force and speed."""

import math

import numpy as np
import pytest

from cartwheel.codes import devices, running
from cartwheel.errors import PluginError
from cartwheel.geometry import Pose

INVALID = devices.PLUGIN_PARAMETER_INVALID

G = 9.8
RADIUS = 0.1
MASS = 10.0
WHEELS = {
    "front_left": (0.2, 0.15),
    "front_right": (0.2, -0.15),
    "rear_left": (-0.2, 0.15),
    "rear_right": (-0.2, -0.15),
}
NORMAL = (MASS - 2.0 + 4 * 0.5) * G / 4
DRIVE = """<plugin name="d" filename="libgazebo_ros_skid_steer_drive.so">
  <leftFrontJoint>front_left_joint</leftFrontJoint><leftRearJoint>rear_left_joint</leftRearJoint>
  <rightFrontJoint>front_right_joint</rightFrontJoint>
  <rightRearJoint>rear_right_joint</rightRearJoint>
  <wheelSeparation>0.3</wheelSeparation><wheelDiameter>0.2</wheelDiameter><torque>50</torque>
  <robotBaseFrame>base_link</robotBaseFrame></plugin>"""


def slip(lateral=1.0, longitudinal=1.0, *, filename="gz-sim-wheel-slip-system", inside=""):
    wheels = "".join(
        f"""<wheel link_name="{name}_wheel">
        <slip_compliance_lateral>{lateral}</slip_compliance_lateral>
        <slip_compliance_longitudinal>{longitudinal}</slip_compliance_longitudinal>
        <wheel_normal_force>{NORMAL}</wheel_normal_force><wheel_radius>{RADIUS}</wheel_radius>
        </wheel>"""
        for name in WHEELS
    )
    return f'<plugin name="slip" filename="{filename}">{inside}{wheels}</plugin>'


def spawn(make, cart, plugin, *, step=None):
    world = make.world(ground=1.0, step=step)
    world.session.spawn(cart(WHEELS, DRIVE + plugin, mass=MASS - 2.0), pose=Pose((0, 0, 0.002)))
    world.run(0.5)
    return world


def push(world, **force):
    x, y = force.get("x", 0.0), force.get("y", 0.0)
    world.session.simulation.forces.wrench(
        "cart", "base_link", force=(x, y, 0.0), torque=(0.0, 0.0, 0.0)
    )


def way(world, seconds):
    before = np.array(world.model("cart").pose.position)
    world.run(seconds)
    return (np.array(world.model("cart").pose.position) - before) / seconds


@pytest.mark.parametrize("step", [0.001, 0.005])
@pytest.mark.parametrize(("compliance", "speed"), [(1.0, 0.5), (0.3, 1.0)])
def test_wheels_slip_by_compliance_force_and_speed(make, cart, compliance, speed, step):
    """Each of four wheels bears a fourth: slip / speed = compliance (F / 4) / N."""
    world = spawn(make, cart, slip(0.0, compliance), step=step)
    world.publish("/cmd_vel", linear_x=speed)
    world.run(1.5)
    assert way(world, 0.5)[0] == pytest.approx(speed, rel=0.01)
    pull = 20.0
    push(world, x=-pull)
    world.run(1.0)
    slipped = compliance * (pull / 4) / NORMAL * speed
    assert speed - way(world, 1.0)[0] == pytest.approx(slipped, rel=0.05)


def test_they_slip_sideways_by_the_same_law_and_not_while_they_stand(make, cart):
    world = spawn(make, cart, slip(0.5, 0.0))
    push(world, y=16.0)
    assert abs(way(world, 1.0)[1]) < 1e-3
    world.publish("/cmd_vel", linear_x=0.6)
    world.run(1.0)
    moved = way(world, 1.0)
    assert moved[1] == pytest.approx(0.5 * (16.0 / 4) / NORMAL * 0.6, rel=0.05)
    assert moved[0] == pytest.approx(0.6, rel=0.01)


def test_friction_bounds_what_they_pass_on(make, cart):
    """Beyond mu N the tyre itself slides: the cart is pulled away."""
    world = spawn(make, cart, slip(0.0, 0.1))
    world.publish("/cmd_vel", linear_x=0.5)
    world.run(1.0)
    push(world, x=-1.2 * 4 * NORMAL)
    before = way(world, 0.2)[0]
    assert way(world, 0.2)[0] < before - 0.2


def test_without_compliance_nothing_slips(make, cart):
    world = spawn(make, cart, slip(0.0, 0.0))
    push(world, x=-20.0, y=10.0)
    world.publish("/cmd_vel", linear_x=0.5)
    world.run(1.0)
    moved = way(world, 1.0)
    assert moved[0] == pytest.approx(0.5, rel=0.01)
    assert abs(moved[1]) < 5e-3


def test_a_skid_steered_cart_turns_nearer_to_what_it_is_commanded(make, cart):
    """Tyres that give way sideways hold a turn back less than those that must be dragged."""

    def turned(plugin):
        world = spawn(make, cart, plugin)
        world.publish("/cmd_vel", angular_z=0.5)
        world.run(0.5)
        before = world.model("cart").pose.yaw
        world.run(2.0)
        return world.model("cart").pose.yaw - before

    assert 1.2 * turned("") < turned(slip(1.0, 0.0)) < 1.0


def test_ros_2_s_spelling_publishes_the_slip_of_each_wheel(make, cart, read):
    plugin = slip(0.5, 1.0, filename="libgazebo_ros_wheel_slip.so", inside="<ros/>")
    world = spawn(make, cart, plugin)
    world.publish("/cmd_vel", linear_x=0.5)
    push(world, x=-20.0, y=16.0)
    world.run(1.5)
    reported = read(world, "/wheel_slip", 0.5)
    assert len(reported) == 50
    assert reported[-1].name == [f"{name}_wheel" for name in WHEELS]
    assert np.mean(reported[-1].longitudinal_slip) == pytest.approx(5 / NORMAL, rel=0.05)
    aside = math.atan2(0.5 * 4 / NORMAL, 1 - 5 / NORMAL)
    # Along the axle, which points to the left or right as the joint's axis does.
    assert abs(np.mean(reported[-1].lateral_slip)) == pytest.approx(aside, rel=0.1)


def test_ros_1_s_spelling_can_be_reconfigured(make, cart, ask):
    world = spawn(make, cart, slip(0.0, 0.0, filename="libgazebo_ros_wheel_slip.so"))
    ask(
        world,
        "/cart/wheel_slip/set_parameters",
        config={"doubles": [{"name": "slip_compliance_unitless_longitudinal", "value": 1.0}]},
    )
    world.publish("/cmd_vel", linear_x=0.5)
    push(world, x=-20.0)
    world.run(2.0)
    assert 0.5 - way(world, 1.0)[0] == pytest.approx(5 / NORMAL * 0.5, rel=0.05)


def test_other_models_and_a_reset_leave_it_as_it_is(make, cart):
    world = spawn(make, cart, slip(0.0, 1.0))
    world.session.spawn(make.box("late", (0.1, 0.1, 0.1)), pose=Pose((5, 5, 0.06)))
    world.reset()
    world.run(0.5)
    world.publish("/cmd_vel", linear_x=0.5)
    push(world, x=-20.0)
    world.run(2.0)
    assert 0.5 - way(world, 1.0)[0] == pytest.approx(5 / NORMAL * 0.5, rel=0.05)


@pytest.mark.parametrize(
    ("old", "new", "code"),
    [
        (
            "<wheel_radius>0.1</wheel_radius>",
            "<wheel_radius>-1</wheel_radius>",
            INVALID,
        ),
        ('link_name="front_left_wheel"', "", devices.PLUGIN_PARAMETER_MISSING),
        ('link_name="front_left_wheel"', 'link_name="base_link"', running.NOT_A_WHEEL),
        (
            "<slip_compliance_lateral>1.0<",
            "<slip_compliance_lateral>x<",
            INVALID,
        ),
    ],
)
def test_a_wheel_that_makes_no_sense_is_refused(make, cart, old, new, code):
    plugin = slip().replace(old, new, 1)
    assert plugin != slip()
    with pytest.raises(PluginError) as caught:
        make.world().session.spawn(cart(WHEELS, plugin))
    assert caught.value.code is code
