"""The frames of a model or world: who is placed relative to whom, resolved to poses.

SDF lets links, joints, frames and nested models state their pose relative to any other of
them; here each name is followed to the model's own frame, and to the link that carries it.
"""

from __future__ import annotations

from dataclasses import dataclass

from cartwheel.codes import tags as codes
from cartwheel.errors import DescriptionError, Origin, meant, suggestion
from cartwheel.geometry import Pose

MODEL = "__model__"
WORLD = "world"


@dataclass(frozen=True, slots=True)
class _Frame:
    kind: str
    pose: Pose
    relative_to: str
    """Empty for the scope's own frame."""
    attached_to: str
    """The frame it moves with; empty for itself, as a link does."""
    origin: Origin


class Frames:
    """The named frames of one scope.

    Args:
        kind: What the scope is, "model" or "world", for errors.
        name: Its name.
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
        """A link, joint or frame.

        Raises:
            DescriptionError: another frame has the name.
        """
        if name in self._frames:
            first = self._frames[name]
            raise DescriptionError(
                f'{kind} "{name}" has the same name as another {first.kind} in this {self.kind}',
                code=codes.NAME_TAKEN,
                origin=origin,
                hint=f"The first is at {first.origin}.",
                values={"name": name},
            )
        self._frames[name] = _Frame(kind, pose, relative_to, attached_to, origin)

    def add_scope(
        self, name: str, frames: Frames, pose: Pose, relative_to: str, origin: Origin
    ) -> None:
        """A nested model, placed in this scope."""
        self.add("model", name, pose, relative_to=relative_to, origin=origin)
        self._scopes[name] = frames

    def pose(self, name: str, origin: Origin) -> Pose:
        """The frame within this scope.

        Args:
            name: A frame, ``nested::frame``, or empty for the scope itself.
            origin: Who asks, for the error.

        Raises:
            DescriptionError: there is no such frame, or it is relative to itself.
        """
        return self._pose(name, origin, [])

    def placed(self, pose: Pose, relative_to: str, origin: Origin) -> Pose:
        """A pose stated relative to a frame, within this scope."""
        return self.pose(relative_to, origin) @ pose if relative_to else pose

    def link_of(self, name: str, origin: Origin) -> str:
        """The link that carries a frame, with ``nested::`` before it where it is nested.

        Raises:
            DescriptionError: there is no such frame, or it is attached to itself.
        """
        seen: list[str] = []
        while True:
            if name in ("", MODEL):
                if self.default_link is None:
                    raise DescriptionError(
                        f'{self.kind} "{self.name}" has no link to attach to',
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
        """Whether a frame of a world is attached to nothing but the world."""
        seen: set[str] = set()
        while name not in ("", WORLD, self.name):
            frame = self._frames.get(name)
            if frame is None or frame.kind != "frame" or name in seen:
                return False
            seen.add(name)
            name = frame.attached_to
        return True

    def has(self, name: str) -> bool:
        """Whether a name may be asked for; ``nested::__model__`` is a nested model's frame."""
        outer, inner = self._split(name)
        if inner is not None:
            return self._scopes[outer].has(inner)
        return name in self._frames or name == MODEL

    def kind_of(self, name: str) -> str | None:
        """What a name of this scope stands for: link, joint, frame or model."""
        frame = self._frames.get(name)
        return frame.kind if frame is not None else None

    def names(self) -> list[str]:
        """All names that may be asked for."""
        nested = [f"{k}::{n}" for k, scope in self._scopes.items() for n in scope.names()]
        return [*self._frames, *nested]

    def _pose(self, name: str, origin: Origin, asking: list[str]) -> Pose:
        if name in ("", MODEL) or (name == WORLD and self.kind == WORLD):
            return Pose()
        if name == self.name and name not in self._frames:
            return Pose()  # the scope by its own name, which Gazebo puts up with
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
        """A scoped name as nested model and the name in it; names with ``::`` may be plain too."""
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
