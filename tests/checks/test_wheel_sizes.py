"""What drives say of their wheels, against a car whose sizes are known."""

# ruff: noqa: E501  (a case is a table row)

from __future__ import annotations

import re

import pytest
import yaml

from cartwheel.checks.controller_files import ControlFile
from cartwheel.checks.robot import Robot
from cartwheel.checks.sliding import Contact, base_motion
from cartwheel.checks.stated_sizes import _of_controller
from cartwheel.codes.robot import SKID_STEERING, WHEEL_BASE_MISMATCH, WHEEL_DIAMETER_MISMATCH
from cartwheel.description import load_text

BASE, TRACK, KINGPINS, RADIUS = 0.5, 0.3, 0.26, 0.1
"""m: between the axles, between the wheels, between the steered joints, of the wheels."""
CORNERS = {
    "front_left": (1, 1),
    "front_right": (1, -1),
    "rear_left": (-1, 1),
    "rear_right": (-1, -1),
}


def link(name, more=""):
    return (
        f'<link name="{name}"><inertial><mass value="1"/><inertia ixx="0.005" iyy="0.005" '
        f'izz="0.005" ixy="0" ixz="0" iyz="0"/></inertial>{more}</link>\n'
    )


def joint(name, ends, xyz, axis, kind="continuous"):
    parent, child = ends
    limit = '<limit lower="-1" upper="1" effort="5" velocity="5"/>' if kind == "revolute" else ""
    return (
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        f'<origin xyz="{xyz}"/><axis xyz="{axis}"/>{limit}</joint>\n'
    )


WHEEL = (
    '<collision><origin rpy="1.5707963 0 0"/><geometry>'
    f'<cylinder radius="{RADIUS}" length="0.02"/></geometry></collision>'
)


def car(plugin="", base=BASE):
    """Front wheels on forks, rear ones on the body."""
    parts = [link("base_link")]
    for name, (ahead, left) in CORNERS.items():
        x, y = ahead * base / 2, left * TRACK / 2
        parent, place = "base_link", f"{x} {y} 0"
        if ahead > 0:
            fork = f"{name}_fork"
            parts.append(link(fork))
            at = f"{x} {left * KINGPINS / 2} 0"
            parts.append(joint(f"{name}_steer", ("base_link", fork), at, "0 0 1", "revolute"))
            parent, place = fork, f"0 {y - left * KINGPINS / 2} 0"
        else:
            # Balances the fork.
            parts.append(link(f"{name}_ballast"))
            ends = "base_link", f"{name}_ballast"
            parts.append(joint(f"{name}_holder", ends, f"{x} 0 0", "0 1 0", "fixed"))
        parts.append(link(f"{name}_wheel", WHEEL))
        parts.append(joint(f"{name}_joint", (parent, f"{name}_wheel"), place, "0 1 0"))
    body = "".join(parts)
    return (
        f'<?xml version="1.0"?>\n<robot name="car">\n{body}<gazebo>\n{plugin}</gazebo>\n</robot>\n'
    )


def plugin(filename, **tags):
    inner = "".join(f"<{tag}>{value}</{tag}>\n" for tag, value in tags.items())
    return f'<plugin name="p" filename="{filename}">\n{inner}</plugin>\n'


REAR = {"left_joint": "rear_left_joint", "right_joint": "rear_right_joint"}
STEERED = {"left_steering_joint": "front_left_steer", "right_steering_joint": "front_right_steer"}
ACKERMANN = {
    **REAR, **STEERED, "wheel_separation": TRACK, "kingpin_width": KINGPINS, "wheel_base": BASE,
    "wheel_radius": RADIUS,
}  # fmt: skip
MECANUM = {
    "front_left_joint": "front_left_joint", "front_right_joint": "front_right_joint",
    "back_left_joint": "rear_left_joint", "back_right_joint": "rear_right_joint",
    "wheelbase": BASE, "wheel_separation": TRACK, "wheel_radius": RADIUS,
}  # fmt: skip
TRICYCLE = {
    "steeringJoint": "front_left_steer", "actuatedWheelJoint": "front_left_joint",
    "encoderWheelLeftJoint": "rear_left_joint", "encoderWheelRightJoint": "rear_right_joint",
    "actuatedWheelDiameter": 2 * RADIUS, "encoderWheelDiameter": 2 * RADIUS,
    "encoderWheelSeparation": TRACK,
}  # fmt: skip
NEW_TRICYCLE = {
    "steering_joint": "front_left_steer", "actuated_wheel_joint": "front_left_joint",
    "encoder_wheel_left_joint": "rear_left_joint", "encoder_wheel_right_joint": "rear_right_joint",
    "actuated_wheel_diameter": 2 * RADIUS, "encoder_wheel_diameter": 2 * RADIUS,
    "wheel_separation": TRACK,
}  # fmt: skip
KOBUKI = {
    "left_wheel_joint_name": "rear_left_joint", "right_wheel_joint_name": "rear_right_joint",
    "wheel_separation": TRACK, "wheel_diameter": 2 * RADIUS,
}  # fmt: skip
MULTI = {
    "leftJoints": "front_left_joint rear_left_joint",
    "rightJoints": "front_right_joint rear_right_joint",
    "wheelSeparation": TRACK, "wheelDiameter": 2 * RADIUS,
}  # fmt: skip
SKID = {
    "leftFrontJoint": "front_left_joint", "rightFrontJoint": "front_right_joint",
    "leftRearJoint": "rear_left_joint", "rightRearJoint": "rear_right_joint",
    "wheelSeparation": TRACK, "wheelDiameter": 2 * RADIUS,
}  # fmt: skip
PAIRS = {
    "num_wheel_pairs": 1, "left_joint": "rear_left_joint", "right_joint": "rear_right_joint",
    "wheel_separation": TRACK, "wheel_diameter": 2 * RADIUS,
}  # fmt: skip
DRIVES = {
    "gz-sim-ackermann-steering-system": ACKERMANN,
    "libignition-gazebo-ackermann-steering-system.so": ACKERMANN,
    "gz-sim-mecanum-drive-system": MECANUM,
    "libgazebo_ros_tricycle_drive.so": TRICYCLE,
    "gazebo_ros_tricycle_drive": NEW_TRICYCLE,
    "libgazebo_ros_kobuki.so": KOBUKI,
    "libdiffdrive_plugin_multi_wheel.so": MULTI,
    "libgazebo_ros_skid_steer_drive.so": SKID,
    "libgazebo_ros_diff_drive.so": PAIRS,
    "gz-sim-diff-drive-system": {**REAR, "wheel_separation": TRACK, "wheel_radius": RADIUS},
}
SIZES = {
    "wheel_separation": "wheel-separation-mismatch", "wheelSeparation": "wheel-separation-mismatch",
    "kingpin_width": "wheel-separation-mismatch", "encoderWheelSeparation": "wheel-separation-mismatch",
    "wheel_base": "wheel-base-mismatch", "wheelbase": "wheel-base-mismatch", "wheel_radius": "wheel-diameter-mismatch",
    "wheel_diameter": "wheel-diameter-mismatch", "wheelDiameter": "wheel-diameter-mismatch",
    "actuatedWheelDiameter": "wheel-diameter-mismatch", "encoderWheelDiameter": "wheel-diameter-mismatch",
    "actuated_wheel_diameter": "wheel-diameter-mismatch", "encoder_wheel_diameter": "wheel-diameter-mismatch",
}  # fmt: skip
STATED = [(name, tag) for name, tags in DRIVES.items() for tag in tags if tag in SIZES]


