"""The macros of the stand-ins: their frames are at the documented places, their sensors publish."""

import re
from pathlib import Path

import pytest
from tests.coded import coded
from tests.standins.calls import Call, on_base
from tests.standins.cameras import CAMERAS
from tests.standins.lasers import LASERS

import cartwheel as cw
from cartwheel.codes.files import STAND_IN_USED
from cartwheel.description import load_text
from cartwheel.description.files.package_folders import package_name, stand_ins
from cartwheel.description.model import RobotDescription
from cartwheel.geometry import Pose, rotate

CALLS = [*CAMERAS, *LASERS]
BASE = """<link name="base_link">
  <inertial><mass value="20"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><origin xyz="0 0 0.1"/><geometry><box size="1 1 0.2"/></geometry></collision></link>"""
HUNG = """<joint name="hung" type="fixed"><parent link="base_link"/><child link="{}"/>
  <origin xyz="0.1 0 0.2"/></joint>"""


_ROBOTS: dict[int, RobotDescription] = {}
"""By the identity of the call: the tests of frames and of topics read the same robots."""


def robot_of(call: Call) -> RobotDescription:
    if id(call) not in _ROBOTS:
        _ROBOTS[id(call)] = _read(call)
    return _ROBOTS[id(call)]


def _read(call: Call) -> RobotDescription:
    package, path = call.file.split("/", 1)
    robot = load_text(
        f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{BASE}'
        f'<xacro:include filename="$(find {package})/{path}"/>{call.text}'
        f"{HUNG.format(call.hung) if call.hung else ''}</robot>"
    )
    assert isinstance(robot, RobotDescription)
    return robot


def poses_of(robot: RobotDescription) -> dict[str, Pose]:
    """The pose of each link relative to ``base_link``, with all joints at zero."""
    base = robot.link("base_link").pose.inverse()
    return {link.name: base @ link.pose for link in robot.links}


@pytest.mark.parametrize("call", CALLS, ids=str)
def test_frames(call):
    robot = robot_of(call)
    (used,) = coded(robot, STAND_IN_USED)
    assert used.values["package"] == call.file.split("/")[0]
    assert used.severity == "info"
    assert [each for each in robot.diagnostics if each.severity != "info"] == []
    poses = poses_of(robot)
    for frame, position in call.frames.items():
        assert poses[frame].position == pytest.approx(position, abs=2e-5), frame
    for frame in call.optical:
        rotation = poses[frame].orientation
        # The colour lens of the Astra is turned by 0.003 rad.
        assert rotate(rotation, (0, 0, 1)) == pytest.approx((1, 0, 0), abs=0.005), frame
        assert rotate(rotation, (1, 0, 0)) == pytest.approx((0, -1, 0), abs=0.005), frame


@pytest.mark.parametrize("call", CALLS, ids=str)
def test_topics(call, make):
    world: cw.World = make.world()
    world.session.spawn(robot_of(call), pose=Pose((0, 0, 0.2)))
    boxes = {topic: world.mailbox(topic) for topic in call.topics}
    frames: dict[str, set[str]] = {}
    # The slowest sensors publish at 5 Hz. Cameras need not render on.
    while len(frames) < len(boxes) and world.time < 0.21:
        world.run(0.01)
        for topic, box in boxes.items():
            if topic not in frames and (messages := box.drain()):
                frames[topic] = {m.header.frame_id for m in messages}
                box.close()
    assert frames == {topic: {frame} for topic, frame in call.topics.items()}
    assert [each for each in world.diagnostics if each.severity != "info"] == []


