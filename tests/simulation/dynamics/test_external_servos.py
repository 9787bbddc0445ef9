"""Servos and forces that move whole models, joints' reactions: against Newton and statics."""

import math

import numpy as np
import pytest

from cartwheel.codes import running
from cartwheel.errors import PluginError
from cartwheel.geometry import Pose, quat_from_rpy
from cartwheel.simulation import Simulation

G = 9.8


def spawn(make, model, take, pose=None, ground=100.0):
    """A world with the model, and what `take` took of its part before it was built."""
    world = make.world(ground=ground)
    simulation: Simulation = world.session.simulation
    taken = []
    attach = simulation._population.attach

    def noting(part):
        taken.append(take(part))
        return attach(part)

    simulation._population.attach = noting
    world.session.spawn(model, pose=pose)
    simulation._population.attach = attach
    return world, taken[0]


def run(world, seconds):
    """Runs, and reads the state of the end."""
    world.run(seconds)
    world.session.simulation.refresh()


def box(make, mu=0.1):
    return make.box("box", (0.4, 0.4, 0.2), mass=5.0, mu=mu)


def test_a_servo_holds_the_velocity_it_is_commanded(make):
    """Against the friction mu m g it lags by that part of the 0.05 m/s at which it gives all."""
    world, (drive, link) = spawn(
        make, box(make), lambda part: (part.body_drive(), part.link("link")), Pose((0, 0, 0.1))
    )
    world.run(0.5)
    drive.command((0.3, -0.2, None), (None, None, 0.0))
    world.run(0.2)
    (vx, vy, _), _ = link.motion(local=False)
    lag = 0.05 * 0.1 / 5
    assert math.hypot(0.3 - vx, -0.2 - vy) < 1.5 * lag
    drive.release()
    world.run(2.0)
    assert np.linalg.norm(link.motion(local=False)[0]) < 1e-3


def test_a_turning_servo_turns_about_the_link_not_the_centre_of_mass(make):
    """A link's origin off the centre of mass stays where it is while the model turns about it."""
    model = """<model name="arm"><link name="link">
      <inertial><pose>0.3 0 0 0 0 0</pose><mass>2</mass>
        <inertia><ixx>.01</ixx><iyy>.01</iyy><izz>.01</izz></inertia></inertial>
    </link></model>"""
    world, (drive, link) = spawn(
        make,
        make.sdf(model),
        lambda part: (part.body_drive(), part.link("link")),
        Pose((1, 2, 3)),
        ground=None,
    )

    drive.command((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))
    world.run(1.0)
    before = link.pose.yaw
    world.run(1.0)
    assert link.pose.yaw - before == pytest.approx(1.0, abs=1e-3)
    assert link.place()[0] == pytest.approx((1, 2, 3), abs=0.03)


def test_what_stands_fixed_cannot_be_driven(make):
    with pytest.raises(PluginError) as caught:
        spawn(make, make.box("box", (1, 1, 1), static=True), lambda part: part.body_drive())
    assert caught.value.code is running.MODEL_NOT_MOVABLE


def test_a_force_accelerates_by_newton_until_it_is_taken_back(make):
    world, (push, other, link) = spawn(
        make,
        box(make),
        lambda part: (part.wrench("link"), part.wrench("link"), part.link("link")),
        Pose((0, 0, 50)),
        ground=None,
    )
    push.apply((10.0, 0, 0), (0, 0, 0.2))
    other.apply((0, 5.0, 5.0 * G), (0, 0, 0))
    run(world, 1.0)
    linear, angular = link.motion(local=False)
    # Forces of two add up: F/m along each axis, and gravity is borne.
    assert linear == pytest.approx((10 / 5, 5 / 5, 0), abs=1e-9)
    assert angular[2] == pytest.approx(0.2 / (5 * (0.4**2 + 0.4**2) / 12), rel=1e-9)
    push.apply((0, 0, 0), (0, 0, 0))
    run(world, 1.0)
    linear, _ = link.motion(local=False)
    assert linear == pytest.approx((10 / 5, 2 * 5 / 5, 0), abs=1e-9)
    # Spawning compiles anew: the push goes on.
    world.session.spawn(make.box("late", (0.1, 0.1, 0.1)), pose=Pose((9, 9, 9)))
    run(world, 1.0)
    assert link.motion(local=False)[0] == pytest.approx((2, 3, 0), abs=1e-9)


