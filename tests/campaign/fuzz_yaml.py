"""YAML files: controllers of ROS 1 and ROS 2, bridges of topics."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from tests.campaign import mutating
from tests.campaign.target import Target

from cartwheel.errors import CartwheelError

_ROOT = Path(__file__).parents[2]
_ROS1 = b"""cart:
  joint_state_controller:
    type: joint_state_controller/JointStateController
    publish_rate: 50
  drive:
    type: "diff_drive_controller/DiffDriveController"
    left_wheel: ['left_wheel', $(arg prefix)left]
    right_wheel: right_wheel
    pose_covariance_diagonal: [0.001, 0.001, 0.001, 0.001, 0.001, 0.03]
    linear: {x: {has_velocity_limits: true, max_velocity: 1.0e+0, min_velocity: -0.5}}
  gazebo_ros_control/pid_gains:
    left_wheel: {p: 10.0, i: 0.1, d: 1}
  arm: &arm
    type: effort_controllers/JointTrajectoryController
    joints: [shoulder, elbow]
    gains: {shoulder: {p: 100, d: 1, i: 1, i_clamp: 1}}
  hand:
    <<: *arm
    joints: [finger]
"""
_ROS2 = b"""/ns:
  controller_manager:
    ros__parameters:
      update_rate: 100  # Hz
      drive:
        type: diff_drive_controller/DiffDriveController
/**/drive:
  ros__parameters:
    left_wheel_names: ["left"]
    right_wheel_names: ["right"]
    wheel_separation: .4
    use_stamped_vel: !!bool "false"
"""
_BOMB = b"a: &a [x, x]\nb: &b [*a, *a]\nc: &c [*b, *b]\nd: &d {*c : *c, e: !!int '5'}\n"
_TAGS = b"a: !degrees 5\nb: !!python/object/apply:os.getcwd []\nc: 2001-01-01\n<<: {d: 1}\n"
_BRIDGE = b"""- ros_topic_name: "/scan"
  gz_topic_name: "/lidar"
  ros_type_name: "sensor_msgs/msg/LaserScan"
  gz_type_name: "gz.msgs.LaserScan"
  direction: GZ_TO_ROS
"""


def _files() -> list[bytes]:
    folders = [_ROOT / "robots"]
    if "CAMPAIGN_CORPUS" in os.environ:
        folders.append(Path(os.environ["CAMPAIGN_CORPUS"]))
    return [path.read_bytes() for folder in folders for path in sorted(folder.rglob("*.yaml"))]


def _reader(read: Callable[[Path], object]) -> Callable[[bytes], None]:
    path = Path("fuzz.yaml")

    def run_one(data: bytes) -> None:
        path.write_bytes(data)
        read(path.resolve())

    return run_one


def _controllers(path: Path) -> None:
    from cartwheel.dialects.ros_control.files import (
        controller_entries,
        is_ros2,
        read_parameters,
        ros2_file,
    )
    from cartwheel.dialects.ros_control.launched.names import ros1_entries
    from cartwheel.dialects.ros_control.substitution import substitute

    content = substitute(read_parameters(path), path, {"name": "x", "prefix": ""})
    if is_ros2(content):
        controller_entries(ros2_file([content], "/ns"), "/ns", str(path))
    else:
        ros1_entries(content, str(path))


def _bridge(path: Path) -> None:
    from cartwheel.dialects.gz.bridge_file import read_bridge

    read_bridge(path)


TARGETS = (
    Target(
        name="controllers",
        seeds=lambda: [*_files(), _ROS1, _ROS2, _BOMB, _TAGS],
        run_one=_reader(_controllers),
        allowed=(CartwheelError,),
        mutate=mutating.text,
    ),
    Target(
        name="gz-bridge",
        seeds=lambda: [_BRIDGE, *(data for data in _files() if b"ros_topic" in data)],
        run_one=_reader(_bridge),
        allowed=(CartwheelError,),
        mutate=mutating.text,
        share=0.5,
    ),
)
