"""Lift and drag, compared with their formulas."""

import dataclasses
import math

import numpy as np
import pytest
from tests.coded import raises

from cartwheel.codes import devices
from cartwheel.devices.air.lift_drag import AirfoilConfig, aerodynamic_force, coefficients
from cartwheel.errors import PluginError
from cartwheel.geometry import Pose

WING = AirfoilConfig(
    area=0.5,
    air_density=1.2,
    zero_angle=0.1,
    lift_slope=4.0,
    drag_slope=0.3,
    stall_angle=0.3,
    stalled_lift_slope=-2.0,
    stalled_drag_slope=1.5,
)
FORWARD, UP = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)


def force(velocity, wing=WING, **more):
    made = aerodynamic_force(wing, velocity=velocity, forward=FORWARD, upward=UP, **more)
    return np.array(made)


@pytest.mark.parametrize(
    ("alpha", "lift", "drag"),
    [
        (0.0, 0.0, 0.0),
        (0.2, 0.8, 0.06),
        (-0.2, -0.8, 0.06),
        (0.4, 1.2 - 0.2, 0.09 + 0.15),
        (-0.4, -(1.2 - 0.2), 0.09 + 0.15),
        (1.2, 0.0, 0.09 + 1.35),
    ],
)
def test_the_coefficients_change_at_the_stall_angle(alpha, lift, drag):
    assert coefficients(WING, alpha) == pytest.approx((lift, drag))


def test_straight_flight_has_the_stated_angle_of_attack():
    q = 0.5 * 1.2 * 20.0**2 * 0.5
    assert force([20.0, 0.0, 0.0]) == pytest.approx([-q * 0.03, 0.0, q * 0.4])


def test_sinking_increases_the_angle_of_attack():
    sink = 0.1
    speed = 10.0
    velocity = [speed * math.cos(sink), 0.0, -speed * math.sin(sink)]
    q = 0.5 * 1.2 * speed**2 * 0.5
    lift, drag = q * 4.0 * 0.2, q * 0.3 * 0.2
    expected = lift * np.array([math.sin(sink), 0.0, math.cos(sink)])
    expected -= drag * np.array([math.cos(sink), 0.0, -math.sin(sink)])
    assert force(velocity) == pytest.approx(expected)


def test_sideslip_reduces_both():
    # gz-sim: the pressure of the velocity in the plane, times the square of the cosine.
    straight, slipping = force([10.0, 0.0, 0.0]), force([10.0, 10.0, 0.0])
    assert slipping == pytest.approx(straight * 0.5)


def test_a_control_surface_adds_lift():
    q = 0.5 * 1.2 * 10.0**2 * 0.5
    more = force([10.0, 0.0, 0.0], more_lift=0.25) - force([10.0, 0.0, 0.0])
    assert more == pytest.approx([0.0, 0.0, q * 0.25])


def test_a_radial_body_is_lifted_across_its_axis():
    body = dataclasses.replace(WING, radial=True, zero_angle=0.0)
    down = force([10.0, 0.0, -1.0], body)
    side = force([10.0, -1.0, 0.0], body)
    assert down[2] > 0.0
    assert side == pytest.approx([down[0], down[2], 0.0])
    assert force([10.0, 0.0, 0.0], body) == pytest.approx([0.0, 0.0, 0.0])


@pytest.mark.parametrize("velocity", [[0.0, 0.0, 0.0], [0.009, 0.0, 0.0], [0.0, 5.0, 0.0]])
def test_without_airflow_there_is_no_force(velocity):
    assert force(velocity).tolist() == [0.0, 0.0, 0.0]


def glider(make, tags):
    return make.sdf(f"""<model name="glider"><link name="body"><inertial><mass>2</mass>
      <inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial></link>
      <plugin name="wing" filename="gz-sim-lift-drag-system"><link_name>body</link_name>
      <area>0.5</area><air_density>1.2</air_density>{tags}</plugin></model>""")


def test_a_wing_accelerates_its_link_and_turns_it_about_the_centre_of_pressure(make):
    world = make.world(ground=None, gravity=0.0)
    tags = "<a0>0.1</a0><cla>4</cla><cda>0</cda><cp>-0.2 0 0</cp>"
    world.session.spawn(glider(make, tags), pose=Pose((0, 0, 10)))
    body = world.session.simulation.data.joint("glider::body")
    body.qvel[:3] = [20.0, 0.0, 0.0]
    step = world.session.simulation.step_ns * 1e-9
    world.run(step)
    lift = 0.5 * 1.2 * 20.0**2 * 0.5 * 0.4
    # A step of 5 ms turns the wing by less than 1 mrad, so the error is below 1 %.
    assert body.qvel[2] == pytest.approx(lift / 2.0 * step, rel=0.01)
    assert body.qvel[4] == pytest.approx(lift * 0.2 / 1.0 * step, rel=0.01)


def test_a_direction_must_not_be_zero(make):
    world = make.world()
    with raises(devices.PLUGIN_PARAMETER_INVALID, PluginError, parameter="forward"):
        world.session.spawn(glider(make, "<forward>0 0 0</forward>"))
