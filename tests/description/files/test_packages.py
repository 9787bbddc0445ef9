"""Where packages, models and files are searched, and how missing ones are reported."""

import tempfile
import time

import pytest
from tests.coded import named, raises

from cartwheel.codes import files
from cartwheel.codes.tags import VALUE_INVALID
from cartwheel.description.files import package_folders, package_search
from cartwheel.description.files import packages as packages_module
from cartwheel.description.files.package_folders import share
from cartwheel.description.files.packages import Packages
from cartwheel.description.files.repositories import root_of
from cartwheel.errors import DescriptionError, Origin

HERE = Origin(file="robot.urdf", line=3)


def package(folder, name=None):
    folder.mkdir(parents=True)
    (folder / "package.xml").write_text(f"<package><name>{name or folder.name}</name></package>")
    return folder


def robot(folder):
    path = folder / "urdf" / "robot.urdf"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("<robot/>")
    return path


def packages(file, environment=None, **more):
    return Packages(file, environment=environment or {}, **more)


@pytest.mark.parametrize("scheme", ["models", "gz"])
def test_gz_sim_finds_a_model_whatever_the_scheme_is(tmp_path, scheme):
    own = package(tmp_path / "ws" / "src" / "a")
    mesh = own / "models" / "car" / "body.stl"
    mesh.parent.mkdir(parents=True)
    mesh.touch()
    found, uri = packages(robot(own)), f"{scheme}://car/body.stl"
    assert found.resolve(uri, HERE) == mesh
    assert found.found_elsewhere[uri].path == mesh
    with raises(VALUE_INVALID):
        found.resolve(f"{scheme}://car/wheel.stl", HERE)


def test_own_package_by_the_name_in_its_manifest(tmp_path):
    own = package(tmp_path / "ws" / "src" / "checkout-folder", "my_robot")
    assert packages(robot(own)).find("my_robot") == own


def test_name_in_a_comment_of_the_manifest_does_not_count(tmp_path):
    own = package(tmp_path / "ws" / "a")
    (own / "package.xml").write_text(
        "<package><!-- <name>wrong</name> --><name>right</name></package>"
    )
    assert packages(robot(own)).find("right") == own


@pytest.mark.parametrize("place", ["src/b", "src/meta/b", "b", "install/b/share/b", "share/b"])
def test_packages_of_the_same_workspace(tmp_path, place):
    own = package(tmp_path / "ws" / "src" / "a")
    other = package(tmp_path / "ws" / place)
    assert packages(robot(own)).find("b") == other


def test_ignored_folders_are_not_searched(tmp_path):
    own = package(tmp_path / "ws" / "src" / "a")
    package(tmp_path / "ws" / "src" / "old" / "b")
    (tmp_path / "ws" / "src" / "old" / "COLCON_IGNORE").touch()
    with raises(files.FILE_MISSING):
        packages(robot(own)).find("b")


@pytest.mark.parametrize(
    ("variable", "place", "value"),
    [
        ("ROS_PACKAGE_PATH", "ros/b", "ros"),
        ("ROS_PACKAGE_PATH", "ros/b", "ros/b"),
        ("ROS_PACKAGE_PATH", "ros/stack/b", "ros"),
        ("AMENT_PREFIX_PATH", "opt/share/b", "opt"),
        ("CMAKE_PREFIX_PATH", "opt/share/b", "opt"),
        ("GAZEBO_MODEL_PATH", "models/b", "models"),
    ],
)
def test_environment(tmp_path, variable, place, value):
    other = package(tmp_path / "elsewhere" / place)
    file = robot(tmp_path / "x1" / "x2" / "x3" / "x4" / "x5" / "x6")
    environment = {variable: f"/nowhere:{tmp_path / 'elsewhere' / value}"}
    assert packages(file, environment).find("b") == other


def test_explicit_path_wins(tmp_path):
    own = package(tmp_path / "ws" / "src" / "a")
    other = package(tmp_path / "other" / "a")
    found = packages(robot(own), package_path=[tmp_path / "other"])
    assert found.find("a") == other


