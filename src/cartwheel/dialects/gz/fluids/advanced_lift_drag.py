"""``gz-sim-advanced-lift-drag-system``: an aeroplane, by its stability derivatives."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from cartwheel.description.model import Element
from cartwheel.devices.air.wing import ControlSurfaceConfig, Wing, WingConfig
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import SMALLEST, invalid, number_at, required, tag
from cartwheel.geometry import Array, Vec3

_NO_EFFECT = "No effect, as in gz-sim."
_LOADS = ("lift", "drag", "side", "roll", "pitch", "yaw")
_CONTROLS = ("CL_ctrl", "CD_ctrl", "CY_ctrl", "Cell_ctrl", "Cem_ctrl", "Cen_ctrl")
"""Tags of the effects of a control surface, in the order of `_LOADS`."""


def _slope(name: str, doc: str) -> Any:
    return tag(name, default=0.0, unit="1/rad", doc=doc)


def _rate(name: str, load: str, rate: str) -> Any:
    return tag(name, default=0.0, doc=f"Change of the {load} coefficient per dimensionless {rate}.")


@dataclass(frozen=True, kw_only=True, slots=True)
class AdvancedLiftDragParameters:
    link: str = tag("link_name", role="link", doc="Link on which the forces act.")
    area: float = tag("area", default=1.0, unit="m²", least=SMALLEST, doc="Area of the wing.")
    ratio: float = tag("AR", least=SMALLEST, doc="Aspect ratio of the wing.")
    efficiency: float = tag("eff", least=SMALLEST, doc="Oswald's efficiency factor.")
    chord: float = tag(
        "mac",
        default=0.0,
        unit="m",
        least=0.0,
        doc="Mean aerodynamic chord. 0: the area divided by the span.",
    )
    density: float = tag(
        "air_density", default=1.2041, unit="kg/m³", least=0.0, doc="Density of the air."
    )
    cp: tuple[float, float, float] = tag(
        "cp", default=(0.0, 0.0, 0.0), unit="m", doc="Centre of pressure in the link."
    )
    forward: tuple[float, float, float] = tag(
        "forward",
        default=(1.0, 0.0, 0.0),
        doc="Direction of flight in the link without angle of attack.",
    )
    upward: tuple[float, float, float] = tag(
        "upward", default=(0.0, 0.0, 1.0), doc="Direction of positive lift in the link."
    )
    stall: float = tag(
        "alpha_stall",
        default=math.pi / 2,
        unit="rad",
        doc="Angle of attack at which the wing stalls.",
    )
    lift: float = tag("CL0", default=0.0, doc="Lift coefficient without angle of attack.")
    drag: float = tag("CD0", default=0.0, doc="Drag coefficient without lift.")
    lift_attack: float = _slope("CLa", "Change of the lift coefficient per angle of attack.")
    lift_sideslip: float = _slope("CLb", "Change of the lift coefficient per angle of sideslip.")
    lift_roll: float = _rate("CLp", "lift", "roll rate")
    lift_pitch: float = _rate("CLq", "lift", "pitch rate")
    lift_yaw: float = _rate("CLr", "lift", "yaw rate")
    drag_roll: float = _rate("CDp", "drag", "roll rate")
    drag_pitch: float = _rate("CDq", "drag", "pitch rate")
    drag_yaw: float = _rate("CDr", "drag", "yaw rate")
    side_attack: float = _slope("CYa", "Change of the side force coefficient per angle of attack.")
    side_sideslip: float = _slope(
        "CYb", "Change of the side force coefficient per angle of sideslip."
    )
    side_roll: float = _rate("CYp", "side force", "roll rate")
    side_pitch: float = _rate("CYq", "side force", "pitch rate")
    side_yaw: float = _rate("CYr", "side force", "yaw rate")
    roll_attack: float = _slope(
        "Cella", "Change of the roll moment coefficient per angle of attack."
    )
    roll_sideslip: float = _slope(
        "Cellb", "Change of the roll moment coefficient per angle of sideslip."
    )
    roll_roll: float = _rate("Cellp", "roll moment", "roll rate")
    roll_pitch: float = _rate("Cellq", "roll moment", "pitch rate")
    roll_yaw: float = _rate("Cellr", "roll moment", "yaw rate")
    pitch_attack: float = _slope("Cema", _NO_EFFECT)
    pitch_sideslip: float = _slope(
        "Cemb", "Change of the pitching moment coefficient per angle of sideslip."
    )
    pitch_roll: float = _rate("Cemp", "pitching moment", "roll rate")
    pitch_pitch: float = _rate("Cemq", "pitching moment", "pitch rate")
    pitch_yaw: float = _rate("Cemr", "pitching moment", "yaw rate")
    yaw_attack: float = _slope("Cena", "Change of the yaw moment coefficient per angle of attack.")
    yaw_sideslip: float = _slope(
        "Cenb", "Change of the yaw moment coefficient per angle of sideslip."
    )
    yaw_roll: float = _rate("Cenp", "yaw moment", "roll rate")
    yaw_pitch: float = _rate("Cenq", "yaw moment", "pitch rate")
    yaw_yaw: float = _rate("Cenr", "yaw moment", "yaw rate")
    pitch: float = tag("Cem0", default=0.0, doc=_NO_EFFECT)
    pitch_stalled: float = tag("Cema_stall", default=0.0, doc=_NO_EFFECT)
    radial: bool = tag("radial_symmetry", default=False, doc=_NO_EFFECT)
    joint_slope: float = tag("control_joint_rad_to_cl", default=4.0, doc=_NO_EFFECT)
    count: int = tag(
        "num_ctrl_surfaces",
        default=0,
        least=0,
        doc="Number of the `<control_surface>` tags that act, from the first one on.",
    )
    surfaces: tuple[str, ...] = tag(
        "control_surface",
        default=(),
        nested=True,
        doc="A control surface: its joint `<name>`, the sign of its `<direction>`, and the changes "
        "of the coefficients per degree of the joint, `<CL_ctrl>`, `<CD_ctrl>`, `<CY_ctrl>`, "
        "`<Cell_ctrl>`, `<Cem_ctrl>` and `<Cen_ctrl>`. Repeat the tag for several.",
    )


class AdvancedLiftDragSystem(Plugin[AdvancedLiftDragParameters]):
    """Applies the forces and moments of still air to an aeroplane.

    They follow from the angles of attack and sideslip, the angular velocity and the control
    surfaces. Beyond the stall angle, the wing acts as a flat plate. The roll and yaw rates are
    multiplied by half the span and divided by the airspeed, and the pitch rate by half the mean
    chord. Original plugin: ``AdvancedLiftDrag`` in gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-advanced-lift-drag-system",)

    def configure(self) -> None:
        config = self.config
        surfaces = tuple(self._surfaces())
        self.add(
            Wing(
                self.scope,
                WingConfig(
                    link=config.link.strip(),
                    area=config.area,
                    aspect_ratio=config.ratio,
                    chord=config.chord or math.sqrt(config.area / config.ratio),
                    efficiency=config.efficiency,
                    air_density=config.density,
                    centre=config.cp,
                    forward=self._direction("forward"),
                    upward=self._direction("upward"),
                    stall_angle=config.stall,
                    lift=config.lift,
                    drag=config.drag,
                    by_attack=self._slopes("attack") * [1, 1, 1, 1, 0, 1],
                    by_sideslip=self._slopes("sideslip"),
                    by_rates=np.column_stack(
                        [self._slopes(name) for name in ("roll", "pitch", "yaw")]
                    ),
                    surfaces=surfaces,
                ),
            )
        )

    def _slopes(self, name: str) -> Array:
        """The change of each coefficient per angle or rate, shape (6,)."""
        return np.array([getattr(self.config, f"{load}_{name}", 0.0) for load in _LOADS])

    def _surfaces(self) -> Iterator[ControlSurfaceConfig]:
        """Yields the control surfaces that act.

        Raises:
            PluginError: A tag is missing, or a value is not a number.
        """
        elements = list(self.tag.element.find_all("control_surface"))
        if len(elements) > self.config.count:
            self.warn_ignored(
                "control_surface",
                f"only the first {self.config.count} act, as <num_ctrl_surfaces> states",
            )
        for element in elements[: self.config.count]:
            sign = _required_number(element, "direction")
            effects = [_required_number(element, name) for name in _CONTROLS]
            yield ControlSurfaceConfig(
                joint=required(element, "name").text.strip(), effects=sign * np.array(effects)
            )

    def _direction(self, name: str) -> Vec3:
        """Returns a normalized direction.

        Raises:
            PluginError: The direction has length 0.
        """
        x, y, z = vector = getattr(self.config, name)
        length = math.hypot(*vector)
        if length < SMALLEST:
            raise invalid(name, "0 0 0", "a direction, not zero", self.place_of(name))
        return x / length, y / length, z / length


def _required_number(element: Element, name: str) -> float:
    required(element, name)
    return number_at(element, name)
