"""Moving links without a mass: their estimated masses, and the diagnostics."""

import math

import numpy as np
import pytest

import cartwheel as cw
from cartwheel.description import load_text

BOX = '<{0}><origin xyz="0 0 0.1"/><geometry><box size="0.2 0.3 0.4"/></geometry></{0}>'
BALL = '<{0}><geometry><sphere radius="0.1"/></geometry></{0}>'
MASS = (
    '<inertial><mass value="{m}"/>'
    '<inertia ixx="{i}" iyy="{i}" izz="{i}" ixy="0" ixz="0" iyz="0"/></inertial>'
)


def robot(*parts):
    return load_text('<robot name="r">' + "\n".join(parts) + "</robot>")


def link(name, *inner):
    return f'<link name="{name}">{"".join(inner)}</link>'


def joint(child, kind="continuous", parent="base", xyz="0 0 0"):
    return (
        f'<joint name="{child}_joint" type="{kind}"><parent link="{parent}"/>'
        f'<child link="{child}"/><origin xyz="{xyz}"/></joint>'
    )


BASE = link("base", MASS.format(m=1, i=0.1))


def test_it_weighs_its_collisions_as_water():
    found = robot(BASE, link("a", BOX.format("collision"), BALL.format("visual")), joint("a"))
    inertial = found.link("a").inertial
    mass = 1000 * 0.2 * 0.3 * 0.4
    assert inertial.mass == pytest.approx(mass)
    assert inertial.pose.position == pytest.approx((0, 0, 0.1))
    assert inertial.ixx == pytest.approx(mass / 12 * (0.3**2 + 0.4**2))


def test_without_collisions_it_weighs_its_visuals():
    found = robot(BASE, link("a", BALL.format("visual")), joint("a"))
    assert found.link("a").inertial.mass == pytest.approx(1000 * 4 / 3 * math.pi * 0.1**3)


def test_only_what_moves_is_given_a_mass():
    found = robot(
        link("world"), link("base", BOX.format("visual")), joint("base", "fixed", "world"),
        link("a", BOX.format("visual")), joint("a"),
        link("b", BOX.format("visual")), joint("b", "fixed"),
    )  # fmt: skip
    weighed = [each.name for each in found.links if each.inertial is not None]
    assert weighed == ["a"]


def test_a_frame_on_a_heavy_part_stays_a_frame():
    found = robot(BASE, link("a", BOX.format("visual")), joint("a", "fixed"))
    assert found.link("a").inertial is None


def test_a_static_robot_needs_none():
    found = robot(link("base", BOX.format("visual")), "<gazebo><static>true</static></gazebo>")
    assert found.link("base").inertial is None
    assert not found.diagnostics


def test_several_are_reported_together():
    found = robot(
        *(link(n, BALL.format("collision")) for n in ("base", "a", "b")), joint("a"), joint("b")
    )
    (reported,) = found.diagnostics
    assert reported.code.name == "inertia-missing"
    assert reported.values["links"] == ("base", "a", "b")
    assert reported.values["masses"] == pytest.approx((4.19,) * 3, abs=0.01)


@pytest.mark.parametrize("mass", ["0", "-1"])
def test_a_mass_that_is_none_counts_as_not_stated(mass):
    found = robot(
        BASE,
        link("a", f'<inertial><mass value="{mass}"/></inertial>', BALL.format("collision")),
        joint("a"),
        link("b", MASS.format(m=1, i=0.1)),
        joint("b", parent="a"),
    )
    assert found.link("a").inertial.mass == pytest.approx(1000 * 4 / 3 * math.pi * 0.1**3)


def test_a_point_mass_that_moves_is_spread_over_its_geometry():
    stated = '<inertial><origin xyz="0 0 0.05"/><mass value="2"/></inertial>'
    hung = link("frame") + joint("frame", "fixed", "a")
    found = robot(BASE, link("a", stated, BALL.format("collision")), joint("a"), hung)
    inertial = found.link("a").inertial
    assert inertial.mass == 2
    assert inertial.pose.position == (0, 0, 0.05)
    assert inertial.ixx == pytest.approx(0.4 * 2 * 0.1**2)


@pytest.mark.parametrize("closed", [True, False])
def test_a_mesh_weighs_what_it_encloses_or_else_its_box(tmp_path, closed):
    """A box whose lid may be missing, seen from a corner far off."""
    x, y, z = 0.2, 0.3, 0.4
    corners = np.array([[a, b, c] for a in (0, x) for b in (0, y) for c in (0, z)]) + 5.0
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    lines = [f"v {a} {b} {c}" for a, b, c in corners]
    lines += ["f " + " ".join(str(i + 1) for i in quad) for quad in quads[: 6 if closed else 5]]
    (tmp_path / "box.obj").write_text("\n".join(lines))
    shape = f'<visual><geometry><mesh filename="file://{tmp_path}/box.obj"/></geometry></visual>'
    inertial = robot(link("base", shape)).link("base").inertial
    assert inertial.mass == pytest.approx(1000 * x * y * z, rel=1e-4)
    assert inertial.pose.position == pytest.approx((5 + x / 2, 5 + y / 2, 5 + z / 2), rel=1e-4)


def test_such_a_robot_falls_and_stands():
    with cw.World("empty") as world:
        ball = world.spawn(robot(link("base", BALL.format("collision"))), z=1.0)
        world.run(seconds=2)
        assert ball.pose.z == pytest.approx(0.1, abs=2e-3)


def untouchable(*parts):
    return [d for d in robot(*parts).diagnostics if d.code.name == "base-without-collision"]


def test_a_robot_that_nothing_holds_is_reported():
    visual, collision = BOX.format("visual"), BOX.format("collision")
    mass = MASS.format(m=1, i=0.1)
    (reported,) = untouchable(link("base", mass, visual))
    assert reported.values["link"] == "base"
    assert not untouchable(link("base", mass, visual, collision))
    assert not untouchable(link("base", mass, visual), link("a", collision), joint("a", "fixed"))
    assert not untouchable(link("base", mass))
    assert not untouchable(link("world"), link("base", mass, visual), joint("base", parent="world"))
