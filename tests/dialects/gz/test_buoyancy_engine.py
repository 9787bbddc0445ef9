"""A bladder that makes a body rise and sink, compared with Archimedes' principle."""

import pytest
from tests.coded import raises

import cartwheel as cw
from cartwheel.codes import devices, running
from cartwheel.description import load_text
from cartwheel.errors import PluginError, UnknownNameError

GRAVITY, MASS, NEUTRAL = 9.8, 2.0, 3e-4
WORLD = (
    '<sdf version="1.9"><world name="w"><gravity>0 0 -9.8</gravity>'
    '<plugin name="water" filename="gz-sim-buoyancy-system"/></world></sdf>'
)
BODY = (
    f'<link name="base"><inertial><mass>{MASS}</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy>'
    '<izz>0.1</izz></inertia></inertial><collision name="c"><geometry><box>'
    "<size>0.1 0.1 0.2</size></box></geometry></collision></link>"
)
"""It has the density of water, so only the bladder moves it."""


class Glider:
    def __init__(self, worlds, tags="", *, link="base", name="gz-sim-buoyancy-engine-system"):
        self.world = cw.World(WORLD)
        worlds.append(self.world)
        plugin = (
            f'<plugin name="engine" filename="{name}"><link_name>{link}</link_name>{tags}</plugin>'
        )
        text = f'<sdf version="1.9"><model name="glider">{BODY}{plugin}</model></sdf>'
        self.model = self.world.spawn(load_text(text, file="glider.sdf"))

    def acceleration(self, seconds=0.2):
        """Upwards, m/s²."""
        before = self._climb()
        self.world.run(seconds)
        return (self._climb() - before) / seconds

    def _climb(self):
        return self.world.session.simulation.data.joint("glider::base").qvel[2]


@pytest.fixture
def glider():
    worlds = []
    yield lambda *given, **more: Glider(worlds, *given, **more)
    for each in worlds:
        each.close()


FAST = "<max_inflation_rate>1</max_inflation_rate>"


@pytest.mark.parametrize("volume", [5e-4, 3e-4, 1e-4])
def test_the_force_is_the_weight_of_the_additional_water(glider, volume):
    made = glider(FAST + "<default_volume>3e-4</default_volume>")
    made.world.publish("/buoyancy_engine", data=volume)
    made.world.run(0.1)
    expected = GRAVITY * 1000 * (volume - NEUTRAL) / MASS
    assert made.acceleration() == pytest.approx(expected, abs=1e-6)


def test_density_and_neutral_volume_count(glider):
    tags = (
        "<fluid_density>1200</fluid_density><neutral_volume>1e-4</neutral_volume>"
        "<default_volume>2e-4</default_volume>"
    )
    assert glider(tags).acceleration() == pytest.approx(GRAVITY * 1200 * 1e-4 / MASS, rel=0.03)


def test_the_volume_changes_at_the_stated_rate_within_its_limits(glider):
    tags = (
        "<namespace>glider</namespace><default_volume>2e-4</default_volume>"
        "<min_volume>1e-4</min_volume><max_volume>4e-4</max_volume>"
        "<max_inflation_rate>1e-4</max_inflation_rate>"
    )
    made = glider(tags)
    box = made.world.mailbox("/model/glider/buoyancy_engine/current_volume", size=10_000)

    def settled(volume, seconds):
        made.world.publish("/model/glider/buoyancy_engine", data=volume)
        made.world.run(seconds)
        return box.drain()[-1].data

    assert settled(1.0, 1.0) == pytest.approx(3e-4, rel=0.02)
    assert settled(1.0, 2.0) == pytest.approx(4e-4)
    assert settled(0.0, 1.0) == pytest.approx(3e-4, rel=0.02)
    assert settled(0.0, 3.0) == pytest.approx(1e-4)


def test_it_is_published_at_each_step(glider):
    made = glider()
    box = made.world.mailbox("/buoyancy_engine/current_volume", size=10_000)
    made.world.run(1.0)
    reported = box.drain()
    assert len(reported) == pytest.approx(200, abs=1)
    # Without a command, the smallest volume.
    assert reported[-1].data == pytest.approx(3e-5)


def test_above_the_surface_the_bladder_is_empty_weight(glider):
    tags = "<surface>-1</surface><default_volume>3e-4</default_volume>"
    expected = -GRAVITY * 1000 * NEUTRAL / MASS
    assert glider(tags).acceleration() == pytest.approx(expected, rel=0.03)
    below = glider("<surface>1</surface><default_volume>3e-4</default_volume>")
    assert below.acceleration() == pytest.approx(0.0, abs=1e-6)


def test_a_reset_restores_the_volume(glider):
    made = glider(FAST + "<default_volume>3e-4</default_volume>")
    made.world.publish("/buoyancy_engine", data=9e-4)
    made.world.run(1.0)
    made.world.reset()
    assert made.acceleration() == pytest.approx(0.0, abs=1e-6)


def test_old_names_are_understood(glider):
    made = glider(
        FAST + "<default_volume>5e-4</default_volume>",
        name="libignition-gazebo-buoyancy-engine-system.so",
    )
    assert made.acceleration() == pytest.approx(GRAVITY * 1000 * 2e-4 / MASS, rel=0.03)


def test_bad_parameters_are_reported(glider):
    with raises(devices.PLUGIN_RANGE_REVERSED, PluginError, parameter="min_volume"):
        glider("<min_volume>2</min_volume><max_volume>1</max_volume>")
    with raises(devices.PLUGIN_PARAMETER_INVALID, PluginError, parameter="fluid_density"):
        glider("<fluid_density>-1</fluid_density>")
    with raises(running.UNKNOWN_LINK, UnknownNameError):
        glider(link="missing")
