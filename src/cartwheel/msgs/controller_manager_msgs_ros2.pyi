"""Message types of controller_manager_msgs_ros2. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.msgs import _converted, builtin_interfaces, lifecycle_msgs

@dataclass(init=False)
class ChainConnection:
    __msgtype__: ClassVar[str]
    name: str = ...
    reference_interfaces: _converted.List[str] = ...
    def __init__(
        self,
        name: str = ...,
        reference_interfaces: list[str] | tuple[str, ...] = ...,
    ) -> None: ...

@dataclass(init=False)
class ControllerState:
    __msgtype__: ClassVar[str]
    name: str = ...
    state: str = ...
    type: str = ...
    is_async: bool = ...
    update_rate: int = ...
    claimed_interfaces: _converted.List[str] = ...
    required_command_interfaces: _converted.List[str] = ...
    required_state_interfaces: _converted.List[str] = ...
    is_chainable: bool = ...
    is_chained: bool = ...
    exported_state_interfaces: _converted.List[str] = ...
    reference_interfaces: _converted.List[str] = ...
    chain_connections: _converted.List[ChainConnection] = ...
    def __init__(
        self,
        name: str = ...,
        state: str = ...,
        type: str = ...,
        is_async: bool = ...,
        update_rate: int = ...,
        claimed_interfaces: list[str] | tuple[str, ...] = ...,
        required_command_interfaces: list[str] | tuple[str, ...] = ...,
        required_state_interfaces: list[str] | tuple[str, ...] = ...,
        is_chainable: bool = ...,
        is_chained: bool = ...,
        exported_state_interfaces: list[str] | tuple[str, ...] = ...,
        reference_interfaces: list[str] | tuple[str, ...] = ...,
        chain_connections: list[ChainConnection] | tuple[ChainConnection, ...] = ...,
    ) -> None: ...

@dataclass(init=False)
class HardwareComponentState:
    __msgtype__: ClassVar[str]
    name: str = ...
    type: str = ...
    is_async: bool = ...
    rw_rate: int = ...
    class_type: str = ...
    plugin_name: str = ...
    state: lifecycle_msgs.State = ...
    command_interfaces: _converted.List[HardwareInterface] = ...
    state_interfaces: _converted.List[HardwareInterface] = ...
    def __init__(
        self,
        name: str = ...,
        type: str = ...,
        is_async: bool = ...,
        rw_rate: int = ...,
        class_type: str = ...,
        plugin_name: str = ...,
        state: lifecycle_msgs.State = ...,
        command_interfaces: list[HardwareInterface] | tuple[HardwareInterface, ...] = ...,
        state_interfaces: list[HardwareInterface] | tuple[HardwareInterface, ...] = ...,
    ) -> None: ...

@dataclass
class HardwareInterface:
    __msgtype__: ClassVar[str]
    name: str = ...
    data_type: str = ...
    is_available: bool = ...
    is_claimed: bool = ...

@dataclass
class CleanupController_Request:
    __msgtype__: ClassVar[str]
    name: str = ...

@dataclass
class CleanupController_Response:
    __msgtype__: ClassVar[str]
    ok: bool = ...

@dataclass
class ConfigureController_Request:
    __msgtype__: ClassVar[str]
    name: str = ...

@dataclass
class ConfigureController_Response:
    __msgtype__: ClassVar[str]
    ok: bool = ...

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
class ListHardwareComponents_Request:
    __msgtype__: ClassVar[str]

@dataclass(init=False)
class ListHardwareComponents_Response:
    __msgtype__: ClassVar[str]
    component: _converted.List[HardwareComponentState] = ...
    def __init__(
        self,
        component: list[HardwareComponentState] | tuple[HardwareComponentState, ...] = ...,
    ) -> None: ...

@dataclass
class ListHardwareInterfaces_Request:
    __msgtype__: ClassVar[str]

@dataclass(init=False)
class ListHardwareInterfaces_Response:
    __msgtype__: ClassVar[str]
    command_interfaces: _converted.List[HardwareInterface] = ...
    state_interfaces: _converted.List[HardwareInterface] = ...
    def __init__(
        self,
        command_interfaces: list[HardwareInterface] | tuple[HardwareInterface, ...] = ...,
        state_interfaces: list[HardwareInterface] | tuple[HardwareInterface, ...] = ...,
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

@dataclass
class SetHardwareComponentState_Request:
    __msgtype__: ClassVar[str]
    name: str = ...
    target_state: lifecycle_msgs.State = ...

@dataclass
class SetHardwareComponentState_Response:
    __msgtype__: ClassVar[str]
    ok: bool = ...
    state: lifecycle_msgs.State = ...

@dataclass(init=False)
class SwitchController_Request:
    __msgtype__: ClassVar[str]
    BEST_EFFORT: ClassVar[int]
    STRICT: ClassVar[int]
    AUTO: ClassVar[int]
    FORCE_AUTO: ClassVar[int]
    activate_controllers: _converted.List[str] = ...
    deactivate_controllers: _converted.List[str] = ...
    strictness: int = ...
    activate_asap: bool = ...
    timeout: _converted.Time[builtin_interfaces.Duration] = ...
    def __init__(
        self,
        activate_controllers: list[str] | tuple[str, ...] = ...,
        deactivate_controllers: list[str] | tuple[str, ...] = ...,
        strictness: int = ...,
        activate_asap: bool = ...,
        timeout: builtin_interfaces.Duration | float = ...,
    ) -> None: ...

@dataclass
class SwitchController_Response:
    __msgtype__: ClassVar[str]
    ok: bool = ...
    message: str = ...

@dataclass
class UnloadController_Request:
    __msgtype__: ClassVar[str]
    name: str = ...

@dataclass
class UnloadController_Response:
    __msgtype__: ClassVar[str]
    ok: bool = ...
