"""Plugins in Python files that the user specifies."""

from __future__ import annotations

from pathlib import Path

import pytest
from tests.coded import coded, raises

import cartwheel as cw
from cartwheel.codes import devices

EXAMPLE = Path(__file__).parents[2] / "examples" / "plugin"
GREETER = """
from __future__ import annotations
from dataclasses import dataclass
from cartwheel.plugin import Plugin, tag

@dataclass(frozen=True, kw_only=True)
class Parameters:
    word: str = tag("word", default="{word}", doc="The greeting.")

class Greeter(Plugin[Parameters]):
    filenames = ("{filename}",)
    parameters = Parameters

    def configure(self) -> None:
        self.greeting = self.advertise(self.config.word, "std_msgs/msg/String", qos="latched")
"""
ROBOT = """<robot name="r"><link name="base"/>
<gazebo><plugin name="g" filename="libgreeter.so"/></gazebo></robot>"""


def greeter(folder: Path, word: str, filename: str = "libgreeter.so") -> Path:
    path = folder / f"{word}.py"
    path.write_text(GREETER.format(word=word, filename=filename))
    return path


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    path = tmp_path / "r.urdf"
    path.write_text(ROBOT)
    return path


def test_a_file_provides_the_plugin_that_a_robot_names() -> None:
    with cw.World(strict=True, plugins=[EXAMPLE / "tilt_alarm.py"]) as world:
        world.spawn(EXAMPLE / "robot.urdf", z=0.1)
        alarms = world.mailbox("/tilt_alarm")
        world.run(seconds=0.1)
        assert [alarm.data for alarm in alarms.drain()] == [False, False]


def test_each_world_has_its_own_files(tmp_path: Path, robot: Path) -> None:
    one, two = greeter(tmp_path, "hello"), greeter(tmp_path, "goodbye")
    with cw.World(plugins=[one]) as first, cw.World(plugins=[two]) as second, cw.World() as third:
        for world in (first, second, third):
            world.spawn(robot)
        assert {"/hello"} == {t.name for t in first.graph.topics()} & {"/hello", "/goodbye"}
        assert {"/goodbye"} == {t.name for t in second.graph.topics()} & {"/hello", "/goodbye"}
        assert coded(third, devices.PLUGIN_UNKNOWN, name="libgreeter.so")


def test_the_last_file_takes_precedence(tmp_path: Path, robot: Path) -> None:
    files = [greeter(tmp_path, "hello"), greeter(tmp_path, "goodbye")]
    with cw.World(plugins=files) as world:
        world.spawn(robot)
        assert "/goodbye" in {topic.name for topic in world.graph.topics()}


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ('tag("word", default="hello", doc="The greeting.")', '"hello"'),
        ("def configure", "def configured"),
        (
            "class Greeter(Plugin",
            "class Other(Plugin[Parameters]):\n"
            "    filenames = ('greeter.so',)\n"
            "    parameters = Parameters\n"
            "    def configure(self) -> None: ...\n\n"
            "class Greeter(Plugin",
        ),
    ],
    ids=["field without tag", "no configure", "one name twice"],
)
def test_an_incomplete_plugin_is_an_error(tmp_path: Path, old: str, new: str) -> None:
    path = greeter(tmp_path, "hello")
    text = path.read_text()
    assert old in text
    with cw.World(plugins=[path]):
        pass
    path.write_text(text.replace(old, new))
    with raises(devices.PLUGIN_FILE_INVALID, path=str(path)):
        cw.World(plugins=[path])


def test_an_import_that_fails_names_the_way_out(tmp_path: Path) -> None:
    path = tmp_path / "one.py"
    path.write_text("import a_neighbour_that_does_not_exist\n")
    with raises(devices.PLUGIN_FILE_INVALID, path=str(path)) as caught:
        cw.World(plugins=[path])
    assert caught.value.hint
    assert caught.value.origin is not None
    assert caught.value.origin.line == 1


def test_a_file_replaces_a_plugin_of_cartwheel(tmp_path: Path) -> None:
    robot = tmp_path / "r.urdf"
    robot.write_text(ROBOT.replace("libgreeter.so", "libgazebo_ros_p3d.so"))
    with cw.World(plugins=[greeter(tmp_path, "hello", "libgazebo_ros_p3d.so")]) as world:
        world.spawn(robot)
        assert "/hello" in {topic.name for topic in world.graph.topics()}


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("x = 1\n", 0),
        ("x = 1\nraise ValueError('no licence')\n", 2),
        ("x = 1\ndef broken(:\n", 2),
        ("import sys\nsys.exit(3)\n", 2),
        (
            "from cartwheel.plugin import Plugin\nclass P(Plugin):\n    filenames = 'libp.so'\n",
            0,
        ),
        ("from cartwheel.plugin import Plugin\nclass P(Plugin):\n    pass\n", 0),
    ],
    ids=["no plugin", "raises", "syntax", "exits", "filenames", "incomplete"],
)
def test_a_file_that_cannot_be_used_is_an_error_with_its_place(
    tmp_path: Path, text: str, line: int
) -> None:
    path = tmp_path / "mine.py"
    path.write_text(text)
    with raises(devices.PLUGIN_FILE_INVALID, path=str(path)) as caught:
        cw.World(plugins=[path])
    assert caught.value.origin == cw.errors.Origin(file=str(path), line=line)


@pytest.mark.parametrize("name", ["missing.py", "."])
def test_a_missing_file_is_an_error(tmp_path: Path, name: str) -> None:
    with raises(devices.PLUGIN_FILE_INVALID, path=str(tmp_path / name)):
        cw.World(plugins=[tmp_path / name])


def test_a_file_with_another_suffix_is_an_error(tmp_path: Path) -> None:
    path = tmp_path / "plugin.txt"
    path.write_text("x = 1\n")
    with raises(devices.PLUGIN_FILE_INVALID, path=str(path)):
        cw.World(plugins=[path])
