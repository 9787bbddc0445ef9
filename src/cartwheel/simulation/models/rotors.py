"""The rotors of motors, whose velocities are commands."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable

from cartwheel.simulation.dynamics.joint_servo import ServoHandle
from cartwheel.simulation.dynamics.velocity_motor import JointStop, MotorHandle
from cartwheel.simulation.part import Part


class Rotors:
    """The rotors of all velocity motors in the compiled model.

    The torque of a motor changes the velocity of its rotor by about a millionth of a rad/s in
    100 ms, because a rotor's inertia is large but finite. A task that is idle does not write its
    command again, so the velocities are set again at fixed times.
    """

    def __init__(self) -> None:
        self._motors: list[MotorHandle] = []
        self._stops: list[JointStop] = []
        self._shared: list[tuple[list[MotorHandle], list[ServoHandle]]] = []
        """The handles of each joint that several plugins drive."""

    def bind(self, parts: Iterable[Part]) -> None:
        """Finds the motors of models, whose handles are bound."""
        self._motors, self._stops, self._shared = [], [], []
        for part in parts:
            motors: dict[str, list[MotorHandle]] = defaultdict(list)
            servos: dict[str, list[ServoHandle]] = defaultdict(list)
            for handle in part.handles:
                if isinstance(handle, MotorHandle):
                    motors[handle.motor.joint].append(handle)
                elif isinstance(handle, ServoHandle):
                    servos[handle.motor.joint].append(handle)
                elif isinstance(handle, JointStop):
                    self._stops.append(handle)
            for joint, found in motors.items():
                if len(found) == 1 and joint not in servos:
                    self._motors += found
                else:
                    self._shared.append((found, servos[joint]))

    def hold(self) -> None:
        """Sets the velocities of all rotors to the commands of their motors."""
        for motor in self._motors:
            motor.rotors[motor.dof] = motor.target
        for stop in self._stops:
            if stop.ends is not None:
                stop.hold()
        for motors, servos in self._shared:
            if any(servo.mode in ("velocity", "position") for servo in servos):
                continue
            # The nearest command is the last one, because the velocity has hardly changed.
            rotors, dof = motors[0].rotors, motors[0].dof
            rotors[dof] = min((each.target for each in motors), key=lambda t: abs(t - rotors[dof]))
