"""``gz-sim-buoyancy-engine-system``: a bladder that makes an underwater vehicle rise and sink."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.codes import devices
from cartwheel.devices.water.buoyancy_engine import BuoyancyEngine, BuoyancyEngineConfig
from cartwheel.dialects.gz.drive_tags import gz_name
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.errors import PluginError


@dataclass(frozen=True, kw_only=True, slots=True)
class BuoyancyEngineParameters:
    link: str = tag("link_name", role="link", doc="Link on which the force acts.")
    namespace: str = tag(
        "namespace",
        default="",
        doc="If set, the topics begin with `/model/<namespace>`.",
    )
    least: float = tag(
        "min_volume", default=3e-5, unit="m³", least=0.0, doc="Minimum volume of the bladder."
    )
    neutral: float = tag(
        "neutral_volume",
        default=3e-4,
        unit="m³",
        least=0.0,
        doc="Volume of the bladder at which it exerts no force.",
    )
    initial: float | None = tag(
        "default_volume",
        default=None,
        unit="m³",
        least=0.0,
        doc="Initial volume. Default: `<min_volume>`.",
    )
    most: float = tag(
        "max_volume", default=9.9e-4, unit="m³", least=0.0, doc="Maximum volume of the bladder."
    )
    rate: float = tag(
        "max_inflation_rate",
        default=3e-6,
        unit="m³/s",
        least=0.0,
        doc="Maximum change of the volume.",
    )
    density: float = tag(
        "fluid_density", default=1000.0, unit="kg/m³", least=0.0, doc="Density of the fluid."
    )
    surface: float | None = tag(
        "surface",
        default=None,
        unit="m",
        doc="Height of the surface, above which the bladder has no buoyancy. Default: no surface.",
    )


class BuoyancyEngineSystem(Plugin[BuoyancyEngineParameters]):
    """Applies the buoyancy of a bladder, whose volume follows commands, to a link.

    Commands in m³ (Float64) are received on ``/buoyancy_engine``, and the volume is published on
    ``/buoyancy_engine/current_volume``. The force acts at the centre of mass. It is 0 at the
    neutral volume, which balances the weight of the bladder's oil. Original plugin:
    ``BuoyancyEngine`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-buoyancy-engine-system",)

    def configure(self) -> None:
        config = self.config
        if config.least > config.most:
            raise PluginError(
                "<min_volume> must not exceed <max_volume> "
                f"(got {config.least:g} and {config.most:g})",
                code=devices.PLUGIN_RANGE_REVERSED,
                origin=self.place_of("min_volume"),
                values={"parameter": "min_volume", "value": config.least, "most": config.most},
            )
        namespace = config.namespace.strip()
        topic = f"model/{namespace}/buoyancy_engine" if namespace else "buoyancy_engine"
        self.add(
            BuoyancyEngine(
                self.scope,
                BuoyancyEngineConfig(
                    link=config.link.strip(),
                    command_topic=gz_name(self, topic, ""),
                    state_topic=gz_name(self, f"{topic}/current_volume", ""),
                    least=config.least,
                    most=config.most,
                    neutral=config.neutral,
                    initial=config.least if config.initial is None else config.initial,
                    rate=config.rate,
                    density=config.density,
                    surface=config.surface,
                ),
            )
        )
