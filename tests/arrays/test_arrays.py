"""Arrays of messages: values, shapes, shared memory, and data that do not fit."""

import io
import math
import struct
from typing import Any

import numpy as np
import pytest
from PIL import Image
from tests.coded import raises

import cartwheel as cw
from cartwheel import arrays
from cartwheel.codes.graph import ARRAY_INVALID, FIELD_UNKNOWN
from cartwheel.errors import GraphError
from cartwheel.messages import from_dict

HEIGHT, WIDTH = 3, 4


def image(
    encoding: str, numbers: np.ndarray[Any, Any], *, padding: int = 0, big: bool = False
) -> Any:
    """A message of an image, of numbers of shape (height, width) or (height, width, channels)."""
    numbers = numbers.astype(numbers.dtype.newbyteorder(">" if big else "<"))
    rows = numbers.reshape(len(numbers), -1).view(np.uint8).reshape(len(numbers), -1)
    padded = np.pad(rows, ((0, 0), (0, padding)), constant_values=77)
    return from_dict(
        "sensor_msgs/msg/Image",
        {
            "height": numbers.shape[0],
            "width": numbers.shape[1],
            "encoding": encoding,
            "is_bigendian": int(big),
            "step": padded.shape[1],
            "data": padded.reshape(-1),
        },
    )


def counted(dtype: str, *channels: int) -> np.ndarray[Any, Any]:
    shape = (HEIGHT, WIDTH, *channels)
    return np.arange(math.prod(shape)).astype(dtype).reshape(shape)


@pytest.mark.parametrize("padding", [0, 1, 5])
@pytest.mark.parametrize("big", [False, True])
@pytest.mark.parametrize(
    ("encoding", "dtype", "channels"),
    [
        ("rgb8", "u1", (3,)),
        ("rgba8", "u1", (4,)),
        ("rgb16", "u2", (3,)),
        ("mono8", "u1", ()),
        ("mono16", "u2", ()),
        ("bayer_rggb8", "u1", ()),
        ("bayer_gbrg16", "u2", ()),
        ("8UC1", "u1", ()),
        ("16UC1", "u2", ()),
        ("16SC2", "i2", (2,)),
        ("32FC1", "f4", ()),
        ("32FC3", "f4", (3,)),
        ("64F", "f8", ()),
    ],
)
def test_images(
    encoding: str, dtype: str, channels: tuple[int, ...], big: bool, padding: int
) -> None:
    numbers = counted(dtype, *channels)
    message = image(encoding, numbers, padding=padding, big=big)
    pixels = cw.image(message)
    assert pixels.shape == numbers.shape
    assert np.array_equal(pixels, numbers)
    assert np.shares_memory(pixels, message.data)
    assert not pixels.flags.writeable
    with pytest.raises(ValueError, match="read-only"):
        pixels[0, 0] = 1
    assert np.array_equal(arrays.array(message), numbers)


def test_colours_are_always_red_green_blue() -> None:
    numbers = counted("u1", 3)
    message = image("bgr8", numbers, padding=2)
    pixels = cw.image(message)
    assert np.array_equal(pixels, numbers[:, :, ::-1])
    assert np.shares_memory(pixels, message.data)
    assert not pixels.flags.writeable
    numbers = counted("u1", 4)
    assert np.array_equal(cw.image(image("bgra8", numbers)), numbers[:, :, [2, 1, 0, 3]])


def test_depths_are_in_metres() -> None:
    metres = counted("f4")
    metres[0, 0] = np.inf
    message = image("32FC1", metres)
    depths = cw.depth(message)
    assert np.array_equal(depths, metres)
    assert np.shares_memory(depths, message.data)
    for encoding in ("16UC1", "mono16"):
        depths = cw.depth(image(encoding, counted("u2") * 500, big=True, padding=3))
        assert depths.dtype == np.float32
        assert np.isnan(depths[0, 0])
        assert depths.reshape(-1)[1:] == pytest.approx(np.arange(1, 12) * 0.5)
    with raises(ARRAY_INVALID, encoding="rgb8"):
        cw.depth(image("rgb8", counted("u1", 3)))


