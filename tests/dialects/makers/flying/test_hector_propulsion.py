"""hector_quadrotor's propellers and drag: a controller flies with voltages."""

import math

import numpy as np
import pytest
from tests.coded import coded, raises

from cartwheel.codes import devices, running
from cartwheel.devices.air.body_drag import drag
from cartwheel.devices.air.quadrotor_propulsion import PropulsionModel
from cartwheel.errors import PluginError
from cartwheel.messages import from_dict

STEP, MASS, INERTIA, G = 0.004, 1.477, 0.0115, 9.8
MODEL = PropulsionModel()
ARM = MODEL.l_m
PROPULSION = """<plugin name="propulsion" filename="libhector_gazebo_quadrotor_propulsion.so">
  {}</plugin>"""
AERODYNAMICS = """<plugin name="drag" filename="libhector_gazebo_quadrotor_aerodynamics.so">
  {}</plugin>"""


def voltage(thrust):
    """Returns the voltage that holds a thrust in still air, by the equations of the motor."""
    speed = math.sqrt(max(thrust, 0.0) / MODEL.CT0s)
    current = (MODEL.k_t * thrust + MODEL.k_m * speed) / MODEL.Psi
    return (current**2 * MODEL.R_A + current * MODEL.Psi * speed) / (
        current * MODEL.beta_m + MODEL.alpha_m
    )


class Quadrotor:
    """A quadrotor in a world, and a controller that follows velocities."""

    def __init__(self, make, plugins, parameters=None, gravity=G, **options):
        self.world = make.world(step=STEP, gravity=gravity, **options)
        for name, value in (parameters or {}).items():
            self.world.session.graph.parameters.set(name, value)
        self.world.session.spawn(
            make.sdf(f"""<model name="quad"><link name="body"><inertial>
          <mass>{MASS}</mass><inertia><ixx>{INERTIA}</ixx><iyy>{INERTIA}</iyy><izz>0.0218</izz>
          </inertia></inertial><pose>0 0 0.05 0 0 0</pose><collision name="c"><geometry><box>
          <size>0.4 0.4 0.1</size></box></geometry></collision></link>{plugins}</model>""")
        )
        self.free = self.world.session.simulation.data.joint("quad::body")

    def send(self, **fields):
        """Publishes a command: voltages or duty cycles."""
        kind, topic = ("MotorPWM", "/motor_pwm") if "pwm" in fields else (
            "MotorCommand", "/command/motor")  # fmt: skip
        name = f"hector_uav_msgs/msg/{kind}"
        self.world.session.graph.publish(topic, name, from_dict(name, fields))

    def fly(self, seconds, velocity=(0.0, 0.0, 0.0)):
        """Follows a velocity, in steps of the simulation."""
        for _ in range(round(seconds / STEP)):
            w, x, y, z = self.free.qpos[3:7]
            vx, vy, vz = self.free.qvel[:3]
            wx, wy, wz = self.free.qvel[3:6]
            roll = math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
            pitch = math.asin(2 * (w * y - z * x))
            lift = MASS * (G + 4.0 * (velocity[2] - vz)) / 4
            about_x = INERTIA * (40.0 * (-0.2 * (velocity[1] - vy) - roll) - 10.0 * wx)
            about_y = INERTIA * (40.0 * (0.2 * (velocity[0] - vx) - pitch) - 10.0 * wy)
            about_z = 0.0218 * -2.0 * wz
            tilt_x, tilt_y = about_x / (2 * ARM), about_y / (2 * ARM)
            # A motor's torque on the body is about k_t times its thrust.
            turn = about_z / (4 * MODEL.k_t)
            thrusts = [
                lift - tilt_y + turn, lift - tilt_x - turn, lift + tilt_y + turn,
                lift + tilt_x - turn,
            ]  # fmt: skip
            self.send(voltage=[voltage(max(each, 0.05)) for each in thrusts])
            self.world.run(STEP)

    @property
    def position(self):
        return np.array(self.free.qpos[:3])


@pytest.mark.parametrize("drag_plugin", ["", AERODYNAMICS.format("")], ids=["vacuum", "drag"])
def test_it_takes_off_hovers_follows_velocities_and_lands(make, drag_plugin):
    quad = Quadrotor(make, PROPULSION.format("") + drag_plugin)
    quad.world.run(0.5)
    assert quad.position[2] == pytest.approx(0.05, abs=0.005)
    quad.fly(4.0, (0.0, 0.0, 0.5))
    assert quad.position[2] > 1.5
    quad.fly(2.0)
    hover = quad.position
    quad.fly(1.0)
    assert quad.position == pytest.approx(hover, abs=0.1)
    quad.fly(4.0, (0.5, -0.3, 0.0))
    assert quad.free.qvel[:2] == pytest.approx([0.5, -0.3], abs=0.08)
    quad.fly(quad.position[2] / 0.5 + 1.0, (0.0, 0.0, -0.5))
    quad.send(voltage=[0.0] * 4)
    quad.world.run(1.0)
    assert quad.position[2] == pytest.approx(0.05, abs=0.005)


