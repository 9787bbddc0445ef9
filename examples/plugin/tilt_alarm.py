"""``libtilt_alarm.so``: publishes whether the robot is tipping over."""

import math
from dataclasses import dataclass

from cartwheel.messages import message_class
from cartwheel.plugin import Plugin, tag

BOOL = "std_msgs/msg/Bool"


@dataclass(frozen=True, kw_only=True)
class TiltAlarmParameters:
    topic: str = tag("topicName", default="tilt_alarm", doc="Topic of the alarm.")
    limit: float = tag("limit", default=0.3, unit="rad", doc="Tilt that raises the alarm.")
    rate: float = tag("updateRate", default=10.0, unit="Hz", doc="Publish rate.")


class TiltAlarm(Plugin[TiltAlarmParameters]):
    """Publishes true while the root link is tilted by more than a limit."""

    filenames = ("libtilt_alarm.so",)

    def configure(self) -> None:
        self.check_above_zero(limit=self.config.limit)
        self.link = self.link_or_root("")
        self.publisher = self.advertise(self.config.topic, BOOL, rate=self.config.rate)
        self.part.schedule(
            self.config.rate, after=self.publish, active=lambda: self.publisher.wanted
        )

    def publish(self) -> None:
        roll, pitch, _ = self.link.pose.rpy
        tilt = math.acos(math.cos(roll) * math.cos(pitch))
        self.publisher.publish(message_class(BOOL)(data=tilt > self.config.limit))
