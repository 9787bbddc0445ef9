"""Objects that fingers press from both sides."""

import math

import numpy as np
import pytest
from tests.devices.grips.hands import FINGER, HAND, SIDE, Hand

from cartwheel.devices.grips.grasp import oppose
from cartwheel.errors import PluginError
from cartwheel.geometry import Pose

GRASP = """<plugin name="g" filename="libgazebo_grasp_fix.so"><arm><arm_name>arm</arm_name>
  <palm_link>palm</palm_link><gripper_link>left</gripper_link><gripper_link>right</gripper_link>
  </arm>{}</plugin>"""
QUICK = "<update_rate>20</update_rate><max_grip_count>4</max_grip_count>"
EVENTS = "/gazebo_grasp_plugin_event_republisher/grasp_events"


def test_what_smooth_fingers_press_is_carried_and_let_go(make):
    hand = Hand(make, GRASP.format(QUICK))
    box = hand.world.mailbox(EVENTS)
    hand.press(0.05)
    # 15 mm of way at 5 cm/s, then three looks at 20 Hz: more than half of four.
    hand.world.run(0.3 + 3 / 20 + 0.1)
    hand.lift(0.1)
    assert hand.cube.z == pytest.approx(SIDE / 2 + 0.1, abs=2e-3)
    hand.press(-0.05)
    hand.world.run(1.5)
    assert hand.cube.z == pytest.approx(SIDE / 2, abs=2e-3)
    events = [(event.arm, event.object, event.attached) for event in box.drain()]
    assert events == [("arm", "cube::link::collision", on) for on in (True, False)]


def test_without_the_plugin_it_slips_out_of_them(make):
    """What the test before proves: fingers without friction lift nothing."""
    hand = Hand(make, "")
    hand.press(0.05)
    hand.world.run(0.6)
    hand.lift(0.1)
    assert hand.cube.z == pytest.approx(SIDE / 2, abs=2e-3)


def test_one_finger_alone_holds_nothing(make):
    hand = Hand(make, GRASP.format(QUICK).replace("<gripper_link>right</gripper_link>", ""))
    hand.press(0.05)
    hand.world.run(1.0)
    hand.lift(0.1)
    assert hand.cube.z == pytest.approx(SIDE / 2, abs=2e-3)


def test_the_threshold_says_how_long_it_must_be_pressed(make):
    """At 5 Hz and 10 looks, those of Gazebo, the sixth look in a row is the first above 5."""
    hand = Hand(make, GRASP.format(""))
    box = hand.world.mailbox(EVENTS)
    hand.press(0.05)
    hand.world.run(0.3 + 5 / 5 - 0.05)
    assert not box.drain()
    hand.world.run(0.3)
    assert [event.attached for event in box.drain()] == [True]


def test_a_held_object_can_be_set_to_touch_nothing(make):
    passing = QUICK + "<disable_collisions_on_attach>true</disable_collisions_on_attach>"
    hand = Hand(make, GRASP.format(passing))
    hand.press(0.05)
    hand.world.run(0.3 + 3 / 20 + 0.005)
    model = hand.simulation.model
    geom = model.geom("cube::link::collision").id
    assert model.geom_contype[geom] == 0
    everything = 0xFFFF
    assert hand.simulation.data.ncon == 0
    hand.world.reset()
    assert hand.simulation.model.geom_contype[geom] == everything
    hand.press(0.0)
    hand.world.run(1.0)
    # It stands on the ground again, which is a pair of its own.
    assert hand.cube.z == pytest.approx(SIDE / 2, abs=2e-3)


def test_what_cannot_move_is_not_held(make):
    post = make.box("post", (SIDE,) * 3, static=True, pose=Pose((0, 0, SIDE / 2)))
    hand = make.sdf(
        HAND.format(
            fingers="".join(FINGER.format(name=n, y=y, mu=0) for n, y in (("left", 0.03),
                                                                          ("right", -0.03))),
            plugin=GRASP.format(QUICK),
        )
    )  # fmt: skip
    world = make.world(hand, post)
    box = world.mailbox(EVENTS)
    for side, sign in (("left", -1), ("right", 1)):
        world.session.simulation.drive(
            "hand", f"{side}_joint", velocity=0.05 * sign, max_effort=5.0
        )
    world.run(1.0)
    assert not box.drain()


@pytest.mark.parametrize(
    ("tags", "parameter"),
    [
        ("<forces_angle_tolerance>60</forces_angle_tolerance>", "forces_angle_tolerance"),
        ("<arm><arm_name>a</arm_name></arm>", "palm_link"),
        (
            "<arm><arm_name>a</arm_name><palm_link>palm</palm_link></arm>",
            "gripper_link",
        ),
    ],
)
def test_a_hand_that_cannot_be_is_refused(make, tags, parameter):
    with pytest.raises(PluginError) as caught:
        Hand(make, GRASP.format(tags))
    assert caught.value.values["parameter"] == parameter


@pytest.mark.parametrize(
    ("one", "other", "angle", "holds"),
    [
        ((0, 1, 0), (0, -1, 0), 120, True),
        # 130° apart.
        ((0, 1, 0), (math.sin(math.radians(130)), math.cos(math.radians(130)), 0), 120, True),
        ((0, 1, 0), (math.sin(math.radians(130)), math.cos(math.radians(130)), 0), 140, False),
        ((0, 1, 0), (0, 1, 0), 120, False),
        # One is too weak: compared with the other, or at all.
        ((0, 1, 0), (0, -0.29, 0), 120, False),
        ((0, 1, 0), (0, -0.31, 0), 120, True),
        ((0, 1e-5, 0), (0, -1e-5, 0), 120, False),
    ],
)
def test_forces_grip_if_they_are_opposite_and_similar(one, other, angle, holds):
    forces = [np.array(one, dtype=float), np.array(other, dtype=float)]
    assert oppose(forces, math.radians(angle)) is holds
    assert oppose(forces[:1], math.radians(angle)) is False
