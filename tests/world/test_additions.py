"""Physics that descriptions do not state: what is added, reported, omitted and not needed."""

import re
from pathlib import Path

import pytest

import cartwheel as cw
from cartwheel.codes import command, devices
from cartwheel.codes import world as codes
from cartwheel.description import load_text
from cartwheel.world.additions import ADDITIONS

from .test_chains import STEP, arm

SOLID = """<inertial><mass value="1"/>
  <inertia ixx="{ixx}" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>"""
BASE = """<link name="base"><inertial><mass value="5"/>
  <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision name="body"><geometry><box size="0.4 0.2 0.1"/></geometry></collision>
  <collision name="ball"><origin xyz="0.15 0 -0.08"/><geometry><sphere radius="0.02"/></geometry>
  </collision></link>"""
AXIS = '<origin xyz="0 0.15 0" rpy="-1.5708 0 0"/><axis xyz="0 0 1"/>'
CYLINDER = '<cylinder radius="0.1" length="0.04"/>'


def cart(tyre=CYLINDER, ixx="0.01"):
    """A base with a fixed ball and one wheel."""
    return load_text(
        f"""<robot name="cart">{BASE}<link name="wheel">{SOLID.format(ixx=ixx)}
        <collision name="tyre"><geometry>{tyre}</geometry></collision></link>
        <joint name="axle" type="continuous"><parent link="base"/><child link="wheel"/>{AXIS}
        </joint></robot>""",
        file="cart.urdf",
    )


def chain():
    return load_text(
        f'<sdf version="1.6"><model name="m"><pose>0 0 2 0 0 0</pose>{arm((0.5, 0.4), (2, 1))}'
        "</model></sdf>",
        file="chain.sdf",
    )


@pytest.fixture
def spawned():
    """Spawns a robot on the ground; the world is closed after the test."""
    worlds = []

    def spawn(robot, *, without=(), **more):
        world = cw.World("empty", without=without)
        worlds.append(world)
        world.spawn(robot, z=0.1, **more)
        return world

    yield spawn
    for world in worlds:
        world.close()


def noted(world, code):
    """The values of the only diagnostic with a code; None without it."""
    found = [each for each in world.diagnostics if each.code is code]
    assert len(found) <= 1
    if not found:
        return None
    assert found[0].severity == "info"
    assert found[0].origin is not None
    return found[0].values


def geom(world, name):
    return world.session.simulation.model.geom(name)


def test_a_tyre_is_reported_and_omitted(spawned):
    before, after = spawned(cart()), spawned(cart(), without="round-tyres")
    assert noted(before, codes.TYRES_ROUNDED) == {
        "model": "cart",
        "collisions": ("wheel::tyre_collision",),
        "widths": (0.04,),
    }
    assert noted(after, codes.TYRES_ROUNDED) is None
    assert (
        geom(before, "cart::wheel::tyre_collision").type[0]
        != geom(after, "cart::wheel::tyre_collision").type[0]
    )


def test_a_wheel_that_is_stated_round_is_not_rounded(spawned):
    assert noted(spawned(cart('<sphere radius="0.1"/>')), codes.TYRES_ROUNDED) is None


def test_softer_friction_is_reported_and_omitted(spawned):
    before, after = spawned(cart()), spawned(cart(), without=["soft-sliding"])
    assert noted(before, codes.SLIDING_SOFTENED) == {
        "model": "cart",
        "collisions": ("base::body_collision", "base::ball_collision"),
        "times": (0.4, 0.4),
    }
    assert noted(after, codes.SLIDING_SOFTENED) is None
    assert before.session.simulation.model.npair == 2
    assert after.session.simulation.model.npair == 0


def test_surfaces_without_friction_are_not_reported(spawned):
    text = "<mu1>0</mu1><mu2>0</mu2>"
    robot = load_text(
        f'<robot name="cart">{BASE}<gazebo reference="base">{text}</gazebo></robot>',
        file="cart.urdf",
    )
    assert noted(spawned(robot), codes.SLIDING_SOFTENED) is None


def test_a_moment_of_zero_is_raised_and_reported(spawned):
    world = spawned(cart(ixx="1e-13"))
    assert noted(world, codes.INERTIA_RAISED) == {
        "model": "cart",
        "links": ("wheel",),
        "moments": (pytest.approx(1e-8),),
    }
    assert world.session.simulation.model.body("cart::wheel").inertia.min() == pytest.approx(1e-8)


