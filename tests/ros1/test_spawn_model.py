"""The program spawn_model against a node that writes down what it is asked for."""

import json
import math
import signal
from pathlib import Path

import pytest

from cartwheel.geometry import Pose

ROOT = Path(__file__).parents[2]
URDF = '<?xml version="1.0"?>\n<robot name="r"><link name="l"/></robot>\n'


@pytest.fixture
def spawn(ros):
    ros.master()
    (ros.folder / "r.urdf").write_text(URDF)
    program = ros.overlay.program("gazebo_ros", "spawn_model")

    def run(line, **options):
        return ros.run(program, *line.split(), **options)

    return run


def test_the_tutorials_command(ros, gazebo):
    ros.master()
    taking = gazebo()
    folder = ROOT / "robots" / "rosbots_description" / "launch"
    line = "-file object.urdf -urdf -x 1 -y 0 -z 1 -model my_object"
    ros.run("rosrun", "gazebo_ros", "spawn_model", *line.split(), cwd=folder)
    what, asked = taking.next()
    assert what == "urdf"
    assert asked["name"] == "my_object"
    assert asked["xml"] == (ROOT / "models" / "object.urdf").read_text()
    assert asked["position"] == [1.0, 0.0, 1.0]
    assert asked["orientation"] == [0.0, 0.0, 0.0, 1.0]
    assert (asked["frame"], asked["namespace"]) == ("", "/")


def test_all_that_says_where(spawn, gazebo):
    taking = gazebo("/other")
    spawn(
        "-sdf -file r.urdf -model m -x -1 -y 2e-1 -z .5 -R 0.3 -P -0.4 -Y 2 -reference_frame a::b"
        " -robot_namespace /mine -gazebo_namespace /other __name:=spawner __log:=/dev/null"
    )
    what, asked = taking.next()
    expected = Pose.from_xyz_rpy((-1.0, 0.2, 0.5), (0.3, -0.4, 2.0))
    assert what == "sdf"
    assert asked["position"] == list(expected.position)
    assert asked["orientation"] == pytest.approx(list(expected.orientation))
    assert (asked["frame"], asked["namespace"]) == ("a::b", "/mine")


def test_the_namespace_is_the_nodes_own_where_none_is_given(spawn, gazebo):
    taking = gazebo()
    spawn("-urdf -file r.urdf -model m", environment={"ROS_NAMESPACE": "left"})
    assert taking.next()[1]["namespace"] == "/left/"


def test_joints_are_set_and_time_goes_on_after_the_model_is_there(spawn, gazebo):
    taking = gazebo()
    spawn("-urdf -file r.urdf -model m -J elbow -0.5 -J wrist 1 -unpause")
    assert taking.next()[0] == "urdf"
    assert taking.next() == (
        "configure",
        {"name": "m", "parameter": "", "joints": ["elbow", "wrist"], "positions": [-0.5, 1.0]},
    )
    assert taking.next() == ("unpause", None)


def test_texts_from_a_parameter_and_from_standard_input(ros, spawn, gazebo):
    taking = gazebo()
    ros.run("rosparam", "set", "/robot_description", URDF)
    spawn("-urdf -param robot_description -model m")
    assert taking.next()[1]["xml"].split() == URDF.split()
    spawn("-urdf -param mine -model m mine:=robot_description")
    assert taking.next()[1]["xml"].split() == URDF.split()
    spawn("-urdf -stdin -model m", input=URDF)
    assert taking.next()[1]["xml"] == URDF


def test_a_file_says_its_encoding(ros, spawn, gazebo):
    taking = gazebo()
    text = '<?xml version="1.0" encoding="iso-8859-1"?><robot name="Käfer"><link name="l"/></robot>'
    (ros.folder / "r.urdf").write_bytes(text.encode("iso-8859-1"))
    spawn("-urdf -file r.urdf -model m")
    assert "Käfer" in taking.next()[1]["xml"]


def test_package_to_model(ros, spawn, gazebo):
    taking = gazebo()
    (ros.folder / "r.urdf").write_text(
        '<robot name="r"><link name="l"><visual><geometry>'
        '<mesh filename="package://p/a.dae"/></geometry></visual></link></robot>'
    )
    spawn("-urdf -file r.urdf -model m -package_to_model")
    assert 'filename="model://p/a.dae"' in taking.next()[1]["xml"]
    spawn("-urdf -file r.urdf -model m")
    assert 'filename="package://p/a.dae"' in taking.next()[1]["xml"]


def test_a_model_of_the_database_is_included_by_its_name(spawn, gazebo):
    taking = gazebo(mood="refuse")
    done = spawn("-sdf -database traffic_cone -model m", status=1)
    assert "<uri>model://traffic_cone</uri>" in taking.next()[1]["xml"]
    assert "GAZEBO_MODEL_PATH" in done.stderr


