"""A small robot without a fault, ways to spoil it, and the advice taken literally."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import pytest

from cartwheel.codes import code_named, devices
from cartwheel.description.check import PluginKnowledge, Report, check
from cartwheel.description.model import PluginTag, Sensor
from cartwheel.errors import Diagnostic

ROBOT = """<?xml version="1.0"?>
<robot name="tester">
  <material name="blue">
    <color rgba="0 0 1 1"/>
  </material>
  <link name="base_footprint"/>
  <joint name="base_joint" type="fixed">
    <parent link="base_footprint"/>
    <child link="base_link"/>
  </joint>
  <link name="base_link">
    <inertial>
      <origin xyz="0 0 0.1"/>
      <mass value="6"/>
      <inertia ixx="0.05" iyy="0.085" izz="0.125"/>
    </inertial>
    <visual>
      <origin xyz="0 0 0.1" rpy="0 0 0"/>
      <geometry>
        <box size="0.4 0.3 0.1"/>
      </geometry>
      <material name="blue"/>
    </visual>
    <collision>
      <origin xyz="0 0 0.1"/>
      <geometry>
        <box size="0.4 0.3 0.1"/>
      </geometry>
    </collision>
  </link>
  <joint name="left_wheel_joint" type="continuous">
    <origin xyz="0 0.2 0.08"/>
    <parent link="base_link"/>
    <child link="left_wheel"/>
    <axis xyz="0 1 0"/>
    <limit effort="5" velocity="20"/>
  </joint>
  <link name="left_wheel">
    <inertial>
      <mass value="0.5"/>
      <inertia ixx="0.000867" iyy="0.0016" izz="0.000867"/>
    </inertial>
    <visual>
      <origin rpy="1.5707963 0 0"/>
      <geometry>
        <cylinder radius="0.08" length="0.04"/>
      </geometry>
    </visual>
    <collision>
      <origin rpy="1.5707963 0 0"/>
      <geometry>
        <cylinder radius="0.08" length="0.04"/>
      </geometry>
    </collision>
  </link>
  <joint name="right_wheel_joint" type="continuous">
    <origin xyz="0 -0.2 0.08"/>
    <parent link="base_link"/>
    <child link="right_wheel"/>
    <axis xyz="0 1 0"/>
  </joint>
  <link name="right_wheel">
    <inertial>
      <mass value="0.5"/>
      <inertia ixx="0.000867" iyy="0.0016" izz="0.000867"/>
    </inertial>
    <collision>
      <origin rpy="1.5707963 0 0"/>
      <geometry>
        <cylinder radius="0.08" length="0.04"/>
      </geometry>
    </collision>
  </link>
  <joint name="caster_joint" type="fixed">
    <origin xyz="-0.15 0 0.03"/>
    <parent link="base_link"/>
    <child link="caster_link"/>
  </joint>
  <link name="caster_link">
    <inertial>
      <mass value="0.1"/>
      <inertia ixx="0.000036" iyy="0.000036" izz="0.000036"/>
    </inertial>
    <collision>
      <geometry>
        <sphere radius="0.03"/>
      </geometry>
    </collision>
  </link>
  <joint name="arm_joint" type="revolute">
    <origin xyz="0 0 0.16"/>
    <parent link="base_link"/>
    <child link="arm"/>
    <axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="5" velocity="2"/>
  </joint>
  <link name="arm">
    <inertial>
      <origin xyz="0 0 0.1"/>
      <mass value="0.3"/>
      <inertia ixx="0.001" iyy="0.001" izz="0.00008"/>
    </inertial>
    <collision>
      <origin xyz="0 0 0.1"/>
      <geometry>
        <box size="0.04 0.04 0.2"/>
      </geometry>
    </collision>
  </link>
  <joint name="finger_joint" type="prismatic">
    <origin xyz="0 0 0.21"/>
    <parent link="arm"/>
    <child link="finger"/>
    <axis xyz="1 0 0"/>
    <limit lower="0" upper="0.1" effort="5" velocity="2"/>
    <mimic joint="arm_joint" multiplier="0.1"/>
  </joint>
  <link name="finger">
    <inertial>
      <mass value="0.1"/>
      <inertia ixx="0.00002" iyy="0.00002" izz="0.00002"/>
    </inertial>
    <collision>
      <geometry>
        <box size="0.03 0.03 0.01"/>
      </geometry>
    </collision>
  </link>
  <joint name="eye_joint" type="fixed">
    <origin xyz="0.2 0 0.18"/>
    <parent link="base_link"/>
    <child link="eye"/>
  </joint>
  <link name="eye"/>
  <gazebo>
    <plugin name="drive" filename="libgazebo_ros_diff_drive.so">
      <leftJoint>left_wheel_joint</leftJoint>
      <rightJoint>right_wheel_joint</rightJoint>
      <wheelSeparation>0.4</wheelSeparation>
      <wheelDiameter>0.16</wheelDiameter>
      <wheelTorque>2</wheelTorque>
      <updateRate>100</updateRate>
      <odometryTopic>odom</odometryTopic>
      <robotBaseFrame>base_link</robotBaseFrame>
    </plugin>
    <plugin name="imu" filename="libgazebo_ros_imu.so">
      <bodyName>base_link</bodyName>
      <topicName>imu</topicName>
    </plugin>
  </gazebo>
  <gazebo reference="caster_link">
    <mu1>0.0</mu1>
    <mu2>0.0</mu2>
  </gazebo>
  <gazebo reference="left_wheel">
    <mu1>1.0</mu1>
    <mu2>1.0</mu2>
    <material>Gazebo/Black</material>
  </gazebo>
  <gazebo reference="base_link">
    <sensor type="contact" name="bumper">
      <contact>
        <collision>base_footprint_fixed_joint_lump__base_link_collision</collision>
      </contact>
      <plugin name="bumper" filename="libgazebo_ros_bumper.so">
        <bumperTopicName>bumper</bumperTopicName>
        <frameName>base_link</frameName>
      </plugin>
    </sensor>
  </gazebo>
  <gazebo reference="eye">
    <sensor type="camera" name="camera">
      <update_rate>30</update_rate>
      <camera>
        <clip>
          <near>0.02</near>
          <far>50</far>
        </clip>
      </camera>
    </sensor>
    <sensor type="ray" name="lidar">
      <ray>
        <scan>
          <horizontal>
            <min_angle>-1</min_angle>
            <max_angle>1</max_angle>
          </horizontal>
        </scan>
        <range>
          <min>0.05</min>
          <max>10</max>
        </range>
      </ray>
    </sensor>
  </gazebo>
