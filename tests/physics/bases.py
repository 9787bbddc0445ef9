"""Mobile bases whose motion in Gazebo 11.1 is recorded in ``gazebo_turning.json``."""

import math
from dataclasses import dataclass, replace

RADIUS = 0.1
"""Of all wheels, m."""
BOX = (0.4, 0.28, 0.1)
"""Size of the chassis of a base with two wheels, m."""


@dataclass(frozen=True)
class Base:
    """A base of links and joints in SDF, without plugins."""

    links: str
    left: tuple[str, ...]
    """Names of the driven joints."""
    right: tuple[str, ...]
    track: float
    """Distance between the driven wheels, m."""
    torque: float = 20.0
    """Of each motor, N m."""


def _inertial(mass, size, place=(0.0, 0.0)):
    x, y, z = (mass * each**2 / 12 for each in size)
    return f"""<inertial><pose>{place[0]} 0 {place[1]} 0 0 0</pose><mass>{mass}</mass><inertia>
      <ixx>{y + z:.8g}</ixx><iyy>{x + z:.8g}</iyy><izz>{x + y:.8g}</izz></inertia></inertial>"""


def _surface(mu):
    """A surface with a friction coefficient; None states none."""
    if mu is None:
        return ""
    return f"<surface><friction><ode><mu>{mu}</mu><mu2>{mu}</mu2></ode></friction></surface>"


def _chassis(size, mass, *, height=0.0, mu=None, ball=None, centre=0.0):
    """A box whose middle is `height` above the axles; `ball` is x and mu of a fixed caster."""
    x, y, z = size
    caster = ""
    if ball is not None:
        caster = f"""<collision name="ball"><pose>{ball[0]} 0 {0.04 - RADIUS} 0 0 0</pose><geometry>
          <sphere><radius>0.04</radius></sphere></geometry>{_surface(ball[1])}</collision>"""
    return f"""<link name="base"><pose>0 0 {RADIUS} 0 0 0</pose>
      {_inertial(mass, size, (centre, height))}<collision name="box">
      <pose>0 0 {height} 0 0 0</pose><geometry><box><size>{x} {y} {z}</size></box></geometry>
      {_surface(mu)}</collision>{caster}</link>"""


def _wheel(name, x, y, mu, *, width=0.05, shape="cylinder", parent="base"):
    tyre = f"<sphere><radius>{RADIUS}</radius></sphere>"
    if shape == "cylinder":
        tyre = f"<cylinder><radius>{RADIUS}</radius><length>{width}</length></cylinder>"
    across = 0.5 * (3 * RADIUS**2 + width**2) / 12
    return f"""<link name="{name}"><pose relative_to="base">{x} {y} 0 {-math.pi / 2} 0 0</pose>
      <inertial><mass>0.5</mass><inertia><ixx>{across:.8g}</ixx><iyy>{across:.8g}</iyy>
      <izz>{0.5 * RADIUS**2 / 2}</izz></inertia></inertial><collision name="tyre">
      <geometry>{tyre}</geometry>{_surface(mu)}</collision></link>
      <joint name="{name}_joint" type="revolute"><parent>{parent}</parent><child>{name}</child>
      <axis><xyz>0 0 1</xyz></axis></joint>"""


def two_wheels(mu=1.0, caster=0.0, *, share=0.25, **wheel):
    """10 kg on two wheels and a fixed ball in front, which carries a share of the chassis."""
    front, rear, track = 0.15, -0.12, 0.36
    centre = rear + share * (front - rear)
    links = _chassis(BOX, 10, ball=(front, caster), centre=centre)
    for name, y in (("left", track / 2), ("right", -track / 2)):
        links += _wheel(name, rear, y, mu, **wheel)
    return Base(links, ("left_joint",), ("right_joint",), track)


def low(mu, chassis=None, *, centre=0.0):
    """10 kg on two wheels in the middle, with the chassis 1 mm above the ground."""
    height, track = 0.001 - RADIUS + BOX[2] / 2, 0.36
    links = _chassis(BOX, 10, height=height, mu=chassis, centre=centre)
    for name, y in (("left", track / 2), ("right", -track / 2)):
        links += _wheel(name, 0, y, mu, width=0.04)
    return Base(links, ("left_joint",), ("right_joint",), track)


def skid_steer(ratio, mu=1.0, *, shape="cylinder", track=0.4):
    """20 kg on four driven wheels; `ratio` is the track divided by the wheelbase."""
    half = track / ratio / 2
    links = _chassis((2 * half + 0.1, track - 0.07, 0.1), 20)
    for end, x in (("front", half), ("rear", -half)):
        for side, y in (("left", track / 2), ("right", -track / 2)):
            links += _wheel(f"{end}_{side}", x, y, mu, shape=shape)
    sides = [
        tuple(f"{end}_{side}_joint" for end in ("front", "rear")) for side in ("left", "right")
    ]
    return replace(Base(links, *sides, track), torque=50.0)


