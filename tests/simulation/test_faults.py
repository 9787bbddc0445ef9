"""Code of others that raises errors: it is named and ended, and time goes on."""

import dataclasses
import importlib.metadata
import signal
import sys
import traceback

import pytest
from tests import launching
from tests.coded import coded

import cartwheel as cw
from cartwheel.codes import devices, running
from cartwheel.codes import world as world_codes
from cartwheel.codes.command import INTERNAL_FAULT
from cartwheel.description import load_robot
from cartwheel.description.model import WorldDescription
from cartwheel.dialects import catalogue
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.errors import CartwheelError
from cartwheel.session import Session

_ROBOT = """<robot name="cart">
  <link name="base">
    <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <link name="arm">
    <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="turn" type="continuous"><parent link="base"/><child link="arm"/></joint>
  <gazebo>
    <plugin name="faulty" filename="libfaulty.so"><when>{when}</when></plugin>
    <plugin name="states" filename="libgazebo_ros_joint_state_publisher.so"/>
  </gazebo>
</robot>
"""


@dataclasses.dataclass(frozen=True, kw_only=True, slots=True)
class FaultyParameters:
    when: str = tag("when", default="", doc="Where it fails.")


class Faulty(Plugin[FaultyParameters]):
    """Fails where its tag says."""

    filenames = ("libfaulty.so",)
    parameters = FaultyParameters

    def configure(self):
        self.calls = []
        self.motor = self.part.velocity_motor("turn", max_effort=10.0)
        self.said = self.advertise("~/said", "std_msgs/msg/Float32")
        self.subscribe("/command", "std_msgs/msg/Float32", self._listen)
        self.part.schedule(50, before=self._before, after=self._after, active=self._active)
        self._fail("configure")

    def reset(self):
        self._fail("reset")

    def close(self):
        super().close()
        self._fail("close")

    def _listen(self, message):
        self.motor.command(message.data)
        self._fail("subscription")

    def _active(self):
        self._fail("active")
        return True

    def _before(self):
        self.motor.command(3.0)
        self._fail("before")

    def _after(self):
        self._fail("after")

    def _fail(self, place):
        self.calls.append(place)
        if self.config.when == f"exit {place}":
            sys.exit(3)
        if self.config.when == f"signal {place}":
            signal.raise_signal(signal.SIGTERM)
        if self.config.when == place:
            raise ZeroDivisionError(f"in {place}")


class _Entry:
    """As an installed package would have it."""

    def __init__(self, name, plugin, error=None):
        self.name = name
        self.value = f"{name}:Plugin"
        self.dist = None
        self._plugin = plugin
        self._error = error

    def load(self):
        if self._error is not None:
            raise self._error
        return self._plugin


@pytest.fixture
def installed(monkeypatch, make):
    make.expects_faults = True
    entries = []
    monkeypatch.setattr(importlib.metadata, "entry_points", lambda group: list(entries))

    def install(*more):
        entries.extend(more)
        catalogue._installed.cache_clear()

    install(_Entry("faulty", Faulty))
    yield install
    monkeypatch.undo()
    catalogue._installed.cache_clear()


@pytest.fixture
def cart(tmp_path, installed):
    def robot(when):
        file = tmp_path / "cart.urdf"
        file.write_text(_ROBOT.format(when=when))
        return load_robot(file)

    return robot


_PLACES = ("configure", "active", "before", "after", "subscription", "reset")


@pytest.mark.parametrize("when", _PLACES)
def test_a_plugin_that_fails_is_named_and_ended_and_the_rest_goes_on(make, cart, when):
    world = make.world()
    robot = world.spawn(cart(when))
    states = world.mailbox("/joint_states")
    if when == "subscription":
        robot.publish("/command", data=2.0)
    world.run(0.5)
    if when == "reset":
        world.reset()
        world.run(0.5)
    assert world.time == pytest.approx(0.5)
    assert len(states.drain()) > 20
    (found,) = [each for each in world.diagnostics if each.severity == "error"]
    assert found.code is running.PLUGIN_FAILED
    assert found.values["cause"] == "ZeroDivisionError"
    if when == "configure":
        assert found.values["plugin"] == "libfaulty.so"
    else:
        assert found.values["plugin"] == 'plugin "libfaulty.so" of model "cart"'
    assert f"ZeroDivisionError: in {when}" in found.details
    assert str(found.origin).endswith("cart.urdf:10")
    assert "Traceback" in found.details
    assert "_fail" in found.details
    # Nothing of it is left: neither topics, nor what it did to the joint.
    assert not [topic for topic in world.graph.topics() if "faulty" in str(topic.publishers)]
    before = robot.joint("turn")
    world.run(1.0)
    assert robot.joint("turn") == pytest.approx(before, abs=1e-3)
    robot.delete()
    assert len([each for each in world.diagnostics if each.severity == "error"]) == 1


