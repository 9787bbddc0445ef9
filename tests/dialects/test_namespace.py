"""Which namespace a plugin's topics have, by its tag and by who spawned the model."""

import pytest

import cartwheel as cw
from cartwheel.description import load_text

ROBOT = """<robot name="{name}"><link name="base"><inertial><mass value="1"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="l"><inertial><mass value="1"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="r"><inertial><mass value="1"/>
  <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="left_joint" type="continuous"><parent link="base"/><child link="l"/></joint>
  <joint name="right_joint" type="continuous"><parent link="base"/><child link="r"/></joint>
  <gazebo><plugin name="d" filename="libgazebo_ros_diff_drive.so">{tag}</plugin>
    <plugin name="i" filename="libgazebo_ros_imu.so">{tag}<bodyName>base</bodyName></plugin>
  </gazebo></robot>"""


@pytest.mark.parametrize(
    ("tag", "spawner", "drive", "imu"),
    [
        ("", "", "/two/cmd_vel", "/imu"),
        ("", "/", "/cmd_vel", "/imu"),
        ("", "/r1", "/r1/cmd_vel", "/r1/imu"),
        ("<robotNamespace>/</robotNamespace>", "/r1", "/cmd_vel", "/imu"),
        ("<robotNamespace>/mine</robotNamespace>", "/r1", "/mine/cmd_vel", "/mine/imu"),
        # Gazebo's drive and cameras take the model's name for an empty tag, its IMU none.
        ("<robotNamespace></robotNamespace>", "/r1", "/two/cmd_vel", "/imu"),
        ("<ros><namespace>/two</namespace></ros>", "/r1", "/two/cmd_vel", "/two/imu"),
    ],
)
def test_the_tag_counts_before_the_spawner(tag: str, spawner: str, drive: str, imu: str) -> None:
    with cw.World("empty") as world:
        robot = load_text(ROBOT.format(name="two", tag=tag), file="two.urdf")
        world.session.spawn(robot, namespace=spawner)
        topics = {topic.name for topic in world.graph.topics()}
        assert {drive, imu} <= topics


@pytest.mark.parametrize(
    ("tag", "spawner", "prefix", "frames"),
    [
        ("", "/", "", ("odom", "base")),
        ("", "/r1", "", ("r1/odom", "r1/base")),
        ("", "/r1", "left", ("left/odom", "left/base")),
        (
            "<ros><namespace>/two</namespace></ros><publish_odom>1</publish_odom>",
            "/",
            "",
            ("odom", "base"),
        ),
    ],
)
def test_a_drive_puts_its_namespace_before_its_frames(tag, spawner, prefix, frames) -> None:
    """As gazebo_plugins does where there is no tf_prefix; its ROS 2 branch does not."""
    with cw.World("empty") as world:
        base = "<robotBaseFrame>base</robotBaseFrame>"
        robot = load_text(ROBOT.format(name="two", tag=tag + base), file="two.urdf")
        world.session.spawn(robot, namespace=spawner, frame_prefix=prefix)
        (topic,) = (t.name for t in world.graph.topics() if t.name.endswith("/odom"))
        seen = []
        world.subscribe(topic, seen.append)
        world.run(0.1)
        assert (seen[0].header.frame_id, seen[0].child_frame_id) == frames


NAMED = """<model name="two"><link name="base"/><link name="arm"><inertial><mass>1</mass>
  <inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>
  <sensor name="s" type="imu"><plugin name="i" filename="libgazebo_ros_imu_sensor.so">{tag}
  </plugin></sensor></link><joint name="j" type="continuous"><parent>base</parent>
  <child>arm</child><axis><xyz>0 0 1</xyz></axis></joint>
  <plugin name="p" filename="libgazebo_ros_joint_state_publisher.so">{tag}</plugin></model>"""


