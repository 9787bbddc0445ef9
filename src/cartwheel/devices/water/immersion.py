"""The part of a solid below a horizontal surface."""

from __future__ import annotations

import numpy as np

from cartwheel.geometry import Array


def below(corners: Array, height: float) -> tuple[float, Array]:
    """Volume of the part of a closed surface that lies below a height, and its first moment.

    Each triangle is cut at the height. The cut itself adds nothing, because the volume is summed
    from a point on it.

    Args:
        corners: Triangles, counter-clockwise from outside, shape (n, 3, 3), m.
        height: z of the horizontal plane, m.

    Returns:
        The volume in m³, and the volume times its centre, shape (3,), m⁴.
    """
    apex = corners.reshape(-1, 3).mean(axis=0)
    apex[2] = height
    cut = corners - apex
    wet = cut[:, :, 2] <= 0
    count = wet.sum(axis=1)
    pieces = [cut[count == 3]]
    for number in (1, 2):
        crossing = cut[count == number]
        if not len(crossing):
            continue
        # The corner that is alone on its side comes first.
        alone = wet[count == number] if number == 1 else ~wet[count == number]
        order = (np.argmax(alone, axis=1)[:, None] + np.arange(3)) % 3
        a, b, c = np.moveaxis(np.take_along_axis(crossing, order[:, :, None], axis=1), 1, 0)
        ab, ac = _crossing(a, b), _crossing(a, c)
        if number == 1:
            pieces.append(np.stack([a, ab, ac], axis=1))
        else:
            pieces += [np.stack([ab, b, c], axis=1), np.stack([ab, c, ac], axis=1)]
    volume, moment = volume_of(np.concatenate(pieces))
    return volume, moment + volume * apex


def volume_of(corners: Array) -> tuple[float, Array]:
    """Volume between a surface and the origin, and its first moment; see `below`."""
    a, b, c = np.moveaxis(corners, 1, 0)
    volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6
    moment: Array = (volumes[:, None] * corners.sum(axis=1)).sum(axis=0) / 4
    return float(volumes.sum()), moment


def _crossing(one: Array, other: Array) -> Array:
    """Points between pairs of points on both sides of z = 0, at z = 0; each shape (n, 3)."""
    share = one[:, 2] / (one[:, 2] - other[:, 2])
    point: Array = one + share[:, None] * (other - one)
    return point