def test_every_macro_is_called():
    """Except those that other stand-ins are made of, and those that tests of others call."""
    defined = set()
    for file in stand_ins().rglob("*.xacro"):
        defined |= set(re.findall(r'<xacro:macro name="(?!stand_in_)([\w-]+)"', file.read_text()))
    for file in stand_ins().rglob("*.xacro"):
        defined -= set(re.findall(r"<xacro:([\w-]+) ", file.read_text()))
    tests = Path(__file__).parent.glob("test_*.py")
    texts = [*(call.text for call in CALLS), *(file.read_text() for file in tests)]
    called = {name for text in texts for name in re.findall(r"<xacro:([\w-]+)", text)}
    assert defined - called == set()


@pytest.mark.parametrize(
    "file",
    [each for each in sorted(stand_ins().rglob("*.xacro")) if each.name.startswith("test_")]
    + sorted(stand_ins().rglob("[dz]*_descr.urdf.xacro")),
    ids=lambda file: f"{file.parts[-3]}/{file.name}",
)
def test_example_robots(file):
    robot = load_text(file.read_text(), file=str(file))
    assert isinstance(robot, RobotDescription)
    assert any(link.sensors for link in robot.links)


@pytest.mark.parametrize("name", ["Black", "DarkGrey", "Grey", "LightGrey", "Orange", "White"])
def test_constants_and_materials_of_pal(name):
    robot = load_text(
        f'<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{BASE}'
        '<xacro:include filename="$(find pal_urdf_utils)/urdf/deg_to_rad.urdf.xacro"/>'
        '<xacro:include filename="$(find pal_urdf_utils)/urdf/materials.urdf.xacro"/>'
        f'<link name="a"><visual><origin rpy="${{90 * deg_to_rad}} 0 0"/><geometry>'
        f'<sphere radius="1"/></geometry><material name="{name}"/></visual></link>'
        '<joint name="j" type="fixed"><parent link="base_link"/><child link="a"/></joint></robot>'
    )
    assert isinstance(robot, RobotDescription)
    (used,) = coded(robot, STAND_IN_USED)
    assert list(robot.diagnostics) == [used]
    visual = robot.link("a").visuals[0]
    assert visual.material is not None and visual.material.diffuse is not None
    assert rotate(visual.pose.orientation, (0, 1, 0)) == pytest.approx((0, 0, 1))


def test_each_folder_is_the_package_of_its_name():
    folders = [each for each in stand_ins().iterdir() if each.is_dir()]
    assert len(folders) >= 14
    for folder in folders:
        assert package_name(folder) == folder.name


REALSENSE_PLUGIN = """<gazebo reference="camera_link">
  <sensor name="color" type="camera"><update_rate>30</update_rate>{image}</sensor>
  <sensor name="ired1" type="camera"><update_rate>30</update_rate>{image}</sensor>
  <sensor name="ired2" type="camera"><update_rate>30</update_rate>{image}</sensor>
  <sensor name="depth" type="depth"><update_rate>30</update_rate>{image}</sensor>
</gazebo>
<gazebo><plugin name="camera" filename="librealsense_gazebo_plugin.so">
  <colorTopicName>color/image_raw</colorTopicName>
  <colorOpticalframeName>camera_color_optical_frame</colorOpticalframeName>
</plugin></gazebo>""".format(
    image="<camera><horizontal_fov>1.2</horizontal_fov><image><width>64</width><height>48</height>"
    "</image><clip><near>0.1</near><far>10</far></clip></camera>"
)


def test_realsense_gazebo_plugin(make):
    """The plugin's sensors replace those of the stand-in, and its frames are there."""
    call = Call(
        "realsense2_description/urdf/_d435.urdf.xacro",
        on_base("sensor_d435", 'use_nominal_extrinsics="true"') + REALSENSE_PLUGIN,
        {},
    )
    world: cw.World = make.world()
    world.session.spawn(_read(call), pose=Pose((0, 0, 0.2)))
    box = world.mailbox("/camera/color/image_raw")
    world.run(0.1)
    message = box.drain()[0]
    assert (message.header.frame_id, message.width) == ("camera_color_optical_frame", 64)
    assert "/camera/infra1/image_rect_raw" not in {t.name for t in world.session.graph.topics()}
