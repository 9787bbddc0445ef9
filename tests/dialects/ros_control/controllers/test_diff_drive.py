"""Drives by controllers: where they go, how fast, and what their odometry says."""

import itertools
import math

import pytest
import yaml
from tests.coded import coded

from cartwheel.codes import robot, running
from cartwheel.messages import from_dict

RADIUS, TRACK = 0.1, 0.4

WHEEL = """<link name="{name}"><inertial><mass value="0.5"/><inertia ixx="0.00125" iyy="0.0025"
  izz="0.00125" ixy="0" ixz="0" iyz="0"/></inertial><collision><origin rpy="1.5707963 0 0"/>
  <geometry><cylinder radius="0.1" length="0.04"/></geometry></collision></link>
  <joint name="{name}_joint" type="continuous"><parent link="base_link"/><child link="{name}"/>
  <origin xyz="0 {y} 0"/><axis xyz="0 1 0"/></joint>"""
BASE = """<link name="base_link"><inertial><origin xyz="0 0 -0.03"/><mass value="8"/>
  <inertia ixx="0.06" iyy="0.06" izz="0.12" ixy="0" ixz="0" iyz="0"/></inertial>
  {gliders}</link>"""
GLIDER = """<collision><origin xyz="{x} 0 -0.06"/><geometry><sphere radius="0.04"/></geometry>
  </collision>"""
SLIPPERY = """<gazebo reference="base_link"><mu1>0</mu1><mu2>0</mu2></gazebo>"""


def cart(control):
    parts = BASE.format(gliders=GLIDER.format(x=0.15) + GLIDER.format(x=-0.15)) + SLIPPERY
    parts += WHEEL.format(name="left", y=TRACK / 2) + WHEEL.format(name="right", y=-TRACK / 2)
    return f'<robot name="cart">{parts}{control}</robot>'


ROS1 = """<transmission name="l"><type>transmission_interface/SimpleTransmission</type>
  <joint name="left_joint"><hardwareInterface>VelocityJointInterface</hardwareInterface></joint>
  </transmission><transmission name="r"><type>transmission_interface/SimpleTransmission</type>
  <joint name="right_joint"><hardwareInterface>VelocityJointInterface</hardwareInterface></joint>
  </transmission><gazebo><plugin name="c" filename="libgazebo_ros_control.so">
  <robotNamespace>/</robotNamespace></plugin></gazebo>"""


class Drive:
    def __init__(self, make, tmp_path, urdf, content):
        file = tmp_path / "c.yaml"
        file.write_text(yaml.safe_dump(content))
        robot = tmp_path / "cart.urdf"
        robot.write_text(urdf)
        self.world = make.world()
        self.model = self.world.spawn(robot, z=RADIUS, controllers=[file])

    def go(self, seconds, linear=0.0, angular=0.0):
        """Sends a command ten times a second."""
        for _ in range(round(seconds * 10)):
            self.world.publish("/base/cmd_vel", linear_x=linear, angular_z=angular)
            self.world.run(0.1)

    def odometry(self, topic="/base/odom"):
        box = self.world.mailbox(topic, size=10)
        self.world.run(0.05)
        return box.drain()[-1]


@pytest.fixture
def drive(make, tmp_path):
    def made(**more):
        base = {
            "type": "diff_drive_controller/DiffDriveController",
            "left_wheel": "left_joint",
            "right_wheel": "right_joint",
            "pose_covariance_diagonal": [1, 2, 3, 4, 5, 6],
            **more,
        }
        return Drive(make, tmp_path, cart(ROS1), {"base": base})

    return made


def test_it_drives_at_the_speed_that_it_is_commanded(drive):
    made = drive()
    made.world.run(0.5)
    start = made.model.pose.x
    made.go(4.0, linear=0.5)
    assert made.model.pose.x - start == pytest.approx(2.0, rel=0.02)
    reported = made.odometry()
    assert reported.twist.twist.linear.x == pytest.approx(0.5, rel=0.02)
    assert reported.pose.covariance.reshape(6, 6).diagonal().tolist() == [1, 2, 3, 4, 5, 6]
    assert (reported.header.frame_id, reported.child_frame_id) == ("odom", "base_link")


