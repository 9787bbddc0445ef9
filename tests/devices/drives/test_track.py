"""The velocities of tracks, and the motion of their surfaces that moves a vehicle so."""

import math

import numpy as np
import pytest

from cartwheel.devices.drives.track import likely_field, surface_field, travel
from cartwheel.devices.drives.tracked_vehicle import track_speeds
from cartwheel.simulation.dynamics.moving_surface import SurfaceContacts

LEFT = np.array([0.0, 1.0, 0.0])
AXES = np.eye(3)
BELOW = np.array([0.0, 0.0, 1.0])
"""Normal into a track of what is below it."""


def contacts(positions, normals=(0.0, 0.0, 1.0), *, centre=(0.0, 0.0, 0.1), radius=0.0, axis=LEFT):
    positions = np.array(positions, dtype=float).reshape(-1, 3)
    return SurfaceContacts(
        centre=np.array(centre),
        size=0.5,
        radius=radius,
        axis=np.array(axis),
        positions=positions,
        normals=np.broadcast_to(np.array(normals, dtype=float), positions.shape),
    )


def field_at(field, touched):
    """Velocity of the surface at each contact, without the part along the normal."""
    linear, angular = field
    velocities = linear + np.cross(angular, touched.positions - touched.centre)
    along = (velocities * touched.normals).sum(axis=1, keepdims=True)
    return velocities - along * touched.normals


CORNERS = [(x, y, 0.0) for x in (-0.4, 0.4) for y in (0.2, 0.3)]
NOTHING = (np.zeros(3), np.zeros(3))


@pytest.mark.parametrize("velocity", [0.5, -0.5])
def test_a_track_travels_along_what_it_touches(velocity):
    """Ahead on the ground, up at a wall in front of it, and back under a ceiling."""
    for normal, direction in (
        ((0, 0, 1), (1, 0, 0)),
        ((-1, 0, 0), (0, 0, 1)),
        ((0, 0, -1), (-1, 0, 0)),
    ):
        touched = contacts([(0.4, 0.2, 0.0)], normal)
        (move,) = travel(velocity, [touched], LEFT, None)
        assert move[0] == pytest.approx(velocity * np.array(direction))


def test_what_it_touches_with_its_side_does_not_move_it():
    touched = contacts([(0.0, 0.3, 0.1)], (0, -1, 0))
    (move,) = travel(0.5, [touched], LEFT, None)
    assert move[0] == pytest.approx((0, 0, 0))


@pytest.mark.parametrize("velocity", [0.5, -0.5])
@pytest.mark.parametrize("side", [1.0, -1.0])
def test_in_a_turn_it_moves_on_circles(velocity, side):
    """A rigid rotation about the centre, whose mean speed at the contacts is that of the track."""
    centre = np.array([0.0, side * 2.0, 0.7])
    (moves,) = travel(velocity, [contacts(CORNERS)], LEFT, centre)
    arms = np.array(CORNERS) - centre
    assert (moves[:, :2] * arms[:, :2]).sum(axis=1) == pytest.approx(0.0, abs=1e-12)
    rates = np.cross(arms * (1, 1, 0), moves)[:, 2] / (arms[:, :2] ** 2).sum(axis=1)
    assert rates == pytest.approx(rates[0])
    assert np.sign(rates[0]) == side * np.sign(velocity)
    speeds = np.linalg.norm(moves, axis=1)
    lengths = np.linalg.norm(arms[:, :2], axis=1)
    assert (speeds * lengths).sum() == pytest.approx(abs(velocity) * lengths.sum())


@pytest.mark.parametrize("centre", [None, np.array([0.1, -0.3, 0.0])])
def test_the_surface_moves_as_wanted_at_each_contact(centre):
    touched = contacts(CORNERS)
    (moves,) = travel(0.5, [touched], LEFT, centre)
    assert field_at(surface_field(touched, moves, NOTHING), touched) == pytest.approx(moves)


def test_contacts_in_front_and_below_fit_together():
    touched = contacts([(0.4, 0.2, 0.1), (0.0, 0.2, 0.0)])
    touched = touched._replace(normals=np.array([(-1.0, 0, 0), (0, 0, 1.0)]))
    (moves,) = travel(0.5, [touched], LEFT, None)
    assert field_at(surface_field(touched, moves, NOTHING), touched) == pytest.approx(moves)


def test_without_contacts_the_likely_motion_stays():
    likely = likely_field(0.5, contacts([]), AXES, BELOW)
    assert surface_field(contacts([]), np.zeros((0, 3)), likely) is likely
    assert likely[0] == pytest.approx((-0.5, 0, 0))
    above = likely_field(0.5, contacts([]), AXES, -BELOW)
    assert above[0] == pytest.approx((0.5, 0, 0))


def test_a_round_end_rotates_about_the_axle():
    """Its lowest point moves back, and its foremost point down, at the velocity of the track."""
    for axis in (LEFT, -LEFT, np.zeros(3)):
        touched = contacts([(0, 0, 0), (0.1, 0, 0.1)], radius=0.1, axis=axis)
        touched = touched._replace(normals=np.array([(0, 0, 1.0), (-1.0, 0, 0)]))
        found = field_at(likely_field(0.5, touched, AXES, BELOW), touched)
        assert found == pytest.approx(np.array([(-0.5, 0, 0), (0, 0, -0.5)]))
    across = contacts([], radius=0.1, axis=(1, 0, 0))
    assert likely_field(0.5, across, AXES, BELOW)[0] == pytest.approx((-0.5, 0, 0))


def test_the_tracks_of_a_turn():
    assert track_speeds(0.5, 0.0, 0.4, 0.5) == (0.5, 0.5, math.inf)
    assert track_speeds(0.0, 1.0, 0.4, 0.5) == pytest.approx((-0.4, 0.4, 0.0))
    assert track_speeds(0.5, 0.25, 0.4, 1.0) == pytest.approx((0.45, 0.55, 2.0))
    assert track_speeds(-0.5, 0.25, 0.4, 1.0).radius == pytest.approx(-2.0)
