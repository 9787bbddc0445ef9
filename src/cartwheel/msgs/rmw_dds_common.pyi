"""Message types of rmw_dds_common. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

@dataclass
class Gid:
    __msgtype__: ClassVar[str]
    data: NDArray[np.uint8] = ...

@dataclass
class NodeEntitiesInfo:
    __msgtype__: ClassVar[str]
    node_namespace: str = ...
    node_name: str = ...
    reader_gid_seq: list[Gid] = ...
    writer_gid_seq: list[Gid] = ...

@dataclass
class ParticipantEntitiesInfo:
    __msgtype__: ClassVar[str]
    gid: Gid = ...
    node_entities_info_seq: list[NodeEntitiesInfo] = ...
