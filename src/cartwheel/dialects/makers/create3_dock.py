"""Dock detection and docking status of iRobot's Create 3."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.bases.dock import (
    DockConfig,
    DockStatus,
    DockStatusConfig,
    IrReceivers,
    IrReceiversConfig,
)
from cartwheel.dialects.makers.create3 import out_topic
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import SMALLEST, tag


@dataclass(frozen=True, kw_only=True, slots=True)
class _Dock:
    robot: str = tag(
        "robot_model_name",
        default="",
        doc="No effect: the robot is the model that contains the plugin.",
    )
    receiver: str = tag("receiver_link_name", doc="Link of the robot's infrared receiver.")
    dock: str = tag("dock_model_name", default="", doc="Name of the dock's model in the world.")
    emitter: str = tag("emitter_link_name", default="", doc="Link of the dock's infrared emitter.")


def _dock(config: _Dock) -> DockConfig:
    return DockConfig(receiver=config.receiver, model=config.dock, emitter=config.emitter)


@dataclass(frozen=True, kw_only=True, slots=True)
class Create3OpcodeParameters(_Dock):
    rate: float = tag(
        "update_rate",
        default=31.0,
        unit="Hz",
        least=SMALLEST,
        doc="Rate at which the plugin checks which codes the receivers detect, and publishes them.",
    )
    omni_opening: float = tag(
        "sensor_0_fov", default=1.0, unit="rad", doc="Field of view of the top receiver."
    )
    omni_range: float = tag(
        "sensor_0_range", default=1.0, unit="m", doc="Range of the top receiver."
    )
    front_opening: float = tag(
        "sensor_1_fov", default=1.0, unit="rad", doc="Field of view of the front receiver."
    )
    front_range: float = tag(
        "sensor_1_range", default=1.0, unit="m", doc="Range of the front receiver."
    )


class Create3Opcode(Plugin[Create3OpcodeParameters]):
    """Publishes the infrared codes of a dock that the robot's two receivers detect.

    The dock emits three infrared signals: the halo in all directions, and the red and the green
    buoy, which are two beams. A receiver detects a signal if the dock is in the receiver's field of
    view, and closer than the range of the receiver plus the range of the signal. Original plugin:
    ``gazebo_ros_ir_opcode`` in the package ``irobot_create_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_create_ir_opcode.so",)

    def configure(self) -> None:
        config = self.config
        device = IrReceiversConfig(
            dock=_dock(config),
            receivers=(
                (config.omni_opening, config.omni_range),
                (config.front_opening, config.front_range),
            ),
            topic=out_topic(self),
            rate=config.rate,
        )
        self.add(IrReceivers(self.scope, device))


@dataclass(frozen=True, kw_only=True, slots=True)
class Create3DockStatusParameters(_Dock):
    rate: float = tag(
        "update_rate",
        default=1.0,
        unit="Hz",
        least=SMALLEST,
        doc="Publish rate. A change of the status is also published immediately.",
    )


class Create3DockStatus(Plugin[Create3DockStatusParameters]):
    """Publishes whether the robot detects a dock, and whether it is docked.

    The robot detects the dock while the dock's infrared codes are received on ``ir_opcode``. If the
    world contains no dock, nothing is published. Original plugin: ``gazebo_ros_docking_status`` in
    the package ``irobot_create_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_create_docking_status.so",)

    def configure(self) -> None:
        config = self.config
        device = DockStatusConfig(
            dock=_dock(config),
            topic=out_topic(self),
            opcode_topic="ir_opcode",
            frame="base_link",
            rate=config.rate,
        )
        self.add(DockStatus(self.scope, device))
