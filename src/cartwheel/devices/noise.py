"""Errors of sensors: Gaussian noise with a bias, and a drift that is a Gauss-Markov process."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cartwheel.geometry import Array
from cartwheel.simulation import Part


@dataclass(frozen=True, kw_only=True, slots=True)
class Noise:
    """Noise on one measured quantity, in the quantity's unit."""

    mean: float = 0.0
    """Constant error."""
    stddev: float = 0.0
    """Standard deviation of the white noise of one measurement."""
    bias_mean: float = 0.0
    """Mean of the bias, which is drawn once and has a random sign."""
    bias_stddev: float = 0.0
    """Standard deviation of the bias."""
    dynamic_bias_stddev: float = 0.0
    """Random walk of the bias: its standard deviation after 1 s, which grows with the square root
    of time."""
    dynamic_bias_correlation_time: float = 0.0
    """Correlation time of the random walk, s. At 0 the bias is constant."""
    precision: float = 0.0
    """If positive, measurements are rounded to a multiple of this."""


def stationary_deviation(density: Array, correlation_time: Array) -> Array:
    """Returns the standard deviation that a random walk with a correlation time approaches.

    Args:
        density: Standard deviation of the walk after 1 s.
        correlation_time: Seconds.
    """
    deviation: Array = density * np.sqrt(correlation_time / 2)
    return deviation


def gauss_markov_step(deviation: Array, frequency: Array, period_ns: int) -> tuple[Array, Array]:
    """Returns the factors of a Gauss-Markov process for steps of a fixed length.

    Args:
        deviation: Stationary standard deviation.
        frequency: Inverse of the time constant, 1/s.
        period_ns: Length of a step, ns.

    Returns:
        The factor on the previous value, and the standard deviation of the random number that is
        added to it.
    """
    kept: Array = np.exp(-frequency * period_ns * 1e-9)
    added: Array = deviation * np.sqrt(1.0 - kept**2)
    return kept, added


def quantize(values: Array, step: Array | float) -> Array:
    """Rounds values to multiples of a positive step."""
    rounded: Array = np.round(values / step) * step
    return rounded


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
        self.drifts = bool(deviation.any())
        """Whether the values change."""
        self._kept, self._added = gauss_markov_step(deviation, frequency, self._period_ns)
        self.restart()
        part.on_seed.append(self.restart)

    def restart(self) -> None:
        """Starts a new drift at the current time."""
        self._random = self._part.random_stream(f"{self._name} drift")
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
        if self.drifts:
            for _ in range(steps):
                self._value = self._kept * self._value + self._random.normal(0.0, self._added)
        return self._value


@dataclass(frozen=True, kw_only=True, slots=True)
class VectorNoiseConfig:
    name: str
    """Name of the random sequence."""
    noises: tuple[Noise, ...]
    """Noise on each quantity."""
    rate: float
    """Measurement rate, Hz; 0: every step."""


