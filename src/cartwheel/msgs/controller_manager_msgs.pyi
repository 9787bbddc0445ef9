"""Message types of controller_manager_msgs. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.msgs import _converted, builtin_interfaces, std_msgs

@dataclass(init=False)
class ControllerState:
    __msgtype__: ClassVar[str]
    name: str = ...
    state: str = ...
    type: str = ...
    claimed_resources: _converted.List[HardwareInterfaceResources] = ...
    def __init__(
        self,
        name: str = ...,
        state: str = ...,
        type: str = ...,
        claimed_resources: list[HardwareInterfaceResources]
        | tuple[HardwareInterfaceResources, ...] = ...,
    ) -> None: ...

@dataclass(init=False)
class ControllerStatistics:
    __msgtype__: ClassVar[str]
    name: str = ...
    type: str = ...
    timestamp: _converted.Time[builtin_interfaces.Time] = ...
    running: bool = ...
    max_time: _converted.Time[builtin_interfaces.Duration] = ...
    mean_time: _converted.Time[builtin_interfaces.Duration] = ...
    variance_time: _converted.Time[builtin_interfaces.Duration] = ...
    num_control_loop_overruns: int = ...
    time_last_control_loop_overrun: _converted.Time[builtin_interfaces.Time] = ...
    def __init__(
        self,
        name: str = ...,
        type: str = ...,
        timestamp: builtin_interfaces.Time | float = ...,
        running: bool = ...,
        max_time: builtin_interfaces.Duration | float = ...,
        mean_time: builtin_interfaces.Duration | float = ...,
        variance_time: builtin_interfaces.Duration | float = ...,
        num_control_loop_overruns: int = ...,
        time_last_control_loop_overrun: builtin_interfaces.Time | float = ...,
    ) -> None: ...

@dataclass(init=False)
class ControllersStatistics:
    __msgtype__: ClassVar[str]
    header: std_msgs.Header = ...
    controller: _converted.List[ControllerStatistics] = ...
    def __init__(
        self,
        header: std_msgs.Header = ...,
        controller: list[ControllerStatistics] | tuple[ControllerStatistics, ...] = ...,
    ) -> None: ...

@dataclass(init=False)
class HardwareInterfaceResources:
    __msgtype__: ClassVar[str]
    hardware_interface: str = ...
    resources: _converted.List[str] = ...
    def __init__(
        self,
        hardware_interface: str = ...,
        resources: list[str] | tuple[str, ...] = ...,
    ) -> None: ...

@dataclass
class ListControllerTypes_Request:
    __msgtype__: ClassVar[str]

@dataclass(init=False)
class ListControllerTypes_Response:
    __msgtype__: ClassVar[str]
    types: _converted.List[str] = ...
    base_classes: _converted.List[str] = ...
    def __init__(
        self,
        types: list[str] | tuple[str, ...] = ...,
        base_classes: list[str] | tuple[str, ...] = ...,
    ) -> None: ...

@dataclass
class ListControllers_Request:
    __msgtype__: ClassVar[str]

@dataclass(init=False)
class ListControllers_Response:
    __msgtype__: ClassVar[str]
    controller: _converted.List[ControllerState] = ...
    def __init__(
        self,
        controller: list[ControllerState] | tuple[ControllerState, ...] = ...,
    ) -> None: ...

@dataclass
class LoadController_Request:
    __msgtype__: ClassVar[str]
    name: str = ...

@dataclass
class LoadController_Response:
    __msgtype__: ClassVar[str]
    ok: bool = ...

@dataclass
class ReloadControllerLibraries_Request:
    __msgtype__: ClassVar[str]
    force_kill: bool = ...

@dataclass
class ReloadControllerLibraries_Response:
    __msgtype__: ClassVar[str]
    ok: bool = ...

@dataclass(init=False)
class SwitchController_Request:
    __msgtype__: ClassVar[str]
    BEST_EFFORT: ClassVar[int]
    STRICT: ClassVar[int]
    start_controllers: _converted.List[str] = ...
    stop_controllers: _converted.List[str] = ...
    strictness: int = ...
    start_asap: bool = ...
    timeout: float = ...
    def __init__(
        self,
        start_controllers: list[str] | tuple[str, ...] = ...,
        stop_controllers: list[str] | tuple[str, ...] = ...,
        strictness: int = ...,
        start_asap: bool = ...,
        timeout: float = ...,
    ) -> None: ...

@dataclass
class SwitchController_Response:
    __msgtype__: ClassVar[str]
    ok: bool = ...

@dataclass
class UnloadController_Request:
    __msgtype__: ClassVar[str]
    name: str = ...

@dataclass
class UnloadController_Response:
    __msgtype__: ClassVar[str]
    ok: bool = ...
