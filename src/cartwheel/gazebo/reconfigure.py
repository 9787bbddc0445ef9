"""Physics parameters for dynamic_reconfigure clients."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cartwheel.errors import CartwheelError, Diagnostic
from cartwheel.gazebo.physics import Physics
from cartwheel.gazebo.requests import failed
from cartwheel.graph import Graph
from cartwheel.graph.reconfigure import ReconfigureParameter, ReconfigureServer, Value

_KEPT = "Stored and returned, but has no effect in MuJoCo."


def _double(
    name: str, default: float, low: float, high: float, text: str = _KEPT
) -> ReconfigureParameter:
    return ReconfigureParameter(
        name=name,
        type="double",
        default=default,
        minimum=low,
        maximum=high,
        description=text,
        level=1,
    )


def _int(name: str, default: int, high: int) -> ReconfigureParameter:
    return ReconfigureParameter(
        name=name,
        type="int",
        default=default,
        minimum=0,
        maximum=high,
        description=_KEPT,
        level=1,
    )


PARAMETERS = (
    _double("time_step", 0.001, 0.0, 10.0, "Simulation time step in s."),
    _double(
        "max_update_rate",
        60.0,
        0.0,
        1000.0,
        "Target number of steps per second of wall time; 0 means as fast as possible.",
    ),
    _double("gravity_x", 0.0, -100.0, 100.0, "Gravity along the world's x axis in m/s²."),
    _double("gravity_y", 0.0, -100.0, 100.0, "Gravity along the world's y axis in m/s²."),
    _double("gravity_z", -9.8, -100.0, 100.0, "Gravity along the world's z axis in m/s²."),
    ReconfigureParameter(
        name="auto_disable_bodies", type="bool", default=False, description=_KEPT, level=1
    ),
    _int("sor_pgs_precon_iters", 0, 10_000),
    _int("sor_pgs_iters", 20, 10_000),
    _double("sor_pgs_w", 1.3, 0.0, 5.0),
    _double("sor_pgs_rms_error_tol", -1.0, -1.0, 10_000.0),
    _double("cfm", 0.0, 0.0, 10.0),
    _double("erp", 0.2, 0.0, 10.0),
    _double("contact_surface_layer", 0.001, 0.0, 10.0),
    _double("contact_max_correcting_vel", 100.0, 0.0, 10_000_000.0),
    _int("max_contacts", 100, 10_000_000),
)
"""Names, limits and defaults in Gazebo 11."""


class PhysicsReconfigure:
    """``/gazebo/set_parameters``: the same as set_physics_properties, by parameter.

    Source: gazebo_ros, ``Physics.cfg``.
    """

    def __init__(
        self, physics: Physics, graph: Graph, node: str, report: Callable[[Diagnostic], None]
    ) -> None:
        self._physics = physics
        self._report = report
        self._server = ReconfigureServer(
            graph, "/gazebo", PARAMETERS, self._change, node=node, initial=self._present()
        )
        physics.on_change = self._tell

    def close(self) -> None:
        """Removes the service and its topics."""
        self._physics.on_change = lambda: None
        self._server.close()

    def _present(self) -> dict[str, Value]:
        physics = self._physics
        x, y, z = physics.gravity
        return {
            "time_step": physics.time_step,
            "max_update_rate": physics.max_update_rate,
            "gravity_x": x,
            "gravity_y": y,
            "gravity_z": z,
            **physics.ode,
        }

    def _tell(self) -> None:
        self._server.update(self._present())

    def _change(self, values: dict[str, Value]) -> dict[str, Value]:
        """Applies values that differ from the last published ones: others may have changed."""
        reported, now = self._server.values, self._present()
        new: dict[str, Any] = now | {k: v for k, v in values.items() if v != reported[k]}
        try:
            self._physics.change(
                time_step=new["time_step"],
                max_update_rate=new["max_update_rate"],
                gravity=(new["gravity_x"], new["gravity_y"], new["gravity_z"]),
                ode={name: new[name] for name in self._physics.ode},
                tell=False,
            )
        except CartwheelError as error:
            self._report(failed("/gazebo/set_parameters", error))
        return self._present()
