"""``libhector_gazebo_quadrotor_simple_controller.so``: takeoff, flight and landing."""

import math

import numpy as np
import pytest
from tests.dialects.makers.flying.quadrotors import GAINS, MASS, Bird

from cartwheel.devices.air.velocity_control import merged_inertia
from cartwheel.messages import message_class

HECTOR = GAINS + "<velocityZIntegralGain>1</velocityZIntegralGain>"


def quadrotor(make, tags="", **options):
    name = "libhector_gazebo_quadrotor_simple_controller.so"
    return Bird(make, name, HECTOR + tags, **options)


def call(bird, name):
    bird.world.session.graph.call(name, message_class("std_srvs/srv/Empty_Request")())


@pytest.mark.parametrize("tags", ["", "<updateRate>100</updateRate>"])
def test_it_takes_off_hovers_follows_commands_and_lands(make, tags):
    bird = quadrotor(make, tags)
    bird.world.run(1.0)
    assert bird.position[2] == pytest.approx(0.05, abs=0.005)
    bird.command(z=0.5)
    bird.world.run(4.0)
    assert bird.velocity[2] == pytest.approx(0.5, abs=0.1)
    bird.command()
    bird.world.run(8.0)
    hover = bird.position
    bird.world.run(2.0)
    assert bird.position == pytest.approx(hover, abs=0.05)
    bird.command(x=0.5)
    bird.world.run(5.0)
    assert bird.velocity == pytest.approx([0.5, 0.0, 0.0], abs=0.05)
    bird.command(turn=0.5)
    bird.world.run(4.0)
    yaw = bird.yaw
    bird.world.run(1.0)
    assert (bird.yaw - yaw + math.pi) % (2 * math.pi) - math.pi == pytest.approx(0.5, abs=0.03)
    wrenches = bird.world.mailbox("/wrench_out", size=100_000)
    bird.command(z=-0.5)
    bird.world.run(20.0)
    assert bird.position[2] == pytest.approx(0.05, abs=0.005)
    assert np.abs(bird.velocity).max() < 0.01
    forces = [message.force.z for message in wrenches.drain()]
    # The motors are off: it stands on the ground.
    assert max(forces) > 10.0
    assert forces[-1] == 0.0


def test_services_switch_the_motors(make):
    bird = quadrotor(make, "<autoEngage>false</autoEngage>")
    wrenches = bird.world.mailbox("/wrench_out", size=100_000)
    bird.command(z=1.0)
    bird.world.run(1.0)
    assert bird.position[2] == pytest.approx(0.05, abs=0.005)
    call(bird, "/engage")
    bird.world.run(2.0)
    assert bird.position[2] > 1.0
    assert wrenches.drain()[-1].force.z == pytest.approx((MASS + 0.1) * 9.8, rel=0.05)
    call(bird, "/shutdown")
    bird.world.run(2.0)
    assert bird.position[2] == pytest.approx(0.05, abs=0.01)


def test_a_fixed_link_belongs_to_the_body(make):
    model = make.sdf("""<model name="m"><link name="a"><inertial><mass>1</mass><inertia>
      <ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial></link>
      <link name="b"><pose>0.4 0 0 0 0 0</pose><inertial><mass>1</mass><inertia><ixx>0.2</ixx>
      <iyy>0.2</iyy><izz>0.2</izz></inertia></inertial></link>
      <link name="c"><inertial><mass>5</mass></inertial></link>
      <joint name="ab" type="fixed"><parent>a</parent><child>b</child></joint>
      <joint name="ac" type="revolute"><parent>a</parent><child>c</child>
      <axis><xyz>0 0 1</xyz></axis></joint></model>""")
    mass, centre, inertia = merged_inertia(model, "a")
    assert mass == pytest.approx(2.0)
    assert centre == pytest.approx([0.2, 0, 0])
    # Each mass is 0.2 m from the centre of mass: twice 1 kg (0.2 m)².
    assert inertia == pytest.approx([0.3, 0.38, 0.38])