@pytest.fixture
def reported(bench):
    """What the rules of sizes say of a text."""
    return lambda text, **options: [
        finding
        for finding in bench.report(text, **options).findings
        if finding.code.name in SIZES.values()
    ]


@pytest.mark.parametrize("name", DRIVES)
def test_the_cars_own_sizes_are_no_fault(reported, name):
    assert reported(car(plugin(name, **DRIVES[name]))) == []


@pytest.mark.parametrize(("name", "tag"), STATED)
def test_a_size_that_is_not_the_cars_is_reported_with_its_own(reported, take, line_of, name, tag):
    # Below the car's own: a skid's separation may be wider.
    wrong = car(plugin(name, **{**DRIVES[name], tag: 0.8 * DRIVES[name][tag]}))
    (finding,) = reported(wrong)
    assert finding.code.name == SIZES[tag]
    assert finding.origin.line == line_of(wrong, f"<{tag}>")
    assert finding.instead == f"<{tag}>{DRIVES[name][tag]:g}</{tag}>"
    assert reported(take(wrong, finding)) == []


def turned(text):
    """The same car, facing along y: its joints are turned about the base."""

    def turn(match):
        x, y = float(match[2]), float(match[3])
        return f'{match[1]}<origin xyz="{-y} {x} 0" rpy="0 0 1.5707963267948966"/>'

    pattern = r'(<parent link="base_link"/><child link="\w+"/>)<origin xyz="(\S+) (\S+) 0"/>'
    return re.sub(pattern, turn, text)


@pytest.mark.parametrize("name", DRIVES)
def test_a_car_that_faces_along_y_is_measured_along_its_axles(reported, bench, name):
    text = turned(car(plugin(name, **DRIVES[name])))
    assert reported(text) == []
    for code in ("wheels-swapped", "wheel-axis-misaligned"):
        assert not bench.find(text, code)


@pytest.mark.parametrize(("name", "tag"), STATED)
def test_a_wrong_size_of_a_car_that_faces_along_y_is_corrected(reported, take, name, tag):
    wrong = turned(car(plugin(name, **{**DRIVES[name], tag: 0.8 * DRIVES[name][tag]})))
    (finding,) = reported(wrong)
    assert finding.code.name == SIZES[tag]
    assert finding.values["measured"] == pytest.approx(DRIVES[name][tag])
    assert reported(take(wrong, finding)) == []


@pytest.mark.parametrize("stated", [True, False])
def test_mecanum_wheels_whose_axes_all_point_to_the_right_roll_backwards(bench, stated):
    """The joints of a plugin without tags have the names of the tags."""
    tags = {key: value for key, value in MECANUM.items() if stated or not key.endswith("joint")}
    text = car(plugin("gz-sim-mecanum-drive-system", **tags))
    text = text if stated else text.replace("rear_left_joint", "back_left_joint")
    text = text if stated else text.replace("rear_right_joint", "back_right_joint")
    assert not bench.find(text, "wheel-axis-misaligned")
    found = bench.find(text.replace('xyz="0 1 0"', 'xyz="0 -1 0"'), "wheel-axis-misaligned")
    assert [each.values["attribute"] for each in found] == ["backwards"] * 4


def test_the_axes_define_the_sides_of_a_car_that_faces_along_y(bench):
    drive = plugin("libgazebo_ros_diff_drive.so", **PAIRS)
    swapped = turned(car(drive.replace("rear_left", "x").replace("rear_right", "rear_left")
                         .replace("<left_joint>x", "<left_joint>rear_right")))  # fmt: skip
    (finding,) = bench.find(swapped, "wheels-swapped")
    assert finding.values == {"left": "rear_right_joint", "right": "rear_left_joint"}
    assert not bench.find(swapped, "wheel-axis-misaligned")
    place = turned(car(drive)).index('<joint name="rear_right_joint"')
    text = turned(car(drive))
    reversed_ = text[:place] + text[place:].replace('xyz="0 1 0"', 'xyz="0 -1 0"', 1)
    (finding,) = bench.find(reversed_, "wheel-axis-misaligned")
    assert finding.values["joint"] == "rear_right_joint"


