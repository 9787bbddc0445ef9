"""The drag that a chain of joints is given: how much, where, and what it is good for."""

import mujoco
import numpy as np
import pytest

import cartwheel as cw
from cartwheel.codes.world import CHAIN_DRAG
from cartwheel.world import chains

STEP = 0.005
ROD = """<inertial><pose>{com} 0 0 0 0 0</pose><mass>{m}</mass><inertia><ixx>{i}</ixx>
  <iyy>{i}</iyy><izz>{i}</izz></inertia></inertial>"""


def arm(lengths, masses, *, axes="y", foot="world"):
    """Links that hang on each other by hinges, stretched along x."""
    parts = []
    x = 0.0
    for number, (length, mass) in enumerate(zip(lengths, masses, strict=True)):
        body = ROD.format(com=length / 2, m=mass, i=mass * length**2 / 12)
        axis = {"x": "1 0 0", "y": "0 1 0", "z": "0 0 1"}[axes[number % len(axes)]]
        parent = f"l{number - 1}" if number else foot
        parts.append(
            f'<link name="l{number}"><pose>{x} 0 0 0 0 0</pose>{body}</link>'
            f'<joint name="j{number}" type="revolute"><parent>{parent}</parent>'
            f"<child>l{number}</child><axis><xyz>{axis}</xyz></axis></joint>"
        )
        x += length
    return "".join(parts)


def standing(make, text, *, step=STEP, gravity=9.8):
    model = make.sdf(f'<model name="m"><pose>0 0 2 0 0 0</pose>{text}</model>')
    return make.world(model, ground=None, step=step, gravity=gravity).session.simulation


def named(simulation):
    model = simulation.model
    return {model.joint(j).name: value for j, value in chains.drag(model).items()}


@pytest.mark.parametrize("step", [0.001, 0.005])
def test_the_drag_is_half_the_step_times_the_largest_inertia(make, step):
    lengths, masses = (0.5, 0.4), (2.0, 1.0)
    found = named(standing(make, arm(lengths, masses), step=step))
    own = [m * a**2 / 12 for a, m in zip(lengths, masses, strict=True)]
    tip = own[1] + masses[1] * 0.2**2
    both = own[0] + masses[0] * 0.25**2 + own[1] + masses[1] * (0.5 + 0.2) ** 2
    assert found == pytest.approx({"m::j0": 0.5 * step * both, "m::j1": 0.5 * step * tip})


def test_it_acts_with_the_third_power_of_the_speed(make):
    simulation = standing(make, arm((0.5, 0.4), (2.0, 1.0)), gravity=0.0)
    coefficient = named(simulation)["m::j1"]
    simulation.data.joint("m::j1").qvel[0] = 20.0
    simulation.refresh()
    force = simulation.data.joint("m::j1").qfrc_passive[0]
    assert force == pytest.approx(-coefficient * 20.0**3)


def test_what_is_alone_has_none(make):
    assert named(standing(make, arm((0.5,), (1.0,)))) == {}


def test_balanced_wheels_have_none_and_unbalanced_ones_do(make):
    def wheel(name, com):
        body = ROD.format(com=com, m=1.0, i=0.01)
        return (
            f'<link name="{name}">{body}</link><joint name="{name}_joint" type="revolute">'
            f"<parent>base</parent><child>{name}</child><axis><xyz>0 1 0</xyz></axis></joint>"
        )

    base = f'<link name="base">{ROD.format(com=0.0, m=5.0, i=0.1)}</link>'
    found = named(standing(make, base + wheel("round", 0.01) + wheel("cam", 0.1)))
    assert list(found) == ["m::cam_joint"]
    assert found["m::cam_joint"] == pytest.approx(0.5 * STEP * (0.01 + 1.0 * 0.1**2))


def test_the_cart_has_none():
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        assert chains.drag(world.session.simulation.model) == {}


def energy(simulation):
    model, data = simulation.model, simulation.data
    simulation.refresh()
    mujoco.mj_energyPos(model, data)
    mujoco.mj_energyVel(model, data)
    return float(data.energy.sum())


FALLING = {
    "lengths": (0.3, 0.3, 0.15, 0.1, 0.04, 0.03),
    "masses": (2.0, 1.0, 0.5, 0.2, 0.01, 0.01),
    "axes": "yzyx",
}