def test_folder_without_manifest_is_the_second_choice(tmp_path):
    bare = tmp_path / "ws" / "my_robot"
    bare.mkdir(parents=True)
    file = robot(package(tmp_path / "ws" / "other"))
    assert packages(file).find("my_robot") == bare
    true = package(tmp_path / "ws" / "src" / "my_robot")
    assert packages(file).find("my_robot") == true


def test_a_file_in_a_folder_without_manifest_means_its_own_folder(tmp_path):
    bare = tmp_path / "repositories" / "mine" / "my_robot"
    file = robot(bare)
    theirs = package(tmp_path / "repositories" / "theirs" / "my_robot")
    assert packages(file).find("my_robot") == bare
    assert packages(file, package_path=[theirs]).find("my_robot") == theirs
    inside = package(bare / "src" / "my_robot")
    assert packages(file).find("my_robot") == inside


def test_a_workspace_with_a_packages_name_is_not_the_package(tmp_path):
    file = robot(package(tmp_path / "fetch" / "other"))
    true = package(tmp_path / "elsewhere" / "fetch")
    environment = {"ROS_PACKAGE_PATH": str(true.parent)}
    assert packages(file, environment).find("fetch") == true


@pytest.mark.parametrize("place", ["src/arm", "arm", "src/meta/arm"])
def test_packages_of_rosbuild_have_the_name_of_their_folder(tmp_path, place):
    file = robot(package(tmp_path / "ws" / "src" / "a"))
    folder = tmp_path / "ws" / place
    folder.mkdir(parents=True)
    (folder / "manifest.xml").write_text("<package><description>arm</description></package>")
    assert packages(file).find("arm") == folder
    own = robot(folder)
    assert packages(own).find("arm") == folder
    (folder / "manifest.xml").write_text("<gazebo><model>arm</model></gazebo>")
    (folder / "package.xml").write_text("<package><name>other</name></package>")
    assert packages(own).find("other") == folder


def test_a_manifest_of_another_program_is_not_a_package(tmp_path):
    file = robot(package(tmp_path / "ws" / "src" / "a"))
    folder = tmp_path / "ws" / "src" / "x" / "y" / "z" / "arm"
    folder.mkdir(parents=True)
    (folder / "manifest.xml").write_text("<assembly><package_name>arm</package_name></assembly>")
    with pytest.raises(DescriptionError):
        packages(file).find("arm")


def test_missing_package_says_which_may_be_meant(tmp_path):
    own = package(tmp_path / "ws" / "src" / "my_robot")
    with raises(files.FILE_MISSING, kind="package", name="my_robt", meant="my_robot") as caught:
        packages(robot(own)).find("my_robt", HERE)
    assert caught.value.origin is HERE


@pytest.mark.wording
def test_missing_package_says_where_it_was_searched(tmp_path):
    own = package(tmp_path / "ws" / "src" / "my_robot")
    with raises(files.FILE_MISSING) as caught:
        packages(robot(own)).find("my_robt", HERE)
    assert str(own.parent) in caught.value.hint


def test_uris(tmp_path):
    own = package(tmp_path / "ws" / "src" / "a")
    mesh = own / "meshes" / "my part.stl"
    mesh.parent.mkdir()
    mesh.touch()
    found = packages(robot(own))
    for uri in (
        "package://a/meshes/my part.stl",
        "package://a/meshes/my%20part.stl",
        "$(find a)/meshes/my part.stl",
        "file://$(find a)/meshes/my part.stl",
        "$(find-pkg-share a)/meshes/my part.stl",
        mesh.as_uri().replace("%20", " "),
        mesh.as_uri(),
        str(mesh),
        "../meshes/my part.stl",
        "model://a/meshes/my part.stl",
    ):
        assert found.resolve(uri).resolve() == mesh, uri


