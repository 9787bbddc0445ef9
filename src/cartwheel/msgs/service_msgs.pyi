"""Message types of service_msgs. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from cartwheel.msgs import _converted, builtin_interfaces

@dataclass(init=False)
class ServiceEventInfo:
    __msgtype__: ClassVar[str]
    REQUEST_SENT: ClassVar[int]
    REQUEST_RECEIVED: ClassVar[int]
    RESPONSE_SENT: ClassVar[int]
    RESPONSE_RECEIVED: ClassVar[int]
    event_type: int = ...
    stamp: _converted.Time[builtin_interfaces.Time] = ...
    client_gid: _converted.Array[np.uint8] = ...
    sequence_number: int = ...
    def __init__(
        self,
        event_type: int = ...,
        stamp: builtin_interfaces.Time | float = ...,
        client_gid: ArrayLike = ...,
        sequence_number: int = ...,
    ) -> None: ...
