"""``SteerBotHardwareGazebo``: one wheel and one steering joint command those of four wheels."""

import math

import pytest
import yaml
from tests.coded import coded
from tests.dialects.ros_control.arms import ROS1
from tests.dialects.ros_control.cars import BASE, RADIUS, TRACK, Driven, car, four_wheels

from cartwheel.codes import devices, robot, running
from cartwheel.description import load
from cartwheel.dialects.ros_control.suggestion import suggested
from cartwheel.errors import CartwheelError

PLUGIN = ROS1.replace(
    "</plugin>",
    "<robotSimType>steer_bot_hardware_gazebo/SteerBotHardwareGazebo</robotSimType></plugin>",
)
HARDWARE = {
    "rear_wheel": "rear_wheel_joint",
    "front_steer": "front_steer_joint",
    "virtual_rear_wheels": ["rear_right_joint", "rear_left_joint"],
    "virtual_front_wheels": ["front_right_joint", "front_left_joint"],
    "virtual_front_steers": ["front_right_steer", "front_left_steer"],
    "enable_ackermann_link": True,
    "wheel_separation_w": TRACK,
    "wheel_separation_h": BASE,
}
DRIVE = {
    "type": "ackermann_steering_controller/AckermannSteeringController",
    "rear_wheel": "rear_wheel_joint",
    "front_steer": "front_steer_joint",
}
STATES = {"type": "joint_state_controller/JointStateController", "publish_rate": 50}
SPEED, ANGLE = 0.3, 0.2


class SteerBot(Driven):
    """A car without transmissions: the names of its joints are only in the parameters."""

    def __init__(self, make, folder, hardware, **drive):
        robot, file = folder / "car.urdf", folder / "drive.yaml"
        robot.write_text(car(four_wheels(steered=True), PLUGIN, ()))
        content = {"base": {**DRIVE, **drive}, "states": STATES}
        if hardware is not None:
            content["steer_bot_hardware_gazebo"] = hardware
        file.write_text(yaml.safe_dump(content))
        self.world = make.world()
        self.model = self.world.spawn(robot, z=RADIUS, controllers=[file])
        self.world.run(0.2)

    def positions(self, *joints):
        simulation = self.world.session.simulation
        return [simulation.joint_position("car", joint) for joint in joints]


def test_the_shared_wheel_drives_all_wheels(make, tmp_path):
    bot = SteerBot(make, tmp_path, HARDWARE)
    assert not coded(bot.world, devices.HARDWARE_NOT_SIMULATED)
    bot.drive(0.5, SPEED, 0.0)
    wheels = [*HARDWARE["virtual_rear_wheels"], *HARDWARE["virtual_front_wheels"]]
    before, place = bot.positions(*wheels), bot.model.pose.x
    twist = bot.drive(1.0, SPEED, 0.0)
    rolled = [b - a for a, b in zip(before, bot.positions(*wheels), strict=True)]
    assert rolled == pytest.approx([SPEED / RADIUS] * 4, rel=0.01)
    assert bot.model.pose.x - place == pytest.approx(SPEED, rel=0.01)
    # The wheel's radius is that of the real wheel: no link has the shared wheel.
    assert twist.linear.x == pytest.approx(SPEED, rel=0.01)


def test_both_joints_steer_by_the_formula_of_the_original(make, tmp_path):
    bot = SteerBot(make, tmp_path, HARDWARE)
    twist = bot.drive(1.0, SPEED, ANGLE)
    right, left = bot.positions(*HARDWARE["virtual_front_steers"])
    tangent = math.tan(ANGLE)
    for angle, side in ((right, 1), (left, -1)):
        # cot = (2 h + side w / 2 tan) / (2 h tan)
        across = side * TRACK / 2 * tangent
        expected = math.atan(2 * BASE * tangent / (2 * BASE + across))
        assert angle == pytest.approx(expected, abs=2e-3)
    assert left > ANGLE > right
    mean = math.tan((left + right) / 2)
    assert twist.angular.z == pytest.approx(SPEED * mean / BASE, rel=0.01)


def test_without_the_linkage_the_second_joint_turns_twice_as_far(make, tmp_path):
    bot = SteerBot(make, tmp_path, {**HARDWARE, "enable_ackermann_link": False})
    bot.drive(1.0, SPEED, -ANGLE)
    assert bot.positions(*HARDWARE["virtual_front_steers"]) == pytest.approx(
        [-ANGLE, -2 * ANGLE], abs=2e-3
    )


def test_the_robot_turns_about_as_slowly_as_is_reported(make, tmp_path):
    bot = SteerBot(make, tmp_path, HARDWARE)
    (reported,) = coded(bot.world, robot.SKID_STEERING)
    bot.drive(1.0, 1.0, ANGLE)
    before = bot.model.pose.yaw
    bot.drive(1.0, 1.0, ANGLE)
    turned = (bot.model.pose.yaw - before) / (math.tan(ANGLE) / BASE)
    estimate = BASE**2 / (BASE**2 + TRACK**2)
    assert reported.values["estimate"] == pytest.approx(estimate)
    # Coulomb's friction is not proportional to the slip.
    assert turned == pytest.approx(estimate, rel=0.15)


