"""Which files a description may read: those of its workspace, of packages, and of arguments."""

import os
from pathlib import Path

import pytest
from PIL import Image
from tests.coded import raises

from cartwheel.codes import files
from cartwheel.description import load
from cartwheel.description.files.readable_files import Reach, is_inside, with_targets
from cartwheel.description.loading import load_plain, open_description

NS = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
PART = f'<robot {NS}><link name="part"/></robot>'


@pytest.fixture
def workspace(tmp_path, monkeypatch):
    """A workspace with two packages, and things beside it."""
    for name in ("ONE", "HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    files = {
        "ws/src/one/package.xml": "<package><name>one</name></package>",
        "ws/src/one/config/a.yaml": "word: a",
        "ws/src/one/urdf/part.xacro": PART,
        "ws/src/two/package.xml": "<package><name>two</name></package>",
        "ws/src/two/config/a.yaml": "word: two",
        "ws/src/two/urdf/part.xacro": PART,
        "beside/a.yaml": "word: beside",
        "beside/part.xacro": PART,
        "home/.ssh/a.yaml": "word: key",
        "away/three/package.xml": "<package><name>three</name></package>",
        "away/three/a.yaml": "word: three",
        "installed/share/four/package.xml": "<package><name>four</name></package>",
        "source/four/a.yaml": "word: four",
    }
    for name, content in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(content)
    one = tmp_path / "ws/src/one"
    (one / "link.yaml").symlink_to(tmp_path / "beside/a.yaml")
    (one / "folder").symlink_to(tmp_path / "beside")
    (one / "near.yaml").symlink_to(one / "config/a.yaml")
    (one / ".git").mkdir()
    (one / ".git" / "a.yaml").write_text("word: token")
    (tmp_path / "installed/share/four/a.yaml").symlink_to(tmp_path / "source/four/a.yaml")
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "installed"))
    return tmp_path


def loaded(workspace, body, **arguments):
    path = workspace / "ws/src/one/urdf/robot.xacro"
    # Far from the workspace's top, so that what is beside it is out of reach.
    path.write_text(f'<robot name="r" {NS}>{body}</robot>')
    return open_description(path, arguments).root


def word(workspace, path, **arguments):
    body = f"""<xacro:arg name="file" default=""/>
    <link name="${{xacro.load_yaml('{path}')['word']}}"/>"""
    return loaded(workspace, body, **arguments).children[0].attributes["name"]


@pytest.mark.parametrize(
    ("path", "expected"),
    [
        ("../config/a.yaml", "a"),
        ("$(find one)/config/a.yaml", "a"),
        ("$(find two)/config/a.yaml", "two"),
        ("../../two/config/a.yaml", "two"),
        ("../near.yaml", "a"),
        ("$(find four)/a.yaml", "four"),
    ],
)
def test_workspace_and_packages_are_read(workspace, path, expected):
    assert word(workspace, path) == expected


@pytest.mark.parametrize(
    "path",
    [
        "{0}/beside/a.yaml",
        "../../../../beside/a.yaml",
        "$(find one)/../../../beside/a.yaml",
        "$(find four)/../../../beside/a.yaml",
        "../link.yaml",
        "../folder/a.yaml",
        "../.git/a.yaml",
        "{0}/home/.ssh/a.yaml",
        "/etc/passwd",
        "/proc/self/environ",
    ],
)
def test_files_elsewhere_are_refused(workspace, path, monkeypatch):
    monkeypatch.setattr("cartwheel.description.files.package_folders.MAX_LEVELS_UP", 2)
    with raises(files.FILE_NOT_ALLOWED):
        word(workspace, path.format(workspace))
    include = f'<xacro:include filename="{path.format(workspace)}"/>'
    with raises(files.FILE_NOT_ALLOWED):
        loaded(workspace, include.replace("a.yaml", "part.xacro") if "beside" in path else include)


