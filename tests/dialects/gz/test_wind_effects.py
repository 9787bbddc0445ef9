"""Wind that pulls links along."""

import contextlib
import math

import pytest
from tests.coded import coded

from cartwheel import World
from cartwheel.codes import devices, running

BODY = (
    '<model name="{name}"><pose>{x} 0 5 0 0 0</pose>{model}<link name="a">{link}<inertial>'
    "<pose>0.5 0 0 0 0 0</pose><mass>2</mass><inertia><ixx>0.5</ixx><iyy>0.5</iyy><izz>0.5</izz>"
    "</inertia></inertial></link></model>"
)
ON = "<enable_wind>true</enable_wind>"
WIND = "<wind><linear_velocity>3 4 0</linear_velocity></wind>"
SWIFT = "<horizontal><magnitude><time_for_rise>0.001</time_for_rise></magnitude></horizontal>"


@pytest.fixture
def windy():
    with contextlib.ExitStack() as started:

        def make(tags=SWIFT, *, wind=WIND, file="gz-sim-wind-effects-system"):
            bodies = (
                BODY.format(name="model_on", x=0, model=ON, link="")
                + BODY.format(name="link_on", x=5, model="", link=ON)
                + BODY.format(name="off", x=10, model="", link="")
            )
            text = (
                f'<sdf version="1.9"><world name="w"><gravity>0 0 0</gravity>{wind}'
                f'<plugin name="p" filename="{file}">{tags}</plugin>{bodies}</world></sdf>'
            )
            return started.enter_context(World(text))

        yield make


def speed(world, model):
    return world.model(model).link("a").velocity.linear


@pytest.mark.parametrize("file", ["gz-sim-wind-effects-system", "libWindPlugin.so"])
def test_links_are_pulled_along(windy, file):
    world = windy(file=file)
    world.run(1.0)
    # A first-order lag: the force is m (w - v).
    part = 1.0 - math.exp(-1.0)
    for name in ("model_on", "link_on"):
        assert speed(world, name) == pytest.approx((3 * part, 4 * part, 0.0), rel=0.01, abs=1e-6)
        # The force acts at the centre of mass.
        assert world.model(name).link("a").velocity.angular == pytest.approx((0, 0, 0), abs=1e-9)
    assert speed(world, "off") == (0.0, 0.0, 0.0)


def test_a_large_factor_is_stable(windy):
    strong = f"<force_approximation_scaling_factor>1e4</force_approximation_scaling_factor>{SWIFT}"
    world = windy(strong)
    world.run(0.5)
    assert speed(world, "model_on") == pytest.approx((3.0, 4.0, 0.0), rel=1e-3, abs=1e-6)


def test_the_wind_rises_and_fluctuates(windy):
    world = windy(
        "<force_approximation_scaling_factor>1e4</force_approximation_scaling_factor>"
        "<horizontal><magnitude><time_for_rise>2</time_for_rise></magnitude><direction><sin>"
        "<amplitude>90</amplitude><period>8</period></sin></direction></horizontal>"
    )
    world.run(2.0)
    x, y, _ = speed(world, "model_on")
    assert math.hypot(x, y) == pytest.approx(5 * (1 - math.exp(-1)), rel=0.01)
    # A quarter of the period: 90 degrees further.
    assert math.atan2(y, x) == pytest.approx(math.atan2(4, 3) + math.pi / 2, abs=0.01)


def test_noise_is_repeatable(windy):
    noisy = SWIFT + (
        "<vertical><noise type='gaussian'><mean>0</mean><stddev>5</stddev></noise></vertical>"
    )
    ends = []
    for _ in range(2):
        world = windy(noisy)
        world.run(0.5)
        ends.append(speed(world, "model_on")[2])
    assert ends[0] == ends[1] != 0.0


def test_what_has_no_effect_is_reported(windy):
    assert coded(windy(wind=""), devices.PLUGIN_IDLE)
    functions = "<force_approximation_scaling_factor><k>2</k></force_approximation_scaling_factor>"
    assert coded(windy(functions), running.PLUGIN_LEFT_OUT)
