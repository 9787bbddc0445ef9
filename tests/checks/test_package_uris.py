"""``package://`` URIs in SDF files, which Gazebo Classic does not know."""

import pytest

import cartwheel
from cartwheel.codes.files import PACKAGE_URI_IN_SDF

MESH = "<geometry><mesh><uri>{uri}</uri></mesh></geometry>"
CLASSIC = '<plugin name="p" filename="libgazebo_ros_p3d.so"/>'
GZ = '<plugin name="p" filename="gz-sim-pose-publisher-system"/>'
STL = (
    "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
    "endloop\nendfacet\nendsolid s\n"
)


def found(folder, uri, plugin=""):
    model = folder / "models" / "robot"
    (model / "meshes").mkdir(parents=True)
    (model / "meshes" / "leg.stl").write_text(STL)
    mesh = MESH.format(uri=uri)
    path = model / "model.sdf"
    path.write_text(
        f'<sdf version="1.6"><model name="robot"><link name="leg"><visual name="v">{mesh}</visual>'
        f'<collision name="c">{mesh}</collision></link>{plugin}</model></sdf>'
    )
    return [each for each in cartwheel.check(path).findings if each.code is PACKAGE_URI_IN_SDF]


@pytest.mark.parametrize(
    ("plugin", "severity"),
    [
        (CLASSIC, "warning"),
        ("", "info"),
        (GZ, None),
        (CLASSIC + GZ, None),
        ('<plugin name="p" filename="libign_ros2_control-system.so"/>', None),
        ('<plugin name="p" filename="libdesign_ros.so"/>', "info"),
    ],
)
def test_a_package_uri_in_sdf_is_reported_once_for_gazebo_classic(tmp_path, plugin, severity):
    reported = found(tmp_path, "package://robot/meshes/leg.stl", plugin)
    assert [each.severity for each in reported] == ([severity] if severity else [])
    assert all(each.values["places"] == 2 for each in reported)


@pytest.mark.parametrize("uri", ["model://robot/meshes/leg.stl", "meshes/leg.stl"])
def test_other_uris_are_not(tmp_path, uri):
    assert not found(tmp_path, uri, CLASSIC)


def test_a_urdf_may_contain_package_uris(tmp_path):
    (tmp_path / "package.xml").write_text("<package><name>robot</name></package>")
    (tmp_path / "leg.stl").write_text(STL)
    path = tmp_path / "robot.urdf"
    path.write_text(
        '<robot name="robot"><link name="leg"><visual><geometry>'
        '<mesh filename="package://robot/leg.stl"/></geometry></visual></link>'
        f"<gazebo>{CLASSIC}</gazebo></robot>"
    )
    codes = {each.code for each in cartwheel.check(path).findings}
    assert PACKAGE_URI_IN_SDF not in codes


@pytest.mark.wording
def test_the_hint_names_the_folder_of_the_model(tmp_path):
    (one,) = found(tmp_path, "package://models/robot/meshes/leg.stl", CLASSIC)
    assert "model://robot/meshes/leg.stl" in one.hint
