"""Includes of absent packages and files, and the macros that they would have defined."""

import pytest
from tests.coded import raises

from cartwheel import World
from cartwheel.codes.files import (
    FILE_ELSEWHERE,
    FILE_MISSING,
    INCLUDE_ABSENT,
    LINK_RECONNECTED,
    MACRO_ABSENT,
    XACRO_NAME_UNKNOWN,
)
from cartwheel.description import load_robot
from cartwheel.errors import DescriptionError

XACRO = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">{}</robot>'
INCLUDE = '<xacro:include filename="{}"/>'
LASER = "$(find laser_x)/laser.xacro"
BASE = """<link name="base"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link>"""


@pytest.fixture
def load(tmp_path, monkeypatch):
    """Loads a robot from the contents of its file, which is in a package of a workspace."""
    monkeypatch.delenv("ROS_DISTRO", raising=False)
    folder = tmp_path / "src" / "mine" / "urdf"
    folder.mkdir(parents=True)
    (folder.parent / "package.xml").write_text("<package><name>mine</name></package>")

    def loaded(*contents, **others):
        for name, text in others.items():
            (folder / f"{name}.xacro").write_text(XACRO.format(text))
        (folder / "robot.xacro").write_text(XACRO.format("\n".join(contents)))
        return load_robot(folder / "robot.xacro")

    return loaded


def reported(robot, code):
    """The line and the values of each diagnostic with a code."""
    return [(each.origin.line, each.values) for each in robot.diagnostics if each.code is code]


def poses(robot):
    return {link.name: tuple(round(x, 6) for x in link.pose.position) for link in robot.links}


def test_the_rest_of_the_robot_is_loaded(load):
    robot = load(INCLUDE.format(LASER), BASE, '<xacro:laser name="front" parent="base"/>')
    assert [link.name for link in robot.links] == ["base"]
    ((line, values),) = reported(robot, INCLUDE_ABSENT)
    assert line == 1
    assert values["name"] == values["package"] == "laser_x"
    assert values["file"] == LASER
    ((line, values),) = reported(robot, MACRO_ABSENT)
    assert line == 5
    assert values["name"] == "xacro:laser"
    assert values["package"] == "laser_x"


def test_the_robot_without_the_part_is_simulated(load):
    robot = load(INCLUDE.format(LASER), BASE, '<xacro:laser name="front" parent="base"/>')
    with World() as world:
        model = world.spawn(robot, z=0.5)
        world.run(1.0)
        assert model.pose.z == pytest.approx(0.1, abs=0.01)


def test_every_absent_package_is_reported(load):
    robot = load(
        INCLUDE.format(LASER),
        INCLUDE.format("part.xacro"),
        BASE,
        '<xacro:laser_x_front parent="base"/><xacro:imu_z parent="base"/>',
        part=INCLUDE.format("$(find imu_z)/imu.xacro"),
    )
    found = [values["package"] for _, values in reported(robot, INCLUDE_ABSENT)]
    assert found == ["laser_x", "imu_z"]
    # Each call is explained by the file whose name is most like its own.
    assert [values["package"] for _, values in reported(robot, MACRO_ABSENT)] == found


def test_a_link_that_others_refer_to_is_empty_at_the_place_of_the_part(load):
    robot = load(
        INCLUDE.format(LASER),
        BASE,
        '<xacro:laser name="front" parent="base"><origin xyz="0.3 0 ${0.1 * 2}"/></xacro:laser>',
        '<link name="hood"/><joint name="j" type="fixed"><origin xyz="0 0 0.1"/>'
        '<parent link="front_link"/><child link="hood"/></joint>',
    )
    assert poses(robot) == {"base": (0, 0, 0), "front_link": (0.3, 0, 0.2), "hood": (0.3, 0, 0.3)}
    values = [values for _, values in reported(robot, LINK_RECONNECTED)]
    assert values == [
        {"link": "front_link", "parent": ""},
        {"link": "front_link", "parent": "base"},
    ]
    # Other programs read the text that Cartwheel publishes: their robot is one tree, too.
    assert '<link name="front_link"' in robot.text


def test_a_child_link_that_is_left_out_is_empty_at_its_joint(load):
    robot = load(
        INCLUDE.format(LASER),
        BASE,
        '<xacro:laser name="laser"/><joint name="j" type="fixed"><origin xyz="0 0.2 0"/>'
        '<parent link="base"/><child link="laser"/></joint>',
    )
    assert poses(robot) == {"base": (0, 0, 0), "laser": (0, 0.2, 0)}


def test_a_link_whose_joint_is_left_out_is_attached_to_the_rest(load):
    robot = load(
        INCLUDE.format(LASER),
        '<link name="mast"/>',
        BASE,
        '<link name="wheel"/><joint name="w" type="continuous"><parent link="base"/>'
        '<child link="wheel"/></joint>',
    )
    assert [joint.parent for joint in robot.joints if joint.child == "mast"] == ["base"]


def test_a_complete_robot_is_not_changed(load):
    with raises(XACRO_NAME_UNKNOWN, name="xacro:laser"):
        load(BASE, '<xacro:laser name="front" parent="base"/>')


def test_an_optional_include_is_not_reported(load):
    robot = load('<xacro:include filename="a.xacro" optional="true"/>', BASE)
    assert reported(robot, INCLUDE_ABSENT) == []


def test_a_property_of_an_absent_file_is_an_error_that_names_the_file(load):
    with raises(XACRO_NAME_UNKNOWN, kind="property", name="size", absent=(LASER,)):
        load(INCLUDE.format(LASER), BASE, '<link name="${size}"/>')