def test_relative_paths_begin_at_the_file_that_names_them(tmp_path):
    file = robot(tmp_path / "a")
    part = tmp_path / "parts" / "wheel.stl"
    part.parent.mkdir()
    part.touch()
    origin = Origin(file=str(tmp_path / "parts" / "wheel.xacro"), line=1)
    assert packages(file).resolve("wheel.stl", origin) == part


@pytest.mark.parametrize("uri", ["file://Media/sea.dae", "Media/sea.dae"])
def test_relative_paths_may_begin_at_the_package_of_the_file_that_names_them(tmp_path, uri):
    """As where the package exports its folder as a gazebo_media_path."""
    file = robot(package(tmp_path / "a"))
    sea = package(tmp_path / "b") / "Media" / "sea.dae"
    sea.parent.mkdir()
    sea.touch()
    origin = Origin(file=str(tmp_path / "b" / "models" / "sea" / "model.sdf"), line=1)
    assert packages(file).resolve(uri, origin) == sea


@pytest.mark.parametrize(
    ("uri", "code"),
    [
        ("package://a/wheel.stk", "file-missing wheel.stl"),
        ("package:///wheel.stl", "value-invalid"),
        ("https://example.org/a.stl", "file-on-network"),
        ("ftp://example.org/a.stl", "value-invalid"),
        ("file://", "value-invalid"),
        ("package://b/x", "file-missing"),
        ("model://b/x", "file-missing"),
        ("model://../x", "file-missing"),
        ("x" * 5000, "file-missing"),
        ("a\0b", "file-missing"),
    ],
)
def test_files_that_are_not_there(tmp_path, uri, code):
    own = package(tmp_path / "ws" / "a")
    (own / "wheel.stl").touch()
    with pytest.raises(DescriptionError) as caught:
        packages(robot(own)).resolve(uri, HERE)
    assert named(caught.value) == code
    assert str(caught.value.origin) == "robot.urdf:3"


@pytest.mark.parametrize("variable", ["GAZEBO_MODEL_PATH", "GZ_SIM_RESOURCE_PATH"])
def test_models(tmp_path, variable):
    cone = tmp_path / "elsewhere" / "cone"
    cone.mkdir(parents=True)
    file = tmp_path / "x1" / "x2" / "x3" / "x4" / "x5" / "x6" / "world.sdf"
    file.parent.mkdir(parents=True)
    found = packages(file, {variable: str(tmp_path / "elsewhere")})
    assert found.find_model("cone") == cone
    assert found.resolve("model://cone", folder=True) == cone


def test_model_with_the_name_of_a_package_that_contains_a_python_module(tmp_path):
    own = package(tmp_path / "ws" / "src" / "robot")
    (own / "robot").mkdir()
    (own / "robot" / "__init__.py").touch()
    (own / "meshes").mkdir()
    mesh = own / "meshes" / "base.stl"
    mesh.touch()
    assert packages(robot(own)).resolve("model://robot/meshes/base.stl") == mesh


def test_models_beside_the_world(tmp_path):
    cone = tmp_path / "models" / "cone"
    cone.mkdir(parents=True)
    file = tmp_path / "worlds" / "a.world"
    file.parent.mkdir()
    assert packages(file).find_model("cone") == cone


def test_shipped_things_are_found_from_anywhere(tmp_path):
    assert (share() / "robots").is_dir()
    found = Packages(tmp_path / "robot.urdf", environment={})
    assert found.find("rosbots_description") == share() / "robots" / "rosbots_description"


def test_what_lies_among_temporary_files_belongs_to_nobody(tmp_path, monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))
    package(tmp_path / "b")
    beside = package(tmp_path / "ws" / "c")
    found = packages(robot(package(tmp_path / "ws" / "a")))
    assert found.find("c") == beside
    with raises(files.FILE_MISSING):
        found.find("b")


