"""Bases whose wheels or casters have ``<slip1>`` and ``<slip2>``, which are not simulated."""

import numpy as np
import pytest

from cartwheel.checks import check
from cartwheel.checks.sliding import Contact, base_motion
from cartwheel.codes.robot import SKID_STEERING

TRACK = 0.4


@pytest.mark.parametrize(
    ("slip", "ratio"),
    [
        # Equal loads and slip in all directions: as with friction, t²/(t² + b²).
        ((0.0, 0.0), 0.5),
        ((100.0, 100.0), 0.5),
        # Sideways, the friction vanishes, so the wheels roll.
        ((0.0, 1e6), 1.0),
        # Lengthwise, it vanishes, so nothing turns the base.
        ((1e6, 0.0), 0.0),
    ],
)
def test_slip_decides_which_part_of_the_motion_is_sliding(slip, ratio):
    half = TRACK / 2
    contacts = [
        Contact(x=x, y=y, rim=half if y < 0 else -half, slip=slip)
        for x in (-half, half)
        for y in (-half, half)
    ]
    assert base_motion(contacts, (0.0, 0.0)) == pytest.approx([0.0, 0.0, ratio], abs=2e-3)


@pytest.mark.parametrize(
    ("slips", "speed"),
    [
        # The mean of the speeds, weighted by 1 / slip.
        ((10.0, 30.0, 20.0), np.average([1.0, 1.0, 0.0], weights=[1 / 10, 1 / 30, 1 / 20])),
        # The third slides at more than 2 / 3 m/s, so its friction is its load, which is 1 / 3.
        ((1.0, 3.0, 2.0), 0.75),
    ],
)
def test_friction_with_slip_is_proportional_to_the_speed_up_to_the_load(slips, speed):
    contacts = [
        Contact(x=0.0, y=0.0, rim=rim, slip=(slip, 0.0))
        for rim, slip in zip((1.0, 1.0, 0.0), slips, strict=True)
    ]
    assert base_motion(contacts, (0.0, 0.0))[0] == pytest.approx(speed, rel=1e-3)


FOUR = {"fl": (0.2, 0.2), "rl": (-0.2, 0.2), "fr": (0.2, -0.2), "rr": (-0.2, -0.2)}


def model(separation, slip):
    """A base on four driven wheels."""
    parts = []
    for name, (x, y) in FOUR.items():
        parts.append(
            f'<link name="{name}"><pose>{x} {y} 0.1 -1.5708 0 0</pose><inertial><mass>0.5</mass>'
            "<inertia><ixx>1e-3</ixx><iyy>1e-3</iyy><izz>2e-3</izz></inertia></inertial>"
            '<collision name="c"><geometry><cylinder><radius>0.1</radius><length>0.04</length>'
            f"</cylinder></geometry><surface><friction><ode><slip1>{slip}</slip1></ode></friction>"
            f'</surface></collision></link><joint name="{name}_joint" type="revolute"><parent>base'
            f"</parent><child>{name}</child><axis><xyz>0 0 1</xyz></axis></joint>"
        )
    left, right = (
        "".join(f"<{side}_joint>{n}_joint</{side}_joint>" for n in FOUR if n[1] == side[0])
        for side in ("left", "right")
    )
    return (
        '<sdf version="1.7"><model name="robot"><link name="base"><pose>0 0 0.1 0 0 0</pose>'
        "<inertial><mass>20</mass><inertia><ixx>0.5</ixx><iyy>0.5</iyy><izz>0.5</izz></inertia>"
        f'</inertial></link>{"".join(parts)}<plugin filename="gz-sim-diff-drive-system" '
        f'name="gz::sim::systems::DiffDrive">{left}{right}<wheel_separation>{separation}'
        "</wheel_separation><wheel_radius>0.1</wheel_radius><topic>cmd_vel</topic></plugin>"
        "</model></sdf>"
    )


@pytest.mark.parametrize(
    ("separation", "slip", "expected"),
    [
        (0.8, 0.0, []),
        (0.8, 1e-6, []),
        (0.8, 0.01, [("info", True)]),  # it turns as commanded, but only without slip
        (0.4, 0.0, [("info", None)]),
        (0.4, 0.01, [("info", True)]),
    ],
)
def test_slip_that_changes_the_turn_rate_is_said(tmp_path, separation, slip, expected):
    path = tmp_path / "m.sdf"
    path.write_text(model(separation, slip))
    found = [each for each in check(path).findings if each.code is SKID_STEERING]
    assert [(each.severity, each.values.get("slip")) for each in found] == expected