def compressed(form: str, data: bytes) -> Any:
    return from_dict(
        "sensor_msgs/msg/CompressedImage", {"format": form, "data": np.frombuffer(data, np.uint8)}
    )


def file(pixels: np.ndarray[Any, Any], form: str = "PNG") -> bytes:
    stream = io.BytesIO()
    Image.fromarray(pixels).save(stream, form)
    return stream.getvalue()


def test_compressed_images() -> None:
    pixels = counted("u1", 3)
    message = compressed("rgb8; png compressed bgr8", file(pixels))
    assert np.array_equal(cw.image(message), pixels)
    assert not cw.image(message).flags.writeable
    grey = counted("u1")
    assert np.array_equal(cw.image(compressed("mono8; png compressed ", file(grey))), grey)
    flat = np.full((16, 16, 3), (200, 100, 50), np.uint8)
    decoded = cw.image(compressed("rgb8; jpeg compressed bgr8", file(flat, "JPEG")))
    assert np.abs(decoded.astype(int) - flat).max() < 5
    wide = counted("u2") * 300
    assert np.array_equal(cw.image(compressed("16UC1; png compressed", file(wide))), wide)
    depths = cw.depth(compressed("16UC1; png compressed", file(wide)))
    assert depths[0, 1] == pytest.approx(0.3)


def test_compressed_depths() -> None:
    """Inverse depths a / z + b as 16-bit numbers; source: compressed_depth_image_transport."""
    a, b = 10_000.0, -100.0
    metres = np.array([[1.0, 2.0], [4.0, 8.0]])
    numbers = np.round(a / metres + b).astype(np.uint16)
    numbers[1, 1] = 0
    data = struct.pack("<iff", 0, a, b) + file(numbers)
    depths = cw.depth(compressed("32FC1; compressedDepth png", data))
    assert depths.dtype == np.float32
    # A rounding error of 0.5 at 4 m: z² 0.5 / a.
    assert depths.reshape(-1)[:3] == pytest.approx([1.0, 2.0, 4.0], abs=16 * 0.5 / a + 1e-6)
    assert np.isnan(depths[1, 1])
    assert np.array_equal(
        cw.image(compressed("32FC1; compressedDepth png", data)), depths, equal_nan=True
    )


@pytest.mark.parametrize(
    "change",
    [
        {"height": 4},
        {"width": 5},
        {"step": 11},
        {"step": 0},
        {"step": 13},
        {"height": 2**32 - 1, "width": 2**32 - 1, "step": 2**32 - 1},
        {"encoding": "rgba8"},
        {"encoding": "yuv422"},
        {"encoding": "8UC0"},
        {"encoding": "8UC99999"},
        {"encoding": "x" * 10_000},
        {"data": np.zeros(10, np.uint8)},
        {"data": np.zeros(0, np.uint8)},
        {"data": np.zeros(37, np.uint8)},
    ],
)
def test_hostile_images_are_refused(change: dict[str, Any]) -> None:
    message = image("rgb8", counted("u1", 3))
    for name, value in change.items():
        setattr(message, name, value)
    with raises(ARRAY_INVALID, GraphError):
        cw.image(message)


@pytest.mark.parametrize(
    "message",
    [
        compressed("rgb8; png compressed bgr8", b"nothing"),
        compressed("rgb8; png compressed bgr8", b""),
        compressed("rgb8; png compressed bgr8", file(counted("u1", 3))[:45]),
        compressed("rgb8; gif compressed", file(counted("u1"), "GIF")),
        compressed("32FC1; compressedDepth png", b"short"),
        compressed("32FC1; compressedDepth png", bytes(12) + file(counted("u1"))),
    ],
)
def test_hostile_compressed_images_are_refused(message: Any) -> None:
    with raises(ARRAY_INVALID, GraphError):
        cw.image(message)
    with raises(ARRAY_INVALID, GraphError):
        cw.depth(message)


