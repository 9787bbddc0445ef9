"""``libgazebo_ros_elevator.so``: an elevator with floors and a door."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.codes import devices, running
from cartwheel.devices.mechanisms.elevator import Elevator, ElevatorConfig
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import SMALLEST, shown, tag


@dataclass(frozen=True, kw_only=True, slots=True)
class ElevatorParameters:
    lift_joint: str = tag(
        "lift_joint", role="joint", doc="Prismatic joint that moves the elevator car."
    )
    door_joint: str = tag(
        "door_joint", role="joint", doc="Prismatic joint of the door. Position 0 is closed."
    )
    floor_height: float = tag(
        "floor_height",
        default=3.0,
        unit="m",
        least=SMALLEST,
        doc="Vertical distance between two consecutive floors.",
    )
    door_wait_time: float = tag(
        "door_wait_time",
        default=5.0,
        unit="s",
        least=0.0,
        doc="Time for which the door stays open.",
    )
    topic: str = tag(
        "topic",
        default="elevator",
        doc="Topic of the String messages with the number of the target floor.",
    )
    bottom_floor: int | None = tag(
        "bottom_floor", default=None, doc="Number of the lowest floor. Default: no limit."
    )
    top_floor: int | None = tag(
        "top_floor", default=None, doc="Number of the highest floor. Default: no limit."
    )


class ElevatorPlugin(Plugin[ElevatorParameters]):
    """Moves the car of an elevator to the commanded floor, and opens and closes its door.

    For each command, the door closes and the car moves. The door then opens, waits for
    ``<door_wait_time>`` and closes. Until the door is closed again, new commands are ignored. At
    floor n, the position of the lift joint is n times ``<floor_height>``. Original plugins:
    ``gazebo_ros_elevator`` in the package ``gazebo_plugins``, and ``ElevatorPlugin`` in Gazebo
    Classic.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libgazebo_ros_elevator.so", "libElevatorPlugin.so")

    def configure(self) -> None:
        config = self.config
        if self.tag.element.find("floor_height") is None:
            self.warn(
                devices.PLUGIN_PARAMETER_MISSING,
                "<floor_height> is missing, so 3 m is used",
                values={"parameter": "floor_height"},
            )
        self._elevator = self.add(
            Elevator(
                self.scope,
                ElevatorConfig(
                    lift_joint=self._joint_name(config.lift_joint),
                    door_joint=self._joint_name(config.door_joint),
                    floor_height=config.floor_height,
                    door_wait=config.door_wait_time,
                    lowest_floor=config.bottom_floor,
                    highest_floor=config.top_floor,
                ),
            )
        )
        topic = config.topic.strip().removeprefix("~/") or "elevator"
        self.subscribe(topic, "std_msgs/msg/String", self._on_command)

    def _joint_name(self, name: str) -> str:
        """Returns the name of a joint, which can be prefixed with the model's name."""
        description = self.part.description
        if description.joint(name) is not None:
            return name
        return name.removeprefix(f"{description.name}::").removeprefix(f"{self.part.name}::")

    def _on_command(self, message: Any) -> None:
        text = str(message.data).strip()
        try:
            floor = int(text)
        except ValueError:
            self.warn(
                running.COMMAND_IGNORED,
                f'a command is ignored: the floor must be a whole number (got "{shown(text)}")',
                values={"floor": shown(text)},
            )
            return
        self._elevator.travel(floor)