def test_nothing_is_left_of_the_robot(load):
    with raises(FILE_MISSING, DescriptionError, kind="package", name="laser_x"):
        load(INCLUDE.format(LASER), '<xacro:laser name="front"/>')


def test_nothing_but_the_world_is_left_of_the_robot(load):
    with raises(FILE_MISSING, name="laser_x"):
        load(INCLUDE.format(LASER), '<link name="world"/>', "<xacro:laser/>")


def test_a_yaml_file_of_an_absent_package_is_reported_by_the_package(load):
    with raises(FILE_MISSING, name="laser_x"):
        load(
            BASE,
            '<xacro:property name="sizes" '
            "value=\"${xacro.load_yaml('$(find laser_x)/sizes.yaml')}\"/>",
            '<link name="${sizes}"/>',
        )


def test_a_mesh_in_an_absent_package_is_left_out(load):
    mesh = '<link name="base"><visual><geometry><mesh filename="file://{}"/></geometry></visual></link>'
    robot = load(mesh.format("$(find shapes_y)/a.stl"))
    assert reported(robot, FILE_MISSING)[0][1]["name"] == "shapes_y"


@pytest.mark.wording
def test_the_hint_says_how_to_get_the_package(load, monkeypatch):
    def hint():
        robot = load(INCLUDE.format(LASER), BASE)
        return next(each.hint for each in robot.diagnostics if each.code is INCLUDE_ABSENT)

    assert "Install the package with apt" in hint()
    monkeypatch.setenv("ROS_DISTRO", "noetic")
    assert "sudo apt install ros-noetic-laser-x. Or" in hint()


@pytest.mark.parametrize("package", ["$(find former)", "package://former", "$(find laser_x)"])
def test_an_include_from_the_own_package_under_its_former_name(load, package):
    robot = load(
        INCLUDE.format(f"{package}/urdf/base.xacro"),
        INCLUDE.format(f"{package}/urdf/absent.xacro"),
        base=BASE,
    )
    assert [link.name for link in robot.links] == ["base"]
    ((line, values),) = reported(robot, FILE_ELSEWHERE)
    assert line == 1
    assert values["name"] == f"{package}/urdf/base.xacro"
    assert values["used"].endswith("src/mine/urdf/base.xacro")
    # The package may be installed elsewhere, and contain another file with this name.
    assert values["needed_for"] == "include"
    assert values["unfound"] == package.strip("$()").split()[-1].removeprefix("package://")
    assert [each.severity for each in robot.diagnostics if each.code is FILE_ELSEWHERE] == [
        "warning"
    ]
    assert [line for line, _ in reported(robot, INCLUDE_ABSENT)] == [2]


@pytest.mark.parametrize("start", ["file://", "$file://", ""])
def test_an_include_by_a_path_of_another_computer_is_read_and_stops_xacro(load, start):
    """A dollar before it makes it a relative path."""
    path = f"{start}/opt/work/src/mine/urdf/base.xacro"
    robot = load(INCLUDE.format(path), base=BASE)
    assert [link.name for link in robot.links] == ["base"]
    ((_, values),) = reported(robot, FILE_ELSEWHERE)
    assert values["needed_for"] == "include"
    assert not reported(robot, INCLUDE_ABSENT)


@pytest.mark.parametrize("package", ["$(find former)", "package://former"])
def test_an_include_under_a_former_name_never_leads_back_to_itself(load, package):
    robot = load(
        BASE,
        INCLUDE.format(f"{package}/urdf/robot.xacro"),
        INCLUDE.format(f"{package}/urdf/part.xacro"),
        part=INCLUDE.format(f"{package}/urdf/robot.xacro") + '<link name="part"/>',
    )
    assert {link.name for link in robot.links} == {"base", "part"}
    assert len(reported(robot, INCLUDE_ABSENT)) == 2
    ((_, values),) = reported(robot, FILE_ELSEWHERE)
    assert values["name"] == f"{package}/urdf/part.xacro"


def test_a_yaml_file_of_the_own_package_under_its_former_name(load, tmp_path):
    (tmp_path / "src" / "mine" / "size.yaml").write_text("mass: 2.5")
    robot = load(
        '<xacro:property name="size" value="${xacro.load_yaml(\'$(find former)/size.yaml\')}"/>',
        BASE.replace('mass value="1"', "mass value=\"${size['mass']}\""),
    )
    assert robot.links[0].inertial.mass == 2.5
    assert [values["name"] for _, values in reported(robot, FILE_ELSEWHERE)] == [
        "$(find former)/size.yaml"
    ]


@pytest.mark.parametrize("scheme", ["", "file://"])
def test_a_mesh_of_the_own_package_under_its_former_name(load, tmp_path, scheme):
    """xacro stops at a package that does not exist, also within a URI."""
    meshes = tmp_path / "src" / "mine" / "meshes"
    meshes.mkdir()
    corners = ("0 0 0", "0.2 0 0", "0 0.2 0", "0 0 0.2")
    points = "\n".join(f"v {each}" for each in corners)
    (meshes / "hull.obj").write_text(f"{points}\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    name = f"{scheme}$(find former)/meshes/hull.obj"
    robot = load(BASE.replace('<box size="0.2 0.2 0.2"/>', f'<mesh filename="{name}"/>'))
    assert len(robot.links[0].collisions) == 1
    ((_, values),) = reported(robot, FILE_ELSEWHERE)
    assert values["name"] == name