def test_empty_images() -> None:
    message = from_dict(
        "sensor_msgs/msg/Image", {"height": 0, "width": 4, "step": 12, "encoding": "rgb8"}
    )
    assert cw.image(message).shape == (0, 4, 3)


# -- scans


def scan(**more: Any) -> Any:
    values = {
        "angle_min": -1.0,
        "angle_max": 1.0,
        "angle_increment": 0.5,
        "range_min": 0.1,
        "range_max": 10.0,
        "ranges": [1.0, 2.0, math.inf, -math.inf, 0.05],
    }
    return from_dict("sensor_msgs/msg/LaserScan", {**values, **more})


def test_scans_have_angles() -> None:
    message = scan(intensities=[1.0, 2.0, 3.0, 4.0, 5.0])
    found = cw.scan(message)
    assert found.ranges.tolist() == message.ranges.tolist()
    assert np.shares_memory(found.ranges, message.ranges)
    assert found.angles == pytest.approx([-1.0, -0.5, 0.0, 0.5, 1.0])
    assert found.intensities.tolist() == [1, 2, 3, 4, 5]
    assert found.valid.tolist() == [True, True, False, False, False]
    assert found.points == pytest.approx(
        np.array([[math.cos(1), -math.sin(1)], [2 * math.cos(0.5), -2 * math.sin(0.5)]])
    )
    assert (found.range_min, found.range_max) == pytest.approx((0.1, 10.0))
    assert cw.scan(scan()).intensities.size == 0
    assert arrays.array(message).tolist() == message.ranges.tolist()
    assert not found.ranges.flags.writeable
    message.ranges[0] = 3.0  # the message itself is unchanged


@pytest.mark.parametrize(
    "wrong", [{"intensities": [1.0]}, {"angle_min": math.nan}, {"angle_increment": math.inf}]
)
def test_hostile_scans_are_refused(wrong: dict[str, Any]) -> None:
    with raises(ARRAY_INVALID, GraphError):
        cw.scan(scan(**wrong))


# -- point clouds

FIELDS = [("x", 7), ("y", 7), ("z", 7), ("intensity", 7), ("ring", 4)]
SIZES = {1: 1, 2: 1, 3: 2, 4: 2, 5: 4, 6: 4, 7: 4, 8: 8}


def cloud(
    height: int = 1,
    width: int = 6,
    *,
    fields: list[tuple[str, int]] = FIELDS,
    gap: int = 0,
    padding: int = 0,
    big: bool = False,
) -> tuple[Any, np.ndarray[Any, Any]]:
    """A message of a point cloud, and its points with fields."""
    order = ">" if big else "<"
    codes = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}
    offsets, offset = [], 0
    for _, datatype in fields:
        offsets.append(offset)
        offset += SIZES[datatype] + gap
    kind = np.dtype(
        {
            "names": [name for name, _ in fields],
            "formats": [f"{order}{codes[datatype]}" for _, datatype in fields],
            "offsets": offsets,
            "itemsize": offset,
        }
    )
    points = np.zeros((height, width), kind)
    for index, (name, _) in enumerate(fields):
        points[name] = np.arange(height * width).reshape(height, width) + index / 4
    rows = points.view(np.uint8).reshape(height, -1)
    data = np.pad(rows, ((0, 0), (0, padding)))
    message = from_dict(
        "sensor_msgs/msg/PointCloud2",
        {
            "height": height,
            "width": width,
            "is_bigendian": big,
            "point_step": kind.itemsize,
            "row_step": data.shape[1],
            "data": data.reshape(-1),
            "fields": [
                {"name": name, "offset": place, "datatype": datatype, "count": 1}
                for (name, datatype), place in zip(fields, offsets, strict=True)
            ],
        },
    )
    return message, points


