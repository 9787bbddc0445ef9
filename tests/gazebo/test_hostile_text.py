"""What clients of services cannot reach: xacro in texts, and files outside of their folders."""

from pathlib import Path

import pytest
from tests.coded import raises

from cartwheel.codes import files
from cartwheel.description import load_plain
from cartwheel.description.files.readable_files import Reach
from cartwheel.gazebo.ros2_api import Ros2Api

from .conftest import SDF, URDF, Gazebo

NS = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
XACRO = {
    "element": f'<robot name="r" {NS}><xacro:property name="a" value="1"/><link name="l"/></robot>',
    "undeclared element": '<robot name="r"><xacro:include filename="/etc/passwd"/></robot>',
    "expression": f"<robot name='r' {NS}><link name='${{().__class__}}'/></robot>",
    "undeclared expression": "<robot name='r'><link name='${1 + 1}'/></robot>",
    "eval": f"<robot name='r' {NS}><link name='$(eval 1 + 1)'/></robot>",
    "arg": "<robot name='r'><link name='$(arg a)'/></robot>",
    "env": "<robot name='r'><link name='$(env HOME)'/></robot>",
    "optenv in text": "<robot name='r'><link name='l'/><gazebo><a>$(optenv HOME)</a></gazebo>"
    "</robot>",
    "sdf": f'<sdf version="1.6" {NS}><model name="${{1}}"><link name="l"/></model></sdf>',
}


@pytest.fixture
def api(make, tmp_path, monkeypatch):
    """Services of a run whose client may name files in `allowed`."""
    (tmp_path / "allowed").mkdir()
    (tmp_path / "run").mkdir()
    monkeypatch.chdir(tmp_path / "run")
    world = make.world()
    world.session.allow_path = (tmp_path / "allowed",)
    return world


def gz(world):
    return Gazebo(world, api=Ros2Api, prefix="")


@pytest.mark.parametrize("name", XACRO)
def test_xacro_in_a_text_is_not_expanded(api, name):
    with raises(files.XACRO_NOT_EXPANDED) as refused:
        load_plain(XACRO[name], file="<x>", reach=Reach(folders=()))
    why = refused.value.code, refused.value.values
    gazebo = Gazebo(api)
    for service in ("spawn_urdf_model", "spawn_sdf_model"):
        gazebo.fails(service, *why, model_name="x", model_xml=XACRO[name])
    ros2 = gz(api)
    ros2.fails("spawn_entity", *why, name="x", xml=XACRO[name])
    resource = {"resource_string": XACRO[name]}
    ros2.fails("gz_server/spawn_entity", *why, name="x", entity_resource=resource)
    create = f"world/{api.session.simulation.world.name}/create"
    ros2.fails(create, *why, entity_factory={"sdf": XACRO[name]})
    assert "x" not in api.session.simulation.models


def test_plain_text_spawns_with_a_namespace_left_over_and_packages(api, tmp_path, monkeypatch):
    (tmp_path / "ws" / "things").mkdir(parents=True)
    (tmp_path / "ws" / "things" / "package.xml").write_text(
        "<package><name>things</name></package>"
    )
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "ws"))
    text = URDF.replace('name="brick"', f'name="brick" {NS}').replace(
        "</robot>", '<gazebo><a b="$(find things)/x"/></gazebo></robot>'
    )
    assert Gazebo(api)("spawn_urdf_model", model_name="brick", model_xml=text).success
    (text,) = [
        each.description.text
        for each in api.session.simulation.scene.models
        if each.name == "brick"
    ]
    assert f"{tmp_path}/ws/things/x" in text


OUTSIDE = [
    "{secret}",
    "file://{secret}",
    "{allowed}/../secret.sdf",
    "file://{allowed}/%2e%2e/secret.sdf",
    "{allowed}/link.sdf",
    "{allowed}/folder/secret.sdf",
    "../secret.sdf",
    "/etc/passwd",
    "/dev/zero",
    "file:///proc/self/environ",
    "{root}/nothing.sdf",
    "{allowed}/.hidden/secret.sdf",
]


