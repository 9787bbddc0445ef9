"""Tracks: a vehicle drives and turns on them, and a belt carries a box."""

import math

import pytest
from tests.coded import coded, raises

from cartwheel.codes import devices, running
from cartwheel.description import load_text
from cartwheel.errors import PluginError, UnknownNameError

LENGTH, WIDTH, HEIGHT, SEPARATION = 0.8, 0.08, 0.2, 0.5
"""m: of a track, and between the tracks."""
CONTROLLER = (
    '<plugin name="{link}" filename="gz-sim-track-controller-system"><link>{link}</link>{tags}'
    "</plugin>"
)
VEHICLE = (
    '<plugin name="vehicle" filename="{file}"><body_link>base</body_link>'
    "<left_track><link>left</link></left_track><right_track><link>right</link></right_track>"
    "<tracks_separation>{separation}</tracks_separation>{tags}</plugin>"
)
EFFICIENCY = SEPARATION / 2 / math.hypot(SEPARATION / 2, LENGTH / 2)
"""With it, the corners of the tracks, on which the vehicle stands, move at the commanded rate."""


def inertial(mass, size):
    x, y, z = size
    i, j, k = (mass / 12 * (a * a + b * b) for a, b in ((y, z), (x, z), (x, y)))
    return (
        f"<inertial><mass>{mass}</mass><inertia><ixx>{i}</ixx><iyy>{j}</iyy><izz>{k}</izz>"
        "</inertia></inertial>"
    )


def link(name, mass, size, *, place="0 0 0 0 0 0", collides=True, shapes=""):
    box = f"<geometry><box><size>{' '.join(map(str, size))}</size></box></geometry>"
    shapes = shapes or (f'<collision name="c">{box}</collision>' if collides else "")
    return f'<link name="{name}"><pose>{place}</pose>{inertial(mass, size)}{shapes}</link>'


def wheels():
    """A track that only touches the ground with a round end at each side."""
    return "".join(
        f'<collision name="w{x}"><pose>{x} 0 0 1.5707963 0 0</pose><geometry><cylinder>'
        f"<radius>{HEIGHT / 2}</radius><length>{WIDTH}</length></cylinder></geometry></collision>"
        for x in (-LENGTH / 2, LENGTH / 2)
    )


def vehicle(*, tags="", track_tags="", shapes="", file="gz-sim-tracked-vehicle-system", tracks=2):
    size = (LENGTH, WIDTH, HEIGHT)
    parts = link("base", 10, (0.4, 0.3, 0.1), collides=False)
    for name, side in (("left", 1), ("right", -1)):
        place = f"0 {side * SEPARATION / 2} 0 0 0 0"
        parts += link(name, 3, size, place=place, shapes=shapes)
        parts += (
            f'<joint name="{name}_j" type="fixed"><parent>base</parent><child>{name}</child>'
            "</joint>"
        )
    for name in ("left", "right")[:tracks]:
        parts += CONTROLLER.format(link=name, tags=track_tags)
    parts += VEHICLE.format(file=file, separation=SEPARATION, tags=tags)
    return f'<sdf version="1.9"><model name="crawler">{parts}</model></sdf>'


class Crawler:
    def __init__(self, make, **given):
        self.world = make.world()
        self.model = self.world.spawn(load_text(vehicle(**given), file="c.sdf"), z=HEIGHT / 2)
        self.world.run(0.3)

    def send(self, forward=0.0, turn=0.0):
        self.world.publish("/model/crawler/cmd_vel", linear_x=forward, angular_z=turn)

    def moved(self, seconds):
        """The distance along the first heading, to its left, and the rotation."""
        before = self.model.pose
        self.world.run(seconds)
        after = self.model.pose
        x, y = after.x - before.x, after.y - before.y
        c, s = math.cos(before.yaw), math.sin(before.yaw)
        turn = math.remainder(after.yaw - before.yaw, 2 * math.pi)
        return c * x + s * y, c * y - s * x, turn


