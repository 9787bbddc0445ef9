"""Seeded faults: documents with one fault each, and the code that a check must report.

The tests of the rules and ``python -m benchmarks check`` use the same ones.
"""

# ruff: noqa: E501  (a case is a table row)

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

Changes = list[tuple[str, str]]
"""Texts of `ROBOT`, and what replaces them."""
Case = tuple[str, Changes, str | None, str]
"""A code's name; the changes; a text in the line of the finding; a text of its advice or hint."""


def transmission(joint: str, interface: str) -> tuple[str, str]:
    return (
        "</robot>",
        f'<transmission name="{joint}_t"><type>transmission_interface/SimpleTransmission</type>\n'
        f'<joint name="{joint}">\n<hardwareInterface>{interface}</hardwareInterface></joint>'
        "</transmission>\n</robot>",
    )


EFFORT = "hardware_interface/EffortJointInterface"

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
      <inertia ixx="0.05" iyy="0.085" izz="0.125" ixy="0" ixz="0" iyz="0"/>
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
      <inertia ixx="0.000867" iyy="0.0016" izz="0.000867" ixy="0" ixz="0" iyz="0"/>
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
      <inertia ixx="0.000867" iyy="0.0016" izz="0.000867" ixy="0" ixz="0" iyz="0"/>
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
      <inertia ixx="0.000036" iyy="0.000036" izz="0.000036" ixy="0" ixz="0" iyz="0"/>
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
      <inertia ixx="0.001" iyy="0.001" izz="0.00008" ixy="0" ixz="0" iyz="0"/>
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
    <limit lower="-0.1" upper="0.1" effort="5" velocity="2"/>
    <mimic joint="arm_joint" multiplier="0.1"/>
  </joint>
  <link name="finger">
    <inertial>
      <mass value="0.1"/>
      <inertia ixx="0.00002" iyy="0.00002" izz="0.00002" ixy="0" ixz="0" iyz="0"/>
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

LUMP = "base_footprint_fixed_joint_lump__base_link_collision"

