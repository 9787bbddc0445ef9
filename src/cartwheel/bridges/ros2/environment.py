"""ROS environment variables: the domain, and the discovery range."""

from __future__ import annotations

import os
from collections.abc import Mapping

from cartwheel.codes.wires import ROS_VARIABLE_INVALID
from cartwheel.errors import CartwheelError
from rtps_lite.network import LAST_DOMAIN, Reach


def discovery_range(environment: Mapping[str, str] = os.environ) -> Reach:
    """Range from ROS environment variables. The default is this computer only.

    Source: REP 2017's ``ROS_AUTOMATIC_DISCOVERY_RANGE`` and ``ROS_STATIC_PEERS``, and the
    older ``ROS_LOCALHOST_ONLY``.

    Raises:
        CartwheelError: A variable has an invalid value.
    """
    peers = tuple(
        peer.strip() for peer in environment.get("ROS_STATIC_PEERS", "").split(";") if peer.strip()
    )
    only = environment.get("ROS_LOCALHOST_ONLY", "").strip()
    given = environment.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "").upper()
    if only not in ("", "0", "1"):
        raise _invalid("ROS_LOCALHOST_ONLY", only, "0 or 1")
    if only == "1":
        return Reach(range="LOCALHOST")
    if not given:
        return Reach(range="SUBNET" if only == "0" else "LOCALHOST", peers=peers)
    if given == "OFF":
        return Reach(range="OFF")
    if given == "LOCALHOST":
        return Reach(range="LOCALHOST", peers=peers)
    if given in ("SUBNET", "SYSTEM_DEFAULT"):
        return Reach(range="SUBNET", peers=peers)
    raise _invalid(
        "ROS_AUTOMATIC_DISCOVERY_RANGE", given, "OFF, LOCALHOST, SUBNET or SYSTEM_DEFAULT"
    )


def domain_id(environment: Mapping[str, str] = os.environ) -> int:
    """``ROS_DOMAIN_ID``; 0 if unset.

    Raises:
        CartwheelError: The domain is invalid.
    """
    given = environment.get("ROS_DOMAIN_ID", "").strip() or "0"
    if not given.isdecimal() or int(given) > LAST_DOMAIN:
        raise _invalid("ROS_DOMAIN_ID", given, f"a number between 0 and {LAST_DOMAIN}")
    return int(given)


def _invalid(variable: str, value: str, valid: str) -> CartwheelError:
    return CartwheelError(
        f'{variable} has the invalid value "{value}"',
        code=ROS_VARIABLE_INVALID,
        hint=f"Set it to {valid}.",
        values={"variable": variable, "value": value},
    )
