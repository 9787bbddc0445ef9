"""What the commands for a running simulation share."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from cartwheel import yaml_text
from cartwheel.codes.graph import MESSAGE_TEXT_INVALID
from cartwheel.control import ControlClient, find
from cartwheel.errors import CartwheelError


def connect(sim: int | None) -> ControlClient:
    """The simulation that a command means.

    Raises:
        ControlError: There is none, or several.
    """
    return ControlClient(find(sim))


def parse_yaml(words: Sequence[str]) -> Any:
    """A message as the command line gives it: one YAML value, or one for each field.

    Raises:
        CartwheelError: It is no YAML.
    """
    import yaml

    try:
        values = [yaml_text.load(word) for word in words]
    except yaml.YAMLError as error:
        raise CartwheelError(
            f"the message is not valid YAML: {str(error).splitlines()[0]}",
            code=MESSAGE_TEXT_INVALID,
            hint="Write it as '{linear: {x: 0.5}}', with a space after each colon.",
        ) from None
    if not values:
        return {}
    # One value is the message itself; a list of it all is what rostopic takes for Twist.
    return values[0] if len(values) == 1 else values
