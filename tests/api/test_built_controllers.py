"""Worlds that are compiled once read no controller files again."""

import pickle
import shutil

import pytest
from tests.dialects.ros_control.arms import (
    ROS1,
    beam,
    robot,
    ros2_joint,
    ros2_plugin,
    ros2_system,
    transmission,
)

import cartwheel as cw
from cartwheel.codes.running import CONTROLLERS_NOT_NAMED
from cartwheel.dialects.ros_control.files import ControllerFiles

ROS1_FILE = """
arm: {type: position_controllers/JointPositionController, joint: beam_joint}
"""
ROS2_FILE = """
controller_manager:
  ros__parameters:
    arm: {type: position_controllers/JointGroupPositionController}
arm:
  ros__parameters: {joints: [beam_joint]}
"""
TARGET = 0.4
"""rad."""
NAMED = "named by the tag"
ROBOTS = {
    "ros1": robot(beam("beam", "world") + transmission("beam_joint", "Position"), ROS1),
    "ros2": robot(
        beam("beam", "world") + ros2_system(ros2_joint("beam_joint", "position")), ros2_plugin()
    ),
    NAMED: robot(
        beam("beam", "world") + ros2_system(ros2_joint("beam_joint", "position")),
        ros2_plugin("config/arm.yaml"),
    ),
}


@pytest.fixture(params=ROBOTS)
def kind(request):
    return request.param


@pytest.fixture
def package(kind, tmp_path):
    """A robot in a package with a controller file."""
    (tmp_path / "package.xml").write_text("<package><name>arm</name></package>")
    (tmp_path / "config").mkdir()
    text = ROS1_FILE if kind == "ros1" else ROS2_FILE
    (tmp_path / "config" / "arm.yaml").write_text(text)
    (tmp_path / "arm.urdf").write_text(ROBOTS[kind])
    return tmp_path


def moved(world):
    """Commands the joint; returns its position, and what was reported."""
    running = [each.name for each in world.session.shared.get(ControllerFiles).started]
    for topic in ("/arm/command", "/arm/commands"):
        if any(each.name == topic for each in world.graph.topics()):
            given = {"data": TARGET} if topic == "/arm/command" else {"data": [TARGET]}
            world.publish(topic, **given)
    world.run(0.5)
    reported = [(each.code, each.message, each.hint) for each in world.diagnostics]
    return running, world.model("arm").joint("beam_joint"), reported


@pytest.mark.parametrize("controllers", ["auto", "config/arm.yaml", None, ()])
def test_the_files_can_be_gone(kind, package, controllers):
    file = package / controllers if controllers == "config/arm.yaml" else controllers
    given = {"robot": package / "arm.urdf", "controllers": file}
    with cw.World() as world:
        world.spawn(**given)
        expected = moved(world)
    built = cw.build("empty", given)
    others = (built, pickle.loads(pickle.dumps(built)))
    shutil.rmtree(package)
    for each in (*others, *others):
        with each.world() as world:
            assert moved(world) == expected
    starts = kind == NAMED or controllers in ("auto", "config/arm.yaml")
    assert expected[0] == (["arm"] if starts else [])
    assert expected[1] == pytest.approx(TARGET if starts else 0.0, abs=0.01)


@pytest.mark.parametrize("kind", [each for each in ROBOTS if each != NAMED])
def test_a_warning_names_the_files_that_were_there(package):
    built = cw.build("empty", package / "arm.urdf")
    shutil.rmtree(package)
    with built.world() as world:
        (warning,) = (each for each in world.diagnostics if each.code is CONTROLLERS_NOT_NAMED)
    assert warning.values["files"] == (str(package / "config" / "arm.yaml"),)
