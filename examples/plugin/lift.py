"""A lift on a vertical joint, with a topic, a service and an action."""

from dataclasses import dataclass
from typing import Any

from cartwheel.plugin import Goal, Plugin, tag

HEIGHT = "std_msgs/msg/Float64"
LOWER = "std_srvs/srv/Trigger"
LIFT = "control_msgs_ros2/action/GripperCommand"


@dataclass(frozen=True, kw_only=True)
class LiftParameters:
    joint: str = tag("joint", default="lift_joint", role="joint", doc="Joint of the platform.")
    speed: float = tag("speed", default=0.2, unit="m/s", doc="Maximum speed.")
    effort: float = tag("effort", default=500.0, unit="N", doc="Maximum force of the motor.")


class Lift(Plugin[LiftParameters]):
    """Moves a platform to the commanded height, m."""

    filenames = ("libplain_lift.so",)

    def configure(self) -> None:
        self.check_above_zero(speed=self.config.speed, effort=self.config.effort)
        self.joint = self.part.joint(self.config.joint)
        self.motor = self.part.servo(self.config.joint, max_effort=self.config.effort)
        self.goal: Goal | None = None
        self.subscribe("height", HEIGHT, self.on_height)
        self.serve("lower", LOWER, self.on_lower)
        self.action = self.offer_action(
            "lift", LIFT, on_goal=self.on_goal, on_cancel=self.on_cancel
        )
        self.part.schedule(20.0, after=self.check_goal)

    def move(self, height: float) -> None:
        self.motor.command_position(height, max_velocity=self.config.speed)

    def on_height(self, message: Any) -> None:
        self.move(message.data)

    def on_lower(self, _: Any) -> Any:
        self.move(0.0)
        return self.message_class("std_srvs/srv/Trigger_Response")(success=True)

    def on_goal(self, goal: Goal) -> None:
        if self.goal is not None:
            goal.reject(self.action.message("Result"), "the lift is moving")
            return
        goal.accept()
        self.goal = goal
        self.move(goal.goal.command.position)

    def on_cancel(self, goal: Goal) -> None:
        self.move(self.joint.position)
        goal.cancel(self.action.message("Result", position=self.joint.position))

    def check_goal(self) -> None:
        if self.goal is not None and not self.goal.done:
            height = self.joint.position
            if abs(height - self.goal.goal.command.position) < 0.001:
                self.goal.succeed(self.action.message("Result", position=height, reached_goal=True))
            else:
                self.goal.feedback(self.action.message("Feedback", position=height))
        if self.goal is not None and self.goal.done:
            self.goal = None

    def reset(self) -> None:
        super().reset()
        self.goal = None
        self.move(0.0)
