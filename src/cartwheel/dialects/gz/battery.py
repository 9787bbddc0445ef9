"""``gz-sim-linearbatteryplugin-system``: a battery that discharges under load."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.codes import devices
from cartwheel.devices.power.battery import Battery, BatteryConfig
from cartwheel.dialects.gz.drive_tags import gz_name
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import SMALLEST, tag


@dataclass(frozen=True, kw_only=True, slots=True)
class BatteryParameters:
    name: str = tag("battery_name", doc="Name of the battery.")
    voltage: float = tag("voltage", unit="V", least=SMALLEST, doc="Initial voltage.")
    constant: float | None = tag(
        "open_circuit_voltage_constant_coef",
        default=None,
        unit="V",
        doc="Open-circuit voltage of the full battery. Default: `<voltage>`.",
    )
    linear: float = tag(
        "open_circuit_voltage_linear_coef",
        default=0.0,
        unit="V",
        doc="Open-circuit voltage of the empty battery minus that of the full battery. Normally "
        "negative.",
    )
    capacity: float = tag("capacity", unit="A h", least=SMALLEST, doc="Charge of the full battery.")
    charge: float | None = tag(
        "initial_charge", default=None, unit="A h", doc="Initial charge. Default: `<capacity>`."
    )
    resistance: float = tag("resistance", default=0.0, unit="Ω", doc="Internal resistance.")
    smoothing: float = tag(
        "smooth_current_tau",
        default=1.0,
        unit="s",
        least=SMALLEST,
        doc="Time constant of the low-pass filter for the current.",
    )
    power: float = tag(
        "power_load",
        default=0.0,
        unit="W",
        doc="Power that is drawn while the battery discharges, also while it is recharged.",
    )
    draining: bool = tag(
        "start_draining",
        default=False,
        doc="Whether the battery starts to discharge when the simulation starts.",
    )
    drain_topics: tuple[str, ...] = tag(
        "power_draining_topic",
        default=(),
        doc="Topic on which any message starts discharging. The message type is Empty, unless "
        "another plugin uses the topic with a different type. Repeat the tag for each "
        "topic.",
    )
    stop_topics: tuple[str, ...] = tag(
        "stop_power_draining_topic",
        default=(),
        doc="Topic on which any message stops discharging. Repeat the tag for each topic.",
    )
    rechargeable: bool = tag(
        "enable_recharge",
        default=False,
        doc="Whether Bool messages can control recharging: a message on "
        "`/model/<model>/battery/<battery_name>/recharge/start` starts it, and a message on "
        "`/model/<model>/battery/<battery_name>/recharge/stop` stops it. Requires "
        "`<charging_time>`.",
    )
    by_topic: bool = tag(
        "recharge_by_topic",
        default=False,
        doc="No effect: recharging is always controlled by topics.",
    )
    charging_time: float = tag(
        "charging_time",
        default=0.0,
        unit="h",
        doc="Time in which an empty battery would be charged to `<capacity>`. Used with "
        "`<enable_recharge>`.",
    )
    invert: bool = tag(
        "invert_current_sign",
        default=False,
        doc="Whether to publish a discharging current as negative, as sensor_msgs/BatteryState "
        "defines it.",
    )
    fixed: bool = tag(
        "fix_issue_225",
        default=False,
        doc="No effect: the fix of gz-sim's issue 225 is always applied.",
    )


class BatteryPlugin(Plugin[BatteryParameters]):
    """Simulates a battery that is discharged with a constant power.

    Discharging starts when a plugin first turns a joint of the model, for example after a drive
    command. It also starts with a message on ``<power_draining_topic>``, or when the simulation
    starts if ``<start_draining>`` is true. The voltage is ``constant + linear (1 - charge /
    capacity) - resistance * current``, where ``constant`` and ``linear`` are the open-circuit
    voltage coefficients.

    While the battery is recharged, a load that has started continues: the charging current is
    the capacity divided by ``<charging_time>``, minus the current of the load. Stop the load on
    ``<stop_power_draining_topic>`` to recharge in this time. Recharging stops at 90 % of the
    capacity. BatteryState messages are published at 50 Hz on
    ``/model/<model>/battery/<battery_name>/state``. The message field ``percentage`` is between 0
    and 1, as sensor_msgs/BatteryState defines it. Cartwheel reports an empty battery, but the robot
    continues to work. Original plugin: ``LinearBatteryPlugin`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = (
        "gz-sim-linearbatteryplugin-system",
        "gz-sim-linear-battery-plugin-system",
    )

    def configure(self) -> None:
        config = self.config
        full = config.capacity
        charge = full if config.charge is None else config.charge
        if not 0 <= charge <= full:
            self.warn(
                devices.PLUGIN_PARAMETER_INVALID,
                f"<initial_charge> must be between 0 and the capacity {full:g} (got {charge:g})",
                values={"parameter": "initial_charge", "value": charge, "most": full},
            )
        rechargeable = config.rechargeable and config.charging_time > 0
        if config.rechargeable and not rechargeable:
            self.warn(
                devices.PLUGIN_PARAMETER_IGNORED,
                "<enable_recharge> has no effect without a positive <charging_time>",
                values={"parameter": "enable_recharge"},
            )
        base = f"/model/{self.part.name}/battery/{config.name}"
        device = BatteryConfig(
            name=config.name,
            state_topic=gz_name(self, f"{base}/state", ""),
            initial_voltage=config.voltage,
            full_voltage=config.voltage if config.constant is None else config.constant,
            voltage_change=config.linear,
            capacity=full,
            charge=min(max(charge, 0.0), full),
            resistance=config.resistance,
            smoothing=config.smoothing,
            power=config.power,
            draining=config.draining,
            drain_topics=tuple(gz_name(self, topic, "") for topic in config.drain_topics),
            stop_topics=tuple(gz_name(self, topic, "") for topic in config.stop_topics),
            charging_time=config.charging_time if rechargeable else 0.0,
            charge_topic=gz_name(self, f"{base}/recharge/start", ""),
            stop_charge_topic=gz_name(self, f"{base}/recharge/stop", ""),
            negative_discharge=config.invert,
        )
        self.add(Battery(self.scope, device))