def test_joint_states_contain_the_shared_joints(make, tmp_path):
    bot = SteerBot(make, tmp_path, HARDWARE)
    box = bot.world.mailbox("/joint_states", size=1000)
    bot.drive(1.0, SPEED, ANGLE)
    message = box.drain()[-1]
    states = dict(zip(message.name, message.position, strict=True))
    assert set(states) == {
        each
        for names in HARDWARE.values()
        if isinstance(names, list | str)
        for each in ([names] if isinstance(names, str) else names)
    }
    for shared, listed in (
        ("rear_wheel", "virtual_rear_wheels"),
        ("front_steer", "virtual_front_steers"),
    ):
        own = [states[name] for name in HARDWARE[listed]]
        assert states[HARDWARE[shared]] == pytest.approx(sum(own) / 2)


def test_effort_limits_in_the_description_do_not_apply(make, tmp_path):
    """The steering joints' limit of 50 N m is reduced to one that friction exceeds."""
    weak = car(four_wheels(steered=True), PLUGIN, ()).replace('effort="50"', 'effort="1e-6"')
    robot, file = tmp_path / "car.urdf", tmp_path / "drive.yaml"
    robot.write_text(weak)
    file.write_text(yaml.safe_dump({"base": DRIVE, "steer_bot_hardware_gazebo": HARDWARE}))
    world = make.world()
    world.spawn(robot, z=RADIUS, controllers=[file])
    for _ in range(10):
        world.publish("/base/cmd_vel", linear_x=0.0, angular_z=ANGLE)
        world.run(0.1)
    angle = world.session.simulation.joint_position("car", "front_left_steer")
    assert angle == pytest.approx(ANGLE, rel=0.05)


def test_a_joint_may_be_listed_twice(make, tmp_path):
    twice = ["front_right_steer", "front_right_steer"]
    bot = SteerBot(make, tmp_path, {**HARDWARE, "virtual_front_steers": twice})
    bot.drive(1.0, SPEED, ANGLE)
    (right,) = bot.positions("front_right_steer")
    assert 0.9 * ANGLE < right < ANGLE


def test_without_parameters_the_default_hardware_is_used(make, tmp_path):
    bot = SteerBot(make, tmp_path, None)
    (warning,) = coded(bot.world, devices.HARDWARE_NOT_SIMULATED)
    assert warning.values["parameters"] == "steer_bot_hardware_gazebo"
    assert coded(bot.world, running.CONTROLLER_NOT_STARTED, controller="base")


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("virtual_rear_wheels", ["rear_right_joint"]),
        ("virtual_front_steers", []),
        ("wheel_separation_h", 0.0),
        ("wheel_separation_w", -1.0),
    ],
)
def test_invalid_parameters_are_named(make, tmp_path, name, value):
    with pytest.raises(CartwheelError) as caught:
        SteerBot(make, tmp_path, {**HARDWARE, name: value})
    assert caught.value.values["parameter"] == name


def test_unknown_joints_are_named(make, tmp_path):
    hardware = {**HARDWARE, "virtual_rear_wheels": ["rear_right_joint", "rear_wrong_joint"]}
    with pytest.raises(CartwheelError) as caught:
        SteerBot(make, tmp_path, hardware)
    assert caught.value.values["name"] == "rear_wrong_joint"


def test_a_reset_straightens_the_wheels(make, tmp_path):
    bot = SteerBot(make, tmp_path, HARDWARE)
    bot.drive(1.0, SPEED, ANGLE)
    bot.world.reset()
    bot.world.run(0.5)
    assert bot.positions(*HARDWARE["virtual_front_steers"]) == pytest.approx([0, 0], abs=1e-3)
    assert bot.model.pose.x == pytest.approx(0.0, abs=5e-3)
    assert bot.drive(0.5, SPEED, 0.0).linear.x == pytest.approx(SPEED, rel=0.01)


def test_the_file_with_the_parameters_is_suggested(make, tmp_path):
    package = tmp_path / "bot"
    (package / "config").mkdir(parents=True)
    (package / "package.xml").write_text("<package/>")
    robot, file = package / "car.urdf", package / "config" / "hardware.yaml"
    robot.write_text(car(four_wheels(steered=True), PLUGIN, ()))
    file.write_text(yaml.safe_dump({"steer_bot_hardware_gazebo": HARDWARE}))
    world = make.world()
    world.spawn(robot, z=RADIUS, controllers=[file])
    assert not coded(world, devices.CONTROLLERS_FILE_WITHOUT_CONTROLLERS)
    assert suggested(load(robot)) == [file]
