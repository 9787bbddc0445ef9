"""``libgazebo_ros_wheel_slip.so`` and ``gz-sim-wheel-slip-system``: wheels that slip."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.codes import devices
from cartwheel.description.model import Cylinder, Element, Sphere
from cartwheel.devices.mechanisms.wheel_slip import (
    SlippingWheelConfig,
    WheelSlip,
    WheelSlipConfig,
)
from cartwheel.dialects.common_tags import publish_rate_tag
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import number_at, tag
from cartwheel.errors import PluginError

_DIRECTIONS = ("lateral", "longitudinal")


@dataclass(frozen=True, kw_only=True, slots=True)
class WheelSlipParameters:
    wheels: tuple[str, ...] = tag(
        "wheel",
        default=(),
        nested=True,
        doc="A wheel. The attribute `link_name` is the link of the wheel. The tags inside are "
        "`<slip_compliance_lateral>`, `<slip_compliance_longitudinal>`, "
        "`<wheel_normal_force>` (in N) and `<wheel_radius>` (in m; by default, the radius "
        "of the wheel's cylinder or sphere). Repeat the tag for each wheel.",
    )
    tolerance: float = tag(
        "wheel_spin_tolerance",
        default=1e-3,
        unit="m/s",
        doc="Rim speed below which the published slip is 0.",
    )
    rate: float = publish_rate_tag("publisher_update_rate", default=100.0, of="`wheel_slip`")


class WheelSlipPlugin(Plugin[WheelSlipParameters]):
    """Makes wheels slip on the ground, in proportion to the friction force.

    The slip speed is ``rim speed * slip compliance * friction force / normal force``, in the
    lateral and the longitudinal direction. A wheel that is not turning does not slip. The friction
    coefficient limits the force, and therefore the slip.

    If the ``<plugin>`` of `libgazebo_ros_wheel_slip.so` contains ``<ros>`` (ROS 2), the plugin
    publishes the slip of each wheel on ``wheel_slip``. The lateral slip is an angle in rad, and the
    longitudinal slip is a fraction of the rim speed. Without ``<ros>`` (ROS 1), dynamic_reconfigure
    can change the slip compliances of all wheels. Its topics and services are under
    ``/<model>/<robotNamespace>``, or under ``/<model>/wheel_slip`` without ``<robotNamespace>``.

    Original plugins: ``WheelSlipPlugin`` in Gazebo Classic, ``gazebo_ros_wheel_slip`` in the
    package ``gazebo_plugins``, and ``WheelSlip`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = (
        "libgazebo_ros_wheel_slip.so",
        "gz-sim-wheel-slip-system",
        "libWheelSlipPlugin.so",
    )

    def configure(self) -> None:
        config, element = self.config, self.tag.element
        wheels = tuple(self._wheel(each) for each in element.find_all("wheel"))
        if not wheels:
            self.warn(devices.PLUGIN_IDLE, "the plugin has no <wheel>, so it has no effect")
            return
        topic = parameters = None
        if "gazebo_ros_wheel_slip" in self.tag.filename:
            if element.find("ros") is not None:
                topic = "wheel_slip"
            else:
                plain = element.find("robotNamespace")
                name = (plain.text.strip().strip("/") if plain is not None else "") or "wheel_slip"
                parameters = f"/{self.part.name}/{name}"
        device = WheelSlipConfig(
            wheels=wheels,
            topic=topic,
            rate=config.rate,
            tolerance=config.tolerance,
            reconfigured_as=parameters,
        )
        self.add(WheelSlip(self.scope, device))

    def _wheel(self, element: Element) -> SlippingWheelConfig:
        origin = element.origin
        name = element.attribute("link_name")
        if not name:
            raise PluginError(
                "<wheel> requires the attribute link_name",
                code=devices.PLUGIN_PARAMETER_MISSING,
                origin=origin,
                values={"parameter": "link_name"},
            )
        radius = number_at(element, "wheel_radius") or self._radius(name)
        normal = number_at(element, "wheel_normal_force")
        if radius <= 0 or normal <= 0:
            raise PluginError(
                f'wheel "{name}" requires a positive <wheel_radius> and <wheel_normal_force>',
                code=devices.PLUGIN_PARAMETER_INVALID,
                origin=origin,
                values={"link": name, "wheel_radius": radius, "wheel_normal_force": normal},
            )
        compliance = {}
        for direction in _DIRECTIONS:
            parameter = f"slip_compliance_{direction}"
            value = number_at(element, parameter)
            if value < 0:
                self.warn(
                    devices.PLUGIN_PARAMETER_INVALID,
                    f"<{parameter}> must not be negative (got {value:g}), so 0 is used",
                    at=origin,
                    values={"parameter": parameter, "value": value},
                )
            compliance[direction] = max(value, 0.0)
        return SlippingWheelConfig(
            link=name, radius=radius, normal_force=normal, origin=origin, **compliance
        )

    def _radius(self, name: str) -> float:
        """Returns the radius of the wheel's cylinder or sphere in m; 0 if it has neither."""
        link = self.part.description.link(name)
        shapes = [each.shape for each in link.collisions] if link is not None else []
        round_ones = [shape for shape in shapes if isinstance(shape, Cylinder | Sphere)]
        return round_ones[0].radius if round_ones else 0.0