@pytest.mark.parametrize("shapes", ["", wheels()], ids=["boxes", "round ends"])
@pytest.mark.parametrize("speed", [0.4, -0.4])
def test_it_drives_straight(make, speed, shapes):
    made = Crawler(make, shapes=shapes)
    made.send(speed)
    made.world.run(0.5)
    x, y, turn = made.moved(2.0)
    assert x == pytest.approx(2 * speed, rel=0.05)
    assert y == pytest.approx(0.0, abs=0.01)
    assert turn == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize("shapes", ["", wheels()], ids=["boxes", "round ends"])
@pytest.mark.parametrize("rate", [0.5, -0.5])
def test_it_turns_in_place(make, rate, shapes):
    made = Crawler(
        make, tags=f"<steering_efficiency>{EFFICIENCY}</steering_efficiency>", shapes=shapes
    )
    made.send(turn=rate)
    made.world.run(0.5)
    x, y, turn = made.moved(2.0)
    assert turn == pytest.approx(2 * rate, rel=0.05)
    assert math.hypot(x, y) < 0.03


def test_it_follows_a_curve(make):
    """Both tracks move on circles about one point: at their ends, they have the stated speeds."""
    forward, rate = 0.4, 0.3
    radius, half = forward / rate, SEPARATION / 2
    made = Crawler(make, tags="<steering_efficiency>1.0</steering_efficiency>")

    def drive(seconds):
        turned = 0.0
        for _ in range(round(seconds * 10)):
            made.send(forward, rate)
            turned += made.moved(0.1)[2]
        return turned

    drive(0.5)
    begin = made.model.pose
    turned = drive(2.0)
    end = made.model.pose
    expected = [
        (forward + side * rate * half) / math.hypot(radius + side * half, LENGTH / 2)
        for side in (-1, 1)
    ]
    assert expected[0] == pytest.approx(expected[1], rel=0.05)
    assert turned == pytest.approx(2.0 * sum(expected) / 2, rel=0.05)
    chord = math.hypot(end.x - begin.x, end.y - begin.y)
    assert chord == pytest.approx(2 * radius * math.sin(turned / 2), rel=0.05)


def test_a_lower_efficiency_turns_faster(make):
    rates = {}
    for efficiency in (0.9, 0.45):
        made = Crawler(make)
        made.world.publish("/model/crawler/steering_efficiency", data=efficiency)
        made.send(turn=0.4)
        made.world.run(0.5)
        rates[efficiency] = made.moved(1.0)[2]
    assert rates[0.45] == pytest.approx(2 * rates[0.9], rel=0.1)


def test_it_climbs_a_step(make):
    """The front of the tracks pulls up on the edge of a step of a third of their height."""
    box = f"<geometry><box><size>{LENGTH} {WIDTH} {HEIGHT}</size></box></geometry>"
    made = Crawler(make, shapes=f'{wheels()}<collision name="middle">{box}</collision>')
    step = link("step", 1000, (1.0, 2.0, 0.06))
    made.world.spawn(
        load_text(
            f'<sdf version="1.9"><model name="step"><static>true</static>{step}</model></sdf>',
            file="s.sdf",
        ),
        x=1.2,
        z=0.03,
    )
    made.send(0.3)
    made.world.run(8.0)
    assert made.model.pose.z == pytest.approx(HEIGHT / 2 + 0.06, abs=0.01)
    assert made.model.pose.x == pytest.approx(1.2, abs=0.4)


