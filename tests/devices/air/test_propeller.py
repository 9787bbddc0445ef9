"""Propellers: forces and moments at each speed, and the speed after a command."""

import math

import numpy as np
import pytest
from tests.coded import coded
from tests.devices.air.multicopters import (
    ARM,
    DOWN,
    HOVER,
    INERTIA,
    MASS,
    MOMENT,
    ROTOR,
    TOPICS,
    UP,
    G,
    K,
    bee,
    climb,
    command,
    fly,
    motor,
    velocity,
)  # fmt: skip

from cartwheel.codes import devices, running
from cartwheel.devices.air.propeller import (
    ACTUATORS,
    PropellerConfig,
    loads,
    next_speed,
    thrust_of,
)
from cartwheel.errors import PluginError
from cartwheel.geometry import Pose


def config(**changes):
    values = {
        "joint": "j", "link": "l", "counterclockwise": True, "command_topic": "c",
        "command_type": ACTUATORS, "number": 0, "max_speed": 100.0, "rise_time": UP,
        "fall_time": DOWN, "slowdown": 10.0, "thrust": 2.0, "thrust_sign": "direction",
        "moment": 0.5, "drag": 0.1, "rolling": 0.01,
    }  # fmt: skip
    return PropellerConfig(**{**values, **changes})


@pytest.mark.parametrize(
    ("sign", "counterclockwise", "speed", "expected"),
    [
        ("direction", True, 3.0, 18.0),
        ("direction", False, -3.0, 18.0),
        ("direction", False, 3.0, -18.0),
        ("joint", False, -3.0, -18.0),
        ("up", False, -3.0, 18.0),
    ],
)
def test_the_thrust_is_upwards_as_its_sign_says(sign, counterclockwise, speed, expected):
    each = config(thrust_sign=sign, counterclockwise=counterclockwise)
    assert thrust_of(each, speed, 7.0) == (expected, 1.0)


@pytest.mark.parametrize(("along", "remaining"), [(0.0, 1.0), (-5.0, 0.75), (30.0, 0.0)])
def test_the_thrust_decreases_with_the_velocity_along_the_axis(along, remaining):
    assert thrust_of(config(max_airspeed=20.0), 1.0, along) == (2.0, remaining)


def test_drag_and_rolling_moment_act_against_the_velocity_across_the_axis():
    up = np.array([0.0, 0.0, 1.0])
    velocity = np.array([3.0, 0.0, 4.0])
    force, torque = loads(config(), speed=-2.0, velocity=velocity, axis=up, up=up)
    assert force == pytest.approx([-0.6, 0.0, -8.0])
    assert torque == pytest.approx([-0.06, 0.0, 4.0])


def test_a_speed_rises_and_falls_with_its_own_time_constant():
    assert next_speed(0.0, 10.0, UP, UP, DOWN) == pytest.approx(10 * (1 - math.exp(-1)))
    assert next_speed(10.0, 0.0, DOWN, UP, DOWN) == pytest.approx(10 * math.exp(-1))


@pytest.mark.parametrize("constant", [0.0, 1e-320, 1e-10])
def test_a_speed_without_a_time_constant_changes_at_once(constant):
    assert next_speed(0.0, 10.0, 0.005, constant, DOWN) == 10.0
    assert next_speed(10.0, 1.0, 0.005, UP, constant) == 1.0


def test_many_propellers_have_the_bits_of_one():
    speeds, targets, along = np.random.default_rng(2).normal(0, 50, (3, 100))
    each = config(max_airspeed=60.0, counterclockwise=False)
    many = next_speed(speeds, targets, 0.005, UP, DOWN)
    thrust, remaining = thrust_of(each, speeds, along)
    for i in range(100):
        assert many[i] == next_speed(float(speeds[i]), float(targets[i]), 0.005, UP, DOWN)
        one = thrust_of(each, float(speeds[i]), float(along[i]))
        assert (thrust[i], remaining[i]) == one


@pytest.mark.parametrize("kind", ["rotors", "px4", "gz"])
def test_propellers_push_by_the_square_of_their_speed(make, kind):
    """Free fall at rest; the weight borne at one speed, and twice of it at √2 times that."""
    world = fly(make, kind)
    assert climb(world, 0.2) == pytest.approx(-G, rel=1e-6)
    command(world, [HOVER] * 4, kind)
    world.run(15 * UP)
    fades = 1.0
    for factor in (1.0, math.sqrt(2)):
        command(world, [factor * HOVER] * 4, kind)
        world.run(15 * UP)
        speed = abs(velocity(world, 2))
        if kind == "px4":
            fades = 1 - speed / 25
        # The thrust of PX4's fades with the speed, which changes meanwhile by some 1 m/s.
        error = 0.5 if kind == "px4" else 0.02
        assert climb(world, 0.1) == pytest.approx(G * (factor**2 * fades - 1), abs=error)


def test_a_quadrotor_hovers_level_at_its_speed(make):
    world = fly(make)
    command(world, [HOVER] * 4)
    world.run(1.0)
    sunk = velocity(world, 2)
    # The impulse that is missing while the motors speed up: 1 - w² over the time, w = 1 - e^(-t/τ),
    # and while a command becomes a speed and that a thrust, which are steps of their own.
    step = world.session.simulation.step_ns * 1e-9
    assert -G * (1.5 * UP + 3 * step) < sunk < -G * 1.5 * UP
    world.run(2.0)
    model = world.model("bee")
    assert velocity(world, 2) == pytest.approx(sunk, abs=0.02)
    assert model.pose.rpy == pytest.approx((0, 0, 0), abs=1e-3)


