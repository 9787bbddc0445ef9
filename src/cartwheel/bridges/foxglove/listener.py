"""Callbacks of the server, called on the server's threads."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cartwheel.bridges.foxglove.controls import Controls, TimeState
from cartwheel.bridges.foxglove.incoming import Incoming
from cartwheel.bridges.foxglove.values import Values
from cartwheel.errors import CartwheelError, Diagnostic


class Listener:
    """Handles client requests without waiting for the simulation.

    Args:
        incoming: Receives client messages.
        values: Parameters.
        controls: Controls of simulation time.
        subscribed: Called with each channel that a client subscribes to or unsubscribes from.
        warn: Receives warnings.
    """

    def __init__(
        self,
        *,
        incoming: Incoming,
        values: Values,
        controls: Controls,
        subscribed: Callable[[int, bool], None],
        warn: Callable[[Diagnostic], None],
    ) -> None:
        self._incoming = incoming
        self._values = values
        self._controls = controls
        self._subscribed = subscribed
        self._warn = warn

    def on_subscribe(self, _: Any, channel: Any) -> None:
        self._subscribed(channel.id, True)

    def on_unsubscribe(self, _: Any, channel: Any) -> None:
        self._subscribed(channel.id, False)

    def on_client_advertise(self, client: Any, channel: Any) -> None:
        self._incoming.advertise(
            client.id, channel.id, channel.topic, channel.encoding, channel.schema_name
        )

    def on_client_unadvertise(self, client: Any, channel: int) -> None:
        self._incoming.unadvertise(client.id, channel)

    def on_message_data(self, client: Any, channel: int, data: bytes) -> None:
        # Copy the data, because the message's arrays are views of it.
        self._incoming.take(client.id, channel, bytes(data))

    def on_get_parameters(self, _: Any, names: list[str], __: str | None = None) -> list[Any]:
        return self._values.get(names)

    def on_set_parameters(self, _: Any, values: list[Any], __: str | None = None) -> list[Any]:
        return self._values.set(values)

    def on_parameters_subscribe(self, names: list[str]) -> None:
        """Does nothing: the server publishes changes of subscribed parameters."""

    def on_parameters_unsubscribe(self, names: list[str]) -> None:
        """Does nothing."""

    def on_connection_graph_subscribe(self) -> None:
        """Does nothing: the server itself sends the last connection graph."""

    def on_connection_graph_unsubscribe(self) -> None:
        """Does nothing."""

    def on_playback_control_request(self, request: Any) -> Any:
        from foxglove.websocket import PlaybackCommand

        controls = self._controls
        try:
            if request.seek_time is not None:
                controls.seek(request.seek_time)
            speed = float(request.playback_speed)
            if speed > 0 and controls.state().speed != speed:
                controls.set_speed(speed)
            play = request.playback_command == PlaybackCommand.Play
            (controls.resume if play else controls.pause)()
        except CartwheelError as error:
            self._warn(error.diagnostic("warning"))
        return playback_state(
            controls.state(),
            did_seek=request.seek_time is not None,
            request_id=request.request_id,
        )


def playback_state(state: TimeState, *, did_seek: bool = False, request_id: str | None) -> Any:
    """Converts a time state to the library's type."""
    from foxglove.websocket import PlaybackState, PlaybackStatus

    return PlaybackState(
        status=PlaybackStatus.Paused if state.paused else PlaybackStatus.Playing,
        current_time=state.time_ns,
        playback_speed=state.speed or 0.0,
        did_seek=did_seek,
        request_id=request_id,
    )
