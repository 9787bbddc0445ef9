"""Images, depths, scans and point clouds of ROS messages as numpy arrays.

Arrays are read-only views of the message's data where the layout allows it, and copies otherwise.
"""

from cartwheel.arrays.fields import reader, single, values
from cartwheel.arrays.images import camera_matrix, depth, image
from cartwheel.arrays.messages import array
from cartwheel.arrays.points import Scan, cloud, scan
from cartwheel.arrays.projection import project, unproject

__all__ = [
    "Scan",
    "array",
    "camera_matrix",
    "cloud",
    "depth",
    "image",
    "project",
    "reader",
    "scan",
    "single",
    "unproject",
    "values",
]
