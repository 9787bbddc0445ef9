"""Transforms between frames, now and in the past, from ``/tf`` and ``/tf_static``."""

from __future__ import annotations

import math
from bisect import bisect_left, bisect_right
from collections.abc import Callable, Iterable, Iterator
from operator import itemgetter
from typing import Any

from cartwheel.codes.graph import FRAME_UNKNOWN, FRAMES_NOT_CONNECTED, TRANSFORM_TIME
from cartwheel.errors import GraphError, UnknownNameError
from cartwheel.geometry import Pose, interpolated

SECOND = 1_000_000_000
KEPT_NS = 10 * SECOND
"""Time for which transforms are kept, as tf2 does by default."""
FOREVER_NS = 10**20
_DEEPEST = 1000
"""Maximum number of frames above a frame, as in tf2. A deeper tree is treated as a cycle."""
_UNIT = 10e-3
"""Largest difference of a quaternion's square from 1, as in tf2."""

Sample = tuple[int, str, Pose]
"""Time in ns, parent frame, and pose in it."""
_time = itemgetter(0)


class TransformBuffer:
    """Stores the transforms of each frame for a time. Call it on the owner's thread.

    Source: tf2, ``BufferCore`` and ``TimeCache``. As there, a transform without a frame, from a
    frame to itself, with numbers that are not finite, or with a quaternion that is not a unit
    quaternion is ignored; the error for an unknown frame says so.

    Args:
        now_ns: Simulation time at which it begins, for errors; None keeps all transforms of the
            past, such as those of a recording.
    """

    def __init__(self, now_ns: int | None) -> None:
        self.kept_ns = KEPT_NS if now_ns is not None else FOREVER_NS
        """Older transforms than this before the newest one of a frame are forgotten."""
        self._began_ns = now_ns
        self._moving: dict[str, list[Sample]] = {}
        """The transforms of each frame, in the order of their times."""
        self._static: dict[str, Sample] = {}
        self._ignored: dict[str, str] = {}
        """Why transforms of a frame are ignored."""

    def add(
        self,
        transforms: Iterable[Any],
        *,
        static: bool,
        named: Callable[[str], str] = str,
    ) -> None:
        """Stores ``TransformStamped`` messages.

        Args:
            transforms: The messages.
            static: Whether they apply to all times, as those on ``/tf_static`` do.
            named: Returns the name of a frame here.
        """
        for sent in transforms:
            stamp = sent.header.stamp
            place, turn = sent.transform.translation, sent.transform.rotation
            child = named(sent.child_frame_id.lstrip("/"))
            pose = Pose((place.x, place.y, place.z), (turn.x, turn.y, turn.z, turn.w))
            parent = named(sent.header.frame_id.lstrip("/"))
            if reason := _invalid(child, parent, pose):
                self._ignored[child] = reason
            elif static:
                self._moving.pop(child, None)
                self._static[child] = (0, parent, pose)
            else:
                self._static.pop(child, None)
                self._put(child, (stamp.sec * SECOND + stamp.nanosec, parent, pose))

    def _put(self, child: str, sample: Sample) -> None:
        samples = self._moving.setdefault(child, [])
        oldest = max(samples[-1][0] if samples else 0, sample[0]) - self.kept_ns
        if sample[0] < oldest:
            return
        index = bisect_left(samples, sample[0], key=_time)
        same = index < len(samples) and samples[index][0] == sample[0]
        samples[index : index + same] = [sample]
        # Not at each message: removing from the front of a list moves all others.
        if samples[0][0] < oldest - self.kept_ns // 8:
            del samples[: bisect_left(samples, oldest, key=_time)]

    def rewind(self, now_ns: int) -> None:
        """Forgets all transforms that are later than the time, at time 0 all but static ones."""
        if self._began_ns is not None:
            self._began_ns = min(self._began_ns, now_ns)
        for child, samples in list(self._moving.items()):
            del samples[bisect_right(samples, now_ns, key=_time) if now_ns > 0 else 0 :]
            if not samples:
                del self._moving[child]

    @property
    def frames(self) -> list[str]:
        """Names of all frames, sorted."""
        known = {*self._static, *self._moving}
        known |= {parent for _, parent, _ in self._static.values()}
        for samples in self._moving.values():
            known |= {parent for _, parent, _ in samples}
        return sorted(known)

    def lookup(
        self,
        target: str,
        source: str,
        time_ns: int | None = None,
        *,
        named: Callable[[str], str] = str,
    ) -> Pose:
        """Pose of a frame in another frame, interpolated between two transforms.

        Args:
            target: The frame in which the pose is given.
            source: The frame whose pose is given.
            time_ns: Time, ns; None for the newest time at which all transforms are known.
            named: Returns the name here of a frame that is not known by its own name.

        Raises:
            UnknownNameError: A frame does not exist.
            GraphError: The frames are not connected, or not at this time.
        """
        frames = self.frames
        target, source = (
            frame if frame in frames else named(frame)
            for frame in (target.lstrip("/"), source.lstrip("/"))
        )
        for frame in (target, source):
            if frame not in frames:
                raise self._unknown(frame, frames)
        if target == source:
            return Pose()
        if time_ns is None:
            time_ns = self._latest_common(target, source)
        failures: list[GraphError] = []
        above = dict(self._above(source, time_ns, failures))
        for frame, pose in self._above(target, time_ns, failures):
            if frame in above:
                return pose.inverse() @ above[frame]
        if failures:
            raise failures[0]
        raise _not_connected(target, source)

    def _above(
        self, frame: str, time_ns: int, failures: list[GraphError]
    ) -> Iterator[tuple[str, Pose]]:
        """The frame and those above it, each with the pose of the frame in it."""
        pose = Pose()
        for _ in range(_DEEPEST):
            yield frame, pose
            try:
                sample = self._at(frame, time_ns)
            except GraphError as error:
                # As in tf2, it matters only if both frames do not meet below.
                failures.append(error)
                return
            if sample is None:
                return
            frame, pose = sample[1], sample[2] @ pose

    def _at(self, child: str, time_ns: int) -> Sample | None:
        """The transform of a frame at a time; None for a frame without a parent."""
        if child in self._static:
            return self._static[child]
        samples = self._moving.get(child)
        if samples is None:
            return None
        if not samples[0][0] <= time_ns <= samples[-1][0]:
            raise self._unknown_time(child, samples, time_ns)
        index = bisect_right(samples, time_ns, key=_time) - 1
        before = samples[index]
        if before[0] == time_ns:
            return before
        after = samples[index + 1]
        if before[1] != after[1]:
            return before
        share = (time_ns - before[0]) / (after[0] - before[0])
        return time_ns, before[1], interpolated(before[2], after[2], share)

    def _latest_common(self, target: str, source: str) -> int:
        """The newest time at which all transforms between two frames are known; 0 if all are
        static.
        """
        above = dict(self._latest_above(source))
        for frame, latest in self._latest_above(target):
            if frame in above:
                common = min(latest, above[frame])
                return 0 if common == math.inf else int(common)
        raise _not_connected(target, source)

    def _latest_above(self, frame: str) -> Iterator[tuple[str, float]]:
        """The frame and those above it, each with the newest time of all transforms between."""
        latest = math.inf
        for _ in range(_DEEPEST):
            yield frame, latest
            if frame in self._static:
                frame = self._static[frame][1]
            elif frame in self._moving:
                time_ns, parent, _ = self._moving[frame][-1]
                frame, latest = parent, min(latest, time_ns)
            else:
                return

    def _unknown(self, frame: str, frames: list[str]) -> UnknownNameError:
        error = UnknownNameError("frame", frame, frames, code=FRAME_UNKNOWN)
        if frame in self._ignored:
            error.values = {**error.values, "ignored": self._ignored[frame]}
            error.hint = f"Its transforms are ignored: {self._ignored[frame]}."
        elif self._began_ns is not None and not error.values["meant"]:
            since = self._began_ns / SECOND
            error.values = {**error.values, "since": since}
            error.hint = (
                f"{error.hint or ''} No transform of it has been published since {since:.9g} s. "
                f"Drives publish theirs during a run: call World.keep_transforms before it. In the "
                f"description, a tag of the drive such as <publish_odom_tf> or <publishOdomTF> can "
                f"disable them."
            )
        return error

    def _unknown_time(self, child: str, samples: list[Sample], time_ns: int) -> GraphError:
        oldest, newest, time = (each / SECOND for each in (samples[0][0], samples[-1][0], time_ns))
        past = time < oldest
        bound = f"the oldest is of {oldest:.9g} s" if past else f"the newest is of {newest:.9g} s"
        hint = "Without a time, the newest one at which all transforms are known is used."
        if past and self._began_ns is not None:
            hint = (
                f"Transforms are stored since {self._began_ns / SECOND:.9g} s, "
                f"for {self.kept_ns / SECOND:g} s; World.keep_transforms stores them earlier and "
                f"longer."
            )
        return GraphError(
            f'the pose of "{child}" in "{samples[-1][1]}" at {time:.9g} s is not known: {bound}',
            code=TRANSFORM_TIME,
            hint=hint,
            values={"frame": child, "time": time, "oldest": oldest, "newest": newest},
        )


def _invalid(child: str, parent: str, pose: Pose) -> str:
    """Why tf2 ignores a transform; empty if it does not."""
    if not child or not parent:
        return "a frame has no name"
    if child == parent:
        return "the frame is its own parent"
    if not all(map(math.isfinite, (*pose.position, *pose.orientation))):
        return "a number is not finite"
    if abs(sum(each * each for each in pose.orientation) - 1) > _UNIT:
        return "the quaternion has not the length 1"
    return ""


def _not_connected(target: str, source: str) -> GraphError:
    return GraphError(
        f'the frames "{target}" and "{source}" are not connected',
        code=FRAMES_NOT_CONNECTED,
        hint="No frame is above both of them.",
        values={"target": target, "source": source},
    )
