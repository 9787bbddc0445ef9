"""Links that a program attaches to each other."""

import pickle

import numpy as np
import pytest
from tests.coded import raises

import cartwheel as cw
from cartwheel.codes.world import VALUE_INVALID
from cartwheel.errors import CartwheelError, UnknownNameError

COMMANDS = "/part2_cmr/cmd_vel"
BOX = """<robot name="box"><link name="link">
  <inertial><mass value="2"/>
    <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><geometry><box size="0.4 0.4 0.4"/></geometry></collision>
</link></robot>"""


def pair(world: cw.World, gap: float = 1.0) -> tuple[cw.Link, cw.Link]:
    """Two boxes in the air, side by side."""
    made = [world.spawn(BOX, name=name, x=x, z=5.0) for name, x in (("a", 0.0), ("b", gap))]
    one, two = (each.link(each.links[0]) for each in made)
    return one, two


def relative(one: cw.Link, two: cw.Link) -> tuple[float, ...]:
    pose = one.pose.inverse() @ two.pose
    return (*pose.position, *pose.orientation)


def test_attached_links_move_as_one_body() -> None:
    with cw.World("empty") as world:
        world.gravity = (0.0, 0.0, 0.0)
        one, two = pair(world)
        before = relative(one, two)
        one.attach(two)
        assert one.attached[0].scoped_name == two.scoped_name
        assert two.attached[0].scoped_name == one.scoped_name
        mass = world.model("a").mass + world.model("b").mass
        one.push((mass * 2.0, 0.0, 0.0), seconds=0.5, at=(0.5, 0.0, 5.0))
        world.run(1.0)
        # 2 m/s² for 0.5 s. Both masses are equal, so that the force acts at the common centre.
        for link in (one, two):
            assert link.velocity.linear[0] == pytest.approx(1.0, abs=1e-3)
        assert relative(one, two) == pytest.approx(before, abs=1e-3)
        two.detach(one)
        assert one.attached == two.attached == ()
        one.push((10.0, 0.0, 0.0), seconds=0.1)
        world.run(0.5)
        assert two.velocity.linear[0] == pytest.approx(1.0, abs=1e-3)
        assert one.velocity.linear[0] > 1.05


def test_a_link_of_the_world_holds_the_other_one() -> None:
    with cw.World("empty") as world:
        one, two = pair(world)
        ground = world.model("ground_plane").link("link")
        for holder, held in ((ground, one), (two, ground)):
            holder.attach(held)
        assert len(ground.attached) == 2
        world.run(1.0)
        assert one.pose.z == pytest.approx(5.0, abs=2e-3)
        assert two.pose.z == pytest.approx(5.0, abs=2e-3)
        ground.detach()
        assert ground.attached == ()
        world.run(0.5)
        assert one.pose.z < 4.0 and two.pose.z < 4.0


def test_a_pair_can_be_attached_again_and_welds_are_used_again() -> None:
    with cw.World("empty") as world:
        world.gravity = (0.0, 0.0, 0.0)
        one, two = pair(world)
        one.attach(two)
        one.detach(two)
        one.detach(two)
        model = world.session.simulation.model
        world.model("b").pose = cw.Pose((2.0, 0.0, 5.0))
        two.attach(one)
        assert world.session.simulation.model is model
        world.run(0.2)
        assert two.pose.x - one.pose.x == pytest.approx(2.0, abs=1e-3)
        world.model("b").pose = cw.Pose((3.0, 0.0, 5.0))
        one.attach(two)
        world.run(0.2)
        assert two.pose.x - one.pose.x == pytest.approx(3.0, abs=1e-3)
        assert len(one.attached) == 1
        assert world.session.simulation.model is model


def test_other_models_can_come_and_go() -> None:
    with cw.World("empty") as world:
        world.gravity = (0.0, 0.0, 0.0)
        one, two = pair(world)
        before = relative(one, two)
        one.attach(two)
        world.spawn(BOX, name="c", x=5.0)
        one.push((5.0, 0.0, 0.0), seconds=0.1)
        world.run(0.5)
        assert relative(one, two) == pytest.approx(before, abs=1e-3)
        world.model("b").delete()
        assert one.attached == ()
        world.run(0.1)
        with pytest.raises(UnknownNameError):
            one.attach(two)
        with pytest.raises(UnknownNameError):
            one.detach(two)


def test_reset_releases() -> None:
    with cw.World("empty") as world:
        one, two = pair(world)
        one.attach(two)
        world.run(0.2)
        world.reset()
        assert one.attached == ()
        assert two.pose.x == pytest.approx(1.0)


def state_of(world: cw.World) -> bytes:
    data = world.session.simulation.data
    return np.concatenate([data.qpos, data.qvel]).tobytes()


def test_a_saved_state_contains_what_is_attached() -> None:
    def set_out(world: cw.World) -> tuple[cw.Link, cw.Link]:
        one, two = pair(world)
        one.push((3.0, 1.0, 0.0), seconds=0.5)
        return one, two

    with cw.World("empty") as world:
        one, two = set_out(world)
        world.run(0.1)
        free = world.save()
        one.attach(two)
        attached = world.save()
        world.run(0.5)
        expected = state_of(world)
        one.detach(two)
        world.run(0.1)
        for state in (attached, pickle.loads(pickle.dumps(attached))):
            world.restore(free)
            assert one.attached == ()
            world.run(0.5)
            assert state_of(world) != expected
            world.restore(state)
            assert [link.model for link in one.attached] == ["b"]
            world.run(0.5)
            assert state_of(world) == expected
    with cw.World("empty") as other:
        set_out(other)
        other.restore(pickle.loads(pickle.dumps(attached)))
        other.run(0.5)
        assert state_of(other) == expected
        other.model("a").link(one.name).detach()
        assert other.model("b").link(two.name).attached == ()


def test_an_action_attaches_while_the_world_runs() -> None:
    def drive() -> tuple[float, bytes]:
        with cw.World("empty") as world:
            cart = world.spawn("rosbots.xacro")
            crate = world.spawn("box_small.urdf", name="crate", x=-1.5)
            base, load = cart.link("base_link"), crate.link(crate.links[0])
            world.on(0.5, lambda: base.attach(load))
            world.on(3.0, lambda: base.detach(load))
            cart.publish(COMMANDS, linear_x=0.3)
            world.run(4.0)
            return cart.pose.x - crate.pose.x, state_of(world)

    distance, state = drive()
    # The cart drives 0.105 m before, at 1 m/s² up to 0.3 m/s, and 0.3 m after the crate is towed.
    assert distance == pytest.approx(1.5 + 0.105 + 0.3, abs=0.03)
    assert drive() == (distance, state)


def test_what_cannot_be_attached() -> None:
    with cw.World("walls") as world, cw.World("empty") as other:
        one, two = pair(world)
        ground = world.model("ground_plane").link("link")
        wall = next(name for name in world.models if name not in ("ground_plane", "a", "b"))
        fixed = world.model(wall).link(world.model(wall).links[0])
        foreign = pair(other)[0]
        for a, b in ((one, one), (ground, fixed), (one, foreign), (one, "b::link"), (one, None)):
            with raises(VALUE_INVALID):
                a.attach(b)  # type: ignore[arg-type]
        with raises(VALUE_INVALID):
            one.detach("b::link")  # type: ignore[arg-type]
        one.attach(two)
    with pytest.raises(CartwheelError):
        one.attach(two)
