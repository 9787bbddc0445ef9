"""Buoyancy, hydrodynamic forces and thrusters, compared with formulas."""

import itertools
import math
from pathlib import Path

import pytest
from tests.coded import coded, raises

import cartwheel as cw
from cartwheel.codes import devices, tags
from cartwheel.description import load_text
from cartwheel.errors import PluginError, UnknownNameError
from cartwheel.geometry import quat_from_rpy

GRAVITY = 9.8
UNIFORM = '<plugin name="water" filename="gz-sim-buoyancy-system">{}</plugin>'
SEA = UNIFORM.format(
    "<graded_buoyancy><default_density>1000</default_density><density_change>"
    "<above_depth>{surface}</above_depth><density>0</density></density_change></graded_buoyancy>"
)
WORLD = '<sdf version="1.9"><world name="w"><gravity>0 0 -9.8</gravity>{plugins}</world></sdf>'
BODY = (
    '<link name="base"><inertial>{at}<mass>{mass}</mass><inertia><ixx>{i}</ixx><iyy>{i}</iyy>'
    "<izz>{i}</izz></inertia></inertial>{collision}</link>"
)
BOX = '<collision name="c"><geometry><box><size>{}</size></box></geometry></collision>'
HYDRO = (
    '<plugin name="hydro" filename="gz-sim-hydrodynamics-system"><link_name>base</link_name>'
    "{}</plugin>"
)
STRAIGHT = "<kP>-500</kP><mQ>-500</mQ><nR>-500</nR>"
"""Damping that keeps a boat, which is pushed from behind, from turning round."""
PROPELLER = (
    '<link name="propeller"><pose>-0.5 0 0 0 0 0</pose><inertial><mass>0.01</mass><inertia>'
    "<ixx>1e-4</ixx><iyy>1e-4</iyy><izz>1e-4</izz></inertia></inertial></link>"
    '<joint name="shaft" type="revolute"><parent>base</parent><child>propeller</child>'
    '<axis><xyz>1 0 0</xyz></axis></joint><plugin name="thruster" '
    'filename="gz-sim-thruster-system"><joint_name>shaft</joint_name>{}</plugin>'
)


@pytest.fixture
def water():
    """Returns a function that makes a world with a fluid and a body."""
    worlds = []

    def make(plugins, *parts, mass=1.0, i=0.1, size="1 1 1", at="", **place):
        collision = BOX.format(size) if size else ""
        body = BODY.format(mass=mass, i=i, collision=collision, at=at)
        model = load_text(
            f'<sdf version="1.9"><model name="boat">{body}{"".join(parts)}</model></sdf>',
            file="boat.sdf",
        )
        world = cw.World(WORLD.format(plugins=plugins))
        worlds.append(world)
        return world, world.spawn(model, **place)

    yield make
    for each in worlds:
        each.close()


def test_a_body_with_the_density_of_the_fluid_stays(water):
    world, boat = water(
        UNIFORM.format("<uniform_fluid_density>800</uniform_fluid_density>"), mass=800, i=100
    )
    world.run(5.0)
    assert boat.pose.position == pytest.approx((0.0, 0.0, 0.0), abs=1e-6)


def test_a_light_body_rises_with_the_difference_of_the_weights(water):
    world, boat = water(UNIFORM.format(""), mass=1500, i=100)
    world.run(1.0)
    assert boat.pose.z == pytest.approx(-GRAVITY * (1500 - 1000) / 1500 / 2, rel=0.01)


def test_only_enabled_models_float(water):
    world, boat = water(UNIFORM.format("<enable>other</enable>"), mass=1000, i=100)
    world.run(1.0)
    assert boat.pose.z == pytest.approx(-GRAVITY / 2, rel=0.01)
    world, boat = water(UNIFORM.format("<enable>boat::base</enable>"), mass=1000, i=100)
    world.run(1.0)
    assert boat.pose.z == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("surface", [0.0, 3.0])
def test_a_flat_box_floats_at_its_draught(water, surface):
    """A quarter of it is below the surface. Linear damping brings it to rest."""
    world, boat = water(
        SEA.format(surface=surface),
        HYDRO.format("<zW>-2000</zW><kP>-300</kP><mQ>-300</mQ>"),
        mass=250,
        i=100,
        size="2 2 0.25",
        z=surface,
    )
    world.run(6.0)
    assert boat.pose.z == pytest.approx(surface + 0.25 / 2 - 0.0625, abs=1e-4)


