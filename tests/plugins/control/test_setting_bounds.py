"""Numbers of controllers and sensors beyond what can be simulated."""

import re

import pytest

import cartwheel as cw
from cartwheel.description import load_text
from cartwheel.errors import PluginError
from cartwheel.plugins.air_pressure import pressure_at
from cartwheel.plugins.control.settings import Settings

_SLIP = """<robot name="r"><link name="a"/>
<joint name="j" type="continuous"><parent link="a"/><child link="w"/></joint><link name="w"/>
<gazebo><plugin name="p" filename="libgazebo_ros_wheel_slip.so"><wheel link_name="w">
<wheel_radius>1e308</wheel_radius><wheel_normal_force>9</wheel_normal_force></wheel>
</plugin></gazebo></robot>"""


@pytest.mark.parametrize(
    "value", [1e308, -1e16, "1e300", 10**400, float("nan")], ids=lambda value: str(value)[:9]
)
def test_a_number_beyond_its_bound(value):
    settings = Settings({"a": value}, "c", "c.yaml")
    with pytest.raises(PluginError, match='controller c: the parameter "a" must be') as got:
        settings.number("a")
    assert "(c.yaml)" in got.value.message
    assert len(got.value.message) < 200


def test_infinity_is_no_limit():
    assert Settings({"a": float("inf")}, "c").number("a") == float("inf")


@pytest.mark.parametrize("value", [1e9, float("inf"), 1.5])
def test_a_count_beyond_its_bound(value):
    message = r"must be a whole number from -1,000,000 to 1,000,000"
    with pytest.raises(PluginError, match=message):
        Settings({"a": value}, "c").integer("a")


def test_a_list_with_a_number_beyond_its_bound():
    with pytest.raises(PluginError, match=re.escape("must be from -1e+15 to 1e+15")):
        Settings({"a": [1.0, 1e308]}, "c").numbers("a")


def test_a_wheel_that_slips_has_a_bounded_radius():
    message = '<wheel_radius> "1e308" must be a number from -1e+15 to 1e+15'
    with cw.World("empty") as world, pytest.raises(PluginError, match=re.escape(message)) as got:
        world.spawn(load_text(_SLIP, file="r"))
    assert str(got.value.origin) == "r:4"


@pytest.mark.parametrize("height", [44_331.0, 1e6, 1e15])
def test_above_the_air_there_is_no_pressure(height):
    assert pressure_at(height) == 0
