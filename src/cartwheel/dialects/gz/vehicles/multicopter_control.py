"""``gz-sim-multicopter-control-system``: a multicopter that follows velocities."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.codes import devices
from cartwheel.description.kinematics import link_poses
from cartwheel.description.model import Element
from cartwheel.devices.air.geometric_control import (
    GeometricControl,
    GeometricControlConfig,
    RotorConfig,
    controls_all,
)
from cartwheel.dialects.catalogue import short_name
from cartwheel.dialects.gz.vehicles.motor_model import GzMotorModel, motor_topic
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import SMALLEST, invalid, number_at, required, tag
from cartwheel.errors import UnknownNameError
from cartwheel.geometry import Vec3, rotate

_UNLIMITED = 1e6
_NONE: Vec3 = (0.0, 0.0, 0.0)
_FREE: Vec3 = (_UNLIMITED,) * 3


def _gain(name: str, unit: str, doc: str) -> Any:
    return tag(name, unit=unit, least=0.0, doc=doc)


def _limit(name: str, unit: str, doc: str) -> Any:
    return tag(name, default=None, unit=unit, doc=f"{doc} Default: no limit.")


def _noise(name: str, unit: str, doc: str, **more: Any) -> Any:
    return tag(name, default=_NONE, unit=unit, doc=doc, **more)


@dataclass(frozen=True, kw_only=True, slots=True)
class MulticopterControlParameters:
    link: str = tag("comLinkName", role="link", doc="Link whose velocity is controlled.")
    command_topic: str = tag(
        "commandSubTopic",
        default="cmd_vel",
        doc="Topic of the velocities in the axes of the link (Twist). Its namespace is "
        "`<robotNamespace>`, or else the model's name.",
    )
    enable_topic: str = tag(
        "enableSubTopic",
        default="enable",
        doc="Topic that switches the controller on and off (Bool). When it is switched off, the "
        "propellers stop.",
    )
    velocity_gain: tuple[float, float, float] = _gain(
        "velocityGain", "N s/m", "Force per velocity error along the axes of the world."
    )
    attitude_gain: tuple[float, float, float] = _gain(
        "attitudeGain", "N m", "Torque per error of the orientation about the axes of the link."
    )
    rate_gain: tuple[float, float, float] = _gain(
        "angularRateGain", "N m s", "Torque per error of the angular velocity."
    )
    max_acceleration: tuple[float, float, float] | None = _limit(
        "maximumLinearAcceleration",
        "m/s²",
        "Maximum acceleration that a velocity error demands along the axes of the world.",
    )
    max_velocity: tuple[float, float, float] | None = _limit(
        "maximumLinearVelocity", "m/s", "Maximum commanded velocity."
    )
    max_rate: tuple[float, float, float] | None = _limit(
        "maximumAngularVelocity", "rad/s", "Maximum commanded angular velocity."
    )
    velocity_mean: tuple[float, float, float] = _noise(
        "linearVelocityNoiseMean", "m/s", "Mean noise of the measured velocity."
    )
    velocity_deviation: tuple[float, float, float] = _noise(
        "linearVelocityNoiseStdDev",
        "m/s",
        "Standard deviation of this noise. Components with 0 have no noise.",
        least=0.0,
    )
    rate_mean: tuple[float, float, float] = _noise(
        "angularVelocityNoiseMean", "rad/s", "Mean noise of the measured angular velocity."
    )
    rate_deviation: tuple[float, float, float] = _noise(
        "angularVelocityNoiseStdDev",
        "rad/s",
        "Standard deviation of this noise. Components with 0 have no noise.",
        least=0.0,
    )
    rotors: str = tag(
        "rotorConfiguration",
        default="",
        nested=True,
        doc="A `<rotor>` for each propeller, in the order of the motors' numbers. It contains the "
        "joint `<jointName>`, `<forceConstant>` (thrust per square of the speed, in N s²/rad²), "
        "`<momentConstant>` (torque divided by the thrust, in m) and `<direction>` (1 if it turns "
        "counter-clockwise, otherwise -1).",
    )


class MulticopterControl(Plugin[MulticopterControlParameters]):
    """Flies a multicopter at the velocity and the yaw rate of Twist commands.

    The speeds of the propellers are sent to each ``gz-sim-multicopter-motor-model-system`` of the
    model, on its topic of commands. The propellers stand still until the first command. Original
    plugin: ``MulticopterVelocityControl`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-multicopter-control-system",)

    def configure(self) -> None:
        config, link = self.config, self.config.link.strip()
        rotors = tuple(self._rotors(link))
        if not controls_all(rotors):
            raise invalid(
                "rotorConfiguration",
                len(rotors),
                "at least four rotors, which can turn the link about each axis",
                self.place_of("rotorConfiguration"),
            )
        motors = tuple(dict.fromkeys(self._motor_topics()))
        if not motors:
            self.warn(
                devices.PLUGIN_IDLE,
                f"the model has no {GzMotorModel.filenames[0]}, so it does not fly",
                at=self.tag.origin,
            )
        element = self.tag.element
        self.add(
            GeometricControl(
                self.scope,
                GeometricControlConfig(
                    link=link,
                    rotors=rotors,
                    velocity_gain=config.velocity_gain,
                    attitude_gain=config.attitude_gain,
                    rate_gain=config.rate_gain,
                    max_acceleration=_size(config.max_acceleration),
                    max_velocity=_size(config.max_velocity),
                    max_rate=_size(config.max_rate),
                    velocity_noise=(config.velocity_mean, config.velocity_deviation),
                    rate_noise=(config.rate_mean, config.rate_deviation),
                    command_topic=motor_topic(self.part, element, config.command_topic),
                    enable_topic=motor_topic(self.part, element, config.enable_topic),
                    motor_topics=motors,
                ),
            )
        )

    def _motor_topics(self) -> Iterator[str]:
        """Yields the topics on which the model's motors receive their speeds."""
        names = set(map(short_name, GzMotorModel.filenames))
        for plugin in self.part.description.plugins:
            if short_name(plugin.filename) in names:
                topic = _text(plugin.element, "commandSubTopic")
                yield motor_topic(self.part, plugin.element, topic)

    def _rotors(self, link: str) -> Iterator[RotorConfig]:
        """Yields the propellers.

        Raises:
            PluginError: A number is missing or not allowed.
            UnknownNameError: A joint does not exist.
        """
        description = self.part.description
        found = self.tag.element.find("rotorConfiguration")
        poses = link_poses(description, {})
        if link not in poses:
            # The device reports it.
            self.part.link(link, origin=self.place_of("comLinkName"))
        to_link = poses[link].inverse()
        for element in found.find_all("rotor") if found is not None else ():
            name = required(element, "jointName").text.strip()
            joint = description.joint(name)
            if joint is None:
                raise UnknownNameError(
                    "joint",
                    name,
                    [each.name for each in description.joints],
                    code=devices.PLUGIN_JOINT_UNKNOWN,
                    origin=element.origin,
                )
            place = to_link @ poses[joint.child] @ joint.pose
            up = rotate(place.orientation, joint.axis.xyz)[2]
            x, y, _ = place.position
            thrust = _positive(element, "forceConstant") * up
            yield RotorConfig(
                place=(x, y),
                thrust=thrust,
                moment=_positive(element, "momentConstant"),
                counterclockwise=_direction(element) > 0,
            )


def _positive(element: Element, name: str) -> float:
    origin = required(element, name).origin
    value = number_at(element, name)
    if value < SMALLEST**2:
        raise invalid(name, value, "positive", origin)
    return value


def _direction(element: Element) -> float:
    origin = required(element, "direction").origin
    value = number_at(element, "direction")
    if value not in (1, -1):
        raise invalid("direction", value, "1 or -1", origin)
    return value


def _size(limits: Vec3 | None) -> Vec3:
    if limits is None:
        return _FREE
    x, y, z = limits
    return abs(x), abs(y), abs(z)


def _text(element: Element, name: str) -> str:
    found = element.find(name)
    return "" if found is None else found.text.strip().strip("/")