def test_odometry_and_transform_are_published(make):
    made = Crawler(make, tags="<steering_efficiency>0.5</steering_efficiency>")
    box, frames = (
        made.world.mailbox(f"/model/crawler/{name}", size=1000) for name in ("odometry", "tf")
    )
    made.send(0.4, 0.2)
    made.world.run(1.0)
    reported = box.drain()
    assert len(reported) == len(frames.drain()) == pytest.approx(50, abs=1)
    twist = reported[-1].twist.twist
    assert twist.linear.x == pytest.approx(0.4)
    # As in gz-sim: the rate of wheels that move like the tracks.
    assert twist.angular.z == pytest.approx(0.4)
    assert reported[-1].header.frame_id == "crawler/odom"
    assert reported[-1].child_frame_id == "crawler/base"


def test_a_track_publishes_its_distance(make):
    made = Crawler(make, track_tags="<odometry_publish_frequency>20</odometry_publish_frequency>")
    box = made.world.mailbox("/model/crawler/link/left/odometry", size=1000)
    made.send(0.4)
    made.world.run(1.0)
    reported = box.drain()
    assert len(reported) == 20
    assert reported[-1].twist.twist.linear.x == pytest.approx(0.4)
    assert reported[-1].pose.pose.position.x == pytest.approx(0.4, abs=0.03)


def test_limits_bind(make):
    tags = (
        "<linear_velocity><max_velocity>0.2</max_velocity></linear_velocity><angular_velocity>"
        "<max_acceleration>0.1</max_acceleration></angular_velocity>"
    )
    made = Crawler(make, tags=tags)
    box = made.world.mailbox("/model/crawler/odometry", size=1000)
    made.send(1.0, 1.0)
    made.world.run(1.0)
    twist = box.drain()[-1].twist.twist
    assert twist.linear.x == pytest.approx(0.2)
    assert twist.angular.z == pytest.approx(0.1 / 0.5, rel=0.05)


def test_a_track_stops_when_its_command_is_old(make):
    made = Crawler(make, track_tags="<max_command_age>0.3</max_command_age>")
    made.send(0.4)
    made.world.run(1.0)
    assert made.moved(0.5)[0] == pytest.approx(0.0, abs=0.005)


def test_a_reset_stops_it(make):
    made = Crawler(make)
    made.send(0.4)
    made.world.run(0.5)
    made.world.reset()
    made.world.run(0.3)
    assert made.moved(0.5)[0] == pytest.approx(0.0, abs=0.005)


def test_a_saved_state_continues_bit_for_bit(make):
    """Also the motion of the surfaces, which the next step uses."""
    made = Crawler(make)
    made.send(0.3, 0.4)
    made.world.run(0.5)
    state = made.world.save()

    def end():
        made.world.run(1.0)
        return made.world.session.simulation.data.qpos.tobytes()

    first = end()
    made.send(-0.3)
    made.world.run(0.5)
    made.world.restore(state)
    assert end() == first


BELT = link("belt", 100, (4.0, 0.5, 0.2))


def conveyor(make, *, static=True, tags="", friction=1.0):
    world = make.world()
    fixed = f"<static>{str(static).lower()}</static>"
    text = (
        f'<model name="conveyor">{fixed}{BELT}{CONTROLLER.format(link="belt", tags=tags)}</model>'
    )
    world.spawn(load_text(f'<sdf version="1.9">{text}</sdf>', file="b.sdf"), z=0.1)
    surface = (
        f"<surface><friction><ode><mu>{friction}</mu><mu2>{friction}</mu2></ode></friction>"
        "</surface></collision>"
    )
    box = link("box", 1, (0.2, 0.2, 0.2)).replace("</collision>", surface)
    model = world.spawn(
        load_text(f'<sdf version="1.9"><model name="box">{box}</model></sdf>', file="b.sdf"), z=0.3
    )
    world.run(2.0)
    return world, model


