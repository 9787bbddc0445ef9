"""Hands that hold: by suction, and where fingers press from both sides."""

import math

import pytest

from cartwheel.errors import PluginError
from cartwheel.geometry import Pose

SIDE = 0.06
MASS = 0.5
HAND = """<model name="hand"><pose>0 0 0.2 0 0 0</pose>
  <link name="palm"><inertial><mass>2</mass></inertial></link>
  <joint name="up" type="prismatic"><parent>world</parent><child>palm</child>
    <axis><xyz>0 0 1</xyz></axis></joint>
  {fingers}{plugin}</model>"""
FINGER = """<link name="{name}"><pose>0 {y} -0.16 0 0 0</pose>
    <inertial><mass>0.2</mass></inertial><collision name="pad"><geometry>
    <box><size>0.04 0.01 0.04</size></box></geometry><surface><friction><ode><mu>{mu}</mu><mu2>{mu}
    </mu2></ode></friction></surface></collision></link>
  <joint name="{name}_joint" type="prismatic"><parent>palm</parent><child>{name}</child>
    <axis><xyz>0 1 0</xyz><limit><lower>-0.2</lower><upper>0.2</upper></limit></axis></joint>"""
GRASP = """<plugin name="g" filename="libgazebo_grasp_fix.so"><arm><arm_name>arm</arm_name>
  <palm_link>palm</palm_link><gripper_link>left</gripper_link><gripper_link>right</gripper_link>
  </arm>{}</plugin>"""
QUICK = "<update_rate>20</update_rate><max_grip_count>4</max_grip_count>"
EVENTS = "/gazebo_grasp_plugin_event_republisher/grasp_events"


class Hand:
    """A hand on a lift, with a box between its fingers that are too smooth to lift it."""

    def __init__(self, make, plugin, *, sides=("left", "right"), mu=0.0, extra=()):
        places = {"left": 0.05, "right": -0.05}
        fingers = "".join(FINGER.format(name=side, y=places[side], mu=mu) for side in sides)
        hand = make.sdf(HAND.format(fingers=fingers, plugin=plugin))
        cube = make.box("cube", (SIDE,) * 3, mass=MASS, mu=0.5, pose=Pose((0, 0, SIDE / 2)))
        self.world = make.world(hand, cube, *extra, ground=1.0, step=0.002)
        self.simulation = self.world.session.simulation
        self.sides = sides
        self.simulation.drive("hand", "up", velocity=0.0, max_effort=200.0)
        self.press(0.0)

    def press(self, speed):
        for side in self.sides:
            toward = -speed if side == "left" else speed
            self.simulation.drive("hand", f"{side}_joint", velocity=toward, max_effort=5.0)

    def lift(self, height, speed=0.1):
        self.simulation.drive("hand", "up", velocity=speed)
        self.world.run(height / speed)
        self.simulation.drive("hand", "up", velocity=0.0)

    @property
    def cube(self):
        return self.world.model("cube").pose


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


def test_what_is_held_can_be_told_to_touch_nothing(make):
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


CUP = """<plugin name="v" filename="libgazebo_ros_vacuum_gripper.so">{}</plugin>"""
ROS1 = (
    "<robotNamespace>cup</robotNamespace><bodyName>palm</bodyName><topicName>grasping</topicName>"
)
ROS2 = """<ros><namespace>cup</namespace></ros><link_name>palm</link_name>
  <max_distance>{}</max_distance>{}"""


class Cup(Hand):
    """The palm alone, 3 cm above the middle of a cube; the lift's zero is at 0.2 m."""

    def __init__(self, make, plugin, **more):
        super().__init__(make, plugin, sides=(), **more)
        self.lift(-0.14, speed=-0.1)


def told(world, seconds=0.02):
    box = world.mailbox("/cup/grasping")
    world.run(seconds)
    return {message.data for message in box.drain()}


def test_a_cup_that_is_on_carries_what_it_was_put_on(make, ask):
    hand = Cup(make, CUP.format(ROS1))
    assert told(hand.world) == {False}
    ask(hand.world, "/cup/on")
    hand.lift(0.1)
    assert hand.cube.z == pytest.approx(SIDE / 2 + 0.1, abs=2e-3)
    assert hand.cube.yaw == pytest.approx(0.0, abs=1e-3)
    assert told(hand.world) == {True}
    ask(hand.world, "/cup/off")
    # It falls 10 cm, and a while on is still there.
    hand.world.run(math.sqrt(2 * 0.1 / 9.8) + 0.3)
    assert hand.cube.z == pytest.approx(SIDE / 2, abs=2e-3)
    assert told(hand.world) == {False}


def test_what_is_beyond_reach_is_taken_when_the_cup_comes_near(make, ask):
    hand = Cup(make, CUP.format(ROS1))
    hand.lift(0.05)
    ask(hand.world, "/cup/on")
    hand.world.run(0.2)
    assert told(hand.world) == {False}
    hand.lift(-0.035, speed=-0.1)
    assert told(hand.world) == {True}


def test_ros_2_s_cup_has_one_switch_a_reach_and_exceptions(make, ask):
    hand = Cup(make, CUP.format(ROS2.format(0.02, "")))
    answer = ask(hand.world, "/cup/switch", data=True)
    assert answer.success
    assert not ask(hand.world, "/cup/switch", data=True).success
    # 3 cm away, and it reaches 2.
    assert told(hand.world) == {False}
    spared = Cup(make, CUP.format(ROS2.format(0.04, "<fixed>cube</fixed>")))
    ask(spared.world, "/cup/switch", data=True)
    assert told(spared.world) == {False}
    taken = Cup(make, CUP.format(ROS2.format(0.04, "<fixed>other</fixed>")))
    ask(taken.world, "/cup/switch", data=True)
    assert told(taken.world) == {True}


def test_a_reset_switches_the_cup_off(make, ask):
    hand = Cup(make, CUP.format(ROS1))
    ask(hand.world, "/cup/on")
    hand.world.reset()
    assert told(hand.world) == {False}
