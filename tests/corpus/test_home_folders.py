"""Files that only the author's computer has, although the robot's package contains them."""

import pytest
from tests.corpus.carts import cart, controlled, plugin
from tests.dialects.ros_control.arms import ROS1, transmission

from cartwheel.checks import check
from cartwheel.codes.devices import CONTROLLERS_FILE_UNREADABLE
from cartwheel.codes.files import FILE_ELSEWHERE
from cartwheel.corpus import try_robot
from cartwheel.description.launches import launches_near

BOX = (0, 0, 0), (0.1, 0, 0), (0, 0.1, 0), (0, 0, 0.1)
"""The corners of a tetrahedron."""
FACES = (0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)
HOME = "/home/me/ws/src/my_cart"
OPT = "/opt/robots/my_cart"


def package(tmp_path, *parts):
    own = tmp_path / "my_cart"
    for folder in (own / "meshes", own / "config", own / "launch"):
        folder.mkdir(parents=True)
    (own / "package.xml").write_text("<package><name>my_cart</name></package>")
    corners = "".join(f"v {x} {y} {z}\n" for x, y, z in BOX)
    faces = "".join(f"f {a + 1} {b + 1} {c + 1}\n" for a, b, c in FACES)
    (own / "meshes" / "mast.obj").write_text(corners + faces)
    path = own / "cart.urdf"
    path.write_text(f'<robot name="cart">{cart()}{"".join(parts)}</robot>')
    return path


def mast(uri, kind):
    return (
        f'<link name="mast"><{kind}><geometry><mesh filename="{uri}"/></geometry></{kind}></link>'
        '<joint name="m" type="fixed"><origin xyz="0 0 0.1"/><parent link="base"/>'
        '<child link="mast"/></joint>'
    )


def faults(verdict):
    return [(each.test, each.code, each.source) for each in verdict.faults]


@pytest.mark.parametrize("scheme", ["", "file://"])
@pytest.mark.parametrize(
    ("folder", "kind", "expected"),
    [
        (HOME, "collision", [("load", FILE_ELSEWHERE, "file")]),
        (HOME, "visual", []),
        # A container may have the file there.
        (OPT, "collision", []),
    ],
)
def test_a_collision_mesh_in_the_home_folder_of_the_author(
    tmp_path, scheme, folder, kind, expected
):
    uri = f"{scheme}{folder}/meshes/mast.obj"
    path = package(tmp_path, mast(uri, kind), plugin())
    verdict = try_robot(path, standing=1.0)
    assert faults(verdict) == expected
    (reported,) = (each for each in check(path).findings if each.code is FILE_ELSEWHERE)
    assert reported.severity == ("error" if expected else "warning")
    assert reported.values.get("needed_for") == ("collision" if expected else None)


def test_a_mesh_that_is_first_only_seen(tmp_path):
    uri = f"{HOME}/meshes/mast.obj"
    shapes = f'<geometry><mesh filename="{uri}"/></geometry>'
    both = mast(uri, "collision").replace("<collision>", f"<visual>{shapes}</visual><collision>")
    verdict = try_robot(package(tmp_path, both, plugin()), standing=1.0)
    assert faults(verdict) == [("load", FILE_ELSEWHERE, "file")]


def test_an_included_xacro_in_the_home_folder(tmp_path):
    include = f'<xacro:include filename="{HOME}/mast.xacro"/>'
    path = package(tmp_path, include, plugin())
    text = path.read_text().replace("<robot ", '<robot xmlns:xacro="http://ros.org/wiki/xacro" ')
    path = path.with_suffix(".xacro")
    path.write_text(text)
    box = '<geometry><box size="0.1 0.1 0.1"/></geometry>'
    part = mast("", "visual").replace('<geometry><mesh filename=""/></geometry>', box)
    (path.parent / "mast.xacro").write_text(f"<robot>{part}</robot>")
    verdict = try_robot(path, standing=1.0)
    assert verdict.links == 6
    assert faults(verdict) == [("load", FILE_ELSEWHERE, "file")]


@pytest.mark.parametrize("folder", [HOME, OPT])
def test_a_controller_file_in_the_home_folder(tmp_path, folder):
    path = package(tmp_path)
    parts = controlled(path.parent / "config").replace(str(path.parent), folder)
    path.write_text(f'<robot name="cart">{cart()}{parts}</robot>')
    verdict = try_robot(path, standing=1.0)
    assert verdict.controllers == ("base",)
    expected = [("controller", FILE_ELSEWHERE, "file")] if folder == HOME else []
    assert faults(verdict) == expected
    (reported,) = (each for each in check(path).findings if each.code is FILE_ELSEWHERE)
    assert reported.severity == ("error" if expected else "warning")


@pytest.mark.parametrize("folder", [HOME, "$(find my_cart)"])
def test_a_rosparam_in_the_home_folder(tmp_path, folder):
    parts = "".join(transmission(f"{side}_joint", "Velocity") for side in SIDES)
    path = package(tmp_path, parts, f"<gazebo>{ROS1}</gazebo>")
    (path.parent / "config" / "base.yaml").write_text(
        "base:\n  type: diff_drive_controller/DiffDriveController\n  left_wheel: left_joint\n"
        "  right_wheel: right_joint\n  wheel_separation: 0.2\n  wheel_radius: 0.05\n"
    )
    (path.parent / "launch" / "start.launch").write_text(
        '<launch><param name="robot_description" textfile="$(find my_cart)/cart.urdf"/>'
        f'<rosparam file="{folder}/config/base.yaml"/>'
        '<node pkg="controller_manager" type="spawner" name="s" args="base"/>'
        '<node pkg="gazebo_ros" type="spawn_model" name="m" '
        'args="-urdf -param robot_description -model cart"/></launch>'
    )
    verdict = try_robot(path, standing=1.0, launches=launches_near(path.parent))
    expected = [("controller", CONTROLLERS_FILE_UNREADABLE, "file")] if folder == HOME else []
    assert [each for each in faults(verdict) if each[0] == "controller"] == expected
    assert verdict.outcome == ("file" if expected else "good")


SIDES = ("left", "right")
