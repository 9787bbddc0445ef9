"""Robots on wheels for the tests of drives, made in a line."""

import math

import pytest

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


@pytest.fixture
def cart(make):
    """`cart_sdf` as a description."""
    return lambda wheels, plugin, **more: make.sdf(cart_sdf(wheels, plugin, **more))
