"""Default values that the definitions of built-in message types state.

rosbags ignores default values when it reads a definition. ROS 1 has none: there, omitted fields are
always zero or empty. Types from packages keep the defaults of their own definitions.

Sources: the `.msg` and `.srv` files of ROS 2 Jazzy (common_interfaces, rcl_interfaces), and
Cartwheel's own definitions. Defaults that are zero, false or empty are omitted.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

STATED: Mapping[str, Mapping[str, Any]] = {
    "geometry_msgs/msg/Quaternion": {"w": 1.0},
    "sensor_msgs/msg/NavSatStatus": {"status": -2},
    "ros_gz_interfaces/msg/EntityFactory": {"relative_to": "world"},
    "simulation_interfaces/srv/StepSimulation_Request": {"steps": 1},
    "type_description_interfaces/srv/GetTypeDescription_Request": {"include_type_sources": True},
}
"""Values by type and field."""
