"""Pushes beside other pushes: each adds what it is, and takes away what it was."""

import pytest

from cartwheel.geometry import Pose

MASS = 2.0


@pytest.fixture
def simulation(make):
    """A weightless cube and another."""
    world = make.world(
        make.box("cube", (0.5,) * 3, mass=MASS),
        make.box("other", (0.5,) * 3, mass=MASS, pose=Pose((5, 0, 0))),
        ground=None,
        gravity=0.0,
    )
    return world.session.simulation


def speed(simulation, model="cube"):
    joint = simulation.engine.free_joint(model, "link")
    start = simulation.model.jnt_dofadr[joint]
    return simulation.data.qvel[start : start + 3].copy()


def test_beside_a_plugins_push_on_the_same_link(simulation):
    """1 N of a plugin's for two seconds, 0.3 N of ours for one: (2 + 0.3) / m."""
    handle = simulation._population.residents["cube"].part.wrench("link")
    handle.bind(simulation.model, simulation.data)
    handle.apply((1.0, 0, 0), (0, 0, 0))
    simulation.forces.wrench(
        "cube",
        "link",
        force=(0.3, 0.1, 0),
        torque=(0, 0, 0),
        start_ns=500_000_000,
        duration_ns=1_000_000_000,
    )
    simulation.advance(2_000_000_000)
    assert speed(simulation) == pytest.approx([2.3 / MASS, 0.1 / MASS, 0], rel=1e-9)
    body = simulation.engine.body_id("cube", "link")
    assert simulation.data.xfrc_applied[body] == pytest.approx([1.0, 0, 0, 0, 0, 0], abs=1e-15)


def test_pushes_that_end_leave_nothing_behind(simulation):
    """Numbers that do not add up to zero in binary, ending one after the other."""
    for index, force in enumerate((0.1, 0.2, 0.3, 1e-3, 7e5)):
        simulation.forces.wrench(
            "cube",
            "link",
            force=(force, -force, 0),
            torque=(0, 0, 0),
            duration_ns=(index + 1) * 10_000_000,
        )
    simulation.advance(100_000_000)
    assert not simulation.forces.active
    assert not simulation.data.xfrc_applied.any()


def test_only_what_is_named_is_pushed_and_cleared(simulation):
    for model in ("cube", "other"):
        simulation.forces.wrench(model, "link", force=(1, 0, 0), torque=(0, 0, 0))
        simulation.forces.wrench(
            model, "link", force=(1, 0, 0), torque=(0, 0, 0), duration_ns=None, start_ns=10**9
        )
    simulation.forces.clear_wrenches("cube", "link")
    simulation.advance(2_000_000_000)
    assert not speed(simulation).any()
    # Both are without end: one from the start, one from the first second on.
    assert speed(simulation, "other") == pytest.approx([3.0 / MASS, 0, 0], rel=1e-9)


def test_a_push_in_the_past_begins_now(simulation):
    simulation.advance(1_000_000_000)
    simulation.forces.wrench(
        "cube",
        "link",
        force=(1, 0, 0),
        torque=(0, 0, 0),
        start_ns=200_000_000,
        duration_ns=500_000_000,
    )
    simulation.advance(3_000_000_000)
    assert speed(simulation) == pytest.approx([0.5 / MASS, 0, 0], rel=1e-9)
