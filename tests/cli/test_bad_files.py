"""What is wrong with a file is said with its place; a running simulation goes on."""

import pytest

from cartwheel.codes.command import INTERNAL_FAULT, SIMULATION_NOT_RUNNING
from cartwheel.codes.files import FILE_MISSING
from cartwheel.codes.world import MODEL_NAME_TAKEN

from .test_run import BOX

XACRO = '<robot name="box" xmlns:xacro="http://www.ros.org/wiki/xacro">'
JOINT = """
  <joint name="j" type="fixed">
    <parent link="base"/>
    <child link="bass"/>
  </joint>
</robot>"""
MESH = '<mesh filename="package://{}/meshes/none.stl"/>'

BAD = {
    "malformed": ("bad.urdf", "<robot name='x'>\n<link name='a'>\n</robot>", "bad.urdf:3: "),
    "macro": ("bad.xacro", f"{XACRO}\n<xacro:wheel name='a'/>\n</robot>", "bad.xacro:2: "),
    "link": ("bad.urdf", BOX.replace("</robot>", JOINT), "bad.urdf:11: "),
    "kind": ("bad.launch", "<launch>\n</launch>", "bad.launch:1: "),
    "text": ("bad.txt", "robots are nice", "bad.txt:1: "),
    "empty": ("bad.urdf", "", "bad.urdf"),
}


@pytest.mark.parametrize("name", BAD)
def test_run(program, name):
    file, text, place = BAD[name]
    (program.folder / file).write_text(text)
    done = program("run", file, "--headless", "--for", "1", status=2)
    first = done.stderr.splitlines()[0]
    assert place in first and "error: " in first, done.stderr
    if name not in ("malformed", "empty"):
        assert "\n  " in done.stderr.rstrip(), "no hint"
    assert done.stdout == ""


@pytest.mark.parametrize("name", BAD)
def test_spawn(cart, name):
    file, text, place = BAD[name]
    (cart.folder / file).write_text(text)
    done = cart("spawn", file, status=2)
    first = done.stderr.splitlines()[0]
    assert place in first and "error: " in first, done.stderr
    assert "bad" not in cart("models").stdout


@pytest.mark.parametrize(
    "package", ["no_such_package", "rosbots_description"], ids=["package", "mesh"]
)
def test_a_missing_mesh_costs_its_shape_alone(program, package):
    def missing(text):
        first = text.splitlines()[0]
        return first.startswith("bad.urdf:6: error: ") and first.endswith(f"[{FILE_MISSING}]")

    text = BOX.replace('<box size="1 1 1"/>', MESH.format(package))
    (program.folder / "bad.urdf").write_text(text)
    run = ("run", "bad.urdf", "--headless", "--for", "0.1", "--speed", "max")
    done = program(*run)
    assert missing(done.stderr)
    assert "robot   box, 2 kg, 1 link, 0 joints" in done.stdout
    strict = program(*run, "--strict", status=2)
    assert missing(strict.stderr)
    assert strict.stdout == ""
    assert "[CW101 file-missing]" in program("check", "bad.urdf", status=1).stdout


def test_a_missing_file(cart):
    (cart.folder / "robot.urdf").write_text(BOX)
    for command in (("run", "--headless"), ("spawn",), ("convert", "--to", "urdf"), ("view",)):
        done = cart(*command, "robt.urdf", status=2)
        first = done.stderr.splitlines()[0]
        assert first.startswith("robt.urdf: error: ") and first.endswith(f"[{FILE_MISSING}]")


@pytest.mark.wording
def test_likely_names_are_shown(cart):
    (cart.folder / "robot.urdf").write_text(BOX)
    assert 'Did you mean "robot.urdf"?' in cart("spawn", "robt.urdf", status=2).stderr
    cart("spawn", "robot.urdf", "-x", "9")
    assert "box_1" in cart("spawn", "robot.urdf", "-x", "9", status=2).stderr
    cart("delete", "box")


def test_a_name_used_twice(cart):
    (cart.folder / "box.urdf").write_text(BOX)
    cart("spawn", "box.urdf", "-x", "9")
    done = cart("spawn", "box.urdf", "-x", "9", status=2)
    assert f"[{MODEL_NAME_TAKEN}]" in done.stderr
    cart("delete", "box")


def test_the_simulation_went_on(cart):
    """After all of the above, on the same simulation."""
    before = cart("topic", "echo", "/clock", "-n", "1").stdout
    assert cart("topic", "echo", "/clock", "-n", "1").stdout != before
    status = cart("status").stdout
    assert "running" in status
    assert "rosbots" in status


def test_no_simulation(program):
    for command in (
        ["status"],
        ["topic", "list"],
        ["topic", "echo", "/odom"],
        ["service", "list"],
        ["spawn", "x.urdf"],
        ["delete", "x"],
        ["models"],
        ["pause"],
        ["teleop"],
    ):
        done = program(*command, status=2)
        assert f"[{SIMULATION_NOT_RUNNING}]" in done.stderr


def faulty_version(program):
    """What is printed where Cartwheel itself fails."""
    (program.folder / "sitecustomize.py").write_text(
        "import cartwheel.cli.console as c\n"
        "def say(text=''): raise ZeroDivisionError('so it goes')\n"
        "c.say = say\n"
    )
    program.environment["PYTHONPATH"] = str(program.folder)
    return program("version", status=1).stderr


def test_a_fault_of_ours_is_reported_as_one(program):
    assert f"[{INTERNAL_FAULT}]" in faulty_version(program)


@pytest.mark.wording
def test_a_fault_of_ours_asks_for_a_report(program):
    assert "--verbose" in faulty_version(program)
