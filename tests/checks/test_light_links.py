"""What hardly weighs is no fault of the robot's."""

import pytest

from cartwheel.checks.checking import check

BASE = (
    '<link name="base">'
    '<inertial><mass value="{base}"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
    '</inertial><collision><geometry><box size="1 1 1"/></geometry></collision></link>'
)
CAMERA = (
    '<link name="camera"><inertial><mass value="0.01"/>{inertia}</inertial><collision><geometry>'
    '<box size="0.1 0.1 0.1"/></geometry></collision></link><joint name="j" type="fixed">'
    '<parent link="base"/><child link="camera"/></joint>'
)
IMPOSSIBLE = '<inertia ixx="1e-5" iyy="1e-5" izz="1e-4" ixy="0" ixz="0" iyz="0"/>'
TINY = '<inertia ixx="1e-9" iyy="1e-9" izz="1e-9" ixy="0" ixz="0" iyz="0"/>'


@pytest.fixture
def severities(tmp_path):
    def find(rule, base, inertia):
        path = tmp_path / "robot.urdf"
        text = BASE.format(base=base) + CAMERA.format(inertia=inertia)
        path.write_text(f'<robot name="robot">{text}</robot>')
        return [each.severity for each in check(str(path)).findings if each.code.name == rule]

    return find


@pytest.mark.parametrize(("base", "severity"), [(10.0, "info"), (0.5, "warning")])
def test_a_tiny_inertia_of_a_link_without_weight_is_a_note(severities, base, severity):
    assert severity in severities("inertia-geometry-mismatch", base, TINY)


def test_an_impossible_inertia_that_hardly_counts_is_a_note(severities):
    assert severities("inertia-impossible", 10.0, IMPOSSIBLE) == ["info"]


@pytest.mark.parametrize(("radius", "reported"), [(1e-6, False), (0.01, True)])
def test_a_link_that_only_marks_a_place_has_no_inertia_of_its_shape(tmp_path, radius, reported):
    """Gazebo needs a larger one than that of such a body."""
    path = tmp_path / "robot.urdf"
    path.write_text(
        '<robot name="robot"><link name="base"><inertial><mass value="1e-5"/>'
        '<inertia ixx="1e-6" iyy="1e-6" izz="1e-6" '
        'ixy="0" ixz="0" iyz="0"/></inertial><collision><geometry>'
        f'<sphere radius="{radius}"/></geometry></collision></link></robot>'
    )
    names = {each.code.name for each in check(str(path)).findings}
    assert ("inertia-geometry-mismatch" in names) == reported