@pytest.mark.parametrize(
    ("name", "tag"), [each for each in STATED if each[0] != "libgazebo_ros_kobuki.so"]
)
def test_a_size_that_is_not_written_is_the_plugins_default(reported, take, name, tag):
    """None of the defaults is the car's, but for the kingpins', which are left out here."""
    tags = {key: value for key, value in DRIVES[name].items() if key != tag}
    text = car(plugin(name, **tags))
    skids = name in ("libgazebo_ros_skid_steer_drive.so", "libdiffdrive_plugin_multi_wheel.so")
    if skids and tag == "wheelSeparation":
        assert reported(text) == []  # 0.4 m or 0.34 m for 0.3 m: wider, as a skid's may be
        return
    (finding,) = reported(text)
    assert finding.place == "inside"
    assert reported(take(text, finding)) == []


def test_a_skid_steers_default_separation_is_its_plugins(reported):
    """The plugin uses 0.4 m without the tag, which is too little for a track of 0.5 m."""
    tags = {key: value for key, value in SKID.items() if key != "wheelSeparation"}
    text = car(plugin("libgazebo_ros_skid_steer_drive.so", **tags))
    for left in (1, -1):
        text = text.replace(
            f'xyz="0 {left * (TRACK - KINGPINS) / 2} 0"', f'xyz="0 {left * 0.12} 0"'
        )
        text = text.replace(f'xyz="-0.25 {left * TRACK / 2} 0"', f'xyz="-0.25 {left * 0.25} 0"')
    (finding,) = reported(text)
    assert finding.values["stated"] == 0.4
    assert finding.values["measured"] == pytest.approx(0.5)


@pytest.mark.parametrize("missing", [("leftFrontJoint", "leftRearJoint"), tuple(SKID)[:4]])
def test_sizes_are_compared_with_the_joints_that_a_plugin_uses_by_default(reported, take, missing):
    """The default joints are named left_front_joint and so on."""
    tags = {name: value for name, value in SKID.items() if name not in missing}
    text = car(plugin("libgazebo_ros_skid_steer_drive.so", **{**tags, "wheelSeparation": 0.2}))
    text = re.sub(r"(front|rear)_(left|right)_joint", r"\2_\1_joint", text)
    (finding,) = reported(text)
    assert finding.code.name == "wheel-separation-mismatch"
    assert finding.values["measured"] == pytest.approx(TRACK)
    assert reported(take(text, finding)) == []


def test_only_the_differential_drive_has_another_name_for_its_torque(bench):
    torque = {"torque": 1}
    for name in ("libgazebo_ros_kobuki.so", "libgazebo_ros_skid_steer_drive.so"):
        text = car(plugin(name, **DRIVES[name], **torque))
        assert not bench.find(text, "plugin-parameter-obsolete"), name
        assert bench.find(text.replace("<torque>1<", "<torque>0<"), "effort-zero"), name
    text = car(plugin("libgazebo_ros_diff_drive.so", **PAIRS, **torque))
    assert bench.find(text, "plugin-parameter-obsolete")


@pytest.mark.parametrize("base", [0.1, TRACK, BASE])
def test_skidding_wheels_may_be_said_to_be_as_far_apart_as_friction_asks(reported, base):
    """t (1 + (b/t)²) turns it rightly, and a quarter more is granted; the least is 2.5 t."""
    name = "libgazebo_ros_skid_steer_drive.so"
    most = max(2.5 * TRACK, 1.25 * TRACK * (1 + (base / TRACK) ** 2))

    def said(apart):
        return reported(car(plugin(name, **{**SKID, "wheelSeparation": apart}), base))

    for fine in (TRACK, 0.999 * most):
        assert said(fine) == []
    for wrong in (0.9 * TRACK, 1.001 * most):
        (finding,) = said(wrong)
        assert finding.code.name == "wheel-separation-mismatch"
        assert finding.instead == f"<wheelSeparation>{TRACK:g}</wheelSeparation>"


def test_the_driven_wheels_on_both_axles_of_a_car_do_not_skid(reported):
    """Unlike those of a skid-steered robot, they need no larger separation."""
    wheels = "".join(
        f"<{side}_joint>{end}_{side}_joint</{side}_joint>"
        for side in ("left", "right")
        for end in ("front", "rear")
    )
    stated = {
        name: ACKERMANN[name] for name in ACKERMANN if name not in ("left_joint", "right_joint")
    }
    text = plugin("gz-sim-ackermann-steering-system", **{**stated, "wheel_separation": 1.5 * TRACK})
    (finding,) = reported(car(text.replace("</plugin>", wheels + "</plugin>")))
    assert finding.instead == f"<wheel_separation>{TRACK:g}</wheel_separation>"


def test_the_distance_of_the_joints_of_wheels_beside_them_is_a_note(reported):
    """The tyres of the rear axle are 0.05 m further out than their joints, and turn the robot."""
    drive = {**REAR, "wheel_diameter": 2 * RADIUS}

    def said(separation):
        text = car(plugin("libgazebo_ros_diff_drive.so", **drive, wheel_separation=separation))
        for name, left in (("rear_left", 0.05), ("rear_right", -0.05)):
            start = text.index(f'<link name="{name}_wheel"')
            text = text[:start] + text[start:].replace(
                '<origin rpy="1.5707963 0 0"/>',
                f'<origin xyz="0 {left} 0" rpy="1.5707963 0 0"/>',
                1,
            )
        return reported(text)

    (note,) = said(TRACK)
    assert note.severity == "info" and note.values["measured"] == pytest.approx(TRACK + 0.1)
    assert said(TRACK + 0.1) == []
    (finding,) = said(TRACK + 0.3)
    assert finding.severity == "warning"
    assert finding.instead == f"<wheel_separation>{TRACK + 0.1:g}</wheel_separation>"


