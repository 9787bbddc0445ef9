"""Playback clock of a recording: runs, pauses, jumps, and publishes messages as they are due."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, NoReturn

from cartwheel.bridges.recording.decoding import Decode, decoder
from cartwheel.bridges.recording.reading import Recorded, RecordedTopic, Recording, span_of
from cartwheel.codes.recording import PLAYBACK_READ_ONLY, RECORDED_TOPIC_LEFT_OUT, RECORDING_EMPTY
from cartwheel.description.model import WorldDescription
from cartwheel.errors import CartwheelError, Diagnostic, RecordingError
from cartwheel.geometry import Pose, Vec3
from cartwheel.graph import Graph, Publisher
from cartwheel.playback.scene import STATE, STRING, PlayedScene
from cartwheel.simulation.run_state import Run
from cartwheel.simulation.snapshot import RunState, Scene, Snapshot

_LOOK_BACK_NS = 2_000_000_000
"""ns before the target of a jump from which the last messages are published again."""
_STEP_NS = 33_333_333
_LONGEST = 0.02
"""Maximum wall time in s per iteration of the playback loop."""


class Player(Run):
    """Publishes a recording's messages. Clients use it like a `Simulation`.

    The thread that calls `run` owns it. A message is decoded only if its topic has subscribers
    or if it changes the displayed scene.

    Args:
        recording: Recording to play.
        graph: Graph to publish on.
        world: World file whose objects are shown around the robots.
        package_path: Directories that are searched first for meshes.
        loop: Whether to restart at the end.
        hold: Whether to pause at the end instead of stopping.

    Raises:
        RecordingError: The recording contains nothing to play.
    """

    def __init__(
        self,
        recording: Recording,
        graph: Graph,
        *,
        world: WorldDescription,
        package_path: Sequence[Path] = (),
        loop: bool = False,
        hold: bool = True,
    ) -> None:
        super().__init__()
        span = span_of(recording)
        if span is None:
            raise RecordingError("the recording contains no messages", code=RECORDING_EMPTY)
        self.start_ns, self.end_ns = span
        self.time_ns = self.start_ns
        self.step_ns = _STEP_NS
        self.world = world
        self._recording = recording
        self._graph = graph
        self._loop = loop
        self._hold = hold
        self._listeners: list[tuple[Callable[[Snapshot], None], float]] = []
        self._due: list[float] = []
        self._played = PlayedScene(world, package_path)
        self._notes: list[Diagnostic] = []
        self._decoders: dict[int, Decode] = {}
        self._latched = self._read_latched()
        self._publishers = self._advertise()
        self._upcoming: Iterator[Recorded] = iter(())
        self._next: Recorded | None = None
        graph.post = self.post
        self.seek(self.start_ns)

    # -- interface of a simulation

    @property
    def diagnostics(self) -> list[Diagnostic]:
        return [*self._notes, *self._played.diagnostics]

    @property
    def scene(self) -> Scene:
        return self._played.scene

    @property
    def models(self) -> tuple[str, ...]:
        return tuple(model.name for model in self.scene.models)

    def pose(self, name: str) -> Pose:
        """Pose of a model."""
        return self._played.pose(name)

    def in_sight(self, _name: str, eyes: Sequence[Vec3], _target: Vec3) -> list[bool]:
        """Whether a model is visible from each point. Always true, as a recording cannot tell."""
        return [True] * len(eyes)

    def resume(self) -> None:
        """Continues playback, from the start if it had reached the end."""
        if self.run_state is RunState.PAUSED and self._next is None:
            self.seek(self.start_ns)
        super().resume()

    def step(self, count: int = 1) -> None:
        """Advances by `count` thirtieths of a second, and pauses."""
        self.pause()
        self._play_until(min(self.time_ns + count * _STEP_NS, self.end_ns))

    def reset(self) -> None:
        """Jumps to the start."""
        self.seek(self.start_ns)
        for callback in self.on_reset:
            callback()

    def delete(self, name: str) -> None:
        """Raises an error, because a recording cannot change.

        Raises:
            RecordingError: Always.
        """
        raise _read_only(name, "deleted")

    def set_pose(self, name: str, _pose: Pose) -> None:
        """Raises an error, because a recording cannot change.

        Raises:
            RecordingError: Always.
        """
        raise _read_only(name, "moved")

    def occupied(self) -> NoReturn:
        """Raises an error, because models cannot be placed in a recording.

        Raises:
            RecordingError: Always.
        """
        raise RecordingError("models cannot be spawned during playback", code=PLAYBACK_READ_ONLY)

    def report(self, diagnostic: Diagnostic) -> None:
        """Stores a diagnostic. Thread-safe."""
        self.post(lambda: self._notes.append(diagnostic))

    def snapshot(self) -> Snapshot:
        """Current state of the displayed scene."""
        return self._played.snapshot(
            self.time_ns, self.run_state, self.speed, self.real_time_factor
        )

    def add_listener(self, listener: Callable[[Snapshot], None], *, rate: float = 30.0) -> None:
        """Calls `listener` with a snapshot at `rate` Hz of wall time."""
        self._listeners.append((listener, 1.0 / rate))
        self._due.append(0.0)

    # -- time

    def seek(self, time_ns: int) -> None:
        """Jumps to a time, and publishes the last messages before it again."""
        time_ns = min(max(time_ns, self.start_ns), self.end_ns)
        if time_ns < self.time_ns:
            self._played.forget()
        self.time_ns = time_ns
        for messages in self._latched.values():
            held = [message for message in messages if message.time_ns <= time_ns] or messages[:1]
            for message in held:
                self._publish(message, always=True)
        last: dict[int, Recorded] = {}
        for message in self._recording.messages(start_ns=time_ns - _LOOK_BACK_NS):
            if message.time_ns > time_ns:
                break
            if message.number in self._latched:
                continue
            if self._recording.topics[message.number].type in STATE:
                self._publish(message)
            else:
                last[message.number] = message
        for message in sorted(last.values()):
            self._publish(message)
        self._upcoming = self._recording.messages(start_ns=time_ns + 1)
        self._next = next(self._upcoming, None)

    def run(self) -> None:
        """Plays until playback is stopped or reaches the end."""
        last = time.perf_counter()
        while True:
            self.drain()
            now = time.perf_counter()
            passed, last = now - last, now
            if self.run_state is RunState.STOPPED:
                return
            if self.run_state is RunState.RUNNING:
                if self._next is None and self.time_ns >= self.end_ns:
                    if not self._end():
                        return
                else:
                    self._go_on(min(passed, 0.25))
            else:
                self.real_time_factor = 0.0
            self._show(time.perf_counter())
            self.wait(self._time_left())

    def _go_on(self, passed: float) -> None:
        if self.speed is None:
            limit = time.perf_counter() + _LONGEST
            while self._next is not None and time.perf_counter() < limit:
                self._play_until(self._next.time_ns)
            if self._next is None:
                self.time_ns = self.end_ns
            self.real_time_factor = 0.0
            return
        self.real_time_factor = self.speed
        self._play_until(min(self.time_ns + int(passed * self.speed * 1e9), self.end_ns))

    def _play_until(self, time_ns: int) -> None:
        while self._next is not None and self._next.time_ns <= time_ns:
            message = self._next
            self.time_ns = message.time_ns
            self._publish(message)
            self._next = next(self._upcoming, None)
        self.time_ns = max(self.time_ns, time_ns)

    def _end(self) -> bool:
        """Handles the end of the recording. Returns whether playback continues."""
        if self._loop:
            self.reset()
            return True
        if self._hold:
            self.run_state = RunState.PAUSED
            return True
        self.run_state = RunState.STOPPED
        return False

    def _time_left(self) -> float:
        """Wall time in s until the next message or redraw is due."""
        if self.run_state is not RunState.RUNNING:
            return _LONGEST
        if self.speed is None:
            return 0.0
        if self._next is None:
            return _LONGEST
        ahead = (self._next.time_ns - self.time_ns) / 1e9 / self.speed
        return min(_LONGEST, max(ahead, 0.0005))

    def _show(self, now: float) -> None:
        snapshot = None
        for index, (listener, period) in enumerate(self._listeners):
            if now >= self._due[index]:
                self._due[index] = now + period
                snapshot = snapshot or self.snapshot()
                listener(snapshot)

    # -- messages

    def _read_latched(self) -> dict[int, list[Recorded]]:
        numbers = {i for i, topic in enumerate(self._recording.topics) if _is_kept(topic)}
        found: dict[int, list[Recorded]] = {number: [] for number in numbers}
        if numbers:
            for message in self._recording.messages(topics=numbers):
                found[message.number].append(message)
        return {number: messages for number, messages in found.items() if messages}

    def _advertise(self) -> dict[int, Publisher]:
        topics = self._recording.topics
        for number, topic in enumerate(topics):
            try:
                self._decoders[number] = decoder(topic)
            except RecordingError as error:
                self._notes.append(
                    RECORDED_TOPIC_LEFT_OUT.because(f"{topic.name} is not played", error)
                )
        for number, messages in self._latched.items():
            # Robot descriptions come first, because other topics are assigned to robots.
            self._describe(topics[number], number, messages[-1])
        publishers = {}
        for number in self._decoders:
            topic = topics[number]
            try:
                publishers[number] = self._graph.advertise(
                    topic.name,
                    topic.type,
                    node=self._played.robot_near(topic.name) or "recording",
                    rate=topic.rate,
                    qos="latched" if number in self._latched else "default",
                )
            except CartwheelError as error:
                self._notes.append(
                    RECORDED_TOPIC_LEFT_OUT.because(
                        f"{topic.name} is not played", error, values={"topic": topic.name}
                    )
                )
        return publishers

    def _describe(self, topic: RecordedTopic, number: int, message: Recorded) -> None:
        if topic.type == STRING and topic.name.endswith("robot_description"):
            made = self._decoded(number, message)
            if made is not None:
                self._played.describe(topic.name, made.data)

    def _publish(self, message: Recorded, *, always: bool = False) -> None:
        number = message.number
        publisher = self._publishers.get(number)
        if publisher is None:
            return
        topic = self._recording.topics[number]
        moves = topic.type in STATE
        if not (publisher.wanted or moves or always):
            return
        made = self._decoded(number, message)
        if made is None:
            return
        if moves:
            self._played.take(topic.name, made)
        elif number in self._latched:
            self._describe(topic, number, message)
        publisher.publish(made)

    def _decoded(self, number: int, message: Recorded) -> Any | None:
        decode = self._decoders.get(number)
        if decode is None:
            return None
        try:
            return decode(message.data)
        except CartwheelError as error:
            name = self._recording.topics[number].name
            self._notes.append(
                RECORDED_TOPIC_LEFT_OUT.because(
                    f"messages on {name} are not played after {message.time_ns / 1e9:.3f} s",
                    error,
                    values={"topic": name, "time": message.time_ns / 1e9},
                )
            )
            del self._decoders[number]
            return None


def _is_kept(topic: RecordedTopic) -> bool:
    """Whether a topic's last message stays valid, as in a latched topic."""
    described = topic.type == STRING and topic.name.endswith("robot_description")
    return topic.latched or described or topic.name == "/tf_static"


def _read_only(name: str, changed: str) -> RecordingError:
    message = f'the recorded model "{name}" cannot be {changed}'
    return RecordingError(message, code=PLAYBACK_READ_ONLY, values={"model": name})
