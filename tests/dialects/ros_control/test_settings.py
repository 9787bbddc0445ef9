"""Parameters of controllers: nested, dotted, and reported if their type is wrong."""

import pytest

from cartwheel.codes import devices
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.errors import PluginError


def test_dots_and_slashes_and_nesting_are_the_same():
    values = {"linear.x.max_velocity": 1.0, "linear": {"x": {"min_velocity": -0.5}}, "a/b": 2}
    settings = Settings(values, "drive")
    assert settings.number("linear/x/max_velocity") == 1.0
    assert settings.number("linear/x/min_velocity") == -0.5
    assert settings.integer("a/b") == 2


def test_a_wrong_kind_names_parameter_controller_and_file():
    settings = Settings({"joint": 3, "rate": "fast", "on": "yes", "names": [1]}, "c", "c.yaml")
    for read, name in (
        (settings.text, "joint"),
        (settings.number, "rate"),
        (settings.boolean, "on"),
        (settings.texts, "names"),
    ):
        with pytest.raises(PluginError) as caught:
            read(name)
        assert caught.value.code is devices.CONTROLLER_PARAMETER_INVALID
        assert caught.value.values["controller"] == "c"
        assert caught.value.values["parameter"] == name
        assert str(caught.value.origin) == "c.yaml"


def test_a_missing_one_says_what_was_likely_meant():
    settings = Settings({"jonit": "a"}, "c", "c.yaml")
    with pytest.raises(PluginError) as caught:
        settings.text("joint")
    assert caught.value.code is devices.CONTROLLER_PARAMETER_MISSING
    assert caught.value.values["parameter"] == "joint"
    assert caught.value.values["meant"] == "jonit"


def test_what_nobody_asked_for_is_known():
    settings = Settings({"joint": "a", "pid": {"p": 1.0, "q": 2.0}, "x": 1}, "c")
    settings.text("joint")
    settings.section("pid")
    assert settings.unread() == ["pid/p", "pid/q", "x"]
    settings.ignore("pid")
    assert settings.unread() == ["x"]


def test_numbers_that_yaml_takes_for_text():
    assert Settings({"x": "1e-3"}, "c").number("x") == 0.001