def test_without_raised_inertias_the_stated_moment_is_used(spawned):
    world = spawned(cart(ixx="1e-13"), without="minimum-inertia")
    assert noted(world, codes.INERTIA_RAISED) is None
    assert world.session.simulation.model.body("cart::wheel").inertia.min() < 1e-12


def test_a_positive_moment_is_not_raised(spawned):
    assert noted(spawned(cart()), codes.INERTIA_RAISED) is None


def test_drag_is_reported_and_omitted(spawned):
    before, after = spawned(chain()), spawned(chain(), without="chain-drag")
    values = noted(before, codes.CHAIN_DRAG)
    assert values["joints"] == ("j0", "j1")
    model = before.session.simulation.model
    assert values["drag"] == pytest.approx(tuple(model.dof_dampingpoly[:, 1]))
    assert noted(after, codes.CHAIN_DRAG) is None
    assert not after.session.simulation.model.dof_dampingpoly.any()


def test_each_model_has_its_own_report():
    with cw.World("empty") as world:
        for name in ("one", "two"):
            world.spawn(chain(), name=name, y=1.0 if name == "two" else 0.0)
        found = [
            each.values["model"] for each in world.diagnostics if each.code is codes.CHAIN_DRAG
        ]
    assert found == ["one", "two"]


def test_overlapping_models_separate_slowly_unless_that_is_omitted():
    fastest = {}
    for without in ((), ("slow-separation",)):
        with cw.World("empty", without=without) as world:
            world.spawn(cart(), z=-0.3)
            assert codes.MODELS_OVERLAP in {each.code for each in world.diagnostics}
            speeds = []
            for _ in range(40):
                world.run(STEP)
                speeds.append(abs(world.session.simulation.data.qvel[2]))
            fastest[without] = max(speeds)
    # One step of gravity may follow the limit.
    assert fastest[()] <= 0.5 + 9.81 * STEP
    assert fastest["slow-separation",] > 1.0


ARM = """<robot name="arm"><link name="world"/><link name="beam"><inertial>
  <origin xyz="0.5 0 0"/><mass value="2"/>
  <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="elbow" type="revolute"><parent link="world"/><child link="beam"/>
  <origin xyz="0 0 1"/><axis xyz="0 1 0"/>
  <limit lower="-3" upper="3" effort="1" velocity="2"/></joint>
  <transmission name="t"><type>transmission_interface/SimpleTransmission</type><joint name="elbow">
  <hardwareInterface>hardware_interface/PositionJointInterface</hardwareInterface></joint>
  <actuator name="m"/></transmission>
  <gazebo><plugin name="control" filename="libgazebo_ros_control.so"/></gazebo></robot>"""


@pytest.mark.parametrize(
    ("without", "used", "holds"), [((), 2 * 2 * 9.8 * 0.5, True), (("all",), 1.0, False)]
)
def test_an_effort_limit_that_is_too_low_holds_the_joint_only_if_it_is_raised(without, used, holds):
    with cw.World("empty", without=without) as world:
        world.spawn(load_text(ARM, file="arm.urdf"))
        (warning,) = (
            each for each in world.diagnostics if each.code is devices.EFFORT_LIMIT_TOO_LOW
        )
        assert warning.values["used"] == pytest.approx(used, rel=0.01)
        world.run(1.0)
        angle = world.session.simulation.data.joint("arm::elbow").qpos[0]
        assert (abs(angle) < 0.01) == holds


def test_all_omits_everything(spawned):
    world = spawned(cart(ixx="1e-13"), without="all")
    codes_of_additions = {
        codes.CHAIN_DRAG, codes.TYRES_ROUNDED, codes.SLIDING_SOFTENED, codes.INERTIA_RAISED
    }  # fmt: skip
    assert not codes_of_additions & {each.code for each in world.diagnostics}
    assert world.session.notes["without"] == ", ".join(sorted(ADDITIONS))


def test_an_unknown_name_is_refused():
    with pytest.raises(cw.CartwheelError) as caught:
        cw.World("empty", without=["chain_drag"])
    assert caught.value.code is command.OPTION_INVALID
    assert caught.value.values == {"option": "without", "value": "chain_drag"}


def test_the_page_lists_all_additions():
    page = (Path(cw.__file__).parents[2] / "docs/physics.md").read_text()
    assert tuple(re.findall(r"^\| `([a-z-]+)` \|", page, flags=re.MULTILINE)) == ADDITIONS
