"""Thrusters of spacecraft: valves that open for a part of each cycle."""

import contextlib

import pytest
from tests.coded import coded

from cartwheel import World
from cartwheel.codes import running
from cartwheel.devices.air.pulsed_thruster import open_share

THRUST, MASS, FREQUENCY = 4.0, 2.0, 10.0
PLUGIN = """<plugin name="p{number}" filename="gz-sim-spacecraft-thruster-model-system">
  <link_name>{link}</link_name><actuator_number>{number}</actuator_number>
  <max_thrust>4</max_thrust><duty_cycle_frequency>{frequency}</duty_cycle_frequency>{more}
</plugin>"""


@pytest.fixture
def craft():
    """A body with one nozzle that points up and one that points along x."""
    with contextlib.ExitStack() as started:

        def make(more="<sub_topic>command/duty_cycle</sub_topic>", frequency=FREQUENCY):
            plugins = "".join(
                PLUGIN.format(number=number, link=link, more=more, frequency=frequency)
                for number, link in enumerate(("body", "side"))
            )
            text = (
                '<sdf version="1.9"><world name="space"><gravity>0 0 0</gravity>'
                '<model name="craft"><link name="body"><inertial><mass>1</mass></inertial></link>'
                '<link name="side"><pose>0 0 0 0 1.5707963 0</pose><inertial><mass>1</mass>'
                '</inertial></link><joint name="j" type="fixed"><parent>body</parent>'
                f"<child>side</child></joint>{plugins}</model></world></sdf>"
            )
            return started.enter_context(World(text))

        yield make


def fire(world, *duties, topic="/craft/command/duty_cycle"):
    world.publish(topic, {"normalized": list(duties)})


def speed(world):
    return world.model("craft").velocity.linear


@pytest.mark.parametrize("duty", [0.03, 0.5, 1.0])
def test_a_thruster_pushes_along_its_z_axis_for_a_part_of_each_cycle(craft, duty):
    world = craft()
    fire(world, duty, 0.0)
    world.run(1.0)
    assert speed(world) == pytest.approx((0, 0, duty * THRUST / MASS), abs=0.011)
    fire(world, 0.0, duty)
    world.run(1.0)
    assert speed(world) == pytest.approx((duty * THRUST / MASS, 0, duty * THRUST / MASS), abs=0.011)


def test_the_first_half_of_a_cycle_has_the_whole_thrust(craft):
    world = craft(frequency=1.0)
    fire(world, 0.5, 0.0)
    world.run(0.5)
    assert speed(world)[2] == pytest.approx(0.5 * THRUST / MASS, rel=0.02)
    world.run(0.45)
    assert speed(world)[2] == pytest.approx(0.5 * THRUST / MASS, rel=0.02)


def test_a_valve_is_closed_after_a_reset(craft):
    world = craft()
    fire(world, 1.0, 1.0)
    world.run(0.1)
    world.reset()
    world.run(0.5)
    assert speed(world) == pytest.approx((0, 0, 0), abs=1e-9)


def test_without_a_topic_within_it_the_name_of_the_model_is_the_topic(craft):
    world = craft(more="")
    fire(world, 1.0, 0.0, topic="/craft")
    world.run(0.5)
    assert speed(world)[2] == pytest.approx(0.5 * THRUST / MASS, rel=0.02)


def test_a_command_without_the_thrusters_number_is_reported(craft):
    world = craft()
    fire(world, 1.0)
    world.run(0.1)
    (said,) = coded(world.diagnostics, running.COMMAND_IGNORED)
    assert (said.values["duties"], said.values["thruster"]) == (1, 1)


@pytest.mark.parametrize(
    ("start", "length", "duty", "share"),
    [
        (0.0, 0.1, 0.5, 1.0),
        (0.4, 0.2, 0.5, 0.5),
        (0.6, 0.1, 0.5, 0.0),
        (0.9, 0.2, 0.5, 0.5),
        (3.0, 5.0, 0.25, 0.25),
        (7.2, 0.1, 1.0, 1.0),
    ],
)
def test_the_share_of_a_step_during_which_a_valve_is_open(start, length, duty, share):
    assert open_share(start, length, 1.0, duty) == pytest.approx(share, abs=1e-9)


def test_cycles_without_length_are_an_error(craft):
    world = craft(frequency=0.0)
    assert len(coded(world.diagnostics, running.PLUGIN_LEFT_OUT)) == 2
