"""Messages that other messages trigger."""

import contextlib

import pytest
from tests.coded import coded

from cartwheel import World
from cartwheel.codes import devices, graph, running
from cartwheel.dialects.gz.messages.text_format import TextFormatError, parse_text_format

KEYS = """<plugin name="t" filename="gz-sim-triggered-publisher-system">
  <input type="gz.msgs.Int32" topic="/keyboard/keypress">
  <match field="data">16777235</match></input>
  <output type="gz.msgs.Twist" topic="/cmd_vel">linear: {x: 0.5}, angular: {z: 0.05}</output>
</plugin>"""


@pytest.fixture
def triggered(make):
    """A simulation with a plugin, and the messages of a topic with their times in s."""

    def make_it(plugin=KEYS, topic="/cmd_vel", *, in_world=False):
        if in_world:
            text = f'<sdf version="1.9"><world name="w">{plugin}</world></sdf>'
            world = started.enter_context(World(text))
        else:
            world = make.world()
            world.session.spawn(make.sdf(f'<model name="m"><link name="l"/>{plugin}</model>'))
        got = []
        simulation = world.session.simulation
        world.graph.subscribe(topic, lambda m: got.append((simulation.time_ns * 1e-9, m)))
        return world, got

    with contextlib.ExitStack() as started:
        yield make_it


def test_a_key_drives_and_another_does_not(triggered):
    world, got = triggered()
    world.publish("/keyboard/keypress", {"data": 1})
    world.run(0.1)
    assert not got
    world.publish("/keyboard/keypress", {"data": 16777235})
    world.run(0.1)
    ((_, twist),) = got
    assert (twist.linear.x, twist.linear.y, twist.angular.z) == (0.5, 0.0, 0.05)


@pytest.mark.parametrize(
    ("matches", "values"),
    [
        ("", [1.0, 2.0, 3.0]),
        ('<match field="linear.x">2</match>', [2.0]),
        ('<match field="linear.x" tol="1.1">2</match>', [1.0, 2.0, 3.0]),
        ('<match field="linear.x" logic_type="negative">2</match>', [1.0, 3.0]),
        ('<match field="linear">x: 3</match>', [3.0]),
        ("<match>linear {x: 1}</match>", [1.0]),
        ('<match field="linear.x">2</match><match field="linear.y">1</match>', []),
    ],
)
def test_matches(triggered, matches, values):
    plugin = KEYS[: KEYS.index("<input")] + (
        f'<input type="ignition.msgs.Twist" topic="in">{matches}</input>'
        '<output type="gz.msgs.Empty" topic="out"/></plugin>'
    )
    world, got = triggered(plugin, "/out")
    matched = []
    for value in (1.0, 2.0, 3.0):
        before = len(got)
        world.publish("/in", {"linear": {"x": value}})
        world.run(0.02)
        if len(got) > before:
            matched.append(value)
    assert matched == values


def test_a_value_is_contained_in_a_repeated_field(triggered):
    plugin = (
        KEYS[: KEYS.index("<input")]
        + """<input type="gz.msgs.Actuators" topic="in"><match field="velocity">2</match>
        <match field="velocity">3</match></input><output type="gz.msgs.Double" topic="out">data: 7
        </output></plugin>"""
    )
    world, got = triggered(plugin, "/out")
    for velocity in ([1.0, 2.0], [3.0, 1.0, 2.0]):
        world.publish("/in", {"velocity": velocity})
        world.run(0.02)
    ((_, message),) = got
    assert message.data == 7.0


def test_a_delay_in_simulation_time(triggered):
    delayed = KEYS.replace("</plugin>", "<delay_ms>300</delay_ms></plugin>")
    world, got = triggered(delayed)
    world.publish("/keyboard/keypress", {"data": 16777235})
    world.run(0.2)
    assert not got
    world.run(0.2)
    ((when, _),) = got
    assert when == pytest.approx(0.3, abs=0.011)


def test_it_may_be_in_a_world(triggered):
    world, got = triggered(in_world=True)
    world.publish("/keyboard/keypress", {"data": 16777235})
    world.run(0.1)
    assert len(got) == 1


