"""The middleware of a ROS 2 connection."""

from __future__ import annotations

from typing import Literal, get_args

from cartwheel.codes.command import OPTION_INVALID
from cartwheel.errors import CartwheelError
from cartwheel.options import RMW

Rmw = Literal["dds", "zenoh"]


def check_rmw(name: str) -> None:
    """Refuses an unknown middleware of ROS 2.

    Raises:
        CartwheelError: The middleware is unknown.
    """
    if name not in get_args(Rmw):
        raise CartwheelError(
            f"{RMW} must be {' or '.join(get_args(Rmw))} (got {name})",
            code=OPTION_INVALID,
            values={"option": str(RMW), "value": name},
        )
