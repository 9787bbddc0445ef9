"""SDF's ``<force_torque>`` element: axes, direction and noise of a sensor on a joint."""

from __future__ import annotations

from cartwheel.description.model import Element, Sensor
from cartwheel.devices.contact.loads import Axes, JointLoadConfig
from cartwheel.dialects.sdf.noise import read_vector_noise
from cartwheel.dialects.tags import invalid
from cartwheel.simulation import Part

_AXES: tuple[Axes, ...] = ("child", "parent", "sensor")


def read_joint_load(part: Part, sensor: Sensor, joint: str) -> JointLoadConfig:
    """Reads a ``force_torque`` sensor.

    Args:
        part: The model's part of the simulation.
        sensor: The sensor.
        joint: The joint that contains the sensor.

    Raises:
        PluginError: A keyword or the noise is not allowed.
    """
    element = sensor.element.find("force_torque") or sensor.element
    axes = _AXES[_choice(element, "frame", _AXES)]
    direction = _choice(element, "measure_direction", ("child_to_parent", "parent_to_child"))
    noises = [
        element.find(f"{quantity}/{axis}/noise")
        for quantity in ("force", "torque")
        for axis in "xyz"
    ]
    return JointLoadConfig(
        joint=joint,
        axes=axes,
        # The sensor's pose is relative to the child link.
        rotation=sensor.pose.orientation,
        parent_to_child=direction == 1,
        noise=read_vector_noise(part, sensor, f"force {joint} {sensor.name}", noises),
    )


def _choice(element: Element, name: str, allowed: tuple[str, ...]) -> int:
    """Returns the index of an element's text in the allowed texts; 0 without the element."""
    child = element.find(name)
    if child is None:
        return 0
    word = child.text.strip()
    if word not in allowed:
        raise invalid(name, word, f"one of {', '.join(allowed)}", child.origin)
    return allowed.index(word)
