"""New Gazebo's controllers of single joints: where the joint goes, and how fast."""

import math

import pytest
from tests.coded import coded

from cartwheel.codes import devices, running
from cartwheel.errors import PluginError

INERTIA = 1.0


def arm(plugin, *, limit=""):
    """A beam that turns about the upright, which gravity does not move."""
    return f"""<model name="arm"><link name="base"/><joint name="bolt" type="fixed">
      <parent>world</parent><child>base</child></joint>
      <link name="beam"><inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy>
      <izz>{INERTIA}</izz></inertia></inertial></link>
      <joint name="turn" type="revolute"><parent>base</parent><child>beam</child>
      <axis><xyz>0 0 1</xyz>{limit}</axis></joint>{plugin}</model>"""


def controller(kind, tags, *, joint="<joint_name>turn</joint_name>"):
    return f'<plugin name="p" filename="gz-sim-{kind}-system">{joint}{tags}</plugin>'


def run(make, plugin, seconds, commands=(), *, limit="", reset=False):
    world = make.world(make.sdf(arm(plugin, limit=limit)), ground=None)
    for topic, value in commands:
        world.publish(topic, data=value)
    world.run(seconds)
    if reset:
        world.reset()
        world.run(seconds)
    data = world.session.simulation.data
    return float(data.qpos[0]), float(data.qvel[0])


POSITION = "/model/arm/joint/turn/cmd_pos"
VELOCITY = "/model/arm/joint/turn/cmd_vel"
FORCE = "/model/arm/joint/turn/cmd_force"


@pytest.mark.parametrize("reset", [False, True])
def test_the_pid_swings_as_its_gains_say(make, reset):
    # Critically damped: 1 - (1 + w t) e^(-w t), w = 10 1/s.
    gains = "<p_gain>100</p_gain><i_gain>0</i_gain><d_gain>20</d_gain>"
    plugin = controller(
        "joint-position-controller", gains + "<initial_position>1</initial_position>"
    )
    position, _ = run(make, plugin, 0.2, reset=reset)
    assert position == pytest.approx(1 - 3 * math.exp(-2), abs=0.03)


def test_the_pid_s_force_is_bounded(make):
    tags = "<p_gain>1e4</p_gain><i_gain>0</i_gain><d_gain>0</d_gain><cmd_max>2</cmd_max>"
    plugin = controller("joint-position-controller", tags)
    _, velocity = run(make, plugin, 0.5, [(POSITION, 100.0)])
    assert velocity == pytest.approx(2 / INERTIA * 0.5, rel=0.03)


@pytest.mark.parametrize("gain", [1e4, 2e5, 1e7])
def test_a_high_gain_without_damping_does_not_diverge(make, gain):
    """With an angular frequency of 2/h or more, the force of the position before each step would
    make the oscillation grow."""
    gains = f"<p_gain>{gain}</p_gain><i_gain>0</i_gain><d_gain>0</d_gain><cmd_max>1e9</cmd_max>"
    bounds = "<cmd_min>-1e9</cmd_min>"
    plugin = controller("joint-position-controller", gains + bounds)
    commands = [(POSITION, 0.5)]
    for seconds in (0.005, 0.05, 0.1):
        assert run(make, plugin, seconds, commands)[0] < 0.9
    position, velocity = run(make, plugin, 2.0, commands)
    assert position == pytest.approx(0.5, abs=0.01)
    assert velocity == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize("gain", [150.0, 1e3, 1e6])
def test_a_high_gain_of_a_velocity_does_not_overshoot(make, gain):
    tags = f"<use_force_commands>true</use_force_commands><p_gain>{gain}</p_gain>"
    plugin = controller("joint-controller", tags + "<i_gain>0</i_gain>")
    velocities = [run(make, plugin, seconds, [(VELOCITY, 1.0)])[1] for seconds in (0.05, 1.0)]
    assert velocities == pytest.approx([1.0, 1.0], abs=0.02)