def test_a_floating_box_bobs_with_its_own_and_the_added_mass(water):
    """The stiffness is the weight of the water per depth."""
    mass, added, area = 250.0, 400.0, 4.0
    world, boat = water(
        SEA.format(surface=0),
        HYDRO.format(f"<zDotW>{-added}</zDotW>"),
        mass=mass,
        i=100,
        size="2 2 0.25",
        z=0.0625 + 0.02,
    )
    period = 2 * math.pi * math.sqrt((mass + added) / (1000 * GRAVITY * area))
    heights = []
    for _ in range(round(4 * period / 0.005)):
        world.run(0.005)
        heights.append(boat.pose.z - 0.0625)
    crossings = [k for k, (a, b) in enumerate(itertools.pairwise(heights)) if a > 0 >= b]
    measured = (crossings[-1] - crossings[0]) / (len(crossings) - 1) * 0.005
    assert measured == pytest.approx(period, rel=0.01)


def test_a_low_centre_of_mass_rights_a_tilted_body(water):
    world, boat = water(
        UNIFORM.format(""),
        HYDRO.format("<kP>-500</kP><mQ>-500</mQ><nR>-500</nR><xU>-500</xU><yV>-500</yV>"),
        mass=1000,
        i=100,
        at="<pose>0 0 -0.1 0 0 0</pose>",
        roll=0.5,
    )
    world.run(8.0)
    roll, pitch, _ = boat.pose.rpy
    assert (roll, pitch) == pytest.approx((0.0, 0.0), abs=0.01)


@pytest.mark.parametrize(
    ("tags", "speed"),
    [
        ("<xU>-4</xU>", 20 / 4),
        ("<xUabsU>-5</xUabsU>", 2.0),
        ("<xU>-6</xU><xUabsU>-2</xUabsU>", 2.0),
        # Against a current of 1 m/s.
        ("<xU>-4</xU><default_current>-1 0 0</default_current>", 20 / 4 - 1),
    ],
)
def test_the_thrust_balances_the_damping(water, tags, speed):
    world, boat = water(
        UNIFORM.format(""),
        HYDRO.format(tags + STRAIGHT),
        PROPELLER.format(""),
        mass=2,
        size="1 1 0.002",
    )
    world.publish("/model/boat/joint/shaft/cmd_thrust", {"data": 20.0})
    world.run(5.0)
    assert boat.velocity.linear[0] == pytest.approx(speed, rel=0.002)


def test_the_added_mass_takes_part_in_each_acceleration(water):
    """It exceeds the body's own mass tenfold, which an explicit computation does not bear."""
    world, boat = water(
        UNIFORM.format(""),
        HYDRO.format("<xDotU>-100</xDotU>" + STRAIGHT),
        PROPELLER.format(""),
        mass=10,
        size="1 1 0.01",
    )
    world.publish("/model/boat/joint/shaft/cmd_thrust", {"data": 11.001})
    world.run(0.5)
    start = boat.velocity.linear[0]
    world.run(2.0)
    assert boat.velocity.linear[0] - start == pytest.approx(11.001 / 110.01 * 2.0, rel=0.001)


def test_strong_damping_stops_a_body_within_a_step(water):
    world, boat = water("", HYDRO.format("<zW>-1e7</zW>"), mass=1, size="")
    world.run(1.0)
    assert boat.velocity.linear[2] == pytest.approx(-GRAVITY * 1e-7, rel=0.01)


def test_a_current_that_is_published_carries_a_body_along(water):
    world, boat = water(
        UNIFORM.format(""), HYDRO.format("<xU>-50</xU><yV>-50</yV>"), mass=10, size="1 1 0.01"
    )
    world.publish("/ocean_current", {"x": 0.3, "y": -0.2, "z": 0.0})
    world.run(5.0)
    assert boat.velocity.linear[:2] == pytest.approx((0.3, -0.2), rel=0.001)


def test_products_of_different_axes_act(water):
    """A force to the side because of the forward speed."""
    tags = f"<xU>-10</xU><yU>2</yU><yUabsU>-1</yUabsU><yV>-10</yV>{STRAIGHT}"
    world, boat = water(
        UNIFORM.format(""), HYDRO.format(tags), PROPELLER.format(""), mass=10, size="1 1 0.01"
    )
    world.publish("/model/boat/joint/shaft/cmd_thrust", {"data": 10.0})
    world.run(10.0)
    assert boat.velocity.linear[0] == pytest.approx(1.0, rel=0.01)
    assert boat.velocity.linear[1] == pytest.approx((2 - 1) / 10, rel=0.02)


