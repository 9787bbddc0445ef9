"""Services for gravity, step length, speed, pause and reset."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from typing import Any

from cartwheel.gazebo.requests import Answer, Offer, refused, vector, vector_message
from cartwheel.geometry import Vec3
from cartwheel.messages import from_dict
from cartwheel.simulation import RunState, Simulation
from cartwheel.simulation.clock import NANOSECONDS, to_ns
from cartwheel.simulation.limits import check_speed, number

LONGEST_STEP = 0.1
"""s; with a longer step, no contact is stable."""
_ODE_DEFAULTS: dict[str, float | int | bool] = {
    "auto_disable_bodies": False,
    "sor_pgs_precon_iters": 0,
    "sor_pgs_iters": 50,
    "sor_pgs_w": 1.3,
    "sor_pgs_rms_error_tol": 0.0,
    "contact_surface_layer": 0.001,
    "contact_max_correcting_vel": 100.0,
    "cfm": 0.0,
    "erp": 0.2,
    "max_contacts": 20,
}
"""Default values in Gazebo 11."""


class Physics:
    """physics_properties, pause, unpause and the two resets.

    The target real-time factor is time_step times max_update_rate. ODE's parameters are stored and
    returned, but have no effect on this solver. Source: gazebo_ros, gazebo_ros_api_plugin.
    """

    def __init__(self, simulation: Simulation) -> None:
        self._simulation = simulation
        self.ode: dict[str, float | int | bool] = dict(_ODE_DEFAULTS)
        """The last values of ODE's parameters."""
        self.on_change: Callable[[], None] = lambda: None
        """Called after a request changed a value."""

    def offers(self) -> list[Offer]:
        """The services."""
        package, empty = "gazebo_msgs/srv", "std_srvs/srv/Empty"
        return [
            Offer("get_physics_properties", f"{package}/GetPhysicsProperties", self.get),
            Offer("set_physics_properties", f"{package}/SetPhysicsProperties", self.set),
            Offer("pause_physics", empty, self._doing(self._simulation.pause)),
            Offer("unpause_physics", empty, self._doing(self._simulation.resume)),
            Offer("reset_simulation", empty, self._doing(self._simulation.reset)),
            Offer("reset_world", empty, self._doing(self._reset_world)),
        ]

    @staticmethod
    def _doing(function: Callable[[], None]) -> Callable[[Any], Answer]:
        def handle(_: Any) -> Answer:
            function()
            return Answer()

        return handle

    def _reset_world(self) -> None:
        self._simulation.reset(keep_time=True)

    @property
    def time_step(self) -> float:
        """Step length, s."""
        return self._simulation.step_ns / NANOSECONDS

    @property
    def gravity(self) -> Vec3:
        """Gravity, m/s²."""
        return self._simulation.world.gravity

    @property
    def max_update_rate(self) -> float:
        """Target number of steps per second of wall time; 0 is as fast as possible."""
        speed = self._simulation.speed
        return 0.0 if speed is None else speed * NANOSECONDS / self._simulation.step_ns

    def get(self, request: Any) -> Answer:  # noqa: ARG002 - it is empty
        fields = {
            "time_step": self.time_step,
            "pause": self._simulation.run_state is not RunState.RUNNING,
            "max_update_rate": self.max_update_rate,
            "gravity": vector_message(self.gravity),
            "ode_config": from_dict("gazebo_msgs/msg/ODEPhysics", self.ode),
        }
        return Answer("GetPhysicsProperties: got properties", fields)

    def set(self, request: Any) -> Answer:
        notes = self.change(
            time_step=request.time_step,
            max_update_rate=request.max_update_rate,
            gravity=vector(request.gravity, "gravity"),
            ode={name: getattr(request.ode_config, name) for name in _ODE_DEFAULTS},
        )
        return Answer("physics engine updated", notes=notes)

    def change(
        self,
        *,
        time_step: float,
        max_update_rate: float,
        gravity: Vec3,
        ode: Mapping[str, float | int | bool],
        tell: bool = True,
    ) -> tuple[str, ...]:
        """Applies all values and, if `tell` is set, calls the callback for changes.

        Returns:
            Parameters without effect.

        Raises:
            CartwheelError: A value is invalid; nothing has changed.
        """
        step_ns = to_ns(number(time_step, "time_step"))
        if not 1 <= step_ns <= to_ns(LONGEST_STEP):
            raise refused(
                f"time_step must be above 0 and at most {LONGEST_STEP:g} s (got {time_step:g} s)",
                "time_step",
                value=time_step,
            )
        rate = number(max_update_rate, "max_update_rate", most=1e9)
        for name, value in ode.items():
            number(value, f"ode_config.{name}", most=1e308)
        speed = step_ns / NANOSECONDS * rate if rate > 0 else None
        check_speed(speed)
        simulation = self._simulation
        world = simulation.world
        changed = dataclasses.replace(world, gravity=gravity)
        if step_ns != simulation.step_ns:
            physics = dataclasses.replace(world.physics, max_step_size=step_ns / NANOSECONDS)
            changed = dataclasses.replace(changed, physics=physics)
        if changed != world:
            simulation.change_world(changed)
        simulation.set_speed(speed)
        unlike = [name for name, value in ode.items() if value != self.ode[name]]
        self.ode |= ode
        if tell:
            self.on_change()
        if not unlike:
            return ()
        return (f"{', '.join(unlike)}: stored, but has no effect in MuJoCo",)
