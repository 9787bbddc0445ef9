"""The direction in which a base drives, by its wheels."""

import pytest
import yaml
from tests.corpus.carts import cart, controlled, written
from tests.dialects.ros_control.arms import ros2_parameters, ros2_plugin
from tests.dialects.ros_control.cars import BASE, RADIUS, TRACK, car, four_wheels

from cartwheel.checks.robot import Robot
from cartwheel.codes.robot import WHEEL_AXIS_MISALIGNED, WHEELS_SWAPPED
from cartwheel.corpus import try_robot
from cartwheel.corpus.heading import FORWARD, heading, rolling
from cartwheel.description import load_text

LINK = (
    '<link name="{name}">'
    '<inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/>'
    "</inertial><collision><geometry>{shape}</geometry></collision></link>"
)
JOINT = (
    '<joint name="{name}_joint" type="continuous"><parent link="base"/><child link="{name}"/>'
    '<origin xyz="{at}"/><axis xyz="{axis}"/></joint>'
)


DRIVE = """<gazebo><plugin name="drive" filename="libgazebo_ros_diff_drive.so">
  <left_joint>left_joint</left_joint><right_joint>right_joint</right_joint></plugin></gazebo>"""


def robot(*turning, tags=""):
    """A box with links that turn: name, place of the joint, and axis."""
    text = LINK.format(name="base", shape='<box size="0.4 0.4 0.1"/>')
    for name, at, axis in turning:
        text += LINK.format(name=name, shape='<sphere radius="0.05"/>')
        text += JOINT.format(name=name, at=at, axis=axis)
    return Robot(load_text(f'<robot name="robot">{text}{tags}</robot>'), None)


LIDAR = ("lidar", "0 0 0.3", "1 0 0")

CAMERA = (
    '<gazebo reference="base"><sensor type="camera" name="eye"><pose>0 0 0 0 0 {yaw}</pose><camera>'
    "<horizontal_fov>1</horizontal_fov><image><width>8</width><height>8</height></image>"
    "</camera></sensor></gazebo>"
)


@pytest.mark.parametrize("wheels", [(), (("left", "0 0.2 -0.05", "0 1 0"),)])
def test_what_turns_above_the_ground_is_no_wheel(wheels):
    speeds = {"lidar_joint": 5.0, "left_joint": 2.0}
    assert heading(robot(LIDAR, *wheels), speeds) == pytest.approx(FORWARD)


def test_a_base_drives_along_its_wheels_also_if_they_roll_along_y():
    left, right = (("left", "0.2 0 -0.05", "1 0 0"), ("right", "-0.2 0 -0.05", "1 0 0"))
    x, y = heading(robot(left, right), {"left_joint": 2.0, "right_joint": 2.0})
    assert (x, abs(y)) == pytest.approx((0.0, 1.0))


def test_a_caster_that_rolls_to_the_side_does_not_change_where_the_driven_wheels_roll():
    """A robot that faces along y, with a caster of one axis, along y, that sliding turns."""
    wheels = (("left", "-0.2 0 -0.05", "1 0 0"), ("right", "0.2 0 -0.05", "1 0 0"))
    caster = ("caster", "0 -0.2 -0.05", "0 1 0")
    speeds = {"left_joint": 2.0, "right_joint": 2.0, "caster_joint": 5.0}
    assert heading(robot(*wheels, caster, tags=DRIVE), speeds) == pytest.approx((0.0, 1.0))
    assert heading(robot(*wheels, caster), speeds) == pytest.approx(FORWARD)


