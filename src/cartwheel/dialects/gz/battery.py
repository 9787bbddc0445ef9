"""``gz-sim-linearbatteryplugin-system``: a battery that discharges under load."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import Any, ClassVar

import numpy as np

from cartwheel.codes import devices, running
from cartwheel.dialects.gz.drive_tags import gz_name
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.messages import header, message_class

_RATE = 50.0
"""Rate of the state messages, Hz."""
_CHARGED = 0.9
"""Fraction of the capacity at which charging stops."""
_HOUR = 3600.0


@dataclass(frozen=True, kw_only=True, slots=True)
class BatteryParameters:
    name: str = tag("battery_name", doc="Name of the battery.")
    voltage: float = tag("voltage", unit="V", doc="Initial voltage.")
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
    capacity: float = tag("capacity", unit="A h", doc="Charge of the full battery.")
    charge: float | None = tag(
        "initial_charge", default=None, unit="A h", doc="Initial charge. Default: the capacity."
    )
    resistance: float = tag("resistance", default=0.0, unit="Ω", doc="Internal resistance.")
    smoothing: float = tag(
        "smooth_current_tau",
        default=1.0,
        unit="s",
        doc="Time constant of the low-pass filter for the current.",
    )
    power: float = tag(
        "power_load", default=0.0, unit="W", doc="Power drawn while the battery discharges."
    )
    draining: bool = tag(
        "start_draining", default=False, doc="Start discharging when the simulation starts."
    )
    drain_topics: tuple[str, ...] = tag(
        "power_draining_topic",
        default=(),
        doc="Topic on which any message starts discharging. The message type is Empty, "
        "unless another plugin uses the topic with a different type.",
    )
    stop_topics: tuple[str, ...] = tag(
        "stop_power_draining_topic",
        default=(),
        doc="Topic on which any message stops discharging.",
    )
    rechargeable: bool = tag(
        "enable_recharge",
        default=False,
        doc="Recharge the battery after a message on "
        "`/model/<model>/battery/<battery_name>/recharge/start`, until a message on "
        "`…/recharge/stop`. Requires `<charging_time>`.",
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
        doc="Time to recharge the empty battery, with `<enable_recharge>`.",
    )
    invert: bool = tag(
        "invert_current_sign",
        default=False,
        doc="Publish a discharging current as negative, as sensor_msgs/BatteryState defines it.",
    )
    fixed: bool = tag(
        "fix_issue_225",
        default=False,
        doc="No effect: the fix of gz-sim's issue 225 is always applied.",
    )


class Battery(Plugin[BatteryParameters]):
    """Simulates a battery that discharges at constant power.

    Discharging starts when a plugin first turns a joint of the model, for example after a drive
    command. It also starts with a message on ``<power_draining_topic>``, or when the simulation
    starts if ``<start_draining>`` is true. The voltage is ``constant + linear (1 - charge /
    capacity) - resistance * current``, where ``constant`` and ``linear`` are the open-circuit
    voltage coefficients.

    Recharging stops at 90 % of the capacity. BatteryState is published at 50 Hz on
    ``/model/<model>/battery/<battery_name>/state``. The message field ``percentage`` is from 0 to
    1, as in ROS. An empty battery is reported but does not stop the robot. Original plugin:
    ``LinearBatteryPlugin`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = (
        "gz-sim-linearbatteryplugin-system",
        "gz-sim-linear-battery-plugin-system",
    )
    parameters: ClassVar[type] = BatteryParameters

    def configure(self) -> None:
        config = self.config
        full = config.capacity
        charge = full if config.charge is None else config.charge
        self.check_above_zero(
            capacity=full, voltage=config.voltage, smooth_current_tau=config.smoothing
        )
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
        self._first = min(max(charge, 0.0), full)
        self._State = message_class("sensor_msgs/msg/BatteryState")
        base = f"/model/{self.part.name}/battery/{config.name}"
        self._publisher = self.advertise(
            gz_name(self, f"{base}/state", ""), "sensor_msgs/msg/BatteryState", rate=_RATE
        )
        if rechargeable:
            for what, charging in (("start", True), ("stop", False)):
                self.subscribe(
                    gz_name(self, f"{base}/recharge/{what}", ""),
                    "std_msgs/msg/Bool",
                    partial(self._charge_it, on=charging),
                )
        self._watches = False
        self.reset()
        self.part.schedule(_RATE, after=self._go_on)

    def reset(self) -> None:
        self._draining, self._charging = self.config.draining, False
        self._charge, self._voltage, self._current = self._first, self.config.voltage, 0.0
        self._reported_empty = False
        self._before_ns = self.part.time_ns

    def _watch_topics(self) -> None:
        """Subscribes to topics of any type, which are known once all plugins are loaded."""
        config = self.config
        known = {topic.name: topic.type for topic in self.graph.topics()}
        for topics, on in ((config.drain_topics, True), (config.stop_topics, False)):
            for topic in topics:
                name = gz_name(self, topic, "")
                kind = known.get(name, "std_msgs/msg/Empty")
                self.subscribe(name, kind, partial(self._drain, on=on))

    def _drain(self, _: Any, *, on: bool) -> None:
        self._draining = on

    def _charge_it(self, _: Any, *, on: bool) -> None:
        self._charging = on

    def _go_on(self) -> None:
        if not self._watches:
            self._watches = True
            self._watch_topics()
        now = self.part.time_ns
        seconds = (now - self._before_ns) * 1e-9
        self._before_ns = now
        self._draining = self._draining or self.part.driven
        if self._draining or self._charging:
            self._flow(seconds)
        if self._publisher.wanted:
            self._publish()

    def _flow(self, seconds: float) -> None:
        """Integrates the current over a time in s."""
        config = self.config
        empty = self._charge <= 0
        wanted = config.power / self._voltage if self._draining and not empty else 0.0
        if self._charging and self._charge < _CHARGED * config.capacity:
            wanted -= config.capacity / config.charging_time
        share = 1 - math.exp(-seconds / config.smoothing)
        self._current += share * (wanted - self._current)
        if empty and wanted >= 0:
            self._current = 0.0
        self._charge = max(self._charge - self._current * seconds / _HOUR, 0.0)
        left = self._charge / config.capacity
        full = config.voltage if config.constant is None else config.constant
        voltage = full + config.linear * (1 - left) - config.resistance * self._current
        # A load beyond the maximum power would make the voltage negative.
        self._voltage = max(voltage, 1e-3)
        if self._charge <= 0 and not self._reported_empty:
            self._reported_empty = True
            self.warn(
                running.BATTERY_EMPTY,
                f'battery "{config.name}" of model "{self.part.name}" is empty',
                values={"battery": config.name, "model": self.part.name},
            )

    def _publish(self) -> None:
        config, state = self.config, self._State
        full = self._charge / config.capacity
        status = state.POWER_SUPPLY_STATUS_NOT_CHARGING
        if self._charging:
            status = state.POWER_SUPPLY_STATUS_CHARGING
        elif self._draining:
            status = state.POWER_SUPPLY_STATUS_DISCHARGING
        elif full > _CHARGED:
            status = state.POWER_SUPPLY_STATUS_FULL
        nothing = np.zeros(0, np.float32)
        self._publisher.publish(
            state(
                header=header(self.part.time_ns, ""),
                voltage=self._voltage,
                temperature=math.nan,
                current=-self._current if config.invert else self._current,
                charge=self._charge,
                capacity=config.capacity,
                design_capacity=math.nan,
                percentage=full,
                power_supply_status=status,
                power_supply_health=state.POWER_SUPPLY_HEALTH_UNKNOWN,
                power_supply_technology=state.POWER_SUPPLY_TECHNOLOGY_UNKNOWN,
                present=True,
                cell_voltage=nothing,
                cell_temperature=nothing,
                location="",
                serial_number="",
            )
        )
