"""Robots that others published do what they should, as far as their own numbers allow it."""

import io
import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from cartwheel.api import World
from cartwheel.corpus import try_robot
from cartwheel.description import load_robot
from cartwheel.geometry import matrix_from_quat

ROOT = Path(__file__).parents[2]
CORPUS = Path(os.environ.get("CARTWHEEL_CORPUS", ROOT.parent / "shared" / "corpus"))

pytestmark = pytest.mark.skipif(
    not CORPUS.is_dir(), reason=f"no corpus of others' robots in {CORPUS}"
)

TURTLEBOT = "turtlebot3/turtlebot3_description/urdf/turtlebot3_"
LINOROBOT = "linorobot2/linorobot2_description/urdf/robots/"
TUTORIAL = "urdf_sim_tutorial/urdf/"
PLUGINS = "gazebo_plugins_tests/gazebo_plugins/test/"


@dataclass(frozen=True)
class Expected:
    """What a robot's own description lets it do."""

    drives: float | None = None
    """Its speed over the commanded one; None where nothing drives it."""
    turns: float | None = None
    """The same of turning where it stands; None where that is not for its numbers to say."""
    reaches: int = 0
    """Joints that controllers take somewhere."""


DIFFERENTIAL = Expected(drives=1.0, turns=1.0)
SKIDS = Expected(drives=1.0)
ROBOTS = {
    f"{TURTLEBOT}burger.urdf.xacro": DIFFERENTIAL,
    f"{TURTLEBOT}burger_for_autorace.urdf.xacro": DIFFERENTIAL,
    f"{TURTLEBOT}burger_for_autorace_2020.urdf.xacro": DIFFERENTIAL,
    f"{TURTLEBOT}waffle.urdf.xacro": DIFFERENTIAL,
    f"{TURTLEBOT}waffle_for_open_manipulator.urdf.xacro": DIFFERENTIAL,
    f"{TURTLEBOT}waffle_pi.urdf.xacro": DIFFERENTIAL,
    f"{TURTLEBOT}waffle_pi_for_open_manipulator.urdf.xacro": DIFFERENTIAL,
    f"{LINOROBOT}2wd.urdf.xacro": DIFFERENTIAL,
    f"{LINOROBOT}4wd.urdf.xacro": SKIDS,
    f"{LINOROBOT}mecanum.urdf.xacro": DIFFERENTIAL,
    # Its left wheel is on the right, so it turns the other way, as in Gazebo.
    f"{PLUGINS}multi_robot_scenario/xacro/p3dx/pioneer3dx.xacro": Expected(drives=1.0, turns=-1.0),
    # It states the radius for the diameter; and its command's turn is the angle of its wheel.
    f"{PLUGINS}tricycle_drive/xacro/tricycle/tricycle.xacro": Expected(drives=2.0),
    "mir_robot/mir_description/urdf/mir.urdf.xacro": DIFFERENTIAL,
    "andino/andino_description/urdf/andino.urdf.xacro": Expected(),
    "gazebo_ros_demos/rrbot_description/urdf/rrbot.xacro": Expected(reaches=2),
    f"{TUTORIAL}10-firsttransmission.urdf.xacro": Expected(reaches=1),
    f"{TUTORIAL}12-gripper.urdf.xacro": Expected(reaches=4),
    # Four wheels that slide sideways turn it by Coulomb's law. Gazebo 11.1: 0.97 and 0.93.
    f"{TUTORIAL}13-diffdrive.urdf.xacro": Expected(drives=1.0, turns=0.744, reaches=4),
}


@pytest.mark.parametrize(("name", "expected"), ROBOTS.items(), ids=lambda value: str(value)[-40:])
def test_a_published_robot_does_what_it_should(name, expected):
    verdict = try_robot(CORPUS / name)
    assert verdict.loaded, verdict.error
    assert not verdict.error
    assert verdict.missing == ()
    assert verdict.stand.state in ("yes", "fixed")
    assert verdict.topics > 0
    assert verdict.silent == ()
    assert len(verdict.drives) == (expected.drives is not None)
    for drive in verdict.drives:
        assert drive.measured / drive.commanded == pytest.approx(expected.drives, rel=0.05)
        if expected.turns is not None:
            ratio = drive.measured_turn / drive.commanded_turn
            assert ratio == pytest.approx(expected.turns, rel=0.05)
    assert len(verdict.reaches) == expected.reaches
    for reach in verdict.reaches:
        assert reach.arrived, reach


@pytest.mark.parametrize("name", ROBOTS, ids=lambda name: name[-40:])
def test_masses_and_places_are_those_that_another_reader_computes(name):
    # Imports trimesh.
    import yourdfpy

    robot = load_robot(CORPUS / name)
    other = yourdfpy.URDF.load(
        io.BytesIO(robot.text.encode()),
        load_meshes=False,
        build_collision_scene_graph=False,
        load_collision_meshes=False,
    )
    masses = [link.inertial.mass or 0.0 for link in other.robot.links if link.inertial]
    assert robot.mass == pytest.approx(sum(masses), rel=1e-9)
    with World() as world:
        model = world.spawn(robot, z=1.0)
        simulation = world.session.simulation
        simulation.refresh()
        base = model.pose
        for link in robot.links:
            pose = base.inverse() @ simulation.engine.link_pose(model.name, link.name)
            theirs = other.get_transform(link.name, other.base_link)
            np.testing.assert_allclose(pose.position, theirs[:3, 3], atol=1e-6)
            np.testing.assert_allclose(
                matrix_from_quat(pose.orientation), theirs[:3, :3], atol=1e-6
            )