@pytest.mark.parametrize("pattern", ["/etc/*", "{0}/beside/*.xacro", "../folder/*.xacro"])
def test_wildcards_stay_inside(workspace, pattern, monkeypatch):
    monkeypatch.setattr("cartwheel.description.files.package_folders.MAX_LEVELS_UP", 2)
    with raises(files.FILE_NOT_ALLOWED):
        loaded(workspace, f'<xacro:include filename="{pattern.format(workspace)}"/>')
    with raises(files.FILE_NOT_ALLOWED):
        loaded(workspace, '<xacro:include filename="../*/../../../beside/part.xacro"/>')
    assert loaded(workspace, '<xacro:include filename="p*.xacro"/>').children[0].tag == "link"


def test_files_that_arguments_name_are_read(workspace, monkeypatch):
    monkeypatch.setattr("cartwheel.description.files.package_folders.MAX_LEVELS_UP", 2)
    file = str(workspace / "beside/a.yaml")
    assert word(workspace, "$(arg file)", file=file) == "beside"
    assert word(workspace, "$(arg file)/a.yaml", file=str(workspace / "beside")) == "beside"
    for value in ("/", str(workspace / "home"), "/etc"):
        with raises(files.FILE_NOT_ALLOWED):
            word(workspace, f"{workspace}/home/.ssh/a.yaml", file=value)
    # What the file itself gives an argument names nothing.
    with raises(files.FILE_NOT_ALLOWED):
        loaded(
            workspace,
            f"""<xacro:arg name="x" default="{file}"/>
            <link name="${{xacro.load_yaml('$(arg x)')}}"/>""",
        )


@pytest.mark.parametrize(
    ("path", "code"),
    [
        ("pipe", files.FILE_UNREADABLE),
        ("folder", files.FILE_UNREADABLE),
        ("zero", files.FILE_NOT_ALLOWED),
        ("large", files.FILE_UNREADABLE),
    ],
)
def test_only_regular_files_of_some_size_are_read(workspace, path, code):
    folder = workspace / "ws/src/one/urdf"
    os.mkfifo(folder / "pipe")
    (folder / "folder").mkdir()
    (folder / "zero").symlink_to("/dev/zero")
    with (folder / "large").open("wb") as file:
        file.truncate(10**10)
    with raises(code):
        word(workspace, path)
    with raises(code):
        loaded(workspace, f'<xacro:include filename="{path}"/>')


def found_of(folder, path, tag):
    """What is reported of a visual with a mesh or texture."""
    if not (folder / "pipe").exists():
        os.mkfifo(folder / "pipe")
    part = (
        f'<geometry><mesh filename="{path}"/></geometry>'
        if tag == "mesh"
        else f'<geometry><sphere radius="1"/></geometry>'
        f'<material name="m"><texture filename="{path}"/></material>'
    )
    robot = folder / "robot.urdf"
    robot.write_text(f'<robot name="r"><link name="l"><visual>{part}</visual></link></robot>')
    return [each for each in load(robot).diagnostics if each.values.get("kind") == tag]


@pytest.mark.parametrize("path", ["/dev/zero", "pipe"])
@pytest.mark.parametrize("tag", ["mesh", "texture"])
def test_meshes_and_pictures_are_regular_files(workspace, path, tag):
    (found,) = found_of(workspace / "ws/src/one/urdf", path, tag)
    assert (found.code, found.values["name"]) == (files.FILE_UNREADABLE, path)


@pytest.mark.parametrize("path", ["/etc/passwd", "/proc/self/mem"])
def test_files_without_the_name_of_a_mesh_are_not_read(workspace, path):
    (found,) = found_of(workspace / "ws/src/one/urdf", path, "mesh")
    assert found.code is files.MESH_UNREADABLE
    assert (found.values["name"], found.values["format"]) == (path, "")


def test_a_description_in_the_home_folder_reads_nothing_hidden(workspace, monkeypatch):
    home = Path(os.environ["HOME"])
    (home / "ok.yaml").write_text("word: ok")
    for path, readable in (("ok.yaml", True), (".ssh/a.yaml", False)):
        (home / "robot.xacro").write_text(
            f"<robot name='r' {NS}><link name=\"${{xacro.load_yaml('{path}')['word']}}\"/></robot>"
        )
        if readable:
            assert open_description(home / "robot.xacro", {}).root.children[0].get("name") == "ok"
        else:
            with raises(files.FILE_NOT_ALLOWED):
                open_description(home / "robot.xacro", {})


