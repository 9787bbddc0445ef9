"""What a trial reports about robots with known faults."""

import math
from dataclasses import replace
from pathlib import Path

import pytest
import yaml
from tests.dialects.ros_control.arms import ROS1, transmission
from tests.dialects.ros_control.cars import BASE, TRACK, car, four_wheels

from cartwheel.api import World
from cartwheel.api.motion import Twist
from cartwheel.checks.robot import Robot
from cartwheel.codes.devices import (
    CONTROL_WITHOUT_JOINTS,
    CONTROLLER_GAIN_TOO_LOW,
    CONTROLLER_GAINS_MISSING,
    CONTROLLER_INTERFACE_MISMATCH,
    CONTROLLER_UNDAMPED,
    CONTROLLERS_NOT_FOUND,
    HARDWARE_WITHOUT_PLUGIN,
    PLUGIN_UNKNOWN,
)
from cartwheel.codes.files import FILE_MISSING, FILE_ON_NETWORK, INCLUDE_ABSENT, LINK_RECONNECTED
from cartwheel.codes.robot import (
    BASE_FIXED,
    BASE_WITHOUT_COLLISION,
    BODY_ON_GROUND,
    DAMPING_TOO_HIGH,
    DRIVES_APART,
    DUPLICATE_NAME,
    INERTIA_GEOMETRY_MISMATCH,
    INERTIA_MISSING,
    JOINTS_UNDRIVEN,
    PLANAR_FRICTION,
    SHAPE_OUT_OF_SCALE,
    SKID_STEERING,
    UNBALANCED,
    WHEEL_AXIS_MISALIGNED,
    WHEEL_DIAMETER_MISMATCH,
    WHEEL_FRICTIONLESS,
    WHEEL_NOT_ROUND,
    WHEEL_SEPARATION_MISMATCH,
    WHEELS_SWAPPED,
    WHEELS_TOED,
)
from cartwheel.codes.running import (
    CONTROLLER_NOT_STARTED,
    JOINT_DRIVEN_TWICE,
    JOINT_SHARED,
    PLUGIN_LEFT_OUT,
)
from cartwheel.codes.world import SIMULATION_DIVERGED
from cartwheel.corpus import try_robot
from cartwheel.corpus.causes.drives import cause_of_drive, explains_turn
from cartwheel.corpus.diagnosis import faults
from cartwheel.corpus.listening import listened
from cartwheel.corpus.motion import positions
from cartwheel.corpus.placing import HIGH, place
from cartwheel.corpus.resting import gave_way
from cartwheel.corpus.verdict import Drive, Reach, Stand, Verdict
from cartwheel.description import load_robot, load_text
from cartwheel.description.launches import launches_near

INERTIA = (
    '<inertial><mass value="{m}"/>'
    '<inertia ixx="{i}" iyy="{i}" izz="{i}" ixy="0" ixz="0" iyz="0"/></inertial>'
)
BOX = (
    '<link name="{name}"><inertial><origin xyz="{at}"/><mass value="2"/>'
    '<inertia ixx="0.02" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial><collision>'
    '<geometry><box size="{size}"/></geometry></collision></link>'
)
WHEEL = (
    '<link name="{name}">'
    '<inertial><mass value="0.2"/><inertia ixx="1e-4" iyy="1e-4" izz="2e-4" ixy="0" '
    'ixz="0" iyz="0"/>'
    '</inertial><collision><geometry><cylinder radius="0.05" length="0.02"/></geometry>'
    "</collision></link>"
    '<joint name="{name}_joint" type="continuous"><parent link="base"/><child link="{name}"/>'
    '<origin xyz="0 {y} -0.02" rpy="-1.5708 0 0"/><axis xyz="0 0 1"/></joint>'
)
DRIVE = (
    '<gazebo><plugin name="drive" filename="libgazebo_ros_diff_drive.so"><legacyMode>false'
    "</legacyMode><leftJoint>left_joint</leftJoint><rightJoint>right_joint</rightJoint>"
    "<wheelSeparation>0.2</wheelSeparation><wheelDiameter>{diameter}</wheelDiameter>"
    "</plugin></gazebo>"
)
CASTER = (
    '<link name="caster"><collision><geometry><sphere radius="0.03"/></geometry></collision></link>'
    '<joint name="caster_joint" type="fixed"><parent link="base"/><child link="caster"/>'
    '<origin xyz="{x} 0 -0.04"/></joint>'
    '<gazebo reference="caster"><mu1>0</mu1><mu2>0</mu2></gazebo>'
)
ARM = (
    f'<link name="world"/><link name="base">{INERTIA.format(m=1, i=0.01)}</link><link name="upper">'
    '<inertial><origin xyz="0 0 0.1"/><mass value="1"/>'
    '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>'
    '<joint name="stand" type="fixed"><parent link="world"/><child link="base"/></joint>'
    '<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>'
    '<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="50" velocity="2"/></joint>'
    '<transmission name="t"><type>transmission_interface/SimpleTransmission</type>'
    '<joint name="shoulder"><hardwareInterface>hardware_interface/{kind}JointInterface'
    '</hardwareInterface></joint><actuator name="m"/></transmission>'
    '<gazebo><plugin name="control" filename="libgazebo_ros_control.so"/></gazebo>'
)


STEER_BOT = ROS1.replace(
    "</plugin>",
    "<robotSimType>steer_bot_hardware_gazebo/SteerBotHardwareGazebo</robotSimType></plugin>",
)
STEER_HARDWARE = {
    "rear_wheel": "rear_wheel_joint",
    "front_steer": "front_steer_joint",
    "virtual_rear_wheels": ["rear_right_joint", "rear_left_joint"],
    "virtual_front_wheels": ["front_right_joint", "front_left_joint"],
    "virtual_front_steers": ["front_right_steer", "front_left_steer"],
    "wheel_separation_w": TRACK,
    "wheel_separation_h": BASE,
}
STEERED = {
    "type": "ackermann_steering_controller/AckermannSteeringController",
    "rear_wheel": "rear_wheel_joint",
    "front_steer": "front_steer_joint",
    "wheel_separation_h": BASE,
}


FOR_GAZEBO = '<gazebo><plugin name="view" filename="libDrawForcePlugin.so"/></gazebo>'
"""A plugin without effect, for which the robot is one for Gazebo and must stand."""


@pytest.fixture
def tried(tmp_path):
    def run(*parts, **more):
        path = tmp_path / "robot.urdf"
        path.write_text(f'<robot name="robot">{"".join(parts)}{FOR_GAZEBO}</robot>')
        return try_robot(path, standing=2.0, **more)

    return run


def cart(diameter: float) -> str:
    parts = BOX.format(name="base", at="0 0 0", size="0.3 0.15 0.06")
    parts += WHEEL.format(name="left", y=0.1) + WHEEL.format(name="right", y=-0.1)
    parts += CASTER.format(x=0.12).replace("caster", "front") + CASTER.format(x=-0.12)
    return parts + DRIVE.format(diameter=diameter)


def test_a_cart_stands_publishes_and_drives_as_it_is_commanded(tried):
    verdict = tried(cart(0.1))
    assert verdict.good, verdict
    assert verdict.mass == pytest.approx(2.4)
    assert verdict.plugins == ("gazebo_ros_diff_drive",)
    assert verdict.missing == ()
    assert verdict.stand.state == "yes"
    assert verdict.topics > 0
    (drive,) = verdict.drives
    assert drive.topic == "/cmd_vel"
    assert abs(drive.error) < 0.02
    assert abs(drive.error_turn) < 0.05
    assert verdict.should_move
    assert verdict.moves


def test_a_wheel_of_half_the_stated_diameter_drives_half_as_fast(tried):
    verdict = tried(cart(0.2))
    (drive,) = verdict.drives
    assert drive.error == pytest.approx(-0.5, abs=0.02)
    assert not drive.follows
    assert not verdict.good
    assert not verdict.moves
    faults = {fault.test: fault for fault in verdict.faults}
    assert set(faults) == {"drive", "turn"}
    for fault in faults.values():
        assert fault.subject == "/cmd_vel"
        assert fault.code is WHEEL_DIAMETER_MISMATCH
        assert fault.reason.origin.line == 1
    assert verdict.outcome == "file"


def test_a_base_that_turns_by_more_than_half_a_turn_while_it_is_measured(tried):
    """Commanded at 0.4 rad/s, it turns at 2 rad/s, which is 4 rad in the measured 2 s."""
    verdict = tried(cart(0.02))
    (drive,) = verdict.drives
    assert drive.measured_turn == pytest.approx(2.0, rel=0.05)
    assert {fault.test: fault.code for fault in verdict.faults} == {
        "drive": WHEEL_DIAMETER_MISMATCH,
        "turn": WHEEL_DIAMETER_MISMATCH,
    }


def test_a_separation_explains_the_turn_rate_that_follows_from_it_and_no_other(tried):
    wide = cart(0.1).replace("<wheelSeparation>0.2<", "<wheelSeparation>0.3<")
    verdict = tried(wide)
    (fault,) = verdict.faults
    assert (fault.test, fault.code) == ("turn", WHEEL_SEPARATION_MISMATCH)
    assert verdict.drives[0].error_turn == pytest.approx(0.5, abs=0.03)
    # Without friction, it neither drives nor turns, which the separation does not explain.
    slippery = "".join(
        f'<gazebo reference="{name}"><mu1>0</mu1><mu2>0</mu2></gazebo>'
        for name in ("left", "right")
    )
    verdict = tried(wide, slippery)
    assert {fault.code for fault in verdict.faults} == {WHEEL_FRICTIONLESS}


def test_a_size_does_not_explain_an_error_in_the_other_direction():
    """It turns 12 % more than commanded; by its separation alone, it would turn 2 % less."""
    separation = WHEEL_SEPARATION_MISMATCH.diagnostic(
        "2 % less", severity="warning", values={"stated": 0.39, "measured": 0.3985}
    )
    shape = WHEEL_NOT_ROUND.diagnostic("not round", severity="warning")
    assert cause_of_drive([separation, shape], 1.12, turning=True) is shape
    assert cause_of_drive([separation, shape], 0.98, turning=True) is separation


def test_swapped_wheels_reverse_either_the_drive_or_the_turn():
    swapped = WHEELS_SWAPPED.diagnostic("swapped", severity="warning")
    radius = WHEEL_DIAMETER_MISMATCH.diagnostic(
        "too small", severity="warning", values={"stated": 0.05, "measured": 0.1}
    )
    drags = BODY_ON_GROUND.diagnostic("a caster brakes it", severity="info")
    found = [swapped, radius, drags]
    assert cause_of_drive(found, 1.5) is radius
    assert cause_of_drive(found, -1.6, turning=True) is swapped
    assert cause_of_drive([drags], 0.5) is drags


def test_a_plugin_that_measures_does_not_explain_why_a_base_drives_backward():
    publisher = PLUGIN_LEFT_OUT.diagnostic(
        "no such joint", values={"plugin": "libgazebo_ros_joint_state_publisher.so"}
    )
    drive = PLUGIN_LEFT_OUT.diagnostic(
        "no such joint", values={"plugin": "libgazebo_ros_diff_drive.so"}
    )
    axis = WHEEL_AXIS_MISALIGNED.diagnostic("turns backwards", severity="warning")
    assert cause_of_drive([publisher, axis], -1.0, turning=False) is axis
    assert cause_of_drive([publisher], -1.0, turning=False) is None
    assert cause_of_drive([drive, axis], -1.0, turning=False) is drive


def test_axes_explain_a_base_that_moves_the_other_way_and_reversed_ones_only_that():
    several = WHEEL_AXIS_MISALIGNED.diagnostic("one is reversed", values={"all": False})
    every = WHEEL_AXIS_MISALIGNED.diagnostic("all are reversed", values={"all": True})
    for turning in (False, True):
        assert cause_of_drive([every], -1.0, turning=turning) is every
        assert cause_of_drive([every], 0.4, turning=turning) is None
        assert cause_of_drive([several], 0.4, turning=turning) is several


def _explained(*findings, **results):
    robot = load_text('<robot name="r"><link name="a"/></robot>', file="r.urdf")
    verdict = Verdict(file=Path("r.urdf"), loaded=True, **results)
    return {fault.test: fault.reason for fault in faults(verdict, robot, lambda: findings)}


def test_a_wrong_radius_also_explains_how_fast_sliding_wheels_turn_the_base():
    radius = WHEEL_DIAMETER_MISMATCH.diagnostic(
        "too small", severity="warning", values={"stated": 0.3, "measured": 0.18}
    )
    drive = Drive(
        topic="/cmd_vel", commanded=0.2, measured=0.12, commanded_turn=0.4, measured_turn=0.47
    )
    assert _explained(radius, drives=(drive,)) == {"drive": radius, "turn": radius}
    right = replace(drive, measured=0.2)
    assert _explained(radius, drives=(right,)) == {"turn": None}


