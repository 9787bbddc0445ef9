"""Tables of controller parameters: what they declare, and how they are read."""

import sys
from dataclasses import dataclass, fields
from pathlib import Path

import pytest
from tests import launching

from cartwheel.codes import devices
from cartwheel.dialects.ros_control.catalogue import controller_types
from cartwheel.dialects.ros_control.parameters import (
    OWN,
    SIZES,
    ignored,
    parameter,
    read_parameters_of,
    rows,
)
from cartwheel.dialects.ros_control.settings import Settings
from cartwheel.errors import PluginError

FAMILIES = sorted(set(controller_types().values()), key=lambda each: each.__name__)


@dataclass(frozen=True, kw_only=True, slots=True)
class Table:
    wheels: tuple[str, ...] = parameter(
        ros1=("wheel",), ros2=("wheel_names",), role="joint", interface=OWN, doc="Joints."
    )
    front: bool = parameter("front_steering", default=True, role="front_steering", doc="Axle.")
    track: float = parameter(
        "track", "{driven}_track", default=0.5, unit="m", positive=True, doc="Distance."
    )
    radius: float | None = parameter("radius", default=None, unit="m", doc="Radius.")
    stamped: bool = parameter(ros1=(), ros2=("stamped",), default=False, doc="Type.")
    unused: None = ignored("verbose")


def read(ros2=True, **values):
    settings = Settings(values, "drive")
    return read_parameters_of(Table, settings, ros2=ros2), settings.unread()


def test_names_depend_on_the_ros_version():
    assert read(ros2=False, wheel="a")[0].wheels == ("a",)
    assert read(wheel_names=["a", "b"])[0].wheels == ("a", "b")


def test_a_parameter_of_the_other_version_is_not_read():
    found, unread = read(ros2=False, wheel="a", stamped=True)
    assert (found.stamped, unread) == (False, ["stamped"])


def test_parameters_without_effect_are_known():
    assert read(wheel_names="a", verbose=True)[1] == []


def test_missing_parameters_have_their_defaults():
    found, _ = read(wheel_names="a")
    assert (found.track, found.radius, found.front) == (0.5, None, True)


@pytest.mark.parametrize(("front", "track"), [(True, 0.1), (False, 0.2)])
def test_the_name_of_an_axle_depends_on_the_steered_axle(front, track):
    found, _ = read(wheel_names="a", front_steering=front, rear_track=0.1, front_track=0.2)
    assert found.track == track


def test_the_first_name_that_exists_is_read():
    assert read(wheel_names="a", track=0.3, rear_track=0.1)[0].track == 0.3


@pytest.mark.parametrize(
    ("values", "code"),
    [
        ({}, devices.CONTROLLER_PARAMETER_MISSING),
        ({"wheel_names": "a", "track": 0.0}, devices.CONTROLLER_PARAMETER_INVALID),
        ({"wheel_names": "a", "radius": "x"}, devices.CONTROLLER_PARAMETER_INVALID),
        ({"wheel_names": "a", "front_steering": 3}, devices.CONTROLLER_PARAMETER_INVALID),
    ],
)
def test_missing_and_invalid_values_are_errors(values, code):
    with pytest.raises(PluginError) as caught:
        read(**values)
    assert caught.value.code is code


@pytest.mark.parametrize("family", FAMILIES, ids=lambda each: each.__name__)
def test_each_controller_declares_what_the_checks_need(family):
    table = family.parameters
    known = {each.name: each.metadata for each in fields(table)}
    for ros2 in (True, False):
        for row in rows(table, ros2=ros2):
            assert row.doc.endswith(".")
            # Sizes are compared with joints of the same table.
            assert bool(row.wheels) == (row.role in SIZES)
            assert all(known[field]["role"] == "joint" for field in row.wheels)
            # A joint with a role is commanded, so its interface must be known.
            assert bool(row.interface) == (row.role == "joint")


def test_the_page_is_up_to_date():
    script = Path(__file__).parents[3] / "tools" / "make_controller_tables.py"
    done = launching.run(
        [sys.executable, str(script), "--check"], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