@pytest.mark.parametrize("uri", OUTSIDE)
def test_files_outside_are_refused_whether_they_exist_or_not(api, tmp_path, uri):
    allowed, secret = tmp_path / "allowed", tmp_path / "secret.sdf"
    secret.write_text(SDF)
    (allowed / "link.sdf").symlink_to(secret)
    (allowed / "folder").symlink_to(tmp_path)
    (allowed / ".hidden").mkdir()
    (allowed / ".hidden" / "secret.sdf").write_text(SDF)
    uri = uri.format(secret=secret, allowed=allowed, root=tmp_path)
    ros2, code = gz(api), files.FILE_NOT_ALLOWED
    ros2.fails("gz_server/spawn_entity", code, name="x", entity_resource={"uri": uri})
    create = f"world/{api.session.simulation.world.name}/create"
    ros2.fails(create, code, entity_factory={"name": "x", "sdf_filename": uri})
    assert "x" not in api.session.simulation.models


def test_files_in_allowed_folders_of_the_run_and_of_packages_are_read(api, tmp_path):
    (tmp_path / "allowed" / "brick.sdf").write_text(SDF)
    ros2 = gz(api)
    create = f"world/{api.session.simulation.world.name}/create"
    for name, uri in {
        "a": f"{tmp_path}/allowed/brick.sdf",
        "b": (tmp_path / "allowed" / "brick.sdf").as_uri(),
        "c": "model://traffic_cone",
        "d": "traffic_cone",
    }.items():
        assert ros2(create, entity_factory={"name": name, "sdf_filename": uri}).success
        assert name in api.session.simulation.models


def test_sources_outside_are_named(api, tmp_path):
    ros2, code = gz(api), files.FILE_NOT_ALLOWED
    ros2.fails("gz_server/get_spawnables", code, sources=[str(tmp_path)])
    ros2.fails("gz_server/get_available_worlds", code, additional_sources=["/etc"])


@pytest.mark.wording
def test_the_option_that_allows_a_folder_is_named(api):
    reported = gz(api)("gz_server/get_available_worlds", additional_sources=["/etc"])
    assert "allow_path=" in reported.result.error_message


@pytest.mark.parametrize("path", ["/etc/passwd", "../../secret.yaml"])
def test_controllers_files_of_a_text_lie_in_packages_too(api, path):
    text = URDF.replace(
        "</robot>",
        '<gazebo><plugin name="c" filename="libgz_ros2_control-system.so">'
        f"<parameters>{path}</parameters></plugin></gazebo></robot>",
    )
    gz(api).fails("spawn_entity", files.FILE_NOT_ALLOWED, name="x", xml=text)


@pytest.mark.parametrize("uri", ["{secret}", "file://{secret}", "../secret.stl", "/etc/passwd"])
@pytest.mark.parametrize("tag", ["mesh", "texture"])
def test_meshes_of_a_text_lie_in_packages_too(tmp_path, monkeypatch, uri, tag):
    (tmp_path / "run").mkdir()
    monkeypatch.chdir(tmp_path / "run")
    (tmp_path / "secret.stl").write_text("solid a\nendsolid a\n")
    uri = uri.format(secret=tmp_path / "secret.stl")
    part = (
        f'<geometry><mesh filename="{uri}"/></geometry>'
        if tag == "mesh"
        else f'<geometry><sphere radius="1"/></geometry>'
        f'<material name="m"><texture filename="{uri}"/></material>'
    )
    text = f'<robot name="r"><link name="l"><visual>{part}</visual></link></robot>'
    found = load_plain(text, file="<x>", reach=Reach(folders=(Path.cwd(),)))
    assert any(each.code is files.FILE_NOT_ALLOWED for each in found.diagnostics)
