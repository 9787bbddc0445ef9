"""Links of one model whose convex hulls overlap, such as a peg in a fork."""

import struct

import numpy as np
import pytest

import cartwheel as cw
from cartwheel.checks.checking import check
from cartwheel.codes import robot as robot_codes
from cartwheel.codes import world as codes
from cartwheel.description import load_robot


def box(low, high):
    """Twelve triangles."""
    corner = np.array([[(low, high)[i >> k & 1][k] for k in range(3)] for i in range(8)])
    quads = ((0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5))
    return [corner[list(part)] for a, b, c, d in quads for part in ((a, b, c), (a, c, d))]


def fork(path):
    """Two tines beside a gap of 0.1 m, in which the peg turns."""
    faces = [
        *box((0.0, -0.1, -0.1), (0.05, 0.1, 0.1)),
        *box((0.05, -0.1, -0.1), (0.4, -0.05, 0.1)),
        *box((0.05, 0.05, -0.1), (0.4, 0.1, 0.1)),
    ]
    data = struct.pack("<80xI", len(faces))
    for face in faces:
        data += struct.pack("<12fH", 0, 0, 0, *face.ravel(), 0)
    path.write_bytes(data)


INERTIA = (
    '<inertial><mass value="1"/><inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" '
    'iyz="0"/></inertial>'
)
SOLID = {
    "mesh": '<mesh filename="fork.stl"/>',
    "boxes": '<box size="0.8 0.2 0.2"/>',
}


def robot(folder, shape="mesh", collide=True):
    """A peg between two tines, on a joint of another link than the fork."""
    fork(folder / "fork.stl")
    tag = f"<selfCollide>{str(collide).lower()}</selfCollide>"
    text = f"""<robot name="peg"><link name="world"/>
      <link name="fork">{INERTIA}<collision><geometry>{SOLID[shape]}</geometry></collision></link>
      <joint name="bolt" type="fixed"><parent link="world"/><child link="fork"/>
        <origin xyz="0 0 1"/></joint>
      <link name="crank">{INERTIA}</link>
      <joint name="first" type="revolute"><parent link="fork"/><child link="crank"/>
        <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="9" velocity="9"/></joint>
      <link name="peg">{INERTIA}<collision><origin xyz="0.2 0 0"/>
        <geometry><box size="0.04 0.04 0.04"/></geometry></collision></link>
      <joint name="second" type="revolute"><parent link="crank"/><child link="peg"/>
        <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="9" velocity="9"/></joint>
      <gazebo reference="fork">{tag}</gazebo><gazebo reference="peg">{tag}</gazebo></robot>"""
    file = folder / "peg.urdf"
    file.write_text(text)
    return file


def moved(world):
    """How far the joints turned from 0 in half a second, rad."""
    world.run(0.5)
    data = world.session.simulation.data
    return max(abs(data.joint(f"peg::{name}").qpos[0]) for name in ("first", "second"))


def reported(world):
    return [each.values for each in world.diagnostics if each.code is codes.HULLS_APART]


def test_links_with_overlapping_hulls_do_not_push_each_other_apart(tmp_path):
    file = robot(tmp_path)
    with cw.World("empty") as world:
        world.spawn(load_robot(file))
        assert reported(world) == [
            {"model": "peg", "links": ("fork", "peg"), "partners": (1.0, 1.0)}
        ]
        assert moved(world) < 1e-6


def test_without_the_addition_they_do(tmp_path):
    file = robot(tmp_path)
    with cw.World("empty", without=["apart-hulls"]) as world:
        world.spawn(load_robot(file))
        assert reported(world) == []
        assert moved(world) > 0.05


@pytest.mark.parametrize(("shape", "collide"), [("boxes", True), ("mesh", False)])
def test_only_meshes_that_collide_with_links_of_their_model_count(tmp_path, shape, collide):
    file = robot(tmp_path, shape, collide)
    with cw.World("empty") as world:
        world.spawn(load_robot(file))
        assert reported(world) == []
        # The box itself contains the peg, as in Gazebo.
        assert (moved(world) > 0.05) == collide


@pytest.mark.parametrize(("shape", "severity"), [("mesh", "info"), ("boxes", "warning")])
def test_check_reports_the_overlap(tmp_path, shape, severity):
    found = check(robot(tmp_path, shape)).findings
    (overlap,) = (each for each in found if each.code is robot_codes.OVERLAPPING_COLLISIONS)
    assert overlap.severity == severity
    assert overlap.values == {"link": "fork", "other": "peg"}
