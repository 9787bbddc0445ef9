"""hector_quadrotor's propellers and drag."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.devices.air.body_drag import BodyDrag, BodyDragConfig
from cartwheel.devices.air.quadrotor_propulsion import (
    PropulsionModel,
    QuadrotorPropulsion,
    QuadrotorPropulsionConfig,
)
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import SMALLEST, invalid, tag

_UNTIMED = "No effect: each command applies from the next simulation step on."
_DRAG = {"C_wxy": 0.12, "C_wz": 0.1, "C_mxy": 0.074156208, "C_mz": 0.050643264}
"""The defaults of the drag's parameters. Source: hector_quadrotor_model."""
_POSITIVE = ("Psi", "J_M", "R_A")
_NOT_NEGATIVE = ("alpha_m", *_DRAG)


@dataclass(frozen=True, kw_only=True, slots=True)
class _BodyTags:
    """The tags that both plugins share."""

    body: str = tag(
        "bodyName",
        default="",
        role="link",
        doc="No effect, as in Gazebo: the root link is used.",
    )
    frame: str = tag(
        "frameId", default="", role="frame", doc="Frame ID of the messages. Default: the root link."
    )
    update_rate: float = tag("updateRate", default=0.0, doc="No effect, as in Gazebo.")


@dataclass(frozen=True, kw_only=True, slots=True)
class HectorPropulsionParameters(_BodyTags):
    space: str = tag(
        "paramNamespace",
        default="quadrotor_propulsion",
        doc="Namespace of the parameters `k_m`, `k_t`, `CT0s`, `CT1s`, `CT2s`, `Psi`, `J_M`, "
        "`R_A`, `alpha_m`, `beta_m`, `l_m` and `supply_voltage`.",
    )
    command_topic: str = tag(
        "topicName", default="command/motor", doc="Topic of the voltages (MotorCommand)."
    )
    pwm_topic: str = tag(
        "pwmTopicName",
        "voltageTopicName",
        default="motor_pwm",
        doc="Topic of the duty cycles from 0 to 255 (MotorPWM).",
    )
    status_topic: str = tag(
        "statusTopic", default="motor_status", doc="Topic of the motors' states (MotorStatus)."
    )
    status_rate: float = tag(
        "motorStatusRate",
        default=0.0,
        unit="Hz",
        least=0.0,
        doc="Rate of the motors' states. If 0, they are published at every simulation step.",
    )
    supply_topic: str = tag(
        "supplyTopic", default="supply", doc="Topic of the supply's voltage (Supply)."
    )
    wrench_topic: str = tag(
        "wrenchTopic",
        default="propulsion/wrench",
        doc="Topic of the force and the torque (WrenchStamped).",
    )
    supply: float = tag(
        "supplyVoltage",
        default=14.8,
        unit="V",
        least=SMALLEST,
        doc="Voltage of the supply. The parameter `supply_voltage` takes precedence.",
    )
    trigger_topic: str = tag("triggerTopic", default="", doc=_UNTIMED)
    control_rate: float = tag("controlRate", default=0.0, doc=_UNTIMED)
    tolerance: float = tag("controlTolerance", default=0.0, doc=_UNTIMED)
    delay: float = tag("controlDelay", default=0.0, doc=_UNTIMED)


class HectorPropulsion(Plugin[HectorPropulsionParameters]):
    """Applies the thrusts and torques of four propellers, whose motors are driven by voltages.

    The propellers are in front, on the right, at the back and on the left of the root link. A
    motor's torque is proportional to its current, which depends on its voltage and speed. The first
    command switches the motors on. Topics without a name are not used. Parameters that are not on
    the parameter server are those of the motor Roxxy 2827-34 with a propeller of 10 x 4.5 inches.
    Original plugin: ``gazebo_quadrotor_propulsion`` in the package
    ``hector_quadrotor_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libhector_gazebo_quadrotor_propulsion.so",)

    def configure(self) -> None:
        config, link = self.config, self.part.description.canonical_link
        names = [each.name for each in dataclasses.fields(PropulsionModel)]
        stated = read_numbers(self, config.space, [*names, "supply_voltage"])
        supply = stated.pop("supply_voltage", config.supply)
        if supply < SMALLEST:
            raise invalid("supply_voltage", supply, "positive", self.origin)
        self.add(
            QuadrotorPropulsion(
                self.scope,
                QuadrotorPropulsionConfig(
                    link=link,
                    frame=config.frame or link,
                    model=PropulsionModel(**stated),
                    supply=supply,
                    command_topic=config.command_topic.strip(),
                    pwm_topic=config.pwm_topic.strip(),
                    status_topic=config.status_topic.strip(),
                    status_rate=config.status_rate,
                    supply_topic=config.supply_topic.strip(),
                    wrench_topic=config.wrench_topic.strip(),
                ),
            )
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class HectorAerodynamicsParameters(_BodyTags):
    space: str = tag(
        "paramNamespace",
        default="quadrotor_aerodynamics",
        doc="Namespace of the parameters `C_wxy`, `C_wz`, `C_mxy` and `C_mz`.",
    )
    wind_topic: str = tag(
        "windTopicName", default="/wind", doc="Topic of the wind in the world (Vector3), m/s."
    )
    wrench_topic: str = tag(
        "wrenchTopic",
        default="aerodynamics/wrench",
        doc="Topic of the force and the torque (WrenchStamped).",
    )


class HectorAerodynamics(Plugin[HectorAerodynamicsParameters]):
    """Applies drag to the root link, which grows with the square of the airspeed.

    The force along an axis is ``-C |v| v``, with ``C_wxy`` along x and y and ``C_wz`` along z. The
    torque is the same function of the angular velocity, with ``C_mxy`` and ``C_mz``. Parameters
    that are not on the parameter server are 0.12, 0.1, 0.0742 and 0.0506. Original plugin:
    ``gazebo_quadrotor_aerodynamics`` in the package ``hector_quadrotor_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libhector_gazebo_quadrotor_aerodynamics.so",)

    def configure(self) -> None:
        config, link = self.config, self.part.description.canonical_link
        stated = _DRAG | read_numbers(self, config.space, _DRAG)
        level, climb, tilt, turn = (stated[name] for name in _DRAG)
        self.add(
            BodyDrag(
                self.scope,
                BodyDragConfig(
                    link=link,
                    frame=config.frame or link,
                    force=(level, level, climb),
                    torque=(tilt, tilt, turn),
                    wind_topic=config.wind_topic.strip(),
                    wrench_topic=config.wrench_topic.strip(),
                ),
            )
        )


def read_numbers(plugin: Plugin[Any], space: str, names: Any) -> dict[str, float]:
    """Returns the numbers on the parameter server that have one of the names.

    Args:
        plugin: The plugin.
        space: Namespace of the parameters in the plugin's namespace.
        names: Names of the parameters.

    Raises:
        PluginError: A parameter is not a number, or has the wrong sign.
    """
    full = plugin.resolve(space)
    values = plugin.graph.parameters.get(full)
    found: dict[str, float] = {}
    for name in names:
        if not isinstance(values, Mapping) or name not in values:
            continue
        value = values[name]
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise invalid(f"{full}/{name}", str(value), "a number", plugin.origin)
        if value < SMALLEST and name in _POSITIVE:
            raise invalid(f"{full}/{name}", value, "positive", plugin.origin)
        if value < 0 and name in _NOT_NEGATIVE:
            raise invalid(f"{full}/{name}", value, "at least 0", plugin.origin)
        found[name] = float(value)
    return found