BEAM = """<model name="beam"><pose>0 0 1 0 0 0.5</pose>
  <link name="post"><inertial><mass>1</mass></inertial></link>
  <link name="arm"><pose>0 0 0.2 0 0 0</pose>
    <inertial><pose>0.5 0 0 0 0 0</pose><mass>3</mass>
      <inertia><ixx>.1</ixx><iyy>.1</iyy><izz>.1</izz></inertia></inertial></link>
  <joint name="bolt" type="fixed"><parent>world</parent><child>post</child></joint>
  <joint name="hinge" type="revolute"><parent>post</parent><child>arm</child>
    <axis><xyz>0 0 1</xyz></axis></joint></model>"""


def test_a_joint_bears_weight_and_moment(make):
    """A beam of 3 kg, its centre 0.5 m out: it presses with m g, and m g 0.5 turns it down."""
    world, arm = spawn(make, make.sdf(BEAM), lambda part: part.link("arm"), ground=None)
    world.run(0.5)
    world.session.simulation.refresh()
    force, torque = arm.reaction()
    assert force == pytest.approx([0, 0, -3 * G], abs=1e-6)
    # r × F with r = (0.5, 0, 0): about y, the sense that lets the end sink.
    assert torque == pytest.approx([0, 3 * G * 0.5, 0], abs=1e-6)
    _, about_end = arm.reaction((0.5, 0.0, 0.0))
    assert about_end == pytest.approx([0, 0, 0], abs=1e-6)


def test_a_tilted_joints_reaction_is_in_the_links_axes(make):
    tilt = Pose((0, 0, 1), quat_from_rpy(0, 0.3, 0))
    world, arm = spawn(make, make.sdf(BEAM), lambda part: part.link("arm"), tilt, ground=None)
    world.session.simulation.refresh()
    force, _ = arm.reaction()
    assert force == pytest.approx([3 * G * math.sin(0.3), 0, -3 * G * math.cos(0.3)], abs=1e-6)


@pytest.mark.parametrize(
    ("own", "given", "kept"), [(None, 5.0, 5.0), (2.0, 5.0, 2.0), (9.0, 5.0, 5.0), (2.0, None, 2.0),
                               (None, 0.0, 0.0), (0.0, 5.0, 5.0)]
)  # fmt: skip
def test_a_motor_gives_no_more_than_its_own_limit_and_the_joints(make, own, given, kept):
    """A wheel of 0.5 kg m², from rest: τ t / I, and τ is the smaller limit; 0 is no effort."""
    limit = "" if own is None else f"<limit><effort>{own}</effort></limit>"
    model = f"""<model name="m"><link name="post"/><link name="wheel"><inertial><mass>1</mass>
      <inertia><ixx>.5</ixx><iyy>.5</iyy><izz>.5</izz></inertia></inertial></link>
      <joint name="bolt" type="fixed"><parent>world</parent><child>post</child></joint>
      <joint name="hub" type="revolute"><parent>post</parent><child>wheel</child>
      <axis><xyz>0 0 1</xyz>{limit}</axis></joint></model>"""
    world, (motor, joint) = spawn(
        make,
        make.sdf(model),
        lambda part: (part.velocity_motor("hub", max_effort=given), part.joint("hub")),
        ground=None,
    )
    motor.command(100.0)
    run(world, 0.5)
    assert joint.velocity == pytest.approx(kept * 0.5 / 0.5, abs=0.01)
    assert joint.effort == pytest.approx(kept, abs=1e-6)


def test_two_may_push_one_model(make):
    """Of two that are as strong neither gets its way, within the band where they give in."""
    world, (one, other) = spawn(
        make, box(make, 0.0), lambda part: (part.body_drive(), part.body_drive()), Pose((0, 0, 0.1))
    )
    one.command((0.04, None, None), (None, None, None))
    other.command((0.0, None, None), (None, None, None))
    world.run(1.0)
    before = world.session.simulation.pose("box").x
    world.run(1.0)
    assert world.session.simulation.pose("box").x - before == pytest.approx(0.02, rel=0.05)