def test_an_integral_bears_a_load(make):
    # The offset pulls with 5 N m; alone, the proportional part would give way by 0.1 rad.
    gains = "<p_gain>50</p_gain><i_gain>100</i_gain><d_gain>14</d_gain><i_max>10</i_max>"
    bounds = "<i_min>-10</i_min><cmd_offset>-5</cmd_offset>"
    plugin = controller("joint-position-controller", gains + bounds)
    position, _ = run(make, plugin, 5.0, [(POSITION, 0.5)])
    assert position == pytest.approx(0.5, abs=0.005)


def test_a_position_by_velocity_goes_no_faster_than_commanded(make):
    tags = "<use_velocity_commands>true</use_velocity_commands><cmd_max>0.5</cmd_max>"
    plugin = controller("joint-position-controller", tags)
    commands = [(POSITION, 1.0)]
    position, velocity = run(make, plugin, 1.0, commands)
    assert position == pytest.approx(0.5, abs=0.01)
    assert velocity == pytest.approx(0.5, rel=0.01)
    assert run(make, plugin, 4.0, commands)[0] == pytest.approx(1.0, abs=0.001)


@pytest.mark.parametrize(
    ("tags", "topic"),
    [
        ("", VELOCITY),
        ("<topic>spin</topic>", "/spin"),
        ("<sub_topic>spin</sub_topic>", "/model/arm/spin"),
        ("<topic>/model/arm/joint/turn/0/cmd_vel</topic>", VELOCITY),
        ("<topic>/arms/2/spin</topic>", "/arms/_2/spin"),
    ],
)
def test_a_velocity_is_held(make, tags, topic):
    plugin = controller("joint-controller", "<initial_velocity>3</initial_velocity>" + tags)
    assert run(make, plugin, 0.5)[1] == pytest.approx(3, rel=1e-3)
    assert run(make, plugin, 0.5, [(topic, -2.0)])[1] == pytest.approx(-2, rel=1e-3)


def test_a_velocity_by_force_rises_as_the_gain_says(make):
    # v = v0 (1 - e^(-p t / I))
    tags = "<use_force_commands>true</use_force_commands><p_gain>2</p_gain>"
    plugin = controller("joint-controller", tags + "<initial_velocity>4</initial_velocity>")
    _, velocity = run(make, plugin, 0.5)
    assert velocity == pytest.approx(4 * (1 - math.exp(-1)), rel=0.02)


def test_a_force_is_given_until_the_next(make):
    plugin = controller("apply-joint-force", "")
    _, velocity = run(make, plugin, 1.0, [(FORCE, 0.7)])
    assert velocity == pytest.approx(0.7 / INERTIA, rel=0.02)


PID = controller("joint-position-controller", "<p_gain>0</p_gain><i_gain>0</i_gain>")
BY_VELOCITY = controller("joint-controller", "")


@pytest.mark.parametrize("order", [1, -1])
def test_a_force_is_added_to_that_of_a_pid_controller(make, order):
    both = "".join((PID, controller("apply-joint-force", ""))[::order])
    world = make.world(make.sdf(arm(both)), ground=None)
    world.publish(FORCE, data=0.7)
    world.run(1.0)
    assert float(world.session.simulation.data.qvel[0]) == pytest.approx(0.7 / INERTIA, rel=0.02)
    assert not coded(world, running.JOINT_DRIVEN_TWICE)
    world.reset()
    world.run(1.0)
    assert float(world.session.simulation.data.qvel[0]) == 0.0


def test_a_force_and_a_velocity_on_one_joint_are_reported(make):
    """gz-sim ignores the velocities of a joint to which forces are applied."""
    both = BY_VELOCITY + controller("apply-joint-force", "")
    world = make.world(make.sdf(arm(both)), ground=None)
    assert coded(world, running.JOINT_DRIVEN_TWICE)


def test_the_topic_of_a_joint_in_a_nested_model_is_a_valid_name(make):
    nested = arm("").replace('name="arm"', 'name="inner"')
    plugin = controller("apply-joint-force", "", joint="<joint_name>inner::turn</joint_name>")
    world = make.world(make.sdf(f'<model name="arm">{nested}{plugin}</model>'), ground=None)
    world.publish("/model/arm/joint/inner__turn/cmd_force", data=0.7)
    world.run(1.0)
    assert float(world.session.simulation.data.qvel[0]) == pytest.approx(0.7 / INERTIA, rel=0.02)


