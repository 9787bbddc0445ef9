"""The pose of a model as an observation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

from cartwheel.batch.plan import invalid
from cartwheel.geometry import rpy_from_quat, yaw_of
from cartwheel.similar_names import meant, suggestion

if TYPE_CHECKING:
    from cartwheel.api import World

_FIELDS = ("x", "y", "z", "qx", "qy", "qz", "qw", "yaw", "roll", "pitch")
_HEADING = 8
"""Number of fields that are known with the heading."""


@dataclass(frozen=True, init=False)
class PoseOf:
    """An observation of `Batch`: where a model is in the world.

    It has the same numbers as a function that reads `Model.pose`, and takes less time.

    Args:
        model: Name of the model.
        fields: Any of ``x``, ``y`` and ``z`` in m, ``roll``, ``pitch`` and ``yaw`` in rad, and
            ``qx``, ``qy``, ``qz`` and ``qw`` of the unit quaternion. Without any: ``x``, ``y`` and
            ``yaw``.

    Raises:
        CartwheelError: A field does not exist.
    """

    model: str
    fields: tuple[str, ...]

    def __init__(self, model: str, *fields: str) -> None:
        chosen = fields or ("x", "y", "yaw")
        for field in chosen:
            if field not in _FIELDS:
                error = invalid(f"a pose does not have the field {field!r:.60}", "obs")
                error.hint = suggestion(str(field), _FIELDS)
                meant_one = meant(str(field), _FIELDS)
                error.values = {**error.values, "field": str(field), "suggestion": meant_one}
                raise error
        object.__setattr__(self, "model", model)
        object.__setattr__(self, "fields", chosen)

    def reader(self, world: World) -> Callable[[], list[float]]:
        """Returns a function that reads the fields of the current pose.

        Raises:
            UnknownNameError: The model does not exist.
        """
        model, lock = world.model(self.model).name, world.lock
        place = world.session.simulation.truth.place
        which = [_FIELDS.index(field) for field in self.fields]
        has_angles, has_heading = max(which) >= _HEADING, "yaw" in self.fields

        def read() -> list[float]:
            with lock:
                position, turn = place(model)
            numbers = [*position, *turn]
            if has_heading or has_angles:
                numbers.append(yaw_of(turn))
                if has_angles:
                    numbers += rpy_from_quat(turn)
            return [numbers[index] for index in which]

        return read
