"""``gz-sim-detachable-joint-system``: a joint to another model, until it is told to part."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.codes import running
from cartwheel.messages import message_class
from cartwheel.plugins.base import Plugin
from cartwheel.plugins.gz_drive import gz_name
from cartwheel.plugins.parameters import tag

_OWN = "__model__"
"""Names the plugin's own model."""


@dataclass(frozen=True, kw_only=True, slots=True)
class DetachableJointParameters:
    parent_link: str = tag("parent_link", doc="Link of this model.")
    child_model: str = tag("child_model", doc="Model that is attached; `__model__` is this one.")
    child_link: str = tag("child_link", doc="Its link.")
    detach_topic: str = tag(
        "detach_topic",
        "topic",
        default="",
        doc="Empty that parts them; /model/<name>/detachable_joint/detach when empty.",
    )
    attach_topic: str = tag(
        "attach_topic",
        default="",
        doc="Empty that joins them again; /model/<name>/detachable_joint/attach when empty.",
    )
    output_topic: str = tag(
        "output_topic",
        default="",
        doc="String, attached or detached, whenever it changes; "
        "/model/<child_model>/detachable_joint/state when empty.",
    )
    quiet: bool = tag(
        "suppress_child_warning", default=False, doc="Say nothing of a child that is not there."
    )


class DetachableJoint(Plugin[DetachableJointParameters]):
    """Joins a link of its model to one of another model as they stand, from the start.

    A child that comes later is joined as soon as it is there. Source: gz-sim, DetachableJoint.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-detachable-joint-system",)
    parameters: ClassVar[type] = DetachableJointParameters

    def configure(self) -> None:
        config, part = self.config, self.part
        part.link(config.parent_link, origin=self.tag.origin)
        self._joint = part.attachment()
        self._surroundings = part.surroundings()
        self._wanted = True
        self._missed = False
        self._String = message_class("std_msgs/msg/String")
        self._state = self.advertise(
            gz_name(
                self,
                config.output_topic or f"/model/{config.child_model}/detachable_joint/state",
                "",
            ),
            "std_msgs/msg/String",
        )
        for topic, default, act in (
            (config.detach_topic, "detach", self._detach),
            (config.attach_topic, "attach", self._attach),
        ):
            name = gz_name(self, topic, f"detachable_joint/{default}")
            self.subscribe(name, "std_msgs/msg/Empty", act)
        part.schedule(0, before=self._join, active=lambda: self._wanted)

    def reset(self) -> None:
        self._joint.release()
        self._wanted = True

    def _attach(self, _: Any) -> None:
        self._wanted = self._joint.held is None

    def _detach(self, _: Any) -> None:
        if self._joint.held is not None:
            self._joint.release()
            self._tell("detached")

    def _join(self) -> None:
        model = self.config.child_model
        own = self.part.name
        places = [
            (own if model == _OWN else model, self.config.child_link),
            # A model in this model, whose links have its name before theirs.
            (own, f"{model}::{self.config.child_link}"),
        ]
        found = next((place for place in places if place in self._surroundings.links), None)
        if found is not None:
            self._joint.hold((own, self.config.parent_link), found)
            self._wanted = False
            self._tell("attached")
        elif not self._missed and not self.config.quiet:
            self._missed = True
            self.warn(
                running.ATTACHMENT_FAILED,
                f'there is no link "{self.config.child_link}" in a model "{model}" to attach',
                values={"link": self.config.child_link, "model": model},
            )

    def _tell(self, state: str) -> None:
        if self._state.wanted:
            self._state.publish(self._String(state))