@pytest.mark.parametrize("step", [0.001, 0.005])
def test_a_falling_arm_with_light_fingers_gains_no_energy(make, step):
    simulation = standing(make, arm(**FALLING), step=step)
    first = energy(simulation)
    reach, mass = sum(FALLING["lengths"]), sum(FALLING["masses"])
    for _ in range(20):
        simulation.advance(simulation.time_ns + 500_000_000)
        assert energy(simulation) < first + 0.02 * mass * 9.8 * reach


def test_without_it_the_same_arm_does(make):
    """So that the test above is about something."""
    simulation = standing(make, arm(**FALLING))
    simulation.model.dof_dampingpoly[:] = 0
    before = energy(simulation)
    for _ in range(400):
        mujoco.mj_step(simulation.model, simulation.data)
        if np.abs(simulation.data.qvel).max() > 1e4:
            return
    assert energy(simulation) > before + 1.0


def test_a_double_pendulum_swings_on(make):
    """At what speeds robots have it takes little: here under 2 % of the energy in 5 s."""
    simulation = standing(make, arm((0.5, 0.5), (1.0, 1.0)), step=0.001)
    data = simulation.data
    data.joint("m::j0").qpos[0] = np.pi / 2 - 0.5
    data.joint("m::j1").qpos[0] = 0.0
    lowest = -9.8 * (1.0 * 0.25 + 1.0 * 0.75) + 2 * 9.8 * 2.0
    first = energy(simulation) - lowest
    simulation.advance(simulation.time_ns + 5_000_000_000)
    assert energy(simulation) - lowest == pytest.approx(first, rel=0.02)


def damped(text, *, damping, velocity=None):
    """The same links, whose joints state a damping and a maximum velocity."""
    limit = f"<limit><velocity>{velocity}</velocity></limit>" if velocity else ""
    stated = f"</xyz>{limit}<dynamics><damping>{damping}</damping></dynamics></axis>"
    return text.replace("</xyz></axis>", stated)


def dragged(make, text, **more):
    """The joints with drag in a world, by the diagnostic of the load."""
    simulation = standing(make, text, **more)
    return [
        joint
        for each in simulation.diagnostics
        if each.code is CHAIN_DRAG
        for joint in each.values["joints"]
    ]


def test_a_hinge_with_enough_damping_has_no_drag(make):
    text = arm((0.5, 0.4), (2.0, 1.0))
    # The energy of a fall: each mass from its largest distance above the first hinge to below it.
    fall = 2 * 9.8 * (2.0 * 0.25 + 1.0 * (0.5 + 0.2))
    enough = STEP * fall
    assert dragged(make, damped(text, damping=1.01 * enough, velocity=1.0)) == []
    assert dragged(make, damped(text, damping=0.99 * enough, velocity=1.0)) == ["j0", "j1"]


def test_a_fast_joint_needs_more_damping(make):
    text = arm((0.5, 0.4), (2.0, 1.0))
    tip = 1.0 * 0.4**2 / 12 + 1.0 * 0.2**2
    enough = 0.5 * STEP * tip * 60.0**2
    found = dragged(make, damped(text, damping=1.01 * enough, velocity=60.0))
    assert found == ["j0"]
    assert dragged(make, damped(text, damping=0.99 * enough, velocity=60.0)) == ["j0", "j1"]


def test_without_a_maximum_velocity_damping_must_be_enough_at_one_radian_per_step(make):
    text = arm((0.5, 0.4), (2.0, 1.0))
    tip = 1.0 * 0.4**2 / 12 + 1.0 * 0.2**2
    enough = 0.5 * tip / STEP
    assert dragged(make, damped(text, damping=1.01 * enough)) == ["j0"]
    assert dragged(make, damped(text, damping=0.99 * enough)) == ["j0", "j1"]


def test_a_falling_arm_with_just_enough_damping_gains_no_energy(make):
    lengths, masses = FALLING["lengths"], FALLING["masses"]
    ends = np.cumsum(lengths)
    middles = ends - np.array(lengths) / 2
    damping = 1.001 * STEP * 2 * 9.8 * float(np.dot(masses, middles))
    simulation = standing(make, damped(arm(**FALLING), damping=damping, velocity=0.1))
    assert not simulation.model.dof_dampingpoly.any()
    before = energy(simulation)
    for _ in range(40):
        simulation.advance(simulation.time_ns + 50_000_000)
        now = energy(simulation)
        assert now < before + 1e-3
        before = now
