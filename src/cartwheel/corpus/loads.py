"""What the motor of a joint works against: gravity and friction."""

from __future__ import annotations

from cartwheel.api import Model, World


def held_by(world: World, model: Model, joint: str) -> float:
    """Size of the effort of a joint's motor, N m or N."""
    simulation = world.session.simulation
    simulation.refresh()
    return abs(float(simulation.data.qfrc_actuator[degree(world, model, joint)]))


def resistance(world: World, model: Model, joint: str) -> tuple[float, float]:
    """What resists the motion of a joint at rest.

    Returns:
        The load of gravity plus the friction, N m or N, and the inertia about the joint with all
        joints at 0, kg m² or kg.
    """
    simulation = world.session.simulation
    simulation.refresh()
    engine, data = simulation.model, simulation.data
    place = degree(world, model, joint)
    load = abs(float(data.qfrc_bias[place])) + float(engine.dof_frictionloss[place])
    return load, float(engine.dof_M0[place])


def degree(world: World, model: Model, joint: str) -> int:
    """Index of a joint's velocity."""
    simulation = world.session.simulation
    return int(simulation.model.jnt_dofadr[simulation.engine.joint_id(model.name, joint)])
