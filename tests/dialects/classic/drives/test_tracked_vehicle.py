"""Vehicles of Gazebo Classic on tracks: links with a moving surface, and rows of wheels."""

import math

import pytest
from tests.coded import coded, raises

from cartwheel.codes import devices, running
from cartwheel.description import load_text
from cartwheel.errors import PluginError, UnknownNameError

LENGTH, WIDTH, HEIGHT, SEPARATION = 0.8, 0.08, 0.2, 0.5
"""m: of a track, and between the tracks."""
SIDES = (("left", 1), ("right", -1))
TOPIC = "/crawler/cmd_vel"
CORNERS = [(LENGTH / 2, SEPARATION / 2 + side * WIDTH / 2) for side in (1, -1)]


def link(name, mass, size, *, place="0 0 0 0 0 0", shape="", surface=""):
    x, y, z = size
    i, j, k = (mass / 12 * (a * a + b * b) for a, b in ((y, z), (x, z), (x, y)))
    collision = f'<collision name="c"><geometry>{shape}</geometry>{surface}</collision>'
    collision = collision if shape else ""
    return (
        f'<link name="{name}"><pose>{place}</pose><inertial><mass>{mass}</mass><inertia><ixx>{i}'
        f"</ixx><iyy>{j}</iyy><izz>{k}</izz></inertia></inertial>{collision}</link>"
    )


def joint(name, child, kind, axis=""):
    return (
        f'<joint name="{name}" type="{kind}"><parent>base</parent><child>{child}</child>{axis}'
        "</joint>"
    )


def model(parts, file, tags):
    parts = link("base", 10, (0.4, 0.3, 0.1)) + parts
    tags += f"<tracks_separation>{SEPARATION}</tracks_separation>"
    plugin = f'<plugin name="tracks" filename="{file}">{tags}</plugin>'
    return f'<sdf version="1.6"><model name="crawler">{parts}{plugin}</model></sdf>'


def crawler(tags="", *, surface="", names="left right", sides=SIDES):
    """A vehicle whose tracks are boxes; `names` are those in the plugin."""
    size = (LENGTH, WIDTH, HEIGHT)
    shape = f"<box><size>{LENGTH} {WIDTH} {HEIGHT}</size></box>"
    parts = ""
    for name, side in sides:
        place = f"0 {side * SEPARATION / 2} 0 0 0 0"
        parts += link(name, 3, size, place=place, shape=shape, surface=surface)
        parts += joint(f"{name}_j", name, "fixed")
    left, right = names.split()
    tags += f"<body>base</body><left_track>{left}</left_track><right_track>{right}</right_track>"
    return model(parts, "libSimpleTrackedVehiclePlugin.so", tags)


def wheeled(tags="", *, shape=f"<cylinder><radius>{HEIGHT / 2}</radius><length>0.08</length>"):
    """A vehicle with three wheels on each side."""
    parts, joints = "", ""
    for name, side in SIDES:
        for number, x in enumerate((-0.3, 0.0, 0.3)):
            wheel = f"{name}{number}"
            place = f"{x} {side * SEPARATION / 2} 0 {math.pi / 2} 0 0"
            parts += link(
                wheel, 1, (0.2, 0.2, 0.1), place=place, shape=f"{shape}{_end(shape)}"
            ) + joint(f"{wheel}_j", wheel, "revolute", "<axis><xyz>0 0 -1</xyz></axis>")
            joints += f"<{name}_joint>{wheel}_j</{name}_joint>"
    return model(parts, "libWheelTrackedVehiclePlugin.so", joints + tags)


def _end(shape):
    return f"</{shape[1:].partition('>')[0]}>"


class Vehicle:
    def __init__(self, make, text, topic=TOPIC):
        self.world = make.world()
        self.model = self.world.spawn(load_text(text, file="c.sdf"), z=HEIGHT / 2)
        self.topic = topic
        self.world.run(0.3)

    def driven(self, forward=0.0, turn=0.0, seconds=1.0):
        """The velocity and the yaw rate that a command results in."""
        self.world.publish(self.topic, linear_x=forward, angular_z=turn)
        self.world.run(0.5)
        before = self.model.pose
        self.world.run(seconds)
        after = self.model.pose
        x, y = after.x - before.x, after.y - before.y
        middle = (before.yaw + after.yaw) / 2
        ahead = math.cos(middle) * x + math.sin(middle) * y
        return ahead / seconds, math.remainder(after.yaw - before.yaw, 2 * math.pi) / seconds


TEXTS = {"surfaces": crawler, "wheels": wheeled}


@pytest.mark.parametrize("kind", TEXTS)
@pytest.mark.parametrize(("speed", "reached"), [(0.5, 0.5), (-0.5, -0.5), (3.0, 1.0)])
def test_it_drives_straight_within_its_limit(make, kind, speed, reached):
    made = Vehicle(make, TEXTS[kind]())
    forward, turn = made.driven(speed)
    assert forward == pytest.approx(reached, rel=0.01)
    assert turn == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize("rate", [0.5, -0.5])
