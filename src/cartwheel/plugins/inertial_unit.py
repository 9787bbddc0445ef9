"""What an inertial measurement unit on a link measures, without a topic (REP 145)."""

from __future__ import annotations

from collections.abc import Sequence

from cartwheel.description.model import Sensor
from cartwheel.errors import Origin
from cartwheel.geometry import IDENTITY, Pose, Quat, matrix_from_quat, quat_multiply
from cartwheel.plugins.noise import VectorNoise, read_noise
from cartwheel.simulation import Part


class InertialUnit:
    """Rates and proper acceleration in the unit's axes, its orientation against the world.

    Args:
        part: Of the model that carries it.
        link: That carries it.
        mount: Of the unit in the link.
        sensor: Whose ``<imu>`` states noise; None is without.
        origin: Place of a link that does not exist.
    """

    def __init__(
        self,
        part: Part,
        link: str,
        mount: Pose,
        *,
        sensor: Sensor | None = None,
        origin: Origin | None = None,
    ) -> None:
        self._link = part.link(link, origin=origin)
        self._mount = mount
        self._turn = matrix_from_quat(mount.orientation).T.tolist()
        self._aligned = mount.orientation == IDENTITY
        self.rate_noise: VectorNoise | None = None
        self.acceleration_noise: VectorNoise | None = None
        element = sensor.element.find("imu") if sensor is not None else None
        if sensor is None or element is None:
            return
        both = []
        for what, older in (("angular_velocity", "rate"), ("linear_acceleration", "accel")):
            noises = [read_noise(element.find(f"{what}/{axis}/noise")) for axis in "xyz"]
            if element.find(f"noise/{older}") is not None and element.find(what) is None:
                # As SDF 1.4 wrote it, one for all axes.
                noises = [read_noise(element.find(f"noise/{older}"))] * 3
            both.append(VectorNoise(part, f"imu {sensor.name} {what}", noises))
        self.rate_noise, self.acceleration_noise = both

    def measure(self) -> tuple[Quat, Sequence[float], Sequence[float]]:
        """Orientation, rates in rad/s and proper acceleration in m/s², with the sensor's noise."""
        _, turned = self._link.place()
        orientation = quat_multiply(turned, self._mount.orientation)
        # Rates first: the unit sits on a rigid link, so only its acceleration depends on where.
        rates = self.rates()
        acceleration = self._turned(self._link.proper_acceleration(self._mount.position).tolist())
        if self.acceleration_noise is not None:
            acceleration = self.acceleration_noise.add(acceleration)
        return orientation, rates, acceleration

    @property
    def gravity(self) -> Sequence[float]:
        """m/s², in the world's axes."""
        return self._link.gravity

    def rates(self) -> Sequence[float]:
        """What its gyroscopes measure, rad/s, with the sensor's noise."""
        _, turning = self._link.motion(local=True)
        rates = self._turned(turning)
        return rates if self.rate_noise is None else self.rate_noise.add(rates)

    def _turned(self, vector: Sequence[float]) -> Sequence[float]:
        """A vector of the link in the unit's axes."""
        if self._aligned:
            return vector
        x, y, z = vector
        return [a * x + b * y + c * z for a, b, c in self._turn]