WITH_ADVICE: dict[str, Case] = {
    "link twice": ("duplicate-name", [('<link name="eye"/>', '<link name="eye"/>\n<link name="eye" />')],
        '<link name="eye" />', 'name="eye_2"'),
    "parent unknown": ("joint-link-unknown", [
        ('<parent link="arm"/>', '<parent link="arn"/>')], 'link="arn"', 'link="arm"'),
    "child unknown": ("joint-link-unknown", [
        ('<child link="finger"/>', '<child link="fingr"/>')], 'link="fingr"', 'link="finger"'),
    "joint type": ("joint-type-unknown", [('name="finger_joint" type="prismatic"',
        'name="finger_joint" type="prismatik"')], "prismatik", 'type="prismatic"'),
    "loose link": ("multiple-roots", [('<link name="eye"/>', '<link name="eye"/>\n<link name="loose"/>')],
        '"loose"', '<child link="loose"/>'),
    "mimic": ("mimic-unknown", [('mimic joint="arm_joint"', 'mimic joint="arm_jiont"')],
        "arm_jiont", 'joint="arm_joint"'),
    "reference": ("reference-unknown", [('reference="caster_link"', 'reference="castor_link"')],
        "castor_link", 'reference="caster_link"'),
    "no limit": ("limit-missing", [('    <limit lower="-1" upper="1" effort="5" velocity="2"/>\n', "")],
        'name="arm_joint"', "<limit lower="),
    "no effort": ("limit-incomplete", [('upper="1" effort="5" ', 'upper="1" ')],
        'upper="1" velocity', 'effort="10"'),
    "reversed": ("limit-reversed", [('lower="-1" upper="1"', 'lower="1" upper="-1"')],
        'lower="1"', 'lower="-1" upper="1"'),
    "degrees": ("limit-in-degrees", [('lower="-1" upper="1"', 'lower="-90" upper="90"')],
        'lower="-90"', 'lower="-1.5708" upper="1.5708"'),
    "a radian in degrees": ("limit-in-degrees", [('lower="-1" upper="1"', 'lower="-57.3" upper="57.2958"')],
        'lower="-57.3"', 'upper="1"'),
    "effort 0": ("effort-zero", [('effort="5" velocity="20"', 'effort="0" velocity="20"')],
        'effort="0"', 'effort="10"'),
    "velocity 0": ("effort-zero", [('effort="5" velocity="20"', 'effort="5" velocity="0"')],
        'velocity="0"', 'velocity="10"'),
    "axis 0": ("axis-zero", [('<axis xyz="1 0 0"/>', '<axis xyz="0 0 0"/>')],
        'axis xyz="0 0 0"', 'xyz="0 0 1"'),
    "axis 2": ("axis-not-normalized", [('<axis xyz="1 0 0"/>', '<axis xyz="1 0 1"/>')],
        'axis xyz="1 0 1"', 'xyz="0.707107 0 0.707107"'),
    "no inertial": ("inertia-missing", [
        ('<inertial>\n      <mass value="0.1"/>\n      <inertia ixx="0.00002" iyy="0.00002" '
         'izz="0.00002" ixy="0" ixz="0" iyz="0"/>\n    </inertial>', "")],
        'link name="finger"', '<mass value="1"/>'),
    "triangle": ("inertia-impossible", [('iyy="0.085" izz="0.125"', 'iyy="0.085" izz="0.325"')],
        'izz="0.325"', '<inertia ixx="0.05" ixy="0" ixz="0" iyy="0.085" iyz="0" izz="0.125"/>'),
    "negative": ("inertia-impossible", [('ixx="0.001"', 'ixx="-0.001"')], 'ixx="-0.001"',
        '<inertia ixx="0.00104"'),
    "mass 0": ("mass-not-positive", [('<mass value="0.3"/>', '<mass value="0"/>')],
        'mass value="0"', 'value="0.289"'),  # 0.00208 kg m² of all axes, by 0.0072 a kilogram
    "mass too small for a sum": ("mass-not-positive",
        [('<mass value="0.3"/>', '<mass value="1e-109"/>')],
        'mass value="1e-109"', 'value="0.289"'),
    "mass below 0": ("mass-not-positive", [('<mass value="0.3"/>', '<mass value="-0.3"/>')],
        'mass value="-0.3"', 'value="0.3"'),
    "inertia large": ("inertia-geometry-mismatch", [('ixx="0.001" iyy="0.001" izz="0.00008"',
        'ixx="1" iyy="1" izz="1"')], 'ixx="1"', '<inertia ixx="0.00104"'),
    "inertia small": ("inertia-geometry-mismatch", [('ixx="0.001" iyy="0.001" izz="0.00008"',
        'ixx="1e-6" iyy="1e-6" izz="1e-6"')], 'ixx="1e-6"', '<inertia ixx="0.00104"'),
    "centre": ("center-of-mass-outside", [('<origin xyz="0 0 0.1"/>\n      <mass value="0.3"/>',
        '<origin xyz="0 0 0.5"/>\n      <mass value="0.3"/>')], 'xyz="0 0 0.5"',
        '<origin xyz="0 0 0.1"/>'),
    "grams": ("mass-in-grams", [('<mass value="0.3"/>', '<mass value="300"/>')], 'mass value="300"',
        'value="0.3"'),
    "tonnes": ("mass-implausible", [('<mass value="6"/>', '<mass value="600000"/>')],
        'mass value="600000"', 'value="600"'),
    "left joint": ("drive-joint-unknown", [("<leftJoint>left_wheel_joint", "<leftJoint>left_wheel_jnt")],
        "left_wheel_jnt", "<leftJoint>left_wheel_joint</leftJoint>"),
    "fixed wheel": ("drive-joint-not-continuous", [('name="left_wheel_joint" type="continuous"',
        'name="left_wheel_joint" type="fixed"')], 'name="left_wheel_joint"', 'type="continuous"'),
    "separation": ("wheel-separation-mismatch", [("<wheelSeparation>0.4<", "<wheelSeparation>0.45<")],
        "wheelSeparation", "<wheelSeparation>0.4</wheelSeparation>"),
    "diameter": ("wheel-diameter-mismatch", [("<wheelDiameter>0.16<", "<wheelDiameter>0.08<")],
        "wheelDiameter", "<wheelDiameter>0.16</wheelDiameter>"),
    "axis backwards": ("wheel-axis-misaligned", [('<child link="right_wheel"/>\n    <axis xyz="0 1 0"/>',
        '<child link="right_wheel"/>\n    <axis xyz="0 -1 0"/>')], 'xyz="0 -1 0"', 'xyz="0 1 0"'),
    "axis along": ("wheel-axis-misaligned", [('<child link="right_wheel"/>\n    <axis xyz="0 1 0"/>',
        '<child link="right_wheel"/>\n    <axis xyz="1 0 0"/>')], 'xyz="1 0 0"', 'xyz="0 1 0"'),
    "no axis": ("wheel-axis-misaligned", [('<child link="right_wheel"/>\n    <axis xyz="0 1 0"/>',
        '<child link="right_wheel"/>')], 'name="right_wheel_joint"', '<axis xyz="0 1 0"/>'),
    "lying wheel": ("wheel-not-round", [('rpy="1.5707963 0 0"/>\n      <geometry>\n        '
        '<cylinder radius="0.08" length="0.04"/>\n      </geometry>\n    </collision>',
        'rpy="0 0 0"/>\n      <geometry>\n        <cylinder radius="0.08" length="0.04"/>\n'
        '      </geometry>\n    </collision>')], 'origin rpy="0 0 0"/>', 'rpy="1.5708 0 0"'),
    "lying wheel without an origin": ("wheel-not-round", [('<collision>\n      <origin '
        'rpy="1.5707963 0 0"/>', '<collision>')], '<collision>\n      <geometry>\n        <cyl',
        '<origin rpy="1.5708 0 0"/>'),
    "a wheel without limits": ("limit-missing", [('name="left_wheel_joint" type="continuous"',
        'name="left_wheel_joint" type="revolute"'), ('<limit effort="5" velocity="20"/>', "")],
        'name="left_wheel_joint" type="rev', 'type="continuous"'),
    "odd degrees": ("limit-in-degrees", [('lower="-1" upper="1"', 'lower="-100" upper="20"')],
        'lower="-100"', 'lower="-1.74533" upper="0.349066"'),
    "no torque": ("effort-zero", [("<wheelTorque>2<", "<wheelTorque>0<")], "<wheelTorque>",
        "<wheelTorque>5</wheelTorque>"),
    "no file name's end": ("plugin-unknown", [("libgazebo_ros_diff_drive.so",
        "libgazebo_ros_diff_drive")], "gazebo_ros_diff_drive", 'filename="libgazebo_ros_diff_drive.so"'),
    "no file name's begin": ("plugin-unknown", [("libgazebo_ros_diff_drive.so",
        "gazebo_ros_diff_drive.so")], "gazebo_ros_diff_drive", 'filename="libgazebo_ros_diff_drive.so"'),
    "a link without a name": ("name-missing", [('<link name="eye"/>', '<link name="eye"/>\n<link/>')],
        "<link/>", 'name="new_link"'),
    "a sensor without a name": ("name-missing", [('<sensor type="ray" name="lidar">',
        '<sensor type="ray">')], '<sensor type="ray">', 'name="ray_sensor"'),
    "a picture's format": ("image-format-unknown", [("<clip>", "<image>\n<format>R8B8G8</format></image><clip>")],
        "R8B8G8", "<format>"),
    "no friction": ("wheel-frictionless", [("<mu1>1.0</mu1>\n    <mu2>1.0</mu2>",
        "<mu1>0</mu1>\n    <mu2>0</mu2>")], "<mu1>0</mu1>", "<mu1>1.0</mu1>"),
    "wheel without collision": ("wheel-without-collision", [(
        '<collision>\n      <origin rpy="1.5707963 0 0"/>\n      <geometry>\n        '
        '<cylinder radius="0.08" length="0.04"/>\n      </geometry>\n    </collision>', "")],
        'link name="left_wheel"', "<cylinder radius="),
    "rate": ("rate-above-physics", [("<updateRate>100<", "<updateRate>5000<")], "updateRate",
        "<updateRate>1000</updateRate>"),
    "bumper": ("contact-collision-unknown", [(LUMP, "bumper_collision")], "bumper_collision",
        "<collision>"),
    "bumper silent": ("contact-never-fires", [(LUMP, "base_footprint_collision_base_link")],
        "base_footprint_collision_base_link", f"<collision>{LUMP}</collision>"),
    "bumper plain": ("contact-never-fires", [(LUMP, "base_link_collision")],
        "<collision>base_link_collision", f"<collision>{LUMP}</collision>"),
    "body": ("body-unknown", [("<bodyName>base_link", "<bodyName>base_lnk")], "base_lnk",
        "<bodyName>base_link</bodyName>"),
    "frame": ("frame-unknown", [("<robotBaseFrame>base_link", "<robotBaseFrame>base_lnk")],
        "base_lnk", "<robotBaseFrame>base_link</robotBaseFrame>"),
    "topic": ("duplicate-topic", [("<topicName>imu<", "<topicName>odom<")], "<topicName>",
        "<topicName>odom_2</topicName>"),
    "plugin": ("plugin-unknown", [("libgazebo_ros_diff_drive.so", "libgazebo_ros_diffdrive.so")],
        "libgazebo_ros_diffdrive.so", 'filename="libgazebo_ros_diff_drive.so"'),
    "parameter": ("plugin-parameter-unknown", [("<wheelDiameter>0.16</wheelDiameter>",
        "<wheeldiameter>0.16</wheeldiameter>")], "wheeldiameter",
        "<wheel_diameter>0.16</wheel_diameter>"),
    "torque": ("plugin-parameter-obsolete", [("<wheelTorque>2</wheelTorque>", "<torque>2</torque>")],
        "<torque>", "<wheelTorque>2</wheelTorque>"),
    "legacy": ("plugin-parameter-obsolete", [("<wheelTorque>2</wheelTorque>",
        "<wheelTorque>2</wheelTorque>\n<legacyMode>true</legacyMode>")], "legacyMode",
        "<legacyMode>false</legacyMode>"),
    "giant": ("shape-out-of-scale", [('<box size="0.04 0.04 0.2"/>', '<box size="40 40 200"/>')],
        "40 40 200", '<box size="0.04 0.04 0.2"/>'),
    "rpy": ("angle-in-degrees", [('rpy="0 0 0"', 'rpy="0 0 90"')], 'rpy="0 0 90"', 'rpy="0 0 1.5708"'),
    "millimetres": ("position-in-millimetres", [('<origin xyz="0 0 0.16"/>', '<origin xyz="0 0 160"/>')],
        "0 0 160", 'xyz="0 0 0.16"'),
    "mu": ("gazebo-ignores", [("<mu1>1.0</mu1>\n    <mu2>1.0</mu2>", "<mu>1.0</mu>")], "<mu>",
        "<mu1>1.0</mu1><mu2>1.0</mu2>"),
    "selfCollide": ("gazebo-ignores", [("  <gazebo>\n", "  <gazebo>\n<selfCollide>0</selfCollide>")],
        "selfCollide", "<self_collide>0</self_collide>"),
    "Gazebo's material": ("material-unknown", [("Gazebo/Black", "Gazebo/Blck")], "Gazebo/Blck",
        "<material>Gazebo/Black</material>"),
    "material": ("material-undefined", [('<material name="blue"/>', '<material name="bleu"/>')],
        '"bleu"', 'name="blue"'),
    "topic with a blank": ("topic-invalid", [("<topicName>imu<", "<topicName>imu data<")], "imu data",
        "<topicName>imu_data</topicName>"),
    "topic of digits": ("topic-invalid", [("<odometryTopic>odom<", "<odometryTopic>1/odom<")],
        "1/odom", "<odometryTopic>_1/odom</odometryTopic>"),
    "sensor's type": ("sensor-type-unknown", [('type="camera"', 'type="camrea"')], 'type="camrea"',
        'type="camera"'),
    "sensor's tag": ("tag-ignored", [("<min_angle>-1</min_angle>",
        "<min_anlge>-1</min_anlge>")], "min_anlge", "<min_angle>-1</min_angle>"),
    "no rays": ("sensor-range-invalid", [("<horizontal>", "<horizontal>\n<samples>0</samples>")],
        "<samples>", "<samples>640</samples>"),
    "range reversed": ("sensor-range-invalid", [("<min>0.05<", "<min>20<")], "<min>20", "<min>10</min>"),
    "angle in degrees": ("sensor-range-invalid", [("<max_angle>1<", "<max_angle>90<")], "<max_angle>90",
        "<max_angle>1.5708</max_angle>"),
    "plugin's joint": ("plugin-joint-unknown", [("  <gazebo>\n", "  <gazebo>\n"
        '<plugin name="js" filename="libgazebo_ros_joint_state_publisher.so">\n'
        "<jointName>arm_joint, left_wheel_jiont</jointName></plugin>")], "<jointName>",
        "<jointName>arm_joint, left_wheel_joint</jointName>"),
    "transmission": ("transmission-joint-unknown", [("  <gazebo>\n", '<transmission name="t">'
        '<type>transmission_interface/SimpleTransmission</type>\n<joint name="arm_jiont"/>'
        "</transmission><gazebo>\n")], "arm_jiont", 'name="arm_joint"'),
    "interface": ("interface-unknown", [("  <gazebo>\n", '<transmission name="t">'
        '<type>transmission_interface/SimpleTransmission</type><joint name="arm_joint">\n'
        "<hardwareInterface>hardware_interface/EfortJointInterface</hardwareInterface></joint>"
        "</transmission><gazebo>\n")], "EfortJoint",
        "<hardwareInterface>hardware_interface/EffortJointInterface</hardwareInterface>"),
    "ros2_control": ("ros2-control-joint-unknown", [("  <gazebo>\n",
        '<ros2_control name="c" type="system">\n<joint name="arm_jiont"/></ros2_control>'
        "<gazebo>\n")], "arm_jiont", 'name="arm_joint"'),
    "command": ("interface-unknown", [("  <gazebo>\n",
        '<ros2_control name="c" type="system"><joint name="arm_joint">\n'
        '<command_interface name="postion"/></joint></ros2_control><gazebo>\n')], "postion",
        'name="position"'),
    "misspelt": ("tag-ignored", [("<mu1>1.0</mu1>", "<minDepht>1.0</minDepht>")], "minDepht",
        "<minDepth>1.0</minDepth>"),
}  # fmt: skip
"""Faults whose advice mends them."""

