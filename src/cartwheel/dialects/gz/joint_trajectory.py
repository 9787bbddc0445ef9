"""``gz-sim-joint-trajectory-controller-system``: joints that follow a trajectory's points."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

from cartwheel.codes import devices
from cartwheel.devices.joints.pid import PidGains
from cartwheel.devices.joints.stepped_trajectory import (
    SteppedJointConfig,
    SteppedTrajectory,
    SteppedTrajectoryConfig,
)
from cartwheel.dialects.gz.drive_tags import gz_name
from cartwheel.dialects.plugin import Plugin
from cartwheel.dialects.tags import tag
from cartwheel.errors import PluginError
from cartwheel.simulation.limits import FARTHEST


def _gain_tag(name: str, doc: str) -> Any:
    kind = name.partition("_")[0]
    limit = name.endswith(("_min", "_max"))
    default = "no limit" if limit else "`0`"
    return tag(
        name,
        default=(),
        unit="N m or N" if limit or name.endswith("cmd_offset") else "",
        doc=f"{doc} the {kind} controller, for each joint. Default: {default}.",
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class JointTrajectoryParameters:
    topic: str = tag(
        "topic",
        default="",
        doc="Topic of the JointTrajectory messages. Default: `/model/<model>/joint_trajectory`.",
    )
    header_start: bool = tag(
        "use_header_start_time",
        default=False,
        doc="Whether to start a trajectory at its header stamp instead of on arrival.",
    )
    joints: tuple[str, ...] = tag(
        "joint_name",
        default=(),
        role="joint",
        doc="Joint to control. Repeat the tag for each joint. Default: all single-axis joints.",
    )
    initial: tuple[float, ...] = tag(
        "initial_position",
        default=(),
        unit="rad or m",
        most=FARTHEST,
        doc="Initial target of each joint. Default: `0`.",
    )
    position_p_gain: tuple[float, ...] = _gain_tag("position_p_gain", "Proportional gain of")
    position_i_gain: tuple[float, ...] = _gain_tag("position_i_gain", "Integral gain of")
    position_d_gain: tuple[float, ...] = _gain_tag("position_d_gain", "Derivative gain of")
    position_i_min: tuple[float, ...] = _gain_tag(
        "position_i_min", "Lower limit of the integral term of"
    )
    position_i_max: tuple[float, ...] = _gain_tag(
        "position_i_max", "Upper limit of the integral term of"
    )
    position_cmd_min: tuple[float, ...] = _gain_tag("position_cmd_min", "Lower force limit of")
    position_cmd_max: tuple[float, ...] = _gain_tag("position_cmd_max", "Upper force limit of")
    position_cmd_offset: tuple[float, ...] = _gain_tag(
        "position_cmd_offset", "Constant force added by"
    )
    velocity_p_gain: tuple[float, ...] = _gain_tag("velocity_p_gain", "Proportional gain of")
    velocity_i_gain: tuple[float, ...] = _gain_tag("velocity_i_gain", "Integral gain of")
    velocity_d_gain: tuple[float, ...] = tag(
        "velocity_d_gain",
        default=(),
        doc="No effect: the velocity controller has no derivative term.",
    )
    velocity_i_min: tuple[float, ...] = _gain_tag(
        "velocity_i_min", "Lower limit of the integral term of"
    )
    velocity_i_max: tuple[float, ...] = _gain_tag(
        "velocity_i_max", "Upper limit of the integral term of"
    )
    velocity_cmd_min: tuple[float, ...] = _gain_tag("velocity_cmd_min", "Lower force limit of")
    velocity_cmd_max: tuple[float, ...] = _gain_tag("velocity_cmd_max", "Upper force limit of")
    velocity_cmd_offset: tuple[float, ...] = _gain_tag(
        "velocity_cmd_offset", "Constant force added by"
    )


class GzJointTrajectory(Plugin[JointTrajectoryParameters]):
    """Moves joints to the points of a trajectory, one point after the other.

    Each point is the target until its ``time_from_start`` has passed. The plugin does not
    interpolate between points, so smooth motion requires closely spaced points. The force or torque
    on a joint is the sum of three values: the output of a position controller, the output of a
    velocity controller, and the effort of the trajectory point.

    The progress is published on ``<topic>_progress`` (Float32). It is the number of the current
    point divided by the total number of points. Original plugin: ``JointTrajectoryController`` in
    gz-sim.
    """

    filenames: ClassVar[tuple[str, ...]] = ("gz-sim-joint-trajectory-controller-system",)

    def configure(self) -> None:
        config = self.config
        names = [name.strip() for name in config.joints] or [
            joint.name
            for joint in self.part.description.joints
            if joint.type in ("revolute", "continuous", "prismatic")
        ]
        if not names:
            raise PluginError(
                "the model has no single-axis joint, so it cannot follow a trajectory",
                code=devices.PLUGIN_IDLE,
                origin=self.tag.origin,
            )
        joints = tuple(
            SteppedJointConfig(
                name=name,
                initial=config.initial[index] if index < len(config.initial) else 0.0,
                position=self._gains("position", index),
                velocity=self._gains("velocity", index),
            )
            for index, name in enumerate(names)
        )
        self.add(
            SteppedTrajectory(
                self.scope,
                SteppedTrajectoryConfig(
                    joints=joints,
                    topic=gz_name(self, config.topic, "joint_trajectory"),
                    header_start=config.header_start,
                ),
            )
        )
        both = [gains for joint in joints for gains in (joint.position, joint.velocity)]
        if not any(gains.p or gains.i for gains in both):
            self.warn(
                devices.PLUGIN_IDLE,
                "all gains are 0, so only the efforts of the trajectory points are applied",
            )

    def _gains(self, quantity: str, index: int) -> PidGains:
        """Returns the gains for a joint by its index.

        Missing values are 0. Limits whose minimum exceeds the maximum are not applied.
        """

        def number(name: str, default: float = 0.0) -> float:
            numbers: tuple[float, ...] = getattr(self.config, f"{quantity}_{name}")
            return numbers[index] if index < len(numbers) else default

        def limits(name: str) -> tuple[float, float]:
            low, high = number(f"{name}_min"), number(f"{name}_max", -1.0)
            return (low, high) if low <= high else (-math.inf, math.inf)

        i_min, i_max = limits("i")
        u_min, u_max = limits("cmd")
        return PidGains(
            p=number("p_gain"),
            i=number("i_gain"),
            d=number("d_gain"),
            i_min=i_min,
            i_max=i_max,
            stored="limited term",
            offset=number("cmd_offset"),
            u_min=u_min,
            u_max=u_max,
        )
