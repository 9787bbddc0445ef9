"""Limits of joints that a program sets: of positions, velocities and efforts."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import replace

from cartwheel.description.model import RobotDescription
from cartwheel.simulation.dynamics.joint_servo import ServoHandle
from cartwheel.simulation.engine import Engine
from cartwheel.simulation.models.population import Population
from cartwheel.simulation.models.resident import Resident
from cartwheel.world import rotor_strength

Limits = Mapping[str, float | None]
"""Some of ``lower``, ``upper``, ``velocity`` and ``effort``; None is unlimited."""


class JointLimits:
    """Reads and sets the limits of joints, which exist, by names.

    Args:
        engine: The engine that simulates the models.
        population: The models.
    """

    def __init__(self, engine: Engine, population: Population) -> None:
        self._engine = engine
        self._population = population

    def effort(self, model: str, joint: str) -> float | None:
        """Maximum effort of what drives a joint, N m or N; without a motor, the stated limit."""
        entry = self._population.resident(model).entry
        described, motor = entry.description.joint(joint), entry.motors.get(joint)
        stated = None if described is None else described.axis.effort or None
        if motor is None or motor.max_effort is None:
            return stated
        return rotor_strength(motor, described)

    def velocity(self, model: str, joint: str) -> float | None:
        """Maximum velocity of a joint's commands, rad/s or m/s; without a controller, the stated
        limit.
        """
        resident = self._population.resident(model)
        for name, each in resident.part.limited:
            if name == joint:
                found: float = each.limits.velocity
                return None if found == math.inf else found
        described = resident.entry.description.joint(joint)
        return None if described is None else described.axis.velocity or None

    def limits_velocity(self, model: str, joint: str) -> bool:
        """Whether a controller limits the velocity of a joint."""
        limited = self._population.resident(model).part.limited
        return any(name == joint for name, _ in limited)

    def set(self, model: str, joint: str, limits: Limits) -> None:
        """Sets limits, which replace those of files, controllers and plugins.

        Raises:
            WorldError: The model cannot be built; nothing has changed.
        """
        resident = self._population.resident(model)
        motors = resident.entry.motors
        before = motors.get(joint)
        if before is not None and "effort" in limits:
            motors[joint] = replace(before, max_effort=limits["effort"], beyond=False)
        try:
            self._population.describe(model, _changed(resident, joint, limits))
        except BaseException:
            if before is not None:
                motors[joint] = before
            raise
        if "effort" in limits and joint in motors:
            strength = rotor_strength(motors[joint], resident.entry.description.joint(joint))
            for handle in resident.part.handles:
                if isinstance(handle, ServoHandle) and handle.motor.joint == joint:
                    handle.strengthen(self._engine.model, strength)
        numbers = {
            name: (-math.inf if name == "lower" else math.inf) if value is None else value
            for name, value in limits.items()
        }
        for name, each in resident.part.limited:
            if name == joint:
                each.limits = replace(each.limits, **numbers)


def _changed(resident: Resident, joint: str, limits: Limits) -> RobotDescription:
    description = resident.entry.description
    joints = tuple(
        replace(each, axis=replace(each.axis, **limits))  # type: ignore[arg-type]
        if each.name == joint
        else each
        for each in description.joints
    )
    return replace(description, joints=joints)
