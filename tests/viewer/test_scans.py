"""What the page makes of scans and clouds, without a browser."""

import numpy as np
import pytest

from cartwheel.messages import header, message_class
from cartwheel.viewer.scans import MOST_POINTS, points_of, points_of_scan, row_of_frame

LINKS = (("wall", "link"), ("bot", "base"), ("bot", "laser"), ("twin", "laser"))


def scan(ranges, low, step):
    return message_class("sensor_msgs/msg/LaserScan")(
        header=header(0, "laser"),
        angle_min=low,
        angle_max=low + step * (len(ranges) - 1),
        angle_increment=step,
        time_increment=0.0,
        scan_time=0.0,
        range_min=0.1,
        range_max=10.0,
        ranges=np.array(ranges, dtype=np.float32),
        intensities=np.zeros(len(ranges), dtype=np.float32),
    )


def cloud(rows, *, padding=0, bigendian=False):
    """Points of shape (height, width, 3) behind four bytes, with bytes between the rows."""
    height, width, _ = rows.shape
    packed = np.zeros((height, width, 4), dtype=">f4" if bigendian else "<f4")
    packed[..., 1:] = rows
    raw = packed.reshape(height, -1).view(np.uint8)
    raw = np.hstack([raw, np.full((height, padding), 255, dtype=np.uint8)])
    field = message_class("sensor_msgs/msg/PointField")
    return message_class("sensor_msgs/msg/PointCloud2")(
        header=header(0, "laser"),
        height=height,
        width=width,
        fields=[field(name, 4 * (i + 1), 7, 1) for i, name in enumerate("xyz")],
        is_bigendian=bigendian,
        point_step=16,
        row_step=16 * width + padding,
        data=raw.reshape(-1),
        is_dense=False,
    )


def test_a_scan_turns_to_the_left_and_leaves_out_what_it_missed():
    message = scan([2.0, np.inf, 3.0, -np.inf], low=0.0, step=np.pi / 4)
    assert points_of_scan(message) == pytest.approx(np.array([[2, 0, 0], [0, 3, 0]]), abs=1e-6)


@pytest.mark.parametrize("padding", [0, 6])
@pytest.mark.parametrize("bigendian", [False, True])
def test_a_cloud_is_read_by_its_own_layout(padding, bigendian):
    rows = np.arange(18, dtype=float).reshape(2, 3, 3)
    points = points_of(cloud(rows, padding=padding, bigendian=bigendian))
    assert points.tolist() == rows.reshape(-1, 3).tolist()


def test_points_that_are_not_there_are_left_out():
    rows = np.array([[[1.0, 2.0, 3.0], [np.nan, 0.0, 0.0], [np.inf, np.inf, np.inf]]])
    assert points_of(cloud(rows)).tolist() == [[1.0, 2.0, 3.0]]


def test_a_large_cloud_is_thinned_evenly():
    count = 3 * MOST_POINTS
    rows = np.zeros((1, count, 3))
    rows[0, :, 0] = np.arange(count)
    points = points_of(cloud(rows))
    assert len(points) == MOST_POINTS
    assert np.all(np.diff(points[:, 0]) == 3)


def test_a_cloud_without_places_has_no_points():
    message = cloud(np.zeros((1, 2, 3)))
    message.fields.pop()
    assert points_of(message).shape == (0, 3)


@pytest.mark.parametrize(
    ("model", "frame", "row"),
    [
        ("bot", "laser", 2),
        ("twin", "laser", 3),
        ("bot", "bot_7/laser", 2),
        ("bot", "optic", None),
        ("wall", "laser", None),
    ],
)
def test_a_frame_is_a_link_of_the_model_that_publishes(model, frame, row):
    assert row_of_frame(LINKS, model, frame) == row
