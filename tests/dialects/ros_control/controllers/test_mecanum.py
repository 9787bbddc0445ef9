"""Mecanum wheels: their speeds for a motion, and the motion that their speeds give."""

import math

import pytest
from tests.coded import coded
from tests.dialects.ros_control.cars import BASE, RADIUS, TRACK, Car, four_wheels, heading, rollers

from cartwheel.codes import devices, robot

REACH = (BASE + TRACK) / 2
NAMES = ("front_left", "front_right", "rear_left", "rear_right")


@pytest.fixture(params=["", rollers()], ids=["pushed", "on rollers"])
def drive(make, tmp_path, request):
    """With wheels like any others a servo pushes it; rollers take it along by friction."""

    def made(**more):
        settings = {
            "type": "mecanum_drive_controller/MecanumDriveController",
            **{f"{name}_wheel_command_joint_name": f"{name}_joint" for name in NAMES},
            "kinematics": {
                "wheels_radius": RADIUS,
                "sum_of_robot_center_projection_on_X_Y_axis": REACH,
                **more.pop("kinematics", {}),
            },
            **more,
        }
        return Car(make, tmp_path, four_wheels(), "reference", request.param, **settings)

    return made


def wheels(x, y, turn):
    """The rim of each wheel goes as the rollers' axes, at 45°, let it: rad/s."""
    signs = ((-1, -1), (1, 1), (1, -1), (-1, 1))
    return [(x + side * y + round_ * REACH * turn) / RADIUS for side, round_ in signs]


@pytest.mark.parametrize(
    "motion", [(0.3, 0.0, 0.0), (0.0, 0.3, 0.0), (0.0, 0.0, 0.6), (0.2, -0.1, 0.4)]
)
def test_each_wheel_turns_as_the_kinematics_say(drive, motion):
    made = drive()
    made.go(0.3, *motion)
    found = made.speeds(*(f"{name}_joint" for name in NAMES))
    assert found == pytest.approx(wheels(*motion), abs=0.05)


def test_wheels_and_the_wanted_motion_are_published(drive):
    made = drive()
    box = made.world.mailbox("/base/controller_state", size=1000)
    made.go(0.5, 0.2, -0.1, 0.4)
    state = box.drain()[-1]
    wanted = state.reference_velocity
    assert (wanted.linear.x, wanted.linear.y, wanted.angular.z) == (0.2, -0.1, 0.4)
    corners = ("front_left", "front_right", "back_left", "back_right")
    found = [getattr(state, f"{corner}_wheel_velocity") for corner in corners]
    assert found == pytest.approx(wheels(0.2, -0.1, 0.4), abs=0.05)
    assert state.header.frame_id == "odom"


def test_wheels_without_friction_turn_but_do_not_move_the_robot(make, tmp_path):
    """Another plugin pushes such a robot, which the controller must not hinder."""
    slippery = "".join(
        f'<gazebo reference="{name}"><mu1>0</mu1><mu2>0</mu2></gazebo>' for name in NAMES
    )
    settings = {
        "type": "mecanum_drive_controller/MecanumDriveController",
        **{f"{name}_wheel_command_joint_name": f"{name}_joint" for name in NAMES},
        "kinematics": {
            "wheels_radius": RADIUS,
            "sum_of_robot_center_projection_on_X_Y_axis": REACH,
        },
    }
    made = Car(make, tmp_path, four_wheels(), "reference", slippery, **settings)
    start = made.world.model("car").pose
    made.go(1.0, 0.3, 0.0, 0.0)
    found = made.speeds(*(f"{name}_joint" for name in NAMES))
    assert found == pytest.approx(wheels(0.3, 0.0, 0.0), abs=0.05)
    assert made.world.model("car").pose.x - start.x == pytest.approx(0.0, abs=0.005)
    codes_found = [each.code for each in made.world.diagnostics]
    assert robot.WHEEL_FRICTIONLESS in codes_found


def test_husarions_controller_of_the_same_name_has_its_own_parameters(make, tmp_path):
    """Separations and factors in place of their sum; ``cmd_vel`` and ``odom``; half a second."""
    settings = {
        "type": "mecanum_drive_controller/MecanumDriveController",
        **{f"{name}_wheel_name": f"{name}_joint" for name in NAMES},
        "wheel_separation_x": BASE / 2,
        "wheel_separation_x_multiplier": 2.0,
        "wheel_separation_y": TRACK,
        "wheel_radius": RADIUS * 2,
        "wheel_radius_multiplier": 0.5,
        "use_stamped_vel": True,
        "position_feedback": False,
        "open_loop": True,
    }
    made = Car(make, tmp_path, four_wheels(), "cmd_vel", **settings)
    motion = (0.2, -0.1, 0.4)
    made.go(0.3, *motion)
    found = made.speeds(*(f"{name}_joint" for name in NAMES))
    assert found == pytest.approx(wheels(*motion), abs=0.05)
    made.go(1.0, y=0.3)
    assert made.odometry("/base/odom").twist.twist.linear.y == pytest.approx(0.3, rel=0.05)
    (reported,) = coded(made.world, devices.CONTROLLER_PARAMETER_UNKNOWN)
    assert reported.values["parameters"] == ("open_loop",)
    made.world.run(0.8)
    assert made.odometry("/base/odom").twist.twist.linear.y == pytest.approx(0, abs=0.02)


