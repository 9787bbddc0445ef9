"""``libgazebo_ros_wheel_slip.so`` and ``gz-sim-wheel-slip-system``: wheels that slip."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from cartwheel.codes import devices
from cartwheel.description.model import Cylinder, Element, Sphere
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import number, tag
from cartwheel.errors import PluginError
from cartwheel.graph import ReconfigureParameter
from cartwheel.messages import message_class
from cartwheel.simulation.handles import JointHandle
from cartwheel.simulation.slipping import SlipHandle

_SENSES = ("lateral", "longitudinal")
_PARAMETERS = tuple(
    ReconfigureParameter(
        name=f"slip_compliance_unitless_{sense}",
        type="double",
        default=-1.0,
        minimum=-1.0,
        maximum=20.0,
        level=0,
        description=f"Slip ratio at a friction force equal to the normal force, {sense}",
    )
    for sense in _SENSES
)


@dataclass(frozen=True, kw_only=True, slots=True)
class WheelSlipParameters:
    wheels: tuple[str, ...] = tag(
        "wheel",
        default=(),
        nested=True,
        doc="A wheel: attribute `link_name`, and the tags `<slip_compliance_lateral>`, "
        "`<slip_compliance_longitudinal>`, `<wheel_normal_force>` in N and `<wheel_radius>` "
        "in m (default: radius of the wheel's cylinder or sphere). Repeat the tag for each "
        "wheel.",
    )
    tolerance: float = tag(
        "wheel_spin_tolerance",
        default=1e-3,
        unit="m/s",
        doc="Below this rim speed, the published slip is 0.",
    )
    rate: float = tag(
        "publisher_update_rate",
        default=100.0,
        unit="Hz",
        doc="Publish rate of `wheel_slip`. 0: every step.",
    )


@dataclass(kw_only=True, slots=True)
class _Wheel:
    link: str
    joint: JointHandle
    slip: SlipHandle
    normal: float
    """Normal force, N."""
    compliance: dict[str, float]
    """Slip ratio at a friction force equal to the normal force, lateral and longitudinal."""


class WheelSlip(Plugin[WheelSlipParameters]):
    """Makes wheels slip in proportion to the friction force.

    The slip speed is ``rim speed * slip compliance * friction force / normal force``. A wheel that
    is not turning does not slip. The friction coefficient limits the force, and therefore the slip.

    With ``<ros>`` (ROS 2), `libgazebo_ros_wheel_slip.so` publishes the slip of each wheel on
    ``wheel_slip``: lateral slip as an angle in rad, longitudinal slip as a fraction of the rim
    speed. Without ``<ros>`` (ROS 1), dynamic_reconfigure can change the compliances of all wheels
    under ``/<model>/<robotNamespace>``, by default ``/<model>/wheel_slip``.

    Original plugins: ``WheelSlipPlugin`` in Gazebo Classic, ``gazebo_ros_wheel_slip`` in the
    package ``gazebo_plugins``, and ``WheelSlip`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = (
        "libgazebo_ros_wheel_slip.so",
        "gz-sim-wheel-slip-system",
        "libWheelSlipPlugin.so",
    )
    parameters: ClassVar[type] = WheelSlipParameters

    def configure(self) -> None:
        config, element = self.config, self.tag.element
        self.check_not_negative("rate")
        self._wheels = [self._wheel(each) for each in element.find_all("wheel")]
        if not self._wheels:
            self.warn(devices.PLUGIN_IDLE, "the plugin has no <wheel>, so no wheel slips")
            return
        self.part.schedule(0, before=self._apply)
        if "gazebo_ros_wheel_slip" not in self.tag.filename:
            return
        if element.find("ros") is not None:
            self._WheelSlip = message_class("gazebo_msgs/msg/WheelSlip")
            rate = config.rate or None
            self._publisher = self.advertise("wheel_slip", "gazebo_msgs/msg/WheelSlip", rate=rate)
            self.part.schedule(
                config.rate, after=self._publish, active=lambda: self._publisher.wanted
            )
        else:
            plain = element.find("robotNamespace")
            name = (plain.text.strip().strip("/") if plain is not None else "") or "wheel_slip"
            self.reconfigure(f"/{self.part.name}/{name}", _PARAMETERS, self._on_change)

    def _wheel(self, element: Element) -> _Wheel:
        origin = element.origin
        name = element.attribute("link_name")
        if not name:
            raise PluginError(
                "<wheel> requires the attribute link_name",
                code=devices.PLUGIN_PARAMETER_MISSING,
                origin=origin,
                values={"parameter": "link_name"},
            )
        radius = _number(element, "wheel_radius") or self._radius(name)
        normal = _number(element, "wheel_normal_force")
        if radius <= 0 or normal <= 0:
            raise PluginError(
                f'wheel "{name}" requires a positive <wheel_radius> and <wheel_normal_force>',
                code=devices.PLUGIN_PARAMETER_INVALID,
                origin=origin,
                values={"link": name, "wheel_radius": radius, "wheel_normal_force": normal},
            )
        slip = self.part.slip(name, radius=radius, origin=origin)
        joint = next(each for each in self.part.description.joints if each.child == name)
        compliance = {}
        for sense in _SENSES:
            value = _number(element, f"slip_compliance_{sense}")
            if value < 0:
                self.warn(
                    devices.PLUGIN_PARAMETER_INVALID,
                    f"<slip_compliance_{sense}> must not be negative (got {value:g}), so 0 is used",
                    at=origin,
                    values={"parameter": f"slip_compliance_{sense}", "value": value},
                )
            compliance[sense] = max(value, 0.0)
        return _Wheel(
            link=name,
            joint=self.part.joint(joint.name, origin=origin),
            slip=slip,
            normal=normal,
            compliance=compliance,
        )

    def _radius(self, name: str) -> float:
        """Returns the radius of the wheel's cylinder or sphere in m; 0 if it has neither."""
        link = self.part.description.link(name)
        shapes = [each.shape for each in link.collisions] if link is not None else []
        round_ones = [shape for shape in shapes if isinstance(shape, Cylinder | Sphere)]
        return round_ones[0].radius if round_ones else 0.0

    def _on_change(self, values: Mapping[str, Any]) -> None:
        for sense in _SENSES:
            value = float(values[f"slip_compliance_unitless_{sense}"])
            if value >= 0:
                for wheel in self._wheels:
                    wheel.compliance[sense] = value

    def _apply(self) -> None:
        for wheel in self._wheels:
            speed = abs(wheel.joint.velocity) * wheel.slip.radius / wheel.normal
            wheel.slip.give(*(speed * wheel.compliance[sense] for sense in _SENSES))

    def _publish(self) -> None:
        names, lateral, longitudinal = [], [], []
        for wheel in self._wheels:
            rim = wheel.joint.velocity * wheel.slip.radius
            aside, ahead = wheel.slip.speeds
            still = abs(rim) < self.config.tolerance
            names.append(wheel.link)
            longitudinal.append(0.0 if still else ahead / rim)
            lateral.append(0.0 if still else math.atan2(aside, rim - ahead))
        self._publisher.publish(self._WheelSlip(names, np.array(lateral), np.array(longitudinal)))


def _number(element: Element, name: str) -> float:
    """Returns the number in a child element; 0 if the element does not exist."""
    child = element.find(name)
    return number(child) if child is not None else 0.0
