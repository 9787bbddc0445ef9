"""A quadrotor with gz-sim's velocity control flies, turns and stops as commanded."""

import math

import numpy as np
import pytest
from tests.coded import coded, raises
from tests.devices.air.multicopters import MOMENT, K, bee, motor, velocity

from cartwheel.codes import devices, robot, running, world
from cartwheel.devices.air.geometric_control import RotorConfig, allocation, controls_all
from cartwheel.errors import PluginError, UnknownNameError
from cartwheel.geometry import Pose

ROTOR = (
    "<rotor><jointName>rotor_{n}_joint</jointName><forceConstant>{force}</forceConstant>"
    "<momentConstant>{moment}</momentConstant><direction>{direction}</direction></rotor>"
)
GAINS = (
    "<velocityGain>3 3 3</velocityGain><attitudeGain>1.5 1.5 0.2</attitudeGain>"
    "<angularRateGain>0.3 0.3 0.1</angularRateGain>"
)


def rotor(n, **changed):
    given = {"n": n, "force": K, "moment": MOMENT, "direction": -1 if n % 2 else 1, **changed}
    return ROTOR.format(**given)


def control(*, tags="", rotors=None, gains=GAINS, name="gz-sim-multicopter-control-system"):
    listed = "".join(map(rotor, range(4))) if rotors is None else rotors
    return (
        f'<plugin name="control" filename="{name}"><robotNamespace>bee</robotNamespace>'
        f"<comLinkName>body</comLinkName>{gains}{tags}"
        f"<rotorConfiguration>{listed}</rotorConfiguration></plugin>"
    )


LOAD = (
    '<link name="load"><pose>{x} {y} 0 0 0 0</pose><inertial><mass>0.1</mass><inertia>'
    "<ixx>1e-4</ixx><iyy>1e-4</iyy><izz>1e-4</izz></inertia></inertial></link>"
    '<joint name="load_joint" type="fixed"><parent>body</parent><child>load</child></joint>'
)


class Copter:
    def __init__(self, make, *, motors=4, load="", **given):
        plugins = "".join(motor(n, "gz") for n in range(motors)) + control(**given)
        self.world = make.world()
        self.world.session.spawn(bee(make, plugins + load), pose=Pose((0, 0, 10)))

    def fly(self, seconds, x=0.0, y=0.0, z=0.0, *, turn=0.0):
        self.world.publish("/bee/cmd_vel", linear_x=x, linear_y=y, linear_z=z, angular_z=turn)
        self.world.run(seconds)

    @property
    def motion(self):
        return np.array([velocity(self.world, axis) for axis in range(6)])

    @property
    def pose(self):
        return self.world.model("bee").pose


@pytest.mark.parametrize("wanted", [(0.0, 0.0, 0.6), (0.5, 0.0, 0.0), (0.0, -0.5, 0.3)])
def test_it_flies_at_the_commanded_velocity(make, wanted):
    made = Copter(make)
    made.fly(6.0, *wanted)
    assert made.motion[:3] == pytest.approx(wanted, abs=0.025)
    begin = made.pose.position
    made.world.run(2.0)
    moved = np.array(made.pose.position) - begin
    assert moved == pytest.approx(2 * np.array(wanted), abs=0.05)


@pytest.mark.parametrize(("x", "y"), [(0.1, 0.0), (0.0, -0.1)])
def test_a_multicopter_with_a_load_at_one_end_drifts_as_reported(make, x, y):
    """With the weight G, the gains a and k and the centre of mass at c: G² c / (a k)."""
    made = Copter(make, load=LOAD.format(x=x, y=y))
    weight = 9.8 * (1.5 + 4 * 0.01 + 0.1)
    made.fly(8.0)
    (found,) = coded(made.world, robot.UNBALANCED, link="body")
    drift = weight**2 * (0.1 * 9.8 / weight) * np.array([x, y]) / (1.5 * 3)
    assert found.values["drift"] == pytest.approx(drift)
    # The equation is that of small angles; here, the error of the orientation is 0.07 rad.
    assert made.motion[:2] == pytest.approx(drift, abs=0.02)
    even = Copter(make)
    even.fly(0.1)
    assert not coded(even.world, robot.UNBALANCED)


def test_it_hovers_and_turns(make):
    made = Copter(make)
    made.fly(3.0, turn=0.5)
    yaw = made.pose.yaw
    place = made.pose.position
    made.world.run(2.0)
    assert math.remainder(made.pose.yaw - yaw, 2 * math.pi) == pytest.approx(1.0, rel=0.05)
    assert made.pose.position == pytest.approx(place, abs=0.03)


def test_velocities_are_those_in_its_own_axes(make):
    made = Copter(make)
    made.fly(math.pi / 2, turn=1.0)
    made.fly(6.0, 0.5)
    yaw = made.pose.yaw
    assert abs(yaw) > 1.0
    assert made.motion[:2] == pytest.approx((0.5 * math.cos(yaw), 0.5 * math.sin(yaw)), abs=0.03)