def test_of_two_wrong_sizes_the_one_that_errs_in_the_measured_direction_is_the_reason():
    radius = WHEEL_DIAMETER_MISMATCH.diagnostic(
        "too small", severity="warning", values={"stated": 0.05, "measured": 0.075}
    )
    apart = WHEEL_SEPARATION_MISMATCH.diagnostic(
        "too narrow", severity="warning", values={"stated": 0.2, "measured": 0.25}
    )
    assert cause_of_drive([apart, radius], 1.2, turning=True) is radius
    assert cause_of_drive([radius, apart], 1.2, turning=True) is radius
    assert cause_of_drive([radius, apart], 0.8, turning=True) is apart


@pytest.mark.parametrize("code", [FILE_MISSING, FILE_ON_NETWORK])
def test_a_robot_that_fell_cannot_drive(code):
    lost = code.diagnostic("no mesh", values={"left_out": "collision"})
    fell = Stand(fixed=False, simulated=10, wall=1, sunk=0.1, tilt=0.5, speed=0, turn=0)
    drive = Drive(
        topic="/cmd_vel", commanded=0.2, measured=0.1, commanded_turn=0.4, measured_turn=0.1
    )
    assert _explained(lost, stand=fell, drives=(drive,)) == dict.fromkeys(
        ("stand", "drive", "turn"), lost
    )
    assert _explained(lost, drives=(drive,)) == {"drive": None, "turn": None}


ROCKING = """<sdf version="1.6"><model name="cart"><link name="base"><pose>0 0 0.1 0 0 0</pose>
<inertial><mass>1</mass></inertial><collision name="c"><geometry><box><size>0.4 0.2 0.1</size></box>
</geometry></collision><collision name="caster"><pose>-0.15 0 -0.05 0 0 0</pose><geometry><sphere>
<radius>0.05</radius></sphere></geometry><surface><friction><ode><mu>0</mu><mu2>0</mu2></ode>
</friction></surface></collision></link>{wheels}
<plugin name="drive" filename="gz-sim-diff-drive-system">
<left_joint>left</left_joint><right_joint>right</right_joint><wheel_radius>0.12</wheel_radius>
<wheel_separation>0.38</wheel_separation></plugin></model></sdf>"""
ROCKING_WHEEL = """<link name="{side}_wheel"><pose>0.12 {y} 0.12 1.5707963 0 0</pose>{inertial}
<collision name="c"><geometry><cylinder><radius>0.12</radius><length>0.05</length></cylinder>
</geometry></collision></link><joint name="{side}" type="revolute"><parent>base</parent>
<child>{side}_wheel</child><axis><xyz expressed_in="__model__">0 1 0</xyz></axis></joint>"""


@pytest.mark.parametrize("stated", [False, True])
def test_wheels_with_the_inertia_of_a_flywheel_explain_why_a_base_rocks(tmp_path, stated):
    """SDF's default is 1 kg m², so the reaction to the wheels' acceleration lifts the base."""
    inertia = "<ixx>0.004</ixx><iyy>0.004</iyy><izz>0.0072</izz>"
    inertial = f"<inertial><mass>1</mass><inertia>{inertia}</inertia></inertial>" if stated else ""
    wheels = "".join(
        ROCKING_WHEEL.format(side=side, y=y, inertial=inertial)
        for side, y in (("left", 0.19), ("right", -0.19))
    )
    file = tmp_path / "cart.sdf"
    file.write_text(ROCKING.format(wheels=wheels))
    verdict = try_robot(file, standing=2)
    (drive,) = verdict.drives
    assert drive.follows == stated
    reasons = {each.test: each.code for each in verdict.faults}
    assert reasons.get("drive") == (None if stated else INERTIA_GEOMETRY_MISMATCH)


def test_lengths_in_millimetres_explain_why_the_simulation_diverges():
    diverged = SIMULATION_DIVERGED.diagnostic("diverged")
    giant = SHAPE_OUT_OF_SCALE.diagnostic("184 m long", severity="warning")
    assert _explained(giant, failure=diverged) == {"simulate": giant}
    assert _explained(failure=diverged) == {"simulate": diverged}


def test_a_controller_that_no_launch_file_starts_is_not_tested():
    reach = Reach(controller="spare", joint="j", target=0.2, reached=0.0, angular=True)
    running = {"controllers": ("drive", "spare"), "reaches": (reach,)}
    assert _explained(**running, spawned=("drive",)) == {}
    assert _explained(**running, spawned=("drive", "spare")) == {"reach": None}
    assert _explained(**running) == {"reach": None}


def test_a_steering_angle_is_commanded_where_the_controller_follows_one(tmp_path):
    """Its four wheels turn at one speed, so it turns less than it is steered."""
    bot, file = tmp_path / "bot.urdf", tmp_path / "bot.yaml"
    bot.write_text(car(four_wheels(steered=True), STEER_BOT, ()))
    settings = {"base": STEERED, "steer_bot_hardware_gazebo": STEER_HARDWARE}
    file.write_text(yaml.safe_dump(settings))
    verdict = try_robot(bot, standing=1.0, controllers=[file])
    (drive,) = verdict.drives
    angle = 0.2 / (4 * Robot(load_robot(bot), None).size)
    assert drive.commanded_turn == pytest.approx(0.2 * math.tan(angle) / BASE, rel=1e-6)
    assert 0.5 < drive.measured_turn / drive.commanded_turn < 1.0
    assert {fault.code for fault in verdict.faults} <= {SKID_STEERING}


def test_a_joint_that_a_plugin_steers_is_not_commanded_against_it(tmp_path):
    """The plugin publishes the steering angles on the topics of the controllers."""
    forks = {"l": "front_left_steer", "r": "front_right_steer"}
    joints = "".join(
        f"<{side}{end}Joint>{end.lower()}_{side}_joint</{side}{end}Joint>"
        for side in ("left", "right")
        for end in ("Front", "Rear")
    )
    plugin = f'<plugin name="drive" filename="libgazebo_ros_ackerman.so">{joints}</plugin>'
    tags = "".join(transmission(name, "Position") for name in forks.values())
    bot, file = tmp_path / "bot.urdf", tmp_path / "bot.yaml"
    bot.write_text(car(four_wheels(steered=True), plugin + ROS1, (), tags))
    kind = "position_controllers/JointPositionController"
    settings = {
        f"limo_f{side}_steering_hinge_controller": {"type": kind, "joint": joint}
        for side, joint in forks.items()
    }
    file.write_text(yaml.safe_dump(settings))
    verdict = try_robot(bot, standing=1.0, controllers=[file])
    assert len(verdict.controllers) == 2
    assert verdict.reaches == ()
    bot.write_text(car(four_wheels(steered=True), ROS1, (), tags))
    verdict = try_robot(bot, standing=1.0, controllers=[file])
    assert {each.joint for each in verdict.reaches} == set(forks.values())


def test_the_friction_of_a_body_explains_why_it_moves_slowly_over_the_ground(tried):
    move = (
        '<gazebo><plugin name="move" filename="libgazebo_ros_planar_move.so">{0}</plugin></gazebo>'
    )
    body = BOX.format(name="base", at="0 0 0", size="0.6 0.4 0.1")
    smooth = '<gazebo reference="base"><mu1>0.0</mu1><mu2>0.0</mu2></gazebo>'
    assert tried(body, move.format(""), smooth).good
    slow = PLANAR_FRICTION.diagnostic("slides", severity="info")
    assert cause_of_drive([slow], 0.9, turning=True) is slow
    assert cause_of_drive([slow], 0.6, turning=False) is slow
    assert cause_of_drive([slow], 1.2, turning=True) is None
    assert cause_of_drive([slow], -0.9, turning=False) is None


def test_the_measured_turn_rate_of_sliding_wheels_is_stated_if_it_is_not_the_predicted_one():
    skids = SKID_STEERING.diagnostic("slide", values={"ratio": 0.4, "stated": 0.5, "rolling": 1.2})
    assert cause_of_drive([skids], 0.41, turning=True) is skids
    cause = cause_of_drive([skids], 0.6, turning=True)
    assert cause.code is SKID_STEERING
    assert cause.values["measured"] == pytest.approx(0.6)
    assert cause.hint and cause != skids
    # The steering hardware whose wheels all turn at the same speed only estimates the rate.
    estimate = SKID_STEERING.diagnostic("slide", values={"hardware": "steer", "estimate": 0.39})
    cause = cause_of_drive([estimate], 0.23, turning=True, arc=True)
    assert cause.values["measured"] == pytest.approx(0.23)
    assert cause_of_drive([estimate], 0.4, turning=True, arc=True) is estimate


@pytest.mark.wording
def test_the_advice_for_the_measured_turn_rate_names_the_parameter_of_the_controller():
    values = {"ratio": 0.4, "stated": 0.5, "rolling": 1.2, "factor": 1.5, "multiplier": "times"}
    for measured in (False, True):
        skids = SKID_STEERING.diagnostic("slide", values={**values, "measured": measured})
        cause = cause_of_drive([skids], 0.6, turning=True)
        assert ("separation of 0.8333 m" in cause.hint) is not measured
        assert '"times" of 2.5 compensates' in cause.hint


def test_a_wrong_separation_is_why_a_robot_with_sliding_wheels_turns_too_fast():
    skids = SKID_STEERING.diagnostic("slide", values={"ratio": 4.7, "stated": 1.0, "rolling": 11.0})
    apart = WHEEL_SEPARATION_MISMATCH.diagnostic("w", values={"stated": 1.0, "measured": 0.09})
    assert cause_of_drive([skids, apart], 4.6, turning=True) is apart
    assert cause_of_drive([skids], 4.6, turning=True) is skids
    slow = SKID_STEERING.diagnostic("slide", values={"ratio": 0.7, "stated": 0.2, "rolling": 2.0})
    assert cause_of_drive([slow, apart], 0.7, turning=True) is slow


def test_wheels_that_slide_do_not_explain_why_a_robot_turns_too_fast():
    skids = SKID_STEERING.diagnostic("slide", values={"ratio": 0.9, "stated": 0.5, "rolling": 1.2})
    wide = WHEEL_DIAMETER_MISMATCH.diagnostic("d", values={"stated": 0.4, "measured": 0.5})
    slim = WHEEL_DIAMETER_MISMATCH.diagnostic("d", values={"stated": 0.4, "measured": 0.38})
    assert cause_of_drive([skids, wide], 1.16, turning=True) is wide
    assert cause_of_drive([skids, wide], 0.7, turning=True) is not wide
    # Without a wrong size, it is the separation that is stated for wheels that slide.
    for found in ([skids], [skids, slim]):
        cause = cause_of_drive(found, 1.1, turning=True)
        assert cause.code is SKID_STEERING
        assert cause.values["measured"] == pytest.approx(1.1)


def test_wheels_that_slide_turn_a_robot_as_slowly_as_if_only_the_outer_ones_carried_it():
    values = {"ratio": 0.75, "least": 0.48, "stated": 0.7, "rolling": 1.1}
    skids = SKID_STEERING.diagnostic("slide", values=values)
    cause = cause_of_drive([skids], 0.45, turning=True)
    assert cause.values["measured"] == pytest.approx(0.45)
    assert cause_of_drive([skids], 0.2, turning=True) is None
    small = WHEEL_DIAMETER_MISMATCH.diagnostic("d", values={"stated": 0.123, "measured": 0.118})
    assert cause_of_drive([skids, small], 0.395, turning=True).code is SKID_STEERING


@pytest.mark.parametrize("predicted", [0.04, 1e-6, 0.0])
def test_wheels_that_slide_explain_why_a_robot_that_should_hardly_turn_does_not_turn(predicted):
    values = {"ratio": predicted, "stated": 0.4, "rolling": 1.0}
    skids = SKID_STEERING.diagnostic("slide", values=values)
    assert cause_of_drive([skids], -0.01, turning=True) is skids
    assert cause_of_drive([skids], -0.5, turning=True) is None


def test_swapped_wheels_explain_a_turn_to_the_wrong_side_and_not_a_standstill(tried):
    swapped = cart(0.1).replace("left_joint</", "x</").replace("right_joint</", "left_joint</")
    swapped = swapped.replace("x</", "right_joint</")
    verdict = tried(swapped)
    assert verdict.drives[0].follows
    (fault,) = verdict.faults
    assert (fault.test, fault.code) == ("turn", WHEELS_SWAPPED)
    # With too little torque, it stands still, which the swapped wheels do not explain.
    weak = swapped.replace("</plugin>", "<wheelTorque>0.0001</wheelTorque></plugin>")
    faults = tried(weak).faults
    assert {fault.test for fault in faults} == {"drive", "turn"}
    assert {fault.code for fault in faults} == {None}
    assert {fault.source for fault in faults} == {"unknown"}