def test_a_pair_of_wheels_has_its_own_separation(reported):
    pairs = (
        '<plugin name="p" filename="libgazebo_ros_diff_drive.so"><num_wheel_pairs>2'
        "</num_wheel_pairs><left_joint>rear_left_joint</left_joint><left_joint>front_left_joint"
        "</left_joint><right_joint>rear_right_joint</right_joint><right_joint>front_right_joint"
        "</right_joint>\n<wheel_separation>0.3</wheel_separation>\n"
        "<wheel_separation>0.2</wheel_separation><wheel_diameter>0.2</wheel_diameter></plugin>"
    )
    (finding,) = reported(car(pairs))
    assert finding.instead == "<wheel_separation>0.3</wheel_separation>"
    assert finding.values["stated"] == pytest.approx(0.2)


ROS1_STEERED = f"""car:
  type: ackermann_steering_controller/AckermannSteeringController
  rear_wheel: rear_left_joint
  front_steer: front_left_steer
  wheel_separation_h: {BASE}
  wheel_radius: {RADIUS}
"""
ROS1_DIFF = f"""car:
  type: diff_drive_controller/DiffDriveController
  left_wheel: [rear_left_joint]
  right_wheel: [rear_right_joint]
  wheel_separation: {TRACK}
  wheel_radius: {RADIUS}
"""
ROS1_MECANUM = f"""car:
  type: mecanum_drive_controller/MecanumDriveController
  front_left_wheel_joint: front_left_joint
  front_right_wheel_joint: front_right_joint
  back_left_wheel_joint: rear_left_joint
  back_right_wheel_joint: rear_right_joint
  wheel_separation_x: {BASE}
  wheel_separation_y: {TRACK}
  wheel_radius: {RADIUS}
"""
ROS2 = """controller_manager:
  ros__parameters:
    car: {{type: {type}}}
car:
  ros__parameters:
"""
ROS2_DIFF = ROS2.format(type="diff_drive_controller/DiffDriveController") + (
    f"""    left_wheel_names: [rear_left_joint]
    right_wheel_names: [rear_right_joint]
    wheel_separation: {TRACK}
    wheel_radius: {RADIUS}
"""
)
ROS2_ACKERMANN = ROS2.format(type="ackermann_steering_controller/AckermannSteeringController") + (
    f"""    rear_wheels_names: [rear_right_joint, rear_left_joint]
    front_wheels_names: [front_right_steer, front_left_steer]
    wheelbase: {BASE}
    front_wheel_track: {KINGPINS}
    rear_wheel_track: {TRACK}
    rear_wheels_radius: {RADIUS}
"""
)
ROS2_MECANUM = ROS2.format(type="mecanum_drive_controller/MecanumDriveController") + (
    f"""    front_left_wheel_command_joint_name: front_left_joint
    front_right_wheel_command_joint_name: front_right_joint
    rear_left_wheel_command_joint_name: rear_left_joint
    rear_right_wheel_command_joint_name: rear_right_joint
    kinematics:
      sum_of_robot_center_projection_on_X_Y_axis: {(BASE + TRACK) / 2}
      wheels_radius: {RADIUS}
"""
)
ROS2_TRICYCLE = ROS2.format(type="tricycle_controller/TricycleController") + (
    f"""    traction_joint_name: front_left_joint
    steering_joint_name: front_left_steer
    wheelbase: {BASE}
    wheel_radius: {RADIUS}
"""
)
FILES = {
    "ROS 1 steered": (ROS1_STEERED, ("wheel_separation_h", "wheel_radius")),
    "ROS 1 mecanum": (ROS1_MECANUM, ("wheel_separation_x", "wheel_separation_y", "wheel_radius")),
    "ROS 2 differential": (ROS2_DIFF, ("wheel_separation", "wheel_radius")),
    "ROS 2 Ackermann": (
        ROS2_ACKERMANN,
        ("wheelbase", "front_wheel_track", "rear_wheel_track", "rear_wheels_radius"),
    ),
    "ROS 2 mecanum": (
        ROS2_MECANUM,
        ("sum_of_robot_center_projection_on_X_Y_axis", "wheels_radius"),
    ),
    "ROS 2 tricycle": (ROS2_TRICYCLE, ("wheelbase", "wheel_radius")),
}


@pytest.mark.parametrize("case", FILES.values(), ids=FILES)
def test_controllers_sizes_are_those_of_the_car(reported, take, tmp_path, case):
    text, sizes = case
    path = tmp_path / "car.yaml"
    path.write_text(text)
    assert reported(car(), controller_files=[path]) == []
    for size in sizes:
        line = next(line for line in text.splitlines() if line.strip().startswith(f"{size}:"))
        value = float(line.partition(":")[2])
        wrong = text.replace(line, line.replace(f": {value}", f": {1.3 * value:.4g}"))
        path.write_text(wrong)
        (finding,) = reported(car(), controller_files=[path])
        assert finding.instead == f"{size}: {value:.6g}", size
        assert finding.origin.line == text.splitlines().index(line) + 1
        path.write_text(take(wrong, finding))
        assert reported(car(), controller_files=[path]) == []


def resized(text, wheel, radius):
    """The car with another radius of a wheel."""
    before, start, after = text.partition(f'<link name="{wheel}">')
    assert start
    after = after.replace(f'radius="{RADIUS}"', f'radius="{radius}"', 1)
    return before + start + after


