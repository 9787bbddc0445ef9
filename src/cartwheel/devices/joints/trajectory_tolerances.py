"""Tolerances of trajectories: defaults, and those of goals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from cartwheel.devices.joints.trajectory_reading import (
    INVALID_JOINTS,
    InvalidTrajectoryError,
)


@dataclass(frozen=True, kw_only=True, slots=True)
class Tolerance:
    """Largest allowed error of a joint; 0 is not checked."""

    position: float = 0.0
    velocity: float = 0.0

    def violated(self, position: float, velocity: float) -> bool:
        """Whether an error exceeds the tolerance."""
        return (0 < self.position < abs(position)) or (0 < self.velocity < abs(velocity))

    def excess(self, position: float, velocity: float) -> str:
        """Describes the error that exceeds the tolerance."""
        if 0 < self.position < abs(position):
            return f"a position error of {abs(position):.4g} (tolerance {self.position:g})"
        return f"a velocity error of {abs(velocity):.4g} (tolerance {self.velocity:g})"


@dataclass(frozen=True, kw_only=True, slots=True)
class Tolerances:
    """Tolerances of a trajectory follower, for each joint."""

    names: tuple[str, ...]
    """Names of the joints."""
    path: tuple[Tolerance, ...]
    """Tolerances on the path."""
    goal: tuple[Tolerance, ...]
    """Tolerances at the goal."""
    goal_time: float = 0.0
    """Time in s by which a goal can be late."""

    def of(self, goal: Any) -> tuple[list[Tolerance], list[Tolerance]]:
        """Returns path and goal tolerances of a goal. The goal's own tolerances override these.

        Raises:
            InvalidTrajectoryError: A tolerance is for a joint that the follower does not have.
        """
        for each in (*goal.component_path_tolerance, *goal.component_goal_tolerance):
            raise InvalidTrajectoryError(
                INVALID_JOINTS,
                f'"{each.joint_name}" is not a joint with several degrees of freedom',
            )
        return self._merged(self.path, goal.path_tolerance), self._merged(
            self.goal, goal.goal_tolerance
        )

    def _merged(self, defaults: Sequence[Tolerance], stated: Any) -> list[Tolerance]:
        tolerances = list(defaults)
        for each in stated:
            if each.name not in self.names:
                raise InvalidTrajectoryError(
                    INVALID_JOINTS,
                    f'a tolerance refers to joint "{each.name}", which does not belong to this '
                    "controller",
                )
            index = self.names.index(each.name)
            # 0 keeps the default; a negative value disables the check.
            tolerances[index] = Tolerance(
                position=max(each.position or tolerances[index].position, 0.0),
                velocity=max(each.velocity or tolerances[index].velocity, 0.0),
            )
        return tolerances
