"""Rotations against matrices multiplied out, and against what defines them."""

import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from tests.coded import raises

import cartwheel as cw
from cartwheel import geometry as g
from cartwheel.codes.command import OPTION_INVALID
from cartwheel.codes.world import NUMBER_OUT_OF_RANGE, VALUE_INVALID

ANGLE = st.floats(-math.pi, math.pi)
PITCH = st.floats(-1.5, 1.5)
LENGTH = st.floats(-10, 10)
VECTOR = st.tuples(LENGTH, LENGTH, LENGTH)
QUATERNION = st.builds(g.quat_from_rpy, ANGLE, PITCH, ANGLE)
POSE = st.builds(g.Pose, VECTOR, QUATERNION)


def turn(axis, angle):
    """The rotation matrix about one of the axes, written out."""
    c, s = math.cos(angle), math.sin(angle)
    return {
        "x": np.array([[1, 0, 0], [0, c, -s], [0, s, c]]),
        "y": np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]]),
        "z": np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]),
    }[axis]


@pytest.mark.parametrize("wrong", [(1, 2), (1, 2, 3, 4), 5, None, (1, "x", 3), ((1,), 2, 3)])
def test_a_pose_needs_three_numbers(wrong):
    with raises(OPTION_INVALID, name="xyz"):
        g.Pose.from_xyz_rpy(wrong)
    with raises(OPTION_INVALID, name="rpy"):
        g.Pose.from_xyz_rpy((1, 2, 3), wrong)


@given(ANGLE, ANGLE, ANGLE)
def test_rpy_turns_about_x_then_y_then_z(roll, pitch, yaw):
    expected = turn("z", yaw) @ turn("y", pitch) @ turn("x", roll)
    assert g.matrix_from_quat(g.quat_from_rpy(roll, pitch, yaw)) == pytest.approx(
        expected, abs=1e-12
    )


@given(ANGLE, PITCH, ANGLE)
def test_rpy_comes_back(roll, pitch, yaw):
    found = g.rpy_from_quat(g.quat_from_rpy(roll, pitch, yaw))
    pose = g.Pose.from_xyz_rpy((1, 2, 3), (roll, pitch, yaw))
    assert (pose.roll, pose.pitch) == found[:2]
    assert math.remainder(pose.yaw - yaw, 2 * math.pi) == pytest.approx(0, abs=1e-9)
    for angle, expected in zip(found, (roll, pitch, yaw), strict=True):
        assert math.remainder(angle - expected, 2 * math.pi) == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize("pitch", [math.pi / 2, -math.pi / 2])
@pytest.mark.parametrize(("roll", "yaw"), [(0.3, 1.0), (-2.0, 0.4), (0, 0)])
def test_rpy_at_the_gimbals_lock_is_the_same_rotation(roll, pitch, yaw):
    q = g.quat_from_rpy(roll, pitch, yaw)
    again = g.quat_from_rpy(*g.rpy_from_quat(q))
    assert g.matrix_from_quat(again) == pytest.approx(g.matrix_from_quat(q), abs=1e-7)


@given(QUATERNION, VECTOR)
def test_rotate_is_the_matrix(q, v):
    assert g.rotate(q, v) == pytest.approx(g.matrix_from_quat(q) @ v, abs=1e-9)


@given(QUATERNION, QUATERNION)
def test_multiplication_is_the_matrices(a, b):
    product = g.matrix_from_quat(g.quat_multiply(a, b))
    assert product == pytest.approx(g.matrix_from_quat(a) @ g.matrix_from_quat(b), abs=1e-12)


@given(QUATERNION)
def test_conjugate_undoes(q):
    assert g.quat_multiply(q, g.quat_conjugate(q)) == pytest.approx((0, 0, 0, 1), abs=1e-12)


@given(QUATERNION)
def test_matrix_gives_the_quaternion_back(q):
    found = np.array(g.quat_from_matrix(g.matrix_from_quat(q)))
    # q and -q are one rotation.
    assert min(np.abs(found - q).max(), np.abs(found + np.array(q)).max()) < 1e-7


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_matrix_of_half_a_turn(axis):
    """The trace is -1: the branch that divides by the largest of the diagonal."""
    matrix = turn(axis, math.pi)
    assert g.matrix_from_quat(g.quat_from_matrix(matrix)) == pytest.approx(matrix, abs=1e-12)


@given(VECTOR, ANGLE)
def test_axis_and_angle(axis, angle):
    assume(math.hypot(*axis) > 1e-3)
    q = g.quat_from_axis_angle(axis, angle)
    assert g.rotate(q, axis) == pytest.approx(axis, abs=1e-9)
    trace = float(np.trace(g.matrix_from_quat(q)))
    assert trace == pytest.approx(1 + 2 * math.cos(angle), abs=1e-9)


@given(VECTOR, VECTOR)
def test_between_turns_one_into_the_other_the_short_way(a, b):
    assume(math.hypot(*a) > 1e-2 and math.hypot(*b) > 1e-2)
    u, v = np.array(a) / math.hypot(*a), np.array(b) / math.hypot(*b)
    # Near half a turn the axis is not defined well enough for a tight bound.
    assume(u @ v > -0.999999)
    q = g.quat_between(a, b)
    assert g.rotate(q, u) == pytest.approx(v, abs=1e-5)
    assert 2 * math.acos(min(1.0, abs(q[3]))) <= math.pi + 1e-9


@pytest.mark.parametrize("direction", [(1, 0, 0), (0, 1, 0), (0, 0, 1), (1, -2, 0.5)])
def test_between_opposites(direction):
    q = g.quat_between(direction, [-c for c in direction])
    assert g.rotate(q, direction) == pytest.approx([-c for c in direction], abs=1e-9)


