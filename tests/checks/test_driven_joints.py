"""Joints that several plugins drive, as the simulation reports them as well."""

import pytest
from tests.corpus.carts import cart, controlled, plugin, written
from tests.corpus.test_rivals import MANAGER, managed

from cartwheel.api import World
from cartwheel.checks.checking import check
from cartwheel.codes.robot import WHEEL_SEPARATION_MISMATCH
from cartwheel.codes.running import JOINT_DRIVEN_TWICE

AGAIN = plugin().replace('name="drive"', 'name="again"')
STATES = (
    '<gazebo><plugin name="s" filename="libgazebo_ros_joint_state_publisher.so">'
    "<jointName>left_joint, right_joint</jointName></plugin></gazebo>"
)
SECOND = MANAGER.replace('name="control"', 'name="again"')
BOTH = ("left_joint", "right_joint")


@pytest.mark.parametrize(
    ("parts", "joints"),
    [
        ([plugin()], ()),
        ([plugin(), STATES], ()),
        ([plugin(), AGAIN], BOTH),
        ([plugin(), controlled], BOTH),
        ([controlled], ()),
        ([managed("Velocity")], ()),
        ([plugin(), managed("Velocity")], BOTH),
        ([plugin(), managed("Effort")], ()),
        ([managed("Effort"), SECOND], BOTH),
    ],
    ids=lambda value: "",
)
def test_two_drivers_of_a_joint_are_found_without_a_simulation(tmp_path, parts, joints):
    path = written(tmp_path, cart(), *(p(tmp_path) if callable(p) else p for p in parts))
    found = [each for each in check(path).findings if each.code is JOINT_DRIVEN_TWICE]
    assert {name for each in found for name in each.values["joints"]} == set(joints)
    with World("empty", lenient=True) as world:
        world.spawn(path)
        world.run(0.1)
        said = [each for each in world.diagnostics if each.code is JOINT_DRIVEN_TWICE]
    assert {each.values["joint"] for each in said} == set(joints)


@pytest.mark.parametrize(
    ("starts", "listed", "reported"),
    [
        (True, managed("Effort"), True),
        (False, managed("Effort"), False),
        # Without a transmission, the controller cannot start.
        (True, MANAGER, False),
    ],
)
def test_a_controller_near_a_robot_counts_if_a_launch_file_starts_it(
    tmp_path, starts, listed, reported
):
    (tmp_path / "package.xml").write_text("<package><name>robot</name></package>")
    (tmp_path / "config").mkdir()
    (tmp_path / "config" / "base.yaml").write_text(
        "base:\n  type: diff_drive_controller/DiffDriveController\n  left_wheel: left_joint\n"
        "  right_wheel: right_joint\n  wheel_separation: 0.2\n  wheel_radius: 0.05\n"
    )
    if starts:
        (tmp_path / "sim.launch").write_text(
            '<launch><param name="robot_description" textfile="$(find robot)/robot.urdf"/>'
            '<rosparam file="$(find robot)/config/base.yaml" command="load"/>'
            '<node name="s" pkg="controller_manager" type="spawner" args="base"/></launch>'
        )
    path = written(tmp_path, cart(), plugin(), listed)
    found = [each for each in check(path).findings if each.code is JOINT_DRIVEN_TWICE]
    assert [each.values["joints"] for each in found] == [BOTH] * reported


@pytest.mark.parametrize(("diameter", "turns"), [(0.1, None), (0.08, 1.5 * 0.1 / 0.08)])
def test_a_wrong_separation_counts_together_with_a_wrong_diameter(tmp_path, diameter, turns):
    """The wheels are 0.2 m apart and have a diameter of 0.1 m."""
    wrong = plugin().replace("<wheelSeparation>0.2", "<wheelSeparation>0.3")
    wrong = wrong.replace("<wheelDiameter>0.1<", f"<wheelDiameter>{diameter}<")
    path = written(tmp_path, cart(), wrong)
    found = [each for each in check(path).findings if each.code is WHEEL_SEPARATION_MISMATCH]
    assert [each.values.get("turns") for each in found] == [pytest.approx(turns)]
