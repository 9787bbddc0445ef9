"""SDF's ``<noise>`` element."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields, replace

from cartwheel.codes import devices
from cartwheel.description.elements.numbers import LARGEST
from cartwheel.description.model import Element, Sensor
from cartwheel.description.sdf.noise_types import GAUSSIAN, noise_type
from cartwheel.devices.noise import Noise, VectorNoiseConfig
from cartwheel.dialects.tags import number
from cartwheel.errors import Diagnostic
from cartwheel.simulation import Part

_SIGNED = ("mean", "bias_mean")


def read_noise(element: Element | None, report: Callable[[Diagnostic], None]) -> Noise:
    """Reads a ``<noise>`` element.

    Args:
        element: The element; None: no noise.
        report: Receives diagnostics about settings without effect.

    Raises:
        PluginError: A number is not allowed.
    """
    if element is None:
        return Noise()
    kind = element.find("type")
    name = noise_type(kind.text if kind is not None else element.attribute("type") or "gaussian")
    if name not in GAUSSIAN:
        # Types that do not exist are reported when the description is read.
        return Noise()
    values = {}
    # The fields have the names of the tags. As in Gazebo, the sign of the bias is random.
    for tag in (field.name for field in fields(Noise)):
        child = element.find(tag)
        least = -LARGEST if tag in _SIGNED else 0.0
        values[tag] = number(child, least=least) if child is not None else 0.0
    noise = Noise(**values)
    idle = ""
    if noise.precision and name != "gaussian_quantized":
        noise = replace(noise, precision=0.0)
        idle = "<precision> has an effect only with noise of type gaussian_quantized"
    elif noise.dynamic_bias_stddev and not noise.dynamic_bias_correlation_time:
        idle = "<dynamic_bias_stddev> has an effect only with <dynamic_bias_correlation_time>"
    if idle:
        report(devices.SENSOR_SETTING_IGNORED.diagnostic(idle, origin=element.origin))
    return noise


def read_vector_noise(
    part: Part, sensor: Sensor, name: str, elements: Sequence[Element | None]
) -> VectorNoiseConfig:
    """Reads the ``<noise>`` of each quantity that a sensor measures; see `read_noise`.

    Args:
        part: Receives the diagnostics.
        sensor: The sensor, whose rate applies.
        name: Name of the random sequence.
        elements: The elements; None: no noise.
    """
    # An element that describes several quantities is read once, so that it is reported once.
    distinct = {id(element): element for element in elements}
    read = {key: read_noise(element, part.report) for key, element in distinct.items()}
    noises = tuple(read[id(element)] for element in elements)
    return VectorNoiseConfig(name=name, noises=noises, rate=sensor.update_rate)
