"""Ground truth and changed properties of robots that others published."""

import hashlib
import math
import os
from pathlib import Path

import numpy as np
import pytest

import cartwheel as cw

ROOT = Path(__file__).parents[2]
CORPUS = Path(os.environ.get("CARTWHEEL_CORPUS", ROOT.parent / "shared" / "corpus"))
TURTLEBOT = "turtlebot3/turtlebot3_description/urdf/turtlebot3_"
ROBOTS = {
    "burger": f"{TURTLEBOT}burger.urdf.xacro",
    "waffle": f"{TURTLEBOT}waffle.urdf.xacro",
    "mir": "mir_robot/mir_description/urdf/mir.urdf.xacro",
    "rrbot": "gazebo_ros_demos/rrbot_description/urdf/rrbot.xacro",
}
CONTROLLERS = {"mir": "mir_robot/mir_description/config/diffdrive_controller.yaml"}
BASES = ("burger", "waffle", "mir")
COMMANDS = {"mir": "/mobile_base_controller/cmd_vel"}
G = 9.8

pytestmark = pytest.mark.skipif(
    not CORPUS.is_dir(), reason=f"no corpus of others' robots in {CORPUS}"
)


@pytest.fixture
def place():
    """Spawns a published robot in a world of its own."""
    worlds = []

    def placed(name, world="empty"):
        made = cw.World(world, lenient=True)
        worlds.append(made)
        height = 0.0 if name == "rrbot" else 0.02
        files = [CORPUS / CONTROLLERS[name]] if name in CONTROLLERS else []
        return made, made.spawn(CORPUS / ROBOTS[name], z=height, controllers=files)

    yield placed
    for world in worlds:
        world.close()


def drive(world, robot, name):
    """Drives for 2 s; some controllers stop after 0.5 s without a command."""
    for _ in range(10):
        robot.publish(COMMANDS.get(name, "/cmd_vel"), linear_x=0.2)
        world.run(0.2)


@pytest.mark.parametrize("name", BASES)
def test_a_base_drives_with_its_commanded_velocity(place, name):
    world, robot = place(name)
    world.run(1.0)
    drive(world, robot, name)
    # Wheels do not slip on average; the pitching of a base with casters adds some mm/s.
    assert robot.velocity.linear[0] == pytest.approx(0.2, abs=0.01)
    assert robot.velocity.angular[2] == pytest.approx(0, abs=0.02)
    speeds = {
        joint: robot.joints.velocities[joint] for joint in robot.joints.names if "wheel" in joint
    }
    casters = ("caster", "fl_", "fr_", "bl_", "br_")
    driven = [speed for joint, speed in speeds.items() if not any(map(joint.count, casters))]
    assert len(driven) == 2
    assert np.ptp(driven) < 0.05 * np.mean(driven)


@pytest.mark.parametrize("name", BASES)
def test_contacts_carry_the_weight(place, name):
    world, robot = place(name)
    world.run(3.0)
    forces = np.array([each.force for each in world.contacts(between=(robot, "ground_plane"))])
    # Standing still, for 2 s: the sum of the forces is the weight.
    assert forces.sum(axis=0) == pytest.approx((0, 0, robot.mass * G), rel=1e-2, abs=0.02 * G)
    wheels = {each.links[0] for each in world.contacts(robot)}
    assert len(wheels) >= 2


@pytest.mark.parametrize("name", BASES)
def test_a_heavier_base_accelerates_less(place, name):
    """In the air, a = F / m, with the mass before and after a change."""
    world, robot = place(name)
    robot.pose = cw.Pose((0, 0, 20))
    world.gravity = (0, 0, 0)
    heavy = max(robot.links, key=lambda link: robot.link(link).mass)
    found = []
    for factor in (1.0, 3.0):
        robot.link(heavy).mass *= factor
        robot.velocity = cw.Twist()
        robot.link(heavy).push((0, 0, 1.0), seconds=0.1)
        world.run(0.1)
        momentum = sum(
            robot.link(link).mass
            * (
                np.asarray(robot.link(link).velocity.linear)
                + np.cross(robot.link(link).velocity.angular, robot.link(link).center_of_mass)
                if robot.link(link).mass
                else np.zeros(3)
            )
            for link in robot.links
        )
        found.append((robot.mass, momentum[2]))
    (light, first), (heavier, second) = found
    assert heavier > light
    # The momentum is F t, whatever the mass. Offsets of the centres of mass are in the links' axes,
    # and the robot turns by less than 0.1 rad.
    assert first == pytest.approx(0.1, rel=0.05)
    assert second == pytest.approx(0.1, rel=0.05)


