"""Message types of simulation_interfaces. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import ArrayLike

from cartwheel.msgs import (
    _converted,
    builtin_interfaces,
    geometry_msgs,
    std_msgs,
    unique_identifier_msgs,
)

@dataclass
class SimulateSteps_Feedback:
    __msgtype__: ClassVar[str]
    completed_steps: int = ...
    remaining_steps: int = ...

@dataclass
class SimulateSteps_FeedbackMessage:
    __msgtype__: ClassVar[str]
    goal_id: unique_identifier_msgs.UUID = ...
    feedback: SimulateSteps_Feedback = ...

@dataclass
class SimulateSteps_GetResult_Request:
    __msgtype__: ClassVar[str]
    goal_id: unique_identifier_msgs.UUID = ...

@dataclass
class SimulateSteps_GetResult_Response:
    __msgtype__: ClassVar[str]
    status: int = ...
    result: SimulateSteps_Result = ...

@dataclass
class SimulateSteps_Goal:
    __msgtype__: ClassVar[str]
    steps: int = ...

@dataclass
class SimulateSteps_Result:
    __msgtype__: ClassVar[str]
    result: Result = ...

@dataclass
class SimulateSteps_SendGoal_Request:
    __msgtype__: ClassVar[str]
    goal_id: unique_identifier_msgs.UUID = ...
    goal: SimulateSteps_Goal = ...

@dataclass(init=False)
class SimulateSteps_SendGoal_Response:
    __msgtype__: ClassVar[str]
    accepted: bool = ...
    stamp: _converted.Time[builtin_interfaces.Time] = ...
    def __init__(
        self,
        accepted: bool = ...,
        stamp: builtin_interfaces.Time | float = ...,
    ) -> None: ...

@dataclass(init=False)
class Bounds:
    __msgtype__: ClassVar[str]
    TYPE_EMPTY: ClassVar[int]
    TYPE_BOX: ClassVar[int]
    TYPE_CONVEX_HULL: ClassVar[int]
    TYPE_SPHERE: ClassVar[int]
    type: int = ...
    points: _converted.List[geometry_msgs.Vector3] = ...
    def __init__(
        self,
        type: int = ...,
        points: list[geometry_msgs.Vector3] | tuple[geometry_msgs.Vector3, ...] = ...,
    ) -> None: ...

@dataclass
class EntityCategory:
    __msgtype__: ClassVar[str]
    CATEGORY_OBJECT: ClassVar[int]
    CATEGORY_ROBOT: ClassVar[int]
    CATEGORY_HUMAN: ClassVar[int]
    CATEGORY_DYNAMIC_OBJECT: ClassVar[int]
    CATEGORY_STATIC_OBJECT: ClassVar[int]
    category: int = ...

@dataclass(init=False)
class EntityFilters:
    __msgtype__: ClassVar[str]
    filter: str = ...
    categories: _converted.List[EntityCategory] = ...
    tags: TagsFilter = ...
    bounds: Bounds = ...
    def __init__(
        self,
        filter: str = ...,
        categories: list[EntityCategory] | tuple[EntityCategory, ...] = ...,
        tags: TagsFilter = ...,
        bounds: Bounds = ...,
    ) -> None: ...

@dataclass(init=False)
class EntityInfo:
    __msgtype__: ClassVar[str]
    category: EntityCategory = ...
    description: str = ...
    tags: _converted.List[str] = ...
    def __init__(
        self,
        category: EntityCategory = ...,
        description: str = ...,
        tags: list[str] | tuple[str, ...] = ...,
    ) -> None: ...

@dataclass
class EntityState:
    __msgtype__: ClassVar[str]
    header: std_msgs.Header = ...
    pose: geometry_msgs.Pose = ...
    twist: geometry_msgs.Twist = ...
    acceleration: geometry_msgs.Accel = ...

@dataclass(init=False)
class NamedPose:
    __msgtype__: ClassVar[str]
    name: str = ...
    description: str = ...
    tags: _converted.List[str] = ...
    pose: geometry_msgs.Pose = ...
    def __init__(
        self,
        name: str = ...,
        description: str = ...,
        tags: list[str] | tuple[str, ...] = ...,
        pose: geometry_msgs.Pose = ...,
    ) -> None: ...

@dataclass
class Resource:
    __msgtype__: ClassVar[str]
    uri: str = ...
    resource_string: str = ...

@dataclass
class Result:
    __msgtype__: ClassVar[str]
    RESULT_FEATURE_UNSUPPORTED: ClassVar[int]
    RESULT_OK: ClassVar[int]
    RESULT_NOT_FOUND: ClassVar[int]
    RESULT_INCORRECT_STATE: ClassVar[int]
    RESULT_OPERATION_FAILED: ClassVar[int]
    result: int = ...
    error_message: str = ...

@dataclass
class SimulationState:
    __msgtype__: ClassVar[str]
    STATE_STOPPED: ClassVar[int]
    STATE_PLAYING: ClassVar[int]
    STATE_PAUSED: ClassVar[int]
    STATE_QUITTING: ClassVar[int]
    STATE_NO_WORLD: ClassVar[int]
    STATE_LOADING_WORLD: ClassVar[int]
    state: int = ...

@dataclass(init=False)
class SimulatorFeatures:
    __msgtype__: ClassVar[str]
    SPAWNING: ClassVar[int]
    DELETING: ClassVar[int]
    NAMED_POSES: ClassVar[int]
    POSE_BOUNDS: ClassVar[int]
    ENTITY_TAGS: ClassVar[int]
    ENTITY_BOUNDS: ClassVar[int]
    ENTITY_BOUNDS_BOX: ClassVar[int]
    ENTITY_BOUNDS_CONVEX: ClassVar[int]
    ENTITY_CATEGORIES: ClassVar[int]
    SPAWNING_RESOURCE_STRING: ClassVar[int]
    ENTITY_STATE_GETTING: ClassVar[int]
    ENTITY_STATE_SETTING: ClassVar[int]
    ENTITY_INFO_GETTING: ClassVar[int]
    ENTITY_INFO_SETTING: ClassVar[int]
    SPAWNABLES: ClassVar[int]
    SIMULATION_RESET: ClassVar[int]
    SIMULATION_RESET_TIME: ClassVar[int]
    SIMULATION_RESET_STATE: ClassVar[int]
    SIMULATION_RESET_SPAWNED: ClassVar[int]
    SIMULATION_STATE_GETTING: ClassVar[int]
    SIMULATION_STATE_SETTING: ClassVar[int]
    SIMULATION_STATE_PAUSE: ClassVar[int]
    STEP_SIMULATION_SINGLE: ClassVar[int]
    STEP_SIMULATION_MULTIPLE: ClassVar[int]
    STEP_SIMULATION_ACTION: ClassVar[int]
    WORLD_LOADING: ClassVar[int]
    WORLD_RESOURCE_STRING: ClassVar[int]
    WORLD_TAGS: ClassVar[int]
    WORLD_UNLOADING: ClassVar[int]
    WORLD_INFO_GETTING: ClassVar[int]
    AVAILABLE_WORLDS: ClassVar[int]
    SPAWNING_ENTITIES: ClassVar[int]
    features: _converted.Array[np.uint16] = ...
    spawn_formats: _converted.List[str] = ...
    custom_info: str = ...
    def __init__(
        self,
        features: ArrayLike = ...,
        spawn_formats: list[str] | tuple[str, ...] = ...,
        custom_info: str = ...,
    ) -> None: ...

@dataclass
class SpawnEntity:
    __msgtype__: ClassVar[str]
    name: str = ...
    allow_renaming: bool = ...
    entity_resource: Resource = ...
    entity_namespace: str = ...
    initial_pose: geometry_msgs.PoseStamped = ...

@dataclass
class SpawnResult:
    __msgtype__: ClassVar[str]
    NAME_NOT_UNIQUE: ClassVar[int]
    NAME_INVALID: ClassVar[int]
    UNSUPPORTED_FORMAT: ClassVar[int]
    NO_RESOURCE: ClassVar[int]
    NAMESPACE_INVALID: ClassVar[int]
    RESOURCE_PARSE_ERROR: ClassVar[int]
    MISSING_ASSETS: ClassVar[int]
    UNSUPPORTED_ASSETS: ClassVar[int]
    INVALID_POSE: ClassVar[int]
    result: Result = ...
    entity_name: str = ...

@dataclass
class Spawnable:
    __msgtype__: ClassVar[str]
    entity_resource: Resource = ...
    description: str = ...
    spawn_bounds: Bounds = ...

@dataclass(init=False)
class TagsFilter:
    __msgtype__: ClassVar[str]
    FILTER_MODE_ANY: ClassVar[int]
    FILTER_MODE_ALL: ClassVar[int]
    tags: _converted.List[str] = ...
    filter_mode: int = ...
    def __init__(
        self,
        tags: list[str] | tuple[str, ...] = ...,
        filter_mode: int = ...,
    ) -> None: ...

@dataclass(init=False)
class WorldResource:
    __msgtype__: ClassVar[str]
    name: str = ...
    world_resource: Resource = ...
    description: str = ...
    tags: _converted.List[str] = ...
    def __init__(
        self,
        name: str = ...,
        world_resource: Resource = ...,
        description: str = ...,
        tags: list[str] | tuple[str, ...] = ...,
    ) -> None: ...

@dataclass
class DeleteEntity_Request:
    __msgtype__: ClassVar[str]
    entity: str = ...

@dataclass
class DeleteEntity_Response:
    __msgtype__: ClassVar[str]
    result: Result = ...

@dataclass(init=False)
class GetAvailableWorlds_Request:
    __msgtype__: ClassVar[str]
    additional_sources: _converted.List[str] = ...
    filter: TagsFilter = ...
    offline_only: bool = ...
    continue_on_error: bool = ...
    def __init__(
        self,
        additional_sources: list[str] | tuple[str, ...] = ...,
        filter: TagsFilter = ...,
        offline_only: bool = ...,
        continue_on_error: bool = ...,
    ) -> None: ...

@dataclass(init=False)
class GetAvailableWorlds_Response:
    __msgtype__: ClassVar[str]
    DEFAULT_SOURCES_FAILED: ClassVar[int]
    result: Result = ...
    worlds: _converted.List[WorldResource] = ...
    def __init__(
        self,
        result: Result = ...,
        worlds: list[WorldResource] | tuple[WorldResource, ...] = ...,
    ) -> None: ...

@dataclass
class GetCurrentWorld_Request:
    __msgtype__: ClassVar[str]

@dataclass
class GetCurrentWorld_Response:
    __msgtype__: ClassVar[str]
    NO_WORLD_LOADED: ClassVar[int]
    result: Result = ...
    world: WorldResource = ...

@dataclass
class GetEntitiesStates_Request:
    __msgtype__: ClassVar[str]
    filters: EntityFilters = ...

@dataclass(init=False)
class GetEntitiesStates_Response:
    __msgtype__: ClassVar[str]
    result: Result = ...
    entities: _converted.List[str] = ...
    states: _converted.List[EntityState] = ...
    def __init__(
        self,
        result: Result = ...,
        entities: list[str] | tuple[str, ...] = ...,
        states: list[EntityState] | tuple[EntityState, ...] = ...,
    ) -> None: ...

@dataclass
class GetEntities_Request:
    __msgtype__: ClassVar[str]
    filters: EntityFilters = ...

@dataclass(init=False)
class GetEntities_Response:
    __msgtype__: ClassVar[str]
    result: Result = ...
    entities: _converted.List[str] = ...
    def __init__(
        self,
        result: Result = ...,
        entities: list[str] | tuple[str, ...] = ...,
    ) -> None: ...

@dataclass
class GetEntityBounds_Request:
    __msgtype__: ClassVar[str]
    entity: str = ...

@dataclass
class GetEntityBounds_Response:
    __msgtype__: ClassVar[str]
    result: Result = ...
    bounds: Bounds = ...

@dataclass
class GetEntityInfo_Request:
    __msgtype__: ClassVar[str]
    entity: str = ...

@dataclass
class GetEntityInfo_Response:
    __msgtype__: ClassVar[str]
    result: Result = ...
    info: EntityInfo = ...

@dataclass
class GetEntityState_Request:
    __msgtype__: ClassVar[str]
    entity: str = ...

@dataclass
class GetEntityState_Response:
    __msgtype__: ClassVar[str]
    result: Result = ...
    state: EntityState = ...

@dataclass
class GetNamedPoseBounds_Request:
    __msgtype__: ClassVar[str]
    name: str = ...

@dataclass
class GetNamedPoseBounds_Response:
    __msgtype__: ClassVar[str]
    result: Result = ...
    bounds: Bounds = ...

@dataclass
class GetNamedPoses_Request:
    __msgtype__: ClassVar[str]
    tags: TagsFilter = ...

@dataclass(init=False)
class GetNamedPoses_Response:
    __msgtype__: ClassVar[str]
    result: Result = ...
    poses: _converted.List[NamedPose] = ...
    def __init__(
        self,
        result: Result = ...,
        poses: list[NamedPose] | tuple[NamedPose, ...] = ...,
    ) -> None: ...

@dataclass
class GetSimulationState_Request:
    __msgtype__: ClassVar[str]

@dataclass
class GetSimulationState_Response:
    __msgtype__: ClassVar[str]
    state: SimulationState = ...
    result: Result = ...

@dataclass
class GetSimulatorFeatures_Request:
    __msgtype__: ClassVar[str]

@dataclass
class GetSimulatorFeatures_Response:
    __msgtype__: ClassVar[str]
    features: SimulatorFeatures = ...

@dataclass(init=False)
class GetSpawnables_Request:
    __msgtype__: ClassVar[str]
    sources: _converted.List[str] = ...
    def __init__(
        self,
        sources: list[str] | tuple[str, ...] = ...,
    ) -> None: ...

@dataclass(init=False)
class GetSpawnables_Response:
    __msgtype__: ClassVar[str]
    result: Result = ...
    spawnables: _converted.List[Spawnable] = ...
    def __init__(
        self,
        result: Result = ...,
        spawnables: list[Spawnable] | tuple[Spawnable, ...] = ...,
    ) -> None: ...

@dataclass
class LoadWorld_Request:
    __msgtype__: ClassVar[str]
    world_resource: Resource = ...
    fail_on_unsupported_element: bool = ...
    ignore_missing_or_unsupported_assets: bool = ...

@dataclass
class LoadWorld_Response:
    __msgtype__: ClassVar[str]
    UNSUPPORTED_FORMAT: ClassVar[int]
    NO_RESOURCE: ClassVar[int]
    RESOURCE_PARSE_ERROR: ClassVar[int]
    MISSING_ASSETS: ClassVar[int]
    UNSUPPORTED_ASSETS: ClassVar[int]
    UNSUPPORTED_ELEMENTS: ClassVar[int]
    result: Result = ...
    world: WorldResource = ...

@dataclass
class ResetSimulation_Request:
    __msgtype__: ClassVar[str]
    SCOPE_DEFAULT: ClassVar[int]
    SCOPE_TIME: ClassVar[int]
    SCOPE_STATE: ClassVar[int]
    SCOPE_SPAWNED: ClassVar[int]
    SCOPE_ALL: ClassVar[int]
    scope: int = ...

@dataclass
class ResetSimulation_Response:
    __msgtype__: ClassVar[str]
    result: Result = ...

@dataclass
class SetEntityInfo_Request:
    __msgtype__: ClassVar[str]
    entity: str = ...
    info: EntityInfo = ...

@dataclass
class SetEntityInfo_Response:
    __msgtype__: ClassVar[str]
    result: Result = ...

@dataclass
class SetEntityState_Request:
    __msgtype__: ClassVar[str]
    entity: str = ...
    state: EntityState = ...
    set_pose: bool = ...
    set_twist: bool = ...
    set_acceleration: bool = ...

@dataclass
class SetEntityState_Response:
    __msgtype__: ClassVar[str]
    INVALID_POSE: ClassVar[int]
    result: Result = ...

@dataclass
class SetSimulationState_Request:
    __msgtype__: ClassVar[str]
    state: SimulationState = ...

@dataclass
class SetSimulationState_Response:
    __msgtype__: ClassVar[str]
    ALREADY_IN_TARGET_STATE: ClassVar[int]
    STATE_TRANSITION_ERROR: ClassVar[int]
    INCORRECT_TRANSITION: ClassVar[int]
    result: Result = ...

@dataclass(init=False)
class SpawnEntities_Request:
    __msgtype__: ClassVar[str]
    spawn_requests: _converted.List[SpawnEntity] = ...
    def __init__(
        self,
        spawn_requests: list[SpawnEntity] | tuple[SpawnEntity, ...] = ...,
    ) -> None: ...

@dataclass(init=False)
class SpawnEntities_Response:
    __msgtype__: ClassVar[str]
    ENTITIES_SPAWN_FAILED: ClassVar[int]
    result: Result = ...
    results: _converted.List[SpawnResult] = ...
    def __init__(
        self,
        result: Result = ...,
        results: list[SpawnResult] | tuple[SpawnResult, ...] = ...,
    ) -> None: ...

@dataclass
class SpawnEntity_Request:
    __msgtype__: ClassVar[str]
    name: str = ...
    allow_renaming: bool = ...
    entity_resource: Resource = ...
    entity_namespace: str = ...
    initial_pose: geometry_msgs.PoseStamped = ...

@dataclass
class SpawnEntity_Response:
    __msgtype__: ClassVar[str]
    NAME_NOT_UNIQUE: ClassVar[int]
    NAME_INVALID: ClassVar[int]
    UNSUPPORTED_FORMAT: ClassVar[int]
    NO_RESOURCE: ClassVar[int]
    NAMESPACE_INVALID: ClassVar[int]
    RESOURCE_PARSE_ERROR: ClassVar[int]
    MISSING_ASSETS: ClassVar[int]
    UNSUPPORTED_ASSETS: ClassVar[int]
    INVALID_POSE: ClassVar[int]
    result: Result = ...
    entity_name: str = ...

@dataclass
class StepSimulation_Request:
    __msgtype__: ClassVar[str]
    steps: int = ...

@dataclass
class StepSimulation_Response:
    __msgtype__: ClassVar[str]
    result: Result = ...

@dataclass
class UnloadWorld_Request:
    __msgtype__: ClassVar[str]

@dataclass
class UnloadWorld_Response:
    __msgtype__: ClassVar[str]
    NO_WORLD_LOADED: ClassVar[int]
    result: Result = ...
