"""Parameters of PID controllers."""

import pytest

from cartwheel.codes import devices
from cartwheel.devices.joints.pid import Pid
from cartwheel.dialects.ros_control.gains import read_gains, read_ros2_gains
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.errors import PluginError


def test_without_a_clamp_the_integral_gives_nothing_as_in_ros_control():
    gains = read_gains(Settings({"p": 1.0, "i": 5.0}, "c"))
    assert (gains.i_min, gains.i_max) == (0.0, 0.0)
    gains = read_gains(Settings({"p": 1.0, "i": 5.0, "i_clamp": 3.0}, "c"))
    assert (gains.i_min, gains.i_max) == (-3.0, 3.0)
    gains = read_gains(Settings({"p": 1.0, "i": 5.0, "i_clamp_min": -1.0, "i_clamp_max": 2.0}, "c"))
    assert (gains.i_min, gains.i_max) == (-1.0, 2.0)


def test_there_must_be_a_p():
    with pytest.raises(PluginError) as caught:
        read_gains(Settings({"i": 1.0}, "c"))
    assert caught.value.code is devices.CONTROLLER_PARAMETER_MISSING


def test_ros2_clamps_nothing_that_is_not_stated():
    gains = read_ros2_gains(Settings({"p": 1.0, "i": 2.0}, "arm"))
    pid = Pid(gains)
    for _ in range(1000):
        law = pid.position(1.0, 0.1, target=0.0)
    assert law.effort == pytest.approx(1.0 + 2.0 * 1000 * 0.1)
    assert read_ros2_gains(Settings({}, "arm")).p == 0.0


def test_ros2_clamps_the_integral_and_the_whole():
    values = {"p": 10.0, "i": 2.0, "d": 1.0, "i_clamp_max": 0.5, "i_clamp_min": -0.2}
    values |= {"u_clamp_max": 4.0, "u_clamp_min": -3.0}
    pid = Pid(read_ros2_gains(Settings(values, "arm")))
    for _ in range(100):
        law = pid.position(0.1, 0.1, target=0.0)
    assert law.effort == pytest.approx(10.0 * 0.1 + 0.5)
    # Within its bounds it stays a law; beyond them it is a number.
    assert pid.limited(law, 0.2) is law
    assert (pid.limited(law, -5.0).effort, pid.limited(law, -5.0).damping) == (4.0, 0.0)
    assert pid.limited(law, 5.0).effort == -3.0


def test_ros2_takes_no_strategy_that_there_is_not():
    with pytest.raises(PluginError) as caught:
        read_ros2_gains(Settings({"antiwindup_strategy": "back_calculation"}, "arm"))
    assert caught.value.values["parameter"] == "antiwindup_strategy"
