"""Several wheel pairs of a differential drive with the tags of ROS 2."""

import pytest
from tests.devices.drives.carts import (
    FOUR,
    spawn,
)

from cartwheel.codes import devices
from cartwheel.errors import PluginError
from cartwheel.geometry import Pose

TWO = {"left": (0.0, 0.15), "right": (0.0, -0.15)}


def test_ros2_drives_several_pairs_each_by_its_own_size(make, cart):
    plugin = """<plugin name="drive" filename="libgazebo_ros_diff_drive.so">
      <num_wheel_pairs>2</num_wheel_pairs>
      <left_joint>left_front_joint</left_joint><right_joint>right_front_joint</right_joint>
      <left_joint>left_rear_joint</left_joint><right_joint>right_rear_joint</right_joint>
      <wheel_separation>0.3</wheel_separation><wheel_separation>0.6</wheel_separation>
      <wheel_diameter>0.2</wheel_diameter><wheel_diameter>0.4</wheel_diameter>
      <max_wheel_torque>50</max_wheel_torque></plugin>"""
    # In the air, where nothing holds the wheels.
    world = spawn(make, cart(FOUR, plugin), Pose((0, 0, 500)), ground=None)
    world.publish("/cmd_vel", linear_x=0.5, angular_z=1.0)
    world.run(1.0)
    model, speeds = world.session.simulation, {}
    for name in FOUR:
        before = model.joint_position("cart", f"{name}_joint")
        world.run(0.1)
        speeds[name] = (model.joint_position("cart", f"{name}_joint") - before) / 0.1
    assert speeds["left_front"] == pytest.approx((0.5 - 0.15) / 0.1, rel=0.01)
    assert speeds["right_front"] == pytest.approx((0.5 + 0.15) / 0.1, rel=0.01)
    assert speeds["left_rear"] == pytest.approx((0.5 - 0.3) / 0.2, rel=0.01)
    assert speeds["right_rear"] == pytest.approx((0.5 + 0.3) / 0.2, rel=0.01)
    # ROS 2's plugin publishes only what its tags state.
    assert not {"/odom", "/tf"} & {topic.name for topic in world.graph.topics()}


def test_pairs_must_be_complete(make, cart):
    plugin = """<plugin name="drive" filename="libgazebo_ros_diff_drive.so">
      <num_wheel_pairs>2</num_wheel_pairs><left_joint>left_joint</left_joint></plugin>"""
    with pytest.raises(PluginError) as caught:
        spawn(make, cart(TWO, plugin))
    assert caught.value.code is devices.WHEELS_UNPAIRED
    assert caught.value.values == {"left": 1, "right": 1}
