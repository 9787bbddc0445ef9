"""A finger whose joints share the angle of one motor."""

import pytest

from cartwheel.codes import devices
from cartwheel.errors import PluginError, UnknownNameError
from cartwheel.geometry import Pose

PLUGIN = """<plugin name="f" filename="libgazebo_underactuated_finger.so">
  <actuatedJoint>motor</actuatedJoint>
  <virtualJoint><name>near</name><scale_factor>2</scale_factor></virtualJoint>
  <virtualJoint><name>far</name><scale_factor>4</scale_factor>
    <pid_gains><p>50</p></pid_gains></virtualJoint></plugin>"""


def hand(make, plugin=PLUGIN):
    inertial = """<inertial><mass>0.05</mass><inertia><ixx>1e-5</ixx><iyy>1e-5</iyy><izz>1e-5</izz>
      </inertia></inertial>"""
    bone = """<collision name="c"><pose>0.05 0 0 0 0 0</pose><geometry><box><size>0.1 0.01 0.01
      </size></box></geometry></collision>"""

    def joint(name, parent, child, upper, x=0.0):
        return f"""<link name="{child}"><pose>{x} 0 0 0 0 0</pose>{inertial}{bone}</link>
          <joint name="{name}" type="revolute"><parent>{parent}</parent><child>{child}</child>
          <axis><xyz>0 0 1</xyz><limit><lower>0</lower><upper>{upper}</upper><effort>0.5</effort>
          </limit></axis></joint>"""

    return make.sdf(f"""<model name="hand"><pose>0 0 1 0 0 0</pose><link name="palm">{inertial}
      </link><joint name="bolt" type="fixed"><parent>world</parent><child>palm</child></joint>
      <link name="spool"><pose>0 0 -0.1 0 0 0</pose>{inertial}</link>
      <joint name="motor" type="revolute"><parent>palm</parent><child>spool</child>
      <axis><xyz>0 0 1</xyz></axis></joint>
      {joint("near", "palm", "first", 1.2)}{joint("far", "first", "second", 0.5, 0.1)}
      {plugin}</model>""")


def positions(world):
    simulation = world.session.simulation
    return [simulation.joint_position("hand", name) for name in ("near", "far")]


def wind(world, angle):
    """Turns the motor at 1 rad/s, and holds it there."""
    simulation = world.session.simulation
    now = simulation.joint_position("hand", "motor")
    simulation.drive("hand", "motor", velocity=1.0 if angle > now else -1.0, max_effort=10.0)
    world.run(abs(angle - now))
    simulation.drive("hand", "motor", velocity=0.0)
    world.run(0.5)


def test_each_joint_has_its_share_within_its_limits(make):
    world = make.world(hand(make), ground=None)
    wind(world, 1.0)
    assert positions(world) == pytest.approx([0.5, 0.25], abs=0.01)
    wind(world, 3.0)
    # 1.5 and 0.75 are more than they can.
    assert positions(world) == pytest.approx([1.2, 0.5], abs=0.01)
    wind(world, 0.4)
    assert positions(world) == pytest.approx([0.2, 0.1], abs=0.01)


def test_what_meets_something_stays_and_the_rest_goes_on(make):
    """A post beside the first bone stops it; the second one closes around it."""
    post = make.box("post", (0.01, 0.01, 0.2), static=True, pose=Pose((0.06, 0.012, 1)))
    world = make.world(hand(make), post, ground=None)
    wind(world, 2.0)
    near, far = positions(world)
    assert near < 0.2
    assert far == pytest.approx(0.5, abs=0.01)


@pytest.mark.parametrize(
    ("old", "new", "error", "code"),
    [
        (">near<", ">ner<", UnknownNameError, devices.PLUGIN_JOINT_UNKNOWN),
        (">2<", ">0<", PluginError, devices.PLUGIN_PARAMETER_INVALID),
        ("<name>near</name>", "", PluginError, devices.PLUGIN_PARAMETER_MISSING),
    ],
)
def test_a_finger_that_makes_no_sense_is_refused(make, old, new, error, code):
    with pytest.raises(error) as caught:
        make.world().session.spawn(hand(make, PLUGIN.replace(old, new, 1)))
    assert caught.value.code is code