def test_propellers_that_turn_one_way_turn_the_body_the_other(make):
    """Two faster, two slower, of the same thrust in all: torque 4 m k a w² about the vertical."""
    share = 0.1
    world = fly(make)
    command(world, [HOVER] * 4)
    world.run(15 * UP)
    fast, slow = HOVER * math.sqrt(1 + share), HOVER * math.sqrt(1 - share)
    command(world, [fast, slow, fast, slow])
    world.run(15 * DOWN)
    before = velocity(world, 5)
    world.run(0.4)
    gained = velocity(world, 5) - before
    torque = 4 * share * MOMENT * K * HOVER**2
    inertia = INERTIA + 4 * ROTOR * ARM**2
    # Those that turn counter-clockwise, 0 and 2, are the faster: the body goes clockwise.
    assert gained / 0.4 == pytest.approx(-torque / inertia, rel=0.02)


def test_speeds_approach_a_command_with_two_time_constants(make):
    world = fly(make)
    reported = world.mailbox("/bee/motor_speed/_0", size=10_000)
    step = world.session.simulation.step_ns * 1e-9
    command(world, [100, 0, 0, 0])
    world.run(0.2)
    up = [message.data * 10 for message in reported.drain()]
    command(world, [0, 0, 0, 0])
    world.run(0.2)
    down = [message.data * 10 for message in reported.drain()]
    # The joint's speed is published after a step, but set before it.
    count = round(UP / step)
    assert up[count] == pytest.approx(100 * (1 - math.exp(-count * step / UP)), abs=100 * step / UP)
    assert up[-1] == pytest.approx(100, abs=0.1)
    count = round(DOWN / step)
    assert down[count] == pytest.approx(100 * math.exp(-count * step / DOWN), abs=100 * step / DOWN)


def test_a_propeller_that_moves_across_the_air_is_held_back(make):
    """Deceleration 4 w c v / m along x, whatever the height: speeds fall as e^(-t / τ)."""
    drag = 4e-4
    world = make.world()
    tags = f"<rotorDragCoefficient>{drag}</rotorDragCoefficient>"
    plugins = "".join(
        motor(n).replace("<rotorDragCoefficient>0</rotorDragCoefficient>", tags) for n in range(4)
    )
    push = """<plugin name="push" filename="libgazebo_ros_force.so"><bodyName>body</bodyName>
      <topicName>push</topicName></plugin>"""
    world.session.spawn(bee(make, plugins + push), pose=Pose((0, 0, 50)))
    command(world, [HOVER] * 4)
    world.run(15 * UP)
    world.publish("/push", force_x=3.0)
    world.run(0.5)
    world.publish("/push", force_x=0.0)
    world.run(0.02)
    before = velocity(world, 0)
    world.run(0.5)
    left = velocity(world, 0) / before
    rate = 4 * HOVER * drag / MASS
    assert before > 0.5
    assert left == pytest.approx(math.exp(-0.5 * rate), rel=0.01)


def test_px4s_reversible_propeller_pushes_down_and_the_others_never(make):
    for reversible, sign in ((True, -1), (False, 1)):
        tags = f"<reversible>{str(reversible).lower()}</reversible>"
        world = make.world()
        plugins = "".join(motor(n, "px4", tags, direction="ccw") for n in range(4))
        world.session.spawn(bee(make, plugins), pose=Pose((0, 0, 30)))
        command(world, [-HOVER] * 4, "px4")
        world.run(15 * DOWN)
        fades = 1 - abs(velocity(world, 2)) / 25
        assert climb(world, 0.05) == pytest.approx(G * (sign * fades - 1), abs=0.5)


def test_a_command_for_fewer_motors_is_ignored_and_reported(make):
    world = fly(make)
    command(world, [HOVER, HOVER])
    world.run(0.1)
    reported = coded(world, running.COMMAND_IGNORED, speeds=2)
    assert len(reported) == 2


def test_new_gazebos_motor_listens_under_the_models_name_by_default(make):
    plugin = motor(0, "gz").replace("<robotNamespace>bee</robotNamespace>", "")
    world = make.world(bee(make, plugin.replace("gazebo/command/motor_speed", "command/speed")))
    assert world.graph.topic("/bee/command/speed").type == "actuator_msgs/msg/Actuators"


@pytest.mark.parametrize(
    ("old", "new", "parameter"),
    [
        ("<timeConstantUp>0.02", "<timeConstantUp>-0.1", "timeConstantUp"),
        ("<motorNumber>0", "<motorNumber>-1", "motorNumber"),
        (">ccw<", ">left<", "turningDirection"),
    ],
)
def test_what_no_motor_can_be_is_an_error(make, old, new, parameter):
    with pytest.raises(PluginError) as caught:
        make.world(bee(make, motor(0).replace(old, new)))
    assert caught.value.code is devices.PLUGIN_PARAMETER_INVALID
    assert caught.value.values["parameter"] == parameter


def test_a_motor_with_another_command_than_a_speed_is_ignored_and_reported(make):
    world = make.world(bee(make, motor(0, tags="<motorType>position</motorType>")))
    assert coded(world, devices.PLUGIN_PARAMETER_UNSUPPORTED, value="position")
    assert not any(topic.name == TOPICS["rotors"][0] for topic in world.graph.topics())
