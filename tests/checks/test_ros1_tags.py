"""Tags of ROS 1's plugins in packages for ROS 2, which Gazebo does not read."""

import pytest

from cartwheel.checks import check
from cartwheel.codes.devices import BODY_UNKNOWN, FRAME_UNKNOWN, PLUGIN_PARAMETER_IGNORED

AMENT = "<buildtool_depend>ament_cmake</buildtool_depend>"
CATKIN = "<buildtool_depend>catkin</buildtool_depend>"
CAMERA = (
    '<robot name="cart"><link name="body"><inertial><mass value="1"/>'
    '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial></link>'
    '<gazebo reference="body"><sensor name="eye" type="camera"><camera><image><width>32</width>'
    "<height>24</height></image></camera>"
    '<plugin name="eye" filename="{filename}">{tags}</plugin></sensor></gazebo></robot>'
)


@pytest.fixture
def ignored(tmp_path):
    def run(written, depend, filename="libgazebo_ros_camera.so"):
        (tmp_path / "package.xml").write_text(f"<package><name>cart</name>{depend}</package>")
        file = tmp_path / "cart.urdf"
        file.write_text(CAMERA.format(tags=written, filename=filename))
        found = check(file).findings
        tags = [each.values["tag"] for each in found if each.code is PLUGIN_PARAMETER_IGNORED]
        # What is not read names no link.
        unknown = any(each.code is FRAME_UNKNOWN for each in found)
        assert unknown == ("frameName" in written and not tags)
        return tags

    return run


OLD = (
    "<cameraName>front</cameraName><frameName>optical</frameName><robotNamespace>a</robotNamespace>"
)


@pytest.mark.parametrize(
    ("depend", "tags", "expected"),
    [
        (AMENT, OLD, ["cameraName", "frameName", "robotNamespace"]),
        ("", f"<ros/>{OLD}", ["cameraName", "frameName", "robotNamespace"]),
        (CATKIN, OLD, []),
        ("", OLD, []),
        (AMENT, "<camera_name>front</camera_name><frame_name>body</frame_name>", []),
    ],
)
def test_tags_with_capital_letters_are_those_of_ros1(ignored, depend, tags, expected):
    assert ignored(tags, depend) == expected


@pytest.mark.parametrize(
    ("link", "frame", "unknown"),
    [
        ("/front/optical", "/front/optical", False),
        ("/front/optical", "front/optical", False),
        ("/optical", "front/optical", False),
        ("front/optical", "/front/optical", False),
        ("/front/optical", "/front/optic", True),
    ],
)
def test_the_slash_at_the_beginning_of_a_link_or_frame_does_not_count(
    tmp_path, link, frame, unknown
):
    """As in tf2."""
    file = tmp_path / "cart.urdf"
    joint = (
        f'<link name="{link}"/><joint name="j" type="fixed"><parent link="body"/>'
        f'<child link="{link}"/></joint></robot>'
    )
    camera = CAMERA.format(
        tags=f"<frameName>{frame}</frameName>", filename="libgazebo_ros_camera.so"
    )
    file.write_text(camera.replace("</robot>", joint))
    assert any(each.code is FRAME_UNKNOWN for each in check(file).findings) is unknown


@pytest.mark.parametrize(("body", "unknown"), [("/imu", False), ("/body", False), ("/i", True)])
def test_a_plugin_finds_a_link_whose_name_begins_with_a_slash(tmp_path, body, unknown):
    file = tmp_path / "cart.urdf"
    robot = CAMERA.partition("<gazebo")[0]
    file.write_text(
        f'{robot}<link name="/imu"><inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" '
        'iyy="0.1" iyz="0" izz="0.1"/></inertial></link><joint name="j" type="continuous">'
        '<parent link="body"/><child link="/imu"/></joint><gazebo><plugin name="p" '
        f'filename="libgazebo_ros_imu.so"><bodyName>{body}</bodyName></plugin></gazebo></robot>'
    )
    assert any(each.code is BODY_UNKNOWN for each in check(file).findings) is unknown


def test_a_plugin_that_the_repository_builds_may_read_any_tags(ignored, tmp_path):
    (tmp_path / ".git").mkdir()
    (tmp_path / "CMakeLists.txt").write_text("add_library(gazebo_ros_camera SHARED camera.cpp)")
    assert ignored(OLD, AMENT) == []


def test_a_tag_that_the_plugin_does_not_read_need_not_name_a_link(tmp_path):
    """The plugin of an IMU as a sensor measures at its sensor's link."""
    path = tmp_path / "robot.urdf"
    path.write_text(
        '<robot name="r"><link name="base"><inertial><mass value="1"/><inertia ixx="0.01" '
        'iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial><collision><geometry>'
        '<box size="0.2 0.2 0.2"/></geometry></collision></link><gazebo reference="base">'
        '<sensor name="imu" type="imu"><plugin name="imu" filename="libgazebo_ros_imu_sensor.so">'
        "<bodyName>none</bodyName><frameName>base</frameName></plugin></sensor></gazebo></robot>"
    )
    assert not check(path).findings
