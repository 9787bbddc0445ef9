"""Files of ros_gz_bridge: topics have the names and types that they have in ROS."""

import pytest
from tests.devices.drives.carts import cart_sdf

import cartwheel as cw
from cartwheel.codes import devices
from cartwheel.dialects.gz.bridge_file import read_bridge
from cartwheel.errors import CartwheelError

DRIVE = """<plugin filename="gz-sim-diff-drive-system" name="d">
  <left_joint>left_joint</left_joint><right_joint>right_joint</right_joint>
  <wheel_separation>0.4</wheel_separation><wheel_radius>0.1</wheel_radius></plugin>"""
CAMERA = """<model name="eye"><static>true</static><link name="l"><sensor name="s" type="camera">
  <topic>front-eye/image</topic><update_rate>10</update_rate><camera><image><width>8</width>
  <height>8</height></image></camera></sensor></link></model>"""


@pytest.fixture
def bridged(tmp_path):
    """A world of models, all of it in a file, with the topics that a bridge makes of them."""
    worlds = []

    def made(entries, *models, version="1.9"):
        file, bridge = tmp_path / "w.sdf", tmp_path / "bridge.yaml"
        file.write_text(f'<sdf version="{version}"><world name="w">{"".join(models)}</world></sdf>')
        bridge.write_text(entries)
        world = cw.World(file, bridge=[bridge])
        world.session.report_unbridged()
        worlds.append(world)
        return world

    yield made
    for each in worlds:
        each.close()


def cart():
    return cart_sdf({"left": (0, 0.2), "right": (0, -0.2)}, DRIVE)


def topics(world):
    return {topic.name: topic.type for topic in world.graph.topics()}


def reported(world):
    return [d.message for d in world.diagnostics if d.severity != "info"]


def test_topics_have_their_names_in_ros_and_commands_their_types(bridged):
    world = bridged(
        """
- ros_topic_name: /clock
  gz_topic_name: /world/w/clock
  ros_type_name: rosgraph_msgs/msg/Clock
- ros_topic_name: drive
  gz_topic_name: /model/cart/cmd_vel
  ros_type_name: geometry_msgs/msg/TwistStamped
  gz_type_name: gz.msgs.Twist
  direction: ROS_TO_GZ
- {ros_topic_name: /odom, gz_topic_name: model/cart/odometry, ros_type_name: nav_msgs/Odometry}
""",
        cart(),
    )
    assert reported(world) == []
    assert topics(world) == {
        "/clock": "rosgraph_msgs/msg/Clock",
        "/drive": "geometry_msgs/msg/TwistStamped",
        "/odom": "nav_msgs/msg/Odometry",
        "/model/cart/tf": "tf2_msgs/msg/TFMessage",
    }
    box = world.mailbox("/odom", size=1)
    world.publish("/drive", twist={"linear": {"x": 0.3}})
    world.run(1.0)
    (message,) = box.drain()
    assert message.twist.twist.linear.x == pytest.approx(0.3, rel=0.02)


def test_what_stands_beside_an_image_goes_with_it(bridged):
    # A dash is a letter of Gazebo's and none of ROS's.
    world = bridged(
        "- {ros_topic_name: /front/rgb, gz_topic_name: /front-eye/image, "
        "ros_type_name: sensor_msgs/msg/Image}",
        CAMERA,
    )
    assert reported(world) == []
    assert set(topics(world)) >= {"/front/rgb", "/front/rgb/compressed", "/front_eye/camera_info"}


def test_what_has_no_effect_is_reported(bridged):
    world = bridged(
        """- {topic_name: /model/cat/cmd_vel, ros_type_name: geometry_msgs/msg/Twist}
- ros_topic_name: /a
  gz_topic_name: /model/cart/odometry
  ros_type_name: nav_msgs/msg/Path
- ros_topic_name: /b
  gz_topic_name: /model/cart/odometry
  ros_type_name: nav_msgs/msg/Odometry
""",
        cart(),
    )
    warnings = [d for d in world.diagnostics if d.severity == "warning"]
    assert all(d.code is devices.BRIDGE_ENTRY_IGNORED for d in warnings)
    assert [(d.origin.line, d.values["ros"]) for d in warnings] == [
        (5, "/b"),
        (1, "/model/cat/cmd_vel"),
        (2, "/a"),
    ]


@pytest.mark.wording
@pytest.mark.parametrize(
    ("topic", "who"),
    [
        ("/world/default/dynamic_pose/info", "Cartwheel does not publish"),
        ("/world/other/pose/info", "Cartwheel does not publish"),
        ("/model/cat/pose", "no plugin uses"),
    ],
)
def test_topics_that_gz_itself_publishes(bridged, topic, who):
    world = bridged(
        f"- {{ros_topic_name: /poses, gz_topic_name: {topic}, "
        "ros_type_name: tf2_msgs/msg/TFMessage}",
        cart(),
    )
    (found,) = reported(world)
    assert found.startswith(f'{who} the topic "{topic}"')


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("a: 1", 0),
        ("- [", 1),
        ("- one", 1),
        ("\n- {ros_topic_name: /a}", 2),
        ("- {topic_name: <ns>/a, ros_type_name: a/msg/B}", 1),
    ],
)
def test_a_file_that_cannot_be_used(text, line, tmp_path):
    file = tmp_path / "bridge.yaml"
    file.write_text(text)
    with pytest.raises(CartwheelError) as raised:
        read_bridge(file)
    assert raised.value.code is devices.BRIDGE_FILE_INVALID
    assert (raised.value.origin.file, raised.value.origin.line) == (str(file), line)


def test_a_file_that_is_empty_or_missing(tmp_path):
    file = tmp_path / "bridge.yaml"
    with pytest.raises(CartwheelError) as caught:
        read_bridge(file)
    assert caught.value.code is devices.BRIDGE_FILE_INVALID
    file.write_text("---\n")
    assert read_bridge(file) == []


def test_the_axis_of_a_joint_is_left_out_as_in_the_topic_of_its_controller(bridged):
    joint = """<plugin filename="gz-sim-joint-position-controller-system" name="p">
      <joint_name>left_joint</joint_name></plugin>"""
    world = bridged(
        """
- ros_topic_name: /wheel/target
  gz_topic_name: /model/cart/joint/left_joint/0/cmd_pos
  ros_type_name: std_msgs/msg/Float64
""",
        cart_sdf({"left": (0, 0.2), "right": (0, -0.2)}, joint),
    )
    assert "/wheel/target" in topics(world)
    assert reported(world) == []
