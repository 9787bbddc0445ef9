"""Descriptions whose arguments select the plugins of one Gazebo, and launch files that state
them.
"""

import pytest

from cartwheel.checks.checking import check
from cartwheel.codes.devices import PLUGIN_OF_OTHER_GAZEBO
from cartwheel.description.launches import launches_near

XACRO = """<robot name="cart" xmlns:xacro="http://wiki.ros.org/xacro">
  <xacro:arg name="gazebo" default="classic"/>
  <link name="base"><inertial><mass value="1"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><box size="1 1 1"/></geometry></collision></link>
  <xacro:if value="${{'$(arg gazebo)' == 'classic'}}">
    <gazebo><plugin name="p" filename="libgazebo_ros_planar_move.so"/></gazebo>
  </xacro:if>
  <xacro:if value="${{'$(arg gazebo)' == 'ignition'}}">
    <gazebo><plugin name="gz::sim::systems::VelocityControl"
      filename="gz-sim-velocity-control-system"/></gazebo>
  </xacro:if>
  {more}
</robot>
"""
ALWAYS = '<gazebo><plugin name="q" filename="libgazebo_ros_p3d.so"/></gazebo>'
LAUNCH = """<launch>
  <arg name="simulator" default="{default}"/>
  <node pkg="robot_state_publisher" exec="robot_state_publisher">
    <param name="robot_description"
      value="$(command 'xacro $(find-pkg-share cart)/cart.urdf.xacro gazebo:={stated}')"/>
  </node>
  <node pkg="gazebo_ros" exec="spawn_entity.py" args="-topic robot_description"
    if="$(eval '&quot;$(var simulator)&quot; == &quot;classic&quot;')"/>
  <node pkg="ros_gz_sim" exec="create" args="-topic robot_description"
    if="$(eval '&quot;$(var simulator)&quot; == &quot;ignition&quot;')"/>
</launch>
"""


def robot(tmp_path, default, stated, more=""):
    """A robot that a launch file starts in Gazebo, with an argument for its description."""
    (tmp_path / "launch").mkdir()
    (tmp_path / ".git").mkdir()
    (tmp_path / "package.xml").write_text("<package><name>cart</name></package>")
    launch = LAUNCH.format(default=default, stated=stated)
    (tmp_path / "launch" / "sim.launch.xml").write_text(launch)
    path = tmp_path / "cart.urdf.xacro"
    path.write_text(XACRO.format(more=more))
    return path


def found(path, **arguments):
    findings = check(path, arguments=arguments).findings
    return [each.values["plugin"] for each in findings if each.code is PLUGIN_OF_OTHER_GAZEBO]


PLANAR = "libgazebo_ros_planar_move.so"


@pytest.mark.parametrize(
    ("stated", "more", "expected"),
    [
        ("ignition", "", []),
        ("classic", "", [PLANAR]),
        # This plugin is not selected.
        ("ignition", ALWAYS, ["libgazebo_ros_p3d.so"]),
    ],
)
def test_plugins_are_those_with_the_arguments_of_the_launch_file(tmp_path, stated, more, expected):
    """The launch file starts gz-sim, and the default of the description is Gazebo Classic."""
    path = robot(tmp_path, "ignition", stated, more)
    # It states no other Gazebo: see below.
    launch = tmp_path / "launch" / "sim.launch.xml"
    launch.write_text(launch.read_text().replace('pkg="gazebo_ros"', 'pkg="other"'))
    assert found(path) == expected


def test_arguments_of_the_user_select_plugins_that_no_launch_file_starts(tmp_path):
    path = robot(tmp_path, "classic", "classic")
    launch = tmp_path / "launch" / "sim.launch.xml"
    launch.write_text(launch.read_text().replace('pkg="ros_gz_sim"', 'pkg="other"'))
    assert found(path, gazebo="ignition") == []
    assert found(path) == []


@pytest.mark.parametrize("default", ["classic", "ignition"])
def test_a_launch_file_whose_argument_selects_a_gazebo_starts_each(tmp_path, default):
    path = robot(tmp_path, default, "$(var simulator)", ALWAYS)
    assert {kind for use in launches_near(tmp_path) for kind in use.gazebos} == {"classic", "gz"}
    assert found(path) == []