def test_it_waits_for_another_model(spawn, gazebo):
    taking = gazebo()
    # The node names the model "late" from the second question on.
    done = spawn("-urdf -file r.urdf -model m -wait late")
    assert "model late" in done.stdout
    assert taking.next()[0] == "urdf"


def test_it_may_be_early(ros, spawn, gazebo):
    program = ros.overlay.program("gazebo_ros", "spawn_model")
    early = ros.start(program, "-urdf", "-file", "r.urdf", "-model", "m")
    lines = iter(early.stdout.readline, "")
    assert any("which is not available yet" in line for line in lines)
    taking = gazebo()
    assert taking.next()[0] == "urdf"
    assert early.wait(timeout=60) == 0


def test_a_bond_deletes_the_model_when_it_is_interrupted(ros, spawn, gazebo):
    taking = gazebo()
    program = ros.overlay.program("gazebo_ros", "spawn_model")
    bound = ros.start(program, "-urdf", "-file", "r.urdf", "-model", "m", "-b")
    assert taking.next()[0] == "urdf"
    assert any("Press Ctrl-C to delete m" in line for line in iter(bound.stdout.readline, ""))
    bound.send_signal(signal.SIGINT)
    assert taking.next() == ("delete", "m")
    assert bound.wait(timeout=60) == 0


REFUSED = [
    ("-file none.urdf", "", "none.urdf: no such file in "),
    ("-file .", "", ": Is a directory"),
    ("-file f", "", "f is empty"),
    ("-file f", "<robot>\n <link>\n</robot>", "f:3:3: invalid XML"),
    ("-param nothing", "", "the parameter /nothing does not exist"),
    (
        "-file f",
        '<robot xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arm/></robot>',
        "f is a xacro file",
    ),
]
"""Arguments, the contents of the file f, and why no model is spawned."""


@pytest.mark.parametrize(("line", "content"), [case[:2] for case in REFUSED])
def test_what_cannot_be_spawned(ros, spawn, line, content):
    (ros.folder / "f").write_text(content)
    assert line.split()[-1] in spawn(f"-urdf -model m {line}", status=1).stderr


@pytest.mark.wording
@pytest.mark.parametrize(("line", "content", "said"), REFUSED)
def test_what_cannot_be_spawned_says_why(ros, spawn, line, content, said):
    (ros.folder / "f").write_text(content)
    assert said in spawn(f"-urdf -model m {line}", status=1).stderr


def test_a_refusal_is_reported_and_fails(spawn, gazebo):
    gazebo(mood="refuse")
    done = spawn("-urdf -file r.urdf -model m", status=1)
    assert "refused" in done.stderr


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("-file f -model m", "-urdf -sdf"),
        ("-urdf -sdf -file f -model m", "not allowed with"),
        ("-urdf -model m", "-file -param -database -stdin"),
        ("-urdf -file f", "-model"),
        ("-urdf -file f -model m -x one", "-x"),
        ("-urdf -file f -model m -Y nan", "-Y"),
        ("-urdf -file f -model m -J elbow much", "-J"),
    ],
)
def test_wrong_arguments_are_reported_before_ros_is_asked(ros, line, said):
    program = ros.overlay.program("gazebo_ros", "spawn_model")
    assert said in ros.run(program, *line.split(), status=2).stderr


CLIENT = f"""
import json
import rospy
from geometry_msgs.msg import Pose
from gazebo_ros import gazebo_interface as gazebo
rospy.init_node("client")
pose = Pose()
pose.orientation.w = {math.cos(0.5)}
pose.orientation.z = {math.sin(0.5)}
print(json.dumps([
    gazebo.spawn_urdf_model_client("a", "<robot/>", "/n", pose, "world", "/gazebo"),
    gazebo.spawn_sdf_model_client("b", "<sdf/>", "", pose, "", "/gazebo"),
    gazebo.set_model_configuration_client("a", "p", ["j"], [0.5], "/gazebo"),
]))
"""


def test_the_module_as_others_import_it(ros, gazebo):
    ros.master()
    taking = gazebo()
    client = ros.python(CLIENT)
    what, asked = taking.next()
    assert (what, asked["name"], asked["xml"], asked["frame"]) == ("urdf", "a", "<robot/>", "world")
    assert asked["orientation"] == [0.0, 0.0, math.sin(0.5), math.cos(0.5)]
    assert taking.next()[0] == "sdf"
    assert taking.next()[1]["parameter"] == "p"
    output, _ = client.communicate(timeout=60)
    assert json.loads(output.splitlines()[-1]) == [True, True, True]