def test_propellers_hover_at_the_speed_of_the_equations(make):
    quad = Quadrotor(make, PROPULSION.format(""))
    states = quad.world.mailbox("/motor_status", size=10_000)
    quad.fly(6.0, (0.0, 0.0, 0.3))
    quad.fly(4.0)
    state = states.drain()[-1]
    assert (state.on, state.running) == (True, True)
    # Four thrusts carry the weight: 4 CT0s ω² = m g.
    assert state.frequency == pytest.approx([math.sqrt(MASS * G / 4 / MODEL.CT0s)] * 4, rel=0.02)
    assert state.voltage == pytest.approx([voltage(MASS * G / 4)] * 4, abs=0.1)


@pytest.mark.parametrize(
    ("pwm", "axis", "sign"),
    [
        ([200, 100, 100, 100], 4, -1),
        ([100, 200, 100, 100], 3, -1),
        ([100, 100, 200, 100], 4, 1),
        ([100, 100, 100, 200], 3, 1),
        ([150, 100, 150, 100], 5, 1),
    ],
)
def test_each_propeller_turns_the_body_its_way(make, pwm, axis, sign):
    quad = Quadrotor(make, PROPULSION.format(""), gravity=0.0, ground=None)
    quad.send(pwm=pwm)
    quad.world.run(0.1)
    rates = np.array(quad.free.qvel[:6])
    assert sign * rates[axis] > 0.01
    others = [each for each in (3, 4) if each != axis]
    # The body also turns about z, which couples the other axes.
    assert np.abs(rates[others]).max() < 0.1 * abs(rates[axis])


def test_a_command_with_too_few_motors_is_ignored(make):
    quad = Quadrotor(make, PROPULSION.format(""))
    quad.send(voltage=[10.0] * 3)
    quad.world.run(1.0)
    assert coded(quad.world, running.COMMAND_IGNORED, motors=3)
    assert quad.position[2] == pytest.approx(0.05, abs=0.005)


def test_parameters_are_read_from_the_server(make):
    strong = {"/quadrotor_propulsion/CT0s": 3e-5, "/quadrotor_propulsion/supply_voltage": 12.0}
    quad = Quadrotor(make, PROPULSION.format(""), strong)
    supplies = quad.world.mailbox("/supply")
    wrenches = quad.world.mailbox("/propulsion/wrench", size=10_000)
    states = quad.world.mailbox("/motor_status", size=10_000)
    quad.send(pwm=[60] * 4)
    quad.world.run(1.5)
    assert supplies.drain()[0].voltage == pytest.approx([12.0])
    speeds = states.drain()[-1].frequency
    # It stands on the ground, so there is no upward velocity.
    assert wrenches.drain()[-1].wrench.force.z == pytest.approx(sum(3e-5 * speeds**2), rel=0.01)


@pytest.mark.parametrize("value", [0.0, -1.0, "much", True])
def test_wrong_parameters_are_errors(make, value):
    with raises(devices.PLUGIN_PARAMETER_INVALID, PluginError):
        Quadrotor(make, PROPULSION.format(""), {"/quadrotor_propulsion/J_M": value})


def test_drag_limits_the_speed_of_a_fall(make):
    quad = Quadrotor(make, AERODYNAMICS.format(""), ground=None)
    quad.world.run(20.0)
    # C v² = m g
    assert quad.free.qvel[2] == pytest.approx(-math.sqrt(MASS * G / 0.1), rel=0.01)


def test_wind_takes_a_body_along(make):
    quad = Quadrotor(make, AERODYNAMICS.format(""), gravity=0.0, ground=None)
    quad.world.publish("/wind", x=2.0, y=0.0, z=0.0)
    quad.world.run(1.0)
    # dv/dt = C/m (u - v)², which begins at 0.
    k = 0.12 / MASS
    assert quad.free.qvel[0] == pytest.approx(2.0 - 2.0 / (1 + 2.0 * k * 1.0), rel=0.02)


def test_drag_never_reverses_a_motion():
    for speed in (1.0, 1e3, 1e9):
        (force, _, _) = drag((speed, 0.0, 0.0), (5.0, 0.0, 0.0), (0.01,) * 3, 0.005)
        assert -min(speed, 100.0) * 0.01 <= force * 0.005 < 0.0
