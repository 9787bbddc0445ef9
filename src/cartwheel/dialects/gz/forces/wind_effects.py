"""``gz-sim-wind-effects-system``: wind that pulls links along."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.codes import devices
from cartwheel.component import Shared
from cartwheel.description.model import PluginTag
from cartwheel.devices.air.wind_drag import Fluctuation, WindDrag, WindDragConfig
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import SMALLEST, read, tag
from cartwheel.errors import PluginError
from cartwheel.simulation import Part


def _rise(path: str, what: str) -> Any:
    return tag(
        f"{path}/time_for_rise",
        default=1.0,
        unit="s",
        least=SMALLEST,
        doc=f"Time constant with which {what} follows that in `<wind>`.",
    )


def _period(path: str) -> Any:
    return tag(
        f"{path}/sin/period", default=1.0, unit="s", least=SMALLEST, doc="Period of the sine."
    )


def _noise(path: str, name: str, unit: str, *, least: float | None = None) -> Any:
    what = "Mean" if name == "mean" else "Standard deviation"
    return tag(
        f"{path}/noise/{name}",
        default=0.0,
        unit=unit,
        least=least,
        doc=f"{what} of the Gaussian noise that is added at each step.",
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class WindEffectsParameters:
    factor: float = tag(
        "force_approximation_scaling_factor",
        default=1.0,
        unit="1/s",
        least=0.0,
        doc="Force per mass and velocity of the wind relative to a link. It must be one number: "
        "functions of the place are not supported.",
    )
    magnitude_rise: float = _rise("horizontal/magnitude", "the horizontal speed")
    magnitude_amplitude: float = tag(
        "horizontal/magnitude/sin/amplitude_percent",
        default=0.0,
        doc="Amplitude of a sine that is added to the horizontal speed, as a fraction of it.",
    )
    magnitude_period: float = _period("horizontal/magnitude")
    magnitude_mean: float = _noise("horizontal/magnitude", "mean", "m/s")
    magnitude_deviation: float = _noise("horizontal/magnitude", "stddev", "m/s", least=0.0)
    direction_rise: float = tag(
        "horizontal/direction/time_for_rise",
        default=1.0,
        unit="s",
        least=SMALLEST,
        doc="No effect: the direction in `<wind>` does not change.",
    )
    direction_amplitude: float = tag(
        "horizontal/direction/sin/amplitude",
        default=0.0,
        unit="degrees",
        doc="Amplitude of a sine that is added to the direction.",
    )
    direction_period: float = _period("horizontal/direction")
    direction_mean: float = _noise("horizontal/direction", "mean", "degrees")
    direction_deviation: float = _noise("horizontal/direction", "stddev", "degrees", least=0.0)
    vertical_rise: float = _rise("vertical", "the vertical speed")
    vertical_mean: float = _noise("vertical", "mean", "m/s")
    vertical_deviation: float = _noise("vertical", "stddev", "m/s", least=0.0)


class WindEffects(Plugin[WindEffectsParameters]):
    """Pulls the links with ``<enable_wind>`` along with the ``<wind>`` of the world.

    The force on a link is its mass times the velocity of the wind relative to the link, times a
    factor. The speed rises from 0 when the simulation starts. The topic that changes the wind is
    not supported. Original plugins: ``WindEffects`` in gz-sim, ``WindPlugin`` in Gazebo Classic.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-wind-effects-system", "libWindPlugin.so")
    for_world: ClassVar[bool] = True

    def configure(self) -> None:
        if not any(self.part.world.wind):
            self.part.report(
                devices.PLUGIN_IDLE.diagnostic(
                    "the world has no <wind>, so there is none",
                    severity="info",
                    origin=self.tag.origin,
                )
            )

    @classmethod
    def added_to(cls, part: Part, shared: Shared, tag: PluginTag) -> Iterator[WindDrag]:
        """Creates the wind on a model."""
        links = tuple(link.name for link in part.description.links if link.wind)
        if part.description.static or not links:
            return
        try:
            config, _ = read(WindEffectsParameters, tag.element)
        except PluginError:
            # The world reports it.
            return
        scope = cls._scope_on(part, shared, tag, "wind", "wind on")
        wind = WindDragConfig(
            links=links,
            wind=part.world.wind,
            factor=config.factor,
            magnitude=Fluctuation(
                rise=config.magnitude_rise,
                amplitude=config.magnitude_amplitude,
                period=config.magnitude_period,
                mean=config.magnitude_mean,
                deviation=config.magnitude_deviation,
            ),
            direction=Fluctuation(
                amplitude=math.radians(config.direction_amplitude),
                period=config.direction_period,
                mean=math.radians(config.direction_mean),
                deviation=math.radians(config.direction_deviation),
            ),
            vertical=Fluctuation(
                rise=config.vertical_rise,
                mean=config.vertical_mean,
                deviation=config.vertical_deviation,
            ),
        )
        yield part.made(lambda: WindDrag(scope, wind))
