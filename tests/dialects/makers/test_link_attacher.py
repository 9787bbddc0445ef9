"""Joints between any two links, made and undone by service."""

import pytest
from tests.coded import coded

from cartwheel.codes import devices, running
from cartwheel.codes import world as world_codes
from cartwheel.description.model import Element, PluginTag
from cartwheel.errors import Origin
from cartwheel.geometry import Pose

HERE = Origin(file="w.world", line=1)
ATTACH, DETACH = "/link_attacher_node/attach", "/link_attacher_node/detach"


def tag(filename):
    return PluginTag(
        name="attacher", filename=filename, element=Element(tag="plugin", origin=HERE), origin=HERE
    )


def world_of(make, filename, *models, **more):
    return make.world(*models, plugins=(tag(filename),), **more)


def pair(make, low=0.05, high=1.0):
    """A heavy box bolted nowhere, and a light one beside it."""
    post = make.box("post", (0.1, 0.1, 0.1), static=True, pose=Pose((0, 0, high)))
    return post, make.box("load", (0.1, 0.1, 0.1), mass=3.0, pose=Pose((0.3, 0, low)))


def names(one, two):
    return {
        "model_name_1": one,
        "link_name_1": "link",
        "model_name_2": two,
        "link_name_2": "link",
    }


@pytest.mark.parametrize("order", [("post", "load"), ("load", "post")])
def test_what_is_attached_to_what_stands_hangs_there_until_it_is_parted(make, ask, order):
    """Without the joint it falls g t²/2; with it, it stays where it was when it was asked for."""
    world = world_of(make, "libgazebo_ros_link_attacher.so", *pair(make, low=1.0), ground=None)
    assert ask(world, ATTACH, **names(*order)).ok
    start = world.model("load").pose.position
    world.run(2.0)
    assert world.model("load").pose.position == pytest.approx(start, abs=2e-4)
    assert ask(world, DETACH, **names(*order)).ok
    world.run(1.0)
    fallen = start[2] - world.model("load").pose.z
    assert fallen == pytest.approx(9.8 / 2, rel=0.02)
    assert not ask(world, DETACH, **names(*order)).ok


def test_a_joint_lasts_over_spawning_and_ends_with_its_link_or_a_reset(make, ask):
    world = world_of(make, "libgazebo_ros_link_attacher.so", *pair(make, low=1.0), ground=None)
    ask(world, ATTACH, **names("post", "load"))
    world.session.spawn(make.box("late", (0.1, 0.1, 0.1)), pose=Pose((5, 5, 5)))
    world.run(1.0)
    assert world.model("load").pose.z == pytest.approx(1.0, abs=1e-3)
    # A second joint holds the late one in the first.
    world.session.simulation.set_pose("late", Pose((0.6, 0, 1.0)))
    assert ask(world, ATTACH, **names("load", "late")).ok
    world.run(1.0)
    assert world.model("late").pose.z == pytest.approx(1.0, abs=0.01)
    world.model("load").delete()
    world.run(0.5)
    assert world.model("late").pose.z < 0.5
    world.reset()
    assert not ask(world, DETACH, **names("post", "late")).ok


def test_a_box_that_sleeps_is_woken_by_what_it_is_attached_to(make, ask):
    lift = make.sdf("""<model name="lift"><pose>1 0 1 0 0 0</pose>
      <link name="link"><inertial><mass>20</mass></inertial></link>
      <joint name="up" type="prismatic"><parent>world</parent><child>link</child>
      <axis><xyz>0 0 1</xyz></axis></joint></model>""")
    box = make.box("load", (0.1, 0.1, 0.1), mass=3.0, pose=Pose((0, 0, 0.05)))
    world = world_of(make, "libgazebo_ros_link_attacher.so", lift, box, gravity=9.8)
    simulation = world.session.simulation
    simulation.drive("lift", "up", velocity=0.0, max_effort=1e4)
    world.run(3.0)
    ask(world, ATTACH, **names("lift", "load"))
    simulation.drive("lift", "up", velocity=0.25)
    world.run(2.0)
    assert world.model("load").pose.z == pytest.approx(0.05 + 0.5, abs=5e-3)
    assert world.model("load").pose.position[:2] == pytest.approx((0, 0), abs=5e-3)


def test_the_reaction_of_a_joint_counts_what_is_attached(make, ask):
    """A post on a fixed joint bears its own weight and, once it is joined, that of the load."""
    post = make.sdf("""<model name="post"><pose>0 0 1 0 0 0</pose>
      <link name="link"><inertial><mass>2</mass></inertial></link>
      <joint name="bolt" type="fixed"><parent>world</parent><child>link</child>
      <sensor name="ft" type="force_torque"><always_on>1</always_on><update_rate>50</update_rate>
      <topic>wrench</topic></sensor></joint></model>""")
    load = make.box("load", (0.1, 0.1, 0.1), mass=3.0, pose=Pose((0.3, 0, 1.0)))
    world = world_of(make, "libgazebo_ros_link_attacher.so", post, load, ground=None)
    box = world.mailbox("/wrench")
    ask(world, ATTACH, **names("post", "load"))
    world.run(1.0)
    message = box.drain()[-1]
    assert abs(message.wrench.force.z) == pytest.approx((2 + 3) * 9.8, rel=1e-3)
    assert abs(message.wrench.torque.y) == pytest.approx(0.3 * 3 * 9.8, rel=1e-3)


def test_what_there_is_not_is_reported_with_what_there_is(make, ask):
    world = world_of(make, "libgazebo_ros_link_attacher.so", *pair(make))
    assert not ask(world, ATTACH, **names("post", "lod")).ok
    assert coded(
        world, running.ATTACHMENT_FAILED, cause=world_codes.UNKNOWN_MODEL.number, meant="load"
    )
    request = names("post", "load") | {"link_name_2": "lnk"}
    assert not ask(world, ATTACH, **request).ok
    assert coded(
        world, running.ATTACHMENT_FAILED, cause=running.UNKNOWN_LINK.number, name="load::lnk"
    )


def test_ros_2_s_services_answer_with_a_message(make, ask):
    world = world_of(make, "libgazebo_link_attacher.so", *pair(make, low=1.0), ground=None)
    request = {
        "model1_name": "post",
        "link1_name": "link",
        "model2_name": "load",
        "link2_name": "load::link",
    }
    assert ask(world, "/ATTACHLINK", **request).success
    again = ask(world, "/ATTACHLINK", **request)
    assert not again.success and again.message
    world.run(1.0)
    assert world.model("load").pose.z == pytest.approx(1.0, abs=1e-3)
    assert ask(world, "/DETACHLINK", **request).success
    world.run(0.5)
    assert world.model("load").pose.z < 0.9
    wrong = ask(world, "/DETACHLINK", **(request | {"model2_name": "lod"}))
    assert not wrong.success and wrong.message


@pytest.mark.wording
def test_ros_2_s_services_answer_with_the_likely_name(make, ask):
    world = world_of(make, "libgazebo_link_attacher.so", *pair(make))
    request = {"model1_name": "post", "link1_name": "link", "model2_name": "lod"}
    assert 'Did you mean "load"' in ask(world, "/ATTACHLINK", **request).message


def test_inside_a_model_it_is_reported_where_it_belongs(make):
    world = make.world(
        make.sdf("""<model name="m"><link name="l"/>
        <plugin name="p" filename="libgazebo_ros_link_attacher.so"/></model>""")
    )
    assert coded(world, devices.PLUGIN_MISPLACED, place="world")
