"""YAML of strangers: bounds on files, depth and what aliases stand for, wherever it is read."""

import math
import os

import pytest
import yaml
from tests.coded import raises

from cartwheel import yaml_text
from cartwheel.bridges.recording.folder_reading import _metadata
from cartwheel.bridges.recording.reading import is_latched
from cartwheel.bridges.ros1.names import _yaml
from cartwheel.checks.controller_files import ControlFile
from cartwheel.codes.devices import BRIDGE_FILE_INVALID, CONTROLLERS_FILE_UNREADABLE
from cartwheel.codes.recording import RECORDING_DAMAGED
from cartwheel.dialects.gz.bridge_file import read_bridge
from cartwheel.dialects.ros_control.files import read_yaml
from cartwheel.errors import PluginError

BOMB = "a: &a [x,x,x,x,x,x,x,x,x]\n" + "".join(
    f"{name}: &{name} [{','.join(['*' + chr(ord(name) - 1)] * 9)}]\n" for name in "bcdefghij"
)
HOSTILE = {
    "aliases": BOMB,
    "itself": "a: &a [*a]",
    "merged itself": "a: &a\n  <<: *a\n",
    "brackets": "a: " + "[" * 100_000,
    "braces": "{a: " * 1000,
    "date": "a: 2001-99-99",
    "empty int": "a: {!!int : b}",
    "no bool": "a: !!bool x",
    "empty float": "a: !!float ''",
    "no timestamp": "a: !!timestamp x",
    "python": "a: !!python/object/apply:os.system [echo]",
}
LINES = {"aliases": 5, "merged itself": 1}
"""Lines of the errors, from 0, where they are not in the first."""
REASONS = {
    "aliases": "more than 200,000 values",
    "itself": "contains itself",
    "merged itself": "contains itself",
    "brackets": "nested more than 50 levels deep",
    "braces": "nested more than 50 levels deep",
    "date": "month must be in",
    "empty int": "expected a value of type .int",
    "no bool": "expected a value of type .bool",
    "empty float": "expected a value of type .float",
    "no timestamp": "expected a value of type .timestamp",
    "python": "could not determine a constructor",
}


@pytest.mark.parametrize("name", HOSTILE)
def test_bounds(name):
    with pytest.raises(yaml.MarkedYAMLError) as error:
        yaml_text.load(HOSTILE[name])
    assert error.value.problem_mark.line == LINES.get(name, 0)


@pytest.mark.wording
@pytest.mark.parametrize("name", HOSTILE)
def test_bounds_say_why(name):
    with pytest.raises(yaml.YAMLError, match=REASONS[name]):
        yaml_text.load(HOSTILE[name])


def test_aliases_and_merges_work():
    text = "a: &a {x: 1, y: [2, 3]}\nb: {<<: *a, x: 4}\nc: [*a, *a]\nd: 2001-02-03\ne: 1.5\n"
    assert yaml_text.load(text) == yaml.safe_load(text)


@pytest.mark.parametrize("name", HOSTILE)
def test_each_reader_has_the_bounds(name, tmp_path):
    text = HOSTILE[name]
    file = tmp_path / "metadata.yaml"
    file.write_text(text)
    with raises(CONTROLLERS_FILE_UNREADABLE):
        read_yaml(file)
    with raises(RECORDING_DAMAGED):
        _metadata(tmp_path)
    assert is_latched(text) is False
    assert _yaml(text) == text
    if name in ("aliases", "itself", "merged itself", "brackets", "braces"):
        assert ControlFile(path=file, named=True).problem is not None
        with raises(BRIDGE_FILE_INVALID):
            read_bridge(file)


@pytest.mark.parametrize("name", ["pipe", "zero", "large", "folder"])
def test_only_regular_files_of_some_size_are_read(name, tmp_path):
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "zero").symlink_to("/dev/zero")
    (tmp_path / "folder").mkdir()
    with (tmp_path / "large").open("wb") as file:
        file.truncate(10**10)
    with pytest.raises(OSError) as error:
        yaml_text.read(tmp_path / name)
    assert type(error.value) is OSError  # Neither missing nor forbidden.


@pytest.mark.parametrize(
    ("text", "angle"),
    [
        ("!degrees 120.0", 2 * math.pi / 3),
        ("!degrees 1e1", math.pi / 18),
        ("!radians 3*pi/4", 3 * math.pi / 4),
        ("deg(-90)", -math.pi / 2),
        ("rad(pi - 1)", math.pi - 1),
    ],
)
def test_angles_of_rosparam_are_in_radians(tmp_path, text, angle):
    file = tmp_path / "c.yaml"
    file.write_text(f"angle: {text}\nname: degenerate\nother: rad\n")
    content = read_yaml(file)
    assert content == {"angle": pytest.approx(angle), "name": "degenerate", "other": "rad"}


@pytest.mark.parametrize(
    "text",
    [
        "!degrees [1]",
        "!degrees north",
        "rad(pi/0)",
        "rad(9**9**9)",
        "!radians __import__",
        "!radians '" + "-" * 200 + "1'",
        "!radians '" + "1+" * 1000 + "1'",
        "rad(1e999 * 0 j)",
    ],
)
def test_invalid_angles_of_rosparam_are_reported_with_their_line(tmp_path, text):
    file = tmp_path / "c.yaml"
    file.write_text(f"name: x\nangle: {text}\n")
    with raises(CONTROLLERS_FILE_UNREADABLE, PluginError) as error:
        read_yaml(file)
    assert error.value.origin.line == 2


def test_ros2_has_no_angles_in_degrees(tmp_path):
    file = tmp_path / "c.yaml"
    file.write_text("arm: {ros__parameters: {name: deg(90)}}\n")
    assert read_yaml(file) == {"arm": {"ros__parameters": {"name": "deg(90)"}}}


def test_a_mapping_that_is_merged_with_itself_does_not_grow_without_bound(tmp_path):
    path = tmp_path / "c.yaml"
    path.write_text("a: &x {ros__parameters: {b: 1}}\n" + "a: *x\n" * 60 + "c: *x\n")
    assert read_yaml(path) == {
        "a": {"ros__parameters": {"b": 1}},
        "c": {"ros__parameters": {"b": 1}},
    }


def test_two_mappings_that_are_merged_with_each_other_do_not_grow_without_bound(tmp_path):
    path = tmp_path / "c.yaml"
    text = "a: &x {ros__parameters: {b: 1}}\nc: &y {ros__parameters: {d: 2}}\n"
    path.write_text(text + "a: *y\nc: *x\n" * 60)
    both = {"ros__parameters": {"b": 1, "d": 2}}
    assert read_yaml(path) == {"a": both, "c": both}
