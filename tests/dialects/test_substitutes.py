"""Unsupported plugins: the nearest supported one, with the text to write."""

from dataclasses import replace

import pytest
from tests.coded import coded
from tests.devices.drives.carts import CAR, FRONT

from cartwheel.codes import devices
from cartwheel.description.model import Element, PluginTag
from cartwheel.dialects.catalogue import plugin_named
from cartwheel.dialects.substitutes import _PURPOSES, substitute
from cartwheel.errors import Origin

ORIGIN = Origin(file="robot.urdf", line=1)
SPACE = {"robotNamespace": "/fly"}


def unknown(filename, **tags):
    children = tuple(Element(tag=name, text=text, origin=ORIGIN) for name, text in tags.items())
    element = Element(tag="plugin", children=children, origin=ORIGIN)
    return PluginTag(name="own", filename=filename, element=element, origin=ORIGIN)


@pytest.mark.parametrize(
    ("filename", "supported"),
    [
        ("libmodel_diff_drive.so", "libgazebo_ros_diff_drive.so"),
        ("libMyDiffDrivePlugin.so", "libgazebo_ros_diff_drive.so"),
        ("libmy_four_skid_steer.so", "libgazebo_ros_skid_steer_drive.so"),
        ("liblivox_laser_simulation.so", "libgazebo_ros_velodyne_laser.so"),
        ("libuuv_gazebo_ros_imu_plugin.so", "libgazebo_ros_imu_sensor.so"),
        ("libuuv_gazebo_ros_pose_gt_plugin.so", "libgazebo_ros_p3d.so"),
        ("libuuv_joint_state_publisher.so", "libgazebo_ros_joint_state_publisher.so"),
        ("libgazebo_ros_controller_manager.so", "libgazebo_ros_control.so"),
        ("libfetch_gazebo_plugin.so", "libgazebo_ros_control.so"),
        ("liblinear_battery_ros_plugin.so", "gz-sim-linear-battery-plugin-system"),
        ("libRayPlugin.so", "libgazebo_ros_ray_sensor.so"),
        ("libArrayPlugin.so", None),
        ("libgazebo_ros_steer_drive.so", "libgazebo_ros_tricycle_drive.so"),
        ("libgazebo_ros_segway_drive.so", "libgazebo_ros_diff_drive.so"),
        ("libhsrb_grasp_hack.so", "libgazebo_grasp_fix.so"),
        ("libuuv_thruster_ros_plugin.so", "gz-sim-thruster-system"),
        ("libLiftDragPlugin2.so", "gz-sim-lift-drag-system"),
        ("libnormwind_plugin.so", None),
        ("libwind_plugin.so", "librotors_gazebo_wind_plugin.so"),
        ("gz-waves1-hydrodynamics-system", "gz-sim-hydrodynamics-system"),
        ("libplugin_drone.so", "gz-sim-velocity-control-system"),
        ("libhector_gazebo_quadrotor_simple_controller.so", "gz-sim-velocity-control-system"),
        # Names that contain a keyword, or nothing known.
        ("libimage_sonar_ros_plugin.so", None),
        ("libsimulation_helper.so", None),
        ("libcamera_move.so", None),
        ("libScanDockScoringPlugin.so", None),
        ("libBallShooterPlugin.so", None),
        ("", None),
    ],
)
def test_the_name_states_the_purpose(filename, supported):
    found = substitute(unknown(filename))
    assert (found and found.filename) == supported


@pytest.mark.parametrize("filename", [filename for *_, filename in _PURPOSES])
def test_substitutes_are_supported_under_that_name(filename):
    plugin = plugin_named(filename)
    assert filename in plugin.filenames
    assert not plugin.for_sensor or plugin.sensor_type


def test_values_are_copied_to_the_tags_of_the_supported_plugin():
    tag = unknown(
        "libmy_diff_drive.so",
        robotNamespace="cart",
        leftWheel="wheel_l",
        right_joint_name="wheel_r",
        wheelSeparation="0.3",
        torque="<&>",
        colour="red",
    )
    found = substitute(tag)
    assert found.text == (
        '<plugin name="own" filename="libgazebo_ros_diff_drive.so">'
        "<robotNamespace>cart</robotNamespace><leftJoint>wheel_l</leftJoint>"
        "<rightJoint>wheel_r</rightJoint><wheelSeparation>0.3</wheelSeparation>"
        "<wheelTorque>&lt;&amp;&gt;</wheelTorque></plugin>"
    )


def test_the_text_drives_the_robot(make, cart):
    """The car of another maker, whose tags have different spellings, drives with the text."""
    tags = {
        "leftFrontJoint": "front_left_joint",
        "rightFrontJoint": "front_right_joint",
        "leftRearJoint": "rear_left_joint",
        "rightRearJoint": "rear_right_joint",
        "steeringLeftJoint": "front_left_steering",
        "steeringRightJoint": "front_right_steering",
    }
    inner = "".join(f"<{name}>{text}</{name}>" for name, text in tags.items())
    own = f'<plugin name="own" filename="libour_ackermann.so">{inner}</plugin>'
    world = make.world()
    world.spawn(cart(CAR, own, forks=FRONT), z=0.1)
    (warning,) = coded(world, devices.PLUGIN_UNKNOWN)
    assert warning.values["substitute"] == "libgazebo_ros_ackermann_drive.so"
    text = substitute(unknown("libour_ackermann.so", **tags)).text
    assert "…" not in text
    other = make.world()
    other.spawn(cart(CAR, text, forks=FRONT), z=0.1)
    assert not coded(other, devices.PLUGIN_UNKNOWN)
    other.publish("/cmd_vel", linear_x=0.5)
    other.run(2.0)
    assert other.model("cart").pose.x > 0.5


@pytest.mark.parametrize(("tags", "topic"), [({}, "/cmd_vel"), (SPACE, "/fly/cmd_vel")])
def test_the_text_flies_a_drone(make, cart, tags, topic):
    text = substitute(unknown("libplugin_drone.so", **tags)).text
    world = make.world()
    world.spawn(cart({}, text), z=1.0)
    world.run(1.0)
    assert world.model("cart").pose.z == pytest.approx(1.0, abs=0.02)
    world.publish(topic, linear_x=0.4, linear_z=0.3)
    world.run(2.0)
    pose = world.model("cart").pose
    # It accelerates for less than 0.1 s.
    assert (pose.x, pose.z) == pytest.approx((0.8, 1.6), abs=0.05)


def test_a_namespace_of_ros_2_is_copied():
    space = Element(tag="namespace", text="/cart", origin=ORIGIN)
    tag = unknown("libour_lidar.so")
    element = replace(tag.element, children=(Element(tag="ros", children=(space,), origin=ORIGIN),))
    text = substitute(replace(tag, element=element)).text
    assert "<robotNamespace>/cart</robotNamespace>" in text


@pytest.mark.wording
def test_a_sensor_plugin_belongs_inside_a_sensor():
    found = substitute(unknown("libour_lidar.so"))
    assert found.sensor_type == "ray"
    inside = "<sensor type=" in found.hint(in_sensor=True)
    outside = "<sensor type=" in found.hint(in_sensor=False)
    assert (inside, outside) == (False, True)


def test_long_values_are_not_copied():
    tag = unknown("libmy_diff_drive.so", leftJoint="a" * 1000, rightJoint="b")
    assert len(substitute(tag).text) < 300
    assert len(substitute(replace(tag, name="n" * 1000)).text) < 400
    assert substitute(replace(tag, filename="x" * 10_000)) is None
