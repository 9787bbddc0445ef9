"""Message types of rmw_dds_common. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from cartwheel.msgs import _converted

@dataclass(init=False)
class Gid:
    __msgtype__: ClassVar[str]
    data: _converted.Array[np.uint8] = ...
    def __init__(
        self,
        data: ArrayLike = ...,
    ) -> None: ...

@dataclass(init=False)
class NodeEntitiesInfo:
    __msgtype__: ClassVar[str]
    node_namespace: str = ...
    node_name: str = ...
    reader_gid_seq: _converted.List[Gid] = ...
    writer_gid_seq: _converted.List[Gid] = ...
    def __init__(
        self,
        node_namespace: str = ...,
        node_name: str = ...,
        reader_gid_seq: list[Gid] | tuple[Gid, ...] = ...,
        writer_gid_seq: list[Gid] | tuple[Gid, ...] = ...,
    ) -> None: ...

@dataclass(init=False)
class ParticipantEntitiesInfo:
    __msgtype__: ClassVar[str]
    gid: Gid = ...
    node_entities_info_seq: _converted.List[NodeEntitiesInfo] = ...
    def __init__(
        self,
        gid: Gid = ...,
        node_entities_info_seq: list[NodeEntitiesInfo] | tuple[NodeEntitiesInfo, ...] = ...,
    ) -> None: ...
