"""``gz-sim-detachable-joint-system``: a fixed joint to a different model that can be detached."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.codes import running
from cartwheel.dialects.gz.drive_tags import gz_name
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.messages import message_class

_OWN = "__model__"
"""Selects the plugin's own model."""


@dataclass(frozen=True, kw_only=True, slots=True)
class DetachableJointParameters:
    parent_link: str = tag("parent_link", doc="Link of this model.")
    child_model: str = tag(
        "child_model", doc="Model to attach. `__model__` is the model that contains the plugin."
    )
    child_link: str = tag("child_link", doc="Link of the child model.")
    detach_topic: str = tag(
        "detach_topic",
        "topic",
        default="",
        doc="Topic of the Empty messages that detach the child. Default: "
        "`/model/<model>/detachable_joint/detach`.",
    )
    attach_topic: str = tag(
        "attach_topic",
        default="",
        doc="Topic of the Empty messages that attach the child again. Default: "
        "`/model/<model>/detachable_joint/attach`.",
    )
    output_topic: str = tag(
        "output_topic",
        default="",
        doc="Topic of the state (String): `attached` or `detached`. Published when the "
        "state changes. Default: `/model/<child_model>/detachable_joint/state`.",
    )
    quiet: bool = tag(
        "suppress_child_warning", default=False, doc="Do not warn if the child does not exist."
    )


class DetachableJoint(Plugin[DetachableJointParameters]):
    """Attaches a link of a different model to a link of this model until a message detaches it.

    The links are attached when the simulation starts, in their current relative pose. A child model
    that is spawned later is attached as soon as it exists. Original plugin: ``DetachableJoint`` in
    gz-sim.
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
            self._publish("detached")

    def _join(self) -> None:
        model = self.config.child_model
        own = self.part.name
        places = [
            (own if model == _OWN else model, self.config.child_link),
            # A nested model, whose links are prefixed with its name.
            (own, f"{model}::{self.config.child_link}"),
        ]
        link = next((place for place in places if place in self._surroundings.links), None)
        if link is not None:
            self._joint.hold((own, self.config.parent_link), link)
            self._wanted = False
            self._publish("attached")
        elif not self._missed and not self.config.quiet:
            self._missed = True
            self.warn(
                running.ATTACHMENT_FAILED,
                f'link "{self.config.child_link}" of model "{model}" does not exist yet, so it is '
                "not attached",
                values={"link": self.config.child_link, "model": model},
            )

    def _publish(self, state: str) -> None:
        if self._state.wanted:
            self._state.publish(self._String(state))
