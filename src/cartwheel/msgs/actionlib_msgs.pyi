"""Message types of actionlib_msgs. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.msgs import _converted, builtin_interfaces, std_msgs

@dataclass(init=False)
class GoalID:
    __msgtype__: ClassVar[str]
    stamp: _converted.Time[builtin_interfaces.Time] = ...
    id: str = ...
    def __init__(
        self,
        stamp: builtin_interfaces.Time | float = ...,
        id: str = ...,
    ) -> None: ...

@dataclass
class GoalStatus:
    __msgtype__: ClassVar[str]
    PENDING: ClassVar[int]
    ACTIVE: ClassVar[int]
    PREEMPTED: ClassVar[int]
    SUCCEEDED: ClassVar[int]
    ABORTED: ClassVar[int]
    REJECTED: ClassVar[int]
    PREEMPTING: ClassVar[int]
    RECALLING: ClassVar[int]
    RECALLED: ClassVar[int]
    LOST: ClassVar[int]
    goal_id: GoalID = ...
    status: int = ...
    text: str = ...

@dataclass(init=False)
class GoalStatusArray:
    __msgtype__: ClassVar[str]
    header: std_msgs.Header = ...
    status_list: _converted.List[GoalStatus] = ...
    def __init__(
        self,
        header: std_msgs.Header = ...,
        status_list: list[GoalStatus] | tuple[GoalStatus, ...] = ...,
    ) -> None: ...
