"""``libgazebo_ros_link_attacher.so`` and ``libgazebo_link_attacher.so``: attached links."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.codes import running, world
from cartwheel.dialects.plugin import Plugin
from cartwheel.errors import UnknownNameError
from cartwheel.messages import service_classes
from cartwheel.simulation.attaching import AttachmentHandle

Place = tuple[str, str]
"""Names of a model and a link."""


@dataclass(frozen=True, kw_only=True, slots=True)
class LinkAttacherParameters:
    pass


class _Attacher(Plugin[LinkAttacherParameters]):
    """Base class of the attachers, which stores the joint of each pair of links."""

    parameters: ClassVar[type] = LinkAttacherParameters
    for_world: ClassVar[bool] = True

    def configure(self) -> None:
        self._surroundings = self.part.surroundings()
        self._joints: list[AttachmentHandle] = []
        self._pairs: dict[frozenset[Place], AttachmentHandle] = {}

    def reset(self) -> None:
        for joint in self._joints:
            joint.release()
        self._pairs.clear()

    def joined(self, one: Place, two: Place) -> bool:
        """Whether the two links are attached."""
        joint = self._pairs.get(frozenset((one, two)))
        return joint is not None and joint.held is not None

    def join(self, one: Place, two: Place) -> None:
        """Attaches two links in their current relative pose."""
        free = (joint for joint in self._joints if joint.held is None)
        joint = next(free, None)
        if joint is None:
            joint = self.part.attachment()
            self._joints.append(joint)
        # If one of the links cannot move, it holds the other one.
        holder, link = (one, two) if two in self._surroundings.moving else (two, one)
        joint.hold(holder, link)
        self._pairs[frozenset((one, two))] = joint

    def separate(self, one: Place, two: Place) -> None:
        """Detaches two links that `join` attached."""
        self._pairs.pop(frozenset((one, two))).release()

    def places(self, *names: str) -> tuple[Place, Place]:
        """Returns the two links in a request.

        Args:
            names: Model, link, model, link.

        Raises:
            UnknownNameError: A model or link does not exist.
        """
        return self._place(*names[:2]), self._place(*names[2:])

    def _place(self, model: str, link: str) -> Place:
        links = [other for owner, other in self._surroundings.links if owner == model]
        if not links:
            models = {owner for owner, _ in self._surroundings.links}
            raise UnknownNameError("model", model, models, code=world.UNKNOWN_MODEL)
        link = link.removeprefix(f"{model}::")
        if link not in links:
            known = [f"{model}::{other}" for other in links]
            raise UnknownNameError("link", f"{model}::{link}", known, code=running.UNKNOWN_LINK)
        return model, link


class LinkAttacher(_Attacher):
    """Attaches and detaches any two links in the world through ROS 1 services.

    Attached links keep their relative pose, as with a fixed joint. Any number of pairs can be
    attached at the same time. Failed requests return ``ok: false``. Unknown models and links also
    cause a warning. Original plugin: ``gazebo_ros_link_attacher`` by PAL Robotics.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_link_attacher.so",)

    def configure(self) -> None:
        super().configure()
        kind = "gazebo_ros_link_attacher/srv/Attach"
        _, self._Response = service_classes(kind)
        self.serve("/link_attacher_node/attach", kind, self._attach)
        self.serve("/link_attacher_node/detach", kind, self._detach)

    def _attach(self, request: Any) -> Any:
        places = self._both(request)
        if places is not None and not self.joined(*places):
            self.join(*places)
        return self._Response(ok=places is not None)

    def _detach(self, request: Any) -> Any:
        places = self._both(request)
        ok = places is not None and self.joined(*places)
        if ok and places is not None:
            self.separate(*places)
        return self._Response(ok=ok)

    def _both(self, request: Any) -> tuple[Place, Place] | None:
        try:
            return self.places(
                request.model_name_1,
                request.link_name_1,
                request.model_name_2,
                request.link_name_2,
            )
        except UnknownNameError as error:
            self.part.report(
                running.ATTACHMENT_FAILED.because(
                    "links cannot be attached or detached",
                    error,
                    origin=self.tag.origin,
                    severity="warning",
                )
            )
            return None


class LinkAttacherRos2(_Attacher):
    """Attaches and detaches any two links in the world through ROS 2 services.

    Attached links keep their relative pose, as with a fixed joint. Any number of pairs can be
    attached at the same time; the original plugin supports only one pair. Failed requests return
    ``success: false`` with a message. Original plugin: ``IFRA_LinkAttacher`` by IFRA-Cranfield.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_link_attacher.so",)

    def configure(self) -> None:
        super().configure()
        kinds = [f"linkattacher_msgs/srv/{name}" for name in ("AttachLink", "DetachLink")]
        (_, self._Attached), (_, self._Detached) = map(service_classes, kinds)
        self.serve("ATTACHLINK", kinds[0], self._attach)
        self.serve("DETACHLINK", kinds[1], self._detach)

    def _attach(self, request: Any) -> Any:
        try:
            one, two = self._both(request)
        except UnknownNameError as error:
            return self._Attached(success=False, message=f"{error.message}. {error.hint}")
        if self.joined(one, two):
            return self._Attached(success=False, message=f"{_pair(one, two)} are already attached")
        self.join(one, two)
        return self._Attached(success=True, message=f"attached {_pair(one, two)}")

    def _detach(self, request: Any) -> Any:
        try:
            one, two = self._both(request)
        except UnknownNameError as error:
            return self._Detached(success=False, message=f"{error.message}. {error.hint}")
        if not self.joined(one, two):
            return self._Detached(success=False, message=f"{_pair(one, two)} are not attached")
        self.separate(one, two)
        return self._Detached(success=True, message=f"detached {_pair(one, two)}")

    def _both(self, request: Any) -> tuple[Place, Place]:
        return self.places(
            request.model1_name, request.link1_name, request.model2_name, request.link2_name
        )


def _pair(one: Place, two: Place) -> str:
    return " and ".join("::".join(place) for place in (one, two))
