"""What a request says, as checked numbers, and what an answer is made of."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from cartwheel.codes.graph import SERVICE_FAILED
from cartwheel.errors import CartwheelError, Diagnostic, one_line
from cartwheel.geometry import IDENTITY, Pose, Vec3
from cartwheel.messages import message_class, zero
from cartwheel.simulation.limits import FARTHEST, number, rotation

REPORTED = 200
"""Different failures that are reported at once."""


@dataclass(frozen=True, slots=True)
class Answer:
    """A success: what Gazebo's status message says of it, and the response's fields."""

    status: str = ""
    fields: dict[str, Any] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    """What of the request has no effect, sentences for the status message."""


Handler = Callable[[Any], Answer]


@dataclass(frozen=True, slots=True)
class Offer:
    """A service of the API."""

    name: str
    """With or without the namespace, as the API has it."""
    type: str
    handler: Handler
    threaded: bool = False


def answering(
    offer: Offer, tell: Callable[[Diagnostic], None], *, title: str = ""
) -> Callable[[Any], Any]:
    """A handler for the graph that answers in any case.

    A request that cannot be met is answered with ``success`` false and the reason; where the
    response has no room for it, it is told. Faults of ours are told as well.

    Args:
        offer: The service.
        tell: Takes what no answer tells; from any thread.
        title: Before each reason.
    """
    response_type = f"{offer.type}_Response"

    def handle(request: Any) -> Any:
        response = zero(response_type)
        try:
            answer = offer.handler(request)
        except Exception as error:  # noqa: BLE001 - the caller waits for an answer
            text = one_line(error)
            says = hasattr(response, "status_message")
            if says:
                response.status_message = f"{title}: {text}" if title else text
            if not says or not isinstance(error, CartwheelError):
                tell(
                    SERVICE_FAILED.because(
                        f"{title or offer.name} failed", error, values={"service": offer.name}
                    )
                )
            return response
        for name, value in answer.fields.items():
            setattr(response, name, value)
        if hasattr(response, "success"):
            response.success = True
        if hasattr(response, "status_message"):
            response.status_message = "; ".join((answer.status, *answer.notes))
        return response

    return handle


def vector(value: Any, name: str, *, most: float = FARTHEST) -> Vec3:
    """``geometry_msgs/Vector3`` or ``Point``."""
    return (
        number(value.x, f"{name}.x", most=most),
        number(value.y, f"{name}.y", most=most),
        number(value.z, f"{name}.z", most=most),
    )


def pose(value: Any, name: str) -> Pose:
    """``geometry_msgs/Pose``; an orientation of zeros, which nobody set, is none, as in Gazebo.

    Raises:
        CartwheelError: A number is not finite, or the orientation is no rotation.
    """
    position = vector(value.position, f"{name}.position")
    q = value.orientation
    parts = (float(q.x), float(q.y), float(q.z), float(q.w))
    if not any(parts):
        return Pose(position, IDENTITY)
    return Pose(position, rotation(parts, f"{name}.orientation"))


def pose_message(where: Pose) -> Any:
    """``geometry_msgs/Pose``."""
    Pose_, Point = message_class("geometry_msgs/msg/Pose"), message_class("geometry_msgs/msg/Point")
    Quaternion = message_class("geometry_msgs/msg/Quaternion")
    return Pose_(Point(*where.position), Quaternion(*where.orientation))


def vector_message(value: Vec3) -> Any:
    """``geometry_msgs/Vector3``."""
    return message_class("geometry_msgs/msg/Vector3")(*value)


def twist_message(linear: Vec3, angular: Vec3) -> Any:
    """``geometry_msgs/Twist``."""
    Twist = message_class("geometry_msgs/msg/Twist")
    return Twist(vector_message(linear), vector_message(angular))
