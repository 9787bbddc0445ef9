"""Carts for the tests of drives: their wheels, plugins and paths."""

import math

import numpy as np

from cartwheel.geometry import Pose, yaw_of

RADIUS = 0.1
WIDTH = 0.04


def _link(name, pose, mass, shape, inertia, mu):  # noqa: PLR0917
    return f"""<link name="{name}"><pose>{pose}</pose>
      <inertial><mass>{mass}</mass><inertia><ixx>{inertia[0]}</ixx><iyy>{inertia[1]}</iyy>
        <izz>{inertia[2]}</izz></inertia></inertial>
      <collision name="c"><geometry>{shape}</geometry><surface><friction><ode><mu>{mu}</mu>
        <mu2>{mu}</mu2></ode></friction></surface></collision></link>"""


def _hinge(name, kind, parent, child, axis):
    return f"""<joint name="{name}" type="{kind}"><parent>{parent}</parent><child>{child}</child>
      <axis><xyz>{axis}</xyz></axis></joint>"""


def cart_sdf(wheels, plugin, *, forks=(), mu=1.0, mass=8.0, balls=()):
    """A cart of base_link and wheels of radius 0.1 m, each turning about y.

    Args:
        wheels: Name to (x, y); its joint is ``<name>_joint``.
        plugin: XML.
        forks: Names of wheels that a joint ``<name>_steering`` turns about z.
        mu: Of the wheels.
        mass: Of the base, low down.
        balls: Places (x, y) of gliders without friction.
    """
    wheel = 0.5
    flat = (wheel * RADIUS**2 / 4, wheel * RADIUS**2 / 4, wheel * RADIUS**2 / 2)
    disc = f"<cylinder><radius>{RADIUS}</radius><length>{WIDTH}</length></cylinder>"
    box = mass * 0.3**2 / 12
    parts = [
        _link("base_link", f"0 0 {RADIUS} 0 0 0", mass, "<box><size>0.1 0.1 0.05</size></box>",
              (box, box, 2 * box), 0.0)
    ]  # fmt: skip
    for name, (x, y) in wheels.items():
        parent = "base_link"
        if name in forks:
            parent = f"{name}_fork"
            parts.append(
                f"""<link name="{parent}"><pose>{x} {y} {RADIUS} 0 0 0</pose><inertial>
                <mass>0.2</mass><inertia><ixx>1e-3</ixx><iyy>1e-3</iyy><izz>1e-3</izz></inertia>
                </inertial></link>"""
            )
            parts.append(_hinge(f"{name}_steering", "revolute", "base_link", parent, "0 0 1"))
        pose = f"{x} {y} {RADIUS} {-math.pi / 2} 0 0"
        parts.append(_link(f"{name}_wheel", pose, wheel, disc, flat, mu))
        parts.append(_hinge(f"{name}_joint", "continuous", parent, f"{name}_wheel", "0 0 1"))
    for number, (x, y) in enumerate(balls):
        ball = f"<sphere><radius>{RADIUS / 2}</radius></sphere>"
        small = 0.2 * RADIUS**2 / 10
        parts.append(
            _link(f"ball{number}", f"{x} {y} {RADIUS / 2} 0 0 0", 0.2, ball, (small,) * 3, 0.0)
        )
        parts.append(_hinge(f"ball{number}_joint", "fixed", "base_link", f"ball{number}", "0 0 1"))
    return f'<model name="cart">{"".join(parts)}{plugin}</model>'


FOUR = {
    "left_front": (0.2, 0.15),
    "right_front": (0.2, -0.15),
    "left_rear": (-0.2, 0.15),
    "right_rear": (-0.2, -0.15),
}
"""Wheels at the corners of a rectangle."""
CAR = {
    "front_left": (0.4, 0.15),
    "front_right": (0.4, -0.15),
    "rear_left": (0.0, 0.15),
    "rear_right": (0.0, -0.15),
}
"""Wheels of a car, whose front wheels are steered."""
FRONT = ("front_left", "front_right")
PLANAR = """<plugin name="drive" filename="libgazebo_ros_planar_move.so">
  <robotBaseFrame>base_link</robotBaseFrame>{}</plugin>"""
START = Pose((0, 0, 0.002))


def skid(tags=""):
    return f"""<plugin name="drive" filename="libgazebo_ros_skid_steer_drive.so">
      <wheelSeparation>0.3</wheelSeparation><wheelDiameter>0.2</wheelDiameter>
      <torque>50</torque><robotBaseFrame>base_link</robotBaseFrame>{tags}</plugin>"""


def ackermann(tags=""):
    return f"""<plugin name="drive" filename="libgazebo_ros_ackermann_drive.so">
      <left_steering_joint>front_left_steering</left_steering_joint>
      <right_steering_joint>front_right_steering</right_steering_joint>
      <publish_odom>true</publish_odom><publish_distance>true</publish_distance>
      <publish_steerangle>true</publish_steerangle><robot_base_frame>base_link</robot_base_frame>
      <left_steering_pid_gain>1 0 0</left_steering_pid_gain>{tags}</plugin>"""


def where(message):
    place, turn = message.pose.pose.position, message.pose.pose.orientation
    return place.x, place.y, yaw_of((turn.x, turn.y, turn.z, turn.w))


def path(messages):
    return np.array([where(message)[:2] for message in messages])


def turned(messages):
    """rad, summed along the messages."""
    yaws = np.unwrap([where(message)[2] for message in messages])
    return yaws[-1] - yaws[0]


def circle(points):
    """Radius of the circle through points, by least squares: |p|² = 2 c·p + (r² - |c|²)."""
    rows = np.column_stack([2 * points, np.ones(len(points))])
    (cx, cy, rest), *_ = np.linalg.lstsq(rows, (points**2).sum(axis=1), rcond=None)
    return math.sqrt(rest + cx * cx + cy * cy)


def spawn(make, model, pose=START, **more):
    world = make.world(**more)
    world.session.spawn(model, pose=pose)
    world.run(0.5)
    return world