def test_swapped_wheels_are_reported(drive):
    assert not coded(drive().world, robot.WHEELS_SWAPPED)
    made = drive(left_wheel="right_joint", right_wheel="left_joint")
    assert coded(made.world, robot.WHEELS_SWAPPED, controller="base", left="right_joint")
    made.go(2.0, angular=0.5)
    assert made.model.pose.rpy[2] < -0.5


@pytest.mark.parametrize("wrong", ["", "left", "right"])
def test_wheels_of_a_robot_that_faces_y_turn_about_x(make, tmp_path, wrong):
    """Its left is toward -x, so both axes point there."""
    urdf = cart(ROS1).replace('rpy="1.5707963 0 0"', 'rpy="0 1.5707963 0"')
    for side, y in (("left", TRACK / 2), ("right", -TRACK / 2)):
        axis = "1 0 0" if side == wrong else "-1 0 0"
        urdf = urdf.replace(
            f'<origin xyz="0 {y} 0"/><axis xyz="0 1 0"/>',
            f'<origin xyz="{-y} 0 0"/><axis xyz="{axis}"/>',
        )
    urdf = urdf.replace('xyz="0.15 0 -0.06"', 'xyz="0 0.15 -0.06"')
    urdf = urdf.replace('xyz="-0.15 0 -0.06"', 'xyz="0 -0.15 -0.06"')
    base = {
        "type": "diff_drive_controller/DiffDriveController",
        "left_wheel": "left_joint",
        "right_wheel": "right_joint",
    }
    made = Drive(make, tmp_path, urdf, {"base": base | {"wheel_separation": TRACK}})
    found = [each for each in made.world.diagnostics if each.code is robot.WHEEL_AXIS_MISALIGNED]
    assert [each.values["joint"] for each in found] == ([f"{wrong}_joint"] if wrong else [])
    if not wrong:
        made.go(2.0, linear=0.5)
        assert made.model.pose.y == pytest.approx(1.0, rel=0.05)


@pytest.mark.parametrize("faces", ["backward", "forward", "mixed"])
def test_a_robot_that_faces_backward_consistently_has_no_reversed_axes(make, tmp_path, faces):
    """Its left wheel is on the other side as well, so it turns as commanded."""
    urdf = cart(ROS1).replace('<axis xyz="0 1 0"/>', '<axis xyz="0 -1 0"/>')
    if faces == "mixed":
        urdf = urdf.replace('<axis xyz="0 -1 0"/>', '<axis xyz="0 1 0"/>', 1)
    left, right = ("left", "right") if faces == "forward" else ("right", "left")
    base = {
        "type": "diff_drive_controller/DiffDriveController",
        "left_wheel": f"{left}_joint",
        "right_wheel": f"{right}_joint",
    }
    made = Drive(make, tmp_path, urdf, {"base": base})
    found = [each for each in made.world.diagnostics if each.code is robot.WHEEL_AXIS_MISALIGNED]
    # Whether all axes are reversed decides whether it drives backward, or not at all.
    every = {"backward": [], "forward": [True, True], "mixed": [False]}
    assert [each.values["all"] for each in found] == every[faces]
    if faces == "backward":
        made.go(2.0, linear=0.5)
        assert made.model.pose.x == pytest.approx(-1.0, rel=0.05)
        made.go(2.0, angular=0.5)
        assert made.model.pose.rpy[2] == pytest.approx(1.0, rel=0.05)


@pytest.mark.parametrize("side", ["left", "right"])
def test_a_negative_multiplier_belongs_to_a_reversed_wheel(make, tmp_path, side):
    urdf = cart(ROS1)
    first, rest = urdf.split(f'<joint name="{side}_joint"', 1)
    reversed_ = f'{first}<joint name="{side}_joint"' + rest.replace("0 1 0", "0 -1 0", 1)
    base = {
        "type": "diff_drive_controller/DiffDriveController",
        "left_wheel": "left_joint",
        "right_wheel": "right_joint",
    }
    factor = {f"{side}_wheel_radius_multiplier": -1.0}
    wrong = Drive(make, tmp_path, reversed_, {"base": base})
    assert coded(wrong.world, robot.WHEEL_AXIS_MISALIGNED, joint=f"{side}_joint", axis="-y")
    wrong = Drive(make, tmp_path, urdf, {"base": base | factor})
    assert coded(wrong.world, robot.WHEEL_AXIS_MISALIGNED, joint=f"{side}_joint", axis="y")
    made = Drive(make, tmp_path, reversed_, {"base": base | factor})
    assert not coded(made.world, robot.WHEEL_AXIS_MISALIGNED)
    made.go(2.0, linear=0.5)
    assert made.model.pose.x == pytest.approx(1.0, rel=0.05)
    assert made.model.pose.rpy[2] == pytest.approx(0.0, abs=0.02)


