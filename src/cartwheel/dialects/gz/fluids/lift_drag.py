"""The lift and drag of wings and rotor blades in gz-sim and Gazebo Classic."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.air.lift_drag import AirfoilConfig, LiftDrag, LiftDragConfig
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import invalid, tag
from cartwheel.geometry import Vec3


@dataclass(frozen=True, kw_only=True, slots=True)
class LiftDragParameters:
    link: str = tag("link_name", role="link", doc="Link of the wing or rotor blade.")
    area: float = tag("area", default=1.0, unit="m²", doc="Area of the surface.")
    density: float = tag("air_density", default=1.2041, unit="kg/m³", doc="Density of the air.")
    cp: tuple[float, float, float] = tag(
        "cp", default=(0.0, 0.0, 0.0), unit="m", doc="Centre of pressure in the link."
    )
    forward: tuple[float, float, float] = tag(
        "forward",
        default=(1.0, 0.0, 0.0),
        doc="Direction in the link in which the surface moves at the angle of attack `<a0>`.",
    )
    upward: tuple[float, float, float] = tag(
        "upward", default=(0.0, 0.0, 1.0), doc="Direction of positive lift in the link."
    )
    a0: float = tag(
        "a0",
        default=0.0,
        unit="rad",
        doc="Angle of attack while the surface moves in the direction `<forward>`.",
    )
    cla: float = tag(
        "cla", default=1.0, unit="1/rad", doc="Change of the lift coefficient per angle of attack."
    )
    cda: float = tag(
        "cda", default=0.01, unit="1/rad", doc="Change of the drag coefficient per angle of attack."
    )
    cma: float = tag("cma", default=0.01, doc="No effect, as in Gazebo.")
    stall: float = tag(
        "alpha_stall",
        default=math.pi / 2,
        unit="rad",
        doc="Angle of attack at which the surface stalls.",
    )
    cla_stall: float = tag(
        "cla_stall",
        default=0.0,
        unit="1/rad",
        doc="Change of the lift coefficient beyond `<alpha_stall>`.",
    )
    cda_stall: float = tag(
        "cda_stall",
        default=1.0,
        unit="1/rad",
        doc="Change of the drag coefficient beyond `<alpha_stall>`.",
    )
    cma_stall: float = tag("cma_stall", default=0.0, doc="No effect, as in Gazebo.")
    radial: bool = tag(
        "radial_symmetry",
        default=False,
        doc="Whether the body is symmetric about `<forward>`. The lift then acts across it, and "
        "`<upward>` has no effect.",
    )
    joint: str = tag(
        "control_joint_name", default="", role="other_joint", doc="Joint of the control surface."
    )
    joint_slope: float = tag(
        "control_joint_rad_to_cl",
        default=4.0,
        unit="1/rad",
        doc="Change of the lift coefficient per angle of the control joint.",
    )


class LiftDragSystem(Plugin[LiftDragParameters]):
    """Applies lift and drag to a wing, a rotor blade or a control surface.

    Both are proportional to the square of the link's velocity relative to still air, and depend on
    the angle of attack. They act at the centre of pressure. A propeller with two blades has two
    such plugins. Original plugins: ``LiftDrag`` in gz-sim and ``LiftDragPlugin`` in Gazebo Classic.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-lift-drag-system", "libLiftDragPlugin.so")

    def configure(self) -> None:
        config = self.config
        self.check_not_negative("area", "density", "stall")
        self.add(
            LiftDrag(
                self.scope,
                LiftDragConfig(
                    link=config.link.strip(),
                    centre=config.cp,
                    forward=self._direction("forward"),
                    upward=self._direction("upward"),
                    control_joint=config.joint.strip(),
                    control_slope=config.joint_slope,
                    airfoil=AirfoilConfig(
                        area=config.area,
                        air_density=config.density,
                        zero_angle=config.a0,
                        lift_slope=config.cla,
                        drag_slope=config.cda,
                        stall_angle=config.stall,
                        stalled_lift_slope=config.cla_stall,
                        stalled_drag_slope=config.cda_stall,
                        radial=config.radial,
                    ),
                ),
            )
        )

    def _direction(self, name: str) -> Vec3:
        """Returns a normalized direction.

        Raises:
            PluginError: The direction has length 0.
        """
        x, y, z = vector = getattr(self.config, name)
        length = math.hypot(*vector)
        if length == 0.0:
            raise invalid(name, "0 0 0", "a direction, not zero", self.place_of(name))
        return x / length, y / length, z / length
