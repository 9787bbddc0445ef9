"""Numbers of controllers and sensors beyond what can be simulated."""

import pytest

import cartwheel as cw
from cartwheel.codes import devices
from cartwheel.description import load_text
from cartwheel.devices.position.barometer import pressure_at
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.errors import PluginError

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
    with pytest.raises(PluginError) as got:
        settings.number("a")
    assert got.value.code is devices.CONTROLLER_PARAMETER_INVALID
    assert got.value.values["parameter"] == "a"
    assert str(got.value.origin) == "c.yaml"
    assert len(got.value.message) < 200


def test_infinity_is_no_limit():
    assert Settings({"a": float("inf")}, "c").number("a") == float("inf")


@pytest.mark.parametrize("value", [1e9, float("inf"), 1.5])
def test_a_count_beyond_its_bound(value):
    with pytest.raises(PluginError) as got:
        Settings({"a": value}, "c").integer("a")
    assert got.value.code is devices.CONTROLLER_PARAMETER_INVALID


def test_a_list_with_a_number_beyond_its_bound():
    with pytest.raises(PluginError) as got:
        Settings({"a": [1.0, 1e308]}, "c").numbers("a")
    assert got.value.code is devices.CONTROLLER_PARAMETER_INVALID


def test_a_wheel_that_slips_has_a_bounded_radius():
    with cw.World("empty") as world, pytest.raises(PluginError) as got:
        world.spawn(load_text(_SLIP, file="r"))
    assert got.value.code is devices.PLUGIN_PARAMETER_INVALID
    assert got.value.values["parameter"] == "wheel_radius"
    assert str(got.value.origin) == "r:4"


@pytest.mark.parametrize("height", [44_331.0, 1e6, 1e15])
def test_above_the_air_there_is_no_pressure(height):
    assert pressure_at(height) == 0
