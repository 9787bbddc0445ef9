"""rosbots_description in ROS 2: launch files run with stand-ins for ROS's own packages."""

from __future__ import annotations

import json
import runpy
import sys
import types
from pathlib import Path
from typing import Any

import pytest
import yaml

from cartwheel.description import load_text

PACKAGE = Path(__file__).parents[2] / "robots" / "rosbots_description"


class Part:
    """Whatever ROS's launch offers: keeps what it was given, and resolves paths and commands."""

    def __init__(self, *given: Any, **named: Any) -> None:
        self.given, self.named = given, named

    def perform(self, context: dict[str, str]) -> str:
        return resolved(self, context)


def resolved(part: Any, context: dict[str, str]) -> str:
    if isinstance(part, str):
        return part
    kind = type(part).__name__
    if kind == "FindPackageShare":
        assert part.given == ("rosbots_description",)
        return str(PACKAGE)
    if kind == "PathJoinSubstitution":
        return "/".join(resolved(each, context) for each in part.given[0])
    if kind == "LaunchConfiguration":
        return context[part.given[0]]
    if kind == "Command":
        word, path = (resolved(each, context) for each in part.given[0])
        assert word == "xacro "
        from cartwheel.description import load_robot

        return load_robot(path).text
    raise AssertionError(kind)


@pytest.fixture
def launched(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Runs a launch file and gives what it describes."""
    names = {
        "launch": ("LaunchDescription", "LaunchContext"),
        "launch.actions": ("DeclareLaunchArgument", "ExecuteProcess", "OpaqueFunction"),
        "launch.conditions": ("IfCondition",),
        "launch.substitutions": (
            "Command",
            "EqualsSubstitution",
            "LaunchConfiguration",
            "PathJoinSubstitution",
        ),
        "launch_ros": (),
        "launch_ros.actions": ("Node",),
        "launch_ros.parameter_descriptions": ("ParameterValue",),
        "launch_ros.substitutions": ("FindPackageShare",),
    }
    for module, classes in names.items():
        made = types.ModuleType(module)
        for name in classes:
            setattr(made, name, type(name, (Part,), {}))
        monkeypatch.setitem(sys.modules, module, made)

    def launch(name: str) -> list[Part]:
        description = runpy.run_path(str(PACKAGE / "launch" / name))[
            "generate_launch_description"
        ]()
        return list(description.given[0])

    return launch


def test_spawn_calls_the_service_with_the_robot(launched: Any) -> None:
    actions = launched("spawn.launch.py")
    defaults = {
        each.given[0]: each.named["default_value"]
        for each in actions
        if type(each).__name__ == "DeclareLaunchArgument"
    }
    (opaque,) = (each for each in actions if type(each).__name__ == "OpaqueFunction")
    (process,) = opaque.named["function"]({**defaults, "x": "1.5"})
    *command, request = process.named["cmd"]
    assert command == ["ros2", "service", "call", "/spawn_entity", "gazebo_msgs/srv/SpawnEntity"]
    # The tool reads YAML.
    said = yaml.safe_load(request)
    assert said == json.loads(request)
    assert (said["name"], said["initial_pose"]["position"]) == (
        "rosbots",
        {"x": 1.5, "y": 0.0, "z": 0.0},
    )
    assert load_text(said["xml"], file="rosbots.urdf").name == "rosbots"


def test_rviz_starts_with_files_that_exist(launched: Any) -> None:
    actions = launched("rviz.launch.py")
    nodes = {each.named["package"] for each in actions if type(each).__name__ == "Node"}
    assert nodes == {"joint_state_publisher_gui", "tf2_ros", "robot_state_publisher", "rviz2"}
    (config,) = (
        each.named["default_value"]
        for each in actions
        if type(each).__name__ == "DeclareLaunchArgument" and each.given[0] == "rvizconfig"
    )
    path = Path(resolved(config, {}))
    displays = yaml.safe_load(path.read_text())["Visualization Manager"]["Displays"]
    image = next(each for each in displays if each["Name"] == "Image")
    assert image["Topic"]["Reliability Policy"] == "Best Effort"
    text = (PACKAGE / "package.xml").read_text()
    assert all(
        f'$ROS_VERSION == 2">{name}<' in text or f"<exec_depend>{name}<" in text for name in nodes
    )
