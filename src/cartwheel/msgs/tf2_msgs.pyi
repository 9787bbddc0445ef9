"""Message types of tf2_msgs. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.msgs import _converted, geometry_msgs

@dataclass
class TF2Error:
    __msgtype__: ClassVar[str]
    NO_ERROR: ClassVar[int]
    LOOKUP_ERROR: ClassVar[int]
    CONNECTIVITY_ERROR: ClassVar[int]
    EXTRAPOLATION_ERROR: ClassVar[int]
    INVALID_ARGUMENT_ERROR: ClassVar[int]
    TIMEOUT_ERROR: ClassVar[int]
    TRANSFORM_ERROR: ClassVar[int]
    error: int = ...
    error_string: str = ...

@dataclass(init=False)
class TFMessage:
    __msgtype__: ClassVar[str]
    transforms: _converted.List[geometry_msgs.TransformStamped] = ...
    def __init__(
        self,
        transforms: list[geometry_msgs.TransformStamped]
        | tuple[geometry_msgs.TransformStamped, ...] = ...,
    ) -> None: ...
