"""Message types of std_msgs. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from cartwheel.msgs import builtin_interfaces

@dataclass
class Bool:
    __msgtype__: ClassVar[str]
    data: bool = ...

@dataclass
class Byte:
    __msgtype__: ClassVar[str]
    data: int = ...

@dataclass
class ByteMultiArray:
    __msgtype__: ClassVar[str]
    layout: MultiArrayLayout = ...
    data: NDArray[np.uint8] = ...

@dataclass
class Char:
    __msgtype__: ClassVar[str]
    data: int = ...

@dataclass
class ColorRGBA:
    __msgtype__: ClassVar[str]
    r: float = ...
    g: float = ...
    b: float = ...
    a: float = ...

@dataclass
class Empty:
    __msgtype__: ClassVar[str]

@dataclass
class Float32:
    __msgtype__: ClassVar[str]
    data: float = ...

@dataclass
class Float32MultiArray:
    __msgtype__: ClassVar[str]
    layout: MultiArrayLayout = ...
    data: NDArray[np.float32] = ...

@dataclass
class Float64:
    __msgtype__: ClassVar[str]
    data: float = ...

@dataclass
class Float64MultiArray:
    __msgtype__: ClassVar[str]
    layout: MultiArrayLayout = ...
    data: NDArray[np.float64] = ...

@dataclass
class Header:
    __msgtype__: ClassVar[str]
    stamp: builtin_interfaces.Time = ...
    frame_id: str = ...

@dataclass
class Int16:
    __msgtype__: ClassVar[str]
    data: int = ...

@dataclass
class Int16MultiArray:
    __msgtype__: ClassVar[str]
    layout: MultiArrayLayout = ...
    data: NDArray[np.int16] = ...

@dataclass
class Int32:
    __msgtype__: ClassVar[str]
    data: int = ...

@dataclass
class Int32MultiArray:
    __msgtype__: ClassVar[str]
    layout: MultiArrayLayout = ...
    data: NDArray[np.int32] = ...

@dataclass
class Int64:
    __msgtype__: ClassVar[str]
    data: int = ...

@dataclass
class Int64MultiArray:
    __msgtype__: ClassVar[str]
    layout: MultiArrayLayout = ...
    data: NDArray[np.int64] = ...

@dataclass
class Int8:
    __msgtype__: ClassVar[str]
    data: int = ...

@dataclass
class Int8MultiArray:
    __msgtype__: ClassVar[str]
    layout: MultiArrayLayout = ...
    data: NDArray[np.int8] = ...

@dataclass
class MultiArrayDimension:
    __msgtype__: ClassVar[str]
    label: str = ...
    size: int = ...
    stride: int = ...

@dataclass
class MultiArrayLayout:
    __msgtype__: ClassVar[str]
    dim: list[MultiArrayDimension] = ...
    data_offset: int = ...

@dataclass
class String:
    __msgtype__: ClassVar[str]
    data: str = ...

@dataclass
class UInt16:
    __msgtype__: ClassVar[str]
    data: int = ...

@dataclass
class UInt16MultiArray:
    __msgtype__: ClassVar[str]
    layout: MultiArrayLayout = ...
    data: NDArray[np.uint16] = ...

@dataclass
class UInt32:
    __msgtype__: ClassVar[str]
    data: int = ...

@dataclass
class UInt32MultiArray:
    __msgtype__: ClassVar[str]
    layout: MultiArrayLayout = ...
    data: NDArray[np.uint32] = ...

@dataclass
class UInt64:
    __msgtype__: ClassVar[str]
    data: int = ...

@dataclass
class UInt64MultiArray:
    __msgtype__: ClassVar[str]
    layout: MultiArrayLayout = ...
    data: NDArray[np.uint64] = ...

@dataclass
class UInt8:
    __msgtype__: ClassVar[str]
    data: int = ...

@dataclass
class UInt8MultiArray:
    __msgtype__: ClassVar[str]
    layout: MultiArrayLayout = ...
    data: NDArray[np.uint8] = ...
