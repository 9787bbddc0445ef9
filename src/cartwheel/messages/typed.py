"""Static types of messages, whose classes are created at run time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, ClassVar, Protocol

from cartwheel.codes.graph import MESSAGE_TYPE_UNKNOWN
from cartwheel.errors import GraphError


class Message(Protocol):
    """A message: an instance of a class of `cartwheel.msgs`."""

    __msgtype__: ClassVar[str]
    """Type such as ``sensor_msgs/msg/LaserScan``."""


Kind = type[Message] | str
"""A message type as a class of `cartwheel.msgs`, or by its name."""

if TYPE_CHECKING:
    # Type checkers contain this package, which provides the defaults of Python 3.13.
    from typing_extensions import TypeVar

    M = TypeVar("M", bound=Message, default=Any)
    """Class of the messages of a topic."""
else:
    from typing import TypeVar

    M = TypeVar("M", bound=Message)


def name_of(kind: Kind) -> str:
    """The name of a message type that a program gives as a class or by its name.

    Raises:
        GraphError: It is neither.
    """
    name: object = kind
    if isinstance(kind, type):
        name = getattr(kind, "__msgtype__", None)
    if not isinstance(name, str):
        raise GraphError(
            f"{kind!r} is not a message type",
            code=MESSAGE_TYPE_UNKNOWN,
            values={"type": repr(kind)},
            hint='Pass a class of cartwheel.msgs, or a name such as "sensor_msgs/msg/LaserScan".',
        )
    return name
