"""One call for every kind of file, and what it says of those that are of no kind."""

import subprocess
import sys
from pathlib import Path

import pytest
from tests.coded import coded, named, placed, raises

from cartwheel.codes import files, tags
from cartwheel.description import load, load_robot, load_text, load_world
from cartwheel.description.files.named_files import find_description, shipped_descriptions
from cartwheel.description.files.package_folders import share
from cartwheel.description.model import RobotDescription, WorldDescription
from cartwheel.errors import DescriptionError

BODY = (
    '<inertial><mass value="1"/>'
    '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
)
URDF = f'<robot name="r"><link name="a">{BODY}</link></robot>'
XACRO = (
    '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
    f'<xacro:arg name="n" default="a"/><link name="$(arg n)">{BODY}</link></robot>'
)
SDF = '<sdf version="1.6"><model name="m"><link name="l"/></model></sdf>'
WORLD = '<sdf version="1.6"><world name="w"/></sdf>'


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def write(path, text):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


def failure(path, call=load, **more):
    with pytest.raises(DescriptionError) as caught:
        call(path, **more)
    return f"{caught.value.origin} {named(caught.value)}"


def hint(path):
    with pytest.raises(DescriptionError) as caught:
        load(path)
    return caught.value.hint


@pytest.mark.parametrize(
    ("text", "kind", "name"),
    [
        (URDF, RobotDescription, "r"),
        (XACRO, RobotDescription, "r"),
        (SDF, RobotDescription, "m"),
        (WORLD, WorldDescription, "w"),
    ],
)
def test_content_decides_not_the_name(folder, text, kind, name):
    found = load(write(folder / "file.txt", text))
    assert isinstance(found, kind)
    assert found.name == name


def test_arguments():
    robot = load_text(XACRO, arguments={"n": "b"})
    assert robot.links[0].name == "b"
    assert "xacro" not in robot.text
    assert '<link name="b">' in robot.text


def test_arguments_of_what_is_no_xacro_are_reported():
    (reported,) = load_text(URDF, file="r.urdf", arguments={"n": "b"}).diagnostics
    assert placed(reported) == "r.urdf warning argument-unknown"


def test_robot_or_world(folder):
    robot, world = write(folder / "r.urdf", URDF), write(folder / "w.world", WORLD)
    assert load_robot(robot).name == "r"
    assert load_world(world).name == "w"
    assert failure(world, load_robot) == "w.world:1 description-kind"
    assert failure(robot, load_world) == "r.urdf:1 description-kind"


@pytest.mark.parametrize(
    ("content", "error"),
    [
        (b"", "file file-unreadable"),
        (b"solid x\0\0\0", "file file-unreadable"),
        (b"a: 1\n", "file:1 xml-malformed"),
        (b"<launch/>", "file:1 not-a-description"),
        (b"<mujoco/>", "file:1 not-a-description"),
        (b"<COLLADA/>", "file:1 not-a-description"),
        (b"<html/>", "file:1 not-a-description"),
        (b"<gazebo version='1.0'/>", "file:1 not-a-description"),
    ],
)
def test_other_files(folder, content, error):
    (folder / "file").write_bytes(content)
    assert failure("file") == error


def test_missing_file_suggests_near_names(folder):
    write(folder / "robots" / "cart.urdf", URDF)
    assert failure("robots/crt.urdf") == "robots/crt.urdf file-missing cart.urdf"
    assert failure("robot/cart.urdf") == "robot/cart.urdf file-missing"
    write(folder / "cart.urdf", URDF)
    assert failure("cart.udf") == "cart.udf file-missing cart.urdf"
    assert failure("robots.xacro") == "robots.xacro file-missing rosbots.xacro"
    assert failure("zzzzz") == "zzzzz file-missing"
    assert failure("materials.xcro") == "materials.xcro file-missing"  # a part of rosbots.xacro
    assert failure("traffic_con") == "traffic_con file-missing traffic_cone"


@pytest.mark.wording
def test_missing_file_says_what_is_there(folder):
    write(folder / "cart.urdf", URDF)
    assert hint("cart.udf") == 'Did you mean "cart.urdf"?'
    assert hint("robot/cart.urdf") == 'The folder "robot" does not exist either.'
    listed = hint("zzzzz").removeprefix("Bundled descriptions: ").removesuffix(".").split(", ")
    assert {"rosbots.xacro", "empty", "object.urdf", "ramp"} <= set(listed)
    for name in listed:
        assert load(name).name
    assert not {"materials.xacro", "rosbots.gazebo.xacro", "sun", "ground_plane"} & set(listed)
    write(folder / "several" / "a.urdf", URDF)
    write(folder / "several" / "b.urdf", URDF)
    assert hint("several") == "Pass one of: a.urdf, b.urdf."


@pytest.mark.parametrize("name", ["a\0b", "x" * 5000, "", "."])
def test_impossible_names(folder, name):
    failure(name)


@pytest.mark.parametrize("name", ["", " "])
def test_an_empty_name_is_not_the_working_folder(folder, name, monkeypatch):
    (folder / "robot.urdf").write_text('<robot name="r"><link name="l"/></robot>')
    monkeypatch.chdir(folder)
    assert find_description(".").name == "robot.urdf"
    with raises(files.FILE_MISSING, name=name):
        find_description(name)


