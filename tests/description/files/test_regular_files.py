"""Pipes, devices and huge files in a stranger's repository hold nobody up."""

from __future__ import annotations

import errno
import os
from pathlib import Path

import pytest
from tests.coded import raises

from cartwheel.checks.checking import check
from cartwheel.codes.devices import PLUGIN_OF_OTHER_ROS
from cartwheel.codes.files import MESH_UNREADABLE
from cartwheel.corpus.finding import robots_in
from cartwheel.description import load
from cartwheel.description.files.plugin_xml import exporting_file
from cartwheel.description.files.regular_files import read_regular, read_regular_text
from cartwheel.description.meshes import load_mesh, mesh_notes
from cartwheel.description.model import Mesh

OBJ = "mtllib {}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


def test_only_regular_files_of_a_bounded_size_are_read(tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "text").write_bytes(b"a\xff")
    assert read_regular_text(tmp_path / "text") == "a\ufffd"
    assert read_regular(tmp_path / "text", 2) == b"a\xff"
    for path, most, reason in (
        (tmp_path / "text", 1, errno.EFBIG),
        (tmp_path / "pipe", 9, errno.EINVAL),
        (tmp_path / "none", 9, errno.ENOENT),
        (tmp_path, 9, errno.EINVAL),
        (Path("/dev/zero"), 9, errno.EINVAL),
    ):
        with pytest.raises(OSError) as error:
            read_regular(path, most)
        assert error.value.errno == reason


@pytest.mark.parametrize("library", ["pipe", "/dev/zero"])
def test_a_material_library_that_is_none_is_noted(tmp_path, library):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "a.obj").write_text(OBJ.format(library))
    mesh = Mesh(uri="", path=tmp_path / "a.obj")
    assert len(load_mesh(mesh)) == 1
    assert library in mesh_notes(mesh)[0]


@pytest.mark.parametrize("uri", ["pipe", "../secret.bin", "/dev/zero", "%2e%2e/secret.bin"])
def test_a_gltf_reads_regular_files_of_its_folder_alone(tmp_path, uri):
    folder = tmp_path / "inner"
    folder.mkdir()
    os.mkfifo(folder / "pipe")
    (tmp_path / "secret.bin").write_bytes(bytes(64))
    (folder / "a.gltf").write_text(
        f"""{{"asset": {{"version": "2.0"}}, "scene": 0, "scenes": [{{"nodes": [0]}}],
        "nodes": [{{"mesh": 0}}],
        "meshes": [{{"primitives": [{{"attributes": {{"POSITION": 0}}}}]}}],
        "accessors": [{{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}}],
        "bufferViews": [{{"buffer": 0, "byteLength": 36}}],
        "buffers": [{{"uri": "{uri}", "byteLength": 36}}]}}"""
    )
    with raises(MESH_UNREADABLE, name=str(folder / "a.gltf")):
        load_mesh(Mesh(uri="", path=folder / "a.gltf"))


def test_a_repository_full_of_pipes_is_searched(tmp_path):
    for name in ("a.urdf", "package.xml", "CMakeLists.txt", "b.yaml", "c.material"):
        os.mkfifo(tmp_path / name)
    (tmp_path / "robot.urdf").write_text('<robot name="r"><link name="a"/></robot>')
    assert [path.name for path in robots_in(tmp_path)] == ["robot.urdf"]
    assert load(tmp_path / "robot.urdf").name == "r"
    check(tmp_path / "robot.urdf")


@pytest.mark.parametrize("pipe", ["CMakeLists.txt", "plugins.xml"])
def test_pipes_in_packages_beside_a_robot_are_not_read(tmp_path, pipe):
    """These files are searched for plugins and controllers that the repository builds."""
    (tmp_path / ".git").mkdir()
    for name in ("arm", "plugins"):
        (tmp_path / name).mkdir()
        (tmp_path / name / "package.xml").write_text(
            f"<package><name>{name}</name><buildtool_depend>ament_cmake</buildtool_depend></package>"
        )
    os.mkfifo(tmp_path / "plugins" / pipe)
    path = tmp_path / "arm" / "robot.urdf"
    plugin = '<gazebo><plugin name="p" filename="libgazebo_ros_laser.so"/></gazebo>'
    path.write_text(f'<robot name="r"><link name="a"/>{plugin}</robot>')
    assert PLUGIN_OF_OTHER_ROS in {each.code for each in check(path).findings}
    assert exporting_file(path, "own_controllers/Own") is None