def test_it_falls_before_the_first_command_and_while_it_is_off(make):
    made = Copter(make)
    made.world.run(0.5)
    assert made.motion[2] == pytest.approx(-4.9, rel=0.05)
    made.fly(5.0)
    assert made.motion[2] == pytest.approx(0.0, abs=0.05)
    made.world.publish("/bee/enable", data=False)
    made.world.run(0.5)
    assert made.motion[2] < -3.0
    # Switched on again, it waits for a command.
    made.world.publish("/bee/enable", data=True)
    before = made.motion[2]
    made.world.run(0.2)
    assert made.motion[2] == pytest.approx(before - 9.8 * 0.2, rel=0.05)
    made.fly(5.0)
    assert made.motion[2] == pytest.approx(0.0, abs=0.05)


def test_limits_bind(make):
    tags = (
        "<maximumLinearVelocity>0.2 1 1</maximumLinearVelocity>"
        "<maximumLinearAcceleration>1 1 0.5</maximumLinearAcceleration>"
    )
    made = Copter(make, tags=tags)
    made.fly(6.0, 1.0)
    assert made.motion[0] == pytest.approx(0.2, abs=0.02)
    made.fly(0.5, 0.0, 0.0, 5.0)
    assert made.motion[2] == pytest.approx(0.25, abs=0.06)


def test_noise_moves_it_and_is_the_same_each_time(make):
    tags = "<linearVelocityNoiseStdDev>0 0 0.5</linearVelocityNoiseStdDev>"
    ended = []
    for _ in range(2):
        made = Copter(make, tags=tags)
        made.fly(2.0)
        ended.append((made.pose.position, made.motion.tolist()))
    assert ended[0] == ended[1]
    silent = Copter(make)
    silent.fly(2.0)
    assert abs(ended[0][1][2] - silent.motion[2]) > 1e-3


def test_the_speeds_are_published_for_the_motors(make):
    made = Copter(make)
    box = made.world.mailbox("/bee/gazebo/command/motor_speed", size=10)
    made.fly(3.0)
    speeds = box.drain()[-1].velocity
    weight = 9.8 * (1.5 + 0.04)
    assert K * float(np.square(speeds).sum()) == pytest.approx(weight, rel=0.01)


def test_a_reset_stops_it(make):
    made = Copter(make)
    made.fly(1.0)
    made.world.reset()
    made.world.run(0.5)
    assert made.motion[2] == pytest.approx(-4.9, rel=0.05)


def test_old_names_are_understood(make):
    made = Copter(make, name="ignition-gazebo-multicopter-control-system")
    made.fly(3.0)
    assert made.motion[2] == pytest.approx(0.0, abs=0.05)


def test_without_motors_it_is_reported(make):
    made = Copter(make, motors=0)
    assert coded(made.world, devices.PLUGIN_IDLE)


@pytest.mark.parametrize(
    ("given", "code", "name"),
    [
        ({"rotors": "".join(map(rotor, range(3)))}, devices.PLUGIN_PARAMETER_INVALID,
         "rotorConfiguration"),
        ({"rotors": rotor(0, direction=2)}, devices.PLUGIN_PARAMETER_INVALID, "direction"),
        ({"rotors": rotor(0, force=0)}, devices.PLUGIN_PARAMETER_INVALID, "forceConstant"),
        ({"gains": ""}, devices.PLUGIN_PARAMETER_MISSING, None),
    ],
)  # fmt: skip
def test_bad_parameters_are_reported(make, given, code, name):
    with raises(code, PluginError, **({"parameter": name} if name else {})):
        Copter(make, **given)


def test_unknown_names_are_reported(make):
    with raises(devices.PLUGIN_JOINT_UNKNOWN, UnknownNameError):
        Copter(make, rotors="".join(map(rotor, range(5))))
    plugin = control().replace("<comLinkName>body<", "<comLinkName>head<")
    with raises(running.UNKNOWN_LINK, UnknownNameError):
        make.world().session.spawn(bee(make, plugin))


def test_propellers_on_a_line_cannot_turn_it_about_that_line():
    line = [
        RotorConfig(place=(x, 0.0), thrust=1e-5, moment=0.02, counterclockwise=bool(n % 2))
        for n, x in enumerate((-0.4, -0.2, 0.2, 0.4))
    ]
    assert not controls_all(line)
    assert allocation(line)[0] == pytest.approx(0.0)


FAST = GAINS.replace("0.3 0.3 0.1", "{k} {k} 0.1")


@pytest.mark.parametrize(("change", "milliseconds"), [(0.4, 5), (0.6, 1)])
def test_a_fast_loop_gets_the_step_of_gazebo(make, change, milliseconds):
    """A step of 5 ms may change the angular velocity by a half of its error: k T / I = 0.5."""
    inertia = bee(make, "").link("body").inertial.ixx
    made = Copter(make, gains=FAST.format(k=change * inertia / 0.005))
    simulation = made.world.session.simulation
    assert simulation.step_ns == milliseconds * 1_000_000
    reported = coded(made.world, world.STEP_SHORTENED)
    assert len(reported) == (milliseconds == 1)
    made.fly(0.1)
    simulation.delete("bee")
    assert simulation.step_ns == 5_000_000
    made.world.run(0.1)
    assert simulation.time_ns == 200_000_000


def test_the_step_of_the_world_stays(make):
    inertia = bee(make, "").link("body").inertial.ixx
    plugins = "".join(motor(n, "gz") for n in range(4)) + control(
        gains=FAST.format(k=200 * inertia)
    )
    made = make.world(step=0.004)
    made.session.spawn(bee(make, plugins))
    assert made.session.simulation.step_ns == 4_000_000
    assert coded(made, world.STEP_SHORTENED) == []
