"""A depth camera above the ground, and the ground's depths."""

import math

import numpy as np
from tests.devices.cameras.sensors import (
    rays,
    sensor,
)

KINECT, DEPTH = "libgazebo_ros_openni_kinect.so", "libgazebo_ros_depth_camera.so"


def kinect(plugin="<cameraName>k</cameraName>", filename=KINECT, **more):
    return sensor(kind="depth", filename=filename, plugin=plugin, **more)


def far_below(high, *, tilt=0.0, fov=1.04, width=320, height=240):
    """Depth of the ground under an eye at `high` that looks down by `tilt`; inf above it."""
    _, down = rays(width, height, fov)
    sink = math.sin(tilt) + down * math.cos(tilt)
    with np.errstate(divide="ignore"):
        return np.where(sink > 0, high / sink, np.inf)