@pytest.mark.parametrize("efficiency", [0.4, 0.8])
def test_a_positive_rate_turns_it_to_the_left_as_fast_as_its_tracks_allow(make, rate, efficiency):
    """Each point has the track's velocity across its distance from the centre of the turn."""
    made = Vehicle(make, crawler(f"<steering_efficiency>{efficiency}</steering_efficiency>"))
    forward, turn = made.driven(turn=rate)
    across = sum(y for _, y in CORNERS) / sum(x * x + y * y for x, y in CORNERS)
    assert turn == pytest.approx(rate * SEPARATION / 2 / efficiency * across, rel=0.02)
    assert forward == pytest.approx(0.0, abs=0.01)


def test_wheels_turn_it_to_the_left(make):
    rates = []
    for efficiency in (1.0, 0.5):
        made = Vehicle(make, wheeled(f"<steering_efficiency>{efficiency}</steering_efficiency>"))
        rates.append(made.driven(turn=0.4)[1])
    assert rates[0] > 0.15
    assert rates[1] == pytest.approx(2 * rates[0], rel=0.1)


def test_wheels_of_other_shapes_have_half_their_longest_edge(make):
    made = Vehicle(make, wheeled(shape=f"<sphere><radius>{HEIGHT / 2}</radius>"))
    assert made.driven(0.4)[0] == pytest.approx(0.4, rel=0.01)


def test_a_wheel_without_an_opposite_one_is_driven_once(make):
    text = wheeled().replace("<right_joint>right1_j</right_joint>", "")
    made = Vehicle(make, text)
    assert made.driven(0.4)[0] == pytest.approx(0.4, rel=0.01)
    assert not coded(made.world, running.JOINT_DRIVEN_TWICE)


def test_a_slow_turn_is_none(make):
    """Below 0.1 rad/s, the tracks drive ahead with their two speeds, and only slip turns it."""
    made = Vehicle(make, crawler())
    forward, turn = made.driven(0.4, 0.05)
    assert forward == pytest.approx(0.4, rel=0.02)
    assert 0.0 < turn < 0.1


def test_a_slow_vehicle_turns_in_place(make):
    forward, turn = Vehicle(make, crawler()).driven(0.05, 0.5)
    assert turn > 0.2
    assert abs(forward) < 0.03


FRICTION = (
    "<surface><friction><ode><mu>0.05</mu><mu2>0.05</mu2><fdir1>0 1 0</fdir1></ode></friction>"
    "</surface>"
)


@pytest.mark.parametrize("mu", [None, 2.0])
def test_the_friction_of_the_tracks_replaces_that_of_the_description(make, mu):
    """With a coefficient of 0.05, a box of 5 kg holds the vehicle up."""
    tags = "" if mu is None else f"<track_mu>{mu}</track_mu><track_mu2>0.5</track_mu2>"
    made = Vehicle(make, crawler(tags, surface=FRICTION))
    box = link("l", 5, (0.4, 0.8, 0.4), shape="<box><size>0.4 0.8 0.4</size></box>")
    made.world.spawn(
        load_text(f'<sdf version="1.6"><model name="box">{box}</model></sdf>', file="b.sdf"),
        x=0.7,
        z=0.2,
    )
    forward, _ = made.driven(0.3, seconds=2.0)
    assert (forward > 0.25) == (mu is not None)


def test_flippers_are_tracks(make):
    """A vehicle that stands on its flippers."""
    sides = (*SIDES, ("left_flipper", 1), ("right_flipper", -1))
    text = crawler(
        "<left_flipper>left</left_flipper><right_flipper>right</right_flipper>",
        sides=sides,
        names="left_flipper right_flipper",
    )
    assert Vehicle(make, text).driven(0.4)[0] == pytest.approx(0.4, rel=0.01)


@pytest.mark.parametrize(
    ("namespace", "topic"), [("tank", "/tank/cmd_vel"), ("/a/b", "/a/b/cmd_vel")]
)
def test_its_topic_is_in_its_namespace(make, namespace, topic):
    text = crawler(f"<robot_namespace>{namespace}</robot_namespace>")
    assert Vehicle(make, text, topic).driven(0.4)[0] == pytest.approx(0.4, rel=0.01)


def test_after_a_reset_it_stands(make):
    made = Vehicle(make, crawler())
    made.driven(0.4)
    made.world.reset()
    made.world.run(1.0)
    assert made.model.pose.x == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("missing", ["body", "left_track", "right_track"])
def test_what_it_requires(make, missing):
    text = crawler().replace(f"<{missing}>", "<other>").replace(f"</{missing}>", "</other>")
    with raises(devices.PLUGIN_PARAMETER_MISSING, PluginError, parameter=missing):
        make.world().spawn(load_text(text, file="c.sdf"))


def test_a_row_of_wheels_on_one_side_only_is_refused(make):
    text = wheeled().replace("left_joint>", "other>")
    with raises(devices.PLUGIN_PARAMETER_MISSING, PluginError, parameter="left_joint"):
        make.world().spawn(load_text(text, file="c.sdf"))


@pytest.mark.parametrize("names", ["nothing right", "left nothing"])
def test_an_unknown_track_is_named(make, names):
    with pytest.raises(UnknownNameError, match='link "nothing"'):
        make.world().spawn(load_text(crawler(names=names), file="c.sdf"))