def test_folders(folder):
    write(folder / "cone" / "model.sdf", SDF)
    assert load(folder / "cone").name == "m"
    write(folder / "box" / "box-1_4.sdf", SDF)
    write(
        folder / "box" / "model.config",
        '<model><sdf version="1.3">old.sdf</sdf><sdf version="1.4">box-1_4.sdf</sdf></model>',
    )
    assert load("box").name == "m"
    write(folder / "single" / "urdf" / "robot.urdf", URDF)
    assert load("single").name == "r"
    write(folder / "several" / "a.urdf", URDF)
    write(folder / "several" / "b.urdf", URDF)
    with raises(files.NOT_A_DESCRIPTION, found=("a.urdf", "b.urdf")):
        load("several")
    (folder / "none").mkdir()
    assert failure("none") == "none not-a-description"
    write(folder / "broken" / "model.config", "<model><sdf>x.sdf</sdf></model>")
    assert failure("broken") == "broken file-missing"


def test_uris(folder):
    write(folder / "ws" / "pkg" / "package.xml", "<package><name>pkg</name></package>")
    write(folder / "ws" / "pkg" / "urdf" / "r.urdf", URDF)
    found = load("package://pkg/urdf/r.urdf", package_path=[folder / "ws"])
    assert found.name == "r"
    assert load((folder / "ws/pkg/urdf/r.urdf").as_uri()).name == "r"
    assert failure("package://none/r.urdf").endswith("file-missing")


def test_shipped_things_by_their_names(folder):
    assert load("rosbots.xacro").name == "rosbots"
    assert load("rosbots").name == "rosbots"
    write(folder / "rosbots.xacro", XACRO)
    assert load("rosbots.xacro").name == "r"  # what lies here comes first


def test_everything_shipped_loads_without_a_word():
    parts = ("camera.xacro", "inertia.xacro", "materials.xacro", "rosbots.gazebo.xacro")
    for path in shipped_descriptions():
        # The sun is but a light, for worlds to include.
        if path.name not in parts and path.parent.name != "sun":
            assert not load(path).diagnostics, path


def test_text_finds_packages_around_the_file_it_is_said_to_be(folder):
    write(folder / "package.xml", "<package><name>pkg</name></package>")
    write(folder / "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    text = URDF.replace(
        "</link>",
        '<visual><geometry><mesh filename="package://pkg/a.obj"/></geometry></visual></link>',
    )
    robot = load_text(text, file=str(folder / "r.urdf"))
    assert robot.links[0].visuals[0].shape.path == folder / "a.obj"


@pytest.mark.parametrize("text", ["", " ", b""])
def test_empty_text(text):
    with raises(files.FILE_UNREADABLE):
        load_text(text)


def test_nothing_slow_is_imported_before_it_is_needed():
    script = (
        "import sys, cartwheel.description as d; d.load_text(sys.argv[1]);"
        "print([m for m in ('xacro', 'lxml', 'trimesh', 'mujoco', 'yaml') if m in sys.modules])"
    )
    out = subprocess.run(
        [sys.executable, "-c", script, URDF], capture_output=True, text=True, check=True
    )
    assert out.stdout == "[]\n"


def test_a_world_is_named_as_gazebos_users_name_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("GAZEBO_RESOURCE_PATH", raising=False)
    shipped = share() / "worlds" / "mud.world"
    assert find_description("worlds/mud.world") == shipped
    assert find_description("mud") == shipped
    # The user's own resources come first, and a file that is really there before all.
    theirs = tmp_path / "share" / "worlds"
    theirs.mkdir(parents=True)
    (theirs / "mud.world").write_text("<sdf/>")
    monkeypatch.setenv("GAZEBO_RESOURCE_PATH", f"/nowhere:{tmp_path / 'share'}")
    assert find_description("worlds/mud.world") == theirs / "mud.world"
    assert find_description("mud.world") == theirs / "mud.world"
    (tmp_path / "mud.world").write_text("<sdf/>")
    assert find_description("mud.world") == Path("mud.world")


def test_a_world_is_suggested_by_its_name():
    with raises(files.FILE_MISSING, meant="walls"):
        load_world("wals")


@pytest.mark.wording
def test_an_unknown_world_lists_the_worlds(folder):
    with raises(files.FILE_MISSING, name="zzzzz") as caught:
        load_world("zzzzz")
    listed = caught.value.hint.removeprefix("Bundled worlds: ").removesuffix(".").split(", ")
    assert {"empty", "walls", "post"} <= set(listed)
    for name in listed:
        assert load_world(name).name
    with raises(files.FILE_MISSING, meant="walls") as caught:
        load_world("wallz")
    assert "walls" in caught.value.hint
    with raises(files.FILE_MISSING) as caught:
        load_world("nowhere/zzzzz.world")
    assert "Bundled" not in (caught.value.hint or "")


LEFT = '<xacro:bracket name="front"/>'
BOX = '<link name="base"/>'


def output(folder, name, content):
    path = folder / name
    path.write_text(
        f'<robot name="box" xmlns:xacro="http://www.ros.org/wiki/xacro">{content}</robot>'
    )
    return path


def test_calls_that_xacro_left_in_its_output_are_ignored(tmp_path):
    """As by urdfdom and Gazebo: xacro before Jade left calls of unknown macros as they are."""
    made = load_robot(output(tmp_path, "box.urdf", BOX + LEFT))
    assert [each.name for each in made.links] == ["base"]
    (found,) = coded(made.diagnostics, tags.TAG_IGNORED)
    assert found.values["tag"] == "xacro:bracket"


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("box.urdf.xacro", BOX + LEFT),
        ("box.xacro.urdf", BOX + LEFT),
        ("box.urdf", BOX + LEFT + '<xacro:property name="a" value="1"/>'),
        ("box.urdf", BOX.replace("base", "${name}") + LEFT),
    ],
)
def test_files_for_xacro_must_define_their_macros(tmp_path, name, content):
    with raises(files.XACRO_NAME_UNKNOWN):
        load_robot(output(tmp_path, name, content))
