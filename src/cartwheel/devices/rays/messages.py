"""ROS messages of scans."""

from __future__ import annotations

from typing import Any

import numpy as np

from cartwheel.devices.rays.scan import Scan, ScanPattern
from cartwheel.messages import message_class


def laser_scan(moment: Any, pattern: ScanPattern, scan: Scan, *, floor: float = 0.0) -> Any:
    """Returns a LaserScan of the middle row.

    Args:
        moment: The header.
        pattern: Pattern of the scan.
        scan: The measurement.
        floor: Intensities below this value are raised to it.
    """
    sweep = pattern.horizontal
    row = pattern.vertical.count // 2
    return message_class("sensor_msgs/msg/LaserScan")(
        header=moment,
        angle_min=sweep.first,
        angle_max=sweep.last,
        angle_increment=sweep.step,
        range_min=pattern.minimum,
        range_max=pattern.maximum,
        ranges=scan.ranges[row].astype(np.float32),
        intensities=np.maximum(scan.intensities[row], floor).astype(np.float32),
    )


def range_message(
    moment: Any, pattern: ScanPattern, value: float, *, fov: float, infrared: bool
) -> Any:
    """Returns a Range message.

    Args:
        moment: The header.
        pattern: Pattern of the scan, which provides the range limits.
        value: Range, m.
        fov: Field of view, rad.
        infrared: Set the radiation type to infrared instead of ultrasound.
    """
    kind = message_class("sensor_msgs/msg/Range")
    return kind(
        header=moment,
        radiation_type=kind.INFRARED if infrared else kind.ULTRASOUND,
        field_of_view=fov,
        min_range=pattern.minimum,
        max_range=pattern.maximum,
        range=value,
    )