def test_the_added_mass_turns_a_body_that_drifts(water):
    """The Munk moment: (Yv' - Xu') u v about z."""
    world, boat = water(
        "",
        HYDRO.format("<xDotU>-5</xDotU><yDotV>-25</yDotV>"),
        mass=10,
        i=50,
        size="",
    )
    boat.velocity = cw.Twist(linear=(0.4, 0.3, 0.0))
    world.run(0.01)
    start = boat.velocity
    world.run(0.2)
    u, v = start.linear[:2]
    spin = boat.velocity.angular[2] - start.angular[2]
    assert spin == pytest.approx(-(25 - 5) * u * v / 50 * 0.2, rel=0.05)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_propeller_turns_at_the_speed_of_its_thrust(water, read, sign):
    tags = (
        "<propeller_diameter>0.2</propeller_diameter><fluid_density>900</fluid_density>"
        f"<thrust_coefficient>{sign * 0.05}</thrust_coefficient>"
    )
    world, boat = water("", PROPELLER.format(tags), mass=10, size="")
    before = boat.joint("shaft")
    world.publish("/model/boat/joint/shaft/cmd_thrust", {"data": 3.0})
    speed = sign * math.sqrt(3.0 / (900 * 0.05 * 0.2**4))
    states = read(world, "/model/boat/joint/shaft/ang_vel", 1.0)
    assert [each.data for each in states[1:]] == pytest.approx([speed] * len(states[1:]))
    assert boat.joint("shaft") - before == pytest.approx(speed, rel=0.02)
    assert boat.velocity.linear[0] == pytest.approx(3.0 / 10.01, rel=0.02)


def test_a_speed_can_be_commanded_instead(water, read):
    tags = (
        "<use_angvel_cmd>true</use_angvel_cmd><propeller_diameter>0.2</propeller_diameter>"
        "<thrust_coefficient>0.05</thrust_coefficient><namespace>ship</namespace>"
        "<topic>main</topic>"
    )
    world, boat = water("", PROPELLER.format(tags), mass=10, size="")
    world.publish("/ship/main", {"data": -5.0})
    force = -1000 * 0.05 * 0.2**4 * 25
    states = read(world, "/ship/main/force", 1.0)
    assert states[-1].data == pytest.approx(force)
    assert boat.velocity.linear[0] == pytest.approx(force / 10.01, rel=0.02)


def test_commands_stay_within_their_range_and_beyond_the_deadband(water):
    tags = (
        "<max_thrust_cmd>2</max_thrust_cmd><min_thrust_cmd>-1</min_thrust_cmd>"
        "<deadband>0.5</deadband>"
    )
    world, boat = water("", PROPELLER.format(tags), mass=9.99, size="")
    topic = "/model/boat/joint/shaft/cmd_thrust"
    for command, thrust in ((50.0, 2.0), (-50.0, -1.0), (0.4, 0.0)):
        world.reset()
        world.publish(topic, {"data": command})
        world.run(1.0)
        assert boat.velocity.linear[0] == pytest.approx(thrust / 10, rel=0.02, abs=1e-9)
    world.reset()
    world.publish(f"{topic.rpartition('/')[0]}/enable_deadband", {"data": False})
    world.publish(topic, {"data": 0.4})
    world.run(1.0)
    assert boat.velocity.linear[0] == pytest.approx(0.4 / 10, rel=0.02)


def test_the_thrust_acts_at_the_origin_of_its_link(water):
    """A propeller beside the centre of mass turns the boat."""
    aside = PROPELLER.format("").replace("-0.5 0 0 0 0 0", "0 0.5 0 0 0 0")
    world, boat = water("", aside, mass=10, i=1, size="")
    world.publish("/model/boat/joint/shaft/cmd_thrust", {"data": 1.0})
    world.run(0.2)
    assert boat.velocity.angular[2] == pytest.approx(-0.5 * 0.2, rel=0.02)