@pytest.mark.parametrize(
    ("tag", "spawner", "states", "imu"),
    [
        ("", None, "/two/joint_states", "/two/imu_data"),
        ("", "", "/two/joint_states", "/two/imu_data"),
        ("", "/", "/joint_states", "/imu_data"),
        ("", "/r1", "/r1/joint_states", "/r1/imu_data"),
        ("<robotNamespace>/</robotNamespace>", None, "/joint_states", "/imu_data"),
        ("<robotNamespace>a/b</robotNamespace>", "/r1", "/a/b/joint_states", "/a/b/imu_data"),
        ("<robotNamespace></robotNamespace>", "/r1", "/two/joint_states", "/imu_data"),
        ("<ros/>", None, "/joint_states", "/i/out"),
    ],
)
def test_two_plugins_take_the_models_name_where_nobody_says_one(make, tag, spawner, states, imu):
    """Gazebo's joint states and IMU of a sensor; spawn_model says "/" by itself."""
    model = make.sdf(NAMED.format(tag=tag))
    world = make.world(*([model] if spawner is None else []))
    if spawner is not None:
        world.session.spawn(model, namespace=spawner)
    assert {states, imu} <= {topic.name for topic in world.graph.topics()}


WHEELED = """<model name="two"><link name="base"/>{links}{joints}
  <plugin name="p" filename="libgazebo_ros_{drive}.so">{tag}</plugin></model>"""
ROS1_DRIVES = ("diff_drive", "tricycle_drive", "skid_steer_drive", "planar_move")
JOINTS = {
    "diff_drive": ("left_joint", "right_joint"),
    "tricycle_drive": (
        "front_steering_joint",
        "front_wheel_joint",
        "left_wheel_joint",
        "right_wheel_joint",
    ),
    "skid_steer_drive": tuple(f"{s}_{e}_joint" for s in ("left", "right") for e in ("f", "r")),
    "planar_move": (),
}


def wheeled(make, drive, tag):
    """A model with the default joints of a drive, or the joints that are stated here."""
    mass = "<inertial><mass>1</mass></inertial>"
    names = JOINTS[drive]
    links = "".join(f'<link name="{name}_l">{mass}</link>' for name in names)
    joints = "".join(
        f'<joint name="{name}" type="continuous"><parent>base</parent><child>{name}_l</child>'
        "<axis><xyz>0 1 0</xyz></axis></joint>"
        for name in names
    )
    if drive == "skid_steer_drive":
        reported = ("leftFrontJoint", "leftRearJoint", "rightFrontJoint", "rightRearJoint")
        tag += "".join(f"<{t}>{name}</{t}>" for t, name in zip(reported, names, strict=True))
    return make.sdf(WHEELED.format(drive=drive, tag=tag, links=links, joints=joints))


@pytest.mark.parametrize(
    ("drive", "tag", "spawner", "command"),
    [
        *((drive, "", None, "/two/cmd_vel") for drive in ROS1_DRIVES[:2]),
        # The others' source has none for a default.
        *((drive, "", None, "/cmd_vel") for drive in ROS1_DRIVES[2:]),
        *((drive, "", "/", "/cmd_vel") for drive in ROS1_DRIVES),
        *((drive, "", "/r1", "/r1/cmd_vel") for drive in ROS1_DRIVES),
        *(
            (drive, "<robotNamespace>a</robotNamespace>", None, "/a/cmd_vel")
            for drive in ROS1_DRIVES
        ),
        *((drive, "<ros/>", None, "/cmd_vel") for drive in ROS1_DRIVES[:2]),
        ("diff_drive", "<left_joint>left_joint</left_joint>", None, "/cmd_vel"),
        ("tricycle_drive", "<publish_odom>1</publish_odom>", None, "/cmd_vel"),
    ],
)
def test_two_of_gazebos_drives_take_the_name_of_a_worlds_own_model(
    make, drive, tag, spawner, command
):
    """GazeboRos, which they are made with, takes it where neither tag nor spawner says one."""
    model = wheeled(make, drive, tag)
    world = make.world(*([model] if spawner is None else []))
    if spawner is not None:
        world.session.spawn(model, namespace=spawner)
    (found,) = (topic.name for topic in world.graph.topics() if topic.name.endswith("cmd_vel"))
    assert found == command


def test_who_is_spawned_by_hand_has_no_namespace(make):
    """As spawn_model has it: its joint states are where robot_state_publisher reads them."""
    world = make.world()
    world.session.spawn(make.sdf(NAMED.format(tag="")))
    assert "/joint_states" in {topic.name for topic in world.graph.topics()}
