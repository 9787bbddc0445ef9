"""The supported controller types."""

from __future__ import annotations

import functools

from cartwheel.codes import devices
from cartwheel.errors import UnknownNameError
from cartwheel.plugins.control.controller import Controller

ACKERMANN = "ackermann_steering_controller/AckermannSteeringController"


@functools.cache
def controller_types() -> dict[str, type[Controller]]:
    """Returns all controller types by name, in the spellings of ROS 1 and ROS 2."""
    from cartwheel.plugins.control.diff_drive import DiffDriveController
    from cartwheel.plugins.control.gripper import (
        GripperActionController,
        ParallelGripperActionController,
    )
    from cartwheel.plugins.control.joint_commands import JointCommand, JointGroup, JointPid
    from cartwheel.plugins.control.joint_states import JointStateController
    from cartwheel.plugins.control.joint_trajectory import JointTrajectoryController
    from cartwheel.plugins.control.mecanum import MecanumDriveController
    from cartwheel.plugins.control.motor_command import UnitreeJointController
    from cartwheel.plugins.control.pid_controller import PidController
    from cartwheel.plugins.control.sensors import ForceTorqueBroadcaster, ImuBroadcaster
    from cartwheel.plugins.control.steering import (
        SingleSteering,
        SteeringController,
        TricycleController,
    )

    families: tuple[type[Controller], ...] = (
        JointStateController,
        JointCommand,
        JointPid,
        JointGroup,
        UnitreeJointController,
        PidController,
        JointTrajectoryController,
        GripperActionController,
        ParallelGripperActionController,
        DiffDriveController,
        SingleSteering,
        SteeringController,
        TricycleController,
        MecanumDriveController,
        ImuBroadcaster,
        ForceTorqueBroadcaster,
    )
    return {name: family for family in families for name in family.types}


def find_type(name: str, *, ros2: bool) -> type[Controller]:
    """Returns the class of a controller type. The C++ spelling ``a::B`` is read as ``a/B``.

    Raises:
        UnknownNameError: The type is not supported.
    """
    known = controller_types()
    plain = name.strip().replace("::", "/")
    if not ros2 and plain == ACKERMANN:
        # ROS 1 and ROS 2 use this name for two different controllers.
        from cartwheel.plugins.control.steering import SingleSteering

        return SingleSteering
    if plain not in known:
        raise UnknownNameError("controller type", name, known, code=devices.CONTROLLER_TYPE_UNKNOWN)
    return known[plain]
