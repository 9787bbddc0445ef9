"""``gz-sim-velocity-control-system``: holds a model at a commanded velocity."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.codes import devices
from cartwheel.devices.drives.body_velocity import BodyVelocity, BodyVelocityConfig
from cartwheel.dialects.gz.drive_tags import gz_name
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.errors import PluginError
from cartwheel.simulation.limits import FARTHEST

_AT_REST = (0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True, slots=True)
class VelocityControlParameters:
    topic: str = tag(
        "topic",
        default="",
        doc="Topic of the Twist commands. Default: `/model/<model>/cmd_vel`.",
    )
    initial_linear: tuple[float, float, float] | None = tag(
        "initial_linear",
        default=None,
        unit="m/s",
        most=FARTHEST,
        doc="Initial linear velocity.",
    )
    initial_angular: tuple[float, float, float] | None = tag(
        "initial_angular",
        default=None,
        unit="rad/s",
        most=FARTHEST,
        doc="Initial angular velocity.",
    )


class VelocityControl(Plugin[VelocityControlParameters]):
    """Moves the model at the commanded linear and angular velocity, expressed in its own frame.

    All six degrees of freedom are controlled. Without an initial velocity, the model moves freely
    until the first command. Original plugin: ``VelocityControl`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-velocity-control-system",)
    moves_model: ClassVar[bool] = True

    def configure(self) -> None:
        if self.tag.element.find("link_name"):
            raise PluginError(
                "<link_name> is not supported because only whole models are moved",
                code=devices.PLUGIN_PARAMETER_UNSUPPORTED,
                origin=self.place_of("link_name"),
                values={"parameter": "link_name"},
            )
        linear, angular = self.config.initial_linear, self.config.initial_angular
        moves = linear is not None or angular is not None
        self.add(
            BodyVelocity(
                self.scope,
                BodyVelocityConfig(
                    topic=gz_name(self, self.config.topic, "cmd_vel"),
                    motion="spatial",
                    initial=(linear or _AT_REST, angular or _AT_REST) if moves else None,
                ),
            )
        )
