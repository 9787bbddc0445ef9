"""Plugins in Python files that the user specifies."""

from __future__ import annotations

import os
import sys
from pathlib import Path

import numpy as np
import pytest
from tests.coded import coded, raises

import cartwheel as cw
from cartwheel.codes import devices, graph, running
from cartwheel.corpus import try_robot
from cartwheel.dialects.plugin_files import using
from cartwheel.errors import Code, PluginError

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


SCALE = """
from dataclasses import dataclass
from cartwheel.plugin import Plugin, tag

@dataclass(frozen=True, kw_only=True)
class Parameters:
    collision: str = tag("collision", doc="The collision.")

class Scale(Plugin[Parameters]):
    filenames = ("libscale.so",)
    parameters = Parameters

    def configure(self):
        self.load = self.advertise("load", "std_msgs/msg/Float64")
        self.part.schedule(10.0, after=self.weigh)

    def weigh(self):
        contacts = self.part.contacts([f"tray::{self.config.collision}"])
        self.load.publish(self.message_class("std_msgs/msg/Float64")(
            float(sum(each.force[2] for each in contacts))))
"""
TRAY = """<robot name="tray"><link name="tray"><inertial><mass value="2"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision name="plate"><geometry><box size="0.5 0.5 0.1"/></geometry></collision></link>
<gazebo><plugin name="s" filename="libscale.so"><collision>{name}</collision></plugin></gazebo>
</robot>"""


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


@pytest.mark.wording
def test_a_plugin_whose_file_is_not_passed_names_the_option() -> None:
    with cw.World() as world:
        world.spawn(EXAMPLE / "robot.urdf", z=0.1)
        (found,) = coded(world.diagnostics, devices.PLUGIN_UNKNOWN)
        assert 'plugins="FILE"' in found.hint


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


def test_a_wind_pushes_a_body(tmp_path: Path) -> None:
    """10 N on 10 kg give 1 m/s after 1 s; ten gusts vary by 0.3 / sqrt(10) of that."""
    body = """<sdf version="1.9"><model name="kite"><link name="link"><gravity>0</gravity><inertial>
      <mass>10</mass></inertial></link><plugin name="wind" filename="libgusty_wind.so">
      <force>10</force></plugin></model></sdf>"""
    with cw.World(strict=True, plugins=[EXAMPLE / "gusty_wind.py"]) as world:
        kite = world.spawn(body, z=5.0)
        world.run(seconds=1.0)
        assert kite.velocity.linear[0] == pytest.approx(1.0, abs=0.4)
        assert kite.velocity.linear[0] != pytest.approx(1.0, abs=1e-6)


def test_a_link_that_does_not_exist_is_an_error() -> None:
    kite = """<sdf version="1.9"><model name="kite"><link name="link"><inertial>
      <mass>10</mass></inertial></link><plugin name="wind" filename="libgusty_wind.so">
      <link>lnik</link></plugin></model></sdf>"""
    with cw.World(plugins=[EXAMPLE / "gusty_wind.py"]) as world, raises(running.UNKNOWN_LINK):
        world.spawn(kite)


def test_a_negative_value_is_refused(tmp_path: Path) -> None:
    plugin = (EXAMPLE / "tilt_alarm.py").read_text()
    (tmp_path / "alarm.py").write_text(plugin.replace("check_above_zero", "check_not_negative"))
    alarm = """<sdf version="1.9"><model name="crate"><link name="link"><inertial>
      <mass>10</mass></inertial></link><plugin name="alarm" filename="libtilt_alarm.so">
      <limit>{}</limit></plugin></model></sdf>"""
    with cw.World(plugins=[tmp_path / "alarm.py"]) as world:
        with raises(devices.PLUGIN_PARAMETER_INVALID, parameter="limit", value=-0.1) as caught:
            world.spawn(alarm.format(-0.1))
        assert caught.value.origin is not None and caught.value.origin.line == 3
        world.spawn(alarm.format(0))


