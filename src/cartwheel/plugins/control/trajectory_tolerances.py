"""How far joints may be off a trajectory, by the controller's parameters and by a goal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from cartwheel.plugins.control.settings import Settings
from cartwheel.plugins.control.trajectory_reading import INVALID_JOINTS, InvalidTrajectoryError


@dataclass(frozen=True, kw_only=True, slots=True)
class Tolerance:
    """The most that a joint may be off; 0 is not checked."""

    position: float = 0.0
    velocity: float = 0.0

    def violated(self, position: float, velocity: float) -> bool:
        """Whether errors of these sizes are too large."""
        return (0 < self.position < abs(position)) or (0 < self.velocity < abs(velocity))


class Tolerances:
    """Those of a controller. Source: joint_trajectory_controller.

    Args:
        constraints: Its parameters of that name.
        names: Of its joints.

    Raises:
        PluginError: A value is no number.
    """

    def __init__(self, constraints: Settings, names: Sequence[str]) -> None:
        self._names = list(names)
        stopped = constraints.number("stopped_velocity_tolerance", 0.01)
        self.goal_time = constraints.number("goal_time", 0.0)
        """s that a goal may be late."""
        self.path = [
            Tolerance(position=constraints.number(f"{name}/trajectory", 0.0)) for name in names
        ]
        """On the way, of each joint."""
        self.goal = [
            Tolerance(position=constraints.number(f"{name}/goal", 0.0), velocity=stopped)
            for name in names
        ]
        """In the end, of each joint."""

    def of(self, goal: Any) -> tuple[list[Tolerance], list[Tolerance]]:
        """Of path and end for a goal: the controller's, or what the goal says of a joint instead.

        Raises:
            InvalidTrajectoryError: It says something of a joint that is none of the controller's.
        """
        for each in (*goal.component_path_tolerance, *goal.component_goal_tolerance):
            raise InvalidTrajectoryError(
                INVALID_JOINTS, f'"{each.joint_name}" is not a joint of several degrees of freedom'
            )
        return self._merged(self.path, goal.path_tolerance), self._merged(
            self.goal, goal.goal_tolerance
        )

    def _merged(self, defaults: list[Tolerance], stated: Any) -> list[Tolerance]:
        made = list(defaults)
        for each in stated:
            if each.name not in self._names:
                raise InvalidTrajectoryError(
                    INVALID_JOINTS,
                    f'a tolerance refers to the joint "{each.name}", which does not exist',
                )
            index = self._names.index(each.name)
            # 0 leaves the default, and what is below takes the check away.
            made[index] = Tolerance(
                position=max(each.position or made[index].position, 0.0),
                velocity=max(each.velocity or made[index].velocity, 0.0),
            )
        return made
