"""Packages with message types, as users write them."""

from collections.abc import Mapping
from pathlib import Path

ROS1 = "<buildtool_depend>catkin</buildtool_depend><build_depend>message_generation</build_depend>"
ROS2 = (
    "<buildtool_depend>ament_cmake</buildtool_depend>"
    "<build_depend>rosidl_default_generators</build_depend>"
)
NEITHER = ""

WHEEL = """\
# A wheel.
uint8 LEFT=0
uint8 RIGHT=1   # the right side
string UNIT=newton
uint8 side
float64 load    # N
"""
WHEEL_LOADS = """\
std_msgs/Header header
geometry_msgs/Pose pose
Wheel[] wheels
float32[4] tyres
"""
CALIBRATE = """\
Wheel wheel
float64 offset
---
bool success
string message
"""
DOCK = """\
Wheel target
---
bool docked
---
float32 distance
"""
MY_MSGS = {
    "msg/Wheel.msg": WHEEL,
    "msg/WheelLoads.msg": WHEEL_LOADS,
    "srv/Calibrate.srv": CALIBRATE,
    "action/Dock.action": DOCK,
}


def write_package(
    folder: Path, files: Mapping[str, str | bytes], *, name: str = "", manifest: str = ROS2
) -> Path:
    """Writes a package and returns its folder."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "package.xml").write_text(
        f"<package><name>{name or folder.name}</name>{manifest}</package>"
    )
    for path, content in files.items():
        file = folder / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(content.encode() if isinstance(content, str) else content)
    return folder