@pytest.mark.parametrize(
    ("old", "new", "code"),
    [
        ("linear: {x: 0.5}", "linear: {x: fast}", devices.PLUGIN_PARAMETER_INVALID),
        ("linear: {x: 0.5}", "linear: {x", devices.PLUGIN_PARAMETER_INVALID),
        ('field="data"', 'field="dato"', devices.PLUGIN_PARAMETER_INVALID),
        ("gz.msgs.Twist", "gz.msgs.Odd", devices.PLUGIN_PARAMETER_INVALID),
        (' topic="/cmd_vel"', "", devices.PLUGIN_PARAMETER_MISSING),
    ],
)
def test_what_does_not_fit_is_reported(old, new, code):
    plugin = KEYS.replace(old, new)
    assert plugin != KEYS
    with World(f'<sdf version="1.9"><world name="w">{plugin}</world></sdf>') as world:
        (reported,) = coded(world, running.PLUGIN_LEFT_OUT)
    assert reported.values["cause"] == code.number


@pytest.mark.parametrize(
    ("text", "fields"),
    [
        ("", {}),
        ("data: true # a comment\n", {"data": True}),
        ("a: -1.5e3, b: 'x\\'y' \"z\"; c: 0x10", {"a": -1500.0, "b": "x'yz", "c": 16}),
        ("a { b: 1 b: 2 } c < d: [3, 4] d: 5 >", {"a": {"b": [1, 2]}, "c": {"d": [3, 4, 5]}}),
        ("kind: LINK x: 2f", {"kind": "LINK", "x": 2}),
    ],
)
def test_text_format(text, fields):
    assert parse_text_format(text) == fields


@pytest.mark.parametrize("text", ["a", "a: ", "a: {b: 1", "a: [1, 2", "1: 2", "a { " * 99, "a: }"])
def test_a_text_that_is_not_a_message(text):
    with pytest.raises(TextFormatError):
        parse_text_format(text)


def test_a_message_that_triggers_itself_is_published_once_in_each_step(triggered):
    """Of a stranger's file; otherwise, the simulation would stand still for ever."""
    loop = '<input type="gz.msgs.Empty" topic="/a"/><output type="gz.msgs.Empty" topic="/a"/>'
    world, got = triggered(KEYS[: KEYS.index("<input")] + loop + "</plugin>", "/a")
    world.publish("/a")
    world.step(20)
    times = [time for time, _ in got]
    assert 20 <= len(times) <= 22
    assert len(set(times[1:])) == len(times) - 1


def test_triggers_that_multiply_are_bounded_and_reported(triggered):
    """Two outputs that are the input double the messages of each step."""
    loop = '<input type="gz.msgs.Empty" topic="/a"/>' + 2 * (
        '<output type="gz.msgs.Empty" topic="/a"/>'
    )
    world, got = triggered(KEYS[: KEYS.index("<input")] + loop + "</plugin>", "/a")
    world.publish("/a")
    world.step(14)
    last = sum(time == got[-1][0] for time, _ in got)
    assert 1000 < last <= 2000
    (report,) = coded(world.session.simulation, graph.DELAYED_LOST)
    assert report.values["topic"] == "/a"


def test_a_subscriber_may_reset_the_world(triggered):
    """The reset clears the triggers that still wait, also those that are due in this step."""
    plugin = '<input type="gz.msgs.Empty" topic="/in"/><output type="gz.msgs.Empty" topic="/out"/>'
    world, got = triggered(KEYS[: KEYS.index("<input")] + plugin + "</plugin>", "/out")
    subscription = world.subscribe("/out", lambda _: world.reset())
    for _ in range(3):
        world.publish("/in")
    world.run(0.1)
    assert len(got) == 1
    assert not coded(world.session.simulation, running.PLUGIN_FAILED)
    subscription.close()
    world.publish("/in")
    world.run(0.1)
    assert len(got) == 2


def test_integers_have_at_most_64_bits():
    assert parse_text_format("a: 0xFFFFFFFFFFFFFFFF b: -5") == {"a": 2**64 - 1, "b": -5}
    assert parse_text_format(f"a: {2**64}") == {"a": 2.0**64}
    assert parse_text_format(f"a: {'9' * 4000}") == {"a": float("inf")}
    with pytest.raises(TextFormatError):
        parse_text_format(f"a: 0x{'f' * 6000}")