def test_a_circle_closes(drive):
    """v / w is its radius; after 2 pi / w it is where it began, by odometry and in truth."""
    made = drive()
    made.world.run(0.5)
    start = made.model.pose
    speed, turn = 0.3, 0.6
    far = 0.0
    steps = round(2 * math.pi / turn * 10)
    for _ in range(steps):
        made.go(0.1, linear=speed, angular=turn)
        place = made.model.pose
        far = max(far, math.hypot(place.x - start.x, place.y - start.y))
    assert far == pytest.approx(2 * speed / turn, rel=0.03)
    reported = made.odometry().pose.pose.position
    place = made.model.pose
    assert math.hypot(place.x - start.x, place.y - start.y) < 0.08
    assert math.hypot(reported.x, reported.y) < 0.08
    assert (reported.x, reported.y) == pytest.approx(
        (place.x - start.x, place.y - start.y), abs=0.03
    )


def test_a_command_counts_for_half_a_second(drive):
    made = drive()
    made.go(1.0, linear=0.5)
    made.world.run(0.6)
    assert made.odometry().twist.twist.linear.x == pytest.approx(0.0, abs=0.02)


def test_limits_of_velocity_and_acceleration(drive):
    """0.2 m/s² up to 0.3 m/s: after 1 s 0.2 m/s, after 3 s 0.3 m/s."""
    limits = {
        "has_velocity_limits": True,
        "max_velocity": 0.3,
        "has_acceleration_limits": True,
        "max_acceleration": 0.2,
    }
    made = drive(linear={"x": limits}, publish_cmd=True)
    made.world.run(0.5)
    box = made.world.mailbox("/base/cmd_vel_out", size=10_000)
    made.go(1.0, linear=5.0)
    assert made.odometry().twist.twist.linear.x == pytest.approx(0.2, abs=0.03)
    made.go(2.0, linear=5.0)
    assert made.odometry().twist.twist.linear.x == pytest.approx(0.3, abs=0.01)
    speeds = [message.twist.linear.x for message in box.drain()]
    assert max(speeds) == pytest.approx(0.3)
    assert max(b - a for a, b in itertools.pairwise(speeds)) < 0.2 * 0.0051


def test_separation_and_radius_come_from_the_description(drive):
    """Turning on the spot at w, each rim goes w track / 2."""
    made = drive()
    made.world.run(0.5)
    states = made.world.session.simulation
    before = states.joint_position("cart", "right_joint")
    made.go(2.0, angular=1.0)
    turned = states.joint_position("cart", "right_joint") - before
    assert turned == pytest.approx(2.0 * 1.0 * TRACK / 2 / RADIUS, rel=0.02)


def test_the_odometry_is_published_at_its_rate_and_moves_the_frame(drive):
    made = drive(publish_rate=20.0)
    odometry = made.world.mailbox("/base/odom", size=1000)
    frames = made.world.graph.mailbox("/tf", size=1000)
    made.world.run(2.0)
    assert len(odometry.drain()) == pytest.approx(40, abs=1)
    sent = [t for message in frames.drain() for t in message.transforms]
    assert {(t.header.frame_id, t.child_frame_id) for t in sent} == {("odom", "base_link")}


def test_without_enable_odom_tf_there_is_none(drive):
    made = drive(enable_odom_tf=False)
    assert "/tf" not in [topic.name for topic in made.world.graph.topics()]


ROS2 = """<ros2_control name="s" type="system"><hardware>
  <plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
  <joint name="left_joint"><command_interface name="velocity"/><state_interface name="position"/>
  </joint><joint name="right_joint"><command_interface name="velocity"/>
  <state_interface name="position"/></joint></ros2_control>
  <gazebo><plugin name="gz_ros2_control::GazeboSimROS2ControlPlugin"
  filename="gz_ros2_control-system"><parameters>{file}</parameters></plugin></gazebo>"""