@given(POSE, POSE, VECTOR)
def test_poses_compose_and_invert(a, b, point):
    assert (a @ b).apply(point) == pytest.approx(a.apply(b.apply(point)), abs=1e-8)
    there_and_back = a.inverse() @ a
    assert there_and_back.position == pytest.approx((0, 0, 0), abs=1e-9)
    assert a.inverse().apply(a.apply(point)) == pytest.approx(point, abs=1e-8)


@given(QUATERNION)
def test_yaw_is_where_x_points(q):
    x, y, _ = g.rotate(q, (1, 0, 0))
    assume(math.hypot(x, y) > 1e-3)
    assert math.remainder(g.yaw_of(q) - math.atan2(y, x), 2 * math.pi) == pytest.approx(0, abs=1e-9)
    assert g.Pose((0, 0, 0), q).yaw == g.yaw_of(q)


def test_orders_of_quaternions():
    assert g.to_wxyz((1, 2, 3, 4)) == (4, 1, 2, 3)
    assert g.from_wxyz((4, 1, 2, 3)) == (1, 2, 3, 4)


@pytest.mark.parametrize("q", [(0, 0, 0, 0), (math.nan, 0, 0, 1), (math.inf, 0, 0, 0)])
def test_what_is_no_rotation(q):
    with pytest.raises(ValueError):
        g.quat_normalize(q)
    with pytest.raises(ValueError):
        g.quat_from_axis_angle((0, 0, 0), 1.0)


def test_normalize():
    assert g.quat_normalize((0, 0, 3, 4)) == pytest.approx((0, 0, 0.6, 0.8))


def test_from_xyz_rpy_reads_as_urdf_does():
    pose = g.Pose.from_xyz_rpy((1, 2, 3), (0, 0, math.pi / 2))
    assert (pose.x, pose.y, pose.z) == (1, 2, 3)
    assert pose.apply((1, 0, 0)) == pytest.approx((1, 3, 3))
    assert pose.rpy == pytest.approx((0, 0, math.pi / 2))


def test_a_pose_transforms_arrays_of_points():
    pose = g.Pose.from_xyz_rpy((1, 2, 3), (0.3, -0.5, 2.0))
    points = np.random.default_rng(1).normal(size=(4, 5, 3)).astype(np.float32)
    placed = pose.apply(points)
    assert placed.shape == points.shape
    for index in np.ndindex(4, 5):
        assert placed[index] == pytest.approx(pose.apply(points[index].tolist()), abs=1e-12)
    assert pose.inverse().apply(placed) == pytest.approx(points, abs=1e-6)


@pytest.mark.parametrize(
    "point", [(1.0, 2.0), [1.0, 2.0, 3.0, 4.0], np.zeros((3, 2)), np.zeros(())]
)
def test_a_point_has_three_coordinates(point):
    with raises(OPTION_INVALID, name="point"):
        g.Pose().apply(point)


@pytest.mark.parametrize("kind", [tuple, list, np.array])
def test_poses_and_velocities_are_equal_if_their_numbers_are(kind):
    pose = g.Pose(kind([1.0, 0.0, 0.0]), kind([0.0, 0.0, 0.0, 1.0]))
    assert pose == g.Pose((1.0, 0.0, 0.0)) != g.Pose((1.0, 0.0, 2.0))
    assert hash(pose) == hash(g.Pose((1.0, 0.0, 0.0)))
    assert type(pose.position) is type(pose.orientation) is tuple
    twist = cw.Twist(linear=kind([1.0, 0.0, 0.0]))
    assert twist == cw.Twist((1.0, 0.0, 0.0)) != cw.Twist((1.0, 0.0, 2.0))
    assert cw.Acceleration(kind([0.0] * 3)) == cw.Acceleration()


@pytest.mark.parametrize(
    "wrong", [(0, 0), (0, 0, 0, 0, 0), "abc", 3, np.zeros((3, 2)), None, [None] * 3]
)
def test_a_pose_has_as_many_numbers_as_it_needs(wrong):
    with raises(OPTION_INVALID, name="position"):
        g.Pose(wrong)
    with raises(OPTION_INVALID, name="orientation"):
        g.Pose((0.0, 0.0, 0.0), wrong)
    with raises(VALUE_INVALID, name="angular"):
        cw.Twist(angular=wrong)


def test_the_quaternion_of_a_pose_becomes_a_unit_quaternion():
    assert g.Pose((0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 2.0)) == g.Pose()
    assert cw.Pose(orientation=(0, 0, 3, 4)).orientation == pytest.approx((0, 0, 0.6, 0.8))
    # What is a unit quaternion keeps its bits, and what has no direction is refused when used.
    nearly = (0.0, 0.0, 0.6, 0.8000000001)
    assert g.Pose(orientation=nearly).orientation == nearly
    zero = g.Pose(orientation=(0.0, 0.0, 0.0, 0.0))
    with cw.World("post") as world, raises(NUMBER_OUT_OF_RANGE):
        world.model("post").pose = zero
    with raises(OPTION_INVALID):
        g.Pose((0.0, 0.0, 0.0), ("a", 0.0, 0.0, 1.0))


@given(st.lists(st.tuples(VECTOR, VECTOR), min_size=1, max_size=5))
def test_cross_products_of_rows_have_the_bits_of_numpy(pairs):
    one, other = np.array([a for a, _ in pairs]), np.array([b for _, b in pairs])
    assert np.array_equal(g.cross_rows(one, other), np.cross(one, other))
    assert np.array_equal(g.cross_rows(one[0], other), np.cross(one[0], other))
    assert np.array_equal(g.cross_rows(one[:, None], other), np.cross(one[:, None], other))
    single = one.astype(np.float32)
    assert g.cross_rows(single, single).dtype == np.float32