def test_the_legacy_mode_does_not_swap_the_wheels(tried):
    """Since ROS Melodic, Gazebo's plugin ignores it."""
    legacy = cart(0.1).replace("<legacyMode>false", "<legacyMode>true")
    assert (verdict := tried(legacy)).good, verdict.faults
    swapped = legacy.replace("left_joint</", "x</").replace("right_joint</", "left_joint</")
    (fault,) = tried(swapped.replace("x</", "right_joint</")).faults
    assert (fault.test, fault.source, fault.code) == ("turn", "file", WHEELS_SWAPPED)


def test_a_vehicle_without_known_sides_faces_where_its_wheels_roll(tmp_path, tried):
    # All wheels are on the x axis, so that it drives along y.
    path = tmp_path / "drive.yaml"
    path.write_text(
        "drive:\n  type: diff_drive_controller/DiffDriveController\n  left_wheel: left_joint\n"
        "  right_wheel: right_joint\n  wheel_separation: 0.2\n  wheel_radius: 0.05\n"
    )
    joints = "".join(
        f'<transmission name="{side}"><type>transmission_interface/SimpleTransmission</type>'
        f'<joint name="{side}_joint"><hardwareInterface>hardware_interface/VelocityJointInterface'
        f'</hardwareInterface></joint><actuator name="{side}"/></transmission>'
        for side in ("left", "right")
    )
    control = '<gazebo><plugin name="control" filename="libgazebo_ros_control.so"/></gazebo>'
    turned = cart(0.1).split('<gazebo><plugin name="drive"')[0]
    turned = turned.replace('name="base"', 'name="body"').replace('"base"', '"body"')
    root = (
        '<link name="base"/><joint name="turn" type="fixed"><parent link="base"/>'
        '<child link="body"/><origin xyz="0 0 0" rpy="0 0 -1.5707963"/></joint>'
    )
    (drive,) = tried(root, turned, joints, control, controllers=[path]).drives
    assert abs(drive.error) < 0.02, drive


def test_the_robots_own_limits_are_no_fault(tried):
    slow = "<max_velocity>0.1</max_velocity></plugin>"
    verdict = tried(cart(0.1).replace("libgazebo_ros_diff_drive.so", "gz-sim-diff-drive-system")
        .replace("leftJoint", "left_joint").replace("rightJoint", "right_joint")
        .replace("wheelSeparation", "wheel_separation")
        .replace("<wheelDiameter>0.1</wheelDiameter>", "<wheel_radius>0.05</wheel_radius>")
        .replace("</plugin>", slow))  # fmt: skip
    (drive,) = verdict.drives
    assert drive.limited
    assert (drive.commanded, drive.commanded_turn) == (0.1, 0.1)
    assert verdict.good, verdict.faults


def test_the_velocity_limits_of_wheels_are_no_fault(tried):
    """1 rad/s on a radius of 5 cm, of which 90 % is commanded; the track is 0.2 m."""
    verdict = tried(cart(0.1).replace("libgazebo_ros_diff_drive.so", "gz-sim-diff-drive-system")
        .replace("leftJoint", "left_joint").replace("rightJoint", "right_joint")
        .replace("wheelSeparation", "wheel_separation")
        .replace("<wheelDiameter>0.1</wheelDiameter>", "<wheel_radius>0.05</wheel_radius>")
        .replace('<axis xyz="0 0 1"/>', '<axis xyz="0 0 1"/><limit effort="9" velocity="1"/>')
    )  # fmt: skip
    (drive,) = verdict.drives
    assert drive.limited
    assert (drive.commanded, drive.commanded_turn) == pytest.approx((0.045, 0.4))
    assert verdict.good, verdict.faults


def test_a_vehicle_that_faces_y_is_measured_along_its_wheels(tried):
    turned = cart(0.1).replace('name="base"', 'name="body"').replace('"base"', '"body"')
    joint = (
        '<link name="base"/><joint name="turn" type="fixed"><parent link="base"/>'
        '<child link="body"/><origin xyz="0 0 0" rpy="0 0 1.5707963"/></joint>'
    )
    (drive,) = tried(joint, turned).drives
    assert abs(drive.error) < 0.02
    assert abs(drive.error_turn) < 0.05


def test_what_is_top_heavy_tips(tried):
    # Its centre of mass lies beyond the edge of what it stands on.
    verdict = tried(BOX.format(name="base", at="0.2 0 0", size="0.1 0.1 0.3"))
    assert verdict.stand.state in ("tips", "moves")
    assert verdict.stand.tilt > 1.0
    (fault,) = verdict.faults
    assert (fault.test, fault.code) == ("stand", UNBALANCED)


LIDAR = (
    '<link name="lidar"><collision><geometry><mesh filename="package://bot/lidar.stl"/></geometry>'
    '</collision></link><joint name="l" type="fixed"><parent link="base"/><child link="lidar"/>'
    '<origin xyz="0 0 {height}"/></joint>'
)


@pytest.mark.parametrize(("height", "code"), [(0.2, UNBALANCED), (-0.1, FILE_MISSING)])
def test_a_missing_mesh_above_a_robot_is_no_reason_why_it_tips(tried, height, code):
    frame = '<link name="frame"/><joint name="f" type="continuous"><parent link="base"/>'
    frame += '<child link="frame"/></joint>'
    body = BOX.format(name="base", at="0.2 0 0", size="0.1 0.1 0.3")
    (fault,) = tried(body, LIDAR.format(height=height), frame).faults
    assert (fault.test, fault.code) == ("stand", code)


LEG = """<link name="leg"><inertial><mass value="4"/>
  <inertia ixx="0.05" iyy="0.05" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><origin xyz="0 0 -0.3"/><geometry><box size="0.4 0.4 0.05"/>
  </geometry></collision></link>
<joint name="hip" type="revolute"><parent link="base"/><child link="leg"/><origin xyz="0 0 -0.05"/>
  <axis xyz="0 1 0"/><limit lower="-1.5" upper="1.5" effort="9" velocity="3"/></joint>
<transmission name="t"><type>transmission_interface/SimpleTransmission</type><joint name="hip">
  <hardwareInterface>hardware_interface/EffortJointInterface</hardwareInterface></joint>
  <actuator name="m"/></transmission>
<gazebo><plugin name="control" filename="libgazebo_ros_control.so"/></gazebo>"""


def test_legs_without_controllers_are_the_reason_why_a_robot_falls(tried):
    verdict = tried(BOX.format(name="base", at="0.08 0 0", size="0.3 0.3 0.1"), LEG)
    reasons = {fault.test: fault.code for fault in verdict.faults}
    assert reasons == dict.fromkeys(("controller", "stand"), CONTROLLERS_NOT_FOUND)


def test_an_arm_whose_limits_exclude_zero_is_balanced_where_it_starts(tried):
    # The weight is above the base at 0, and beside it at the lower limit.
    upper = ARM[ARM.index('<link name="upper">') : ARM.index('<joint name="stand"')]
    joint = ARM[ARM.index('<joint name="shoulder"') : ARM.index("<transmission")]
    upper = upper.replace('xyz="0 0 0.1"', 'xyz="0 0 0.5"').replace('"1"/>', '"3"/>')
    joint = joint.replace('lower="-1" upper="1"', 'lower="1" upper="2"')
    joint = joint.replace("<limit", '<dynamics friction="100" damping="1"/><limit')
    verdict = tried(BOX.format(name="base", at="0 0 0", size="0.2 0.2 0.1"), upper, joint)
    (fault,) = verdict.faults
    assert (fault.test, fault.code) == ("stand", UNBALANCED)


def test_what_has_nothing_to_stand_on_sinks(tried):
    link = f'<link name="base">{INERTIA.format(m=1, i=0.1)}</link>'
    verdict = tried(link)
    # Free fall for two seconds: g t² / 2.
    assert verdict.stand.sunk == pytest.approx(0.5 * 9.8 * 4, rel=0.02)
    assert verdict.stand.state == "moves"


def test_what_the_world_holds_is_fixed(tried):
    verdict = tried('<link name="world"/>', BOX.format(name="base", at="0 0 0", size="1 1 1"), (
        '<joint name="j" type="fixed"><parent link="world"/><child link="base"/></joint>'
    ))  # fmt: skip
    assert verdict.stand.state == "fixed"
    assert verdict.good
    assert verdict.drives == ()


def test_a_cart_that_the_world_holds_cannot_drive(tried):
    hold = '<link name="world"/><joint name="hold" type="fixed"><parent link="world"/>{}</joint>'
    verdict = tried(cart(0.1), hold.format('<child link="base"/>'))
    assert verdict.stand.state == "fixed"
    (fault,) = verdict.faults
    assert (fault.test, fault.subject) == ("drive", "gazebo_ros_diff_drive")
    assert fault.code is BASE_FIXED
    assert fault.source == "file"
    assert verdict.should_move
    assert not verdict.moves


@pytest.mark.parametrize("name", ["arm.yaml", "config.yml"])
def test_the_controllers_beside_a_robot_take_its_joint_where_that_is_set(tmp_path, tried, name):
    (tmp_path / "package.xml").write_text("<package><name>arm</name></package>")
    (tmp_path / "config").mkdir()
    (tmp_path / "config" / name).write_text(
        "arm_controller:\n  type: position_controllers/JointTrajectoryController\n"
        "  joints: [shoulder]\n"
    )
    # Of ROS 2, and so for another robot.
    (tmp_path / "config" / "ros2.yaml").write_text(
        "controller_manager:\n  ros__parameters:\n    other:\n"
        "      type: position_controllers/JointGroupPositionController\n"
        "other:\n  ros__parameters:\n    joints: [shoulder]\n"
    )
    verdict = tried(ARM.format(kind="Position"))
    assert verdict.controllers == ("arm_controller",)
    (reach,) = verdict.reaches
    # The target is 0.2 rad from where it stood, and it bears the weight.
    assert reach.target == pytest.approx(-0.2, abs=1e-3)
    assert abs(reach.error) < 1e-3
    assert reach.arrived
    assert verdict.good


PID = (
    "arm_controller:\n  type: effort_controllers/JointPositionController\n"
    "  joint: shoulder\n  pid: {{p: {p}, d: 1.0}}\n"
)


def test_an_error_that_follows_from_gravity_and_the_gains_is_none(tmp_path, tried):
    path = tmp_path / "soft.yaml"
    path.write_text(PID.format(p=3.0))
    verdict = tried(ARM.format(kind="Effort"), controllers=[path])
    (reach,) = verdict.reaches
    # At rest, p times the error is the weight: 3 e = m g l sin(q), with m g l = 0.98 N m.
    assert abs(reach.error) == pytest.approx(0.98 * abs(math.sin(reach.reached)) / 3.0, rel=0.02)
    assert reach.sag == pytest.approx(abs(reach.error), rel=0.02)
    assert reach.arrived
    assert verdict.good


@pytest.mark.parametrize("damping", [0.0, 0.5])
def test_a_controller_without_damping_is_the_reason_for_oscillations(tmp_path, tried, damping):
    """A spring of 1 N m/rad on 0.02 kg m² about a vertical axis oscillates for minutes."""
    path = tmp_path / "spring.yaml"
    path.write_text(PID.format(p=1.0).replace("d: 1.0", "d: 0.0"))
    text = ARM.format(kind="Effort").replace('xyz="0 1 0"', 'xyz="0 0 1"')
    verdict = tried(
        text.replace("<limit", f'<dynamics damping="{damping}"/><limit'), controllers=[path]
    )
    (reach,) = verdict.reaches
    assert reach.arrived == (damping > 0)
    assert [(each.test, each.code, each.source) for each in verdict.faults] == (
        [] if damping else [("reach", CONTROLLER_UNDAMPED, "file")]
    )


def test_damping_that_the_effort_limit_cannot_overcome_is_the_reason(tmp_path, tried):
    """50 N m against 5000 N m s/rad."""
    path = tmp_path / "slow.yaml"
    path.write_text(PID.format(p=500.0))
    text = ARM.format(kind="Effort").replace("<limit", '<dynamics damping="5000"/><limit')
    (fault,) = tried(text, controllers=[path]).faults
    assert (fault.test, fault.code, fault.source) == ("reach", DAMPING_TOO_HIGH, "file")


LIFT = (
    f'<link name="world"/><link name="base">{INERTIA.format(m=1, i=0.01)}</link>'
    '<link name="cart"><inertial><mass value="1"/>'
    '<inertia ixx="1" iyy="1" izz="1" '
    'ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="stand" type="fixed">'
    '<parent link="world"/><child link="base"/></joint><joint name="slide" type="prismatic">'
    '<parent link="base"/><child link="cart"/><axis xyz="0 0 1"/><dynamics damping="1"/>'
    '<limit lower="-2.5" upper="2.5" effort="1000" velocity="30"/></joint>'
    '<ros2_control name="s" type="system"><hardware><plugin>gazebo_ros2_control/GazeboSystem'
    '</plugin></hardware><joint name="slide">{gains}<command_interface name="{kind}_pid"/>'
    '</joint></ros2_control><gazebo><plugin name="c" filename="libgazebo_ros2_control.so"/>'
    "</gazebo>"
)
"""A cart of 1 kg on a vertical slide, whose hardware contains a PID controller."""


