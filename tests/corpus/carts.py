"""A cart with two wheels, driven by a plugin or by a controller of ROS 2."""

from __future__ import annotations

from pathlib import Path

TRACK, RADIUS = 0.2, 0.05
"""m."""
_BASE = (
    '<link name="base">'
    '<inertial><mass value="2"/><inertia ixx="0.02" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/>'
    '</inertial><collision><geometry><box size="0.3 0.15 0.06"/></geometry></collision></link>'
)
_WHEEL = (
    '<link name="{name}">'
    '<inertial><mass value="0.2"/><inertia ixx="1e-4" iyy="1e-4" izz="2e-4" ixy="0" '
    'ixz="0" iyz="0"/>'
    '</inertial><collision><geometry><cylinder radius="0.05" length="0.02"/></geometry>'
    "</collision></link>"
    '<joint name="{name}_joint" type="continuous"><parent link="base"/><child link="{name}"/>'
    '<origin xyz="0 {y} -0.02" rpy="-1.5708 0 0"/><axis xyz="0 0 1"/></joint>'
)
_CASTER = (
    '<link name="{name}"><collision><geometry><sphere radius="0.03"/></geometry></collision></link>'
    '<joint name="{name}_joint" type="fixed"><parent link="base"/><child link="{name}"/>'
    '<origin xyz="{x} 0 -0.04"/></joint>'
    '<gazebo reference="{name}"><mu1>{mu}</mu1><mu2>{mu}</mu2></gazebo>'
)
_PLUGIN = (
    '<gazebo><plugin name="drive" filename="libgazebo_ros_diff_drive.so"><legacyMode>false'
    "</legacyMode><leftJoint>left_joint</leftJoint><rightJoint>right_joint</rightJoint>"
    "<wheelSeparation>{separation}</wheelSeparation><wheelDiameter>0.1</wheelDiameter>"
    "{more}</plugin></gazebo>"
)
_HARDWARE = (
    '<ros2_control name="s" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem'
    '</plugin></hardware><joint name="left_joint"><command_interface name="velocity"/></joint>'
    '<joint name="right_joint"><command_interface name="velocity"/></joint></ros2_control>'
    '<gazebo><plugin name="c" filename="gz_ros2_control-system">{parameters}</plugin></gazebo>'
)
_CONTROLLER = """controller_manager:
  ros__parameters:
    base: {{type: diff_drive_controller/DiffDriveController}}
base:
  ros__parameters:
    left_wheel_names: [left_joint]
    right_wheel_names: [right_joint]
    wheel_separation: {separation}
    wheel_radius: 0.05
"""


def cart(friction: float = 0.0) -> str:
    """The links and joints. `friction` is that of the two casters."""
    wheels = _WHEEL.format(name="left", y=TRACK / 2) + _WHEEL.format(name="right", y=-TRACK / 2)
    casters = _CASTER.format(name="front", x=0.12, mu=friction)
    return _BASE + wheels + casters + _CASTER.format(name="back", x=-0.12, mu=friction)


def plugin(separation: float = TRACK, more: str = "") -> str:
    """A drive plugin of Gazebo Classic. `more` contains more tags."""
    return _PLUGIN.format(separation=separation, more=more)


def controlled(folder: Path, separation: float = TRACK, *, swapped: bool = False) -> str:
    """The hardware and the manager of a diff_drive_controller, whose file is in a folder.

    `swapped` is whether it takes the right wheel for the left one.
    """
    file = folder / "base.yaml"
    text = _CONTROLLER.format(separation=separation)
    if swapped:
        text = text.replace("[left_", "[x_").replace("[right_", "[left_").replace("[x_", "[right_")
    file.write_text(text)
    return _HARDWARE.format(parameters=f"<parameters>{file}</parameters>")


def written(folder: Path, *parts: str) -> Path:
    """The file of a robot with these parts."""
    path = folder / "robot.urdf"
    path.write_text(f'<robot name="robot">{"".join(parts)}</robot>')
    return path