def plain(text, workspace, **options):
    reach = Reach(folders=(workspace / "allowed",))
    return load_plain(text, file="<model_xml of r>", reach=reach, **options)


@pytest.mark.parametrize(
    "named",
    ["{0}/beside/a.yaml", " \n {0}/beside/a.yaml\n", "beside/a.yaml", "./beside/a.yaml",
     "allowed/link.yaml", "allowed/../beside/a.yaml", "{0}/beside/missing.yaml"],
)  # fmt: skip
@pytest.mark.parametrize("tag", ["parameters", "gz:parameters"])
def test_a_text_names_no_controller_file_elsewhere(workspace, monkeypatch, named, tag):
    monkeypatch.chdir(workspace)
    (workspace / "allowed").mkdir()
    (workspace / "allowed" / "a.yaml").write_text("a: 1")
    (workspace / "allowed" / "link.yaml").symlink_to(workspace / "beside/a.yaml")
    text = """<robot name="r" xmlns:gz="g"><link name="a"/><gazebo>
      <plugin filename="libgazebo_ros2_control.so" name="c"><{tag}>{named}</{tag}></plugin>
    </gazebo></robot>"""
    with raises(files.FILE_NOT_ALLOWED):
        plain(text.format(tag=tag, named=named.format(workspace)), workspace)
    for kept in ("allowed/a.yaml", f"{workspace}/allowed/a.yaml", "allowed/missing.yaml"):
        plain(text.format(tag=tag, named=kept), workspace)


def test_what_the_page_uploads_names_no_controller_file_elsewhere(workspace):
    uploaded = workspace / "upload"
    uploaded.mkdir()
    text = """<robot name="r"><link name="a"/><gazebo>
      <plugin filename="libgazebo_ros2_control.so" name="c"><parameters>{}</parameters></plugin>
    </gazebo></robot>"""
    (uploaded / "r.urdf").write_text(text.format(workspace / "beside/a.yaml"))
    with raises(files.FILE_NOT_ALLOWED):
        load(uploaded / "r.urdf", reach=Reach(folders=(uploaded,)))


def test_a_script_of_strangers_names_no_picture_elsewhere(workspace):
    uploaded = workspace / "upload"
    uploaded.mkdir()
    for folder in ("beside", "upload"):
        Image.new("RGB", (2, 2)).save(workspace / folder / "p.png")
    # The file is the description and its own script.
    text = """<sdf version="1.7">
<!--
material Own {{ technique {{ pass {{ texture_unit {{ texture {} }} }} }} }}
-->
<model name="m"><link name="l"><visual name="v"><geometry><sphere><radius>1</radius></sphere>
</geometry><material><script><uri>m.sdf</uri><name>Own</name></script></material></visual></link>
</model></sdf>"""

    def texture(named):
        (uploaded / "m.sdf").write_text(text.format(named))
        found = load(uploaded / "m.sdf", reach=Reach(folders=(uploaded,)))
        return found.links[0].visuals[0].material.texture

    assert texture("p.png") == uploaded / "p.png"
    assert texture(workspace / "beside/p.png") is None
    assert texture("../beside/p.png") is None


def test_the_way_back_from_a_link_leaves_a_trusted_folder(workspace):
    trusted = workspace / "trusted"
    (trusted / "pack/meshes").mkdir(parents=True)
    (trusted / "pack/meshes/a.stl").write_text("")
    (trusted / "pack/away").symlink_to(workspace / "away/three")
    (workspace / "away/secret.yaml").write_text("")
    linked = workspace / "linked"
    linked.symlink_to(trusted)
    for folder in (trusted, linked):
        folders = with_targets([folder])
        assert is_inside(folder, folders)
        assert is_inside(folder / "pack/meshes/../meshes/a.stl", folders)
        assert is_inside(folder / "pack/away/a.yaml", folders)
        assert not is_inside(folder / "pack/away/../secret.yaml", folders)
        assert not is_inside(folder / "../away/secret.yaml", folders)
        assert not is_inside(folder.with_name(f"{folder.name}2"), folders)
    assert is_inside(trusted / "pack", with_targets([linked]))
    assert not is_inside(linked / "pack", with_targets([trusted]))
