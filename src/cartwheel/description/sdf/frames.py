"""Resolves the frames in a model or world to poses.

In SDF, the poses of links, joints, frames and nested models can be relative to any other of them.
This module resolves each name to a pose in the model's frame, and to the link that it is attached
to.
"""

from __future__ import annotations

from dataclasses import dataclass

from cartwheel.codes import tags as codes
from cartwheel.errors import DescriptionError, Origin
from cartwheel.geometry import Pose
from cartwheel.similar_names import meant, suggestion

MODEL = "__model__"
WORLD = "world"


@dataclass(frozen=True, slots=True)
class _Frame:
    kind: str
    pose: Pose
    relative_to: str
    """Empty for the scope's own frame."""
    attached_to: str
    """The frame that it moves with; empty for itself, as for a link."""
    origin: Origin


class Frames:
    """The named frames in one scope.

    Args:
        kind: Type of the scope, "model" or "world", for errors.
        name: Name of the scope.
    """

    def __init__(self, kind: str, name: str) -> None:
        self.kind = kind
        self.name = name
        self.default_link: str | None = None
        """The link that the scope's own frame is attached to."""
        self._frames: dict[str, _Frame] = {}
        self._scopes: dict[str, Frames] = {}
        self._resolved: dict[str, Pose] = {}

    def add(
        self,
        kind: str,
        name: str,
        pose: Pose,
        *,
        relative_to: str = "",
        attached_to: str = "",
        origin: Origin,
    ) -> None:
        """Adds a link, joint or frame.

        Raises:
            DescriptionError: The name is already in use.
        """
        if name in self._frames:
            first = self._frames[name]
            raise DescriptionError(
                f'{kind} "{name}" has the same name as another {first.kind} in this {self.kind}',
                code=codes.NAME_TAKEN,
                origin=origin,
                hint=f"The first definition is at {first.origin}.",
                values={"name": name},
            )
        self._frames[name] = _Frame(kind, pose, relative_to, attached_to, origin)

    def add_scope(
        self, name: str, frames: Frames, pose: Pose, relative_to: str, origin: Origin
    ) -> None:
        """Adds a nested model."""
        self.add("model", name, pose, relative_to=relative_to, origin=origin)
        self._scopes[name] = frames

    def pose(self, name: str, origin: Origin) -> Pose:
        """The pose of a frame in this scope.

        Args:
            name: A frame, ``nested::frame``, or empty for the scope itself.
            origin: Origin of the reference, for the error.

        Raises:
            DescriptionError: The frame does not exist, or is relative to itself.
        """
        return self._pose(name, origin, [])

    def placed(self, pose: Pose, relative_to: str, origin: Origin) -> Pose:
        """Converts a pose relative to a frame to a pose in this scope."""
        return self.pose(relative_to, origin) @ pose if relative_to else pose

    def link_of(self, name: str, origin: Origin) -> str:
        """The link that a frame is attached to, with ``nested::`` as a prefix if it is nested.

        Raises:
            DescriptionError: The frame does not exist, or is attached to itself.
        """
        seen: list[str] = []
        while True:
            if name in ("", MODEL):
                if self.default_link is None:
                    raise DescriptionError(
                        f'{self.kind} "{self.name}" has no link that a frame or joint can be '
                        "attached to",
                        code=codes.MODEL_EMPTY,
                        origin=origin,
                        values={"name": self.name},
                    )
                return self.default_link
            if name in seen:
                raise DescriptionError(
                    f"frames form an attachment cycle: {' -> '.join([*seen, name])}",
                    code=codes.FRAMES_CIRCULAR,
                    values={"names": (*seen, name)},
                    origin=origin,
                )
            seen.append(name)
            outer, inner = self._split(name)
            if inner is not None:
                return f"{outer}::{self._scopes[outer].link_of(inner, origin)}"
            frame = self._require(name, origin)
            if name in self._scopes:
                return f"{name}::{self._scopes[name].link_of('', origin)}"
            if frame.kind == "link":
                return name
            name = frame.attached_to

    def stays(self, name: str) -> bool:
        """Whether a frame in a world is attached only to the world."""
        seen: set[str] = set()
        while name not in ("", WORLD, self.name):
            frame = self._frames.get(name)
            if frame is None or frame.kind != "frame" or name in seen:
                return False
            seen.add(name)
            name = frame.attached_to
        return True

    def has(self, name: str) -> bool:
        """Whether a name can be resolved; ``nested::__model__`` is a nested model's frame."""
        outer, inner = self._split(name)
        if inner is not None:
            return self._scopes[outer].has(inner)
        return name in self._frames or name == MODEL

    def kind_of(self, name: str) -> str | None:
        """The type of a name in this scope: link, joint, frame or model."""
        frame = self._frames.get(name)
        return frame.kind if frame is not None else None

    def names(self) -> list[str]:
        """All names that can be resolved."""
        nested = [f"{k}::{n}" for k, scope in self._scopes.items() for n in scope.names()]
        return [*self._frames, *nested]

    def links(self) -> list[str]:
        """The names of all links, which are suggested where a link is usual."""
        nested = [f"{k}::{n}" for k, scope in self._scopes.items() for n in scope.links()]
        return [name for name, frame in self._frames.items() if frame.kind == "link"] + nested

    def _pose(self, name: str, origin: Origin, asking: list[str]) -> Pose:
        if name in ("", MODEL) or (name == WORLD and self.kind == WORLD):
            return Pose()
        if name == self.name and name not in self._frames:
            return Pose()  # the scope's own name, which Gazebo accepts
        outer, inner = self._split(name)
        if inner is not None:
            scope = self._scopes[outer]
            return self._pose(outer, origin, asking) @ scope.pose(inner, origin)
        if name in self._resolved:
            return self._resolved[name]
        frame = self._require(name, origin)
        if name in asking:
            circle = " -> ".join([*asking[asking.index(name) :], name])
            raise DescriptionError(
                f"poses form a reference cycle: {circle}",
                code=codes.FRAMES_CIRCULAR,
                origin=frame.origin,
                values={"names": (*asking[asking.index(name) :], name)},
            )
        base = frame.relative_to or (frame.attached_to if frame.kind != "link" else "")
        result = self._pose(base, frame.origin, [*asking, name]) @ frame.pose
        self._resolved[name] = result
        return result

    def _split(self, name: str) -> tuple[str, str | None]:
        """A scoped name as nested model and inner name; plain names may also contain ``::``."""
        if name in self._frames or "::" not in name:
            return name, None
        parts = name.split("::")
        for count in range(len(parts) - 1, 0, -1):
            outer = "::".join(parts[:count])
            if outer in self._scopes:
                return outer, "::".join(parts[count:])
        return name, None

    def _require(self, name: str, origin: Origin) -> _Frame:
        frame = self._frames.get(name)
        if frame is None:
            raise DescriptionError(
                f'the frame "{name}" does not exist in {self.kind} "{self.name}"',
                code=codes.NAME_UNKNOWN,
                origin=origin,
                hint=suggestion(name, self.names()),
                values={"name": name, "meant": meant(name, self.names())},
            )
        return frame
