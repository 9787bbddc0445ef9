"""Fixed joints that a message attaches and detaches."""

import pytest
from tests.coded import coded

from cartwheel.codes import running
from cartwheel.errors import UnknownNameError
from cartwheel.geometry import Pose

G = 9.8


def post(make, plugin, *, name="post"):
    """A link that stands 1 m above the ground."""
    return make.sdf(f"""<model name="{name}"><pose>0 0 1 0 0 0</pose><link name="hand">
      <inertial><mass>1</mass></inertial></link>
      <joint name="bolt" type="fixed"><parent>world</parent><child>hand</child></joint>{plugin}
      </model>""")


JOINT = """<plugin name="d" filename="gz-sim-detachable-joint-system">
  <parent_link>hand</parent_link><child_model>load</child_model><child_link>link</child_link>
  {}</plugin>"""


def load(make, z=1.0):
    return make.box("load", (0.1, 0.1, 0.1), mass=2.0, pose=Pose((0.3, 0, z)))


def test_a_detachable_joint_holds_until_it_is_commanded_to_part_and_joins_again(make):
    world = make.world(post(make, JOINT.format("")), load(make), ground=None)
    states = world.mailbox("/model/load/detachable_joint/state")
    world.run(1.0)
    assert world.model("load").pose.z == pytest.approx(1.0, abs=1e-3)
    world.publish("/model/post/detachable_joint/detach")
    world.run(0.5)
    fallen = world.model("load").pose.z
    assert fallen == pytest.approx(1.0 - G * 0.5**2 / 2, abs=0.03)
    world.publish("/model/post/detachable_joint/attach")
    world.run(0.5)
    held = world.model("load").pose.z
    world.run(0.5)
    # Held where it was caught, at rest.
    assert world.model("load").pose.z == pytest.approx(held, abs=1e-3)
    assert [message.data for message in states.drain()] == ["attached", "detached", "attached"]


def test_a_child_that_comes_later_is_joined_then_and_missed_once(make):
    world = make.world(post(make, JOINT.format("")), ground=None)
    world.run(1.0)
    missed = coded(world, running.ATTACHMENT_FAILED)
    assert len(missed) == 1
    world.session.spawn(load(make))
    world.run(1.0)
    assert world.model("load").pose.z == pytest.approx(1.0, abs=1e-3)
    quiet = make.world(
        post(make, JOINT.format("<suppress_child_warning>1</suppress_child_warning>"))
    )
    quiet.run(0.1)
    assert not coded(quiet, running.ATTACHMENT_FAILED)


def test_topics_have_the_names_that_they_are_given(make):
    tags = "<topic>/let/go</topic><output_topic>/how/is/it</output_topic>"
    world = make.world(post(make, JOINT.format(tags)), load(make), ground=None)
    states = world.mailbox("/how/is/it")
    world.run(0.1)
    world.publish("/let/go")
    world.run(0.1)
    assert [message.data for message in states.drain()] == ["attached", "detached"]


def test_a_model_in_the_model_can_be_its_child(make):
    model = make.sdf(f"""<model name="outer"><pose>0 0 1 0 0 0</pose>
      <link name="hand"><inertial><mass>1</mass></inertial></link>
      <joint name="bolt" type="fixed"><parent>world</parent><child>hand</child></joint>
      <model name="load"><pose>0.2 0 0 0 0 0</pose><link name="link"><inertial><mass>1</mass>
      </inertial></link></model>{JOINT.format("")}</model>""")
    world = make.world(model, ground=None)
    link = world.session.simulation.engine
    world.run(1.0)
    assert link.link_pose("outer", "load::link").z == pytest.approx(1.0, abs=1e-3)


def test_a_parent_that_is_not_there_is_refused(make):
    with pytest.raises(UnknownNameError) as caught:
        make.world().session.spawn(post(make, JOINT.format("").replace(">hand<", ">hnd<")))
    assert caught.value.code is running.UNKNOWN_LINK
    assert caught.value.values["name"] == "hnd"
