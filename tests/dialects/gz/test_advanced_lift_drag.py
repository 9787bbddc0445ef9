"""An aeroplane whose forces follow from its stability derivatives."""

import math

import pytest
from tests.coded import coded, raises

import cartwheel as cw
from cartwheel.codes import devices, running
from cartwheel.description import load_text
from cartwheel.errors import PluginError, UnknownNameError

MASS, AREA, RATIO, SPEED, RHO = 2.0, 0.6, 6.0, 15.0, 1.2041
PRESSURE = 0.5 * RHO * SPEED**2 * AREA
WORLD = '<sdf version="1.9"><world name="w"><gravity>0 0 {}</gravity></world></sdf>'
BODY = (
    f'<link name="body"><inertial><mass>{MASS}</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy>'
    "<izz>0.2</izz></inertia></inertial></link>"
)
FLAP = (
    '<link name="flap"><pose>-0.5 0 0 0 0 0</pose><inertial><mass>1e-3</mass><inertia>'
    "<ixx>1e-6</ixx><iyy>1e-6</iyy><izz>1e-6</izz></inertia></inertial></link>"
    '<joint name="hinge" type="revolute"><parent>body</parent><child>flap</child><axis>'
    "<xyz>0 1 0</xyz><limit><lower>-1</lower><upper>1</upper></limit></axis></joint>"
    '<plugin name="servo" filename="gz-sim-joint-position-controller-system">'
    "<joint_name>hinge</joint_name><use_velocity_commands>true</use_velocity_commands></plugin>"
)
SURFACE = (
    "<num_ctrl_surfaces>1</num_ctrl_surfaces><control_surface><name>{}</name>"
    "<direction>-1</direction><CL_ctrl>0</CL_ctrl><CD_ctrl>0</CD_ctrl><CY_ctrl>0</CY_ctrl>"
    "<Cell_ctrl>0.002</Cell_ctrl><Cem_ctrl>0</Cem_ctrl><Cen_ctrl>0</Cen_ctrl></control_surface>"
)


SYSTEM = "gz-sim-advanced-lift-drag-system"
SIZES = f"<area>{AREA}</area><AR>{RATIO}</AR><eff>0.97</eff>"


class Plane:
    def __init__(
        self, worlds, tags, *, gravity=0.0, flap="", file=SYSTEM, given=SIZES, link="body"
    ):
        self.world = cw.World(WORLD.format(-gravity))
        worlds.append(self.world)
        plugin = (
            f'<plugin name="air" filename="{file}"><link_name>{link}</link_name>{given}{tags}'
            "</plugin>"
        )
        text = f'<sdf version="1.9"><model name="plane">{BODY}{flap}{plugin}</model></sdf>'
        self.model = self.world.spawn(load_text(text, file="plane.sdf"), z=100)

    def fly(self, speed=SPEED, climb=0.0, side=0.0):
        self.model.velocity = cw.Twist(linear=(speed, side, climb))

    @property
    def motion(self):
        return self.world.session.simulation.data.joint("plane::body").qvel.tolist()


@pytest.fixture
def plane():
    worlds = []
    yield lambda *given, **more: Plane(worlds, *given, **more)
    for each in worlds:
        each.close()


def test_the_lift_of_level_flight(plane):
    made = plane("<CL0>0.15</CL0>")
    made.fly()
    made.world.run(0.1)
    assert made.motion[2] == pytest.approx(0.1 * PRESSURE * 0.15 / MASS, rel=0.03)


def test_lift_can_carry_the_weight(plane):
    """With the lift coefficient that level flight needs, the height stays for a while."""
    needed = MASS * 9.8 / PRESSURE
    made = plane(f"<CL0>{needed}</CL0>", gravity=9.8)
    made.fly()
    made.world.run(1.0)
    assert made.model.pose.z == pytest.approx(100, abs=0.5)
    assert made.model.pose.x > 10


def test_the_drag_slows_it(plane):
    """dv/dt = -k v², so 1/v grows linearly."""
    made = plane("<CD0>0.1</CD0>")
    made.fly()
    made.world.run(2.0)
    k = 0.5 * RHO * AREA * 0.1 / MASS
    assert 1 / made.motion[0] == pytest.approx(1 / SPEED + 2.0 * k, rel=0.01)


def test_sideslip_turns_the_nose_into_the_wind(plane):
    made = plane("<Cenb>0.01</Cenb>")
    made.fly(side=1.0)
    made.world.run(0.1)
    span = math.sqrt(AREA * RATIO)
    expected = PRESSURE * span * 0.01 * math.atan2(1.0, SPEED) / 0.2 * 0.1
    # To the left, where it slips to.
    assert made.motion[5] == pytest.approx(expected, rel=0.05)


def test_a_control_surface_rolls_it(plane):
    made = plane(SURFACE.format("hinge"), flap=FLAP)
    made.world.publish("/model/plane/joint/hinge/cmd_pos", data=math.radians(10))
    made.world.run(1.0)
    made.fly()
    made.world.run(0.1)
    span = math.sqrt(AREA * RATIO)
    expected = -PRESSURE * span * 0.002 * 10 / 0.1 * 0.1
    assert made.motion[3] == pytest.approx(expected, rel=0.05)


def test_more_surfaces_than_stated_are_reported(plane):
    tags = SURFACE.format("hinge").replace("<num_ctrl_surfaces>1<", "<num_ctrl_surfaces>0<")
    made = plane(tags, flap=FLAP)
    (reported,) = coded(made.world, devices.PLUGIN_PARAMETER_IGNORED)
    assert reported.values["parameter"] == "control_surface"


def test_a_stalled_aeroplane_falls(plane):
    """Falling flat, the drag is that of a plate, and balances the weight."""
    made = plane("<CL0>0.1</CL0><CLa>5</CLa><alpha_stall>0.3</alpha_stall>", gravity=9.8)
    made.fly(speed=0.0, climb=-1.0)
    made.world.run(5.0)
    # At a right angle, the coefficient of drag is 2 / (1 + exp(k1 + k2 AR)).
    plate = 2 / (1 + math.exp(-0.224 - 0.115 * RATIO))
    limit = math.sqrt(2 * MASS * 9.8 / (RHO * AREA * plate))
    assert made.motion[2] == pytest.approx(-limit, rel=0.05)


def test_old_names_are_understood(plane):
    made = plane("<CL0>0.15</CL0>", file="libignition-gazebo-advanced-lift-drag-system.so")
    made.fly()
    made.world.run(0.1)
    assert made.motion[2] > 0.3


@pytest.mark.parametrize("missing", ["AR", "eff"])
def test_missing_tags_are_reported(plane, missing):
    other = {"AR": "<eff>1</eff>", "eff": "<AR>5</AR>"}[missing]
    with raises(devices.PLUGIN_PARAMETER_MISSING, PluginError):
        plane("", given=other)


def test_bad_values_are_reported(plane):
    with raises(devices.PLUGIN_PARAMETER_INVALID, PluginError, parameter="AR"):
        plane("", given="<AR>0</AR><eff>1</eff>")
    with raises(devices.PLUGIN_PARAMETER_INVALID, PluginError, parameter="forward"):
        plane("<forward>0 0 0</forward>")
    with raises(devices.PLUGIN_PARAMETER_MISSING, PluginError):
        plane(SURFACE.format("hinge").replace("<CL_ctrl>0</CL_ctrl>", ""), flap=FLAP)
    with raises(devices.PLUGIN_JOINT_UNKNOWN, UnknownNameError):
        plane(SURFACE.format("other"), flap=FLAP)
    with raises(running.UNKNOWN_LINK, UnknownNameError):
        plane("", link="other")
