"""Message types of statistics_msgs. Written by `make catalogue`; do not edit."""

from dataclasses import dataclass
from typing import ClassVar

from cartwheel.msgs import _converted, builtin_interfaces

@dataclass(init=False)
class MetricsMessage:
    __msgtype__: ClassVar[str]
    measurement_source_name: str = ...
    metrics_source: str = ...
    unit: str = ...
    window_start: _converted.Time[builtin_interfaces.Time] = ...
    window_stop: _converted.Time[builtin_interfaces.Time] = ...
    statistics: _converted.List[StatisticDataPoint] = ...
    def __init__(
        self,
        measurement_source_name: str = ...,
        metrics_source: str = ...,
        unit: str = ...,
        window_start: builtin_interfaces.Time | float = ...,
        window_stop: builtin_interfaces.Time | float = ...,
        statistics: list[StatisticDataPoint] | tuple[StatisticDataPoint, ...] = ...,
    ) -> None: ...

@dataclass
class StatisticDataPoint:
    __msgtype__: ClassVar[str]
    data_type: int = ...
    data: float = ...

@dataclass
class StatisticDataType:
    __msgtype__: ClassVar[str]
    STATISTICS_DATA_TYPE_UNINITIALIZED: ClassVar[int]
    STATISTICS_DATA_TYPE_AVERAGE: ClassVar[int]
    STATISTICS_DATA_TYPE_MINIMUM: ClassVar[int]
    STATISTICS_DATA_TYPE_MAXIMUM: ClassVar[int]
    STATISTICS_DATA_TYPE_STDDEV: ClassVar[int]
    STATISTICS_DATA_TYPE_SAMPLE_COUNT: ClassVar[int]
