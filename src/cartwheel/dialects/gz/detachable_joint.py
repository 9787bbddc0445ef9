"""``gz-sim-detachable-joint-system``: a fixed joint to a different model that can be detached."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.grips import attachment
from cartwheel.dialects.gz.drive_tags import gz_name
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag

_OWN = "__model__"
"""Selects the plugin's own model."""


@dataclass(frozen=True, kw_only=True, slots=True)
class DetachableJointParameters:
    parent_link: str = tag(
        "parent_link", doc="Link of this model to which the child link is attached."
    )
    child_model: str = tag(
        "child_model",
        doc="Model that contains the child link. `__model__` is the model that contains the "
        "plugin.",
    )
    child_link: str = tag(
        "child_link", doc="Link of the child model that is attached to the parent link."
    )
    detach_topic: str = tag(
        "detach_topic",
        "topic",
        default="",
        doc="Topic of the Empty messages that detach the child link. Default: "
        "`/model/<model>/detachable_joint/detach`.",
    )
    attach_topic: str = tag(
        "attach_topic",
        default="",
        doc="Topic of the Empty messages that attach the child link again. Default: "
        "`/model/<model>/detachable_joint/attach`.",
    )
    output_topic: str = tag(
        "output_topic",
        default="",
        doc="Topic of the String messages `attached` and `detached`, which are published when "
        "the state changes. Default: `/model/<child_model>/detachable_joint/state`.",
    )
    quiet: bool = tag(
        "suppress_child_warning",
        default=False,
        doc="Whether to suppress the warning if the child model or link does not exist.",
    )


class DetachableJoint(Plugin[DetachableJointParameters]):
    """Attaches a link of another model to a link of this model until a message detaches it.

    The links are attached in their current relative pose, as with a fixed joint. They are attached
    when the simulation starts or, if the child model is spawned later, when it is spawned. Original
    plugin: ``DetachableJoint`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-detachable-joint-system",)

    def configure(self) -> None:
        config, own = self.config, self.part.name
        model, link = config.child_model, config.child_link
        state = config.output_topic or f"model/{model}/detachable_joint/state"
        device = attachment.DetachableJointConfig(
            parent_link=config.parent_link,
            child_model=model,
            child_link=link,
            children=(
                (own if model == _OWN else model, link),
                # A nested model, whose links are prefixed with its name.
                (own, f"{model}::{link}"),
            ),
            attach_topic=gz_name(self, config.attach_topic, "detachable_joint/attach"),
            detach_topic=gz_name(self, config.detach_topic, "detachable_joint/detach"),
            state_topic=gz_name(self, state, ""),
            warn=not config.quiet,
        )
        self.add(attachment.DetachableJoint(self.scope, device))