@pytest.mark.parametrize(
    ("tags", "direction"),
    [
        ("", (1.0, 0.0)),
        ("<track_orientation>0 0 1.5707963</track_orientation>", (0.0, 1.0)),
    ],
)
def test_a_belt_carries_what_lies_on_it(make, tags, direction):
    """Also a box that has come to rest, and only while the belt moves."""
    world, box = conveyor(make, tags=tags)
    world.publish("/model/conveyor/link/belt/track_cmd_vel", data=0.1)
    world.run(0.5)
    before = box.pose
    world.run(2.0)
    after = box.pose
    moved = (after.x - before.x, after.y - before.y)
    assert moved == pytest.approx((0.2 * direction[0], 0.2 * direction[1]), abs=0.01)
    world.publish("/model/conveyor/link/belt/track_cmd_vel", data=0.0)
    world.run(0.5)
    before = box.pose
    world.run(1.0)
    assert box.pose.x - before.x == pytest.approx(0.0, abs=0.002)


@pytest.mark.parametrize("speed", [0.8, -0.8])
@pytest.mark.parametrize("friction", [0.2, 1.0])
def test_a_belt_that_starts_at_once_accelerates_a_box_by_friction(make, friction, speed):
    """The box slides at first, and hops: when it lands, the belt still moves in its direction."""
    world, box = conveyor(make, friction=friction)
    rate = 9.8 * friction
    slides = abs(speed) / rate
    begin = box.pose.x
    world.publish("/model/conveyor/link/belt/track_cmd_vel", data=speed)
    world.run(slides / 2)
    assert box.velocity.linear[0] == pytest.approx(speed / 2, rel=0.15)
    world.run(1.0 - slides / 2)
    assert box.velocity.linear[0] == pytest.approx(speed, rel=0.01)
    way = math.copysign(abs(speed) - speed**2 / (2 * rate), speed)
    assert box.pose.x - begin == pytest.approx(way, rel=0.05)


def test_old_names_are_understood(make):
    made = Crawler(make, file="libignition-gazebo-tracked-vehicle-system.so")
    made.send(0.4)
    made.world.run(0.5)
    assert made.moved(1.0)[0] == pytest.approx(0.4, rel=0.05)


def test_a_track_without_a_controller_is_reported(make):
    made = Crawler(make, tracks=1)
    (reported,) = coded(made.world, devices.PLUGIN_IDLE)
    assert reported.values["link"] == "right"


@pytest.mark.parametrize(
    ("given", "code", "name"),
    [
        (
            {"track_tags": "<min_velocity>1</min_velocity><max_velocity>0</max_velocity>"},
            devices.PLUGIN_RANGE_REVERSED,
            "min_velocity",
        ),
        (
            {"tags": "<steering_efficiency>0</steering_efficiency>"},
            devices.PLUGIN_PARAMETER_INVALID,
            "steering_efficiency",
        ),
        (
            {"tags": "<linear_velocity><min_velocity>1</min_velocity><max_velocity>0</max_velocity>"
             "</linear_velocity>"},
            devices.PLUGIN_RANGE_REVERSED,
            "linear_velocity/min_velocity",
        ),
    ],
)  # fmt: skip
def test_bad_parameters_are_reported(make, given, code, name):
    with raises(code, PluginError, parameter=name):
        Crawler(make, **given)


def test_jerk_limits_are_reported(make):
    made = Crawler(make, track_tags="<max_jerk>1</max_jerk>")
    assert {
        each.values["parameter"] for each in coded(made.world, devices.PLUGIN_PARAMETER_IGNORED)
    } == {"max_jerk"}


def test_a_track_needs_a_link(make):
    with raises(devices.PLUGIN_PARAMETER_MISSING, PluginError):
        Crawler(make, tags="<left_track><velocity_topic>/x</velocity_topic></left_track>")


def test_a_link_that_does_not_exist_is_reported(make):
    world = make.world()
    text = f'<model name="m">{BELT}{CONTROLLER.format(link="missing", tags="")}</model>'
    with raises(running.UNKNOWN_LINK, UnknownNameError, name="missing"):
        world.spawn(load_text(f'<sdf version="1.9">{text}</sdf>', file="b.sdf"))
