"""The base class of drives that follow Twist commands and publish odometry."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.component import Component, Scope
from cartwheel.devices.drives.odometry import Odometry, OdometryConfig, base_of
from cartwheel.devices.drives.reckoning import Motion
from cartwheel.devices.drives.timeouts import CommandTimeouts
from cartwheel.devices.joints.states import JointStates, JointStatesConfig


@dataclass(frozen=True, kw_only=True, slots=True)
class DriveConfig:
    """Topics and rates of a drive."""

    command_topic: str
    """Topic of the Twist commands."""
    timeout: float | None = None
    """Time after which the robot stops without a command, s; None: never."""
    control_rate: float
    """Rate of the control loop, Hz; 0: every step."""
    limited_joints: bool = False
    """Whether the velocity limits of the joints apply, as in gz-sim."""
    odometry: OdometryConfig
    """The odometry. Its rate is the publish rate of all topics."""
    joint_states: JointStatesConfig | None = None
    """The joint states; None: not published."""


class Drives:
    """The drives of a simulation, in the order in which they were created."""

    def __init__(self) -> None:
        self.all: list[Drive] = []

    def of(self, nodes: Sequence[str]) -> Drive | None:
        """The first drive of these nodes, such as the subscribers of a topic."""
        return next((each for each in self.all if each.node in nodes), None)


class Drive(Component):
    """Base class of drives.

    A subclass acquires its joints and then calls `run`, which creates the topics and the control
    loop. `command` stores a command, `update` executes it, and `motion` returns the pose and
    velocity that the odometry contains.
    """

    sideways: ClassVar[bool] = False
    """Whether ``linear.y`` of the commands is followed."""
    enabled: bool = True
    """Whether commands move the robot. Requires a `timeout`."""

    def __init__(self, scope: Scope) -> None:
        super().__init__(scope)
        self._odometry: Odometry | None = None
        self._joint_states: JointStates | None = None

    def run(self, config: DriveConfig, *, reads_state: bool = False) -> None:
        """Advertises topics, subscribes to commands and schedules the control loop.

        Args:
            config: Topics and rates.
            reads_state: Whether `command` and `update` read only positions and velocities of
                joints; see `Task.reads_state`.
        """
        self._odometry = self.add(Odometry(self.scope, config.odometry))
        if config.joint_states is not None:
            self._joint_states = self.add(JointStates(self.scope, config.joint_states))
        self._base = base_of(self, config.odometry)
        self.subscribe(config.command_topic, "geometry_msgs/msg/Twist", self._on_command)
        if config.timeout is not None:
            self._timeout = config.timeout
            self.shared.get(CommandTimeouts).set(self.node, config.timeout)
            self.part.schedule(0, before=self._watch).reads_state = reads_state
        idle = self.is_idle if self.can_idle() else None
        self._controlling = self.part.schedule(config.control_rate, before=self._control, idle=idle)
        self._controlling.reads_state = reads_state
        owners = (self, self._odometry, self._joint_states)
        topics = [topic for each in owners if each is not None for topic in each.publishers]
        self.part.schedule(config.odometry.rate, after=self._publish, topics=topics)
        drives = self.shared.get(Drives).all
        drives.append(self)
        self._open.callback(drives.remove, self)
        self.reset()

    def reset(self) -> None:
        """Stops the robot and forgets commands and odometry."""
        super().reset()
        self.enabled = True
        self._updated_ns: int | None = None
        self._received_ns = 0

    def command(self, forward: float, sideways: float, turn: float) -> None:
        """Stores a command.

        Args:
            forward: Velocity in x, m/s.
            sideways: Velocity in y, m/s.
            turn: Yaw rate in rad/s, or a steering angle in rad: the drive defines it.
        """
        raise NotImplementedError

    def commanded(self, forward: float, turn: float) -> tuple[float, float]:
        """The velocity that a command without a sideways part asks for: m/s in x and rad/s.

        Args:
            forward: ``linear.x``, m/s.
            turn: ``angular.z``, rad/s or rad.
        """
        return forward, turn

    def update(self, seconds: float) -> None:
        """Executes the command; `seconds` is the time since the last call, or 0."""
        raise NotImplementedError

    def can_idle(self) -> bool:
        """Whether `is_idle` may become true."""
        return False

    def is_idle(self) -> bool:
        """Whether `update` would change nothing before the next command, after the first update."""
        return self._updated_ns is not None

    def respond(self) -> None:
        """Executes a new command between two updates, if the drive does so without a ramp.

        Called if the command arrives between two runs, after the update that is due at this time.
        """

    def motion(self) -> Motion:
        """Returns pose and velocity for the odometry: by default, those in the world."""
        return self._base.planar_motion()

    def publish(self, time_ns: int) -> None:
        """Publishes on the topics that have subscribers."""
        states, odometry = self._joint_states, self._odometry
        if states is not None and states.publisher.wanted:
            states.publish(time_ns)
        if odometry is not None and odometry.wanted():
            place, turn, linear, angular = self.motion()
            odometry.publish(time_ns, place, turn, linear, angular)

    def _on_command(self, message: Any) -> None:
        linear, angular = message.linear, message.angular
        self.receive(float(linear.x), float(linear.y), float(angular.z))

    def receive(self, forward: float, sideways: float, turn: float) -> None:
        """Takes a command that has just arrived; see `command`."""
        self._received_ns = self.part.time_ns
        self.command(forward, sideways, turn)
        if self.enabled and self._updated_ns == self._received_ns and self.part.served:
            self.respond()

    def _watch(self) -> None:
        late = (self.part.time_ns - self._received_ns) * 1e-9 > self._timeout
        if late or not self.enabled:
            self.command(0.0, 0.0, 0.0)

    def _control(self) -> None:
        now, before = self.part.clock.time_ns, self._updated_ns
        idles = self._controlling.idle is not None
        if idles and self.is_idle():
            self._updated_ns = now
            return
        self._updated_ns = now
        if idles and before is not None:
            # It may have been idle since.
            before = max(before, self.part.last_due_ns(self._controlling))
        self.update(0.0 if before is None else (now - before) * 1e-9)

    def _publish(self) -> None:
        self.publish(self.part.clock.time_ns)
