"""Parameters for clients: those of the graph, robot descriptions, and time controls."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from cartwheel.bridges.bridged import BridgedGraph
from cartwheel.bridges.foxglove.controls import Controls
from cartwheel.codes.graph import PARAMETER_VALUE_INVALID
from cartwheel.codes.wires import PARAMETER_REFUSED
from cartwheel.errors import CartwheelError, Diagnostic, GraphError

_MOST, _MOST_BYTES, _LARGEST = 1000, 4 << 20, 64 << 10
"""Limits on parameters that clients set: number, characters in total, and characters of one."""
_LONGEST_NAME = 256
PAUSED, SPEED = "/cartwheel/paused", "/cartwheel/speed"
"""Whether time is paused, and the target real-time factor; 0 is as fast as possible."""


class _FullError(GraphError):
    """A parameter is too large, or there are too many parameters."""

    code = PARAMETER_REFUSED


class Values:
    """Reads and sets parameters. Thread-safe.

    Args:
        graph: Graph with the parameters.
        controls: Controls of simulation time.
        descriptions: Robot descriptions by topic.
        warn: Receives warnings.
    """

    def __init__(
        self,
        graph: BridgedGraph,
        *,
        controls: Controls,
        descriptions: Mapping[str, str],
        warn: Callable[[Diagnostic], None],
    ) -> None:
        self._graph = graph
        self._controls = controls
        self._descriptions = descriptions
        self._warn = warn
        self._sizes: dict[str, int] = {}
        """Characters of the parameters that clients have set."""
        self._lock = threading.Lock()

    def get(self, names: list[str]) -> list[Any]:
        """Parameters with these names, or all parameters if no name is given."""
        from foxglove import Parameter

        found = {name: self._one(name) for name in names} if names else dict(self._all())
        wanted = names or sorted(found)
        values = ((name, found[name]) for name in wanted)
        return [Parameter(name, value=value) for name, value in values if value is not None]

    def set(self, values: list[Any]) -> list[Any]:
        """Sets parameters. Returns their resulting values."""
        for value in values:
            try:
                self._set_one(value.name, value.get_value())
            except _FullError as error:
                # The warning omits the name, so that it is reported once for any number of
                # parameters.
                self._warn(error.diagnostic("warning"))
            except CartwheelError as error:
                self._warn(
                    PARAMETER_REFUSED.because(
                        f"parameter {value.name[:_LONGEST_NAME]} was not set",
                        error,
                        values={"parameter": value.name[:_LONGEST_NAME]},
                    )
                )
        return self.get([value.name for value in values])

    def _set_one(self, name: str, value: Any) -> None:
        controls = self._controls
        if name == PAUSED:
            if not isinstance(value, bool):
                raise GraphError("the value must be true or false", code=PARAMETER_VALUE_INVALID)
            (controls.pause if value else controls.resume)()
        elif name == SPEED:
            number = isinstance(value, int | float) and not isinstance(value, bool)
            if not number:
                raise GraphError(
                    "the value must be a number; 0 means as fast as possible",
                    code=PARAMETER_VALUE_INVALID,
                )
            controls.set_speed(float(value) or None)
        elif name in self._descriptions:
            raise GraphError(
                "a robot's description cannot be changed while the robot is simulated",
                code=PARAMETER_REFUSED,
                values={"parameter": name},
            )
        else:
            with self._lock:
                size = self._room_for(name, value)
                self._graph.parameters.set(name, value)
                self._sizes[name] = size

    def _room_for(self, name: str, value: Any) -> int:
        """Size of a parameter. Rejects a parameter that exceeds the memory limits."""
        size = len(name) + len(repr(value))
        if len(name) > _LONGEST_NAME or size > _LARGEST:
            raise _FullError(
                f"a client's parameter was not set because its name exceeds {_LONGEST_NAME} "
                f"characters or its value exceeds {_LARGEST >> 10} KiB",
                values={"limit": "size"},
            )
        known = self._sizes.get(name)
        if known is None and len(self._sizes) >= _MOST:
            raise _FullError(
                f"clients may set at most {_MOST} parameters; additional parameters are not set",
                values={"limit": "count"},
            )
        if sum(self._sizes.values()) - (known or 0) + size > _MOST_BYTES:
            raise _FullError(
                f"parameters set by clients may occupy at most {_MOST_BYTES >> 20} MiB; additional "
                "parameters are not set",
                values={"limit": "bytes"},
            )
        return size

    def _one(self, name: str) -> Any:
        """A value, or None if no single parameter has this name."""
        if name in (PAUSED, SPEED):
            state = self._controls.state()
            return state.paused if name == PAUSED else float(state.speed or 0.0)
        if name in self._descriptions:
            return self._descriptions[name]
        try:
            value = self._graph.parameters.get(name)
        except CartwheelError:
            return None
        return None if isinstance(value, Mapping) else value

    def _all(self) -> Iterator[tuple[str, Any]]:
        yield from _flat("", self._graph.parameters.get("/", {}))
        yield from self._descriptions.items()
        state = self._controls.state()
        yield PAUSED, state.paused
        yield SPEED, float(state.speed or 0.0)


def _flat(prefix: str, tree: Mapping[str, Any]) -> Iterator[tuple[str, Any]]:
    for name, value in tree.items():
        if isinstance(value, Mapping):
            yield from _flat(f"{prefix}/{name}", value)
        elif value is not None:
            yield f"{prefix}/{name}", value
