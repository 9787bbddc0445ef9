"""The PID law against its definition."""

import pytest

from cartwheel.codes import devices
from cartwheel.dialects.ros_control.pid import Gains, Pid
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.errors import PluginError


def test_each_term():
    pid = Pid(Gains(p=2.0, i=3.0, d=4.0, i_min=-10, i_max=10))
    law = pid.position(0.5, 0.1, target=1.0)
    # The first time the target has not changed; its own speed is the damping's.
    assert law.effort == pytest.approx(2 * 0.5 + 3 * 0.5 * 0.1)
    assert law.damping == 4.0
    law = pid.position(0.4, 0.1, target=1.2)
    assert law.effort == pytest.approx(2 * 0.4 + 3 * (0.5 + 0.4) * 0.1 + 4 * 0.2 / 0.1)


def test_the_integral_is_clamped_by_what_it_gives():
    pid = Pid(Gains(p=0.0, i=10.0, i_min=-1, i_max=2))
    for _ in range(100):
        law = pid.position(1.0, 0.1, target=0.0)
    assert law.effort == 2.0
    # It went on to grow, so it takes as long to come back...
    for _ in range(50):
        law = pid.position(-1.0, 0.1, target=0.0)
    assert law.effort == 2.0


def test_antiwindup_clamps_the_integral_itself():
    pid = Pid(Gains(p=0.0, i=10.0, i_min=-1, i_max=2, antiwindup=True))
    for _ in range(100):
        law = pid.position(1.0, 0.1, target=0.0)
    assert law.effort == 2.0
    law = pid.position(-1.0, 0.1, target=0.0)
    assert law.effort == pytest.approx(2.0 - 10 * 0.1)


def test_without_a_clamp_the_integral_gives_nothing_as_in_ros_control():
    gains = Gains.read(Settings({"p": 1.0, "i": 5.0}, "c"))
    assert (gains.i_min, gains.i_max) == (0.0, 0.0)
    gains = Gains.read(Settings({"p": 1.0, "i": 5.0, "i_clamp": 3.0}, "c"))
    assert (gains.i_min, gains.i_max) == (-3.0, 3.0)
    gains = Gains.read(Settings({"p": 1.0, "i": 5.0, "i_clamp_min": -1.0, "i_clamp_max": 2.0}, "c"))
    assert (gains.i_min, gains.i_max) == (-1.0, 2.0)


def test_there_must_be_a_p():
    with pytest.raises(PluginError) as caught:
        Gains.read(Settings({"i": 1.0}, "c"))
    assert caught.value.code is devices.CONTROLLER_PARAMETER_MISSING


def test_a_velocity_is_held_by_p_as_damping():
    law = Pid(Gains(p=3.0)).velocity(2.0, 0.5, 0.01)
    assert law.effort - law.damping * 0.5 == pytest.approx(3.0 * (2.0 - 0.5))


def test_ros2_clamps_nothing_that_is_not_stated():
    gains = Gains.read_ros2(Settings({"p": 1.0, "i": 2.0}, "arm"))
    pid = Pid(gains)
    for _ in range(1000):
        law = pid.position(1.0, 0.1, target=0.0)
    assert law.effort == pytest.approx(1.0 + 2.0 * 1000 * 0.1)
    assert Gains.read_ros2(Settings({}, "arm")).p == 0.0


def test_ros2_clamps_the_integral_and_the_whole():
    values = {"p": 10.0, "i": 2.0, "d": 1.0, "i_clamp_max": 0.5, "i_clamp_min": -0.2}
    values |= {"u_clamp_max": 4.0, "u_clamp_min": -3.0}
    pid = Pid(Gains.read_ros2(Settings(values, "arm")))
    for _ in range(100):
        law = pid.position(0.1, 0.1, target=0.0)
    assert law.effort == pytest.approx(10.0 * 0.1 + 0.5)
    # Within its bounds it stays a law; beyond them it is a number.
    assert pid.bounded(law, 0.2) is law
    assert (pid.bounded(law, -5.0).effort, pid.bounded(law, -5.0).damping) == (4.0, 0.0)
    assert pid.bounded(law, 5.0).effort == -3.0


def test_ros2_takes_no_strategy_that_there_is_not():
    with pytest.raises(PluginError) as caught:
        Gains.read_ros2(Settings({"antiwindup_strategy": "back_calculation"}, "arm"))
    assert caught.value.values["parameter"] == "antiwindup_strategy"


def test_the_derivative_of_a_velocity_is_that_of_its_target():
    pid = Pid(Gains(p=0.0, d=2.0))
    pid.velocity(1.0, 0.0, 0.01)
    # Whatever the joint does: on its velocity it would be an inertia that comes a step late.
    assert pid.velocity(1.0, 5.0, 0.01).effort == 0.0
    assert pid.velocity(1.5, 5.0, 0.01).effort == pytest.approx(2.0 * 0.5 / 0.01)


@pytest.mark.parametrize(("inertia", "damping"), [(1.0, 0.2), (1e-3, 0.2 + 10 * 0.01)])
def test_what_swings_too_fast_to_be_followed_is_damped(inertia, damping):
    """(omega T)² is 0.001 and 1: the second would be seen six times in a swing."""
    pid = Pid(Gains(p=10.0, d=0.2))
    law = pid.position(0.3, 0.01, target=0.3, rate=0.0, lightness=1 / inertia)
    assert law.effort == pytest.approx(3.0)
    assert law.damping == pytest.approx(damping)