def test_an_advance_ratio_changes_the_speed_that_belongs_to_a_thrust(water, read):
    tags = (
        "<propeller_diameter>0.2</propeller_diameter><alpha_1>0.05</alpha_1>"
        "<alpha_2>-0.02</alpha_2><wake_fraction>0.1</wake_fraction>"
    )
    world, boat = water(
        UNIFORM.format(""),
        HYDRO.format("<xU>-10</xU>" + STRAIGHT),
        PROPELLER.format(tags),
        mass=10,
        size="1 1 0.01",
    )
    world.publish("/model/boat/joint/shaft/cmd_thrust", {"data": 10.0})
    world.run(3.0)
    speed = read(world, "/model/boat/joint/shaft/ang_vel", 0.1)[-1].data
    velocity = math.hypot(*boat.link("propeller").velocity.linear)
    coefficient = 0.05 - 0.02 * 0.9 * velocity / (speed * 0.2)
    assert speed == pytest.approx(math.sqrt(10.0 / (1000 * coefficient * 0.2**4)), rel=1e-3)


def test_a_reset_stops_the_thrust_and_the_current(water):
    world, boat = water("", HYDRO.format("<xU>-5</xU>"), PROPELLER.format(""), mass=10, size="")
    world.publish("/model/boat/joint/shaft/cmd_thrust", {"data": 1.0})
    world.publish("/ocean_current", {"x": 1.0, "y": 0.0, "z": 0.0})
    world.run(1.0)
    assert boat.velocity.linear[0] > 0.1
    world.reset()
    world.run(1.0)
    assert boat.velocity.linear[0] == pytest.approx(0.0, abs=1e-9)


def test_two_runs_are_equal(water):
    poses = []
    for _ in range(2):
        world, boat = water(
            SEA.format(surface=0),
            HYDRO.format("<xU>-20</xU><zW>-50</zW><zDotW>-9</zDotW><mQ>-9</mQ><kP>-9</kP>"),
            PROPELLER.format(""),
            mass=20,
            i=1,
            size="1 0.5 0.2",
            roll=0.1,
        )
        world.publish("/model/boat/joint/shaft/cmd_thrust", {"data": 5.0})
        world.run(3.0)
        poses.append(boat.pose)
    assert poses[0] == poses[1]


def test_a_reversed_range_is_an_error(water):
    tags = "<max_thrust_cmd>-2</max_thrust_cmd><min_thrust_cmd>1</min_thrust_cmd>"
    with raises(devices.PLUGIN_RANGE_REVERSED, PluginError, value=1.0, most=-2.0):
        water("", PROPELLER.format(tags))


def test_an_unknown_coefficient_is_reported(water):
    world, _ = water("", HYDRO.format("<xUabsUU>-1</xUabsUU><xRQ>1</xRQ><yDotR>-1</yDotR>"))
    unknown = [
        each.values["parameter"]
        for each in world.diagnostics
        if each.code is devices.PLUGIN_PARAMETER_UNKNOWN
    ]
    assert unknown == ["xUabsUU"]


def test_the_fluid_of_a_classic_model_is_its_own(water):
    """Archimedes: half of the weight is carried."""
    plugin = (
        '<plugin name="float" filename="libBuoyancyPlugin.so"><fluid_density>{}</fluid_density>'
        "{}</plugin>"
    )
    world, boat = water("", plugin.format(1000, ""), mass=2000, i=100)
    world.run(1.0)
    assert boat.pose.z == pytest.approx(-GRAVITY / 4, rel=0.01)
    stated = (
        '<link name="base"><center_of_volume>0.2 0 0</center_of_volume><volume>0.01</volume></link>'
    )
    world, boat = water("", plugin.format(500, stated), mass=10, i=100)
    world.run(0.5)
    assert boat.pose.z == pytest.approx(-GRAVITY / 2 / 2 * 0.25, rel=0.02)
    assert boat.velocity.angular[1] == pytest.approx(-0.2 * 5 * GRAVITY / 100 * 0.5, rel=0.03)


def test_a_body_between_two_fluids_floats_on_the_denser_one(water):
    """Oil of 800 kg/m³ on water, and a body of 900: half of it is in the water."""
    layers = UNIFORM.format(
        "<graded_buoyancy><default_density>1000</default_density>"
        "<density_change><above_depth>2</above_depth><density>1</density></density_change>"
        "<density_change><above_depth>0</above_depth><density>800</density></density_change>"
        "</graded_buoyancy>"
    )
    damped = HYDRO.format("<zW>-4000</zW><kP>-300</kP><mQ>-300</mQ>")
    world, boat = water(layers, damped, mass=900 * 2 * 2 * 0.2, i=100, size="2 2 0.2", z=0.05)
    world.run(6.0)
    assert boat.pose.z == pytest.approx(0.0, abs=1e-3)


