"""Message types of mav_msgs. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from cartwheel.msgs import _converted, std_msgs

@dataclass(init=False)
class Actuators:
    __msgtype__: ClassVar[str]
    header: std_msgs.Header = ...
    angles: _converted.Array[np.float64] = ...
    angular_velocities: _converted.Array[np.float64] = ...
    normalized: _converted.Array[np.float64] = ...
    def __init__(
        self,
        header: std_msgs.Header = ...,
        angles: ArrayLike = ...,
        angular_velocities: ArrayLike = ...,
        normalized: ArrayLike = ...,
    ) -> None: ...
