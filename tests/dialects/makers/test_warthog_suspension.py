"""Two sides on springs: they sag by their weight, and swing as a spring lets them."""

import math

import pytest

from cartwheel.errors import PluginError

MASS, ARM, G = 2.0, 0.5, 9.8
STIFFNESS = 50.0


def rover(make, tags):
    sides = "".join(
        f"""<link name="{side}"><inertial><pose>{ARM} 0 0 0 0 0</pose><mass>{MASS}</mass><inertia>
        <ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia></inertial></link>
        <joint name="{side}_diff_unit_joint" type="revolute"><parent>world</parent>
        <child>{side}</child><axis><xyz>0 1 0</xyz></axis></joint>"""
        for side in ("left", "right")
    )
    return make.sdf(f"""<model name="rover">{sides}<plugin name="suspension"
      filename="libwarthog_suspension_plugin.so">{tags}</plugin></model>""")


def springs(stiffness, damping):
    return f"<suspension_k>{stiffness}</suspension_k><suspension_b>{damping}</suspension_b>"


def test_both_sides_sag_by_what_their_weight_asks(make):
    """k a = m g l cos a."""
    world = make.world(rover(make, springs(STIFFNESS, 10.0)))
    world.run(5.0)
    sag = 0.0
    for _ in range(100):
        sag = MASS * G * ARM / STIFFNESS * math.cos(sag)
    for side in ("left", "right"):
        angle = world.session.simulation.joint_position("rover", f"{side}_diff_unit_joint")
        assert angle == pytest.approx(sag, rel=1e-3)


def test_what_no_spring_can_be_is_an_error(make):
    with pytest.raises(PluginError) as caught:
        make.world(rover(make, springs(-1.0, 1.0)))
    assert caught.value.values["parameter"] == "suspension_k"
