"""The tags of multicopter motor models from rotors_simulator, PX4 and gz-sim."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal

from cartwheel.codes import devices
from cartwheel.devices.air.propeller import Propeller, PropellerConfig
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import SMALLEST, tag

SLOWDOWN = 10.0
"""Default ratio of the speed of the propeller to the speed of its joint."""


@dataclass(frozen=True, kw_only=True, slots=True)
class PropellerTags:
    """The tags that all motor models share."""

    joint: str = tag("jointName", role="joint", doc="Joint of the propeller.")
    link: str = tag(
        "linkName", role="link", doc="Link of the propeller. The thrust acts along its z axis."
    )
    direction: Literal["cw", "ccw"] = tag(
        "turningDirection", doc="Direction of rotation, seen from above."
    )
    kind: Literal["velocity", "position", "force"] = tag(
        "motorType", default="velocity", doc="Command type; only `velocity` is supported."
    )
    motor_constant: float = tag(
        "motorConstant",
        default=8.54858e-06,
        unit="N s²/rad²",
        doc="Thrust divided by the square of the propeller's speed.",
    )
    moment_constant: float = tag(
        "momentConstant",
        default=0.016,
        unit="m",
        doc="Torque on the parent link divided by the thrust.",
    )
    up: float = tag(
        "timeConstantUp",
        default=1 / 80,
        unit="s",
        least=0.0,
        doc="Time constant while the speed increases. 0: at once.",
    )
    down: float = tag(
        "timeConstantDown",
        default=1 / 40,
        unit="s",
        least=0.0,
        doc="Time constant while the speed decreases. 0: at once.",
    )
    drag: float = tag(
        "rotorDragCoefficient",
        default=1e-4,
        unit="N s²/(m rad)",
        doc="Drag force divided by the propeller's speed and by the airspeed perpendicular "
        "to its axis.",
    )
    rolling: float = tag(
        "rollingMomentCoefficient",
        default=1e-6,
        unit="N s²/rad",
        doc="Rolling moment divided by the propeller's speed and by the airspeed "
        "perpendicular to its axis.",
    )
    slowdown: float = tag(
        "rotorVelocitySlowdownSim",
        default=SLOWDOWN,
        least=SMALLEST,
        doc="Speed of the propeller divided by the speed of the joint.",
    )


def max_speed_tag() -> Any:
    """The maximum speed of a propeller, rad/s."""
    return tag(
        "maxRotVelocity",
        default=838.0,
        unit="rad/s",
        least=SMALLEST,
        doc="Maximum speed of the propeller.",
    )


def add_propeller(
    plugin: Plugin[Any],
    *,
    topic: str,
    message: Literal["mav_msgs/msg/Actuators", "actuator_msgs/msg/Actuators"],
    thrust_sign: Literal["direction", "joint", "up"] = "direction",
    max_airspeed: float | None = None,
    signed_rolling: bool = False,
) -> None:
    """Adds the propeller that a plugin describes.

    Args:
        plugin: The plugin, whose parameters are `PropellerTags` with the fields `number` and
            `fastest`.
        topic: Topic of the commands.
        message: Message type of the commands.
        thrust_sign: When the thrust is upwards; see `PropellerConfig`.
        max_airspeed: Axial airspeed at which the thrust becomes 0, m/s.
        signed_rolling: Whether the rolling moment is negated for clockwise propellers.

    Raises:
        PluginError: A parameter is not allowed.
        UnknownNameError: The joint or link does not exist.
    """
    config = plugin.config
    counterclockwise = config.direction == "ccw"
    driven = config.kind == "velocity"
    device = PropellerConfig(
        joint=config.joint,
        link=config.link,
        counterclockwise=counterclockwise,
        driven=driven,
        command_topic=topic,
        command_type=message,
        number=config.number,
        max_speed=config.fastest,
        rise_time=config.up,
        fall_time=config.down,
        slowdown=config.slowdown,
        thrust=config.motor_constant,
        thrust_sign=thrust_sign,
        max_airspeed=max_airspeed,
        moment=config.moment_constant,
        drag=config.drag,
        rolling=-config.rolling if signed_rolling and not counterclockwise else config.rolling,
    )
    plugin.add(Propeller(plugin.scope, device))
    if not driven:
        plugin.warn(
            devices.PLUGIN_PARAMETER_UNSUPPORTED,
            f'<motorType> "{config.kind}" is not supported, so the joint is not driven',
            values={"parameter": "motorType", "value": config.kind},
        )