def test_a_robot_without_controllers_does_not_move_with_any_hardware(tried):
    other = LIFT.format(kind="position", gains="").replace("gazebo_ros2_control/Gaz", "own/Own")
    faults = tried(other).faults
    assert {fault.code for fault in faults} == {CONTROLLERS_NOT_FOUND, HARDWARE_WITHOUT_PLUGIN}
    assert all((fault.test, fault.source) == ("controller", "file") for fault in faults)


@pytest.mark.parametrize(
    ("kind", "gains", "error", "codes"),
    [
        # Its weight over the gain.
        ("position", {"pos_kp": 600, "pos_ki": 1, "pos_kd": 10}, 9.8 / 600, ["CW487"]),
        # The integral has reduced it by a half to a third while it is measured.
        ("velocity", {"vel_kp": 10, "vel_ki": 10, "vel_kd": 0.1}, 0.15, []),
    ],
)
def test_an_error_that_follows_from_the_load_and_the_gains_of_the_hardware(
    *, tmp_path, tried, kind, gains, error, codes
):
    """A large error of a position is a fault of the file."""
    path = tmp_path / "lift.yaml"
    path.write_text(
        "controller_manager:\n  ros__parameters:\n    lift:\n"
        f"      type: {kind}_controllers/JointGroup{kind.title()}Controller\n"
        "lift:\n  ros__parameters:\n    joints: [slide]\n"
    )
    written = "".join(f'<param name="{name}">{value}</param>' for name, value in gains.items())
    verdict = tried(LIFT.format(kind=kind, gains=written), controllers=[path])
    (one,) = verdict.reaches or verdict.spins
    wanted, got = (one.target, one.reached) if kind == "position" else (one.commanded, one.measured)
    assert wanted - got == pytest.approx(error, rel=0.1)
    assert error <= one.sag * 1.01
    assert [fault.code.number for fault in verdict.faults] == codes


@pytest.mark.parametrize("gain", [3.0, 12.0, 20.0])
def test_an_error_that_follows_from_friction_and_the_gain_of_a_plugin(tried, gain):
    """A large one is a fault of the file: 0.1 rad times the gain is less than the friction."""
    plugin = (
        '<gazebo><plugin name="p" filename="gz-sim-joint-position-controller-system">'
        f"<joint_name>shoulder</joint_name><p_gain>{gain}</p_gain></plugin></gazebo>"
    )
    rubbing = ARM.format(kind="Effort").replace(
        '<limit lower="-1"', '<dynamics friction="1.5" damping="1"/><limit lower="-1"'
    )
    verdict = tried(rubbing.split("<transmission")[0], plugin)
    (reach,) = verdict.reaches
    # Gravity, 0.98 N m sin(0.2), is not what holds it.
    assert reach.sag > 1.5 / gain
    assert reach.moved == (gain * 0.2 > 1.5)
    assert verdict.good == (abs(reach.error) < 0.1) == (gain * 0.1 > 1.5)
    if not verdict.good:
        (fault,) = verdict.faults
        assert (fault.test, fault.code, fault.source) == ("reach", CONTROLLER_GAIN_TOO_LOW, "file")


def test_an_arm_that_nothing_drives_falls_and_the_reason_is_reported(tried):
    upper = ARM[ARM.index('<link name="upper">') : ARM.index('<joint name="stand"')]
    joint = ARM[ARM.index('<joint name="shoulder"') : ARM.index("<transmission")]
    # It falls to the side.
    upper = upper.replace('xyz="0 0 0.1"', 'xyz="0.02 0 0.5"').replace('"1"/>', '"3"/>')
    joint = joint.replace('lower="-1" upper="1"', 'lower="-2" upper="2"')
    verdict = tried(BOX.format(name="base", at="0 0 0", size="0.2 0.2 0.1"), upper, joint)
    assert verdict.stand.state in ("tips", "moves"), verdict.stand
    (fault,) = verdict.faults
    assert (fault.test, fault.code, fault.source) == ("stand", JOINTS_UNDRIVEN, "file")


def test_what_falls_through_the_ground_has_no_collision(tried):
    """Its missing inertia is not why it falls, but Gazebo does not even load it."""
    shape = '<visual><geometry><box size="0.2 0.2 0.1"/></geometry></visual>'
    verdict = tried(f'<link name="base">{shape}</link>')
    assert verdict.stand.state == "moves"
    assert [(fault.test, fault.code, fault.source) for fault in verdict.faults] == [
        ("load", INERTIA_MISSING, "file"),
        ("stand", BASE_WITHOUT_COLLISION, "file"),
    ]
    inertia = (
        '<inertial><mass value="1"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
    )
    verdict = tried(f'<link name="base">{inertia}{shape}</link>')
    assert [fault.code for fault in verdict.faults] == [BASE_WITHOUT_COLLISION]


def test_an_arm_whose_hardware_names_other_joints_falls_and_the_reason_is_reported(tmp_path, tried):
    """A running broadcaster holds no joint."""
    upper = ARM[ARM.index('<link name="upper">') : ARM.index('<joint name="stand"')]
    joint = ARM[ARM.index('<joint name="shoulder"') : ARM.index("<transmission")]
    upper = upper.replace('xyz="0 0 0.1"', 'xyz="0.02 0 0.5"').replace('"1"/>', '"3"/>')
    joint = joint.replace('lower="-1" upper="1"', 'lower="-2" upper="2"')
    (tmp_path / "arm.yaml").write_text(
        "controller_manager:\n  ros__parameters:\n    states:\n"
        "      type: joint_state_broadcaster/JointStateBroadcaster\n"
    )
    control = f"""<ros2_control name="arm" type="system"><hardware>
      <plugin>gazebo_ros2_control/GazeboSystem</plugin></hardware>
      <joint name="Shoulder"><command_interface name="position"/></joint></ros2_control>
      <gazebo><plugin name="c" filename="libgazebo_ros2_control.so">
      <parameters>{tmp_path}/arm.yaml</parameters></plugin></gazebo>"""
    verdict = tried(BOX.format(name="base", at="0 0 0", size="0.2 0.2 0.1"), upper, joint, control)
    assert verdict.controllers == ("states",)
    stand = next(fault for fault in verdict.faults if fault.test == "stand")
    assert (stand.code, stand.source) == (CONTROL_WITHOUT_JOINTS, "file")
    assert stand.reason.values["joints"] == ("Shoulder",)


def test_an_arm_whose_controller_waits_for_a_command_falls_and_the_reason_is_reported(
    tmp_path, tried
):
    path = tmp_path / "arm.yaml"
    path.write_text("arm:\n  type: effort_controllers/JointEffortController\n  joint: shoulder\n")
    arm = ARM.format(kind="Effort")
    upper = arm[arm.index('<link name="upper">') : arm.index('<joint name="stand"')]
    arm = upper + arm[arm.index('<joint name="shoulder"') :]
    arm = arm.replace('xyz="0 0 0.1"', 'xyz="0.02 0 0.5"').replace('"1"/>', '"3"/>')
    arm = arm.replace('lower="-1" upper="1"', 'lower="-2" upper="2"')
    verdict = tried(
        BOX.format(name="base", at="0 0 0", size="0.2 0.2 0.1"), arm, controllers=[path]
    )
    assert not verdict.stands, verdict.stand
    fault = next(each for each in verdict.faults if each.test == "stand")
    assert (fault.code, fault.source) == (JOINTS_UNDRIVEN, "file")
    assert fault.reason.values["joints"] == ("shoulder",)


def test_a_velocity_error_that_follows_from_the_load_and_the_gain_is_none(tmp_path, tried):
    """A load of 1 kg on a vertical slide: (9.8 N + 1 N s/m v) = 100 N s/m (0.5 m/s - v)."""
    path = tmp_path / "lift.yaml"
    path.write_text(
        "lift_controller:\n  type: effort_controllers/JointVelocityController\n"
        "  joint: shoulder\n  pid: {p: 100.0}\n"
    )
    lift = ARM.format(kind="Effort").replace('type="revolute"', 'type="prismatic"')
    lift = lift.replace('<axis xyz="0 1 0"/>', '<axis xyz="0 0 1"/><dynamics damping="1"/>')
    lift = lift.replace('lower="-1" upper="1"', 'lower="-2" upper="2"')
    verdict = tried(lift, controllers=[path])
    (spin,) = verdict.spins
    assert spin.measured == pytest.approx((100.0 * 0.5 - 9.8) / 101.0, rel=0.01)
    assert spin.follows
    assert verdict.good, verdict.faults


def test_an_inertia_that_no_motor_moves_is_why_a_joint_does_not_arrive(tmp_path, tried):
    path = tmp_path / "arm.yaml"
    path.write_text(PID.format(p=100.0))
    heavy = ARM.format(kind="Effort").replace('ixx="0.01" iyy="0.01"', 'ixx="1e5" iyy="1e5"')
    shape = '<collision><geometry><box size="0.1 0.1 0.2"/></geometry></collision></link>'
    heavy = heavy.replace('izz="0.01" ixy', 'izz="1e5" ixy').replace(
        "</inertial></link>", f"</inertial>{shape}"
    )
    (fault,) = tried(heavy, controllers=[path]).faults
    assert (fault.test, fault.code) == ("reach", INERTIA_GEOMETRY_MISMATCH)
    assert fault.source == "file"


def test_two_controller_managers_are_why_a_joint_does_not_arrive(tmp_path, tried):
    path = tmp_path / "arm.yaml"
    path.write_text(
        "arm_controller:\n  type: position_controllers/JointPositionController\n  joint: shoulder\n"
    )
    second = '<gazebo><plugin name="again" filename="libgazebo_ros_control.so">'
    second += "<robotNamespace>/again</robotNamespace></plugin></gazebo>"
    verdict = tried(ARM.format(kind="Position"), second, controllers=[path])
    assert JOINT_DRIVEN_TWICE in {each.code for each in verdict.diagnostics}
    assert all(fault.source == "file" for fault in verdict.faults)


def test_an_effort_moves_a_light_link_without_throwing_it(tmp_path, tried):
    path = tmp_path / "push.yaml"
    path.write_text("push:\n  type: effort_controllers/JointEffortController\n  joint: shoulder\n")
    light = (
        ARM.format(kind="Effort")
        .replace('"0.01"', '"1e-6"')
        .replace('<mass value="1"/>', '<mass value="1e-4"/>')
    )
    verdict = tried(light, controllers=[path])
    (spin,) = verdict.spins
    assert spin.follows
    assert abs(spin.measured) < 10
    assert verdict.good, verdict.faults


def test_an_effort_moves_a_damped_joint_of_little_inertia(tmp_path, tried):
    """The effort for an acceleration of 5 rad/s² alone would turn it at 5e-6 rad/s."""
    path = tmp_path / "push.yaml"
    path.write_text("push:\n  type: effort_controllers/JointEffortController\n  joint: shoulder\n")
    light = ARM.format(kind="Effort").replace('"0.01"', '"1e-8"').replace("0 0 0.1", "0 0 0")
    damped = light.replace("<limit", '<dynamics damping="0.01"/><limit')
    verdict = tried(damped, controllers=[path])
    (spin,) = verdict.spins
    assert spin.measured == pytest.approx(0.5, rel=0.1)
    assert verdict.good, verdict.faults


def test_a_joint_that_is_too_weak_does_not_arrive(tmp_path, tried):
    path = tmp_path / "weak.yaml"
    path.write_text(PID.format(p=100.0))
    weak = ARM.format(kind="Effort").replace('effort="50"', 'effort="0.01"')
    verdict = tried(weak, controllers=[path])
    (reach,) = verdict.reaches
    assert not reach.arrived
    (fault,) = verdict.faults
    assert (fault.test, fault.subject, fault.code) == ("reach", "shoulder", None)
    assert verdict.outcome == "unknown"


def test_a_plugin_that_is_missing_and_moves_a_joint_is_a_fault(tried):
    extra = (
        '<gazebo><plugin name="x" filename="libmy_own_thing.so"><side>flap_joint</side></plugin>'
        "</gazebo>"
    )
    verdict = tried(cart(0.1), FLAP.format(z=0.2), extra)
    (fault,) = verdict.faults
    assert (fault.test, fault.subject, fault.code) == ("plugin", "my_own_thing", PLUGIN_UNKNOWN)
    assert fault.source == "unknown"
    assert verdict.should_move
    assert not verdict.moves


def test_a_plugin_that_only_records_motors_is_no_fault(tried):
    plugin = (
        '<gazebo><plugin name="b" filename="librotors_gazebo_bag_plugin.so">'
        "<commandMotorSpeedTopic>command</commandMotorSpeedTopic></plugin></gazebo>"
    )
    verdict = tried(cart(0.1), plugin)
    assert verdict.missing == ("rotors_gazebo_bag_plugin",)
    assert verdict.good


