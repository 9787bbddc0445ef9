"""QoS of topics and services, and its formats in DDS and Zenoh."""

from __future__ import annotations

import math
from dataclasses import dataclass

from cartwheel.graph import Qos
from rtps_lite.discovery import EndpointQos


@dataclass(frozen=True, kw_only=True, slots=True)
class Profile:
    """ROS 2 QoS settings that differ between topics."""

    reliable: bool = True
    transient_local: bool = False
    depth: int = 10
    lifespan: int = 0
    """Time in s after which a message expires; 0 means never."""

    @property
    def dds(self) -> EndpointQos:
        """The profile as DDS policies."""
        return EndpointQos(
            reliable=self.reliable,
            transient_local=self.transient_local,
            depth=self.depth,
            lifespan=self.lifespan or math.inf,
        )

    @property
    def zenoh(self) -> str:
        """The profile in a liveliness token, which omits default values. Source: rmw_zenoh."""
        reliability = "" if self.reliable else "2"
        durability = "1" if self.transient_local else ""
        lifespan = f"{self.lifespan},0" if self.lifespan else ","
        return f"{reliability}:{durability}:,{self.depth}:,:{lifespan}:,,"


LATCHED = Profile(transient_local=True, depth=1)
SENSOR = Profile(reliable=False, depth=5)
DEFAULT = Profile()
CALLS, PARAMETER_CALLS = 10, 1000
"""Queue depths of services, and of parameter services. Source: rmw's qos_profiles.h."""
_BY_TOPIC = {
    "/tf": Profile(depth=100),
    "/tf_static": LATCHED,
    "/robot_description": LATCHED,
    "/rosout": Profile(transient_local=True, depth=1000, lifespan=10),
    "/parameter_events": Profile(depth=1000),
}


def profile_of(topic: str, qos: Qos) -> Profile:
    """QoS of a topic in the graph.

    Source: rmw's ``qos_profile_sensor_data``, tf2_ros, robot_state_publisher, rcl's rosout.
    """
    return _BY_TOPIC.get(topic) or {"latched": LATCHED, "sensor": SENSOR, "default": DEFAULT}[qos]
