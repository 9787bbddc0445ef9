"""Image messages as pictures: every encoding that a camera of ours publishes."""

import numpy as np
import pytest
from tests.coded import raises

from cartwheel.codes.graph import ARRAY_INVALID
from cartwheel.geometry import Pose
from cartwheel.messages import from_dict
from cartwheel.viewer.panels.camera import pixels_of

COLOUR = (200, 100, 50)


def message(encoding, values, *, padding=0):
    """An image of these values, shape (height, width) or (height, width, channels)."""
    height, width = values.shape[:2]
    rows = np.ascontiguousarray(values).view(np.uint8).reshape(height, -1)
    rows = np.pad(rows, ((0, 0), (0, padding)))
    return from_dict(
        "sensor_msgs/msg/Image",
        {
            "height": height,
            "width": width,
            "encoding": encoding,
            "step": rows.shape[1],
            "data": rows.reshape(-1),
        },
    )


@pytest.mark.parametrize("padding", [0, 5])
@pytest.mark.parametrize("encoding", ["rgb8", "bgr8", "rgba8", "bgra8", "rgb16", "bgr16"])
def test_colours_keep_their_place(encoding, padding):
    colour = COLOUR if encoding.startswith("rgb") else COLOUR[::-1]
    if "a8" in encoding:
        colour = (*colour, 7)
    values = np.tile(np.array(colour, dtype=np.uint8), (2, 3, 1))
    if "16" in encoding:
        values = values.astype("<u2") * np.uint16(257)
    shown = pixels_of(message(encoding, values, padding=padding))
    assert shown.shape == (2, 3, 3)
    assert (shown == COLOUR).all()


@pytest.mark.parametrize(
    ("encoding", "dtype", "scale"), [("mono8", "u1", 1), ("mono16", "<u2", 257)]
)
def test_grey(encoding, dtype, scale):
    values = (np.arange(6).reshape(2, 3) * scale).astype(dtype)
    assert np.array_equal(pixels_of(message(encoding, values))[..., 1], values // scale)


@pytest.mark.parametrize("encoding", [f"bayer_{f}8" for f in ("rggb", "bggr", "gbrg", "grbg")])
@pytest.mark.parametrize("shape", [(4, 6), (3, 5)])
def test_mosaics(encoding, shape):
    values = np.zeros(shape, dtype=np.uint8)
    for index, letter in enumerate(encoding.removeprefix("bayer_")[:4]):
        row, column = divmod(index, 2)
        values[row::2, column::2] = COLOUR["rgb".index(letter)]
    shown = pixels_of(message(encoding, values))
    assert shown.shape == (*shape, 3)
    assert (shown[:2, :2] == COLOUR).all()


@pytest.mark.parametrize(
    ("encoding", "dtype", "unit"), [("32FC1", "<f4", 1.0), ("16UC1", "<u2", 1000.0)]
)
def test_depths_are_brighter_the_nearer(encoding, dtype, unit):
    metres = np.array([[0.5, 1.0], [4.0, np.nan]])
    values = np.nan_to_num(metres * unit, nan=np.nan if unit == 1.0 else 0.0).astype(dtype)
    shown = pixels_of(message(encoding, values))
    near, middle, far, none = shown[..., 0].ravel().tolist()
    assert near == 255
    assert near > middle > far > none == 0


def test_infinite_depths_are_black():
    values = np.array([[np.inf, -np.inf, np.nan, 2.0]], dtype="<f4")
    assert pixels_of(message("32FC1", values))[0, :, 0].tolist() == [0, 0, 0, 255]
    assert not pixels_of(message("32FC1", values[:, :3])).any()


def test_data_that_do_not_fit_are_refused():
    damaged = message("rgb8", np.zeros((2, 3, 3), dtype="u1"))
    damaged.data = damaged.data[:-1]
    with raises(ARRAY_INVALID, width=3, height=2, size=17):
        pixels_of(damaged)


def test_an_unknown_encoding_is_none():
    assert pixels_of(message("yuv422", np.zeros((2, 2), dtype="u1"))) is None


def test_what_a_depth_camera_publishes(make):
    model = """<model name="eye"><static>1</static><pose>0 0 1 0 0 0</pose><link name="link">
      <sensor name="cam" type="depth"><update_rate>30</update_rate><camera/>
        <plugin name="p" filename="libgazebo_ros_openni_kinect.so"><cameraName>k</cameraName>
        </plugin></sensor></link></model>"""
    post = make.box("post", (0.2, 0.2, 0.2), static=True, pose=Pose((1, 0, 1)))
    world = make.world(make.sdf(model), post)
    box = world.mailbox("/k/depth/image_raw")
    world.run(0.05)
    shown = pixels_of(box.drain()[0])
    assert shown.shape == (240, 320, 3)
    assert (shown[120, 160] == 255).all()
    assert not shown[0].any()