@pytest.mark.parametrize(
    ("plugin", "code"),
    [
        (controller("joint-controller", "", joint=""), devices.PLUGIN_PARAMETER_MISSING),
        (controller("joint-controller", "<cmd_max>-2000</cmd_max>"), devices.PLUGIN_RANGE_REVERSED),
    ],
)
def test_what_makes_no_sense_is_refused(make, plugin, code):
    world = make.world(ground=None)
    with pytest.raises(PluginError) as caught:
        world.session.spawn(make.sdf(arm(plugin)))
    assert caught.value.code is code
    assert caught.value.origin is not None


@pytest.mark.parametrize("kind", ["joint-position-controller", "joint-trajectory-controller"])
def test_a_joint_goes_where_it_is_put_by_hand(make, kind):
    name = "position_{}_gain" if "trajectory" in kind else "{}_gain"
    gains = "".join(f"<{name.format(g)}>{v}</{name.format(g)}>" for g, v in (("p", 100), ("d", 20)))
    world = make.world(make.sdf(arm(controller(kind, gains))), ground=None)
    (taker,) = world.graph.joint_inputs.all()
    assert (taker.model, taker.joints) == ("arm", ("turn",))
    taker.put({"turn": 0.5}, 1.0)
    world.run(3.0)
    assert float(world.session.simulation.data.qpos[0]) == pytest.approx(0.5, abs=0.02)


ACTUATED = "<use_actuator_msg>true</use_actuator_msg><actuator_number>1</actuator_number>"


def actuated(make, kind, tags, topic, **message):
    plugin = controller(kind, tags)
    world = make.world(make.sdf(arm(plugin)), ground=None)
    world.publish(topic, **message)
    world.run(1.0)
    data = world.session.simulation.data
    return float(data.qpos[0]), float(data.qvel[0]), world.diagnostics


@pytest.mark.parametrize(
    ("tags", "topic"),
    [
        ("", "/actuators"),
        ("<sub_topic>motors</sub_topic>", "/model/arm/motors"),
        ("<topic>own/motors</topic>", "/own/motors"),
    ],
)
def test_a_velocity_is_read_from_an_actuators_message(make, tags, topic):
    _, velocity, _ = actuated(
        make, "joint-controller", ACTUATED + tags, topic, velocity=[9.0, 0.5, 9.0]
    )
    assert velocity == pytest.approx(0.5, abs=1e-3)


def test_a_position_is_read_from_an_actuators_message(make):
    tags = ACTUATED + "<use_velocity_commands>true</use_velocity_commands>"
    position, _, _ = actuated(
        make, "joint-position-controller", tags, "/actuators", position=[9.0, 0.5]
    )
    assert position == pytest.approx(0.5, abs=1e-3)


def test_an_actuators_message_without_the_joint_s_value_is_ignored(make):
    _, velocity, found = actuated(make, "joint-controller", ACTUATED, "/actuators", velocity=[9.0])
    assert velocity == pytest.approx(0.0, abs=1e-6)
    (warning,) = [each for each in found if each.code is running.COMMAND_IGNORED]
    assert warning.values["actuator"] == 1


def test_actuators_messages_need_a_number(make):
    tags = "<use_actuator_msg>true</use_actuator_msg>"
    plugin = controller("joint-controller", tags)
    world = make.world(make.sdf(arm(plugin)), ground=None)
    world.publish(VELOCITY, data=0.5)
    world.run(1.0)
    assert float(world.session.simulation.data.qvel[0]) == pytest.approx(0.5, abs=1e-3)
    assert [each.code for each in world.diagnostics] == [devices.PLUGIN_PARAMETER_IGNORED]


@pytest.mark.parametrize(
    ("kind", "tags", "topic"),
    [
        ("joint-controller", "", VELOCITY),
        ("joint-position-controller", "<use_velocity_commands>1</use_velocity_commands>", POSITION),
    ],
)
def test_the_velocity_limit_of_the_joint_applies(make, kind, tags, topic):
    limit = "<limit><velocity>0.5</velocity></limit>"
    position, velocity = run(make, controller(kind, tags), 1.0, [(topic, 2.0)], limit=limit)
    assert velocity == pytest.approx(0.5, rel=0.01)
    assert position == pytest.approx(0.5, rel=0.02)