ALL = """
import numpy as np
import cartwheel as cw
from cartwheel.plugin import CameraIntrinsics, NoTags, Plugin

class All(Plugin[NoTags]):
    \"\"\"Uses all that the guide lists.\"\"\"
    filenames = ("liball.so",)

    def configure(self):
        part = self.part
        self.link, self.joint = part.link("base"), part.joint("lift")
        self.wrench = part.wrench(self.link.name)
        self.servo = part.servo("lift", max_effort=200.0)
        self.wheel = part.velocity_motor("wheel", max_effort=None)
        down = np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]])
        self.rays = part.rays("base", cw.Pose((0, 0, -0.2)), down, minimum=0.02, maximum=9.0)
        lens = CameraIntrinsics(width=16, height=12, horizontal_fov=1.0)
        self.camera = part.camera("eye", "base", cw.Pose((0.2, 0, 0)), lens)
        self.found = self.advertise("found", "std_msgs/msg/Float64MultiArray")
        part.schedule(0, before=self.act)
        part.schedule(10.0, after=self.measure)

    def act(self):
        self.wrench.apply((0.0, 0.0, 5.0), (0.0, 0.0, 0.0))
        self.servo.command_position(0.1)
        self.wheel.command(2.0)

    def measure(self):
        part = self.part
        distances, _ = self.rays.cast()
        picture = part.render(self.camera)
        touching = part.contacts(["base::c"])
        force = sum(each.force[2] for each in touching)
        values = [distances[0], distances[1], self.joint.position, force]
        values += [self.link.proper_acceleration()[2], part.random("x").normal(), *picture.shape]
        kind = self.message_class("std_msgs/msg/Float64MultiArray")
        self.found.publish(kind(data=[float(each) for each in values]))
"""

MACHINE = """<sdf version="1.9"><model name="machine"><pose>0 0 0.25 0 0 0</pose><link name="base">
<inertial><mass>10</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>
<collision name="c"><geometry><box><size>0.5 0.5 0.5</size></box></geometry></collision></link>
<link name="arm"><pose>0 0 0.5 0 0 0</pose><inertial><mass>1</mass><inertia><ixx>0.1</ixx>
<iyy>0.1</iyy><izz>0.1</izz></inertia></inertial></link><joint name="lift" type="prismatic">
<parent>base</parent><child>arm</child><axis><xyz>0 0 1</xyz></axis></joint>
<link name="disc"><pose>0 0 0.9 0 0 0</pose><inertial><mass>1</mass><inertia><ixx>0.1</ixx>
<iyy>0.1</iyy><izz>0.1</izz></inertia></inertial></link><joint name="wheel" type="continuous">
<parent>arm</parent><child>disc</child><axis><xyz>0 0 1</xyz></axis></joint>
<plugin name="all" filename="liball.so"/></model></sdf>"""


def test_all_that_the_guide_lists(tmp_path: Path) -> None:
    (tmp_path / "all.py").write_text(ALL)
    (tmp_path / "machine.sdf").write_text(MACHINE)
    with cw.World(strict=True, plugins=[tmp_path / "all.py"]) as world:
        machine = world.spawn(tmp_path / "machine.sdf")
        found = world.mailbox("/found")
        world.run(seconds=2.0)
        below, above, height, force, acceleration, noise, *shape = found.drain()[-1].data
        assert machine.joints.velocities["wheel"] == pytest.approx(2.0, rel=1e-3)
    assert (below, above) == (pytest.approx(0.05, abs=2e-3), float("inf"))
    assert height == pytest.approx(0.1, abs=1e-3)
    assert force == pytest.approx(12 * 9.8 - 5, rel=0.01)
    assert acceleration == pytest.approx(9.8, abs=0.05)
    assert noise != 0 and shape == [12, 16, 3]


@pytest.mark.wording
def test_a_handle_instead_of_a_name_is_explained(tmp_path: Path) -> None:
    wrong = ALL.replace("part.wrench(self.link.name)", "part.wrench(self.link)")
    (tmp_path / "all.py").write_text(wrong)
    (tmp_path / "machine.sdf").write_text(MACHINE)
    with cw.World(plugins=[tmp_path / "all.py"]) as world:
        with raises(running.PLUGIN_FAILED, PluginError) as caught:
            world.spawn(tmp_path / "machine.sdf")
        assert world.models == ("ground_plane",)
    assert "link.name" in caught.value.message
    line = 1 + wrong[: wrong.index("part.wrench(self.link)")].count("\n")
    assert caught.value.message.endswith(f"(all.py:{line})")
    assert str(caught.value.origin).partition(":")[0].endswith("machine.sdf")
    with cw.World(plugins=[tmp_path / "all.py"], lenient=True) as world:
        world.spawn(tmp_path / "machine.sdf")
        assert coded(world, running.PLUGIN_FAILED)