@pytest.mark.parametrize("wheel", ["rear_left_wheel", "rear_right_wheel"])
@pytest.mark.parametrize("way", ["ROS 1", "ROS 2", "gz-sim"])
def test_the_wheels_of_both_sides_are_compared(bench, tmp_path, way, wheel):
    """The robot drives with the mean of both radii."""
    path = tmp_path / "car.yaml"
    path.write_text(ROS2_DIFF if way == "ROS 2" else ROS1_DIFF)
    tags = {**REAR, "wheel_separation": TRACK, "wheel_radius": RADIUS}
    gz = way == "gz-sim"
    text = resized(car(plugin("gz-sim-diff-drive-system", **tags) if gz else ""), wheel, 0.12)
    files = [] if gz else [path]
    (finding,) = bench.find(text, "wheel-diameter-mismatch", controller_files=files)
    assert finding.values["measured"] == pytest.approx(0.11)
    assert finding.values["joint"] == wheel.replace("wheel", "joint")
    assert not finding.instead


@pytest.mark.wording
def test_the_message_names_wheels_of_different_sizes(bench, tmp_path):
    path = tmp_path / "car.yaml"
    path.write_text(ROS2_DIFF)
    text = resized(car(), "rear_right_wheel", 0.12)
    (finding,) = bench.find(text, "wheel-diameter-mismatch", controller_files=[path])
    assert 'of the wheel "rear_right_wheel" is 0.12 m and that of the wheel' in finding.message
    assert "drives 10% faster" in finding.message


@pytest.mark.wording
def test_different_wheels_with_the_stated_mean_do_not_drive_straight(bench, tmp_path):
    path = tmp_path / "car.yaml"
    path.write_text(ROS2_DIFF)
    text = resized(resized(car(), "rear_left_wheel", 0.11), "rear_right_wheel", 0.09)
    (finding,) = bench.find(text, "wheel-diameter-mismatch", controller_files=[path])
    assert finding.message.endswith("so the robot does not drive straight")


def test_wheels_above_the_ground_do_not_count_for_the_radius(bench, tmp_path):
    """Four wheels are driven, and the front ones are smaller than their axles are high."""
    path = tmp_path / "car.yaml"
    path.write_text(
        ROS2_DIFF.replace("[rear_left_joint]", "[front_left_joint, rear_left_joint]").replace(
            "[rear_right_joint]", "[front_right_joint, rear_right_joint]"
        )
    )
    text = resized(resized(car(), "front_left_wheel", 0.05), "front_right_wheel", 0.05)
    assert not bench.find(text, "wheel-diameter-mismatch", controller_files=[path])


@pytest.mark.parametrize("text", [ROS1_DIFF, ROS2_DIFF])
def test_swapped_wheels_of_a_controller_are_found(bench, tmp_path, text):
    path = tmp_path / "car.yaml"
    path.write_text(text)
    assert not bench.find(car(), "wheels-swapped", controller_files=[path])
    left, right = "rear_left_joint", "rear_right_joint"
    path.write_text(text.replace(left, "x").replace(right, left).replace("x]", f"{right}]"))
    (finding,) = bench.find(car(), "wheels-swapped", controller_files=[path])
    assert finding.values == {"left": right, "right": left}
    line = next(n for n, line in enumerate(path.read_text().splitlines(), 1) if right in line)
    assert (finding.origin.file, finding.origin.line) == (str(path), line)


def test_the_sizes_of_wheels_that_other_hardware_moves_are_not_compared(reported, tmp_path):
    """SteerBotHardwareGazebo moves other joints than those that the controller commands."""
    path = tmp_path / "car.yaml"
    path.write_text(ROS1_STEERED.replace(f"_h: {BASE}", f"_h: {1.5 * BASE}"))
    tags = {"robotSimType": "steer_bot_hardware_gazebo/SteerBotHardwareGazebo"}
    other = plugin("libgazebo_ros_control.so", **tags)
    plain = plugin("libgazebo_ros_control.so")
    (finding,) = reported(car(plain), controller_files=[path])
    assert finding.code is WHEEL_BASE_MISMATCH
    assert reported(car(other), controller_files=[path]) == []


@pytest.mark.parametrize("namespace", ["", "my_car"])
@pytest.mark.parametrize("joint", ["rear_left_joint", "rear_joint"])
def test_the_radius_of_wheels_that_other_hardware_moves_is_compared(
    reported, tmp_path, joint, namespace
):
    """The joint that the controller commands need not be in the robot."""
    path, hardware = tmp_path / "car.yaml", tmp_path / "hardware.yaml"
    wheels = {"virtual_rear_wheels": ["rear_right_joint", "rear_left_joint"]}
    held = {"steer_bot_hardware_gazebo": wheels}
    hardware.write_text(yaml.safe_dump({namespace: held} if namespace else held))
    tags = {"robotSimType": "steer_bot_hardware_gazebo/SteerBotHardwareGazebo"}
    robot = car(plugin("libgazebo_ros_control.so", **tags))
    text = ROS1_STEERED.replace("rear_left_joint", joint)
    path.write_text(text)
    assert reported(robot, controller_files=[path, hardware]) == []
    path.write_text(text.replace(f"radius: {RADIUS}", f"radius: {2 * RADIUS}"))
    (finding,) = reported(robot, controller_files=[path, hardware])
    assert finding.code is WHEEL_DIAMETER_MISMATCH
    assert finding.values["measured"] == pytest.approx(RADIUS)


