"""Commands that need no simulation."""

import signal
import urllib.request
from xml.etree import ElementTree

import mujoco
import pytest

import cartwheel
from cartwheel.codes.command import OPTION_INVALID, OUTPUT_NOT_WRITTEN, USAGE
from cartwheel.description import load_robot


def test_version(program):
    expected = f"cartwheel {cartwheel.__version__}\n"
    assert program("version").stdout == program("--version").stdout == expected


def test_help_names_every_command(program):
    text = program("--help").stdout
    for name in ("run", "topic", "spawn", "teleop", "convert", "status"):
        assert f"\n  {name} " in text
    assert f"[{USAGE}]" in program("rnu", status=2).stderr


def test_urdf_is_the_same_robot(program):
    program("convert", "rosbots.xacro", "--to", "urdf", "-o", "out.urdf")
    text = (program.folder / "out.urdf").read_text()
    assert "xacro:" not in text
    again = load_robot(program.folder / "out.urdf")
    assert again.mass == pytest.approx(load_robot("rosbots.xacro").mass)
    assert program("convert", "--to", "urdf", "rosbots.xacro").stdout == text


@pytest.mark.parametrize(("name", "bodies"), [("rosbots.xacro", 9), ("post.world", 3)])
def test_mjcf_loads_in_mujoco(program, name, bodies):
    text = program("convert", name, "--to", "mjcf").stdout
    model = mujoco.MjModel.from_xml_string(text)
    assert model.nbody == bodies
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, 100)
    assert data.time > 0


def test_mjcf_of_a_mesh_keeps_it(program):
    """The ramp and the cone are of meshes, which MuJoCo must find in the text itself."""
    text = program("convert", "traffic_cone", "--to", "mjcf").stdout
    model = mujoco.MjModel.from_xml_string(text)
    assert model.nmesh >= 1
    assert model.mesh_vertnum.sum() > 10


def test_the_format_is_that_of_the_file(program):
    for name, root in (("out.urdf", "robot"), ("OUT.XML", "mujoco")):
        program("convert", "rosbots.xacro", "-o", name)
        assert ElementTree.parse(program.folder / name).getroot().tag == root
    program("convert", "rosbots.xacro", "-o", "out.xml", "--to", "urdf")
    assert ElementTree.parse(program.folder / "out.xml").getroot().tag == "robot"


def test_what_cannot_be_converted(program):
    assert f"[{USAGE}]" in program("convert", "rosbots.xacro", status=2).stderr
    assert f"[{USAGE}]" in program("convert", "rosbots.xacro", "-o", "out.txt", status=2).stderr
    assert (
        f"[{OPTION_INVALID}]" in program("convert", "rosbots.xacro", "--to", "usd", status=2).stderr
    )
    assert "[CW108 " in program("convert", "post.world", "--to", "urdf", status=2).stderr
    done = program("convert", "rosbots.xacro", "--to", "urdf", "-o", "/no/where", status=2)
    assert f"[{OUTPUT_NOT_WRITTEN}]" in done.stderr


def test_view(program, ends):
    process = program.start("view", "rosbots.xacro", "--port", "0")
    url = process.stdout.readline().split()[1]
    with urllib.request.urlopen(url) as page:
        assert page.status == 200
    assert ends(process, signal.SIGINT) < 100
    assert process.returncode == 0
    assert process.stderr.read() == ""
