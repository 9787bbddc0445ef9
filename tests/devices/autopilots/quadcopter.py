"""A quadcopter for tests of autopilots, and a simple controller that flies it."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest

from cartwheel.codes import wires

BODY, ROTOR, ARM = 1.5, 0.02, 0.2
SPIN = 2e-4
"""Moment of inertia of a rotor about its axis, kg m²."""
AREA, RADIUS, SLOPE, ANGLE, DENSITY = 0.002, 0.08, 4.0, 0.3, 1.2
FASTEST = 800.0
STEP = 0.004
K = DENSITY * RADIUS**2 * AREA * SLOPE * ANGLE
"""Thrust of a rotor with two blades divided by the square of its speed, N s²."""
WEIGHT = (BODY + 4 * ROTOR) * 9.8
INERTIA = 0.02
PLACES = [(ARM, -ARM), (-ARM, ARM), (ARM, ARM), (-ARM, -ARM)]
"""x and y of the rotors in m: front right, back left, front left, back right."""
SENSES = (1, 1, -1, -1)
"""Directions of rotation, seen from above: counterclockwise is 1."""

IMU = '<sensor name="imu" type="imu"><pose>0 0 0 3.141592653589793 0 0</pose></sensor>'
"""Its axes are forward, right, down."""


def blades() -> str:
    """Returns two blades for each rotor."""
    return "".join(
        f"""<plugin name="blade{n}{side}" filename="gz-sim-lift-drag-system">
        <link_name>rotor_{n}</link_name><area>{AREA}</area><air_density>{DENSITY}</air_density>
        <a0>{ANGLE}</a0><cla>{SLOPE}</cla><cda>0.4</cda><alpha_stall>1.4</alpha_stall>
        <cp>{side * RADIUS} 0 0</cp><forward>0 {side * SENSES[n]} 0</forward>
        <upward>0 0 1</upward></plugin>"""
        for n in range(4)
        for side in (1, -1)
    )


def controls() -> str:
    """Returns a channel for each rotor."""
    return "".join(
        f"""<control channel="{n}"><jointName>rotor_{n}_joint</jointName><type>VELOCITY</type>
        <multiplier>{SENSES[n] * FASTEST}</multiplier><servo_min>1100</servo_min>
        <servo_max>1900</servo_max><p_gain>0.05</p_gain><cmd_max>2</cmd_max>
        <cmd_min>-2</cmd_min></control>"""
        for n in range(4)
    )


def quadcopter(make, plugins, sensors=IMU):
    """Returns a quadcopter that stands on the ground at the origin and faces along x."""
    rotors = "".join(
        f"""<link name="rotor_{n}"><pose>{x} {y} 0.05 0 0 0</pose><inertial><mass>{ROTOR}</mass>
        <inertia><ixx>{SPIN / 2}</ixx><iyy>{SPIN / 2}</iyy><izz>{SPIN}</izz></inertia></inertial>
        </link><joint name="rotor_{n}_joint" type="continuous"><parent>body</parent>
        <child>rotor_{n}</child><axis><xyz>0 0 1</xyz></axis></joint>"""
        for n, (x, y) in enumerate(PLACES)
    )
    return make.sdf(f"""<model name="drone"><link name="body"><inertial><mass>{BODY}</mass>
      <inertia><ixx>{INERTIA}</ixx><iyy>{INERTIA}</iyy><izz>{2 * INERTIA}</izz></inertia></inertial>
      <pose>0 0 0.05 0 0 0</pose>
      <collision name="c"><geometry><box><size>0.4 0.4 0.1</size></box></geometry></collision>
      {sensors}</link>{rotors}{plugins}</model>""")


def position(world):
    """Returns the position of the body in the world, m."""
    return np.array(world.session.simulation.data.joint("drone::body").qpos[:3])


@dataclass
class Motion:
    """State of the vehicle, with axes forward, right, down, and north, east, down."""

    seconds: float
    rates: np.ndarray
    quaternion: np.ndarray
    """w, x, y, z."""
    position: np.ndarray
    velocity: np.ndarray


def planned(seconds: float) -> tuple[float, float]:
    """Returns the height in m and its rate: up to 2 m in 3 s, 4 s of hovering, down in 4 s."""
    if seconds < 3.0:
        return seconds / 1.5, 1 / 1.5
    if seconds < 7.0:
        return 2.0, 0.0
    return max(2.0 - (seconds - 7.0) / 2, -0.5), -0.5


LANDED = 12.5
"""Time in s at which the motors are off."""


def outputs(motion: Motion) -> list[float]:
    """Returns the speed of each rotor as a fraction of `FASTEST`, to follow the plan."""
    height, climb = planned(motion.seconds)
    if motion.seconds > LANDED - 0.5:
        return [0.0] * 4
    below = height + motion.position[2]
    slower = climb + motion.velocity[2]
    thrust = WEIGHT + BODY * (6.0 * below + 5.0 * slower)
    w, x, y, z = motion.quaternion
    # Small tilts towards the start position.
    roll = math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y))
    pitch = math.asin(max(-1.0, min(1.0, 2 * (w * y - z * x))))
    yaw = math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))
    north, east = (-0.1 * motion.position - 0.15 * motion.velocity)[:2]
    ahead = math.cos(yaw) * north + math.sin(yaw) * east
    right = math.cos(yaw) * east - math.sin(yaw) * north
    about_x = INERTIA * (60.0 * (right - roll) - 12.0 * motion.rates[0])
    about_y = INERTIA * (60.0 * (-ahead - pitch) - 12.0 * motion.rates[1])
    lifts = []
    for forward, left in PLACES:
        lift = thrust / 4 + (about_x * left + about_y * forward) / (4 * ARM * ARM)
        lifts.append(max(0.0, lift))
    return [min(1.0, math.sqrt(lift / K) / FASTEST) for lift in lifts]


def reported(world, code):
    """Returns the diagnostics with a code."""
    return [each for each in world.diagnostics if each.code == code]


def check_flight(world):
    """Runs until the quadcopter has landed, and checks that it hovered on the way."""
    hover = []
    while world.time < LANDED:
        world.run(0.1)
        if 5.0 < world.time < 7.0:
            hover.append(position(world))
    assert np.abs(np.array(hover) - [0.0, 0.0, 2.05]).max() < 0.2
    x, y, z = position(world)
    assert z == pytest.approx(0.05, abs=0.01)
    assert abs(x) < 0.3
    assert abs(y) < 0.3


def check_loss(world):
    """Runs without the autopilot: it is reported as lost, and the quadcopter falls."""
    before = world.time
    world.run(2.0)
    (lost,) = reported(world, wires.AUTOPILOT_LOST)
    assert lost.values["address"].startswith("127.0.0.1:")
    assert world.time == pytest.approx(before + 2.0)
    assert position(world)[2] < 0.5
