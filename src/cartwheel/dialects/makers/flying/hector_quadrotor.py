"""``libhector_gazebo_quadrotor_simple_controller.so``: a quadrotor that follows velocities."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.devices.air.simple_quadrotor import SimpleQuadrotor, SimpleQuadrotorConfig
from cartwheel.dialects.makers.flying.quadrotor_tags import QuadrotorTags, read_control
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag

_TRUE_STATE = "No effect: the true state of the link is used instead of this topic."


@dataclass(frozen=True, kw_only=True, slots=True)
class HectorQuadrotorParameters(QuadrotorTags):
    topic: str = tag("topicName", default="cmd_vel", doc="Topic of the commands (Twist).")
    wrench_topic: str = tag(
        "wrenchTopic",
        default="wrench_out",
        doc="Topic of the force and the torque (Wrench). Not published if empty.",
    )
    imu_topic: str = tag("imuTopic", default="", doc=_TRUE_STATE)
    state_topic: str = tag("stateTopic", default="", doc=_TRUE_STATE)
    rate: float = tag(
        "updateRate",
        default=0.0,
        unit="Hz",
        least=0.0,
        doc="Rate of the controllers. If 0, they run at every simulation step.",
    )
    engages: bool = tag(
        "autoEngage",
        default=True,
        doc="Whether a command to climb faster than 0.1 m/s switches the motors on, and a command "
        "to descend switches them off on the ground.",
    )


class HectorQuadrotor(Plugin[HectorQuadrotorParameters]):
    """Flies a quadrotor without propellers, which follows velocities in level axes.

    PID controllers compute a force along the z axis of the link and a torque from the velocity and
    the orientation of the link. The force compensates gravity. The services ``engage`` and
    ``shutdown`` (Empty) switch the motors on and off. Original plugin:
    ``gazebo_quadrotor_simple_controller`` in the package ``hector_quadrotor_gazebo_plugins``.
    """

    filenames: ClassVar[tuple[str, ...]] = ("libhector_gazebo_quadrotor_simple_controller.so",)

    def configure(self) -> None:
        config = self.config
        self.add(
            SimpleQuadrotor(
                self.scope,
                SimpleQuadrotorConfig(
                    control=read_control(self, p=0.0, d=0.0, acts_at="origin", leads=True),
                    topic=config.topic,
                    wrench_topic=config.wrench_topic.strip(),
                    rate=config.rate,
                    switches_itself=config.engages,
                ),
            )
        )
