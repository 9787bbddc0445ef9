"""Cars: the circle that they drive, and how they are measured."""

import math
from dataclasses import replace

import pytest
import trimesh
from tests.coded import coded
from tests.devices.drives.carts import (
    CAR,
    FRONT,
    RADIUS,
    ackermann,
    circle,
    path,
    spawn,
    turned,
)

from cartwheel.codes import devices
from cartwheel.description.model import Axis, Mesh
from cartwheel.devices.drives.drive import Drives
from cartwheel.geometry import Pose


def test_car_circles_about_one_point(make, cart, read):
    """Radius L / tan a at the rear axle; each front wheel square to the centre of the turn."""
    speed, angle, base, track = 0.6, 0.4, 0.4, 0.3
    world = spawn(make, cart(CAR, ackermann(), forks=FRONT))
    world.publish("/cmd_vel", linear_x=speed, angular_z=angle)
    world.run(2.0)
    extra = {topic: world.mailbox(topic, size=10_000) for topic in ("/distance", "/steerangle")}
    reported = read(world, "/odom", 8.0)
    radius = base / math.tan(angle)
    assert circle(path(reported)) == pytest.approx(radius, rel=0.03)
    assert turned(reported) / 7.99 == pytest.approx(speed / radius, rel=0.03)
    (drive,) = world.session.shared.get(Drives).all
    assert drive.commanded(speed, angle) == pytest.approx((speed, speed / radius))
    assert drive.commanded(-speed, angle) == pytest.approx((-speed, speed / radius))
    simulation = world.session.simulation
    left = simulation.joint_position("cart", "front_left_steering")
    right = simulation.joint_position("cart", "front_right_steering")
    assert left == pytest.approx(math.atan2(base, radius - track / 2), abs=0.01)
    assert right == pytest.approx(math.atan2(base, radius + track / 2), abs=0.01)
    angles = [message.data for message in extra["/steerangle"].drain()]
    assert angles[-1] == pytest.approx((left + right) / 2, abs=1e-3)
    ways = [message.data for message in extra["/distance"].drain()]
    assert ways[-1] - ways[0] == pytest.approx(speed * 7.99, rel=0.03)
    assert coded(world, devices.PLUGIN_PARAMETER_IGNORED)


def test_a_universal_joint_steers_about_its_first_axis_and_rolls_about_its_second(make, cart, read):
    """As for cars of Gazebo Classic whose front wheels have no forks."""
    speed, angle, base, track = 0.6, 0.4, 0.4, 0.3
    car = cart(CAR, ackermann().replace("_steering<", "_joint<"))
    front = [f"{name}_joint" for name in FRONT]
    joints = [
        # The wheel's frame is turned by -90 degrees about x.
        replace(joint, type="universal", axis=Axis(xyz=(0, -1, 0)), axis2=Axis(xyz=(0, 0, 1)))
        if joint.name in front
        else joint
        for joint in car.joints
    ]
    world = spawn(make, replace(car, joints=tuple(joints)))
    world.publish("/cmd_vel", linear_x=speed, angular_z=angle)
    world.run(2.0)
    steered = world.mailbox("/steerangle", size=10_000)
    radius = base / math.tan(angle)
    assert circle(path(read(world, "/odom", 8.0))) == pytest.approx(radius, rel=0.03)
    angles = [message.data for message in steered.drain()]
    left = math.atan2(base, radius - track / 2)
    right = math.atan2(base, radius + track / 2)
    assert angles[-1] == pytest.approx((left + right) / 2, abs=0.01)


def test_car_in_reverse_turns_the_way_it_is_commanded(make, cart, read):
    world = spawn(make, cart(CAR, ackermann(), forks=FRONT))
    world.publish("/cmd_vel", linear_x=-0.5, angular_z=0.4)
    world.run(1.0)
    reported = read(world, "/odom", 2.0)
    assert reported[-1].twist.twist.linear.x == pytest.approx(-0.5, rel=0.05)
    assert turned(reported) > 0


def test_car_is_measured_at_its_axles_where_meshes_are_elsewhere(make, cart, read, tmp_path):
    """As CAD exports them: each mesh where it is in the whole car, its frame set back by that."""
    base, away = 0.4, 5.0
    tyre = trimesh.creation.cylinder(radius=RADIUS, height=0.04)
    tyre.apply_translation((away, 0, 0))
    tyre.export(tmp_path / "tyre.stl")
    shape = Mesh(uri="tyre.stl", path=tmp_path / "tyre.stl")
    car = cart(CAR, ackermann(), forks=FRONT)
    front = [f"{name}_wheel" for name in FRONT]
    links = [
        replace(link, collisions=(replace(link.collisions[0], shape=shape, pose=back),))
        if link.name in front
        else link
        for link in car.links
        for back in [Pose((-away, 0, 0))]
    ]
    world = spawn(make, replace(car, links=tuple(links)))
    world.publish("/cmd_vel", linear_x=0.6, angular_z=0.4)
    world.run(2.0)
    assert circle(path(read(world, "/odom", 5.0))) == pytest.approx(base / math.tan(0.4), rel=0.03)
