"""Converts requests to checked numbers, and builds responses."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from cartwheel.codes.graph import PROPERTY_INVALID, SERVICE_FAILED
from cartwheel.errors import CartwheelError, Diagnostic, GraphError, one_line
from cartwheel.geometry import IDENTITY, Pose, Vec3
from cartwheel.messages import message_class, zero
from cartwheel.simulation.limits import FARTHEST, number, rotation

REPORTED = 200
"""Maximum number of different failures reported in a burst."""


@dataclass(frozen=True, slots=True)
class Answer:
    """A success: Gazebo's status message, and the response's fields."""

    status: str = ""
    fields: dict[str, Any] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    """Sentences about parameters without effect, for the status message."""


Handler = Callable[[Any], Answer]


@dataclass(frozen=True, slots=True)
class Offer:
    """A service of the API."""

    name: str
    """With or without the namespace, as in the API."""
    type: str
    handler: Handler
    threaded: bool = False


def named(*handlers: Handler) -> list[Offer]:
    """Services of gazebo_msgs with the names of their handlers."""
    return [
        Offer(each.__name__, f"gazebo_msgs/srv/{camel(each.__name__)}", each) for each in handlers
    ]


def camel(name: str) -> str:
    """The name of a service as the name of a type: ``get_model_state`` as ``GetModelState``."""
    return "".join(word.capitalize() for word in name.split("_"))


def failed(service: str, error: Exception) -> Diagnostic:
    """The report of a request whose response cannot contain the reason."""
    return SERVICE_FAILED.because(f"{service} failed", error, values={"service": service})


def refused(message: str, name: str, **values: float) -> GraphError:
    """An error in a property of a request."""
    return GraphError(message, code=PROPERTY_INVALID, values={"property": name, **values})


def answering(
    offer: Offer, tell: Callable[[Diagnostic], None], *, title: str = ""
) -> Callable[[Any], Any]:
    """A handler that always returns a response.

    A failed request returns ``success`` false with the reason. If the response has no field for the
    reason, the failure is reported. Internal errors are also reported.

    Args:
        offer: The service.
        tell: Reports failures that the response cannot contain. Thread-safe.
        title: Prefix of each reason.
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
    """Converts ``geometry_msgs/Vector3`` or ``Point``."""
    return (
        number(value.x, f"{name}.x", most=most),
        number(value.y, f"{name}.y", most=most),
        number(value.z, f"{name}.z", most=most),
    )


def pose(value: Any, name: str) -> Pose:
    """Converts ``geometry_msgs/Pose``; a quaternion of zeros is the identity, as in Gazebo.

    Raises:
        CartwheelError: A number is not finite, or the orientation is invalid.
    """
    position = vector(value.position, f"{name}.position")
    q = value.orientation
    parts = (float(q.x), float(q.y), float(q.z), float(q.w))
    if not any(parts):
        return Pose(position, IDENTITY)
    return Pose(position, rotation(parts, f"{name}.orientation"))


def pose_message(where: Pose) -> Any:
    """Creates ``geometry_msgs/Pose``."""
    Pose_, Point = message_class("geometry_msgs/msg/Pose"), message_class("geometry_msgs/msg/Point")
    Quaternion = message_class("geometry_msgs/msg/Quaternion")
    return Pose_(Point(*where.position), Quaternion(*where.orientation))


def vector_message(value: Vec3) -> Any:
    """Creates ``geometry_msgs/Vector3``."""
    return message_class("geometry_msgs/msg/Vector3")(*value)


def twist_message(linear: Vec3, angular: Vec3) -> Any:
    """Creates ``geometry_msgs/Twist``."""
    Twist = message_class("geometry_msgs/msg/Twist")
    return Twist(vector_message(linear), vector_message(angular))