@pytest.mark.parametrize("name", BASES)
def test_ice_makes_the_wheels_slip(place, name):
    """Without friction, the wheels turn as commanded, but the base stays."""
    world, robot = place(name)
    world.run(1.0)
    compiled = world.session.simulation.model
    for link in robot.links:
        if any(each.links[0] == link for each in world.contacts(robot)):
            robot.link(link).friction = 0.0
    assert world.session.simulation.model is compiled
    before = robot.pose.x
    drive(world, robot, name)
    assert abs(robot.pose.x - before) < 0.02
    assert any(abs(speed) > 0.5 for speed in robot.joints.velocities.values())


@pytest.mark.parametrize("name", ROBOTS)
def test_reading_changes_no_bit(place, name):
    digests = []
    for reads in (False, True):
        world, robot = place(name)
        if name in BASES:
            robot.publish(COMMANDS.get(name, "/cmd_vel"), linear_x=0.2, angular_z=0.3)
        found = hashlib.sha256()
        for _ in range(100):
            world.run(0.005)
            if reads:
                assert world.contacts() or name == "rrbot" or world.time < 0.2
                for link in robot.links:
                    assert robot.link(link).acceleration
                assert np.isfinite(np.asarray(robot.joints.efforts)).all()
            data = world.session.simulation.data
            found.update(data.qpos.tobytes() + data.qvel.tobytes())
        digests.append(found.hexdigest())
    assert digests[0] == digests[1]


def test_a_burger_sees_a_wall_that_moves(place):
    world, robot = place("burger", world="empty")
    wall = world.spawn(_wall(), name="wall", x=2.0)
    scans = world.mailbox("/scan", size=1)
    for distance in (2.0, 1.5, 3.0):
        wall.pose = cw.Pose((distance, 0.0, 0.0))
        world.run(1.0)
        # The laser is 32 mm behind the base, and has noise of 1 cm.
        front = scans.drain()[-1].ranges[0]
        laser = robot.link("base_scan").pose.x
        assert front == pytest.approx(distance - 0.1 - laser, abs=0.06)


def _wall():
    from cartwheel.description import load_text

    return load_text(
        """<sdf version="1.7"><model name="wall"><static>1</static><link name="l">
        <collision name="c"><pose>0 0 0.5 0 0 0</pose><geometry><box><size>0.2 4 1</size></box>
        </geometry></collision><visual name="v"><pose>0 0 0.5 0 0 0</pose><geometry><box>
        <size>0.2 4 1</size></box></geometry></visual></link></model></sdf>""",
        file="wall.sdf",
    )


def test_an_arm_swings_and_is_damped(place):
    """Damping of the joints takes the energy out of a double pendulum."""
    world, arm = place("rrbot")
    names = arm.joints.names
    assert len(names) == 2
    arm.joints.positions = {names[0]: math.pi / 2, names[1]: 0.0}
    world.run(0.2)
    assert abs(arm.joints.velocities[names[0]]) > 0.5
    compiled = world.session.simulation.model
    arm.joints.damping = [20.0, 20.0]
    world.run(20.0)
    assert world.session.simulation.model is compiled
    assert np.abs(np.asarray(arm.joints.velocities)).max() < 0.05
    # It hangs down: both links point to the floor.
    assert math.cos(arm.joints.positions[names[0]]) == pytest.approx(-1, abs=0.05)


def test_an_arm_is_held_by_an_effort(place):
    """The effort against gravity is the moment of all links about the joint."""
    world, arm = place("rrbot")
    first, second = arm.joints.names
    arm.joints.positions = {first: 0.7, second: 0.0}
    efforts = {}
    for joint, start in ((first, 0), (second, 1)):
        carried = _carried(arm, world, start)
        efforts[joint] = carried
    arm.joints.efforts = efforts
    # Both links are in equilibrium, so nothing accelerates.
    for link in arm.links:
        acceleration = arm.link(link).acceleration
        assert acceleration.angular == pytest.approx((0, 0, 0), abs=1e-6)


def _carried(arm, world, number):
    """The moment about a joint, by virtual work: of the weights of the links that it carries."""
    joint = arm.joints.names[number]
    position = arm.joints.positions[joint]
    small = 1e-4
    energies = []
    for side in (1, -1):
        arm.joints.positions[joint] = position + side * small
        energy = 0.0
        for link in arm.links:
            handle = arm.link(link)
            if handle.mass:
                energy += handle.mass * G * handle.pose.apply(handle.center_of_mass)[2]
        energies.append(energy)
    arm.joints.positions[joint] = position
    return (energies[0] - energies[1]) / (2 * small)
