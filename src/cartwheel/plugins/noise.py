"""Errors of sensors: Gaussian noise with a bias as SDF states it, slow drift as hector has it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from cartwheel.codes import devices
from cartwheel.description.model import Element
from cartwheel.description.numbers import LARGEST
from cartwheel.errors import Diagnostic, PluginError
from cartwheel.geometry import Array
from cartwheel.plugins.parameters import number
from cartwheel.simulation import Part


@dataclass(frozen=True, kw_only=True, slots=True)
class Noise:
    """SDF's ``<noise>`` of one quantity."""

    mean: float = 0.0
    stddev: float = 0.0
    bias_mean: float = 0.0
    bias_stddev: float = 0.0
    walk: float = 0.0
    """How fast the bias wanders: the standard deviation after 1 s; from then on times the root of
    the time."""
    memory: float = 0.0
    """s, the time constant with which it forgets; without one it does not wander."""
    precision: float = 0.0
    """What is measured is a multiple of this, where it is above 0."""


_FIELDS = {
    "mean": "mean",
    "stddev": "stddev",
    "bias_mean": "bias_mean",
    "bias_stddev": "bias_stddev",
    "dynamic_bias_stddev": "walk",
    "dynamic_bias_correlation_time": "memory",
    "precision": "precision",
}
"""SDF's tags and what they are here."""
_SIGNED = ("mean", "bias_mean")


def read_noise(element: Element | None, report: Callable[[Diagnostic], None]) -> Noise:
    """What a ``<noise>`` element says; none at all without one.

    Args:
        element: The tag.
        report: Takes what has no effect.

    Raises:
        PluginError: A type or a number that makes no sense.
    """
    if element is None:
        return Noise()
    kind = element.find("type")
    name = (kind.text if kind is not None else element.attribute("type") or "gaussian").strip()
    if name in ("none", ""):
        return Noise()
    if name not in ("gaussian", "gaussian_quantized"):
        raise PluginError(
            f'noise of type "{name}" is not supported',
            code=devices.PLUGIN_PARAMETER_INVALID,
            origin=element.origin,
            hint="There are: none, gaussian, gaussian_quantized.",
            values={"parameter": "noise", "value": name},
        )
    values = {}
    for tag, field in _FIELDS.items():
        child = element.find(tag)
        least = -LARGEST if tag in _SIGNED else 0.0
        values[field] = number(child, least=least) if child is not None else 0.0
    noise = Noise(**values)
    idle = ""
    if noise.precision and name != "gaussian_quantized":
        noise = replace(noise, precision=0.0)
        idle = "<precision> only has an effect with noise of type gaussian_quantized"
    elif noise.walk and not noise.memory:
        idle = "<dynamic_bias_stddev> only has an effect with <dynamic_bias_correlation_time>"
    if idle:
        report(devices.SENSOR_SETTING_IGNORED.diagnostic(idle, origin=element.origin))
    return noise


class _Drift:
    """Gauss-Markov processes: what they are at a time does not depend on who has asked when.

    Args:
        part: Whose seed counts.
        name: Of the sequence.
        rate: Hz at which it is asked; 0 is every step.
        deviation: Standard deviations, of all times.
        frequency: 1/s, inverse of the time constants.
        settled: Whether it has one at the beginning; else it begins at 0.
    """

    def __init__(
        self,
        part: Part,
        name: str,
        *,
        rate: float,
        deviation: Array,
        frequency: Array,
        settled: bool,
    ) -> None:
        self._part, self._name, self._settled = part, name, settled
        self._period_ns = part.period_ns(rate)
        self._deviation = deviation
        self._keep = np.exp(-frequency * self._period_ns * 1e-9)
        self._grow = deviation * np.sqrt(1.0 - self._keep**2)
        self.restart()

    def restart(self) -> None:
        """Time is what it is now; the drift begins anew."""
        self._random = self._part.random(f"{self._name} drift")
        drawn: Array = self._random.normal(0.0, self._deviation)
        self._value = drawn if self._settled else np.zeros_like(drawn)
        self._told_ns = self._part.time_ns

    def put(self, value: Sequence[float]) -> None:
        """Sets it, as calibration does; it wanders on from there."""
        self.now()
        self._value = np.array(value, dtype=float)

    def now(self) -> Array:
        """The drift of this moment, shape (n,)."""
        steps = (self._part.time_ns - self._told_ns) // self._period_ns
        if steps < 0:
            # Time went back.
            self.restart()
            return self._value
        self._told_ns += steps * self._period_ns
        if self._deviation.any():
            for _ in range(steps):
                self._value = self._keep * self._value + self._random.normal(0.0, self._grow)
        return self._value