@pytest.mark.parametrize("when", (*_PLACES, "close"))
def test_a_plugin_that_exits_is_named_and_the_program_goes_on(make, cart, when):
    world = make.world()
    robot = world.spawn(cart(f"exit {when}"))
    if when == "subscription":
        robot.publish("/command", data=2.0)
    world.run(0.5)
    world.reset()
    world.run(0.5)
    robot.delete()
    (found,) = [each for each in world.diagnostics if each.severity == "error"]
    assert found.code is running.PLUGIN_FAILED
    assert found.values["cause"] == "SystemExit"
    assert str(found.origin).endswith("cart.urdf:10")


@pytest.mark.parametrize("when", _PLACES)
def test_a_signal_handler_that_exits_ends_the_program(make, cart, when):
    def leave(_number, _frame):
        sys.exit(4)

    world = make.world()
    before = signal.signal(signal.SIGTERM, leave)
    try:
        with pytest.raises(SystemExit) as caught:
            robot = world.spawn(cart(f"signal {when}"))
            if when == "subscription":
                robot.publish("/command", data=2.0)
            world.run(0.5)
            world.reset()
    finally:
        signal.signal(signal.SIGTERM, before)
    assert caught.value.code == 4
    assert not [each for each in world.diagnostics if each.severity == "error"]


def test_a_plugin_that_does_not_fail_drives_the_joint(make, cart):
    """Else the test above would see a joint that stands still in any case."""
    world = make.world()
    robot = world.spawn(cart("never"))
    world.run(1.0)
    assert robot.joint("turn") > 1


def test_a_plugin_that_fails_when_it_is_closed_is_taken_away_all_the_same(make, cart):
    world = make.world()
    world.spawn(cart("close")).delete()
    assert world.models == ("ground_plane",)
    (found,) = [each for each in world.diagnostics if each.severity == "error"]
    assert found.code is running.PLUGIN_FAILED
    assert found.values["cause"] == "ZeroDivisionError"
    world.run(0.1)
    assert world.time == pytest.approx(0.1)


@pytest.mark.parametrize("when", _PLACES)
def test_strict_ends_with_the_first_fault(cart, when):
    with cw.World("empty", strict=True) as world:

        def play():
            world.spawn(cart(when)).publish("/command", data=2.0)
            world.run(0.5)
            world.reset()
            world.run(0.5)

        with pytest.raises(CartwheelError) as got:
            play()
        assert got.value.code is running.PLUGIN_FAILED
        assert got.value.values["cause"] == "ZeroDivisionError"
        assert str(got.value.origin).endswith("cart.urdf:10")
        shown = "".join(traceback.format_exception(got.value))
        assert 'raise ZeroDivisionError(f"in {place}")' in shown  # the line of the plugin


@pytest.mark.wording
def test_strict_is_named_as_the_reason_of_the_end(cart):
    with cw.World("empty", strict=True) as world, pytest.raises(CartwheelError) as got:
        world.spawn(cart("configure"))
    assert "strict=True" in got.value.hint


def test_what_a_callback_raises_comes_out_of_run_and_time_goes_on(make):
    world = make.world()
    times = []

    def fail(message):
        times.append(message.clock.nanosec)
        raise KeyError("mine")

    world.subscribe("/clock", fail)
    other = world.mailbox("/clock")
    for count in range(1, 4):
        with pytest.raises(KeyError, match="mine"):
            world.run(1.0)
        assert len(times) == count
    # Each run made the step at which it failed, so that no time came twice.
    assert times == [0, 10_000_000, 20_000_000]
    assert len(other.drain()) == 3
    assert world.time == pytest.approx(0.025)


def test_a_failed_assertion_of_a_test_comes_out_of_run(make):
    world = make.world()
    world.subscribe("/clock", lambda _: pytest.fail("no clock was expected"))
    with pytest.raises(pytest.fail.Exception, match="no clock was expected"):
        world.run(1.0)
    assert world.time > 0


