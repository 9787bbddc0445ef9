"""Plugins of rotors_simulator: commands, motor states, IMU and odometry."""

import math

import numpy as np
import pytest
from tests.devices.air.multicopters import HOVER, UP, G, bee, climb, command, motor

from cartwheel.geometry import Pose


def plugin(name, tags):
    return f"""<plugin name="one" filename="librotors_gazebo_{name}.so">
      <robotNamespace>bee</robotNamespace>{tags}</plugin>"""


def test_commands_go_through_the_interface_to_the_motors(make):
    world = make.world()
    plugins = "".join(motor(n) for n in range(4)) + plugin("controller_interface", "")
    world.session.spawn(bee(make, plugins), pose=Pose((0, 0, 10)))
    world.publish("/bee/command/motor_speed", angular_velocities=[HOVER] * 4)
    world.run(15 * UP)
    assert climb(world, 0.2) == pytest.approx(0, abs=0.02)


def test_the_base_publishes_speeds_and_angles_in_the_order_of_their_numbers(make):
    world = make.world()
    plugins = "".join(motor(n) for n in range(4))
    base = plugin("multirotor_base_plugin", "<linkName>body</linkName>")
    world.session.spawn(bee(make, plugins + base), pose=Pose((0, 0, 10)))
    boxes = [world.mailbox(topic, size=1) for topic in ("/bee/motor_speed", "/bee/joint_states")]
    command(world, [100, 200, 300, 400])
    world.run(30 * UP)
    (speeds,), (states,) = (box.drain() for box in boxes)
    # Those that turn clockwise turn the other way about their axes.
    assert speeds.angular_velocities == pytest.approx([100, -200, 300, -400], rel=1e-3)
    assert states.name == [f"rotor_{n}_joint" for n in range(4)]
    assert speeds.header.frame_id == "body"


SILENT = "".join(
    f"<{name}>0</{name}>"
    for name in (
        "gyroscopeNoiseDensity",
        "gyroscopeBiasRandomWalk",
        "gyroscopeTurnOnBiasSigma",
        "accelerometerNoiseDensity",
        "accelerometerRandomWalk",
        "accelerometerTurnOnBiasSigma",
    )
)


def test_the_imu_feels_gravity_and_says_that_it_knows_no_orientation(make):
    tags = "<linkName>body</linkName>" + SILENT
    world = make.world()
    world.session.spawn(bee(make, plugin("imu_plugin", tags)), pose=Pose((0, 0, 0.025)))
    box = world.mailbox("/bee/imu", size=1)
    world.run(1.0)
    (message,) = box.drain()
    assert message.linear_acceleration.z == pytest.approx(G, abs=0.01)
    assert message.orientation_covariance.tolist() == [-1.0] * 9
    assert message.header.frame_id == "body"


def test_the_imus_noise_has_the_density_that_is_stated(make):
    density = 0.01
    tags = "<linkName>body</linkName>" + SILENT.replace(
        "<gyroscopeNoiseDensity>0", f"<gyroscopeNoiseDensity>{density}"
    )
    world = make.world()
    world.session.spawn(bee(make, plugin("imu_plugin", tags)), pose=Pose((0, 0, 0.025)))
    world.run(1.0)
    box = world.mailbox("/bee/imu", size=10_000)
    world.run(5.0)
    rates = np.array([message.angular_velocity.x for message in box.drain()])
    step = world.session.simulation.step_ns * 1e-9
    # The spread of a spread is 1/√(2n) of it, 2 % for a thousand: five of them.
    assert rates.std() == pytest.approx(density / math.sqrt(step), rel=0.12)


def test_odometry_publishes_the_truth_in_five_forms(make, read):
    world = make.world()
    tags = "<linkName>body</linkName><childFrameId>bee/eye</childFrameId>"
    model = bee(make, plugin("odometry_plugin", tags))
    world.session.spawn(model, pose=Pose.from_xyz_rpy((1, 2, 30), (0, 0, 1.0)))
    topics = ("pose", "pose_with_covariance", "position", "transform", "odometry")
    boxes = {topic: world.mailbox(f"/bee/{topic}", size=1) for topic in topics}
    world.run(0.5)
    reported = {topic: box.drain()[-1] for topic, box in boxes.items()}
    odometry = reported["odometry"]
    place = odometry.pose.pose.position
    # It falls for half a second, and is published until one step before the end.
    step = world.session.simulation.step_ns * 1e-9
    assert (place.x, place.y) == pytest.approx((1, 2))
    assert place.z == pytest.approx(30 - G * 0.5**2 / 2, abs=G * 0.5 * 2 * step)
    assert odometry.twist.twist.linear.z == pytest.approx(-G * 0.5, abs=2 * G * step)
    assert (odometry.header.frame_id, odometry.child_frame_id) == ("world", "bee/eye")
    assert reported["pose"].position == place
    assert reported["pose_with_covariance"].pose.pose.position == place
    assert reported["position"].point == place
    where = reported["transform"].transform.translation
    assert (where.x, where.y, where.z) == (place.x, place.y, place.z)
    (tf,) = read(world, "/tf", step)[-1].transforms
    assert (tf.header.frame_id, tf.child_frame_id) == ("world", "bee/eye")


def test_odometry_comes_every_so_many_steps_with_its_noise(make, read):
    tags = """<linkName>body</linkName><measurementDivisor>4</measurementDivisor>
      <noiseNormalPosition>0.1 0 0</noiseNormalPosition>
      <noiseUniformPosition>0 0.2 0</noiseUniformPosition>"""
    world = make.world()
    world.session.spawn(bee(make, plugin("odometry_plugin", tags)), pose=Pose((0, 0, 0.025)))
    world.run(1.0)
    reported = read(world, "/bee/odometry", 10.0)
    step = world.session.simulation.step_ns * 1e-9
    assert len(reported) == pytest.approx(10.0 / step / 4, abs=1)
    x = np.array([message.pose.pose.position.x for message in reported])
    y = np.array([message.pose.pose.position.y for message in reported])
    assert x.std() == pytest.approx(0.1, rel=0.2)
    assert y.std() == pytest.approx(0.2 / math.sqrt(3), rel=0.2)
    assert np.abs(y - y.mean()).max() <= 0.2 + 0.05
    assert reported[0].pose.covariance[0] == pytest.approx(0.01)