@pytest.mark.parametrize("root", ["src", ".git", ".gitignore"])
def test_packages_lie_deep_in_a_workspace_or_repository(tmp_path, root):
    """An archive of a repository contains no ``.git``."""
    source = tmp_path / "ws" / ("src" if root == "src" else "robots")
    own = package(source / "turtle" / "turtle_description")
    deep = package(source / "create" / "common" / "more" / "b")
    if root != "src":
        (tmp_path / "ws" / root).mkdir()
    assert packages(robot(own)).find("b") == deep


def test_the_package_path_of_ros_is_crawled(tmp_path):
    deep = package(tmp_path / "share" / "create" / "common" / "more" / "b")
    own = package(tmp_path / "home" / "a")
    found = packages(robot(own), {"ROS_PACKAGE_PATH": str(tmp_path / "share")}).find("b")
    assert found == deep


def test_large_trees_are_not_walked(tmp_path, monkeypatch):
    own = package(tmp_path / "ws" / "src" / "a")
    for number in range(700):
        (tmp_path / "ws" / f"f{number:03}").mkdir()
    looked = set()
    name_of = package_folders.package_name

    def counted(folder):
        looked.add(folder)
        return name_of(folder)

    monkeypatch.setattr(package_folders, "package_name", counted)
    with raises(files.FILE_MISSING):
        packages(robot(own)).find("nowhere")
    walked = [each for each in looked if each.parent == tmp_path / "ws"]
    assert 0 < len(walked) <= package_folders.MAX_ENTRIES


def test_folders_are_looked_at_once_for_many_names(tmp_path, monkeypatch):
    own = package(tmp_path / "ws" / "src" / "a")
    for number in range(40):
        package(tmp_path / "ws" / "src" / "deep" / "er" / f"p{number}")
    looked = []
    name_of = package_folders.package_name

    def counted(folder):
        looked.extend([folder] if folder.parent.name == "er" else [])
        return name_of(folder)

    monkeypatch.setattr(package_folders, "package_name", counted)
    search = packages(robot(own))
    assert search.all_named("none") == search.all_named("neither") == []
    assert search.find("p39") == tmp_path / "ws" / "src" / "deep" / "er" / "p39"
    assert len(looked) == len(set(looked)) == 40


def test_a_package_that_is_made_later_is_found(tmp_path, monkeypatch):
    own = package(tmp_path / "ws" / "src" / "a")
    search = packages(robot(own))
    assert search.all_named("none") == []
    made = package(tmp_path / "ws" / "src" / "deep" / "er" / "b")
    now = time.monotonic()
    monkeypatch.setattr(package_search.time, "monotonic", lambda: now + 2)
    assert search.find("b") == made


@pytest.mark.parametrize(
    "uri",
    [
        "/home/me/ws/src/my_robot/meshes/base.stl",
        "file:///home/me/ws/src/my_robot/meshes/base.stl",
        "my_robot/meshes/base.stl",
        "package://former_name/meshes/base.stl",
        "$(find former_name)/meshes/base.stl",
        "$(find-pkg-share former_name)/meshes/base.stl",
    ],
)
def test_a_file_of_another_computer_is_found_in_its_package(tmp_path, uri):
    own = package(tmp_path / "ws" / "src" / "my_robot")
    mesh = own / "meshes" / "base.stl"
    mesh.parent.mkdir()
    mesh.write_text("solid base")
    found = packages(robot(own))
    assert found.resolve(uri, HERE, what="mesh").samefile(mesh)
    (received,) = found.moves()
    assert received.code is files.FILE_ELSEWHERE
    assert received.values["name"] == uri
    assert received.origin == HERE


@pytest.mark.parametrize(
    "uri",
    [
        "/home/me/ws/src/my_robot/../../../secret.stl",
        "../secret.stl",
        "package://former_name/../../../secret.stl",
        "$(find former_name)/../../../secret.stl",
        "http://localhost/my_robot/meshes/base.stl",
        "/home/me/other/meshes/base.stl",
    ],
)
def test_a_file_of_another_computer_is_not_searched_outside_its_package(tmp_path, uri):
    own = package(tmp_path / "ws" / "src" / "my_robot")
    (tmp_path / "secret.stl").write_text("solid secret")
    found = packages(robot(own))
    with pytest.raises(DescriptionError):
        found.resolve(uri, HERE, what="mesh")
    assert not found.found_elsewhere


