"""Shared by the commands for a running simulation."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from cartwheel import yaml_text
from cartwheel.codes.graph import MESSAGE_TEXT_INVALID
from cartwheel.control import ControlClient, find
from cartwheel.errors import CartwheelError


def connect(sim: str | None) -> ControlClient:
    """Connects to the selected simulation.

    Raises:
        ControlError: No simulation is running, or several are.
    """
    return ControlClient(find(sim))


def parse_yaml(words: Sequence[str]) -> Any:
    """A message from the command line: one YAML value, or one value per field.

    Raises:
        CartwheelError: The YAML is invalid.
    """
    import yaml

    try:
        values = [yaml_text.load(word) for word in words]
    except yaml.YAMLError as error:
        raise CartwheelError(
            f"the message is not valid YAML: {str(error).splitlines()[0]}",
            code=MESSAGE_TEXT_INVALID,
            hint="Use the form '{linear: {x: 0.5}}', with a space after each colon.",
        ) from None
    if not values:
        return {}
    # A single value is the message itself; rostopic also accepts a list of field values.
    return values[0] if len(values) == 1 else values
