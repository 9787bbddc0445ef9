"""Message types of std_msgs. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from cartwheel.msgs import _converted, builtin_interfaces

@dataclass
class Bool:
    __msgtype__: ClassVar[str]
    data: bool = ...

@dataclass
class Byte:
    __msgtype__: ClassVar[str]
    data: int = ...

@dataclass(init=False)
class ByteMultiArray:
    __msgtype__: ClassVar[str]
    layout: MultiArrayLayout = ...
    data: _converted.Array[np.uint8] = ...
    def __init__(
        self,
        layout: MultiArrayLayout = ...,
        data: ArrayLike = ...,
    ) -> None: ...

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

@dataclass(init=False)
class Float32MultiArray:
    __msgtype__: ClassVar[str]
    layout: MultiArrayLayout = ...
    data: _converted.Array[np.float32] = ...
    def __init__(
        self,
        layout: MultiArrayLayout = ...,
        data: ArrayLike = ...,
    ) -> None: ...

@dataclass
class Float64:
    __msgtype__: ClassVar[str]
    data: float = ...

@dataclass(init=False)
class Float64MultiArray:
    __msgtype__: ClassVar[str]
    layout: MultiArrayLayout = ...
    data: _converted.Array[np.float64] = ...
    def __init__(
        self,
        layout: MultiArrayLayout = ...,
        data: ArrayLike = ...,
    ) -> None: ...

@dataclass(init=False)
class Header:
    __msgtype__: ClassVar[str]
    stamp: _converted.Time[builtin_interfaces.Time] = ...
    frame_id: str = ...
    def __init__(
        self,
        stamp: builtin_interfaces.Time | float = ...,
        frame_id: str = ...,
    ) -> None: ...

@dataclass
class Int16:
    __msgtype__: ClassVar[str]
    data: int = ...

@dataclass(init=False)
class Int16MultiArray:
    __msgtype__: ClassVar[str]
    layout: MultiArrayLayout = ...
    data: _converted.Array[np.int16] = ...
    def __init__(
        self,
        layout: MultiArrayLayout = ...,
        data: ArrayLike = ...,
    ) -> None: ...

@dataclass
class Int32:
    __msgtype__: ClassVar[str]
    data: int = ...

@dataclass(init=False)
class Int32MultiArray:
    __msgtype__: ClassVar[str]
    layout: MultiArrayLayout = ...
    data: _converted.Array[np.int32] = ...
    def __init__(
        self,
        layout: MultiArrayLayout = ...,
        data: ArrayLike = ...,
    ) -> None: ...

@dataclass
class Int64:
    __msgtype__: ClassVar[str]
    data: int = ...

@dataclass(init=False)
class Int64MultiArray:
    __msgtype__: ClassVar[str]
    layout: MultiArrayLayout = ...
    data: _converted.Array[np.int64] = ...
    def __init__(
        self,
        layout: MultiArrayLayout = ...,
        data: ArrayLike = ...,
    ) -> None: ...

@dataclass
class Int8:
    __msgtype__: ClassVar[str]
    data: int = ...

@dataclass(init=False)
class Int8MultiArray:
    __msgtype__: ClassVar[str]
    layout: MultiArrayLayout = ...
    data: _converted.Array[np.int8] = ...
    def __init__(
        self,
        layout: MultiArrayLayout = ...,
        data: ArrayLike = ...,
    ) -> None: ...

@dataclass
class MultiArrayDimension:
    __msgtype__: ClassVar[str]
    label: str = ...
    size: int = ...
    stride: int = ...

@dataclass(init=False)
class MultiArrayLayout:
    __msgtype__: ClassVar[str]
    dim: _converted.List[MultiArrayDimension] = ...
    data_offset: int = ...
    def __init__(
        self,
        dim: list[MultiArrayDimension] | tuple[MultiArrayDimension, ...] = ...,
        data_offset: int = ...,
    ) -> None: ...

@dataclass
class String:
    __msgtype__: ClassVar[str]
    data: str = ...

@dataclass
class UInt16:
    __msgtype__: ClassVar[str]
    data: int = ...

@dataclass(init=False)
class UInt16MultiArray:
    __msgtype__: ClassVar[str]
    layout: MultiArrayLayout = ...
    data: _converted.Array[np.uint16] = ...
    def __init__(
        self,
        layout: MultiArrayLayout = ...,
        data: ArrayLike = ...,
    ) -> None: ...

@dataclass
class UInt32:
    __msgtype__: ClassVar[str]
    data: int = ...

@dataclass(init=False)
class UInt32MultiArray:
    __msgtype__: ClassVar[str]
    layout: MultiArrayLayout = ...
    data: _converted.Array[np.uint32] = ...
    def __init__(
        self,
        layout: MultiArrayLayout = ...,
        data: ArrayLike = ...,
    ) -> None: ...

@dataclass
class UInt64:
    __msgtype__: ClassVar[str]
    data: int = ...

@dataclass(init=False)
class UInt64MultiArray:
    __msgtype__: ClassVar[str]
    layout: MultiArrayLayout = ...
    data: _converted.Array[np.uint64] = ...
    def __init__(
        self,
        layout: MultiArrayLayout = ...,
        data: ArrayLike = ...,
    ) -> None: ...

@dataclass
class UInt8:
    __msgtype__: ClassVar[str]
    data: int = ...

@dataclass(init=False)
class UInt8MultiArray:
    __msgtype__: ClassVar[str]
    layout: MultiArrayLayout = ...
    data: _converted.Array[np.uint8] = ...
    def __init__(
        self,
        layout: MultiArrayLayout = ...,
        data: ArrayLike = ...,
    ) -> None: ...