class VectorNoise:
    """Noise on several quantities that are measured together.

    Args:
        part: Provides the seed and the time.
        config: Noise of each quantity.
    """

    def __init__(self, part: Part, config: VectorNoiseConfig) -> None:
        name, noises = config.name, config.noises
        self._part, self._name = part, name
        self._stddev = np.array([noise.stddev for noise in noises])
        self._mean = np.array([noise.mean for noise in noises])
        self._precision = np.array([noise.precision for noise in noises])
        self._rounds = self._precision > 0
        self.variance = self._stddev**2
        """Variance of the white noise, shape (n,)."""
        self._bias = [noise.bias_mean for noise in noises], [noise.bias_stddev for noise in noises]
        self._draw()
        part.on_seed.append(self._draw)
        time = np.array([noise.dynamic_bias_correlation_time for noise in noises])
        walk = np.where(time > 0, [noise.dynamic_bias_stddev for noise in noises], 0.0)
        self._drift = _Drift(
            part,
            name,
            rate=config.rate,
            deviation=stationary_deviation(walk, time),
            frequency=1.0 / np.where(time > 0, time, 1.0),
            settled=False,
        )
        self._none = not (
            self._stddev.any()
            or self._mean.any()
            or any(map(any, self._bias))
            or walk.any()
            or self._precision.any()
        )

    def _draw(self) -> None:
        """Draws the constant bias."""
        random = self._part.random(f"{self._name} bias")
        bias = random.normal(*self._bias)
        # The sign of the bias is random.
        self._fixed = self._mean + np.where(random.random(len(bias)) < 0.5, bias, -bias)

    @property
    def offset(self) -> Array:
        """Mean plus current bias, shape (n,)."""
        if not self._drift.drifts:
            return self._fixed
        total: Array = self._fixed + self._drift.now()
        return total

    def restart(self) -> None:
        """Has no effect: the bias is constant, and its drift restarts when time is reset."""

    def add(self, values: Sequence[float]) -> Sequence[float]:
        """Adds noise to the values, as measured at the current time."""
        if self._none:
            return values
        measured = np.asarray(values) + self.offset
        measured += self._part.random(self._name).normal(0.0, self._stddev)
        if self._rounds.any():
            step = np.where(self._rounds, self._precision, 1.0)
            measured = np.where(self._rounds, quantize(measured, step), measured)
        result: list[float] = measured.tolist()
        return result


@dataclass(frozen=True, kw_only=True, slots=True)
class DriftingErrorConfig:
    """Configuration of a `DriftingError`. Sequences have one number for each quantity."""

    name: str
    """Name of the random sequence."""
    rate: float
    """Measurement rate, Hz; 0: every step."""
    offset: Sequence[float]
    """Constant error."""
    drift: Sequence[float]
    """Standard deviation of the drift."""
    frequency: Sequence[float]
    """Inverse of the drift's time constant, 1/s."""
    noise: Sequence[float]
    """Standard deviation of the noise."""
    scale: Sequence[float]
    """Factor on the true value."""
    bias: float = 0.0
    """Standard deviation of a further constant error of each quantity, which is drawn once."""


class DriftingError:
    """Scale factor, offset, drift and white noise on quantities that are measured together.

    The drift is a Gauss-Markov process with a constant standard deviation. Its value depends only
    on time, not on subscribers.

    Args:
        part: Provides the seed and the time.
        config: Errors of each quantity.
    """

    def __init__(self, part: Part, config: DriftingErrorConfig) -> None:
        self._part, self._name = part, config.name
        self._config = config
        self._noise, self._scale = np.array(config.noise), np.array(config.scale)
        self._draw()
        part.on_seed.append(self._draw)
        self._drift = _Drift(
            part,
            config.name,
            rate=config.rate,
            deviation=np.array(config.drift),
            frequency=np.array(config.frequency),
            settled=True,
        )
        self.variance = self._noise**2
        """Variance of the noise, without drift, shape (n,)."""

    def _draw(self) -> None:
        """Draws the constant error."""
        self._offset = np.array(self._config.offset)
        if self._config.bias:
            random = self._part.random(f"{self._name} bias")
            self._offset = self._offset + random.normal(0.0, self._config.bias, len(self._offset))

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

    def add(self, values: Sequence[float]) -> Sequence[float]:
        """Adds all errors to the values, as measured at the current time."""
        noise = self._part.random(self._name).normal(0.0, self._noise)
        measured: Array = np.asarray(values) * self._scale + self.bias + noise
        result: list[float] = measured.tolist()
        return result


ErrorConfig = VectorNoiseConfig | DriftingErrorConfig
"""Errors of a sensor that supports both models."""


def sensor_error(part: Part, config: ErrorConfig) -> VectorNoise | DriftingError:
    """Returns the errors that a configuration describes."""
    if isinstance(config, VectorNoiseConfig):
        return VectorNoise(part, config)
    return DriftingError(part, config)