def test_what_a_subscriber_raises_is_not_blamed_on_the_publisher(make, cart):
    world = make.world()
    robot = world.spawn(cart("never"))
    world.graph.subscribe("/joint_states", lambda _: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        world.run(0.5)
    assert not [each for each in world.diagnostics if each.severity == "error"]
    states = world.mailbox("/joint_states")
    with pytest.raises(ZeroDivisionError):
        robot._world.run(0.5)
    assert len(states.drain()) == 1


def test_what_was_posted_and_fails_comes_out_of_run(make):
    world = make.world()
    world.session.simulation.post(lambda: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        world.run(0.5)
    world.run(0.5)
    assert world.time == pytest.approx(0.5, abs=0.011)


def test_a_tolerant_run_reports_subscribers_and_commands_once():
    session = Session(WorldDescription(name="test"))
    session.simulation.faults.tolerant = True
    session.graph.subscribe("/clock", lambda _: 1 / 0, node="somebody")
    for _ in range(3):
        session.simulation.post(lambda: {}[1])
    session.pacer(until_ns=100_000_000).run()
    assert session.simulation.time_ns == 100_000_000
    assert all(each.code is world_codes.CALLBACK_FAILED for each in session.diagnostics)
    causes = [each.values["cause"] for each in session.diagnostics]
    assert causes == ["KeyError", "ZeroDivisionError"]
    session.close()


def test_a_task_of_the_world_that_fails_is_ended(make):
    world = make.world()
    make.expects_faults = True
    calls = []

    def look():
        calls.append(world.time)
        raise OSError("no")

    world.session.simulation.schedule(100, before=look)
    world.run(0.2)
    assert len(calls) == 1
    assert world.time == pytest.approx(0.2)
    assert coded(world, world_codes.CALLBACK_FAILED, cause="OSError")


class _Half(Plugin[FaultyParameters]):
    """Names itself wrongly."""

    filenames = "libhalf.so"
    parameters = FaultyParameters


@pytest.mark.parametrize(
    "entry",
    [
        _Entry("broken", None, ImportError("no module named nothing")),
        _Entry("broken", None, SystemExit(3)),
        _Entry("broken", None, AttributeError("no Plugin in it")),
        _Entry("broken", "no class at all"),
        _Entry("broken", dict),
        _Entry("broken", _Half),
    ],
    ids=["import", "exit", "attribute", "text", "class", "names"],
)
def test_a_broken_package_fails_only_who_names_it(make, cart, installed, rosbots, entry):
    installed(entry)
    world = make.world()
    world.spawn(rosbots)
    world.spawn(cart("never"), x=3)
    world.run(0.1)
    assert not [each for each in world.diagnostics if each.severity != "info"]
    named = cart("never")
    plugins = tuple(
        dataclasses.replace(each, filename=each.filename.replace("libfaulty", "libbroken"))
        for each in named.plugins
    )
    world.spawn(dataclasses.replace(named, name="third", plugins=plugins), x=6)
    (found,) = [each for each in world.diagnostics if each.severity == "warning"]
    assert found.code is devices.PLUGIN_UNKNOWN
    assert found.values["name"] == "libbroken.so"
    assert len(found.values["broken"]) == 1
    assert "broken:Plugin" in found.values["broken"][0]


_PACKAGE = """
from cartwheel.plugin import NoTags, Plugin

class Faulty(Plugin[NoTags]):
    filenames = ("libfaulty.so",)

    def configure(self):
        self.part.schedule(10, after=self._fail)

    def _fail(self):
        raise ZeroDivisionError("mine")
"""


@pytest.mark.parametrize("strict", [False, True])
def test_cartwheel_run_goes_on_without_a_faulty_plugin(tmp_path, strict):
    (tmp_path / "my_faulty.py").write_text(_PACKAGE)
    info = tmp_path / "my_faulty-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: my-faulty\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[cartwheel.plugins]\nfaulty = my_faulty:Faulty\n")
    robot = tmp_path / "cart.urdf"
    robot.write_text(_ROBOT.replace("<when>{when}</when>", ""))
    run = "import sys; sys.path.insert(0, sys.argv.pop(1))\n"
    run += "from cartwheel.cli.main import main; main()"
    options = ["--headless", "--for", "1", "--speed", "max", "--verbose"]
    done = launching.run(
        [sys.executable, "-c", run, str(tmp_path), "run", str(robot), *options]
        + ["--strict"] * strict,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert "[CW509 plugin-failed]" in done.stderr
    assert "ZeroDivisionError: mine" in done.stderr
    assert f"[{INTERNAL_FAULT}]" not in done.stderr
    if strict:
        assert done.returncode == 2
    else:
        assert (done.returncode, "simulated 1.000 s" in done.stdout) == (0, True)
        assert "in _fail" in done.stderr
