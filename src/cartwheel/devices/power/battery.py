"""A battery that discharges at constant power."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import Any, NamedTuple

from cartwheel.codes import running
from cartwheel.component import Component, Scope
from cartwheel.devices.elementwise import Number, maximum, where
from cartwheel.messages import header, message_class

_RATE = 50.0
"""Rate of the state messages, Hz."""
_CHARGED = 0.9
"""Fraction of the capacity at which charging stops."""
_HOUR = 3600.0
_LOWEST_VOLTAGE = 1e-3
"""V. A load beyond the maximum power would make the voltage negative."""
_MESSAGE = "sensor_msgs/msg/BatteryState"


@dataclass(frozen=True, kw_only=True, slots=True)
class BatteryConfig:
    name: str
    state_topic: str
    """Topic of the BatteryState messages."""
    initial_voltage: float
    """V."""
    full_voltage: float
    """Open-circuit voltage of the full battery, V."""
    voltage_change: float
    """Open-circuit voltage of the empty battery minus that of the full battery, V."""
    capacity: float
    """Charge of the full battery, A h."""
    charge: float
    """Initial charge, A h."""
    resistance: float
    """Internal resistance, Ω."""
    smoothing: float
    """Time constant of the low-pass filter for the current, s."""
    power: float
    """Power drawn while the battery discharges, W."""
    draining: bool
    """Whether the battery discharges from the start. It also does so once a joint is driven."""
    drain_topics: tuple[str, ...] = ()
    """Topics on which any message starts discharging."""
    stop_topics: tuple[str, ...] = ()
    """Topics on which any message stops discharging."""
    charging_time: float = 0.0
    """Time to recharge the empty battery, h; 0: the battery cannot be recharged."""
    charge_topic: str = ""
    """Topic of the Bool messages that start recharging."""
    stop_charge_topic: str = ""
    """Topic of the Bool messages that stop recharging."""
    negative_discharge: bool = False
    """Whether a discharging current is published as negative."""


class BatteryState(NamedTuple):
    """The charge in A h, the voltage in V and the current in A of a battery."""

    charge: Number
    voltage: Number
    current: Number


class Battery(Component):
    """Simulates a battery and publishes its state. An empty battery causes a warning.

    Args:
        scope: The battery's model and names.
        config: Battery and topics.
    """

    def __init__(self, scope: Scope, config: BatteryConfig) -> None:
        super().__init__(scope)
        self._config = config
        self._State = message_class(_MESSAGE)
        self._publisher = self.advertise(config.state_topic, _MESSAGE, rate=_RATE)
        if config.charging_time > 0:
            for topic, on in ((config.charge_topic, True), (config.stop_charge_topic, False)):
                self.subscribe(topic, "std_msgs/msg/Bool", partial(self._set_charging, on=on))
        self._subscribed = False
        self.reset()
        self.part.schedule(_RATE, after=self._update)

    def reset(self) -> None:
        super().reset()
        config = self._config
        self._draining, self._charging = config.draining, False
        self._state = BatteryState(config.charge, config.initial_voltage, 0.0)
        self._reported_empty = False
        self._last_ns = self.part.time_ns

    def _subscribe_all(self) -> None:
        """Subscribes to topics of any type, which are known once all plugins are loaded."""
        config = self._config
        known = {topic.name: topic.type for topic in self.graph.topics()}
        for topics, on in ((config.drain_topics, True), (config.stop_topics, False)):
            for topic in topics:
                kind = known.get(topic, "std_msgs/msg/Empty")
                self.subscribe(topic, kind, partial(self._set_draining, on=on))

    def _set_draining(self, _: Any, *, on: bool) -> None:
        self._draining = on

    def _set_charging(self, _: Any, *, on: bool) -> None:
        self._charging = on

    def _update(self) -> None:
        if not self._subscribed:
            self._subscribed = True
            self._subscribe_all()
        now = self.part.time_ns
        seconds = (now - self._last_ns) * 1e-9
        self._last_ns = now
        self._draining = self._draining or self.part.driven
        if self._draining or self._charging:
            self._state = next_state(
                self._config, self._state, seconds, draining=self._draining, charging=self._charging
            )
            self._report_empty()
        if self._publisher.wanted:
            self._publish()

    def _report_empty(self) -> None:
        if self._state.charge <= 0 and not self._reported_empty:
            self._reported_empty = True
            name, model = self._config.name, self.part.name
            self.warn(
                running.BATTERY_EMPTY,
                f'battery "{name}" of model "{model}" is empty',
                values={"battery": name, "model": model},
            )

    def _publish(self) -> None:
        config, message = self._config, self._State
        charge, voltage, current = self._state
        fraction = charge / config.capacity
        status = message.POWER_SUPPLY_STATUS_NOT_CHARGING
        if self._charging:
            status = message.POWER_SUPPLY_STATUS_CHARGING
        elif self._draining:
            status = message.POWER_SUPPLY_STATUS_DISCHARGING
        elif fraction > _CHARGED:
            status = message.POWER_SUPPLY_STATUS_FULL
        self._publisher.publish(
            message(
                header=header(self.part.time_ns, ""),
                voltage=voltage,
                temperature=math.nan,
                current=-current if config.negative_discharge else current,
                charge=charge,
                capacity=config.capacity,
                design_capacity=math.nan,
                percentage=fraction,
                power_supply_status=status,
                power_supply_health=message.POWER_SUPPLY_HEALTH_UNKNOWN,
                power_supply_technology=message.POWER_SUPPLY_TECHNOLOGY_UNKNOWN,
                present=True,
            )
        )


def next_state(
    config: BatteryConfig,
    state: BatteryState,
    seconds: float,
    *,
    draining: bool,
    charging: bool,
) -> BatteryState:
    """Returns the state of a battery after a time in s.

    Args:
        config: The battery.
        state: The present state.
        seconds: The time.
        draining: Whether the battery discharges.
        charging: Whether the battery is being recharged, if it is rechargeable.
    """
    empty = state.charge <= 0
    target = where(empty, 0.0, config.power / state.voltage) if draining else 0.0
    if charging:
        below = state.charge < _CHARGED * config.capacity
        target = where(below, target - config.capacity / config.charging_time, target)
    share = 1 - math.exp(-seconds / config.smoothing)
    current = state.current + share * (target - state.current)
    current = where(empty, where(target >= 0, 0.0, current), current)
    charge = maximum(state.charge - current * seconds / _HOUR, 0.0)
    drop = config.resistance * current
    voltage = config.full_voltage + config.voltage_change * (1 - charge / config.capacity) - drop
    return BatteryState(charge, maximum(voltage, _LOWEST_VOLTAGE), current)