class VectorNoise:
    """Noise of several quantities that are measured together.

    Args:
        part: Whose seed counts.
        name: Of the sequence.
        noises: One for each quantity.
        rate: Hz at which they are measured; 0 is every step.
    """

    def __init__(self, part: Part, name: str, noises: Sequence[Noise], *, rate: float) -> None:
        self._part, self._name = part, name
        self._stddev = np.array([noise.stddev for noise in noises])
        self._mean = np.array([noise.mean for noise in noises])
        self._precision = np.array([noise.precision for noise in noises])
        self._rounds = self._precision > 0
        self.variance = self._stddev**2
        """Shape (n,)."""
        random = part.random(f"{name} bias")
        bias = random.normal(
            [noise.bias_mean for noise in noises], [noise.bias_stddev for noise in noises]
        )
        # Gazebo gives a bias either sign.
        self._fixed = self._mean + np.where(random.random(len(noises)) < 0.5, bias, -bias)
        memory = np.array([noise.memory for noise in noises])
        walk = np.where(memory > 0, [noise.walk for noise in noises], 0.0)
        self._drift = _Drift(
            part,
            name,
            rate=rate,
            # What a walk comes to that forgets: its density is the tag's.
            deviation=walk * np.sqrt(memory / 2),
            frequency=1.0 / np.where(memory > 0, memory, 1.0),
            settled=False,
        )
        self._none = not (
            self._stddev.any() or self._fixed.any() or walk.any() or self._precision.any()
        )

    @property
    def offset(self) -> Array:
        """Mean and bias of this moment, shape (n,)."""
        total: Array = self._fixed + self._drift.now()
        return total

    def add(self, values: Sequence[float]) -> Sequence[float]:
        """The values as they are measured at this moment."""
        if self._none:
            return values
        measured = np.asarray(values) + self.offset
        measured += self._part.random(self._name).normal(0.0, self._stddev)
        if self._rounds.any():
            step = np.where(self._rounds, self._precision, 1.0)
            measured = np.where(self._rounds, np.round(measured / step) * step, measured)
        told: list[float] = measured.tolist()
        return told


class DriftingError:
    """An offset, a slow drift and noise, as hector_gazebo_plugins' sensor models have them.

    The drift is a Gauss-Markov process: it has a standard deviation of its own at all times,
    and forgets with a time constant. (hector's own grows with the length of the step.) What it
    is at a time does not depend on who has listened since when.

    Args:
        part: Whose seed counts.
        name: Of the sequence.
        rate: Hz at which it is asked; 0 is every step.
        offset: Constant error.
        drift: Standard deviation of the drift.
        frequency: 1/s, inverse of the drift's time constant.
        noise: Standard deviation of the noise.
        scale: Factor on what is measured.
    """

    def __init__(
        self,
        part: Part,
        name: str,
        *,
        rate: float,
        offset: Sequence[float],
        drift: Sequence[float],
        frequency: Sequence[float],
        noise: Sequence[float],
        scale: Sequence[float],
    ) -> None:
        self._part, self._name = part, name
        self._offset, self._noise, self._scale = (np.array(v) for v in (offset, noise, scale))
        self._drift = _Drift(
            part,
            name,
            rate=rate,
            deviation=np.array(drift),
            frequency=np.array(frequency),
            settled=True,
        )
        self.variance = self._noise**2
        """Shape (n,), of the noise alone."""

    def restart(self) -> None:
        """Time is what it is now; the drift begins anew."""
        self._drift.restart()

    def put(self, drift: Sequence[float]) -> None:
        """Sets the drift, as calibration does; it wanders on from there."""
        self._drift.put(drift)

    @property
    def bias(self) -> Array:
        """Offset and drift of this moment, shape (n,)."""
        total: Array = self._offset + self._drift.now()
        return total

    def add(self, values: Sequence[float] | Array) -> Array:
        """The values as they are measured at this moment, shape (n,)."""
        noise = self._part.random(self._name).normal(0.0, self._noise)
        measured: Array = np.asarray(values) * self._scale + self.bias + noise
        return measured
