"""``gz-sim-thruster-system``: the propeller of a boat or an underwater vehicle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.codes import devices
from cartwheel.devices.water.thruster import Thruster, ThrusterConfig
from cartwheel.dialects.gz.bridge_file import namespaced
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.errors import PluginError

_NO_EFFECT = "No effect: the propeller turns at the speed that belongs to its thrust."


@dataclass(frozen=True, kw_only=True, slots=True)
class ThrusterParameters:
    joint: str = tag(
        "joint_name",
        role="joint",
        doc="Joint of the propeller. The thrust acts on its child link, along its axis.",
    )
    namespace: str = tag(
        "namespace", default="", doc="Namespace of the topics. Default: the model's name."
    )
    topic: str = tag(
        "topic",
        default="",
        doc="Topic of the commands (Float64), relative to `<namespace>`. Default: "
        "`/model/<namespace>/joint/<joint>/cmd_thrust`, or `cmd_vel` with `<use_angvel_cmd>`.",
    )
    by_speed: bool = tag(
        "use_angvel_cmd",
        default=False,
        doc="Whether commands are speeds in rad/s. If false, they are forces in N.",
    )
    most: float = tag(
        "max_thrust_cmd", default=1000.0, unit="N or rad/s", doc="Maximum of the commands."
    )
    least: float = tag(
        "min_thrust_cmd", default=-1000.0, unit="N or rad/s", doc="Minimum of the commands."
    )
    deadband: float = tag(
        "deadband",
        default=0.0,
        unit="N",
        least=0.0,
        doc="Thrust below which the propeller stands still.",
    )
    density: float = tag("fluid_density", default=1000.0, unit="kg/m³", doc="Density of the fluid.")
    diameter: float = tag(
        "propeller_diameter", default=0.02, unit="m", doc="Diameter of the propeller."
    )
    coefficient: float | None = tag(
        "thrust_coefficient",
        default=None,
        doc="Thrust divided by the density, the square of the speed in rad/s and the fourth power "
        "of the diameter. It is negative if the propeller turns in the other direction. Default: "
        "`<alpha_1>`.",
    )
    alpha_1: float = tag(
        "alpha_1", default=1.0, doc="Thrust coefficient at standstill of the vehicle."
    )
    alpha_2: float = tag(
        "alpha_2",
        default=0.0,
        doc="Change of the thrust coefficient with the advance ratio. No effect with "
        "`<thrust_coefficient>`.",
    )
    wake_fraction: float = tag(
        "wake_fraction",
        default=0.2,
        doc="Part of the vehicle's speed by which the water at the propeller is slower.",
    )
    velocity_control: bool = tag("velocity_control", default=False, doc=_NO_EFFECT)
    p: float = tag("p_gain", default=0.1, doc=_NO_EFFECT)
    i: float = tag("i_gain", default=0.0, doc=_NO_EFFECT)
    d: float = tag("d_gain", default=0.0, doc=_NO_EFFECT)
    power_load: float = tag("power_load", default=0.0, unit="W", doc="No effect.")
    battery: str = tag("battery_name", default="", doc="No effect.")


def topics(model: str, namespace: str, config: ThrusterParameters) -> tuple[str, str, str]:
    """Returns the topics of the commands, of the state, and of the switch of the deadband.

    Args:
        model: Name of the model.
        namespace: Namespace in which the model was spawned, for topics in a `<namespace>`.
        config: The tags.
    """
    command, state = ("cmd_vel", "force") if config.by_speed else ("cmd_thrust", "ang_vel")
    stated = config.namespace.strip().strip("/")
    if config.topic.strip():
        topic = under = f"{stated or model}/{config.topic.strip()}"
    else:
        under = f"model/{stated or model}/joint/{config.joint.strip()}"
        topic = f"{under}/{command}"
    space = namespace if stated else ""
    command, state, deadband = (
        namespaced(each, space) for each in (topic, f"{under}/{state}", f"{under}/enable_deadband")
    )
    return command, state, deadband


class ThrusterSystem(Plugin[ThrusterParameters]):
    """Applies the commanded thrust of a marine propeller to its link, and turns the propeller.

    The propeller turns at most at 100 rad/s, because its joint is only for show. Original plugin:
    ``Thruster`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-thruster-system",)

    def configure(self) -> None:
        config = self.config
        self.check_above_zero(propeller_diameter=config.diameter, fluid_density=config.density)
        if config.least > config.most:
            raise PluginError(
                "<min_thrust_cmd> must not exceed <max_thrust_cmd> "
                f"(got {config.least:g} and {config.most:g})",
                code=devices.PLUGIN_RANGE_REVERSED,
                origin=self.place_of("min_thrust_cmd"),
                values={
                    "parameter": "min_thrust_cmd",
                    "value": config.least,
                    "most": config.most,
                },
            )
        command, state, deadband = topics(self.part.name, self.part.namespace, config)
        stated = config.coefficient
        self.add(
            Thruster(
                self.scope,
                ThrusterConfig(
                    joint=config.joint.strip(),
                    command="velocity" if config.by_speed else "force",
                    command_topic=command,
                    state_topic=state,
                    deadband_topic=deadband,
                    least=config.least,
                    most=config.most,
                    deadband=config.deadband,
                    density=config.density,
                    diameter=config.diameter,
                    coefficient=config.alpha_1 if stated is None else stated,
                    advance_slope=config.alpha_2 if stated is None else 0.0,
                    wake_fraction=config.wake_fraction,
                ),
            )
        )