def test_contacts_of_collisions_by_their_names_in_a_urdf(tmp_path: Path) -> None:
    (tmp_path / "scale.py").write_text(SCALE)
    robot = tmp_path / "r.urdf"
    with cw.World(plugins=[tmp_path / "scale.py"]) as world:
        for number, name in enumerate(("plate", "plate_collision")):
            robot.write_text(TRAY.format(name=name))
            world.spawn(robot, name=name, namespace=name, x=2.0 * number, z=0.05)
        loads = [world.topic(f"/{name}/load") for name in ("plate", "plate_collision")]
        world.run(1.0)
        assert [each.latest.data for each in loads] == pytest.approx([19.6, 19.6], rel=0.01)
        robot.write_text(TRAY.format(name="plaet"))
        world.spawn(robot, name="wrong", namespace="wrong", x=4.0)
        world.topic("/wrong/load")
        world.run(0.1)
        (found,) = coded(world, running.PLUGIN_FAILED)
        assert found.values["cause"] == devices.CONTACT_COLLISION_UNKNOWN.number


SERVER = """
from cartwheel.plugin import NoTags, Plugin

class Server(Plugin[NoTags]):
    filenames = ("libserver.so",)

    def configure(self):
        self.serve("read", "rcl_interfaces/GetParameters", lambda request: {response})
"""
RESPONSE = 'self.message_class("rcl_interfaces/srv/GetParameters_Response")'
VALUES = "[{'integer_array_value': [1, 2]}]"


def server(folder: Path, response: str) -> cw.World:
    """A world with a plugin that offers ``/read``."""
    file = folder / "server.py"
    file.write_text(SERVER.format(response=response))
    world = cw.World("empty", plugins=file)
    world.spawn(ROBOT.replace("libgreeter.so", "libserver.so"))
    return world


@pytest.mark.parametrize("response", [f"{{'values': {VALUES}}}", f"{RESPONSE}(values={VALUES})"])
def test_responses_of_a_plugin_have_the_types_of_their_fields(
    tmp_path: Path, response: str
) -> None:
    """As messages that it publishes: mappings become messages, and lists arrays."""
    with server(tmp_path, response) as world:
        (value,) = world.call("/read").values
        assert value.integer_array_value.dtype == np.int64
        assert value.integer_array_value.tolist() == [1, 2]


@pytest.mark.parametrize(
    ("response", "code"),
    [
        (f"{RESPONSE}(values='many')", graph.FIELD_VALUE_INVALID),
        ("{'value': 1}", graph.FIELD_UNKNOWN),
        ("None", graph.SERVICE_TIMED_OUT),
    ],
)
def test_a_wrong_response_of_a_plugin_is_an_error(
    tmp_path: Path, response: str, code: Code
) -> None:
    with server(tmp_path, response) as world, raises(code):
        world.call("/read")


def test_a_check_reads_the_tags_of_a_plugin_in_a_file(tmp_path: Path) -> None:
    path = tmp_path / "crate.urdf"
    text = (EXAMPLE / "robot.urdf").read_text().replace("limit>", "limitt>")
    path.write_text(text)
    found = {each.code for each in cw.check(path).findings}
    assert devices.PLUGIN_UNKNOWN in found and devices.PLUGIN_PARAMETER_UNKNOWN not in found
    found = {each.code for each in cw.check(path, plugins=[EXAMPLE / "tilt_alarm.py"]).findings}
    assert devices.PLUGIN_UNKNOWN not in found and devices.PLUGIN_PARAMETER_UNKNOWN in found
    # The next check does not know it any more.
    assert devices.PLUGIN_UNKNOWN in {each.code for each in cw.check(path).findings}
    with raises(devices.PLUGIN_FILE_INVALID):
        cw.check(path, plugins=[tmp_path / "absent.py"])


def test_the_corpus_tries_a_robot_with_a_plugin_in_a_file() -> None:
    robot = EXAMPLE / "robot.urdf"
    with using([EXAMPLE / "tilt_alarm.py"]):
        verdict = try_robot(robot, standing=1.0)
    assert verdict.plugins == ("tilt_alarm",) and not verdict.missing and verdict.good
    assert try_robot(robot, standing=1.0).missing == ("tilt_alarm",)


def test_a_file_that_was_changed_in_the_same_second_is_read_again(
    tmp_path: Path, robot: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Python's compiled file would be valid: the source has the same size and time."""
    monkeypatch.setattr(sys, "dont_write_bytecode", False)
    path = greeter(tmp_path, "first")
    for word in ("first", "other"):
        path.write_text(path.read_text().replace("first", word))
        os.utime(path, (1e9, 1e9))
        with cw.World(plugins=[path]) as world:
            world.spawn(robot)
            assert f"/{word}" in {topic.name for topic in world.graph.topics()}