def test_the_passive_wheels_of_a_tricycle_are_one_axle(reported, tmp_path):
    """Without a second axle whose wheels are not driven, its wheelbase is unknown."""
    path = tmp_path / "car.yaml"
    path.write_text(ROS2_TRICYCLE.replace(f"wheelbase: {BASE}", f"wheelbase: {2 * BASE}"))
    (finding,) = reported(car(), controller_files=[path])
    assert finding.values["measured"] == pytest.approx(BASE)
    middle = link("middle_wheel", WHEEL) + joint(
        "middle_joint", ("base_link", "middle_wheel"), "0.1 0 0", "0 1 0"
    )
    several = car().replace("<gazebo>", f"{middle}<gazebo>", 1)
    assert reported(several, controller_files=[path]) == []


def test_the_wheel_base_is_measured_between_the_axles_when_all_wheels_are_driven(reported):
    tags = {**ACKERMANN}
    text = plugin("gz-sim-ackermann-steering-system", **tags)
    more = "<left_joint>front_left_joint</left_joint><right_joint>front_right_joint</right_joint>"
    assert reported(car(text.replace("</plugin>", f"{more}</plugin>"))) == []


@pytest.mark.parametrize(
    "case",
    [
        ("wheel_radius", RADIUS, ("left_wheel_radius_multiplier", "right_wheel_radius_multiplier")),
        ("wheel_separation", TRACK, ("wheel_separation_multiplier",)),
    ],
)
def test_the_size_with_its_multiplier_is_compared(reported, take, tmp_path, case):
    size, value, multipliers = case
    path = tmp_path / "car.yaml"
    twice = ROS2_DIFF.replace(f"{size}: {value}", f"{size}: {2 * value}")
    path.write_text(twice + "".join(f"    {name}: 0.5\n" for name in multipliers))
    assert reported(car(), controller_files=[path]) == []
    wrong = ROS2_DIFF + "".join(f"    {name}: 0.5\n" for name in multipliers)
    path.write_text(wrong)
    (finding,) = reported(car(), controller_files=[path])
    assert finding.values["stated"] == pytest.approx(value / 2)
    path.write_text(take(wrong, finding))
    assert reported(car(), controller_files=[path]) == []


def test_a_negative_multiplier_of_a_side_does_not_change_the_radius(reported, tmp_path):
    path = tmp_path / "car.yaml"
    path.write_text(ROS2_DIFF + "    right_wheel_radius_multiplier: -1.0\n")
    assert reported(car(), controller_files=[path]) == []


def test_a_multiplier_without_a_size_is_that_of_the_measured_separation(reported, take, tmp_path):
    path = tmp_path / "car.yaml"
    wrong = ROS2_DIFF.replace(f"wheel_separation: {TRACK}", "wheel_separation_multiplier: 1.5")
    path.write_text(wrong)
    (finding,) = reported(car(), controller_files=[path])
    assert finding.instead == "wheel_separation_multiplier: 1.0"
    path.write_text(take(wrong, finding))
    assert reported(car(), controller_files=[path]) == []


SKID_CONTROLLER = ROS2.format(type="diff_drive_controller/DiffDriveController") + (
    "    left_wheel_names: [front_left_joint, rear_left_joint]\n"
    "    right_wheel_names: [front_right_joint, rear_right_joint]\n"
    f"    wheel_radius: {RADIUS}\n"
)


def test_a_multiplier_of_the_wheel_separation_counts_for_the_turn_rate(bench, tmp_path):
    path = tmp_path / "car.yaml"
    text = f"{SKID_CONTROLLER}    wheel_separation: {TRACK}\n"
    slow = TRACK**2 / (TRACK**2 + BASE**2)
    for multiplier, ratio in ((1.0, slow), (2.0, 2 * slow)):
        path.write_text(f"{text}    wheel_separation_multiplier: {multiplier}\n")
        report = bench.report(car(), controller_files=[path])
        (finding,) = [each for each in report.findings if each.code is SKID_STEERING]
        assert finding.values["ratio"] == pytest.approx(ratio, rel=1e-6)
        # The separation to write: the controller multiplies it again.
        fits = finding.values["fits"]
        path.write_text(
            f"{text.replace(f'wheel_separation: {TRACK}', f'wheel_separation: {fits}')}"
            f"    wheel_separation_multiplier: {multiplier}\n"
        )
        report = bench.report(car(), controller_files=[path])
        assert not [each for each in report.findings if each.code is SKID_STEERING]


@pytest.mark.wording
@pytest.mark.parametrize(("times", "added"), [(1.0, ""), (0.5, " of its wheels")])
def test_wheels_that_slide_and_have_a_wrong_size(bench, tmp_path, times, added):
    path = tmp_path / "car.yaml"
    text = SKID_CONTROLLER.replace(f"radius: {RADIUS}", f"radius: {times * RADIUS}")
    path.write_text(f"{text}    wheel_separation: {TRACK}\n")
    (finding,) = [
        each
        for each in bench.report(car(), controller_files=[path]).findings
        if each.code is SKID_STEERING
    ]
    slow = TRACK**2 / (TRACK**2 + BASE**2)
    assert f"turns at {slow:.0%} of the commanded rate" in finding.message
    assert (f", and at {slow / times:.0%} with the wrong radius{added}" in finding.message) == bool(
        added
    )


