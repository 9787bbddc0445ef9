"""A robot on a winch: hung, lowered, set down and let go."""

import pytest

from cartwheel.codes import devices, running
from cartwheel.errors import PluginError, UnknownNameError

INVALID = devices.PLUGIN_PARAMETER_INVALID

MASS, SIDE = 8.0, 0.4
G = 9.8
ROPE = """<joint name="rope" type="prismatic"><parent>world</parent><child>trunk</child>
  <axis><xyz>0 0 1</xyz><limit><lower>{}</lower><upper>0.5</upper></limit></axis></joint>"""
WINCH = """<winch><joint>rope</joint><pid><p>1e6</p></pid></winch><detach>rope</detach>"""


def robot(make, inside, filename="libgazebo_ros_harness.so"):
    return make.sdf(f"""<model name="biped"><pose>0 0 1 0 0 0</pose><link name="trunk">
      <inertial><mass>{MASS}</mass><inertia><ixx>.2</ixx><iyy>.2</iyy><izz>.2</izz></inertia>
      </inertial><collision name="c"><geometry><box><size>{SIDE} {SIDE} {SIDE}</size></box>
      </geometry></collision></link>
      <plugin name="h" filename="{filename}">{inside}</plugin></model>""")


@pytest.fixture
def world(make):
    return make.world(robot(make, ROPE.format(-2) + WINCH))


def force_of(world):
    """What the rope exerts on the robot."""
    simulation = world.session.simulation
    simulation.refresh()
    return simulation._population.residents["biped"].behaviours[0].device.wound.joint.force()


def height(world):
    return world.model("biped").pose.z


def test_it_hangs_and_is_wound_up_to_the_end_of_its_rope(world):
    world.run(1.0)
    assert height(world) == pytest.approx(1.0, abs=1e-3)
    world.publish("/biped/harness/velocity", data=0.2)
    world.run(1.0)
    # It follows as what is critically damped in 10 ms does: twice that behind.
    assert height(world) == pytest.approx(1.2 - 0.2 * 0.02, abs=0.002)
    world.run(3.0)
    assert height(world) == pytest.approx(1.5, abs=0.003)


def test_it_is_set_down_and_not_pressed_into_the_ground(world):
    world.publish("/biped/harness/velocity", data=-0.2)
    world.run(2.0)
    assert height(world) == pytest.approx(0.6, abs=0.005)
    # The rope is long enough for another 60 cm, of which 40 lead to the ground.
    world.run(5.0)
    assert height(world) == pytest.approx(SIDE / 2, abs=0.005)
    assert force_of(world) == pytest.approx([0, 0, 0])
    # 40 cm of it lie slack by now, or what the limit leaves: it is wound up by so much first.
    world.publish("/biped/harness/velocity", data=0.2)
    world.run(2.0)
    assert height(world) == pytest.approx(SIDE / 2, abs=0.005)
    world.run(2.0)
    assert height(world) == pytest.approx(1.0 - 1.4 + 4.0 * 0.2, abs=0.02)


def test_the_rope_bears_the_weight(world):
    world.run(1.0)
    assert force_of(world) == pytest.approx([0, 0, MASS * G], rel=1e-3, abs=1e-6)


def test_detached_it_falls_and_a_reset_hangs_it_again(world):
    world.publish("/biped/harness/detach", data=False)
    world.run(0.5)
    assert height(world) == pytest.approx(1.0, abs=1e-3)
    world.publish("/biped/harness/detach", data=True)
    world.run(1.0)
    assert height(world) == pytest.approx(SIDE / 2, abs=0.005)
    world.publish("/biped/harness/detach", data=True)
    world.run(0.1)
    assert world.diagnostics[-1].code is running.ATTACHMENT_FAILED
    world.reset()
    world.run(1.0)
    assert height(world) == pytest.approx(1.0, abs=1e-3)


def test_ros_2_s_spelling_has_a_first_velocity_and_is_let_go_by_empty(make):
    inside = (
        ROPE.format(-2) + WINCH + "<ros><namespace>lab</namespace></ros><init_vel>-0.1</init_vel>"
    )
    world = make.world(robot(make, inside))
    world.run(2.0)
    assert height(world) == pytest.approx(0.8, abs=0.005)
    world.publish("/lab/biped/harness/velocity", data=0.0)
    world.run(1.0)
    assert height(world) == pytest.approx(0.8, abs=0.005)
    world.publish("/lab/biped/harness/detach")
    world.run(1.0)
    assert height(world) == pytest.approx(SIDE / 2, abs=0.005)


@pytest.mark.parametrize(
    ("inside", "error", "code"),
    [
        (ROPE.format(-2) + "<detach>rop</detach>", UnknownNameError, devices.PLUGIN_JOINT_UNKNOWN),
        (ROPE.format("x"), PluginError, INVALID),
        (
            ROPE.format(-2).replace("prismatic", "revolute"),
            PluginError,
            INVALID,
        ),
        (
            ROPE.format(-2).replace(">0 0 1<", ">0 0 0<"),
            PluginError,
            INVALID,
        ),
        (ROPE.format(-2).replace("trunk", "trnk"), UnknownNameError, running.UNKNOWN_LINK),
    ],
)
def test_a_harness_that_cannot_hold_is_refused(make, inside, error, code):
    with pytest.raises(error) as caught:
        make.world().session.spawn(robot(make, inside))
    assert caught.value.code is code