def test_a_controller_of_wheels_without_friction_is_no_fault_if_the_robot_is_pushed(
    tmp_path, tried
):
    """A planar drive moves the robot; the controller only turns its mecanum wheels."""
    names = ("front_left", "front_right", "back_left", "back_right")
    wheels, interfaces = "", ""
    for name in names:
        x = 0.1 if name.startswith("front") else -0.1
        y = 0.1 if name.endswith("left") else -0.1
        wheels += WHEEL.format(name=name, y=y).replace('xyz="0 ', f'xyz="{x} ')
        wheels += f'<gazebo reference="{name}"><mu1>0</mu1><mu2>0</mu2></gazebo>'
        interfaces += f'<joint name="{name}_joint"><command_interface name="velocity"/></joint>'
    path = tmp_path / "mecanum.yaml"
    path.write_text(
        "controller_manager:\n  ros__parameters:\n    base:\n"
        "      type: mecanum_drive_controller/MecanumDriveController\n"
        "base:\n  ros__parameters:\n"
        + "".join(
            f"    {name.replace('back', 'rear')}_wheel_command_joint_name: {name}_joint\n"
            for name in names
        )
        + "    kinematics: {wheels_radius: 0.05,"
        " sum_of_robot_center_projection_on_X_Y_axis: 0.2}\n"
    )
    verdict = tried(
        BOX.format(name="base", at="0 0 0", size="0.3 0.15 0.03") + wheels,
        '<ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem'
        f"</plugin></hardware>{interfaces}</ros2_control><gazebo>"
        '<plugin name="c" filename="gz_ros2_control-system">'
        f"<parameters>{path}</parameters></plugin>"
        '<plugin name="p" filename="libgazebo_ros_planar_move.so"/></gazebo>',
    )
    errors = {drive.topic: drive.error for drive in verdict.drives}
    assert len(errors) == 2
    assert abs(errors["/cmd_vel"]) < 0.05
    assert min(errors.values()) == pytest.approx(-1.0, abs=0.05)
    assert verdict.moves, verdict.faults


@pytest.mark.parametrize("kind", ["my_controllers/Own", "my_controllers/OwnBroadcaster"])
def test_a_controller_that_a_launch_file_starts_and_that_is_not_supported_is_a_fault(
    tmp_path, kind
):
    """Unless its type says that it only publishes."""
    files = {
        "package.xml": "<package><name>arm</name></package>",
        "arm.urdf": f'<robot name="arm">{ARM.format(kind="Position")}</robot>',
        "a.yaml": "a:\n  type: position_controllers/JointPositionController\n  joint: shoulder\n"
        f"b:\n  type: {kind}\n  joint: shoulder\n",
        "a.launch": '<launch><param name="robot_description" textfile="$(find arm)/arm.urdf"/>'
        '<rosparam file="$(find arm)/a.yaml"/>'
        '<node name="s" pkg="controller_manager" type="spawner" args="a b"/></launch>',
    }
    for name, text in files.items():
        (tmp_path / "arm" / name).parent.mkdir(exist_ok=True)
        (tmp_path / "arm" / name).write_text(text)
    verdict = try_robot(
        tmp_path / "arm" / "arm.urdf", standing=1.0, launches=launches_near(tmp_path)
    )
    assert verdict.controllers == ("a",)
    if kind.endswith("Broadcaster"):
        assert verdict.good, verdict.faults
        return
    (fault,) = verdict.faults
    assert (fault.test, fault.subject, fault.code) == ("controller", "b", CONTROLLER_NOT_STARTED)
    assert fault.source == "unknown"


@pytest.mark.parametrize("interfaces", [("position",), ("position", "velocity")])
def test_a_controller_that_a_launch_file_starts_must_start_if_the_robot_names_its_file(
    tmp_path, interfaces
):
    offered = "".join(f'<command_interface name="{each}"/>' for each in interfaces)
    joint = f'<joint name="shoulder">{offered}</joint>'
    group = (
        "  ros__parameters:\n    type: {0}_controllers/JointGroup{1}Controller\n    joints: [{2}]\n"
    )
    arm = ARM.format(kind="Position").replace(
        '"libgazebo_ros_control.so"/>',
        '"libgazebo_ros2_control.so"><parameters>$(find arm)/a.yaml</parameters></plugin>',
    )
    files = {
        "package.xml": "<package><name>arm</name></package>",
        "arm.xacro": f'<robot name="arm" xmlns:xacro="http://www.ros.org/wiki/xacro">{arm}'
        '<ros2_control name="x" type="system"><hardware><plugin>gazebo_ros2_control/GazeboSystem'
        f"</plugin></hardware>{joint}</ros2_control></robot>",
        "a.yaml": "a:\n" + group.format("position", "Position", "shoulder")
        + "b:\n" + group.format("velocity", "Velocity", "shoulder"),
        "a.launch.xml": '<launch><node pkg="robot_state_publisher" exec="robot_state_publisher">'
        '<param name="robot_description" '
        """value="$(command 'xacro $(find-pkg-share arm)/arm.xacro')"/>"""
        '</node><node pkg="gazebo_ros" exec="spawn_entity.py" args="-topic x"/>'
        '<node pkg="controller_manager" exec="spawner" args="a b"/></launch>',
    }  # fmt: skip
    for name, text in files.items():
        (tmp_path / "arm" / name).parent.mkdir(exist_ok=True)
        (tmp_path / "arm" / name).write_text(text)
    verdict = try_robot(
        tmp_path / "arm" / "arm.xacro", standing=1.0, launches=launches_near(tmp_path)
    )
    (fault,) = verdict.faults
    if len(interfaces) == 1:
        assert verdict.controllers == ("a",)
        wanted = ("controller", "b", CONTROLLER_NOT_STARTED)
        assert fault.reason.values["cause"] == CONTROLLER_INTERFACE_MISMATCH.number
    else:
        # As in gazebo_ros2_control, the joint follows its position commands.
        assert verdict.controllers == ("a", "b")
        wanted = ("spin", "shoulder", JOINT_SHARED)
    assert (fault.test, fault.subject, fault.code) == wanted
    assert fault.source == "file"


@pytest.mark.parametrize("tag", ["<rollGain>5</rollGain>", "<motorConstant>1</motorConstant>"])
def test_an_unsupported_plugin_with_gains_or_motors_is_a_fault(tried, tag):
    fly = f'<gazebo><plugin name="x" filename="libown_thing.so">{tag}</plugin></gazebo>'
    verdict = tried(BOX.format(name="base", at="0 0 0", size="1 1 1"), fly)
    (fault,) = verdict.faults
    assert (fault.test, fault.subject) == ("plugin", "own_thing")
    assert verdict.should_move


def test_wheels_whose_drive_is_in_a_package_that_is_not_installed_are_unknown(tmp_path):
    path = tmp_path / "cart.xacro"
    include = '<xacro:include filename="$(find far_drive)/drive.xacro"/>'
    wheels = cart(0.1).replace(DRIVE.format(diameter=0.1), include)
    head = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="cart">'
    path.write_text(f"{head}{wheels}</robot>")
    verdict = try_robot(path, standing=1.0)
    assert verdict.loaded
    (fault,) = verdict.faults
    assert (fault.test, fault.code, fault.source) == ("plugin", INCLUDE_ABSENT, "unknown")
    assert verdict.should_move
    assert not verdict.moves


def test_a_robot_whose_body_was_in_an_absent_file_falls_because_of_that(tmp_path):
    """Its mast is left, and tips over."""
    path = tmp_path / "cart.xacro"
    include = '<xacro:include filename="$(find far_cart)/body.xacro"/><xacro:body name="base"/>'
    mast = BOX.format(name="mast", at="0.3 0 0", size="0.02 0.02 0.5") + (
        '<joint name="mast_joint" type="fixed"><parent link="base"/><child link="mast"/></joint>'
    )
    head = '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="cart">'
    path.write_text(f"{head}{include}{mast}</robot>")
    verdict = try_robot(path, standing=2.0)
    (fault,) = verdict.faults
    assert (fault.test, fault.code, fault.source) == ("stand", LINK_RECONNECTED, "file")
    # A lost link that only holds a part does not explain why the rest tips over.
    body = BOX.format(name="base", at="0.3 0 0", size="0.1 0.1 0.1")
    arm = mast.replace('"base"', '"holder"')
    joint = '<joint name="h" type="fixed"><parent link="base"/><child link="holder"/></joint>'
    include = include.replace("base", "holder")
    path.write_text(f"{head}{include}{body}{joint}{arm}</robot>")
    (fault,) = try_robot(path, standing=2.0).faults
    assert (fault.test, fault.code) == ("stand", UNBALANCED)


def test_a_manager_without_controllers_is_a_fault(tried):
    verdict = tried(ARM.format(kind="Position"))
    (fault,) = verdict.faults
    assert (fault.test, fault.code) == ("controller", CONTROLLERS_NOT_FOUND)
    assert fault.reason.values["started"] == ()
    assert verdict.should_move
    assert not verdict.moves


def test_a_launch_file_that_only_starts_a_publisher_is_named(tmp_path):
    """Other controllers are in a file, but nothing starts them."""
    publisher = "states: {type: joint_state_controller/JointStateController, publish_rate: 50}"
    mover = "mover: {type: position_controllers/JointPositionController, joint: shoulder}"
    for path, text in {
        "package.xml": "<package><name>arm</name></package>",
        "config/states.yaml": publisher,
        "config/mover.yaml": mover,
        "urdf/robot.urdf": f'<robot name="robot">{ARM.format(kind="Position")}</robot>',
        "launch/a.launch": """<launch>
          <param name="robot_description" textfile="$(find arm)/urdf/robot.urdf"/>
          <node name="m" pkg="gazebo_ros" type="spawn_model"
            args="-urdf -param robot_description -model r"/>
          <rosparam file="$(find arm)/config/states.yaml" command="load"/>
          <node name="s" pkg="controller_manager" type="spawner" args="states"/></launch>""",
    }.items():
        (tmp_path / path).parent.mkdir(exist_ok=True)
        (tmp_path / path).write_text(text)
    launches = launches_near(tmp_path)
    verdict = try_robot(tmp_path / "urdf/robot.urdf", standing=2.0, launches=launches)
    assert verdict.controllers == ("states",)
    (fault,) = verdict.faults
    assert (fault.test, fault.code) == ("controller", CONTROLLERS_NOT_FOUND)
    assert fault.reason.values["started"] == ("states",)


@pytest.mark.parametrize("kind", ["velocity", "effort"])
def test_joints_are_moved_by_velocities_and_efforts(tmp_path, tried, kind):
    path = tmp_path / "spin.yaml"
    path.write_text(
        f"spin:\n  type: {kind}_controllers/Joint{kind.capitalize()}Controller\n  joint: shoulder\n"
    )
    verdict = tried(ARM.format(kind=kind.capitalize()), controllers=[path])
    (spin,) = verdict.spins
    assert spin.joint == "shoulder"
    assert spin.effort == (kind == "effort")
    assert spin.follows
    assert verdict.moves
    assert verdict.good


def test_the_velocities_of_a_joint_with_close_limits_end_within_them(tmp_path):
    """The joint has 0.15 rad in each direction: at 0.5 rad/s, it would be there after 0.3 s."""
    path = tmp_path / "robot.sdf"
    path.write_text(
        '<sdf version="1.9"><model name="robot"><link name="base"/><joint name="bolt" type="fixed">'
        "<parent>world</parent><child>base</child></joint><link name='beam'><inertial>"
        "<mass>1</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial></link>"
        "<joint name='tilt' type='revolute'><parent>base</parent><child>beam</child><axis>"
        "<xyz>0 1 0</xyz><limit><lower>-0.15</lower><upper>0.15</upper></limit></axis></joint>"
        '<plugin filename="gz-sim-joint-controller-system" name="c"><joint_name>tilt</joint_name>'
        "</plugin></model></sdf>"
    )
    verdict = try_robot(path, standing=2.0)
    assert verdict.good, verdict
    (spin,) = verdict.spins
    assert 0 < abs(spin.commanded) < 0.15 / 2
    assert spin.measured == pytest.approx(spin.commanded, rel=0.01)


def test_plugins_that_are_not_there_are_listed_and_cost_nothing_else(tried):
    names = ("libmy_own_thing.so", "libKeysToCmdVelPlugin.so")  # the second has no effect
    extra = "".join(f'<gazebo><plugin name="x" filename="{name}"/></gazebo>' for name in names)
    verdict = tried(cart(0.1), extra)
    assert verdict.missing == ("my_own_thing",)
    assert verdict.good


