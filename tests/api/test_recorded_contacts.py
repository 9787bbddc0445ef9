"""Contacts over a run, against closed forms."""

import math

import numpy as np
import pytest
from tests.coded import raises

import cartwheel as cw
from cartwheel.codes.world import SIMULATION_CLOSED, UNKNOWN_MODEL
from cartwheel.errors import SimulationError, UnknownNameError

G = 9.8
STEP = 0.005


@pytest.fixture
def world(make):
    return make.world()


def total(record):
    return np.sum([contact.impulse for contact in record], axis=0)


def test_a_box_that_falls(world, make):
    """It touches after √(2 h / g), and all impulses stop it and carry its weight: m g t."""
    box = world.spawn(make.box("box", (0.2, 0.2, 0.2)), z=1.1)
    with world.record_contacts("box") as record:
        assert not record and record.first is None and record.peak_force == 0.0
        world.run(2.0)
        assert record
        first = record.first
        assert first.start == pytest.approx(math.sqrt(2 / G), abs=2 * STEP)
        assert first.models == ("box", "ground_plane") and first.links == ("link", "link")
        assert first.point[2] == pytest.approx(0.0, abs=0.02)
        assert first.peak_force > box.mass * G and first.peak_time >= first.start
        assert record.peak_force == max(each.peak_force for each in record)
        assert record.contacts[-1].end is None
        assert total(record) == pytest.approx([0, 0, box.mass * G * 2.0], abs=0.02)
    seen = record.contacts
    world.run(1.0)
    assert record.contacts == seen


def test_a_touch_between_two_states_that_a_program_reads(world, make):
    """A box hits a wall in the air and falls, after which nothing touches."""
    wall = world.spawn(make.box("wall", (0.2, 4, 2), static=True), x=2.0, z=1.0)
    box = world.spawn(make.box("box", (0.2, 0.2, 0.2)), z=5.0)
    wall.link("link").friction = box.link("link").friction = 0.0
    wall.pose = cw.Pose((2.0, 0.0, 5.0))
    box.velocity = cw.Twist((4.0, 0.0, 0.0))
    with (
        world.record_contacts((box, "wall")) as hits,
        world.record_contacts(("wall", box)) as turned,
        world.record_contacts(ignore=["wall", "ground_plane"]) as others,
    ):
        world.run(0.6)
    assert world.contacts() == ()
    assert not others and len(hits) == len(turned) == 1
    (hit,), (back,) = hits, turned
    assert hit.start == pytest.approx((2.0 - 0.1 - 0.1) / 4.0, abs=2 * STEP)
    assert hit.end is not None and hit.end > hit.start
    assert hit.impulse[0] == pytest.approx(box.mass * (box.velocity.linear[0] - 4.0), rel=1e-3)
    assert back.models == ("wall", "box")
    assert back.impulse == pytest.approx([-each for each in hit.impulse])


def test_a_record_is_a_condition(world, make, rosbots):
    world.spawn(make.box("post", (0.2, 0.2, 1.0), static=True), x=2.0, z=0.5)
    cart = world.spawn(rosbots, name="cart", z=0.05)
    cart.publish("/part2_cmr/cmd_vel", linear_x=0.5)
    with world.record_contacts((cart.link("base_link"), "post")) as record:
        world.run_until(lambda: record, timeout=10)
    assert record.first.start == pytest.approx(world.time)
    assert {each.links for each in record} == {("base_link", "link")}


def test_a_body_that_sleeps_still_touches(world, make):
    box = world.spawn(make.box("box", (0.2, 0.2, 0.2)), z=0.1)
    world.run(5.0)
    assert (world.session.simulation.engine.data.tree_asleep >= 0).any()
    with world.record_contacts(box) as record:
        world.run(1.0)
        (contact,) = record
        assert contact.end is None
        assert contact.impulse[2] == pytest.approx(box.mass * G, rel=1e-3)


