"""Robots on four wheels for ros2_control, made in a line."""

import math

import yaml
from tests.dialects.ros_control.arms import ros2_joint, ros2_parameters, ros2_plugin, ros2_system

RADIUS, BASE, TRACK = 0.1, 0.5, 0.4
"""m: of the wheels, between the axles, between the wheels of an axle."""
CORNERS = {"front_left": (1, 1), "front_right": (1, -1), "rear_left": (-1, 1),
           "rear_right": (-1, -1)}  # fmt: skip

REAR = {"rear_left": (-BASE / 2, TRACK / 2, False), "rear_right": (-BASE / 2, -TRACK / 2, False)}
FRONT = {"front": (BASE / 2, 0.0, True)}
"""Wheels of a tricycle, for `car`."""


def _wheel(name, parent, x, y):
    return f"""<link name="{name}"><inertial><mass value="0.5"/><inertia ixx="0.00125" iyy="0.0025"
      izz="0.00125" ixy="0" ixz="0" iyz="0"/></inertial><collision><origin rpy="1.5707963 0 0"/>
      <geometry><cylinder radius="{RADIUS}" length="0.04"/></geometry></collision></link>
      <joint name="{name}_joint" type="continuous"><parent link="{parent}"/><child link="{name}"/>
      <origin xyz="{x} {y} 0"/><axis xyz="0 1 0"/></joint>"""


def _fork(name, x, y):
    return f"""<link name="{name}_fork"><inertial><mass value="0.3"/><inertia ixx="1e-3" iyy="1e-3"
      izz="1e-3" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <joint name="{name}_steer" type="revolute"><parent link="base_link"/>
      <child link="{name}_fork"/><origin xyz="{x} {y} 0"/><axis xyz="0 0 1"/>
      <limit lower="-1.4" upper="1.4" effort="50" velocity="20"/></joint>"""


def rollers():
    """Tags that let mecanum wheels grip along the axes of the rollers that touch the ground."""
    slants = {name: -x * y for name, (x, y) in CORNERS.items()}
    return "".join(
        f"""<gazebo reference="{name}" xmlns:gz="http://gazebosim.org/schema"><collision><surface>
        <friction><ode><mu>1.0</mu><mu2>0.0</mu2>
        <fdir1 gz:expressed_in="base_link">1 {slant} 0</fdir1></ode></friction></surface>
        </collision></gazebo>"""
        for name, slant in slants.items()
    )


def car(wheels, plugin, commanded, tags=""):
    """A robot of some wheels.

    Args:
        wheels: Name to (x, y, whether a joint ``<name>_steer`` turns it).
        plugin: XML.
        commanded: Joints that ros2_control has; others turn freely, as it would hold them.
        tags: Further ones of the robot.
    """
    mass = 8.0
    parts = f"""<link name="base_link"><inertial><mass value="{mass}"/><inertia ixx="0.1" iyy="0.2"
      izz="0.3" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
    joints = []
    for name, (x, y, steered) in wheels.items():
        if steered:
            parts += _fork(name, x, y) + _wheel(name, f"{name}_fork", 0, 0)
            joints.append((f"{name}_steer", "position"))
        else:
            parts += _wheel(name, "base_link", x, y)
        joints.append((f"{name}_joint", "velocity"))
    system = ros2_system(*(ros2_joint(*joint) for joint in joints if joint[0] in commanded))
    return f'<robot name="car">{parts}{system}<gazebo>{plugin}</gazebo>{tags}</robot>'


def four_wheels(*, steered=False):
    """Their places, the front ones steered or none."""
    return {
        name: (x * BASE / 2, y * TRACK / 2, steered and x > 0) for name, (x, y) in CORNERS.items()
    }


class Car:
    """A robot with one drive, ``base``, that a test commands."""

    def __init__(self, make, folder, wheels, topic, tags="", *, edit=str, **settings):
        file = folder / "drive.yaml"
        file.write_text(yaml.safe_dump(ros2_parameters(base=settings)))
        robot = folder / "car.urdf"
        robot.write_text(edit(car(wheels, ros2_plugin(file), file.read_text(), tags)))
        self.topic = topic
        self.world = make.world()
        self.model = self.world.spawn(robot, z=RADIUS)
        self.world.run(0.2)

    def go(self, seconds, x=0.0, y=0.0, turn=0.0):
        """Sends a command ten times a second."""
        for _ in range(round(seconds * 10)):
            self.send(x, y, turn)
            self.world.run(0.1)

    def send(self, x=0.0, y=0.0, turn=0.0):
        self.world.publish(
            f"/base/{self.topic}", twist_linear_x=x, twist_linear_y=y, twist_angular_z=turn
        )

    def joint(self, name):
        return self.world.session.simulation.joint_position("car", name)

    def speeds(self, *names):
        """rad/s, of joints over a tenth of a second."""
        before = [self.joint(name) for name in names]
        self.world.run(0.1)
        return [(self.joint(name) - place) / 0.1 for name, place in zip(names, before, strict=True)]

    def odometry(self, topic="/base/odometry"):
        box = self.world.mailbox(topic, size=10)
        self.world.run(0.05)
        return box.drain()[-1]

    @property
    def place(self):
        pose = self.model.pose
        return pose.x, pose.y, pose.yaw


def heading(message):
    turn = message.pose.pose.orientation
    return 2 * math.atan2(turn.z, turn.w)


class Driven:
    """A car in `world` that follows Twist messages."""

    def drive(self, seconds, speed, angle):
        """Sends a command ten times a second; returns the last odometry."""
        box = self.world.mailbox("/base/odom", size=1000)
        for _ in range(round(seconds * 10)):
            self.world.publish("/base/cmd_vel", linear_x=speed, angular_z=angle)
            self.world.run(0.1)
        return box.drain()[-1].twist.twist