def test_it_goes_sideways_and_its_odometry_knows(drive):
    made = drive()
    x, y, _ = made.place
    made.go(2.0, y=0.3)
    end = made.place
    assert end[1] - y == pytest.approx(0.6, rel=0.05)
    assert abs(end[0] - x) < 0.02
    assert abs(end[2]) < 0.03
    reported = made.odometry()
    assert reported.pose.pose.position.y == pytest.approx(0.6, rel=0.08)
    assert reported.twist.twist.linear.y == pytest.approx(0.3, rel=0.05)


def test_a_circle_sideways_closes(drive):
    """Going left and turning left: a circle of radius v / w, its centre ahead or behind."""
    made = drive()
    start = made.place
    made.go(2 * math.pi / 0.8, y=0.2, turn=0.8)
    assert math.dist(made.place[:2], start[:2]) < 0.05


def test_a_command_counts_until_the_next_unless_a_time_is_stated(drive):
    made = drive()
    made.send(x=0.2)
    made.world.run(3.0)
    assert made.speeds("front_left_joint")[0] == pytest.approx(2.0, rel=0.02)


def test_with_a_time_stated_it_ends(drive):
    made = drive(reference_timeout=0.5)
    made.send(x=0.2)
    made.world.run(1.0)
    assert made.speeds("front_left_joint")[0] == pytest.approx(0.0, abs=0.02)


def test_limits_bind_in_all_three_directions(drive):
    limits = {
        "linear.x.max_velocity": 0.1,
        "linear.y.max_velocity": 0.2,
        "angular.z.max_velocity": 0.3,
    }
    made = drive(**limits)
    made.go(0.5, 1.0, 1.0, 1.0)
    found = made.speeds(*(f"{name}_joint" for name in NAMES))
    assert found == pytest.approx(wheels(0.1, 0.2, 0.3), abs=0.05)


def test_the_base_frame_may_be_off_the_wheels_centre(drive):
    """To turn about a point 0.2 m behind it, the wheels' centre goes sideways as well."""
    made = drive(kinematics={"base_frame_offset": {"x": 0.2, "y": 0.0, "theta": 0.0}})
    made.go(1.0, turn=0.5)
    found = made.speeds(*(f"{name}_joint" for name in NAMES))
    assert found == pytest.approx(wheels(0.0, -0.2 * 0.5, 0.5), abs=0.05)
    reported = made.odometry()
    # The base frame itself only turns.
    assert abs(reported.twist.twist.linear.x) < 0.01
    assert abs(reported.twist.twist.linear.y) < 0.01
    assert reported.twist.twist.angular.z == pytest.approx(0.5, rel=0.05)
    assert math.hypot(reported.pose.pose.position.x, reported.pose.pose.position.y) < 0.01
    assert heading(reported) == pytest.approx(0.5 * 1.15, rel=0.15)


@pytest.mark.parametrize("swapped", [True, False])
def test_a_robot_that_faces_backward_has_no_reversed_axes(make, tmp_path, swapped):
    """Its left front wheel is where the right rear wheel of others is."""
    others = dict(zip(NAMES, reversed(NAMES) if swapped else NAMES, strict=True))
    settings = {
        "type": "mecanum_drive_controller/MecanumDriveController",
        **{f"{name}_wheel_command_joint_name": f"{others[name]}_joint" for name in NAMES},
        "kinematics": {
            "wheels_radius": RADIUS,
            "sum_of_robot_center_projection_on_X_Y_axis": REACH,
        },
    }

    def edit(text):
        return text.replace('<axis xyz="0 1 0"/>', '<axis xyz="0 -1 0"/>')

    made = Car(make, tmp_path, four_wheels(), "reference", edit=edit, **settings)
    found = coded(made.world, robot.WHEEL_AXIS_MISALIGNED)
    assert [each.values.get("all") for each in found] == ([] if swapped else [True] * 4)
    made.go(2.0, x=0.3)
    assert made.place[0] == pytest.approx(-0.6, rel=0.1)
