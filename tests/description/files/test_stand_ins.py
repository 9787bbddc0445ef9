"""Stand-ins for packages that are not installed: when they are used, and what is reported."""

import pytest
from tests.coded import coded, raises

from cartwheel.checks import check
from cartwheel.codes import files
from cartwheel.description import load
from cartwheel.description.files.package_folders import stand_in_name, stand_ins
from cartwheel.description.files.packages import Packages

NS = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
OWN = "<package><name>realsense2_description</name></package>"
D435 = "$(find realsense2_description)/urdf/_d435.urdf.xacro"
CALL = '<xacro:sensor_d435 parent="base"><origin xyz="1 0 0"/></xacro:sensor_d435>'
LINK = '<link name="base"/>'


@pytest.fixture
def load_robot(tmp_path):
    """Loads a robot in a workspace from the elements in its xacro file."""

    def made(*elements):
        file = tmp_path / "src" / "mine" / "urdf" / "robot.xacro"
        file.parent.mkdir(parents=True, exist_ok=True)
        (file.parents[1] / "package.xml").write_text("<package><name>mine</name></package>")
        file.write_text("\n".join((f'<robot name="r" {NS}>', *elements, "</robot>")))
        return load(file)

    return made


def include(file=D435):
    return f'<xacro:include filename="{file}"/>'


def reported(robot):
    return [each.values["package"] for each in coded(robot, files.STAND_IN_USED)]


def sensors(robot):
    return {each.name for link in robot.links for each in link.sensors}


@pytest.mark.parametrize(
    "place", ["src/realsense2_description", "src/realsense-ros/description", "install/share/a"]
)
def test_a_package_nearby_wins(load_robot, tmp_path, place):
    own = tmp_path / place
    (own / "urdf").mkdir(parents=True)
    (own / "package.xml").write_text(OWN)
    (own / "urdf" / "_d435.urdf.xacro").write_text(
        f'<robot {NS}><xacro:macro name="sensor_d435" params="parent *origin">'
        '<link name="own"/></xacro:macro></robot>'
    )
    robot = load_robot(include(), CALL)
    assert [link.name for link in robot.links] == ["own"]
    assert reported(robot) == []


def test_a_folder_without_a_manifest_wins(load_robot, tmp_path):
    own = tmp_path / "src" / "realsense2_description" / "urdf"
    own.mkdir(parents=True)
    (own / "_d435.urdf.xacro").write_text(f"<robot {NS}>{LINK.replace('base', 'own')}</robot>")
    assert [link.name for link in load_robot(include()).links] == ["own"]


def test_a_package_of_the_environment_wins(tmp_path):
    own = tmp_path / "opt" / "share" / "velodyne_description"
    own.mkdir(parents=True)
    (own / "package.xml").write_text("<package><name>velodyne_description</name></package>")
    environment = {"AMENT_PREFIX_PATH": str(tmp_path / "opt")}
    file = tmp_path / "robot.xacro"
    assert Packages(file, environment=environment).find("velodyne_description") == own
    assert Packages(file, package_path=[own], environment={}).find("velodyne_description") == own
    found = Packages(file, environment={}).find("velodyne_description")
    assert found == stand_ins() / "velodyne_description"


def test_each_stand_in_is_reported_once_at_its_first_include(load_robot):
    robot = load_robot(
        LINK,
        include(),
        include("$(find realsense2_description)/urdf/_d415.urdf.xacro"),
        include("$(find velodyne_description)/urdf/VLP-16.urdf.xacro"),
        CALL,
    )
    found = coded(robot, files.STAND_IN_USED)
    assert [each.values["package"] for each in found] == [
        "realsense2_description",
        "velodyne_description",
    ]
    assert [each.origin.line for each in found] == [3, 5]
    assert {each.severity for each in found} == {"info"}


def test_a_stand_in_that_includes_another_one(load_robot):
    robot = load_robot(LINK, include("$(find realsense2_camera)/urdf/_d435.urdf.xacro"), CALL)
    assert reported(robot) == ["realsense2_camera"]


def test_check_reports_nothing_about_the_contents_of_a_stand_in(load_robot, tmp_path):
    load_robot(
        '<link name="base"><inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" '
        'ixy="0" ixz="0" iyz="0"/></inertial>'
        '<collision><geometry><box size="0.5 0.5 0.5"/></geometry></collision></link>',
        include("$(find realsense2_description)/urdf/_d435i.urdf.xacro"),
        '<xacro:sensor_d435i parent="base"><origin xyz="0.2 0 0"/></xacro:sensor_d435i>',
    )
    found = check(tmp_path / "src" / "mine" / "urdf" / "robot.xacro")
    assert [each.code for each in found.findings] == [files.STAND_IN_USED]


def test_a_file_that_the_stand_in_lacks(load_robot):
    mesh = '<link name="base"><visual><geometry><mesh filename="{}"/></geometry></visual></link>'
    for name in ("package://realsense2_description/a.stl", "$(find realsense2_description)/a.stl"):
        robot = load_robot(mesh.format(name))
        (lost,) = coded(robot, files.FILE_MISSING)
        assert (lost.values["kind"], lost.values["name"]) == ("package", "realsense2_description")
        assert reported(robot) == []


def test_a_file_that_neither_package_has():
    with raises(files.FILE_MISSING, kind="package", name="lms1xx"):
        Packages(None, environment={}).resolve("package://lms1xx/urdf/none.xacro")


