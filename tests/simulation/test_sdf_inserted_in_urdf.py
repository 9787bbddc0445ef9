"""What a URDF's ``<gazebo>`` inserts as SDF acts like any other part of a robot."""

import numpy as np
import pytest

from cartwheel.description import load_text

BASE = """<link name="base"><inertial><mass value="20"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><geometry><box size="0.4 0.3 0.1"/></geometry></collision></link>
  <link name="mast"/><joint name="weld" type="fixed"><parent link="base"/><child link="mast"/>
  <origin xyz="0.1 0 0.05"/></joint>"""


def robot(inserted):
    return load_text(
        f'<robot name="cart">{BASE}<gazebo>{inserted}</gazebo></robot>', file="cart.urdf"
    )


def test_a_laser_reads_its_distance_to_a_wall(make, read):
    """It stands 0.3 m before the base and turned left: the wall's face is at y = 2."""
    scanner = """
      <link name="laser"><pose>0.3 0.25 0.3 0 0 1.5707963267948966</pose>
        <inertial><mass>0.1</mass><inertia><ixx>1e-4</ixx><iyy>1e-4</iyy><izz>1e-4</izz></inertia>
        </inertial>
        <sensor name="s" type="ray"><update_rate>10</update_rate><ray><scan><horizontal>
          <samples>3</samples><min_angle>-0.5</min_angle><max_angle>0.5</max_angle></horizontal>
          </scan><range><min>0.1</min><max>10</max></range></ray>
          <plugin name="p" filename="libgazebo_ros_laser.so"><topicName>/scan</topicName>
          <frameName>laser</frameName></plugin></sensor></link>
      <joint name="laser_joint" type="fixed"><parent>mast</parent><child>laser</child></joint>"""
    wall = make.sdf(
        """<model name="wall"><static>true</static><pose>0 2.5 0 0 0 0</pose><link name="link">
        <collision name="c"><geometry><box><size>20 1 20</size></box></geometry></collision>
        </link></model>"""
    )
    world = make.world(wall, robot(scanner), ground=None, gravity=0.0)
    message = read(world, "/scan", 0.2)[-1]
    across = 1.75 / np.cos(0.5)
    assert message.ranges == pytest.approx([across, 1.75, across], rel=1e-4)
    assert message.header.frame_id == "laser"


def test_wheels_turn_as_their_drive_is_commanded(make):
    wheels = "".join(
        f"""<link name="{side}_wheel"><pose>0 {y} 0 -1.5707963267948966 0 0</pose>
          <inertial><mass>0.5</mass><inertia><ixx>2e-3</ixx><iyy>2e-3</iyy><izz>2.5e-3</izz></inertia>
          </inertial><collision name="c"><geometry><cylinder><radius>0.1</radius>
          <length>0.04</length></cylinder></geometry></collision></link>
        <joint name="{side}" type="continuous"><parent>base</parent><child>{side}_wheel</child>
          <axis><xyz>0 0 1</xyz></axis></joint>"""
        for side, y in (("left", 0.2), ("right", -0.2))
    )
    drive = """<plugin name="d" filename="libgazebo_ros_diff_drive.so"><leftJoint>left</leftJoint>
      <rightJoint>right</rightJoint><wheelSeparation>0.4</wheelSeparation>
      <wheelDiameter>0.2</wheelDiameter><wheelTorque>20</wheelTorque>
      <robotBaseFrame>base</robotBaseFrame><robotNamespace>/robot</robotNamespace></plugin>"""
    world = make.world(robot(wheels + drive), ground=None, gravity=0.0)
    world.publish("/robot/cmd_vel", linear_x=0.3, angular_z=0.5)
    world.run(1.0)
    data = world.session.simulation.data
    speeds = [data.joint(f"cart::{side}").qvel[0] for side in ("left", "right")]
    # (v ∓ ω s / 2) / r
    assert speeds == pytest.approx([2.0, 4.0], rel=1e-3)