@pytest.mark.wording
@pytest.mark.parametrize("stated", [(TRACK, None), (TRACK, 0.75), (None, 0.75), (None, 5.0)])
def test_each_parameter_of_a_controller_in_the_advice_compensates_for_wheels_that_slide(
    bench, tmp_path, stated
):
    path = tmp_path / "car.yaml"

    def finding(separation, multiplier):
        pairs = (("wheel_separation", separation), ("wheel_separation_multiplier", multiplier))
        lines = [f"    {name}: {value}\n" for name, value in pairs if value is not None]
        path.write_text(SKID_CONTROLLER + "".join(lines))
        report = bench.report(car(), controller_files=[path])
        return next((each for each in report.findings if each.code is SKID_STEERING), None)

    separation, multiplier = stated
    found = finding(*stated)
    advised = re.search(r"(?i:a wheel separation) of (\S+) m", found.hint)
    assert (advised is None) is (separation is None)
    if advised is not None:
        assert finding(float(advised[1]), multiplier) is None
    advised = re.search(r'a "wheel_separation_multiplier" of (\S+)', found.hint, re.IGNORECASE)
    assert finding(separation, float(advised[1])) is None
    assert ("wheel_separation_multiplier" in found.message) is (multiplier == 5.0)


@pytest.mark.wording
def test_a_separation_that_is_too_large_for_wheels_that_slide_is_named(bench):
    """Wheels that slide alone turn a robot more slowly."""
    fits = TRACK * (1 + (BASE / TRACK) ** 2)
    wide = {**SKID, "wheelSeparation": 1.2 * fits}
    report = bench.report(car(plugin("libgazebo_ros_skid_steer_drive.so", **wide)))
    (finding,) = [each for each in report.findings if each.code is SKID_STEERING]
    assert f"but <wheelSeparation> of {1.2 * fits:.4g} m compensates for more" in finding.message
    assert "at 120% of the commanded rate" in finding.message


def test_the_turn_rate_of_a_skid_steered_robot_is_that_at_which_friction_torques_balance(bench):
    """For four wheels with track t and wheelbase b it is t²/(t² + b²) of the commanded rate."""
    report = bench.report(car(plugin("libgazebo_ros_skid_steer_drive.so", **SKID)))
    (finding,) = [each for each in report.findings if each.code is SKID_STEERING]
    assert finding.values["ratio"] == pytest.approx(TRACK**2 / (TRACK**2 + BASE**2), rel=1e-6)
    # A separation that compensates for it is no finding.
    wide = {**SKID, "wheelSeparation": TRACK * (1 + (BASE / TRACK) ** 2)}
    report = bench.report(car(plugin("libgazebo_ros_skid_steer_drive.so", **wide)))
    assert not [each for each in report.findings if each.code is SKID_STEERING]


def test_six_wheels_turn_slowest_if_those_in_the_middle_carry_nothing(bench):
    """The slowest turn is that on the four outer wheels."""
    names = {
        "left": "front_left_joint rear_left_joint",
        "right": "front_right_joint rear_right_joint",
    }
    body = ""
    for side, y in (("left", TRACK / 2), ("right", -TRACK / 2)):
        body += link(f"middle_{side}", WHEEL)
        ends = "base_link", f"middle_{side}"
        body += joint(f"middle_{side}_joint", ends, f"0 {y} 0", "0 1 0")
        names[side] += f" middle_{side}_joint"
    tags = {**MULTI, "leftJoints": names["left"], "rightJoints": names["right"]}
    text = car(plugin("libdiffdrive_plugin_multi_wheel.so", **tags))
    text = text.replace("<gazebo>", f"{body}<gazebo>")
    (finding,) = [each for each in bench.report(text).findings if each.code is SKID_STEERING]
    least = TRACK**2 / (TRACK**2 + BASE**2)
    assert finding.values["least"] == pytest.approx(least, rel=1e-6)
    assert finding.values["ratio"] > 1.2 * least


def test_pairs_of_wheels_with_equal_separations_are_those_of_a_skid_steer(bench):
    pairs = (
        '<plugin name="p" filename="libgazebo_ros_diff_drive.so"><num_wheel_pairs>2'
        "</num_wheel_pairs><left_joint>rear_left_joint</left_joint><left_joint>front_left_joint"
        "</left_joint><right_joint>rear_right_joint</right_joint><right_joint>front_right_joint"
        f"</right_joint>{f'<wheel_separation>{TRACK}</wheel_separation>' * 2}"
        f"{f'<wheel_diameter>{2 * RADIUS}</wheel_diameter>' * 2}</plugin>"
    )
    (finding,) = [each for each in bench.report(car(pairs)).findings if each.code is SKID_STEERING]
    assert finding.values["ratio"] == pytest.approx(TRACK**2 / (TRACK**2 + BASE**2), rel=1e-6)


def test_a_base_with_its_weight_on_one_axle_turns_about_this_axle():
    """The other wheels slide without a force, so nothing opposes the turn."""
    contacts = [Contact(x=x, y=y, rim=-y) for x in (-0.2, 0.2) for y in (-0.15, 0.15)]
    forward, sideways, turn = base_motion(contacts, (0.2, 0.0))
    assert (forward, turn) == (pytest.approx(0.0, abs=1e-3), pytest.approx(1.0, rel=0.01))
    assert sideways == pytest.approx(-0.2, rel=0.01)


def test_undriven_wheels_that_do_not_swivel_slow_turns(bench):
    """The rear wheels are driven, and the front wheels are on the body instead of the forks.

    The front wheels hold their axle: with the turn rate w of 1 rad/s commanded, the driven wheels
    slide by w b across and by (1 - w) t/2 along the robot. The torque of the side forces at both
    axles balances that of the driven wheels where b² w = (1 - w) t²/4, so w = t² / (t² + 4 b²).
    """
    drive = {**REAR, "wheel_separation": TRACK, "wheel_diameter": 2 * RADIUS}
    text = car(plugin("libgazebo_ros_diff_drive.so", **drive))
    for steer in ("front_left_steer", "front_right_steer"):
        text = text.replace(f'name="{steer}" type="revolute"', f'name="{steer}" type="fixed"')
    (finding,) = [each for each in bench.report(text).findings if each.code is SKID_STEERING]
    ratio = TRACK**2 / (TRACK**2 + 4 * BASE**2)
    assert finding.values["ratio"] == pytest.approx(ratio, rel=1e-3)