WITHOUT_PLACE: dict[str, Case] = {
    "two parents": ("multiple-parents", [('<child link="finger"/>', '<child link="arm"/>')],
        'name="finger_joint"', "Remove one"),
    "ring": ("kinematic-loop", [('<parent link="base_footprint"/>', '<parent link="arm"/>')],
        None, "Reverse"),
    "mimic ring": ("mimic-unknown", [('mimic joint="arm_joint"', 'mimic joint="finger_joint"')],
        'mimic joint="finger_joint"', "free"),
    "mimic of a fixed joint": ("mimic-unknown", [('mimic joint="arm_joint"', 'mimic joint="caster_joint"')],
        'mimic joint="caster_joint"', "slide along an axis"),
    "limits 0": ("limit-zero", [('lower="-1" upper="1"', 'lower="0" upper="0"')],
        'lower="0" upper="0"', 'type="fixed"'),
    "swapped": ("wheels-swapped", [("<leftJoint>left", "<leftJoint>right"),
        ("<rightJoint>right", "<rightJoint>left")], "<leftJoint>", "Swap"),
    "caster": ("caster-friction", [("<mu1>0.0</mu1>", "<mu1>1.0</mu1>")], None, "Add "),
    "deep": ("wheels-off-ground", [('<box size="0.4 0.3 0.1"/>\n      </geometry>\n    </collision>',
        '<box size="0.4 0.3 0.25"/>\n      </geometry>\n    </collision>')], None, "Raise the collision"),
    "scraping": ("body-on-ground", [('<box size="0.4 0.3 0.1"/>\n      </geometry>\n    </collision>',
        '<box size="0.4 0.3 0.2"/>\n      </geometry>\n    </collision>')], None, "Raise the collision"),
    "unbalanced": ("unbalanced", [('<origin xyz="0 0 0.1"/>\n      <mass value="6"/>', '<origin xyz="0.1 0 0.1"/>\n      <mass value="6"/>')],
        '<robot name="tester">', "caster"),
    "overlap": ("overlapping-collisions", [("  <gazebo>\n", "  <gazebo><self_collide>true</self_collide>"),
        ('<origin xyz="0 0 0.21"/>', '<origin xyz="0 0 -0.06"/>')], None, "smaller"),
    "clockwise": ("sensor-range-invalid", [("<min_angle>-1<", "<min_angle>1.5<")], "<min_angle>", "max_angle"),
    "mesh": ("file-missing", [('<box size="0.03 0.03 0.01"/>', '<mesh filename="finger.stl"/>')],
        "finger.stl", "Searched"),
    "number": ("value-invalid", [('<box size="0.03 0.03 0.01"/>', '<box size="0.03 0.03 x"/>')],
        "0.03 0.03 x", ""),
    "two sensors": ("sensor-twice", [('type="ray" name="lidar"', 'type="ray" name="camera"')],
        'type="ray"', ""),
    "further limit": ("tag-repeated", [('<limit effort="5" velocity="20"/>',
        '<limit effort="5" velocity="20"/>\n<limit effort="6" velocity="20"/>')], 'effort="6"', ""),
    "misplaced": ("tag-misplaced", [("  <gazebo>\n", "  <gazebo>\n<mu1>1</mu1>")], "<mu1>1<", ""),
    "empty": ("tag-empty", [("<mu1>1.0</mu1>", "<kp></kp>")], "<kp>", ""),
    "below 0": ("value-ignored", [("<mu1>1.0</mu1>", "<mu1>-2</mu1>")], "<mu1>-2", ""),
    "limit below 0": ("value-ignored", [('effort="5"', 'effort="-1"')], "<limit", ""),
    "damping": ("damping-too-high", [('<limit lower="-1" upper="1" effort="5" velocity="2"/>\n  </joint>\n  <link name="arm">',
        '<limit lower="-1" upper="1" effort="5" velocity="2"/><dynamics damping="100"/></joint>\n<link name="arm">'),
        transmission("arm_joint", EFFORT)], None, ""),
    "materials differ": ("material-differs", [('<material name="blue"/>',
        '<material name="blue">\n<color rgba="0 1 0 1"/>\n</material>')], None, ""),
    "battery": ("not-simulated", [("<mu1>1.0</mu1>", '<battery name="b"/>')],
        "battery", ""),
}  # fmt: skip
"""Faults whose advice is a sentence, or a text whose place the user must choose."""


