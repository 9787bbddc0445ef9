"""Handles of a world: their attributes and their equality."""

import copy
import dataclasses
import pickle

import pytest
from tests.coded import raises

import cartwheel as cw
from cartwheel.codes.command import OPTION_INVALID
from cartwheel.codes.world import NUMBER_OUT_OF_RANGE

HANDLES = [
    ("world", "gravitiy", "gravity"),
    ("world", "paces", "pace"),
    ("model", "positon", "pose"),
    ("link", "colour", "color"),
    ("joints", "position", "positions"),
    ("joint", "postion", "position"),
    ("light", "colour", "color"),
    ("positions", "wheel_left_joint", ""),
]


@pytest.fixture(scope="module")
def handles():
    with cw.World("walls") as world:
        cart = world.spawn("rosbots.xacro")
        yield {
            "world": world,
            "model": cart,
            "link": cart.link("base_link"),
            "joints": cart.joints,
            "joint": cart.joints["wheel_left_joint"],
            "light": world.light(world.lights[0]),
            "positions": cart.joints.positions,
        }


@pytest.mark.parametrize(("handle", "name", "_meant"), HANDLES)
def test_a_misspelt_attribute_is_refused(handle, name, _meant, handles):
    with pytest.raises(AttributeError) as caught:
        setattr(handles[handle], name, (1, 0, 0))
    assert caught.value.name == name
    with pytest.raises(AttributeError):
        getattr(handles[handle], name)


@pytest.mark.wording
@pytest.mark.parametrize(("handle", "name", "meant"), HANDLES)
def test_a_misspelt_attribute_is_corrected(handle, name, meant, handles):
    with pytest.raises(AttributeError) as caught:
        setattr(handles[handle], name, (1, 0, 0))
    assert meant in str(caught.value)


def test_a_property_that_cannot_be_set_stays(handles):
    for handle, name in (("world", "time"), ("model", "mass"), ("joints", "names")):
        with pytest.raises(AttributeError):
            setattr(handles[handle], name, 3)


@pytest.mark.parametrize("handle", ["model", "link", "joint", "light"])
def test_a_handle_keeps_its_name(handle, handles):
    name = handles[handle].name
    with pytest.raises(AttributeError):
        handles[handle].name = "other"
    assert handles[handle].name == name


def test_a_world_of_a_program_has_its_own_attributes():
    class Lab(cw.World):
        def __init__(self, world):
            self.level = 3
            super().__init__(world)
            self.robot = self.spawn("rosbots.xacro")

    with Lab("empty") as lab:
        lab.more = lab.level
        assert (lab.more, lab.robot) == (3, lab.model("rosbots"))
    with cw.World() as world:
        world.pace = 2.0
        assert world.pace == 2.0


@pytest.mark.parametrize("copied", [pickle.dumps, copy.copy, copy.deepcopy])
def test_a_world_cannot_be_copied(copied, handles):
    for name in ("world", "model", "link", "light"):
        if copied is not copy.copy or name == "world":
            with raises(OPTION_INVALID, name="world"):
                copied(handles[name])


def test_what_is_part_of_a_pose_cannot_be_set(handles):
    model = handles["model"]
    for owner, name in (
        (model.pose, "x"),
        (model.pose, "position"),
        (model.pose, "anything"),
        (model.velocity, "linear"),
        (handles["link"].acceleration, "angular"),
    ):
        with pytest.raises(dataclasses.FrozenInstanceError):
            setattr(owner, name, 3.0)
    with pytest.raises(dataclasses.FrozenInstanceError):
        del model.pose.position


@pytest.mark.wording
def test_instead_of_a_part_the_pose_is_set(handles):
    with pytest.raises(AttributeError, match=r"robot\.pose = cartwheel\.Pose\(\(x, y, z\)\)"):
        handles["model"].pose.x = 3
    with pytest.raises(AttributeError, match=r"robot\.velocity = cartwheel\.Twist"):
        handles["model"].velocity.linear = 3


@pytest.mark.parametrize("wrong", ["a", None, [0.0]])
def test_a_pose_consists_of_numbers(wrong, handles):
    with raises(NUMBER_OUT_OF_RANGE):
        handles["model"].pose = cw.Pose((wrong, 0, 0))
    with raises(OPTION_INVALID):
        cw.Pose((0, 0, 0), (0, wrong, 0, 1))


def test_handles_to_the_same_thing_are_equal(handles):
    world, cart = handles["world"], handles["model"]
    again = world.model(cart.name)
    pairs = [
        (again, cart),
        (again.link("base_link"), handles["link"]),
        (again.joints, handles["joints"]),
        (again.joints["wheel_left_joint"], handles["joint"]),
        (world.light(world.lights[0]), handles["light"]),
    ]
    for one, other in pairs:
        assert one is not other and one == other and hash(one) == hash(other)
        assert len({one, other}) == 1
    parts = [one for one, _ in pairs]
    assert all(one != other for one in parts for other in parts if one is not other)
    assert cart.link("base_link") != cart.link("wheel_left_link")
    assert cart.joints["wheel_left_joint"] != cart.joints["wheel_right_joint"]
    assert cart != "rosbots" and cart != world.model("ground_plane")


def test_handles_of_two_worlds_differ(handles):
    with cw.World("walls") as other:
        cart = other.spawn("rosbots.xacro")
        assert cart.name == handles["model"].name
        assert cart != handles["model"] and cart.joints != handles["joints"]
        assert cart.link("base_link") != handles["link"]
        assert other.light(other.lights[0]) != handles["light"]


def test_attached_links_contain_the_handle(make):
    world = make.world(
        make.box("one", (1, 1, 1)), make.box("two", (1, 1, 1), pose=cw.Pose((3, 0, 0)))
    )
    one, two = (world.model(name).link(world.model(name).links[0]) for name in ("one", "two"))
    one.attach(two)
    assert two in one.attached and one in two.attached and one not in one.attached


@pytest.mark.wording
def test_worlds_say_what_they_are() -> None:
    built = cw.build("post", ["rosbots"])
    with built.world() as world:
        world.run(0.5)
        assert repr(world) == "<World 'default' at 0.5 s>"
        hold = world.topic("/part2_cmr/cmd_vel").hold(rate=10.0, linear={"x": 0.1})
        assert repr(hold) == "<Hold of /part2_cmr/cmd_vel: active>"
        hold.stop()
        assert repr(hold) == "<Hold of /part2_cmr/cmd_vel: ended>"
    assert repr(world) == "<World 'default' closed>"
    assert repr(built) == "<Built world 'default': ground_plane, post, rosbots>"