@pytest.mark.parametrize(
    ("left", "axis", "x"), [(0.2, 1, 1), (-0.2, -1, -1), (0.2, -1, 1), (-0.2, 1, 1)]
)
@pytest.mark.parametrize("eyes", [(), (3.14,), (0,), (3.14, 0)])
def test_a_robot_whose_sides_axes_and_cameras_are_mirrored_faces_backwards(left, axis, x, eyes):
    """It turns as commanded. With one of both alone, it turns or drives in the wrong direction."""
    wheels = [("left", left), ("right", -left)]
    tags = DRIVE + "".join(CAMERA.format(yaw=yaw).replace("eye", f"eye{yaw}") for yaw in eyes)
    found = robot(*((name, f"0 {y} -0.05", f"0 {axis} 0") for name, y in wheels), tags=tags)
    x = x if eyes == (3.14,) else 1
    speeds = {"left_joint": 2.0, "right_joint": 2.0}
    assert heading(found, speeds) == pytest.approx((x, 0.0))


def test_mirrored_wheels_roll_in_one_direction():
    wheels = [
        (f"{end}_{side}", f"{x} {y} -0.05", f"0 {axis} 0")
        for end, x in (("front", 0.1), ("rear", -0.1))
        for side, y, axis in (("left", 0.2, 1), ("right", -0.2, -1))
    ]
    names = [f"{name}_joint" for name, _, _ in wheels]
    signs = rolling(robot(LIDAR, *wheels), [*names, "lidar_joint", "none"])
    assert set(signs) == set(names)
    assert {sign * (1 if "left" in name else -1) for name, sign in signs.items()} in ({1}, {-1})


def test_wheels_that_are_not_parallel_have_no_common_direction():
    wheels = [("a", "0.2 0 -0.05", "1 0 0"), ("b", "0 0.2 -0.05", "0 1 0")]
    assert rolling(robot(*wheels), ["a_joint", "b_joint"]) == {}


@pytest.mark.parametrize(
    ("swapped", "camera", "wrong"),
    [
        (True, CAMERA.format(yaw=3.14), {}),
        (True, "", {"drive": WHEELS_SWAPPED}),
        (False, "", dict.fromkeys(("drive", "turn"), WHEEL_AXIS_MISALIGNED)),
    ],
)
def test_a_robot_with_a_controller_may_face_backward(tmp_path, swapped, camera, wrong):
    """With the wheels on their own sides, only the axes are wrong."""
    mirrored = cart().replace('<axis xyz="0 0 1"/>', '<axis xyz="0 0 -1"/>')
    path = written(tmp_path, mirrored, camera, controlled(tmp_path, swapped=swapped))
    verdict = try_robot(path, standing=1.0)
    (drive,) = verdict.drives
    assert drive.measured == pytest.approx(-0.2 if wrong else 0.2, rel=0.05)
    assert {each.test: each.code for each in verdict.faults} == wrong


@pytest.mark.parametrize("swapped", [True, False])
def test_a_robot_with_steered_wheels_may_face_backward(tmp_path, swapped):
    """Its controller lists the right wheels first. On their own sides, only the axes are wrong."""
    sides = ("left", "right") if swapped else ("right", "left")
    settings = {
        "type": "ackermann_steering_controller/AckermannSteeringController",
        "traction_joints_names": [f"rear_{side}_joint" for side in sides],
        "steering_joints_names": [f"front_{side}_steer" for side in sides],
        "wheelbase": BASE,
        "traction_track_width": TRACK,
        "steering_track_width": TRACK,
        "traction_wheels_radius": RADIUS,
    }
    file = tmp_path / "drive.yaml"
    file.write_text(yaml.safe_dump(ros2_parameters(base=settings)))
    wheels = {
        name: (-x if swapped else x, y, steered)
        for name, (x, y, steered) in four_wheels(steered=True).items()
    }
    text = car(wheels, ros2_plugin(file), file.read_text())
    path = tmp_path / "car.urdf"
    path.write_text(text.replace('<axis xyz="0 1 0"/>', '<axis xyz="0 -1 0"/>'))
    verdict = try_robot(path, standing=1.0)
    (drive,) = verdict.drives
    assert drive.measured == pytest.approx(0.2 if swapped else -0.2, rel=0.05)
    assert {each.test: each.code for each in verdict.faults} == (
        {} if swapped else dict.fromkeys(("drive", "turn"), WHEEL_AXIS_MISALIGNED)
    )