ROS1 = (
    "</robot>",
    '<gazebo><plugin name="c" filename="libgazebo_ros_control.so"/></gazebo>\n</robot>',
)


ARM = """arm:
  type: effort_controllers/JointPositionController
  joint: arm_joint
  pid: {p: 10.0, i: 0.1, d: 1.0}
"""

IN_CONTROLLERS: dict[str, tuple[str, tuple[str, str], int, str]] = {
    "joint": ("controller-joint-unknown", ("joint: arm_joint", "joint: arm_jiont"), 3,
        "joint: arm_joint"),
    "type": ("controller-type-unknown", ("effort_controllers/Joint", "effort_controller/Joint"), 2,
        "type: effort_controllers/JointPositionController"),
    "type of ROS 2": ("controller-type-unknown", ("pid: {p: 10.0, i: 0.1, d: 1.0}\n",
        "pid: {p: 10.0}\nstates:\n  type: joint_state_broadcaster/JointStateBroadcaster\n"), 6,
        "type: joint_state_controller/JointStateController"),
    "no gains": ("controller-gains-missing", ("  pid: {p: 10.0, i: 0.1, d: 1.0}\n", ""), 2, "pid: {p: "),
}  # fmt: skip
"""A code's name; a text of `ARM`, and what replaces it; the line; a text of the advice."""