@pytest.mark.parametrize("uri", ["file:///no/such.stl", "package://no_such/a.stl"])
def test_a_missing_mesh_is_counted_and_the_rest_is_tried(tried, uri):
    visual = f'<visual><geometry><mesh filename="{uri}"/></geometry></visual></link>'
    verdict = tried(BOX.format(name="base", at="0 0 0", size="1 1 1").replace("</link>", visual))
    assert verdict.missing_meshes == 1
    assert verdict.loaded
    assert verdict.stand.state == "yes"


def test_a_description_that_is_wrong_says_why(tried):
    verdict = tried('<link name="a"/><link name="a"/>')
    assert not verdict.loaded
    assert "robot.urdf:1" in verdict.error
    assert math.isnan(verdict.speed)
    (fault,) = verdict.faults
    assert (fault.test, fault.code, fault.source) == ("load", DUPLICATE_NAME, "file")


def test_a_topic_that_states_a_rate_and_is_silent_is_named():
    with World() as world:
        world.graph.advertise("/never", "std_msgs/msg/Float64", rate=10.0)
        assert listened(world) == (2, ("/never",))


@pytest.mark.parametrize("rate", [0.1, 0.2])
def test_a_topic_with_a_period_of_several_seconds_is_not_silent_before_it(rate):
    with World() as world:
        slow = world.graph.advertise("/slow", "std_msgs/msg/Float64", rate=rate)
        world.graph.advertise("/never", "std_msgs/msg/Float64", rate=rate)
        world.every(rate, lambda: slow.publish({"data": 1.0}))
        assert listened(world) == (3, ("/never",))


def test_a_topic_too_slow_to_wait_for_is_not_called_silent():
    with World() as world:
        world.graph.advertise("/hourly", "std_msgs/msg/Float64", rate=1 / 3600)
        assert listened(world) == (2, ())
        assert world.time < 60.0


def test_a_model_named_as_the_ground_is_tried_beside_it(tmp_path):
    path = tmp_path / "model.sdf"
    path.write_text("""<sdf version="1.6"><model name="ground_plane"><static>true</static>
      <link name="link"><collision name="c"><geometry><box><size>1 1 0.1</size></box></geometry>
      </collision></link></model></sdf>""")
    verdict = try_robot(path, standing=1.0)
    assert verdict.good
    assert verdict.stand.state == "fixed"


def test_arguments_and_controllers_come_from_the_launch_files_of_the_robot(tmp_path):
    files = {
        "package.xml": "<package><name>arm</name></package>",
        "arm.xacro": '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="$(arg robot)">'
        + ARM.format(kind="Position")
        + "</robot>",
        # Not in a folder named config, so that only the launch file names it.
        "settings/a.yaml": "a:\n  type: position_controllers/JointPositionController\n"
        "  joint: shoulder\n",
        "config/b.yaml": "b:\n  type: position_controllers/JointGroupPositionController\n"
        "  joints: [shoulder]\n",
        "launch/a.launch": '<launch><param name="robot_description" '
        'command="xacro $(find arm)/arm.xacro robot:=lefty"/>'
        '<rosparam file="$(find arm)/settings/a.yaml" command="load"/>'
        '<node name="s" pkg="controller_manager" type="spawner" args="a"/></launch>',
    }
    arm = tmp_path / "workspace" / "arm"
    for name, text in files.items():
        (arm / name).parent.mkdir(parents=True, exist_ok=True)
        (arm / name).write_text(text)
    verdict = try_robot(arm / "arm.xacro", standing=1.0)
    assert verdict.name == "lefty"
    assert verdict.launch.file == arm / "launch/a.launch"
    assert verdict.controllers == ("a",)
    assert verdict.good, verdict.faults
    # The caller's arguments and files take precedence.
    verdict = try_robot(
        arm / "arm.xacro",
        standing=1.0,
        arguments={"robot": "righty"},
        controllers=[arm / "config/b.yaml"],
    )
    assert (verdict.name, verdict.controllers) == ("righty", ("b",))


