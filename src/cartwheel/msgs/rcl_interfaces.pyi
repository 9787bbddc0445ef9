"""Message types of rcl_interfaces. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from cartwheel.msgs import _converted, builtin_interfaces

@dataclass
class FloatingPointRange:
    __msgtype__: ClassVar[str]
    from_value: float = ...
    to_value: float = ...
    step: float = ...

@dataclass
class IntegerRange:
    __msgtype__: ClassVar[str]
    from_value: int = ...
    to_value: int = ...
    step: int = ...

@dataclass(init=False)
class ListParametersResult:
    __msgtype__: ClassVar[str]
    names: _converted.List[str] = ...
    prefixes: _converted.List[str] = ...
    def __init__(
        self,
        names: list[str] | tuple[str, ...] = ...,
        prefixes: list[str] | tuple[str, ...] = ...,
    ) -> None: ...

@dataclass(init=False)
class Log:
    __msgtype__: ClassVar[str]
    DEBUG: ClassVar[int]
    INFO: ClassVar[int]
    WARN: ClassVar[int]
    ERROR: ClassVar[int]
    FATAL: ClassVar[int]
    stamp: _converted.Time[builtin_interfaces.Time] = ...
    level: int = ...
    name: str = ...
    msg: str = ...
    file: str = ...
    function: str = ...
    line: int = ...
    def __init__(
        self,
        stamp: builtin_interfaces.Time | float = ...,
        level: int = ...,
        name: str = ...,
        msg: str = ...,
        file: str = ...,
        function: str = ...,
        line: int = ...,
    ) -> None: ...

@dataclass
class LoggerLevel:
    __msgtype__: ClassVar[str]
    LOG_LEVEL_UNKNOWN: ClassVar[int]
    LOG_LEVEL_DEBUG: ClassVar[int]
    LOG_LEVEL_INFO: ClassVar[int]
    LOG_LEVEL_WARN: ClassVar[int]
    LOG_LEVEL_ERROR: ClassVar[int]
    LOG_LEVEL_FATAL: ClassVar[int]
    name: str = ...
    level: int = ...

@dataclass
class Parameter:
    __msgtype__: ClassVar[str]
    name: str = ...
    value: ParameterValue = ...

@dataclass(init=False)
class ParameterDescriptor:
    __msgtype__: ClassVar[str]
    name: str = ...
    type: int = ...
    description: str = ...
    additional_constraints: str = ...
    read_only: bool = ...
    dynamic_typing: bool = ...
    floating_point_range: _converted.List[FloatingPointRange] = ...
    integer_range: _converted.List[IntegerRange] = ...
    def __init__(
        self,
        name: str = ...,
        type: int = ...,
        description: str = ...,
        additional_constraints: str = ...,
        read_only: bool = ...,
        dynamic_typing: bool = ...,
        floating_point_range: list[FloatingPointRange] | tuple[FloatingPointRange, ...] = ...,
        integer_range: list[IntegerRange] | tuple[IntegerRange, ...] = ...,
    ) -> None: ...

@dataclass(init=False)
class ParameterEvent:
    __msgtype__: ClassVar[str]
    stamp: _converted.Time[builtin_interfaces.Time] = ...
    node: str = ...
    new_parameters: _converted.List[Parameter] = ...
    changed_parameters: _converted.List[Parameter] = ...
    deleted_parameters: _converted.List[Parameter] = ...
    def __init__(
        self,
        stamp: builtin_interfaces.Time | float = ...,
        node: str = ...,
        new_parameters: list[Parameter] | tuple[Parameter, ...] = ...,
        changed_parameters: list[Parameter] | tuple[Parameter, ...] = ...,
        deleted_parameters: list[Parameter] | tuple[Parameter, ...] = ...,
    ) -> None: ...

@dataclass(init=False)
class ParameterEventDescriptors:
    __msgtype__: ClassVar[str]
    new_parameters: _converted.List[ParameterDescriptor] = ...
    changed_parameters: _converted.List[ParameterDescriptor] = ...
    deleted_parameters: _converted.List[ParameterDescriptor] = ...
    def __init__(
        self,
        new_parameters: list[ParameterDescriptor] | tuple[ParameterDescriptor, ...] = ...,
        changed_parameters: list[ParameterDescriptor] | tuple[ParameterDescriptor, ...] = ...,
        deleted_parameters: list[ParameterDescriptor] | tuple[ParameterDescriptor, ...] = ...,
    ) -> None: ...

@dataclass
class ParameterType:
    __msgtype__: ClassVar[str]
    PARAMETER_NOT_SET: ClassVar[int]
    PARAMETER_BOOL: ClassVar[int]
    PARAMETER_INTEGER: ClassVar[int]
    PARAMETER_DOUBLE: ClassVar[int]
    PARAMETER_STRING: ClassVar[int]
    PARAMETER_BYTE_ARRAY: ClassVar[int]
    PARAMETER_BOOL_ARRAY: ClassVar[int]
    PARAMETER_INTEGER_ARRAY: ClassVar[int]
    PARAMETER_DOUBLE_ARRAY: ClassVar[int]
    PARAMETER_STRING_ARRAY: ClassVar[int]

@dataclass(init=False)
class ParameterValue:
    __msgtype__: ClassVar[str]
    type: int = ...
    bool_value: bool = ...
    integer_value: int = ...
    double_value: float = ...
    string_value: str = ...
    byte_array_value: _converted.Array[np.uint8] = ...
    bool_array_value: _converted.Array[np.bool_] = ...
    integer_array_value: _converted.Array[np.int64] = ...
    double_array_value: _converted.Array[np.float64] = ...
    string_array_value: _converted.List[str] = ...
    def __init__(
        self,
        type: int = ...,
        bool_value: bool = ...,
        integer_value: int = ...,
        double_value: float = ...,
        string_value: str = ...,
        byte_array_value: ArrayLike = ...,
        bool_array_value: ArrayLike = ...,
        integer_array_value: ArrayLike = ...,
        double_array_value: ArrayLike = ...,
        string_array_value: list[str] | tuple[str, ...] = ...,
    ) -> None: ...

@dataclass
class SetLoggerLevelsResult:
    __msgtype__: ClassVar[str]
    successful: bool = ...
    reason: str = ...

@dataclass
class SetParametersResult:
    __msgtype__: ClassVar[str]
    successful: bool = ...
    reason: str = ...

@dataclass(init=False)
class DescribeParameters_Request:
    __msgtype__: ClassVar[str]
    names: _converted.List[str] = ...
    def __init__(
        self,
        names: list[str] | tuple[str, ...] = ...,
    ) -> None: ...

@dataclass(init=False)
class DescribeParameters_Response:
    __msgtype__: ClassVar[str]
    descriptors: _converted.List[ParameterDescriptor] = ...
    def __init__(
        self,
        descriptors: list[ParameterDescriptor] | tuple[ParameterDescriptor, ...] = ...,
    ) -> None: ...

@dataclass(init=False)
class GetParameterTypes_Request:
    __msgtype__: ClassVar[str]
    names: _converted.List[str] = ...
    def __init__(
        self,
        names: list[str] | tuple[str, ...] = ...,
    ) -> None: ...

@dataclass(init=False)
class GetParameterTypes_Response:
    __msgtype__: ClassVar[str]
    types: _converted.Array[np.uint8] = ...
    def __init__(
        self,
        types: ArrayLike = ...,
    ) -> None: ...

@dataclass(init=False)
class GetParameters_Request:
    __msgtype__: ClassVar[str]
    names: _converted.List[str] = ...
    def __init__(
        self,
        names: list[str] | tuple[str, ...] = ...,
    ) -> None: ...

@dataclass(init=False)
class GetParameters_Response:
    __msgtype__: ClassVar[str]
    values: _converted.List[ParameterValue] = ...
    def __init__(
        self,
        values: list[ParameterValue] | tuple[ParameterValue, ...] = ...,
    ) -> None: ...

@dataclass(init=False)
class ListParameters_Request:
    __msgtype__: ClassVar[str]
    DEPTH_RECURSIVE: ClassVar[int]
    prefixes: _converted.List[str] = ...
    depth: int = ...
    def __init__(
        self,
        prefixes: list[str] | tuple[str, ...] = ...,
        depth: int = ...,
    ) -> None: ...

@dataclass
class ListParameters_Response:
    __msgtype__: ClassVar[str]
    result: ListParametersResult = ...

@dataclass(init=False)
class SetParametersAtomically_Request:
    __msgtype__: ClassVar[str]
    parameters: _converted.List[Parameter] = ...
    def __init__(
        self,
        parameters: list[Parameter] | tuple[Parameter, ...] = ...,
    ) -> None: ...

@dataclass
class SetParametersAtomically_Response:
    __msgtype__: ClassVar[str]
    result: SetParametersResult = ...

@dataclass(init=False)
class SetParameters_Request:
    __msgtype__: ClassVar[str]
    parameters: _converted.List[Parameter] = ...
    def __init__(
        self,
        parameters: list[Parameter] | tuple[Parameter, ...] = ...,
    ) -> None: ...

@dataclass(init=False)
class SetParameters_Response:
    __msgtype__: ClassVar[str]
    results: _converted.List[SetParametersResult] = ...
    def __init__(
        self,
        results: list[SetParametersResult] | tuple[SetParametersResult, ...] = ...,
    ) -> None: ...