BOX = """<link name="box"><pose>0 0 0.5 0 0 {yaw}</pose>
<inertial><mass>{mass}</mass>
<inertia><ixx>{i}</ixx><iyy>{i}</iyy><izz>{izz}</izz></inertia></inertial>
<collision name="c"><geometry><box><size>1 1 1</size></box></geometry></collision>
<visual name="v"><geometry><box><size>1 1 1</size></box></geometry></visual>
</link>
"""
GOOD = {"mass": "6", "i": "1", "izz": "1", "yaw": "1.57"}


def model(extra: str = "", **values: str) -> str:
    text = BOX.format(**{**GOOD, **values})
    return f'<sdf version="1.6"><model name="m">\n{text}{extra}</model></sdf>'


def world(extra: str = "", inner: str = "") -> str:
    inside = model(inner).removeprefix('<sdf version="1.6">').removesuffix("</sdf>")
    return f'<sdf version="1.6"><world name="w">\n{extra}{inside}</world></sdf>'


IN_SDF: list[tuple[str, str, int]] = [
    ("inertia-impossible", model(izz="9"), 3),
    ("inertia-geometry-mismatch", model(i="100", izz="100"), 3),
    ("angle-in-degrees", model(yaw="90"), 2),
    ("file-missing", world("<include><uri>model://nothing_here</uri></include>\n"), 2),
    ("tag-ignored", model("<velocty_decay/>"), 8),
    ("tag-missing", model('<joint name="j" type="fixed"/>'), 8),
]
"""A code's name, a document, and the line of the finding."""