@pytest.mark.parametrize(("joint", "code"), [
    ("f", INCLUDE_ABSENT), ("left_shoulder", CONTROLLER_NOT_STARTED),
])  # fmt: skip
def test_a_gripper_in_an_absent_file_is_the_reason_why_its_controller_does_not_start(
    tmp_path, joint, code
):
    """Unless the robot has the joint, but without the prefix."""
    spawner = '<node name="s" pkg="controller_manager" type="spawner" args="a hand"/>'
    group = "\n  type: position_controllers/JointGroupPositionController\n  joints: [{joint}]\n"
    files = {
        "package.xml": "<package><name>arm</name></package>",
        "arm.xacro": '<robot xmlns:xacro="http://www.ros.org/wiki/xacro" name="arm">'
        + '<xacro:include filename="$(find far_gripper)/gripper.xacro"/>'
        + ARM.format(kind="Position")
        + "</robot>",
        "config/a.yaml": "a:"
        + group.format(joint="shoulder")
        + "hand:"
        + group.format(joint=joint),
        "launch/a.launch": '<launch><param name="robot_description" '
        'command="xacro $(find arm)/arm.xacro"/><rosparam file="$(find arm)/config/a.yaml" '
        f'command="load"/>{spawner}</launch>',
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    verdict = try_robot(tmp_path / "arm.xacro", standing=1.0)
    assert verdict.controllers == ("a",)
    (fault,) = verdict.faults
    assert (fault.test, fault.subject, fault.code) == ("controller", "hand", code)


def test_a_controller_of_the_file_in_the_tag_must_start_if_a_launch_file_starts_it(tmp_path):
    plugin = (
        '<ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem'
        '</plugin></hardware><joint name="shoulder"><command_interface name="position"/></joint>'
        '</ros2_control><gazebo><plugin name="c" filename="gz_ros2_control-system">'
        "<parameters>config/a.yaml</parameters></plugin></gazebo>"
    )
    body = ARM.format(kind="Position")
    tag = body[body.index("<gazebo>") : body.index("</gazebo>") + len("</gazebo>")]
    group = "{type: position_controllers/JointGroupPositionController}"
    files = {
        "package.xml": "<package><name>arm</name></package>",
        "arm.urdf": f'<robot name="arm">{body.replace(tag, plugin)}</robot>',
        "config/a.yaml": f"controller_manager: {{ros__parameters: {{a: {group}, hand: {group}}}}}"
        "\na: {ros__parameters: {joints: [shoulder]}}\nhand: {ros__parameters: {joints: [f]}}",
        "launch/a.launch.py": """def generate_launch_description():
    path = get_package_share_directory("arm") + "/arm.urdf"
    Node(package="robot_state_publisher", parameters=[{"robot_description": open(path).read()}])
    for name in ("a", "hand"):
        ExecuteProcess(cmd=["ros2", "control", "load_controller", "--set-state", "active", name])
""",
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    verdict = try_robot(tmp_path / "arm.urdf", standing=1.0)
    assert verdict.controllers == ("a",)
    assert [(each.test, each.subject) for each in verdict.faults] == [("controller", "hand")]


@pytest.mark.parametrize(
    ("name", "moves"),
    [
        ("libown_gm_status.so", False),
        ("librotors_gazebo_own_wind.so", False),
        ("libown_gm_thing.so", True),
    ],
)
def test_an_unsupported_plugin_that_measures_a_joint_moves_nothing(tried, name, moves):
    plugin = (
        f'<gazebo><plugin name="x" filename="{name}"><jointName>flap_joint</jointName>'
        "<motorConstant>1</motorConstant></plugin></gazebo>"
    )
    assert tried(cart(0.1), FLAP.format(z=0.2), plugin).moves is not moves


def test_an_effort_is_tested_on_each_joint_alone(tmp_path, tried):
    """A cart on a rail carries a pole: an effort on both pushes the light cart backward.

    The cart of 0.05 kg bears the pole's reaction to its torque, F = τ m l / (I + m l²), beside
    the commanded force.
    """
    pole = ARM.format(kind="Effort").replace('<axis xyz="0 1 0"/>', '<axis xyz="0 1 0"/>', 1)
    rail = (
        '<link name="cart"><inertial><mass value="0.05"/>'
        '<inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        '<joint name="rail" type="prismatic"><parent link="base"/><child link="cart"/>'
        '<axis xyz="1 0 0"/><limit lower="-9" upper="9" effort="50" velocity="9"/></joint>'
    )
    trans = pole[pole.index("<transmission") : pole.index("<gazebo>")]
    both = pole.replace(
        '<joint name="shoulder" type="revolute"><parent link="base"/>',
        f'{rail}<joint name="shoulder" type="revolute"><parent link="cart"/>',
    ).replace(trans, trans + trans.replace('"t"', '"t2"').replace('"shoulder"', '"rail"'))
    path = tmp_path / "push.yaml"
    path.write_text(
        "push:\n  type: effort_controllers/JointGroupEffortController\n  joints: [rail, shoulder]\n"
    )
    verdict = tried(both, controllers=[path])
    assert [spin.joint for spin in verdict.spins] == ["rail", "shoulder"]
    assert all(spin.follows for spin in verdict.spins), verdict.spins
    assert verdict.good, verdict.faults


def test_gains_of_zero_are_why_a_joint_does_not_move(tmp_path, tried):
    path = tmp_path / "arm.yaml"
    path.write_text(PID.format(p=0.0).replace("d: 1.0", "i: 0.0, d: 0.0"))
    (fault,) = tried(ARM.format(kind="Effort"), controllers=[path]).faults
    assert (fault.test, fault.subject, fault.code) == (
        "reach",
        "shoulder",
        CONTROLLER_GAINS_MISSING,
    )
    assert fault.source == "file"
    assert fault.reason.origin.line == 3


def test_the_integral_of_ros_control_without_a_limit_corrects_no_error(tmp_path, tried):
    """See `test_a_velocity_error_that_follows_from_the_load_and_the_gain_is_none`."""
    path = tmp_path / "arm.yaml"
    path.write_text(PID.format(p=3.0).replace("d: 1.0", "i: 50.0, d: 1.0"))
    verdict = tried(ARM.format(kind="Effort"), controllers=[path])
    (reach,) = verdict.reaches
    assert abs(reach.error) == pytest.approx(0.98 * abs(math.sin(reach.reached)) / 3.0, rel=0.02)
    assert verdict.good, verdict.faults


BOAT = (
    '<link name="base">'
    '<inertial><mass value="20"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
    "</inertial>"
    '<collision><geometry><box size="1 0.4 0.05"/></geometry></collision></link>'
)
SCREW = (
    '<link name="{name}">'
    '<inertial><mass value="0.1"/><inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" '
    'ixz="0" iyz="0"/>'
    '</inertial></link><joint name="{name}_joint" type="continuous"><parent link="base"/>'
    '<child link="{name}"/><origin xyz="-0.5 {y} 0"/><axis xyz="1 0 0"/></joint>'
    '<gazebo><plugin name="gz::sim::systems::Thruster" filename="gz-sim-thruster-system">'
    "<joint_name>{joint}</joint_name><propeller_diameter>0.1</propeller_diameter>{more}</plugin>"
    "</gazebo>"
)


@pytest.mark.parametrize(
    "more",
    [
        "",
        "<use_angvel_cmd>true</use_angvel_cmd><thrust_coefficient>-0.1</thrust_coefficient>",
        "<topic>left</topic><max_thrust_cmd>2</max_thrust_cmd>",
    ],
)
def test_thrusters_push_a_boat_in_water(tried, more):
    port = SCREW.format(name="port", joint="port_joint", y=0.1, more=more)
    starboard = SCREW.format(name="starboard", joint="starboard_joint", y=-0.1, more="")
    found = tried(BOAT, port, starboard)
    assert found.good and found.moves
    assert found.stand.state == "floats"
    assert [spin.joint for spin in found.spins] == ["port_joint", "starboard_joint"]
    for spin in found.spins:
        assert spin.effort and spin.follows is (spin.measured * spin.commanded > 0)
    # The whole boat accelerates at 0.5 m/s² for 0.1 s, and the propeller as it turns the boat.
    assert found.spins[1].measured > 0.05


HULL = (
    '<link name="hull"><inertial><mass value="6"/>'
    '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>'
)
VALVE = (
    '<gazebo><plugin name="v" filename="gz-sim-spacecraft-thruster-model-system">'
    "<link_name>hull</link_name><actuator_number>2</actuator_number><max_thrust>3</max_thrust>"
    "<duty_cycle_frequency>10</duty_cycle_frequency><sub_topic>duty</sub_topic></plugin></gazebo>"
)


def test_a_spacecraft_is_tested_without_gravity(tried):
    verdict = tried(HULL, VALVE)
    assert verdict.good, verdict.faults
    assert verdict.stand.state == "floats"
    (spin,) = verdict.spins
    assert (spin.joint, spin.commanded) == ("hull", 3.0)
    assert spin.measured == pytest.approx(3.0 / 6 * 0.1, rel=0.1)


def test_a_valve_with_a_very_large_number_is_not_commanded(tried):
    verdict = tried(HULL, VALVE.replace(">2<", ">100000000<"))
    assert verdict.stand.state == "floats"
    assert not verdict.spins and not verdict.faults


def test_a_thruster_without_its_joint_is_a_fault_of_the_file(tried):
    found = tried(BOAT, SCREW.format(name="port", joint="no_joint", y=0.1, more=""))
    assert found.outcome == "file" and not found.moves
    assert [(fault.test, fault.subject) for fault in found.faults] == [
        ("plugin", "gz-sim-thruster-system")
    ]


LEGS = (
    '<link name="base"><inertial><origin xyz="0.12 0 0"/><mass value="2"/>'
    '<inertia ixx="0.02" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/>'
    '</inertial><collision><geometry><box size="0.3 0.2 0.1"/></geometry></collision></link>'
    '<link name="upper"><inertial><origin xyz="0 0 -0.2"/><mass value="0.5"/>'
    '<inertia ixx="0.01" iyy="0.01" izz="0.01" '
    'ixy="0" ixz="0" iyz="0"/></inertial><collision><origin xyz="0 0 -0.25"/>'
    '<geometry><box size="0.05 0.05 0.5"/></geometry></collision></link>'
    '<joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/>'
    '<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="50" velocity="2"/></joint>'
) + ARM[ARM.index("<transmission") :]


def test_the_joints_of_a_robot_that_lies_on_them_are_moved_above_the_ground(tmp_path, tried):
    """It stands on one leg, falls, and lies on it. Its controller is too weak to lift it."""
    path = tmp_path / "leg.yaml"
    path.write_text(PID.format(p=20.0))
    found = tried(LEGS.format(kind="Effort"), controllers=[path])
    assert found.stand.state in ("tips", "moves", "sinks")
    (reach,) = found.reaches
    assert reach.arrived and found.moves
    assert {fault.test for fault in found.faults} == {"stand"}


FOOT = (
    '<link name="foot">'
    '<inertial><mass value="0.1"/><inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" '
    'ixz="0" iyz="0"/>'
    '</inertial><collision><geometry><box size="0.02 0.02 0.02"/></geometry></collision></link>'
    '<joint name="shoulder" type="prismatic"><parent link="base"/><child link="foot"/>'
    '<origin xyz="0.1 0 {z}"/><axis xyz="0 0 -1"/>'
    '<limit lower="0" upper="0.2" effort="50" velocity="1"/></joint>'
    '<gazebo reference="foot"><mu1>0</mu1><mu2>0</mu2></gazebo>'
) + ARM[ARM.index("<transmission") :]


@pytest.mark.parametrize("z", [0.1, -0.06])
def test_a_joint_whose_link_the_ground_holds_is_moved_above_it(tmp_path, tried, z):
    """The foot of the second cart touches the ground, so it cannot be extended."""
    path = tmp_path / "foot.yaml"
    path.write_text(PID.format(p=300.0))
    found = tried(cart(0.1), FOOT.format(kind="Effort", z=z), controllers=[path])
    (reach,) = found.reaches
    assert reach.target == pytest.approx(0.02, abs=0.005)
    assert found.good and found.drives, found.faults


def test_topics_of_a_robot_that_is_tested_above_the_ground_are_its_own(tried):
    arm = (
        '<link name="arm">'
        '<inertial><mass value="0.1"/><inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" '
        'ixz="0" iyz="0"/>'
        '</inertial></link><joint name="elbow" type="continuous"><parent link="base"/>'
        '<child link="arm"/><axis xyz="0 0 1"/></joint><gazebo><plugin name="f" '
        'filename="gz-sim-apply-joint-force-system"><joint_name>elbow</joint_name></plugin></gazebo>'
    )
    found = tried(BOX.format(name="base", at="0.3 0 0", size="0.1 0.1 0.1"), arm)
    assert found.stand.state != "yes"
    assert [spin.topic for spin in found.spins] == ["/model/robot/joint/elbow/cmd_force"]


def test_an_arm_that_hangs_far_below_its_base_is_tested_above_the_ground(tmp_path, tried):
    """The ground would press its lowest part, 8 m below the base, upwards."""
    path = tmp_path / "arm.yaml"
    path.write_text(PID.format(p=500.0))
    ball = (
        '<link name="ball">'
        '<inertial><mass value="0.1"/><inertia ixx="1e-3" iyy="1e-3" izz="1e-3" ixy="0" '
        'ixz="0" iyz="0"/>'
        '</inertial><collision><geometry><sphere radius="0.1"/></geometry></collision></link>'
        '<joint name="rope" type="fixed"><parent link="base"/><child link="ball"/>'
        '<origin xyz="0 0 -8"/></joint>'
    )
    found = tried(ARM.format(kind="Effort"), ball, controllers=[path])
    assert found.good, found.faults
    pose = place(load_text(_text(ARM.format(kind="Effort"), ball), file="robot.urdf"))
    assert pose.z - 8.1 >= HIGH - 0.01


MOTOR = (
    '<gazebo><plugin name="m" filename="gz-sim-multicopter-motor-model-system"><jointName>{joint}'
    "</jointName><linkName>base</linkName><turningDirection>ccw</turningDirection>"
    "<timeConstantUp>{up}</timeConstantUp><actuator_number>0</actuator_number></plugin></gazebo>"
)


def test_a_motor_that_is_not_loaded_is_a_fault(tried):
    """The error is in the line of its tag, not in that of the plugin."""
    body = BOX.format(name="base", at="0 0 0", size="0.2 0.2 0.1")
    found = tried(body, "\n", MOTOR.format(joint="none", up="\nfast"))
    (fault,) = found.faults
    assert (fault.test, fault.source) == ("plugin", "file")
    assert not found.moves and found.outcome == "file"


def test_another_plugin_that_is_not_loaded_is_not_why_no_controller_starts(tried):
    lost = (
        '<gazebo><plugin name="truth" filename="libgazebo_ros_p3d.so"><bodyName>none</bodyName>'
        "<topicName>truth</topicName></plugin></gazebo>"
    )
    found = tried(ARM.format(kind="Effort"), lost, controllers=[])
    reasons = {fault.test: fault.code for fault in found.faults}
    assert reasons["controller"] is CONTROLLERS_NOT_FOUND


def _text(*parts):
    return f'<robot name="robot">{"".join(parts)}</robot>'


def test_a_base_whose_wheels_carry_little_is_given_time_to_accelerate(tried):
    """The wheels carry 5 % of 4 kg at 0.6 m behind the rest, so they slide until it turns."""
    heavy = BOX.format(name="base", at="0.57 0 0", size="0.3 0.15 0.06").replace("0.02", "0.2")
    wheels = WHEEL.format(name="left", y=0.1) + WHEEL.format(name="right", y=-0.1)
    caster = CASTER.format(x=0.6)
    verdict = tried(heavy + wheels + caster + DRIVE.format(diameter=0.1))
    (drive,) = verdict.drives
    assert abs(drive.error) < 0.05
    assert abs(drive.error_turn) < 0.05


def test_a_long_robot_may_settle_further_than_a_short_one():
    stood = Stand(fixed=False, simulated=2, wall=1, sunk=0.04, tilt=0.02, speed=0, turn=0, size=3.0)
    assert stood.state == "yes"
    assert replace(stood, size=0.5).state == "sinks"


def test_a_leg_whose_foot_does_not_slide_is_tested_above_the_ground(tmp_path, tried):
    """The friction on the foot, 20 N at 0.3 m, exceeds a gain of 5 N m/rad times 0.2 rad."""
    path = tmp_path / "soft.yaml"
    path.write_text(PID.format(p=5.0))
    leg = BOX.format(name="leg", at="0 0 0", size="0.05 0.05 0.6").replace(
        'mass value="2"', 'mass value="0.3"'
    )
    joint = (
        '<joint name="shoulder" type="revolute"><parent link="base"/><child link="leg"/>'
        '<axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="50" velocity="2"/></joint>'
        '<gazebo reference="leg"><mu1>9</mu1><mu2>9</mu2></gazebo>'
    )
    feet = BOX.format(name="base", at="0 0 -0.2", size="0.4 0.4 0.597")
    drive = ARM[ARM.index("<transmission") :].format(kind="Effort")
    verdict = tried(feet + leg + joint + drive, controllers=[path])
    (reach,) = verdict.reaches
    assert reach.arrived
    assert abs(reach.error) < 0.05


def test_wheels_that_point_to_one_side_explain_a_small_error_to_this_side():
    toed = WHEELS_TOED.diagnostic("point to the left", values={"joint": "j", "toe": 0.01})
    assert cause_of_drive([toed], 1.1, turning=True, arc=True) is toed
    assert cause_of_drive([toed], 0.9, turning=True, arc=True) is None
    assert cause_of_drive([toed], 1.1, turning=False) is None
    assert cause_of_drive([toed], 1.1, turning=True) is None


FLAP = (
    '<link name="flap"><inertial><origin xyz="0.1 0 0"/><mass value="1"/>'
    '<inertia ixx="0.002" iyy="0.002" izz="0.002" ixy="0" ixz="0" iyz="0"/></inertial><collision>'
    '<origin xyz="0.1 0 0"/><geometry><box size="0.2 0.1 0.02"/></geometry></collision></link>'
    '<joint name="flap_joint" type="revolute"><parent link="base"/><child link="flap"/>'
    '<origin xyz="0.15 0 {z}"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="9" '
    'velocity="9"/></joint>'
)


def test_a_part_that_hangs_down_to_the_ground_explains_why_a_base_is_slow(tried):
    """The wheels' friction is mu m g of their load, and they slide."""
    slippery = "".join(
        f'<gazebo reference="{name}"><mu1>0.05</mu1><mu2>0.05</mu2></gazebo>'
        for name in ("left", "right")
    )
    verdict = tried(cart(0.1), FLAP.format(z=0.0), slippery)
    (drive, *_) = verdict.faults
    assert (drive.test, drive.code) == ("drive", BODY_ON_GROUND)


def test_an_upright_arm_that_falls_only_when_the_base_drives_explains_why_it_is_slow(tried):
    """The friction of its joint, 0.02 N m, holds the mast while it stands."""
    slippery = "".join(
        f'<gazebo reference="{name}"><mu1>0.05</mu1><mu2>0.05</mu2></gazebo>'
        for name in ("left", "right")
    )
    mast = FLAP.format(z=0.0).replace("0.1 0 0", "0 0 0.15").replace("0.2 0.1 0.02", "0.02 0.1 0.3")
    mast = mast.replace('lower="-1" upper="1"', 'lower="-3" upper="3"')
    mast = mast.replace("</joint>", '<dynamics friction="0.02"/></joint>')
    verdict = tried(cart(0.1), mast, slippery)
    assert verdict.stand.state == "yes"
    (drive, *_) = verdict.faults
    assert (drive.test, drive.code) == ("drive", BODY_ON_GROUND)
    assert drive.reason.values["link"] == "flap"
    assert drive.reason.values["joint"] == "flap_joint"


def test_the_wheels_of_a_train_explain_how_it_drives_and_turns(tmp_path):
    """SDF's wheels have revolute joints. The rear ones roll freely, so they do not hang down."""
    ball = "<inertia><ixx>{i}</ixx><iyy>{i}</iyy><izz>{i}</izz></inertia>"
    light = ball.format(i=0.005)
    wheels = "".join(
        f"""<link name="{name}"><pose>{x} {y} 0.1 0 1.5707963 0</pose><inertial><mass>1</mass>
        {light}</inertial><collision name="c"><geometry><cylinder><radius>0.1</radius>
        <length>0.04</length></cylinder></geometry></collision></link><joint name="{name}_joint"
        type="revolute"><parent>base</parent><child>{name}</child><axis>
        <xyz expressed_in="base">-1 0 0</xyz></axis></joint>"""
        for name, x, y in (("a", -0.2, 0.3), ("b", 0.2, 0.3), ("c", -0.2, -0.3), ("d", 0.2, -0.3))
    )
    path = tmp_path / "train.sdf"
    path.write_text(
        f"""<sdf version="1.8"><model name="train"><link name="base"><pose>0 0 0.2 0 0 0</pose>
        <inertial><mass>8</mass>{ball.format(i=0.2)}</inertial></link>{wheels}
        <plugin name="d" filename="libgazebo_ros_diff_drive.so"><left_joint>a_joint</left_joint>
        <right_joint>b_joint</right_joint><wheel_separation>0.4</wheel_separation>
        <wheel_diameter>0.1</wheel_diameter></plugin></model></sdf>"""
    )
    verdict = try_robot(path)
    (drive,) = verdict.drives
    assert abs(drive.measured / drive.commanded) == pytest.approx(2.0, rel=0.03)
    assert {fault.test: fault.code for fault in verdict.faults} == {
        "drive": WHEEL_DIAMETER_MISMATCH,
        "turn": SKID_STEERING,
    }


@pytest.mark.parametrize("same", [False, True])
def test_a_drive_without_a_command_explains_why_another_one_is_slow(tried, same):
    """Two pairs of equal wheels, of which one stands still, slide at half the speed."""
    parts = [BOX.format(name="base", at="0 0 0", size="0.3 0.1 0.04")]
    for name, x in (("front", 0.1), ("rear", -0.1)):
        for side, y in (("left", 0.1), ("right", -0.1)):
            wheel = WHEEL.format(name=f"{name}_{side}", y=y)
            parts.append(wheel.replace('xyz="0 ', f'xyz="{x} '))
        topic = "cmd_vel" if same else f"{name}/cmd_vel"
        plugin = DRIVE.format(diameter=0.1).replace("left_joint", f"{name}_left_joint")
        plugin = plugin.replace("right_joint", f"{name}_right_joint").replace(
            '"drive"', f'"{name}"'
        )
        command = f"<commandTopic>{topic}</commandTopic></plugin>"
        parts.append(plugin.replace("</plugin>", command))
    verdict = tried(*parts)
    found = [each for each in verdict.observed if each.code is DRIVES_APART]
    if same:
        assert verdict.drives[0].follows
        assert not found
        return
    assert [each.values["topics"] for each in found] == [("/front/cmd_vel", "/rear/cmd_vel")]
    assert [drive.follows for drive in verdict.drives] == [False, False]
    assert {fault.code for fault in verdict.faults if fault.test == "drive"} == {DRIVES_APART}


@pytest.mark.parametrize("moving", [True, False])
def test_wheels_without_motors_explain_why_a_robot_rolls(moving):
    parts = [BOX.format(name="base", at="0 0 0", size="0.2 0.1 0.04"), CASTER.format(x=0.1)]
    parts += [WHEEL.format(name=name, y=y) for name, y in (("left", 0.1), ("right", -0.1))]
    robot = load_text(f'<robot name="robot">{"".join(parts)}</robot>', file="r.urdf")
    with World() as one:
        model = one.spawn(robot, z=0.07)
        before = positions(one, model)
        model.velocity = Twist(linear=(0.2, 0.0, 0.0))
        one.run(2.0)
        found = [*gave_way(one, model, Robot(robot, None), before, (), moving=moving)]
    rolling = [("left_joint", "right_joint")] if moving else []
    assert [each.values["joints"] for each in found] == rolling
    assert {each.code for each in found} <= {JOINTS_UNDRIVEN}


def test_a_joint_that_gives_way_explains_why_a_robot_falls(tmp_path, tried):
    """A body turns on a leg that nothing drives; it would stand if the knee were held."""
    leg = BOX.format(name="leg", at="0 0 -0.15", size="0.2 0.3 0.02").replace(
        "<collision>", '<collision><origin xyz="0 0 -0.3"/>'
    )
    knee = (
        '<joint name="knee" type="revolute"><parent link="base"/><child link="leg"/>'
        '<axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="9" velocity="9"/></joint>'
    )
    verdict = tried(BOX.format(name="base", at="0.04 0 0.05", size="0.1 0.1 0.1"), leg, knee)
    (fault, *_) = verdict.faults
    assert (fault.test, fault.code) == ("stand", JOINTS_UNDRIVEN)
    assert fault.reason.values["joints"] == ("knee",)


STAND = """<robot name="camera" xmlns:xacro="http://www.ros.org/wiki/xacro">
<xacro:arg name="plug" default="false"/>
{box}
<xacro:if value="$(arg plug)">
  {plug}
  <joint name="side" type="fixed"><parent link="base"/><child link="plug"/></joint>
</xacro:if>{more}</robot>"""


@pytest.mark.parametrize("simulated", [True, False])
@pytest.mark.parametrize("device", [True, False])
def test_arguments_for_rviz_are_not_used_for_a_robot_without_plugins(tmp_path, simulated, device):
    """With its heavy plug, the camera tips over."""
    box, plug = (
        BOX.format(name=name, at=at, size="0.02 0.02 0.02")
        for name, at in (("base", "0 0 0"), ("plug", "0.05 0 0.01"))
    )
    heavy = plug.replace('mass value="2"', 'mass value="9"')
    more = "<gazebo><plugin name='p' filename='libgazebo_ros_p3d.so'/></gazebo>" * device
    spawner = '<node name="s" pkg="gazebo_ros" type="spawn_model" args="-urdf -model c"/>'
    files = {
        "package.xml": "<package><name>camera</name></package>",
        "camera.xacro": STAND.format(box=box, plug=heavy, more=more),
        "a.launch": '<launch><param name="robot_description" command="xacro '
        f'$(find camera)/camera.xacro plug:=true"/>{spawner * simulated}</launch>',
    }
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    path = tmp_path / "camera.xacro"
    verdict = try_robot(path, standing=1.0, launches=launches_near(tmp_path))
    used = simulated or device
    assert verdict.stands is not used
    assert [fault.test for fault in verdict.faults] == ["stand"] * used


def test_a_description_for_rviz_that_needs_its_arguments_need_not_stand(tmp_path):
    """Nothing in it is for Gazebo, and its launch file starts no Gazebo."""
    tall = BOX.format(name="base", at="0.2 0 0.5", size="0.02 0.02 0.02").replace(
        "<collision>", '<collision><origin xyz="$(arg x) 0 0"/>', 1
    )
    files = {
        "package.xml": "<package><name>camera</name></package>",
        "camera.xacro": '<robot name="camera" xmlns:xacro="http://www.ros.org/wiki/xacro">'
        f"{tall}</robot>",
        "a.launch": '<launch><param name="robot_description" command="xacro '
        '$(find camera)/camera.xacro x:=0.0"/></launch>',
    }
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    path = tmp_path / "camera.xacro"
    verdict = try_robot(path, standing=1.0, launches=launches_near(tmp_path))
    assert verdict.loaded and not verdict.stands
    assert verdict.good, verdict.faults


RVIZ = '<node name="rviz" pkg="rviz" type="rviz"/>'
SPAWNER = '<node name="s" pkg="gazebo_ros" type="spawn_model" args="-urdf -model arm"/>'


@pytest.mark.parametrize("node", ["", RVIZ, SPAWNER])
@pytest.mark.parametrize(
    ("more", "for_gazebo"),
    [
        ("", False),
        ("<mujoco><compiler/></mujoco>", False),
        # Perhaps colours.
        ('<gazebo reference="base"><mu1>1</mu1></gazebo>', False),
        (FOR_GAZEBO, True),
        # Also those of the real robot.
        (transmission("shoulder", "Effort"), False),
    ],
)
def test_whether_a_launch_file_shows_a_robot_in_rviz_does_not_decide_whether_it_must_stand(
    tmp_path, node, more, for_gazebo
):
    """It must if it has a plugin, or if a launch file starts it in Gazebo."""
    body = BOX.format(name="base", at="0.2 0 0", size="0.1 0.1 0.1")
    arm = ARM[ARM.index('<link name="upper">') : ARM.index('<joint name="stand"')]
    arm += ARM[ARM.index('<joint name="shoulder"') : ARM.index("<transmission")]
    (tmp_path / "package.xml").write_text("<package><name>arm</name></package>")
    (tmp_path / "arm.urdf").write_text(f'<robot name="arm">{body}{arm}{more}</robot>')
    if node:
        (tmp_path / "arm.launch").write_text(
            '<launch><param name="robot_description" textfile="$(find arm)/arm.urdf"/>'
            f"{node}</launch>"
        )
    launches = launches_near(tmp_path)
    verdict = try_robot(tmp_path / "arm.urdf", standing=2.0, launches=launches)
    assert not verdict.stands
    started = node == SPAWNER
    assert verdict.good is (not for_gazebo and not started), verdict.faults


@pytest.mark.parametrize("end", ["", "<!DOCTYPE robot>", "<!DOCTYPE robot [<!ELEMENT robot ANY>]>"])
def test_comments_before_a_robot_do_not_decide_whether_it_must_stand(tmp_path, end):
    """Trying all ways to separate so many comments would not end."""
    head = '<?xml version="1.0"?>' + "<!-- a --><!-- b -->\n" * 100 + end
    (tmp_path / "arm.urdf").write_text(
        f'{head}<robot name="arm">{BOX.format(name="base", at="0 0 0", size="0.1 0.1 0.1")}'
        f"{BOX.format(name='upper', at='1 0 0', size='0.1 0.1 0.1')}"
        '<joint name="shoulder" type="fixed"><parent link="base"/><child link="upper"/>'
        '<origin xyz="0 0 0.2"/></joint></robot>'
    )
    verdict = try_robot(tmp_path / "arm.urdf", standing=1.0)
    assert not verdict.stands
    assert verdict.good, verdict.faults


@pytest.mark.parametrize("simulated", [True, False])
def test_a_description_of_visuals_for_rviz_needs_no_mass(tmp_path, simulated):
    spawner = '<node name="s" pkg="gazebo_ros" type="spawn_model" args="-urdf -model c"/>'
    viewer = '<node name="rviz" pkg="rviz" type="rviz"/>'
    files = {
        "package.xml": "<package><name>camera</name></package>",
        "camera.urdf": '<robot name="camera"><link name="base"><visual><geometry>'
        '<box size="0.1 0.1 0.1"/></geometry></visual></link></robot>',
        "a.launch": '<launch><param name="robot_description" textfile="$(find camera)/camera.urdf"'
        f"/>{spawner if simulated else viewer}</launch>",
    }
    for name, text in files.items():
        (tmp_path / name).write_text(text)
    path = tmp_path / "camera.urdf"
    verdict = try_robot(path, standing=1.0, launches=launches_near(tmp_path))
    expected = [("load", INERTIA_MISSING), ("stand", BASE_WITHOUT_COLLISION)] * simulated
    assert [(each.test, each.code) for each in verdict.faults] == expected


def test_a_long_robot_that_tilts_a_little_until_it_rests_on_another_part_does_not_rise(tried):
    """A beam of 4 m, whose middle is 0.1 m too low: 0.05 rad lift its root at one end."""
    base = BOX.format(name="base", at="1 0 0", size="0.2 0.4 0.3")
    beam = "".join(
        f"{BOX.format(name=name, at='0 0 0', size='0.2 0.4 0.1')}"
        f'<joint name="{name}_joint" type="fixed"><parent link="base"/><child link="{name}"/>'
        f'<origin xyz="{x} 0 {z}"/></joint>'
        for name, x, z in (("middle", 2, -0.1), ("end", 4, 0))
    )
    verdict = tried(base, beam)
    assert verdict.stand.sunk < -0.02 * verdict.stand.size
    assert verdict.stand.tilt > 0.01
    assert abs(verdict.stand.settled) < 0.005
    assert verdict.stand.state == "yes"


def test_a_joint_that_carries_nothing_is_not_why_a_robot_sinks():
    """Two rockers give way below the body, and a loose antenna swings above it further."""
    legs = [
        BOX.format(name=f"foot{y}", at="0 0 0", size="0.3 0.1 0.02")
        + f'<joint name="rocker{y}" type="prismatic"><parent link="base"/><child link="foot{y}"/>'
        f'<origin xyz="0 {y} -0.15"/><axis xyz="0 0 1"/>'
        '<limit lower="-0.02" upper="0.12" effort="9" velocity="9"/></joint>'
        for y in (0.2, -0.2)
    ]
    antenna = BOX.format(name="dish", at="0.05 0 0.05", size="0.02 0.02 0.02") + (
        '<joint name="antenna" type="revolute"><parent link="base"/><child link="dish"/>'
        '<origin xyz="0 0 0.1"/><axis xyz="0 1 0"/>'
        '<limit lower="-3" upper="3" effort="9" velocity="9"/></joint>'
    )
    text = BOX.format(name="base", at="0 0 0", size="0.3 0.3 0.02") + antenna + "".join(legs)
    robot = load_text(f'<robot name="robot">{text}</robot>', file="r.urdf")
    with World() as one:
        model = one.spawn(robot, z=0.17)
        before = positions(one, model)
        one.run(3.0)
        (found,) = gave_way(one, model, Robot(robot, None), before, ())
    assert found.values["joints"] == ("rocker0.2", "rocker-0.2", "antenna")
    assert found.values["moved"] == pytest.approx(0.12, abs=0.01)


@pytest.mark.parametrize(
    ("factor", "ratio", "accounts"),
    [(2.0, 1.5, True), (2.0, 0.001, False), (0.5, 0.5, True), (0.5, 0.07, False), (2.0, -1, False)],
)
def test_a_size_explains_a_turn_rate_that_errs_no_more_than_the_speed(factor, ratio, accounts):
    size = WHEEL_DIAMETER_MISMATCH.diagnostic("wrong size")
    assert explains_turn(size, factor, ratio) == accounts
    assert not explains_turn(None, factor, ratio)
    assert not explains_turn(SKID_STEERING.diagnostic("slides"), factor, ratio)
