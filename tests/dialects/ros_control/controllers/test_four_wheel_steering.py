"""ROS 1's controller of four steered wheels: turns, sideways motion and odometry."""

import math

import pytest
import yaml
from tests.coded import coded
from tests.dialects.ros_control.arms import ROS1, transmission
from tests.dialects.ros_control.cars import BASE, CORNERS, RADIUS, TRACK, car, heading

from cartwheel.codes import devices, robot, running

TYPE = "four_wheel_steering_controller/FourWheelSteeringController"


class FourWheels:
    def __init__(self, make, folder, *, edit=str, **settings):
        path, file = folder / "car.urdf", folder / "drive.yaml"
        joints = "".join(
            transmission(f"{name}_joint", "Velocity") + transmission(f"{name}_steer", "Position")
            for name in CORNERS
        )
        places = {name: (x * BASE / 2, y * TRACK / 2, True) for name, (x, y) in CORNERS.items()}
        path.write_text(edit(car(places, ROS1, (), joints)))
        names = {
            f"{axle}_{kind}": [f"{axle}_{side}_{end}" for side in ("left", "right")]
            for axle in ("front", "rear")
            for kind, end in (("wheel", "joint"), ("steering", "steer"))
        }
        file.write_text(yaml.safe_dump({"base": {"type": TYPE, **names, **settings}}))
        self.world = make.world()
        self.model = self.world.spawn(path, z=RADIUS, controllers=[file])
        self.world.run(0.2)

    def twist(self, seconds, forward, turn):
        for _ in range(round(seconds * 10)):
            self.world.publish("/base/cmd_vel", linear_x=forward, angular_z=turn)
            self.world.run(0.1)

    def angles(self, seconds, speed, front, rear):
        for _ in range(round(seconds * 10)):
            self.world.publish(
                "/base/cmd_four_wheel_steering",
                speed=speed,
                front_steering_angle=front,
                rear_steering_angle=rear,
            )
            self.world.run(0.1)

    @property
    def place(self):
        pose = self.model.pose
        return pose.x, pose.y, pose.yaw

    def moved(self, begin):
        """Way in the axes of the first place in m, and rotation in rad."""
        x, y, yaw = self.place
        way = complex(x - begin[0], y - begin[1]) * complex(math.cos(begin[2]), -math.sin(begin[2]))
        return way.real, way.imag, math.remainder(yaw - begin[2], 2 * math.pi)


def test_a_twist_turns_it_about_a_point_beside_it(make, tmp_path):
    made = FourWheels(make, tmp_path)
    made.twist(0.5, 0.3, 0.5)
    begin = made.place
    made.twist(2.0, 0.3, 0.5)
    x, y, turn = made.moved(begin)
    assert turn == pytest.approx(1.0, rel=0.05)
    assert math.hypot(x, y) == pytest.approx(2 * 0.3 / 0.5 * math.sin(0.5), rel=0.05)
    assert math.atan2(y, x) == pytest.approx(0.5, abs=0.05)


def test_equal_angles_move_it_sideways_without_a_turn(make, tmp_path):
    made = FourWheels(make, tmp_path)
    made.angles(0.7, 0.3, 0.4, 0.4)
    begin = made.place
    made.angles(2.0, 0.3, 0.4, 0.4)
    x, y, turn = made.moved(begin)
    assert (x, y) == pytest.approx((0.6 * math.cos(0.4), 0.6 * math.sin(0.4)), rel=0.05)
    assert turn == pytest.approx(0.0, abs=0.02)


def test_opposite_angles_turn_it(make, tmp_path):
    made = FourWheels(make, tmp_path)
    made.angles(0.7, 0.3, 0.3, -0.3)
    begin = made.place
    made.angles(2.0, 0.3, 0.3, -0.3)
    assert made.moved(begin)[2] == pytest.approx(2 * 0.3 * 2 * math.tan(0.3) / BASE, rel=0.05)