</robot>
"""
_KNOWN = {
    "libgazebo_ros_diff_drive.so": {
        "leftJoint", "rightJoint", "wheelSeparation", "wheelDiameter", "wheelTorque", "torque",
        "updateRate", "odometryTopic", "robotBaseFrame", "legacyMode",
    },
    "libgazebo_ros_imu.so": {"bodyName", "body_name", "topicName"},
    "libgazebo_ros_p3d.so": {"bodyName", "topicName"},
    "libgazebo_ros_control.so": {"robotSimType"},
    "libgazebo_ros_bumper.so": {"bumperTopicName", "frameName"},
}  # fmt: skip


def judge(tag: PluginTag, _sensor: Sensor | None) -> Iterable[Diagnostic] | None:
    """What the plugins above would say of their parameters."""
    known = _KNOWN.get(tag.filename)
    if known is None:
        return None
    return [
        devices.PLUGIN_PARAMETER_UNKNOWN.diagnostic(
            f"<{child.tag}> has no effect",
            origin=child.origin,
            values={"parameter": child.tag, "meant": "wheelDiameter" * ("iameter" in child.tag)},
        )
        for child in tag.element.children
        if child.tag not in known
    ]


KNOWLEDGE = PluginKnowledge(
    filenames=tuple(_KNOWN),
    judge=judge,
    controller_types=(
        "diff_drive_controller/DiffDriveController",
        "effort_controllers/JointPositionController",
        "joint_state_controller/JointStateController",
        "joint_trajectory_controller/JointTrajectoryController",
        "position_controllers/JointPositionController",
    ),
    controller_files=lambda robot, _joints: sorted(robot.parent.glob("config/*.yaml")),
)


@dataclass
class Bench:
    """Checks texts as files."""

    folder: Path

    def report(self, text: str, name: str = "robot.urdf", **options: object) -> Report:
        """What is found in a text."""
        path = self.folder / name
        path.write_text(text)
        return check(path, known=KNOWLEDGE, **options)

    def find(
        self, text: str, rule: str, name: str = "robot.urdf", **options: object
    ) -> list[Diagnostic]:
        """What a rule finds in a text."""
        return [
            f for f in self.report(text, name, **options).findings if f.code is code_named(rule)
        ]


@pytest.fixture
def bench(tmp_path: Path) -> Bench:
    return Bench(tmp_path)


@pytest.fixture
def robot() -> str:
    """A URDF without a fault."""
    return ROBOT


@pytest.fixture
def spoil() -> Callable[..., str]:
    """The robot with texts replaced, each of which it must have."""

    def make(*pairs: tuple[str, str], text: str = ROBOT) -> str:
        for old, new in pairs:
            assert old in text, f"the robot has no {old!r}"
            text = text.replace(old, new, 1)
        return text

    return make


@pytest.fixture
def line_of() -> Callable[[str, str], int]:
    """The line in which a text stands first."""
    return lambda text, part: text[: text.index(part)].count("\n") + 1


@pytest.fixture
def take() -> Callable[[str, Diagnostic], str]:
    """A text with a finding's advice written where it says."""
    return take_advice


def take_advice(text: str, finding: Diagnostic) -> str:
    assert finding.origin is not None
    assert finding.instead
    if finding.place == "line" or finding.origin.file.endswith(".yaml"):
        return _take_in_yaml(text, finding)
    start = sum(len(line) + 1 for line in text.split("\n")[: finding.origin.line - 1])
    head = re.compile(r"<([\w:]+)((?:\s+[\w:]+=\"[^\"]*\")*)\s*(/?)>").search(text, start)
    assert head is not None
    tag, attributes, alone = head[1], head[2], bool(head[3])
    end = head.end() if alone else text.index(f"</{tag}>", head.end()) + len(f"</{tag}>")
    new = finding.instead
    if finding.place == "element":
        return text[: head.start()] + new + text[end:]
    if finding.place == "after":
        return text[:end] + new + text[end:]
    if finding.place == "inside":
        if alone:
            return text[: head.start()] + f"<{tag}{attributes}>{new}</{tag}>" + text[end:]
        close = end - len(f"</{tag}>")
        return text[:close] + new + text[close:]
    assert finding.place == "attribute", "the advice does not say where"
    name = new.partition("=")[0]
    attributes = re.sub(rf'\s+{name}="[^"]*"', "", attributes)
    return text[: head.start()] + f"<{tag} {new}{attributes}{'/' * alone}>" + text[head.end() :]


def _take_in_yaml(text: str, finding: Diagnostic) -> str:
    assert finding.origin is not None
    lines = text.split("\n")
    number = finding.origin.line - 1
    indent = " " * (len(lines[number]) - len(lines[number].lstrip()))
    if finding.place == "line":
        lines[number] = indent + finding.instead
    else:
        assert finding.place == "after"
        lines.insert(number + 1, indent + finding.instead)
    return "\n".join(lines)