def test_ros2_control_starts_what_its_file_names(make, tmp_path):
    file = tmp_path / "controllers.yaml"
    content = {
        "controller_manager": {
            "ros__parameters": {
                "update_rate": 100,
                "base": {"type": "diff_drive_controller/DiffDriveController"},
                "states": {"type": "joint_state_broadcaster/JointStateBroadcaster"},
            }
        },
        "/**/base": {
            "ros__parameters": {
                "left_wheel_names": ["left_joint"],
                "right_wheel_names": ["right_joint"],
                "wheel_separation": TRACK,
                "wheel_radius": RADIUS,
                "linear.x.max_velocity": 0.2,
            }
        },
    }
    file.write_text(yaml.safe_dump(content))
    robot = tmp_path / "cart.urdf"
    robot.write_text(cart(ROS2.format(file=file)))
    world = make.world()
    model = world.spawn(robot, z=RADIUS)
    states = world.mailbox("/joint_states", size=1000)
    kind = "geometry_msgs/msg/TwistStamped"
    start = model.pose.x
    for _ in range(30):
        world.graph.publish(
            "/base/cmd_vel", kind, from_dict(kind, {"twist": {"linear": {"x": 1.0}}})
        )
        world.run(0.1)
    assert model.pose.x - start == pytest.approx(0.2 * 3.0, rel=0.05)
    found = states.drain()
    assert len(found) == pytest.approx(300, abs=2)
    assert found[0].name == ["left_joint", "right_joint"]


def test_wheels_that_two_controllers_want_go_to_the_base_s(make, tmp_path):
    """A launch file would start the one or the other; the group is named first."""
    content = {
        "wheels": {
            "type": "velocity_controllers/JointGroupVelocityController",
            "joints": ["left_joint", "right_joint"],
        },
        "base": {
            "type": "diff_drive_controller/DiffDriveController",
            "left_wheel": "left_joint",
            "right_wheel": "right_joint",
        },
    }
    drive = Drive(make, tmp_path, cart(ROS1), content)
    drive.go(3.0, linear=0.5)
    assert drive.odometry().twist.twist.linear.x == pytest.approx(0.5, rel=0.02)
    (reported,) = coded(drive.world, running.CONTROLLER_NOT_STARTED)
    assert reported.values["cause"] == running.CONTROLLER_CONFLICT.number


@pytest.mark.wording
def test_parameters_among_those_of_the_manager_are_found(make, tmp_path):
    """ROS 2 gives a controller only the parameters of its own node."""
    file = tmp_path / "controllers.yaml"
    own = {
        "type": "diff_drive_controller/DiffDriveController",
        "left_wheel_names": ["left_joint"],
        "right_wheel_names": ["right_joint"],
    }
    manager = {"ros__parameters": {"base": own}}
    file.write_text(yaml.safe_dump({"controller_manager": manager}))
    robot = tmp_path / "cart.urdf"
    robot.write_text(cart(ROS2.format(file=file)))
    world = make.world()
    world.spawn(robot, z=RADIUS)
    (refused,) = coded(world, running.CONTROLLER_NOT_STARTED)
    assert "left_wheel_names" in refused.message
    assert refused.hint.endswith("Move it to base: ros__parameters.")


@pytest.mark.parametrize("managers", [1, 2])
@pytest.mark.parametrize("first", ["drive", "managers"])
def test_controller_managers_without_commands_leave_effort_joints_to_a_drive(
    make, tmp_path, managers, first
):
    """In Gazebo, each adds an effort of 0 to that of the drive."""
    drive = f"""<gazebo><plugin name="d" filename="libgazebo_ros_diff_drive.so">
      <leftJoint>left_joint</leftJoint><rightJoint>right_joint</rightJoint>
      <commandTopic>base/cmd_vel</commandTopic><wheelSeparation>{TRACK}</wheelSeparation>
      <wheelDiameter>{2 * RADIUS}</wheelDiameter></plugin></gazebo>"""
    effort = ROS1.replace("VelocityJoint", "EffortJoint")
    effort += ROS1[ROS1.index("<gazebo>") :] * (managers - 1)
    parts = (drive, effort) if first == "drive" else (effort, drive)
    made = Drive(make, tmp_path, cart("".join(parts)), {})
    made.go(2.0, linear=0.5)
    assert made.model.pose.x == pytest.approx(1.0, rel=0.05)