def test_odometry_and_measured_angles_are_published(make, tmp_path):
    covariance = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
    made = FourWheels(make, tmp_path, publish_rate=20, pose_covariance_diagonal=covariance)
    box, states, frames = (
        made.world.graph.mailbox(topic, size=1000)
        for topic in ("/base/odom", "/base/odom_steer", "/tf")
    )
    begin = made.place
    made.twist(2.0, 0.3, 0.5)
    odometry, state = box.drain(), states.drain()
    assert len(odometry) == len(state) == len(frames.drain()) == 40
    reported, moved = odometry[-1], made.moved(begin)
    assert heading(reported) == pytest.approx(moved[2], rel=0.05)
    place = reported.pose.pose.position
    assert math.hypot(place.x, place.y) == pytest.approx(math.hypot(*moved[:2]), rel=0.05)
    assert reported.twist.twist.linear.x == pytest.approx(0.3, rel=0.02)
    assert reported.twist.twist.angular.z == pytest.approx(0.5, rel=0.02)
    assert reported.pose.covariance[7] == 2.0
    angle = math.atan(0.5 * BASE / 2 / 0.3)
    data = state[-1].data
    assert data.front_steering_angle == pytest.approx(angle, rel=0.01)
    assert data.rear_steering_angle == pytest.approx(-angle, rel=0.01)
    assert data.speed == pytest.approx(0.3, rel=0.02)
    assert data.acceleration == pytest.approx(0.0, abs=0.05)


@pytest.mark.parametrize("kind", ["twist", "angles"])
def test_a_command_expires(make, tmp_path, kind):
    made = FourWheels(make, tmp_path, cmd_vel_timeout=0.3)
    getattr(made, kind)(0.5, 0.3, *((0.5,) if kind == "twist" else (0.2, 0.2)))
    made.world.run(1.0)
    before = made.place
    made.world.run(0.5)
    assert math.dist(before[:2], made.place[:2]) < 0.005


def test_limits_bind(make, tmp_path):
    limits = {"has_velocity_limits": True, "max_velocity": 0.1}
    made = FourWheels(make, tmp_path, linear={"x": limits})
    made.twist(0.5, 0.5, 0.0)
    begin = made.place
    made.twist(1.0, 0.5, 0.0)
    assert made.moved(begin)[0] == pytest.approx(0.1, rel=0.05)


def test_an_axle_of_three_wheels_is_reported(make, tmp_path):
    names = ["front_left_joint", "front_right_joint", "rear_left_joint"]
    made = FourWheels(make, tmp_path, front_wheel=names)
    (reported,) = coded(made.world, running.CONTROLLER_NOT_STARTED)
    assert reported.values["parameter"] == "front_wheel"
    assert not coded(made.world, devices.CONTROLLER_PARAMETER_UNKNOWN)


def test_a_wheel_base_that_is_not_positive_is_reported(make, tmp_path):
    made = FourWheels(make, tmp_path, wheel_base=0.0)
    (reported,) = coded(made.world, running.CONTROLLER_NOT_STARTED)
    assert reported.values["parameter"] == "wheel_base"


MIRRORED = {"front": "rear", "rear": "front", "left": "right", "right": "left"}


@pytest.mark.parametrize(
    ("names", "wrong"), [(MIRRORED, 0), ({"left": "right", "right": "left"}, 4), ({}, 4)]
)
def test_a_robot_that_faces_backward_has_no_reversed_axes(make, tmp_path, names, wrong):
    """Its front axle and its left wheels are where the rear axle and the right ones of others are.

    With the front axle in front, it would steer to the wrong side.
    """

    def joints(axle, end):
        return [
            f"{names.get(axle, axle)}_{names.get(side, side)}_{end}" for side in ("left", "right")
        ]

    settings = {
        f"{axle}_{kind}": joints(axle, end)
        for axle in ("front", "rear")
        for kind, end in (("wheel", "joint"), ("steering", "steer"))
    }

    def edit(text):
        return text.replace('<axis xyz="0 1 0"/>', '<axis xyz="0 -1 0"/>')

    made = FourWheels(make, tmp_path, edit=edit, **settings)
    assert len(coded(made.world, robot.WHEEL_AXIS_MISALIGNED)) == wrong
    if not wrong:
        made.twist(0.5, 0.3, 0.5)
        begin = made.place
        made.twist(2.0, 0.3, 0.5)
        x, _, turn = made.moved(begin)
        assert x < -0.4
        assert turn == pytest.approx(1.0, rel=0.05)