@pytest.mark.parametrize("places", [[0.0, 0.0], [-0.1, 0.0, 0.1]])
def test_wheels_of_one_axle_do_not_slide_and_more_axles_turn_more_slowly(places):
    def ratio(places):
        contacts = [Contact(x=x, y=y, rim=-y) for x in places for y in (-0.2, 0.2)]
        return base_motion(contacts, (0.0, 0.0))[2]

    if len(places) == 2:
        assert ratio(places) == pytest.approx(1.0)
    else:
        # The middle axle helps: faster than two axles at ±0.1 m, slower than one.
        assert ratio([-0.1, 0.1]) < ratio(places) < 1.0


@pytest.mark.parametrize("crossed", [False, True])
def test_the_side_of_a_wheel_is_that_of_its_shape(bench, crossed):
    """A joint may be anywhere on the axle, even beyond the other wheel."""
    parts = []
    for side, y in (("rear_left", TRACK / 2), ("rear_right", -TRACK / 2)):
        at = -y if crossed else y
        shape = WHEEL.replace("<origin ", f'<origin xyz="0 {y - at} 0" ')
        parts += [
            link(f"{side}_wheel", shape),
            joint(f"{side}_joint", ("base_link", f"{side}_wheel"), f"0 {at} 0", "0 1 0"),
        ]
    tags = {"leftJoint": "rear_left_joint", "rightJoint": "rear_right_joint"}
    drive = plugin("libgazebo_ros_diff_drive.so", **tags)
    body = link("base_link") + "".join(parts)
    text = f'<robot name="car">{body}<gazebo>{drive}</gazebo></robot>'
    assert not bench.find(text, "wheels-swapped")
    swapped = dict(zip(tags, reversed(tags.values()), strict=True))
    other = text.replace(drive, plugin("libgazebo_ros_diff_drive.so", **swapped))
    assert bench.find(other, "wheels-swapped")


@pytest.mark.parametrize(
    ("kind", "parameters", "multiplier"),
    [
        (
            "diff_drive_controller/DiffDriveController",
            "left_wheel: left, right_wheel: right, wheel_separation: 0.4",
            "wheel_separation_multiplier",
        ),
        (
            "four_wheel_steering_controller/FourWheelSteeringController",
            "front_wheel: [left, right], rear_wheel: [left, right], track: 0.4",
            "",
        ),
    ],
)
def test_only_multipliers_that_a_controller_has_are_advised(tmp_path, kind, parameters, multiplier):
    wheels = "".join(
        f'<link name="{name}_wheel"/><joint name="{name}" type="continuous"><parent link="base"/>'
        f'<child link="{name}_wheel"/><origin xyz="0 {y} 0"/><axis xyz="0 1 0"/></joint>'
        for name, y in (("left", 0.2), ("right", -0.2))
    )
    text = f'<robot name="robot"><link name="base"/>{wheels}</robot>'
    robot = Robot(load_text(text, file="robot.urdf"), None)
    path = tmp_path / "drive.yaml"
    path.write_text(f"drive: {{type: {kind}, {parameters}}}\n")
    (controller,) = ControlFile(path=path, named=True).controllers
    apart = [each for each in _of_controller(robot, controller, ()) if each.measure == "apart"]
    assert [each.multiplier for each in apart] == [multiplier]


def test_a_wheel_rolls_on_its_collision_whatever_it_looks_like(reported):
    """Its visual mesh is missing."""
    name = "libgazebo_ros_diff_drive.so"
    text = car(plugin(name, **{**DRIVES[name], "wheel_diameter": RADIUS}))
    mesh = '<visual><geometry><mesh filename="package://nowhere/wheel.stl"/></geometry></visual>'
    unseen = text.replace(WHEEL, mesh + WHEEL)
    assert [each.code for each in reported(unseen)] == [WHEEL_DIAMETER_MISMATCH]
    # Nothing shows its size.
    assert not reported(text.replace(WHEEL, mesh))


SDF_WHEEL = """<link name="{name}"><pose>0 {y} 0 -1.5707963 0 0</pose>{visual}
  <collision name="c"><geometry><cylinder><radius>0.1</radius><length>0.02</length></cylinder></geometry>
  </collision></link>
  <joint name="{name}_joint" type="revolute"><parent>base</parent><child>{name}</child>
  <axis><xyz>0 0 1</xyz></axis></joint>"""
MESH = "<mesh><uri>nowhere/wheel.stl</uri></mesh>"
PAINT = "<material><script><uri>nowhere/a.material</uri><name>A</name></script></material>"


@pytest.mark.parametrize(("shape", "paint"), [(MESH, ""), ("<box><size>1 1 1</size></box>", PAINT)])
def test_a_wheel_in_sdf_rolls_on_its_collision_whatever_it_looks_like(reported, shape, paint):
    visual = f'<visual name="v"><geometry>{shape}</geometry>{paint}</visual>'
    wheels = "".join(
        SDF_WHEEL.format(name=f"{side}_wheel", y=y, visual=visual)
        for side, y in (("left", 0.15), ("right", -0.15))
    )
    drive = plugin(
        "libgazebo_ros_diff_drive.so",
        leftJoint="left_wheel_joint",
        rightJoint="right_wheel_joint",
        wheelSeparation=0.3,
        wheelDiameter=0.1,
    )
    text = f'<sdf version="1.6"><model name="m"><link name="base"/>{wheels}{drive}</model></sdf>'
    assert [each.code for each in reported(text)] == [WHEEL_DIAMETER_MISMATCH]
