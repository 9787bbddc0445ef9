"""Joints whose axis has length 0: Gazebo Classic's ODE uses the x axis of the world."""

import pytest

import cartwheel
from cartwheel.api import World
from cartwheel.codes.robot import AXIS_ZERO
from cartwheel.corpus import try_robot
from cartwheel.description import load_text
from cartwheel.description.launches import launches_near
from cartwheel.errors import DescriptionError

ROBOT = """<robot name="r">
<link name="base">{mass}</link>
<link name="arm">{mass}</link>
<joint name="turn" type="continuous"><parent link="base"/><child link="arm"/>
<origin rpy="0 0 1.5707963"/>
<axis xyz="0 0 0"/></joint>
<gazebo{reference}>{plugins}</gazebo>
</robot>"""
MASS = (
    '<inertial><mass value="1"/>'
    '<inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>'
)
CLASSIC = '<plugin name="p" filename="libgazebo_ros_p3d.so"><bodyName>base</bodyName></plugin>'
CAMERA = (
    '<sensor name="s" type="camera"><plugin name="p" filename="libgazebo_ros_camera.so"/></sensor>'
)
GZ = '<plugin name="q" filename="gz-sim-pose-publisher-system"/>'


def text(plugins, reference=""):
    return ROBOT.format(mass=MASS, plugins=plugins, reference=reference)


@pytest.mark.parametrize(
    ("plugins", "reference"),
    [
        (CLASSIC, ""),
        (CAMERA, ' reference="arm"'),
        # They may be for Gazebo Classic.
        ("", ""),
        (CLASSIC + GZ, ""),
        ('<plugin name="q" filename="libown.so"/>', ""),
    ],
)
def test_the_axis_is_that_of_the_world_in_gazebo_classic(plugins, reference):
    """The joint is turned by 90° about z, so the x axis of the world is its -y axis."""
    robot = load_text(text(plugins, reference))
    assert robot.joint("turn").axis.xyz == pytest.approx((0, -1, 0), abs=1e-6)
    (found,) = (each for each in robot.diagnostics if each.code is AXIS_ZERO)
    assert (found.severity, found.origin.line) == ("warning", 6)
    assert found.values["joint"] == "turn"


def test_the_joint_turns_about_the_x_axis_of_the_world():
    with World("empty") as world:
        model = world.spawn(load_text(text(CLASSIC)), z=1.0)
        world.run(0.1)
        axis = world.session.simulation.data.joint("r::turn").xaxis
        assert abs(axis[0]) == pytest.approx(1, abs=1e-3), model


def test_gz_sim_does_not_load_such_a_robot():
    with pytest.raises(DescriptionError) as raised:
        load_text(text(GZ))
    assert raised.value.code is AXIS_ZERO


LAUNCH = """<launch><node pkg="ros_gz_sim" exec="create" args="-file $(find-pkg-share r)/r.urdf"/>
</launch>"""


@pytest.mark.parametrize("package", ["ros_gz_sim", "gazebo_ros"])
def test_a_launch_file_shows_for_which_gazebo_a_robot_is(tmp_path, package):
    (tmp_path / "package.xml").write_text("<package><name>r</name></package>")
    (tmp_path / "launch").mkdir()
    program = "create" if package == "ros_gz_sim" else "spawn_entity.py"
    start = LAUNCH.replace("ros_gz_sim", package).replace("create", program)
    (tmp_path / "launch" / "start.launch.xml").write_text(start)
    path = tmp_path / "r.urdf"
    path.write_text(text(""))
    verdict = try_robot(path, standing=0.1, launches=launches_near(tmp_path))
    assert verdict.loaded
    faults = [(each.test, each.code) for each in verdict.faults if each.test == "load"]
    assert faults == ([("load", AXIS_ZERO)] if package == "ros_gz_sim" else [])


def test_check_reports_the_axis_once_as_an_error(tmp_path):
    path = tmp_path / "r.urdf"
    path.write_text(text(CLASSIC))
    (found,) = (each for each in cartwheel.check(path).findings if each.code is AXIS_ZERO)
    assert found.severity == "error"


MODEL = """<sdf version="{version}"><model name="m"><link name="base"/>
<link name="arm"><pose>0 0 0 0 0 1.5707963</pose></link>
<joint name="turn" type="revolute"><parent>base</parent><child>arm</child>
<axis><xyz>0 0 0</xyz>{frame}</axis></joint>
{plugins}</model></sdf>"""
IN_MODEL = "<use_parent_model_frame>1</use_parent_model_frame>"


@pytest.mark.parametrize("frame", ["", IN_MODEL])
@pytest.mark.parametrize(("version", "plugins"), [("1.6", CLASSIC), ("1.6", ""), ("1.8", CLASSIC)])
def test_a_model_that_may_be_for_gazebo_classic_is_loaded(frame, version, plugins):
    model = MODEL.format(version=version, frame=frame, plugins=plugins)
    robot = load_text(model)
    assert robot.joint("turn").axis.xyz == pytest.approx((0, -1, 0), abs=1e-6)
    assert [each.severity for each in robot.diagnostics if each.code is AXIS_ZERO] == ["warning"]


@pytest.mark.parametrize(("version", "plugins"), [("1.8", ""), ("1.6", GZ)])
def test_a_model_for_gz_sim_is_not_loaded(version, plugins):
    with pytest.raises(DescriptionError) as raised:
        load_text(MODEL.format(version=version, frame="", plugins=plugins))
    assert raised.value.code is AXIS_ZERO