def test_thousands_of_references_search_the_folders_once(tmp_path, monkeypatch):
    searched = []
    original = packages_module.package_above

    def counted(folder):
        searched.append(folder)
        return original(folder)

    monkeypatch.setattr(packages_module, "package_above", counted)
    for number in range(3):
        (tmp_path / f"{number}.stl").touch()
    found = packages(tmp_path / "a.world", package_path=[tmp_path])
    other = Origin(file=str(tmp_path / "models/b.sdf"), line=1)
    for _ in range(100):
        for number in range(3):
            for origin in (None, other):
                assert found.resolve(f"{number}.stl", origin) == tmp_path / f"{number}.stl"
    assert len(searched) <= 3


def test_a_file_that_is_removed_is_missed(tmp_path):
    near, far = tmp_path / "near/a.stl", tmp_path / "far/a.stl"
    for file in (near, far):
        file.parent.mkdir()
        file.touch()
    found = packages(tmp_path / "near/a.world", package_path=[far.parent])
    assert found.resolve("a.stl") == near
    near.unlink()
    assert found.resolve("a.stl") == far
    far.unlink()
    with raises(files.FILE_MISSING):
        found.resolve("a.stl")


def test_a_package_of_a_neighbouring_repository_is_reported_once(tmp_path):
    own, other = tmp_path / "src" / "own", tmp_path / "src" / "other"
    (own / ".git").mkdir(parents=True)
    (other / ".git").mkdir(parents=True)
    found = packages(robot(package(own / "pieces" / "robot")))
    there = package(other / "arm")
    for line in (3, 4):
        assert found.find("arm", Origin(file="robot.urdf", line=line)) == there
    (note,) = found.moves()
    assert (note.code, note.severity) == (files.PACKAGE_OF_NEIGHBOUR, "info")
    assert note.values == {"name": "arm", "used": str(there)}
    assert note.origin is not None
    assert note.origin.line == 3
    sourced = {"ROS_PACKAGE_PATH": str(tmp_path / "src")}
    known = packages(own / "pieces" / "robot" / "urdf" / "robot.urdf", sourced)
    assert known.find("arm") == there
    assert not [*known.moves()]


@pytest.mark.parametrize("mark", [".git", ""])
def test_the_own_repository_comes_before_a_neighbour(tmp_path, mark):
    """Unless it only has a folder with the name, such as that of a submodule that was not fetched:
    ROS finds packages by their manifests.
    """
    own = tmp_path / "src" / "own"
    file = robot(package(own / "pieces" / "robot"))
    package(own / "pieces" / "tools")
    if mark:
        (own / mark).mkdir()
    there = package(tmp_path / "src" / "other" / "arm")
    bare = own / "pieces" / "arm"
    for part in (bare, bare / "meshes"):
        part.mkdir()
        found = packages(file)
        assert found.find("arm") == there
        assert [each.code for each in found.moves()] == [files.PACKAGE_OF_NEIGHBOUR]
    (bare / "package.xml").write_text("<package><name>arm</name></package>")
    found = packages(file)
    assert found.find("arm") == bare
    assert not [*found.moves()]
    if mark:
        deep = package(own / "a" / "b" / "c" / "d" / "hand")
        package(tmp_path / "src" / "other" / "hand")
        assert packages(file).find("hand") == deep


def test_a_folder_around_a_package_that_may_not_be_read(tmp_path, monkeypatch):
    own = package(tmp_path / "closed" / "own")
    package(tmp_path / "closed" / "other")
    assert root_of(robot(own)) == own.parent

    def refuse(_):
        raise PermissionError

    monkeypatch.setattr("pathlib.Path.iterdir", refuse)
    assert root_of(robot(own)) == own