def test_names_of_files():
    assert stand_in_name(stand_ins() / "lms1xx" / "urdf" / "a.xacro") == "lms1xx"
    assert stand_in_name(stand_ins() / "parts.xacro") is None
    assert stand_in_name(stand_ins().parent / "robots" / "a") is None


@pytest.mark.wording
def test_the_report(load_robot):
    robot = load_robot(LINK, include(), CALL)
    (found,) = coded(robot, files.STAND_IN_USED)
    assert "its frames, joints and sensors match, but its shapes are plain" in found.message


CAMERA = '<gazebo reference="{}"><sensor name="mine" type="camera"/></gazebo>'


@pytest.mark.parametrize("link", ["camera_link", "camera_bottom_screw_frame", "lens"])
def test_a_sensor_on_the_device_replaces_those_of_the_stand_in(load_robot, link):
    """Also if it is on a link that the robot attaches to the device."""
    lens = (
        '<link name="lens"/><joint name="l" type="fixed"><parent link="camera_link"/>'
        '<child link="lens"/></joint>'
    )
    robot = load_robot(LINK, include(), CALL, lens, CAMERA.format(link))
    assert sensors(robot) == {"mine"}
    # The frames are those of the original package, too.
    assert {each.name for each in robot.links} == {
        "base", "camera_bottom_screw_frame", "camera_link", "lens"
    }  # fmt: skip
    assert "driver_of" not in robot.text


def test_a_sensor_elsewhere_replaces_nothing(load_robot):
    robot = load_robot(LINK, include(), CALL, CAMERA.format("base"))
    assert sensors(robot) == {"mine", "camera_color", "camera_depth", "camera_infra2"}
    assert "driver_of" not in robot.text
    assert robot.link("camera_color_optical_frame") is not None


def test_a_material_on_the_device_replaces_nothing(load_robot):
    plain = '<gazebo reference="camera_link"><material>Gazebo/Grey</material></gazebo>'
    assert "camera_depth" in sensors(load_robot(LINK, include(), CALL, plain))


def test_a_frame_of_the_robot_replaces_those_of_the_driver(load_robot):
    """The robot's description would otherwise contain a link twice."""
    own = (
        '<link name="camera_depth_frame"/><joint name="d" type="fixed">'
        '<parent link="camera_link"/><child link="camera_depth_frame"/></joint>'
    )
    robot = load_robot(LINK, include(), CALL, own)
    assert sensors(robot) == set()
    assert robot.joint("d") is not None


def test_two_devices_are_independent(load_robot):
    other = CALL.replace("<xacro:sensor_d435 ", '<xacro:sensor_d435 name="rear" ')
    robot = load_robot(LINK, include(), CALL, other, CAMERA.format("rear_link"))
    assert sensors(robot) == {"mine", "camera_color", "camera_depth", "camera_infra2"}


def test_a_macro_in_a_namespace(load_robot):
    robot = load_robot(
        LINK,
        f'<xacro:include filename="{D435}" ns="intel"/>',
        CALL.replace("xacro:sensor", "xacro:intel.sensor"),
    )
    assert robot.link("camera_link") is not None


def test_a_macro_that_the_stand_in_lacks_is_left_out(load_robot):
    robot = load_robot(LINK, include(), CALL, '<xacro:sensor_t265 parent="base" name="t"/>')
    (lost,) = coded(robot, files.MACRO_ABSENT)
    assert lost.values["package"] == "realsense2_description"
    assert robot.link("camera_link") is not None


def test_a_parameter_that_the_stand_in_lacks_is_ignored(load_robot):
    robot = load_robot(LINK, include(), CALL.replace(' parent="base"', ' parent="base" colour="1"'))
    (ignored,) = coded(robot, files.STAND_IN_PARAMETER)
    assert ignored.values == {
        "package": "realsense2_description",
        "name": "colour",
        "macro": "xacro:sensor_d435",
    }
    assert robot.link("camera_link") is not None


def test_a_parameter_that_another_macro_lacks_is_an_error(load_robot):
    with raises(files.MACRO_CALL_INVALID, name="b"):
        load_robot(LINK, '<xacro:macro name="m" params="a"/>', '<xacro:m a="1" b="2"/>')


@pytest.mark.parametrize("own", ["", '<link name="base_link"/><link name="more"/>'])
def test_the_base_of_an_example_robot_is_spare(load_robot, own):
    joint = (
        '<joint name="j" type="fixed"><parent link="base_link"/><child link="more"/></joint>'
        if own
        else ""
    )
    test = include("$(find realsense2_camera)/urdf/test_d435_camera.urdf.xacro")
    robot = load_robot(own, test, joint)
    assert [each.name for each in robot.links].count("base_link") == 1
    assert "if_undefined" not in robot.text
    assert "camera_depth" in sensors(robot)


def test_the_sensors_that_the_original_package_does_not_contain_are_named(load_robot):
    (found,) = coded(load_robot(LINK, include(), CALL), files.STAND_IN_USED)
    assert set(found.values["added_sensors"]) == {"camera_color", "camera_depth", "camera_infra2"}
    own = load_robot(LINK, include(), CALL, CAMERA.format("camera_link"))
    (found,) = coded(own, files.STAND_IN_USED)
    assert found.values["added_sensors"] == ()
