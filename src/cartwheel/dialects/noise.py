"""Sensor errors: SDF's Gaussian noise with bias, and hector_gazebo_plugins' slow drift."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from cartwheel.codes import devices
from cartwheel.description.model import Element
from cartwheel.description.numbers import LARGEST
from cartwheel.dialects.tags import number
from cartwheel.errors import Diagnostic, PluginError
from cartwheel.geometry import Array
from cartwheel.simulation import Part


@dataclass(frozen=True, kw_only=True, slots=True)
class Noise:
    """SDF's ``<noise>`` on one measured quantity."""

    mean: float = 0.0
    stddev: float = 0.0
    bias_mean: float = 0.0
    bias_stddev: float = 0.0
    walk: float = 0.0
    """Random walk of the bias: its standard deviation after 1 s, which grows with the square root
    of time."""
    memory: float = 0.0
    """Correlation time of the random walk, s. At 0 the bias is constant."""
    precision: float = 0.0
    """If positive, measurements are rounded to a multiple of this."""


_FIELDS = {
    "mean": "mean",
    "stddev": "stddev",
    "bias_mean": "bias_mean",
    "bias_stddev": "bias_stddev",
    "dynamic_bias_stddev": "walk",
    "dynamic_bias_correlation_time": "memory",
    "precision": "precision",
}
"""Fields of `Noise` by SDF tag."""
_SIGNED = ("mean", "bias_mean")


def read_noise(element: Element | None, report: Callable[[Diagnostic], None]) -> Noise:
    """Reads a ``<noise>`` element.

    Args:
        element: The element; None: no noise.
        report: Receives diagnostics about settings without effect.

    Raises:
        PluginError: The type or a number is not allowed.
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
            hint="Supported types: none, gaussian, gaussian_quantized.",
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
        idle = "<precision> has an effect only with noise of type gaussian_quantized"
    elif noise.walk and not noise.memory:
        idle = "<dynamic_bias_stddev> has an effect only with <dynamic_bias_correlation_time>"
    if idle:
        report(devices.SENSOR_SETTING_IGNORED.diagnostic(idle, origin=element.origin))
    return noise


class _Drift:
    """Gauss-Markov processes. Their values depend only on time, not on when they are read.

    Args:
        part: Provides the seed and the time.
        name: Name of the random sequence.
        rate: Hz at which the value changes; 0: at every step.
        deviation: Stationary standard deviations, shape (n,).
        frequency: Inverse of the time constants, 1/s, shape (n,).
        settled: Start from the stationary distribution; otherwise from 0.
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
        """Starts a new drift at the current time."""
        self._random = self._part.random(f"{self._name} drift")
        drawn: Array = self._random.normal(0.0, self._deviation)
        self._value = drawn if self._settled else np.zeros_like(drawn)
        self._updated_ns = self._part.time_ns

    def put(self, value: Sequence[float]) -> None:
        """Sets the current value, as calibration does."""
        self.now()
        self._value = np.array(value, dtype=float)

    def now(self) -> Array:
        """Current value, shape (n,)."""
        steps = (self._part.time_ns - self._updated_ns) // self._period_ns
        if steps < 0:
            # Simulation time was reset.
            self.restart()
            return self._value
        self._updated_ns += steps * self._period_ns
        if self._deviation.any():
            for _ in range(steps):
                self._value = self._keep * self._value + self._random.normal(0.0, self._grow)
        return self._value


class VectorNoise:
    """Noise on several quantities that are measured together.

    Args:
        part: Provides the seed and the time.
        name: Name of the random sequence.
        noises: Noise on each quantity.
        rate: Measurement rate in Hz; 0: every step.
    """

    def __init__(self, part: Part, name: str, noises: Sequence[Noise], *, rate: float) -> None:
        self._part, self._name = part, name
        self._stddev = np.array([noise.stddev for noise in noises])
        self._mean = np.array([noise.mean for noise in noises])
        self._precision = np.array([noise.precision for noise in noises])
        self._rounds = self._precision > 0
        self.variance = self._stddev**2
        """Variance of the white noise, shape (n,)."""
        random = part.random(f"{name} bias")
        bias = random.normal(
            [noise.bias_mean for noise in noises], [noise.bias_stddev for noise in noises]
        )
        # As in Gazebo, the sign of the bias is random.
        self._fixed = self._mean + np.where(random.random(len(noises)) < 0.5, bias, -bias)
        memory = np.array([noise.memory for noise in noises])
        walk = np.where(memory > 0, [noise.walk for noise in noises], 0.0)
        self._drift = _Drift(
            part,
            name,
            rate=rate,
            # Stationary deviation of a random walk with this density and correlation time.
            deviation=walk * np.sqrt(memory / 2),
            frequency=1.0 / np.where(memory > 0, memory, 1.0),
            settled=False,
        )
        self._none = not (
            self._stddev.any() or self._fixed.any() or walk.any() or self._precision.any()
        )

    @property
    def offset(self) -> Array:
        """Mean plus current bias, shape (n,)."""
        total: Array = self._fixed + self._drift.now()
        return total

    def add(self, values: Sequence[float]) -> Sequence[float]:
        """Adds noise to the values, as measured at the current time."""
        if self._none:
            return values
        measured = np.asarray(values) + self.offset
        measured += self._part.random(self._name).normal(0.0, self._stddev)
        if self._rounds.any():
            step = np.where(self._rounds, self._precision, 1.0)
            measured = np.where(self._rounds, np.round(measured / step) * step, measured)
        result: list[float] = measured.tolist()
        return result


class DriftingError:
    """The error model of hector_gazebo_plugins: scale factor, offset, slow drift and noise.

    The drift is a Gauss-Markov process with a constant standard deviation. (In the original plugin,
    the drift grows with the step length.) Its value depends only on time, not on subscribers.

    Args:
        part: Provides the seed and the time.
        name: Name of the random sequence.
        rate: Measurement rate in Hz; 0: every step.
        offset: Constant error.
        drift: Standard deviation of the drift.
        frequency: Inverse of the drift's time constant, 1/s.
        noise: Standard deviation of the noise.
        scale: Factor on the true value.
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
        """Variance of the noise, without drift, shape (n,)."""

    def restart(self) -> None:
        """Starts a new drift at the current time."""
        self._drift.restart()

    def put(self, drift: Sequence[float]) -> None:
        """Sets the current drift, as calibration does."""
        self._drift.put(drift)

    @property
    def bias(self) -> Array:
        """Offset plus current drift, shape (n,)."""
        total: Array = self._offset + self._drift.now()
        return total

    def add(self, values: Sequence[float] | Array) -> Array:
        """Adds all errors to the values, as measured at the current time, shape (n,)."""
        noise = self._part.random(self._name).normal(0.0, self._noise)
        measured: Array = np.asarray(values) * self._scale + self.bias + noise
        return measured