def test_a_saved_state_continues_alike(water, tmp_path: Path):
    def make():
        return water(
            SEA.format(surface=0),
            HYDRO.format("<xU>-20</xU><zW>-50</zW><zDotW>-9</zDotW><mQ>-9</mQ><kP>-9</kP>"),
            PROPELLER.format(""),
            mass=20,
            i=1,
            size="1 0.5 0.2",
        )

    world, boat = make()
    world.publish("/model/boat/joint/shaft/cmd_thrust", {"data": 5.0})
    world.run(1.0)
    state = world.save()
    world.run(1.0)
    expected = boat.pose
    world.restore(state)
    world.run(1.0)
    assert boat.pose == expected


def test_an_unknown_joint_is_an_error(water):
    with raises(devices.PLUGIN_JOINT_UNKNOWN, UnknownNameError):
        water("", PROPELLER.format("").replace("<joint_name>shaft", "<joint_name>axle"))


def test_a_body_that_is_tilted_in_the_fluid_stays_so(water):
    world, boat = water(UNIFORM.format(""), mass=1000, i=100, yaw=1.0, pitch=0.5)
    world.run(2.0)
    assert boat.pose.orientation == pytest.approx(quat_from_rpy(0.0, 0.5, 1.0), abs=1e-6)


def weighted(tags):
    """The ``<fluid_added_mass>`` of an inertial, instead of its pose."""
    return f"<fluid_added_mass>{tags}</fluid_added_mass>"


def motion(world, axis):
    """A velocity of the body: 0 to 2 along the world's axes, 3 to 5 about its own."""
    return float(world.session.simulation.data.joint("boat::base").qvel[axis])


def acceleration(world, axis=2):
    """Its change in a second. The water's force is known from the third step on."""
    world.run(0.1)
    before = motion(world, axis)
    world.run(1.0)
    return motion(world, axis) - before


@pytest.mark.parametrize("added", [0.5, 10.0, 500.0])
def test_the_added_mass_of_an_inertial_is_accelerated_but_has_no_weight(water, added):
    world, _ = water("", mass=2.0, size="", at=weighted(f"<zz>{added}</zz>"))
    assert acceleration(world) == pytest.approx(-GRAVITY * 2.0 / (2.0 + added), rel=1e-3)


def test_each_direction_has_its_own_added_mass(water):
    """A body that lies on its side falls along its own y axis."""
    world, _ = water("", mass=2.0, size="", at=weighted("<yy>6</yy>"), roll=math.pi / 2)
    assert acceleration(world) == pytest.approx(-GRAVITY * 2.0 / 8.0, rel=1e-3)
    world, _ = water("", mass=2.0, size="", at=weighted("<yy>6</yy>"))
    assert acceleration(world) == pytest.approx(-GRAVITY, rel=1e-3)


def test_the_added_inertia_resists_a_torque(water):
    world, boat = water("", mass=2.0, i=0.5, size="", at=weighted("<pp>1.5</pp>"))
    boat.link("base").push(torque=(1.0, 0.0, 0.0), seconds=math.inf)
    assert acceleration(world, 3) == pytest.approx(1.0 / 2.0, rel=1e-3)


def test_a_plugin_of_the_link_includes_the_added_mass_of_the_inertial(water):
    """Both together resist as one mass, also if it is much larger than that of the body."""
    world, _ = water(
        "", HYDRO.format("<zDotW>-100</zDotW>"), mass=2.0, size="", at=weighted("<zz>100</zz>")
    )
    assert acceleration(world) == pytest.approx(-GRAVITY * 2.0 / 202.0, rel=1e-3)


def test_a_negative_added_mass_is_reported(water):
    world, _ = water("", mass=2.0, size="", at=weighted("<xx>1</xx><xy>3</xy><yy>1</yy>"))
    (reported,) = coded(world, tags.NOT_SIMULATED)
    assert reported.values["tag"] == "fluid_added_mass"
    assert acceleration(world) == pytest.approx(-GRAVITY, rel=1e-3)