URDF = """<robot name="r"><link name="base"><inertial><mass value="6"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="1 1 1"/></geometry></collision></link><gazebo>
{}</gazebo></robot>"""


def inserted(extra: str = "", **values: str) -> str:
    """A URDF into which ``<gazebo>`` inserts the box from line 4 on."""
    return URDF.format(BOX.format(**{**GOOD, **values}) + extra)


IN_SDF_OF_A_URDF: list[tuple[str, str, int, str]] = [
    ("inertia-impossible", inserted(izz="9"), 5, "<ixx>1</ixx>"),
    ("inertia-geometry-mismatch", inserted(i="100", izz="100"), 6, "<ixx>1</ixx>"),
    ("mass-in-grams", inserted(mass="60000", i="1e4", izz="1e4"), 5, "<mass>60</mass>"),
    (
        "file-missing",
        inserted(
            '<link name="l"><visual name="v"><geometry><mesh>\n<uri>model://nothing/a.dae</uri>'
            "</mesh></geometry></visual></link>"
        ),
        10,
        "",
    ),
    (
        "joint-link-unknown",
        inserted('<joint name="j" type="ball"><parent>bass</parent><child>box</child></joint>'),
        10,
        "",
    ),
]
"""A code's name, a document, the line of the finding, and a text of its advice."""


