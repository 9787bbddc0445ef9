"""What the motor of a joint works against: gravity, friction and the ground."""

from __future__ import annotations

import numpy as np

from cartwheel.api import Model, World
from cartwheel.description.model import Joint, RobotDescription


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


def grip(world: World, model: Model, robot: RobotDescription, joint: Joint) -> float:
    """Largest effort with which friction at the contacts of a leg resists its joint, N m or N.

    Each contact between what the joint moves and another model counts with the friction
    coefficient of the link, the normal force and the distance from the joint's axis.
    """
    moved = _beyond(robot, joint)
    simulation = world.session.simulation
    place = simulation.engine.joint_id(model.name, joint.name)
    axis, anchor = simulation.data.xaxis[place], simulation.data.xanchor[place]
    total = 0.0
    for contact in world.contacts(model.name):
        if contact.links[0] not in moved or contact.models[1] == model.name:
            continue
        arm = np.linalg.norm(np.cross(axis, np.array(contact.point) - anchor))
        load = abs(float(np.dot(contact.force, contact.normal)))
        total += moved[contact.links[0]] * load * (1.0 if joint.type == "prismatic" else float(arm))
    return total


def _beyond(robot: RobotDescription, joint: Joint) -> dict[str, float]:
    """The friction coefficients of the links that a joint moves."""
    found, waiting = {joint.child}, [joint.child]
    while waiting:
        parent = waiting.pop()
        children = {each.child for each in robot.joints if each.parent == parent} - found
        found |= children
        waiting += children
    links = {link.name: link for link in robot.links if link.name in found}
    return {
        name: max((each.surface.mu1 or 1.0 for each in link.collisions), default=1.0)
        for name, link in links.items()
    }
