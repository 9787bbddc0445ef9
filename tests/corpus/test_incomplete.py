"""Robots without a mass, or without a part that is not there."""

import pytest
from tests.corpus.carts import cart, plugin, written

from cartwheel.codes.files import INCLUDE_ABSENT
from cartwheel.codes.robot import BASE_WITHOUT_COLLISION, INERTIA_MISSING
from cartwheel.corpus import try_robot

MASS = '<inertial><mass value="2"/><inertia ixx="0.02" iyy="0.02" izz="0.02"/></inertial>'
COLLISION = '<collision><geometry><box size="0.3 0.15 0.06"/></geometry></collision>'
XACRO = '<robot name="robot" xmlns:xacro="http://www.ros.org/wiki/xacro">'
INCLUDE = '<xacro:include filename="$(find no_such_package)/urdf/arm.xacro"/>'
CALL = '<xacro:no_such_arm parent="base"/>'


def expanded(folder, *parts):
    path = folder / "robot.urdf.xacro"
    path.write_text(f"{XACRO}{''.join(parts)}</robot>")
    return path


def test_gazebo_does_not_load_a_robot_whose_root_has_no_mass(tmp_path):
    massless = cart().replace(MASS, "", 1)
    assert massless != cart()
    verdict = try_robot(written(tmp_path, massless, plugin()), standing=1.0)
    assert verdict.loaded
    assert [(each.test, each.code) for each in verdict.faults] == [("load", INERTIA_MISSING)]
    assert verdict.outcome == "file"
    assert try_robot(written(tmp_path, cart(), plugin()), standing=1.0).good


def test_links_need_no_mass_in_a_description_that_nothing_starts_in_gazebo(tmp_path):
    massless = cart().replace(MASS, "", 1)
    assert try_robot(written(tmp_path, massless), standing=1.0).good
    (tmp_path / "package.xml").write_text("<package><name>robot</name></package>")
    launch = tmp_path / "show.launch"
    shown = (
        '<launch><param name="robot_description" textfile="$(find robot)/robot.urdf"/>{}</launch>'
    )
    spawner = '<node name="s" pkg="gazebo_ros" type="spawn_model" args="-param robot_description"/>'
    for node, good in (("", True), (spawner, False)):
        launch.write_text(shown.format(node))
        assert try_robot(written(tmp_path, massless), standing=1.0).good == good


def test_a_mass_may_be_in_a_part_that_is_missing(tmp_path):
    massless = cart().replace(MASS, "", 1)
    verdict = try_robot(expanded(tmp_path, INCLUDE, massless, plugin()), standing=1.0)
    assert INERTIA_MISSING not in {each.code for each in verdict.faults}


@pytest.mark.parametrize(
    ("parts", "reason"),
    [([], BASE_WITHOUT_COLLISION), ([INCLUDE, CALL], INCLUDE_ABSENT)],
)
def test_a_robot_may_fall_because_a_part_is_missing_that_has_its_collisions(
    tmp_path, parts, reason
):
    body = f'<link name="base">{MASS}</link>'
    verdict = try_robot(expanded(tmp_path, *parts, body), standing=1.0)
    (fault,) = verdict.faults
    assert (fault.test, fault.code, fault.source) == ("stand", reason, "file")
