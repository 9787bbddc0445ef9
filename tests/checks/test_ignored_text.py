"""Tags and texts that Gazebo does not read, or reads in another way than they look."""

import pytest

from cartwheel.checks import check
from cartwheel.codes.robot import JOINTS_UNDRIVEN
from cartwheel.codes.tags import GAZEBO_IGNORES, NOT_SIMULATED, TAG_IGNORED

BODY = (
    '<link name="body"><inertial><mass value="1"/>'
    '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial><visual>{}'
    '<geometry><box size="1 1 1"/></geometry></visual></link>'
)


@pytest.fixture
def found(tmp_path):
    def run(origin="", more="", depend=""):
        file = tmp_path / "cart.urdf"
        (tmp_path / "package.xml").write_text(f"<package><name>cart</name>{depend}</package>")
        file.write_text(f'<robot name="cart">{BODY.format(origin)}{more}</robot>')
        return check(file).findings

    return run


def ignored(findings):
    return [each for each in findings if each.code is TAG_IGNORED]


def test_attributes_behind_a_tag_are_reported(found):
    pose = """xyz="0 0 1" rpy='1.57 0 0'"""
    (each,) = ignored(found(f"<origin> {pose} </origin>"))
    assert each.severity == "warning"
    assert each.values["text"] == pose


@pytest.mark.parametrize("text", ["", "a remark", 'of size="2"', "x = y"])
def test_other_texts_are_no_attributes(found, text):
    assert not ignored(found(f'<origin xyz="0 0 1">{text}</origin>'))


def test_an_attribute_behind_a_tag_that_has_it_is_a_remark(found):
    assert not ignored(found('<origin xyz="0 0 1" rpy="0 0 0">xyz="0 0 2"</origin>'))


@pytest.mark.parametrize(
    ("tags", "severity"),
    [
        ("<mu>0.5</mu>", "warning"),
        ("<mu>0.5</mu><mu1>0.5</mu1>", "info"),
        ("<mu>0.5</mu><mu1>0.5</mu1><mu2>0.1</mu2>", "info"),
    ],
)
def test_the_friction_that_gazebo_ignores_matters_if_no_other_is_stated(found, tags, severity):
    findings = found(more=f'<gazebo reference="body">{tags}</gazebo>')
    (each,) = [each for each in findings if each.code is GAZEBO_IGNORES]
    assert each.severity == severity
    # Its fix would state the other tags twice.
    assert bool(each.instead) == (severity == "warning")


def test_a_plugin_in_a_visual_is_known_and_has_no_effect(found):
    plugin = '<visual><plugin name="p" filename="libforce_arrows.so"/></visual>'
    codes = [each.code for each in found(more=f'<gazebo reference="body">{plugin}</gazebo>')]
    assert NOT_SIMULATED in codes
    assert TAG_IGNORED not in codes


ARM = (
    '<link name="arm"/><joint name="elbow" type="revolute"><parent link="body"/>'
    '<child link="arm"/><axis xyz="0 1 0"/>'
    '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>'
)
TRANSMISSION = (
    '<transmission name="t"><type>transmission_interface/SimpleTransmission</type>'
    '<joint name="elbow"/></transmission>'
)
SYSTEM = '<ros2_control name="s" type="system"><joint name="elbow"/></ros2_control>'


@pytest.mark.parametrize(
    ("depend", "more", "advice", "refused"),
    [
        ("catkin", TRANSMISSION, "libgazebo_ros_control.so", "ros2"),
        ("ament_cmake", TRANSMISSION, "gz_ros2_control", "libgazebo_ros_control.so"),
        ("ament_cmake", SYSTEM, "libgazebo_ros2_control.so", "libgazebo_ros_control.so"),
        ("ament_cmake", "", "gz_ros2_control", "gazebo_ros_control"),
    ],
)
@pytest.mark.wording
def test_the_advice_for_joints_without_a_plugin_is_for_the_ros_of_the_package(
    found, depend, more, advice, refused
):
    depend = f"<buildtool_depend>{depend}</buildtool_depend>"
    findings = found(more=ARM + more, depend=depend)
    (each,) = [each for each in findings if each.code is JOINTS_UNDRIVEN]
    assert advice in each.hint
    assert refused not in each.hint
