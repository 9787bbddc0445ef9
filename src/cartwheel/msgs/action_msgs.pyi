"""Message types of action_msgs. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.msgs import _converted, builtin_interfaces, unique_identifier_msgs

@dataclass(init=False)
class GoalInfo:
    __msgtype__: ClassVar[str]
    goal_id: unique_identifier_msgs.UUID = ...
    stamp: _converted.Time[builtin_interfaces.Time] = ...
    def __init__(
        self,
        goal_id: unique_identifier_msgs.UUID = ...,
        stamp: builtin_interfaces.Time | float = ...,
    ) -> None: ...

@dataclass
class GoalStatus:
    __msgtype__: ClassVar[str]
    STATUS_UNKNOWN: ClassVar[int]
    STATUS_ACCEPTED: ClassVar[int]
    STATUS_EXECUTING: ClassVar[int]
    STATUS_CANCELING: ClassVar[int]
    STATUS_SUCCEEDED: ClassVar[int]
    STATUS_CANCELED: ClassVar[int]
    STATUS_ABORTED: ClassVar[int]
    goal_info: GoalInfo = ...
    status: int = ...

@dataclass(init=False)
class GoalStatusArray:
    __msgtype__: ClassVar[str]
    status_list: _converted.List[GoalStatus] = ...
    def __init__(
        self,
        status_list: list[GoalStatus] | tuple[GoalStatus, ...] = ...,
    ) -> None: ...

@dataclass
class CancelGoal_Request:
    __msgtype__: ClassVar[str]
    goal_info: GoalInfo = ...

@dataclass(init=False)
class CancelGoal_Response:
    __msgtype__: ClassVar[str]
    ERROR_NONE: ClassVar[int]
    ERROR_REJECTED: ClassVar[int]
    ERROR_UNKNOWN_GOAL_ID: ClassVar[int]
    ERROR_GOAL_TERMINATED: ClassVar[int]
    return_code: int = ...
    goals_canceling: _converted.List[GoalInfo] = ...
    def __init__(
        self,
        return_code: int = ...,
        goals_canceling: list[GoalInfo] | tuple[GoalInfo, ...] = ...,
    ) -> None: ...