def stacked(points: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
    return np.stack([points[name].astype(float) for name in "xyz"], axis=-1)


@pytest.mark.parametrize("big", [False, True])
@pytest.mark.parametrize("padding", [0, 3])
@pytest.mark.parametrize("gap", [0, 1, 4])
@pytest.mark.parametrize("size", [(1, 6), (2, 3), (1, 0)])
@pytest.mark.parametrize(
    "fields", [FIELDS, [("z", 7), ("y", 7), ("x", 7)], [("i", 2), ("x", 8), ("y", 8), ("z", 8)]]
)
def test_point_clouds(
    size: tuple[int, int], fields: list[tuple[str, int]], gap: int, padding: int, big: bool
) -> None:
    if size[0] == 1 and padding:
        padding = 0
    message, points = cloud(*size, fields=fields, gap=gap, padding=padding, big=big)
    expected = points if size[0] > 1 else points.reshape(-1)
    places = cw.cloud(message)
    assert places.shape == (*expected.shape, 3)
    assert np.array_equal(places, stacked(expected))
    assert not places.flags.writeable
    together = gap == 0 and fields[0][0] != "z"
    if size[1]:
        assert np.shares_memory(places, message.data) == together
    records = cw.cloud(message, structured=True)
    assert records.shape == expected.shape
    for name, _ in fields:
        assert np.array_equal(records[name], expected[name])
    if size[1]:
        assert np.shares_memory(records, message.data)
    assert np.array_equal(arrays.array(message), places)


def test_fields_with_several_numbers() -> None:
    message = from_dict(
        "sensor_msgs/msg/PointCloud2",
        {
            "height": 1,
            "width": 2,
            "point_step": 24,
            "row_step": 48,
            "data": np.arange(12, dtype="<f4").view(np.uint8),
            "fields": [
                {"name": "position", "offset": 0, "datatype": 7, "count": 3},
                {"name": "normal", "offset": 12, "datatype": 7, "count": 3},
            ],
        },
    )
    records = cw.cloud(message, structured=True)
    assert records["normal"].tolist() == [[3, 4, 5], [9, 10, 11]]
    with raises(ARRAY_INVALID, field="x"):
        cw.cloud(message)


def test_point_clouds_of_ros1() -> None:
    points = [{"x": 1.0, "y": 2.0, "z": 3.0}, {"x": 4.0, "y": 5.0, "z": 6.0}]
    message = from_dict("sensor_msgs/msg/PointCloud", {"points": points})
    assert cw.cloud(message).tolist() == [[1, 2, 3], [4, 5, 6]]
    assert cw.cloud(from_dict("sensor_msgs/msg/PointCloud", {})).shape == (0, 3)


@pytest.mark.parametrize(
    "change",
    [
        {"width": 7},
        {"height": 2},
        {"point_step": 17},
        {"point_step": 0},
        {"row_step": 1},
        {"row_step": 2**32 - 1},
        {"data": np.zeros(5, np.uint8)},
        {"fields": []},
        {"fields": [{"name": "x", "offset": 15, "datatype": 7, "count": 1}]},
        {"fields": [{"name": "x", "offset": 0, "datatype": 9, "count": 1}]},
        {"fields": [{"name": "x", "offset": 0, "datatype": 7, "count": 2**31}]},
        {"fields": [{"name": "", "offset": 0, "datatype": 7, "count": 1}]},
        {"fields": [{"name": "x", "offset": 0, "datatype": 7, "count": 1}] * 2},
    ],
)
def test_hostile_point_clouds_are_refused(change: dict[str, Any]) -> None:
    message, _ = cloud()
    for name, value in change.items():
        if name == "fields":
            value = [from_dict("sensor_msgs/msg/PointField", each) for each in value]  # noqa: PLW2901
        setattr(message, name, value)
    with raises(ARRAY_INVALID, GraphError):
        cw.cloud(message)


# -- other messages


def test_camera_matrices() -> None:
    message = from_dict("sensor_msgs/msg/CameraInfo", {"k": np.arange(9.0)})
    assert cw.camera_matrix(message).tolist() == [[0, 1, 2], [3, 4, 5], [6, 7, 8]]
    message.k = np.zeros(8)
    with raises(ARRAY_INVALID):
        cw.camera_matrix(message)


def test_arrays_of_std_msgs() -> None:
    dims = [{"label": "rows", "size": 2, "stride": 6}, {"label": "columns", "size": 3, "stride": 3}]
    values = {"data": np.arange(7.0), "layout": {"dim": dims, "data_offset": 1}}
    message = from_dict("std_msgs/msg/Float64MultiArray", values)
    assert arrays.array(message).tolist() == [[1, 2, 3], [4, 5, 6]]
    message.layout.dim = []
    assert arrays.array(message).tolist() == list(range(7))
    message = from_dict("std_msgs/msg/Float64MultiArray", {**values, "data": np.arange(6.0)})
    with raises(ARRAY_INVALID):
        arrays.array(message)
    joints = from_dict("sensor_msgs/msg/JointState", {"position": [1.0, 2.0]})
    assert arrays.array(joints).tolist() == [1, 2]
    with raises(ARRAY_INVALID):
        arrays.array(from_dict("std_msgs/msg/String", {"data": "text"}))
    with raises(ARRAY_INVALID):
        arrays.array("text")


def test_the_cameras_of_a_robot() -> None:
    """Every topic with images of the example cart gives the same picture."""
    with cw.World("walls") as world:
        world.spawn("rosbots.xacro")
        raw = world.topic("/rosbots/camera1/image_raw")
        packed = world.topic("/rosbots/camera1/image_raw/compressed")
        info = world.topic("/rosbots/camera1/camera_info")
        world.run(0.1)
        pixels = cw.image(raw.latest)
        assert pixels.shape == (240, 320, 3)
        assert pixels.std() > 5
        decoded = cw.image(packed.latest)
        assert np.abs(decoded.astype(int) - pixels).mean() < 5
        matrix = cw.camera_matrix(info.latest)
        assert matrix[0, 0] == matrix[1, 1] > 0
        assert matrix[2].tolist() == [0, 0, 1]


def test_a_field_that_is_an_array_gives_a_row_for_each_message():
    short, long = (
        from_dict("sensor_msgs/msg/LaserScan", {"ranges": ranges})
        for ranges in ([1.0, np.inf], [1.0, 2.0, 3.0])
    )
    table = arrays.values([short, long], "ranges")
    assert np.array_equal(table, [[1.0, np.inf, np.nan], [1.0, 2.0, 3.0]], equal_nan=True)
    names = from_dict("sensor_msgs/msg/JointState", {"name": ["a", "b"], "position": [1.0, 2.0]})
    assert arrays.values([names], "position").tolist() == [[1.0, 2.0]]
    with raises(FIELD_UNKNOWN, field="name"):
        arrays.values([names], "name")


@pytest.mark.parametrize("convert", [cw.scan, cw.cloud, cw.image, cw.depth, cw.camera_matrix])
def test_no_message_and_one_of_another_type(convert):
    for wrong in (None, from_dict("std_msgs/msg/Bool", {})):
        with raises(ARRAY_INVALID) as caught:
            convert(wrong)
        assert str(caught.value.values["expected"]).startswith("sensor_msgs/")


@pytest.mark.wording
@pytest.mark.parametrize(
    ("field", "expected"),
    [
        ("polygon", "Write polygon.points."),
        (
            "polygon.points",
            "Write polygon.points[0].x, polygon.points[0].y, polygon.points[0].z.",
        ),
        (
            "polygon.points[0]",
            "Write polygon.points[0].x, polygon.points[0].y, polygon.points[0].z.",
        ),
        ("header", "Write header.stamp."),
        ("header.frame_id", None),
    ],
)
def test_a_field_with_messages_states_the_numbers_in_them(field: str, expected: str | None) -> None:
    made = from_dict("geometry_msgs/PolygonStamped", {"polygon": {"points": [{"x": 2.0}]}})
    with raises(FIELD_UNKNOWN, field=field) as caught:
        arrays.values([made], field)
    assert caught.value.hint == expected
    assert arrays.values([made], "polygon.points[0].x").tolist() == [2.0]