WHEELBASE, CAR_TRACK = 0.6, 0.4
"""Of cars, m."""


def car(mu, offset, *, driven="front"):
    """20 kg with two wheels that are steered about axes `offset` m beside their middles."""
    links = _chassis((0.5, 0.2, 0.1), 20, height=0.05)
    for name, sign in (("left", 1), ("right", -1)):
        y = sign * CAR_TRACK / 2
        links += _wheel(f"rear_{name}", -WHEELBASE / 2, y, mu)
        links += f"""<link name="{name}_knuckle">
          <pose relative_to="base">{WHEELBASE / 2} {y - sign * offset} 0 0 0 0</pose>
          {_inertial(0.5, (0.1, 0.1, 0.1))}</link>
          <joint name="{name}_steering" type="revolute"><parent>base</parent>
          <child>{name}_knuckle</child><axis><xyz>0 0 1</xyz>
          <limit><lower>-0.8</lower><upper>0.8</upper></limit></axis></joint>"""
        links += _wheel(f"front_{name}", WHEELBASE / 2, y, mu, parent=f"{name}_knuckle")
    return Base(links, (f"{driven}_left_joint",), (f"{driven}_right_joint",), CAR_TRACK)


HUGE = 100000.0
BASES = {
    "two wheels, 20 mm wide": two_wheels(width=0.02),
    "two wheels, 50 mm wide": two_wheels(),
    "two wheels, 100 mm wide": two_wheels(width=0.1),
    "two spheres": two_wheels(shape="sphere"),
    "caster of mu 0.2 with 45 %": two_wheels(caster=0.2, share=0.45),
    "caster of mu 1 with 25 %": two_wheels(caster=1.0),
    "caster of mu 1 with 45 %": two_wheels(caster=1.0, share=0.45),
    "no mu stated": two_wheels(None, None),
    "wheels of mu 100": two_wheels(100.0),
    "wheels of mu 100,000, caster of mu 1": two_wheels(HUGE, 1.0),
    "all of mu 100, caster with 45 %": two_wheels(100.0, 100.0, share=0.45),
    "all of mu 100,000, caster with 25 %": two_wheels(HUGE, HUGE),
    "low, mu 1": low(1.0),
    "low, wheels of mu 100,000": low(HUGE),
    "low, wheels of mu 100,000, nose heavy": low(HUGE, centre=0.02),
    "low, all of mu 100,000, nose heavy": low(HUGE, HUGE, centre=0.02),
    "skid steer 0.5, spheres": skid_steer(0.5, shape="sphere"),
    "skid steer 1, spheres": skid_steer(1.0, shape="sphere"),
    "skid steer 1.5, spheres": skid_steer(1.5, shape="sphere"),
    "skid steer 2, spheres": skid_steer(2.0, shape="sphere"),
    "skid steer 1, spheres of mu 100": skid_steer(1.0, 100.0, shape="sphere"),
    "skid steer 0.5": skid_steer(0.5),
    "skid steer 1": skid_steer(1.0),
    "skid steer 1.5": skid_steer(1.5),
    "skid steer 2": skid_steer(2.0),
    "skid steer 1, mu 100": skid_steer(1.0, 100.0),
    "skid steer 1, no mu stated": skid_steer(1.0, None),
}
"""Bases that are driven as differential drives."""
CARS = {
    "car, mu 1": car(1.0, 0.0),
    "car, mu 100": car(100.0, 0.0),
    "car, mu 100, 40 mm": car(100.0, 0.04),
    "car, mu 100, 40 mm, rear drive": car(100.0, 0.04, driven="rear"),
}
"""Cars, with the distance between the steering axis and the middle of the wheel."""
STEERING = 0.3
"""Angle of the middle of the front axle, rad."""
STIFFNESS, DAMPING, STRONGEST = 100.0, 2.0, 5.0
"""Of the steering, N m/rad, N m s/rad and N m."""


def steering_angles():
    """Angles of the left and right front wheel for `STEERING`, rad."""
    radius = WHEELBASE / math.tan(STEERING)
    return [math.atan(WHEELBASE / (radius + side * CAR_TRACK / 2)) for side in (-1, 1)]


def wheel_speeds(speed, driven):
    """Speeds of the left and right driven wheel of a car at `STEERING`, rad/s."""
    radius = WHEELBASE / math.tan(STEERING)
    ahead = WHEELBASE if driven == "front" else 0.0
    away = [math.hypot(ahead, radius + side * CAR_TRACK / 2) for side in (-1, 1)]
    return [speed / radius * each / RADIUS for each in away]