@dataclass(frozen=True, kw_only=True, slots=True)
class SeededFault:
    """A document with one fault."""

    name: str
    code: str
    """The name of the code that a check must report."""
    text: str
    file: str = "robot.urdf"
    """The document's file name."""
    controllers: str = ""
    """A file of controllers, to check with the document."""


def seeded_faults() -> Iterator[SeededFault]:
    """All faults of the tables above, as documents."""
    for table in (WITH_ADVICE, WITHOUT_PLACE):
        for name, (code, changes, _, _) in table.items():
            yield SeededFault(name=name, code=code, text=changed(ROBOT, *changes))
    arm = changed(ROBOT, ROS1, transmission("arm_joint", EFFORT))
    for name, (code, change, _, _) in IN_CONTROLLERS.items():
        yield SeededFault(name=name, code=code, text=arm, controllers=changed(ARM, change))
    for code, text, _ in IN_SDF:
        yield SeededFault(name=f"{code} in SDF", code=code, text=text, file="model.sdf")
    for code, text, _, _ in IN_SDF_OF_A_URDF:
        yield SeededFault(name=f"{code} in SDF of a URDF", code=code, text=text)


def changed(text: str, *changes: tuple[str, str]) -> str:
    """A text with the first place of each change replaced.

    Raises:
        ValueError: A text to replace is not there.
    """
    for old, new in changes:
        if old not in text:
            raise ValueError(f"there is no {old!r} to replace")
        text = text.replace(old, new, 1)
    return text
