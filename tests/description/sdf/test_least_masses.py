"""Masses below those that the engine takes, such as of models that are only frames."""

import pytest

from cartwheel.api import World
from cartwheel.codes.tags import VALUE_IGNORED
from cartwheel.description import load, load_text
from cartwheel.description.inertia import LIGHTEST

FRAME = (
    '<sdf version="1.6"><model name="frame"><link name="l"><inertial><mass>{mass}</mass><inertia>'
    "<ixx>{mass}</ixx><iyy>{mass}</iyy><izz>{mass}</izz></inertia></inertial>"
    '<collision name="c"><geometry><sphere><radius>0.1</radius></sphere></geometry></collision>'
    "</link>{more}</model></sdf>"
)
HOLDER = (
    '<link name="holder"><inertial><mass>1</mass></inertial></link><joint name="j" type="fixed">'
    "<parent>holder</parent><child>l</child></joint>"
)


def reported(description):
    return [each for each in description.diagnostics if each.code is VALUE_IGNORED]


@pytest.mark.parametrize("mass", ["1e-15", "1e-109"])
def test_a_light_link_falls_as_any_other(mass):
    """Half a second of free fall; a step of 5 ms adds half a step's way, g t dt / 2."""
    robot = load_text(FRAME.format(mass=mass, more=""))
    (found,) = reported(robot)
    assert found.severity == "info"
    assert found.values == {"link": "l", "stated": float(mass), "used": LIGHTEST}
    assert robot.link("l").inertial.mass == LIGHTEST
    with World("empty") as world:
        model = world.spawn(robot, z=5.0)
        world.run(0.5)
        assert model.pose.z == pytest.approx(5.0 - 9.8 * 0.5**2 / 2, abs=9.8 * 0.5 * 0.005)
        world.run(1.0)
        assert model.pose.z == pytest.approx(0.1, abs=1e-3)


@pytest.mark.parametrize(("mass", "more"), [("1e-15", HOLDER), ("1e-11", "")])
def test_other_masses_are_used_as_they_are(mass, more):
    robot = load_text(FRAME.format(mass=mass, more=more))
    assert not reported(robot)
    assert robot.link("l").inertial.mass == float(mass)


def test_a_model_that_a_world_includes_several_times_is_reported_once(tmp_path):
    (tmp_path / "frame").mkdir()
    (tmp_path / "frame" / "model.sdf").write_text(FRAME.format(mass="1e-15", more=""))
    (tmp_path / "frame" / "model.config").write_text(
        "<model><name>frame</name><sdf>model.sdf</sdf></model>"
    )
    include = "<include><uri>model://frame</uri><name>{}</name></include>"
    path = tmp_path / "yard.world"
    path.write_text(
        f'<sdf version="1.6"><world name="yard">{include.format("a")}{include.format("b")}'
        "</world></sdf>"
    )
    assert len(reported(load(path))) == 1
