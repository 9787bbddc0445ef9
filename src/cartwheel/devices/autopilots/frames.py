"""Rotations between the axes of ROS and those of flight controllers."""

from __future__ import annotations

import math

from cartwheel.geometry import Quat

TO_NORTH_EAST_DOWN: Quat = (math.sqrt(0.5), math.sqrt(0.5), 0.0, 0.0)
"""Rotates east, north, up to north, east, down. It is its own inverse."""
TO_FORWARD_RIGHT_DOWN: Quat = (1.0, 0.0, 0.0, 0.0)
"""Rotates forward, left, up to forward, right, down. It is its own inverse."""
