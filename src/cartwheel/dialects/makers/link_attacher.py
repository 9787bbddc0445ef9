"""``libgazebo_ros_link_attacher.so`` and ``libgazebo_link_attacher.so``: attached links."""

from __future__ import annotations

from typing import Any, ClassVar

from cartwheel.codes import running
from cartwheel.devices.grips.attachment import Attacher, Place
from cartwheel.dialects.plugin import NoTags, Plugin
from cartwheel.errors import UnknownNameError
from cartwheel.messages import service_classes


class _LinkAttacher(Plugin[NoTags]):
    """Base class of both plugins, whose services differ."""

    for_world: ClassVar[bool] = True

    def configure(self) -> None:
        self.attacher = self.add(Attacher(self.scope))

    def _places(self, *names: str) -> tuple[Place, Place]:
        """Returns the two links in a request, whose names are model, link, model, link."""
        return self.attacher.place(*names[:2]), self.attacher.place(*names[2:])


class LinkAttacher(_LinkAttacher):
    """Attaches and detaches any two links in the world through ROS 1 services.

    Attached links keep their relative pose, as with a fixed joint. Any number of pairs can be
    attached at the same time. Failed requests return ``ok: false``. Unknown models and links are
    also reported as warnings. Original plugin: ``gazebo_ros_link_attacher`` by PAL Robotics.
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
        if places is not None and not self.attacher.attached(*places):
            self.attacher.attach(*places)
        return self._Response(ok=places is not None)

    def _detach(self, request: Any) -> Any:
        places = self._both(request)
        ok = places is not None and self.attacher.attached(*places)
        if ok and places is not None:
            self.attacher.detach(*places)
        return self._Response(ok=ok)

    def _both(self, request: Any) -> tuple[Place, Place] | None:
        try:
            return self._places(
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
                )
            )
            return None


class LinkAttacherRos2(_LinkAttacher):
    """Attaches and detaches any two links in the world through ROS 2 services.

    Attached links keep their relative pose, as with a fixed joint. Any number of pairs can be
    attached at the same time; the original plugin supports only one pair at a time. Failed requests
    return ``success: false`` with a message. Original plugin: ``IFRA_LinkAttacher`` by
    IFRA-Cranfield.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_link_attacher.so",)

    def configure(self) -> None:
        super().configure()
        kinds = [f"linkattacher_msgs/srv/{name}" for name in ("AttachLink", "DetachLink")]
        (_, self._Attached), (_, self._Detached) = map(service_classes, kinds)
        self.serve("ATTACHLINK", kinds[0], self._attach)
        self.serve("DETACHLINK", kinds[1], self._detach)

    def _attach(self, request: Any) -> Any:
        return self._Attached(**self._change(request, attach=True))

    def _detach(self, request: Any) -> Any:
        return self._Detached(**self._change(request, attach=False))

    def _change(self, request: Any, *, attach: bool) -> dict[str, Any]:
        """Attaches or detaches two links; returns the fields of the response."""
        try:
            one, two = self._both(request)
        except UnknownNameError as error:
            return {"success": False, "message": f"{error.message}. {error.hint}"}
        pair = " and ".join("::".join(place) for place in (one, two))
        if self.attacher.attached(one, two) == attach:
            state = "already" if attach else "not"
            return {"success": False, "message": f"{pair} are {state} attached"}
        (self.attacher.attach if attach else self.attacher.detach)(one, two)
        return {"success": True, "message": f"{'attached' if attach else 'detached'} {pair}"}

    def _both(self, request: Any) -> tuple[Place, Place]:
        return self._places(
            request.model1_name, request.link1_name, request.model2_name, request.link2_name
        )
