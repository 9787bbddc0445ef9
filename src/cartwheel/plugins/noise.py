"""Errors of sensors: Gaussian noise with a bias as SDF states it, slow drift as hector has it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cartwheel.description.model import Element
from cartwheel.errors import PluginError
from cartwheel.geometry import Array
from cartwheel.simulation import Part


@dataclass(frozen=True, kw_only=True, slots=True)
class Noise:
    """SDF's ``<noise>`` of one quantity."""

    mean: float = 0.0
    stddev: float = 0.0
    bias_mean: float = 0.0
    bias_stddev: float = 0.0


def read_noise(element: Element | None) -> Noise:
    """What a ``<noise>`` element says; none at all without one.

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
            origin=element.origin,
            hint="There are: none, gaussian, gaussian_quantized.",
        )
    values = {}
    for field in ("mean", "stddev", "bias_mean", "bias_stddev"):
        child = element.find(field)
        try:
            value = float(child.text) if child is not None else 0.0
        except ValueError:
            value = math.nan
        if not math.isfinite(value) or (value < 0 and field.endswith("stddev")):
            raise PluginError(f"<{field}> of a noise makes no sense", origin=element.origin)
        values[field] = value
    return Noise(**values)


class VectorNoise:
    """Noise of several quantities that are measured together.

    Args:
        part: Whose seed counts.
        name: Of the sequence.
        noises: One for each quantity.
    """

    def __init__(self, part: Part, name: str, noises: Sequence[Noise]) -> None:
        self._part, self._name = part, name
        self._stddev = np.array([noise.stddev for noise in noises])
        self._mean = np.array([noise.mean for noise in noises])
        self.variance = self._stddev**2
        """Shape (n,)."""
        random = part.random(f"{name} bias")
        bias = random.normal(
            [noise.bias_mean for noise in noises], [noise.bias_stddev for noise in noises]
        )
        # Gazebo gives a bias either sign.
        self._offset = self._mean + np.where(random.random(len(noises)) < 0.5, bias, -bias)
        self._none = not (self._stddev.any() or self._offset.any())

    def add(self, values: Sequence[float]) -> Sequence[float]:
        """The values as they are measured at this moment."""
        if self._none:
            return values
        drawn = self._part.random(self._name).normal(0.0, self._stddev)
        measured: list[float] = (np.asarray(values) + self._offset + drawn).tolist()
        return measured


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
        self._period_ns = part.period_ns(rate)
        self._offset, self._noise, self._scale = (np.array(v) for v in (offset, noise, scale))
        self._deviation = np.array(drift)
        self._keep = np.exp(-np.array(frequency) * self._period_ns * 1e-9)
        self._grow = self._deviation * np.sqrt(1.0 - self._keep**2)
        self.variance = self._noise**2
        """Shape (n,), of the noise alone."""
        self.restart()

    def restart(self) -> None:
        """Time is what it is now; the drift begins anew."""
        self._random = self._part.random(f"{self._name} drift")
        self._drift: Array = self._random.normal(0.0, self._deviation)
        self._told_ns = self._part.time_ns

    def put(self, drift: Sequence[float]) -> None:
        """Sets the drift, as calibration does; it wanders on from there."""
        self._advance()
        self._drift = np.array(drift, dtype=float)

    @property
    def bias(self) -> Array:
        """Offset and drift of this moment, shape (n,)."""
        self._advance()
        return self._offset + self._drift

    def add(self, values: Sequence[float] | Array) -> Array:
        """The values as they are measured at this moment, shape (n,)."""
        noise = self._part.random(self._name).normal(0.0, self._noise)
        measured: Array = np.asarray(values) * self._scale + self.bias + noise
        return measured

    def _advance(self) -> None:
        steps = (self._part.time_ns - self._told_ns) // self._period_ns
        self._told_ns += steps * self._period_ns
        if not self._deviation.any():
            return
        for _ in range(steps):
            self._drift = self._keep * self._drift + self._random.normal(0.0, self._grow)
