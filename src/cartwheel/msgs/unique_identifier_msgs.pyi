"""Message types of unique_identifier_msgs. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from cartwheel.msgs import _converted

@dataclass(init=False)
class UUID:
    __msgtype__: ClassVar[str]
    uuid: _converted.Array[np.uint8] = ...
    def __init__(
        self,
        uuid: ArrayLike = ...,
    ) -> None: ...