def test_a_record_continues_after_time_was_set(world, make):
    box = world.spawn(make.box("box", (0.2, 0.2, 0.2)), z=0.1)
    before = world.save()
    world.run(0.5)
    with world.record_contacts(box) as record:
        world.run(0.5)
        for change in (world.reset, lambda: world.restore(before)):
            count = len(record)
            change()
            world.run(0.5)
            assert len(record) == count + 1
        starts = [each.start for each in record]
        assert starts == pytest.approx([0.5, 0.0, 0.0], abs=2 * STEP)
        assert [each.end for each in record] == [1.0, 0.5, None]
        assert [each.impulse[2] for each in record] == pytest.approx(
            [0.5 * box.mass * G] * 3, rel=0.05
        )


def test_models_come_and_go(world, make):
    world.spawn(make.box("base", (1, 1, 0.2), static=True), z=0.1)
    with world.record_contacts("base") as record:
        top = world.spawn(make.box("top", (0.2, 0.2, 0.2)), z=0.3)
        world.run(0.5)
        top.delete()
        world.run(0.5)
    assert record.first.models == ("base", "top")
    assert record.contacts[-1].end == pytest.approx(0.5, abs=2 * STEP)


@pytest.mark.parametrize(
    ("height", "seconds", "periods"), [(0.0005, 0.05, 1), (0.002, 0.05, 2), (0.0005, 0.3, 2)]
)
def test_a_short_interruption_within_a_millimetre_is_none(world, make, height, seconds, periods):
    """The box is lifted and put back: what counts is how far, and for how long."""
    box = world.spawn(make.box("box", (0.2, 0.2, 0.2)), z=0.1)
    world.run(0.5)
    rest = box.pose
    with world.record_contacts(box) as record:
        world.run(0.1)
        lifted = rest.x, rest.y, rest.z + height
        holding = world.every(200.0, lambda: setattr(box, "pose", cw.Pose(lifted)))
        start = world.time
        world.run(seconds)
        if periods == 1:
            assert record.first.end is None
        holding.cancel()
        box.pose = rest
        world.run(0.3)
    assert len(record) == periods
    ends = [each.end for each in record]
    assert ends[-1] is None
    assert ends[:-1] == pytest.approx([start] * (periods - 1), abs=2 * STEP)
    weight = box.mass * G
    assert total(record)[2] == pytest.approx(weight * 0.4, abs=0.1 * weight)


def test_a_record_that_ends_in_an_interruption(world, make):
    box = world.spawn(make.box("box", (0.2, 0.2, 0.2)), z=0.1)
    world.run(0.5)
    with world.record_contacts(box) as record:
        world.run(0.1)
        world.every(200.0, lambda: setattr(box, "pose", cw.Pose((0.0, 0.0, 0.1005))))
        world.run(0.05)
        assert record.first.end is None
    assert record.first.end == pytest.approx(0.6, abs=2 * STEP)


def test_wheels_and_casters_that_roll(world, rosbots):
    cart = world.spawn(rosbots)
    world.run(0.5)
    with world.record_contacts((cart, "ground_plane")) as record:
        cart.publish("/part2_cmr/cmd_vel", linear_x=0.3, angular_z=0.5)
        world.run(3.0)
        cart.publish("/part2_cmr/cmd_vel")
        world.run(1.0)
    assert sorted(each.links[0] for each in record) == [
        "caster_link", "wheel_left_link", "wheel_right_link",
    ]  # fmt: skip


def test_recording_changes_nothing(make, rosbots):
    ends = []
    for records in (False, True):
        world = make.world(make.box("post", (0.2, 0.2, 1.0), pose=cw.Pose((1.5, 0, 0.5))))
        cart = world.spawn(rosbots, z=0.05)
        cart.publish("/part2_cmr/cmd_vel", linear_x=0.5)
        record = world.record_contacts() if records else None
        world.run(4.0)
        ends.append((cart.pose, cart.velocity, world.model("post").pose))
        if record is not None:
            assert record
            record.close()
            record.close()
    assert ends[0] == ends[1]


def test_what_cannot_be_recorded_is_refused(world):
    with raises(UNKNOWN_MODEL, UnknownNameError, name="post"):
        world.record_contacts("post")
    record = world.record_contacts()
    world.run(0.1)
    world.close()
    record.close()
    assert record.contacts == ()
    with raises(SIMULATION_CLOSED, SimulationError):
        world.record_contacts()
