"""Datasets: their labels are those of the geometry, and the same in each run."""

import hashlib
import json
import math

import numpy as np
import pytest
from PIL import Image
from tests.coded import raises

import cartwheel as cw
from cartwheel import arrays
from cartwheel.codes.command import OUTPUT_NOT_WRITTEN
from cartwheel.codes.world import DATASET_INVALID
from cartwheel.dataset import Dataset, Viewpoint
from cartwheel.geometry import Pose

SIZE = (0.4, 0.6, 0.8)
FRONT = Viewpoint(
    name="front", pose=Pose.from_xyz_rpy((0, 0, 1)), width=320, height=240, fov=1.0, far=20.0
)


def box(name, x, y):
    size = " ".join(map(str, SIZE))
    return f"""<sdf version="1.7"><model name="{name}"><static>true</static>
<pose>{x} {y} 1 0 0 0</pose><link name="body"><visual name="v"><geometry><box><size>{size}</size>
</box></geometry></visual></link></model></sdf>"""


class Yard(cw.World):
    """An empty world in which boxes are added."""

    def __init__(self, folder):
        super().__init__()
        self.folder = folder

    def add(self, name, x, y):
        file = self.folder / f"{name}.sdf"
        file.write_text(box(name, x, y))
        self.spawn(file)


@pytest.fixture
def world(tmp_path):
    with Yard(tmp_path) as made:
        yield made


def corners(x, y):
    """Pixels of the front face's corners: u to the right, v down."""
    focal = FRONT.matrix[0][0]
    depth = x - SIZE[0] / 2
    left, right = ((-(y + side * SIZE[1] / 2)) * focal / depth + 160 for side in (1, -1))
    half = SIZE[2] / 2 * focal / depth
    return left, 120 - half, right, 120 + half


def read(folder):
    contents = json.loads((folder / "annotations.json").read_text())
    objects = {each["id"]: each["name"] for each in contents["objects"]}
    found = {objects[each["object_id"]]: each for each in contents["annotations"]}
    return contents, found


def pixels(folder, kind):
    return np.asarray(Image.open(folder / kind / "front" / "000000.png"))


def test_a_box_is_the_projection_of_its_corners(world, tmp_path):
    world.add("crate", 3.0, 0.0)
    with Dataset(tmp_path / "out", world, cameras=[FRONT]) as made:
        assert made.capture() == 0
    _, found = read(tmp_path / "out")
    crate = found["crate"]
    left, top, right, bottom = corners(3.0, 0.0)
    # A pixel belongs to the box if its centre is in the projection.
    x, y, width, height = crate["bbox"]
    for edge, expected in ((x, left), (y, top), (x + width, right), (y + height, bottom)):
        assert abs(edge - expected) <= 0.5 + 1e-3
    assert crate["area"] == width * height and crate["whole_bbox"] == crate["bbox"]
    assert crate["visible"] == 1.0 and crate["truncated"] is False
    # The background is the ground, which reaches the edges of the image.
    assert found["ground_plane"]["truncated"] is True


def test_depths_are_those_of_rays(world, tmp_path):
    world.add("crate", 3.0, 0.0)
    with Dataset(tmp_path / "out", world, cameras=[FRONT]) as made:
        made.capture()
    depth, instances = pixels(tmp_path / "out", "depth"), pixels(tmp_path / "out", "instances")
    _, found = read(tmp_path / "out")
    assert depth.dtype == instances.dtype == np.uint16
    crate = instances == found["crate"]["object_id"]
    # A ray through a pixel hits the front face; depths are along the camera's axis. Rounding, and
    # the resolution of the depth buffer.
    assert np.abs(depth[crate].astype(float) - (3.0 - SIZE[0] / 2) * 1000).max() <= 1
    # A ray below the horizon hits the ground 1 m below the camera.
    rows, _ = np.nonzero((instances == found["ground_plane"]["object_id"]) & (depth > 0))
    focal = FRONT.matrix[0][0]
    expected = 1000.0 * focal / (rows + 0.5 - 120)
    measured = depth[(instances == found["ground_plane"]["object_id"]) & (depth > 0)]
    assert len(rows) > 10000 and np.allclose(measured, expected, rtol=1e-3, atol=1)
    # Farther than the far distance: no depth.
    assert (depth[:120][instances[:120] == 0] == 0).all() and (instances[:120] == 0).any()


def test_hidden_and_truncated_objects(world, tmp_path):
    world.add("near", 2.0, 0.0)
    world.add("behind", 4.0, 0.7)
    world.add("hidden", 6.0, 0.0)
    world.add("cut", 3.0, 1.6)
    with Dataset(tmp_path / "out", world, cameras=[FRONT]) as made:
        made.capture()
    _, found = read(tmp_path / "out")
    assert "hidden" not in found and found["near"]["visible"] == 1.0
    assert found["cut"]["truncated"] and not found["behind"]["truncated"]
    assert found["cut"]["bbox"][0] == 0
    # The front face of the near box hides what is right of its left edge.
    near, behind = corners(2.0, 0.0), corners(4.0, 0.7)
    whole = found["behind"]["whole_bbox"]
    assert abs(whole[0] - behind[0]) <= 1 and abs(whole[1] - behind[1]) <= 1
    x, _, width, _ = found["behind"]["bbox"]
    assert x == whole[0] and abs(x + width - near[0]) <= 1
    share = found["behind"]["area"] / (whole[2] * whole[3])
    assert found["behind"]["visible"] == pytest.approx(share, abs=0.03) and 0.2 < share < 0.8


def test_a_transparent_object_has_labels_and_no_depth(world, tmp_path):
    glass = box("glass", 2.0, 0.0).replace("</visual>", "<transparency>0.5</transparency></visual>")
    (tmp_path / "glass.sdf").write_text(glass)
    world.spawn(tmp_path / "glass.sdf")
    world.add("crate", 3.0, 0.0)
    with Dataset(tmp_path / "out", world, cameras=[FRONT]) as made:
        made.capture()
    _, found = read(tmp_path / "out")
    assert pixels(tmp_path / "out", "instances")[120, 160] == found["glass"]["object_id"]
    assert abs(int(pixels(tmp_path / "out", "depth")[120, 160]) - 2800) <= 1
    assert "crate" not in found and found["glass"]["visible"] == 1.0


def test_masks_and_numbers(world, tmp_path):
    world.add("brick_a", 3.0, 0.5)
    world.add("brick_b", 3.0, -0.5)
    categories = {"brick_*": "brick", "ground_plane": None}
    with Dataset(tmp_path / "out", world, cameras=[FRONT], categories=categories) as made:
        made.capture()
        world.model("brick_a").delete()
        world.add("cone", 3.0, 0.5)
        made.capture()
    contents, found = read(tmp_path / "out")
    assert contents["categories"] == [{"id": 1, "name": "brick"}, {"id": 2, "name": "cone"}]
    assert [each["name"] for each in contents["objects"]] == ["brick_a", "brick_b", "cone"]
    assert set(found) == {"brick_a", "brick_b", "cone"}
    instances, semantic = (pixels(tmp_path / "out", kind) for kind in ("instances", "semantic"))
    assert set(np.unique(instances)) == {0, 1, 2} and set(np.unique(semantic)) == {0, 1}
    for each in contents["annotations"]:
        if each["image_id"] == 1:
            height, width = each["segmentation"]["size"]
            counts = each["segmentation"]["counts"]
            runs = np.repeat(np.arange(len(counts)) % 2, counts).reshape(width, height).T
            assert np.array_equal(runs == 1, instances == each["object_id"])
            assert each["area"] == runs.sum()
    left = instances[120, 160 - 60], instances[120, 160 + 60]
    assert left == (1, 2)


def drive(folder):
    world = cw.World("post", seed=3)
    world.spawn("rosbots.xacro")
    arm = Viewpoint(
        name="rear", link="rosbots::base_link", pose=Pose.from_xyz_rpy((-1, 0, 0.8), (0, 0.4, 0)),
        width=160, height=120,
    )  # fmt: skip
    cameras = ["rosbots::camera1", arm]
    image = world.topic("/rosbots/camera1/image_raw", keep=1)
    with Dataset(folder, world, cameras=cameras, objects="links") as made:
        for _ in range(2):
            world.publish("/part2_cmr/cmd_vel", linear_x=0.3, angular_z=0.2)
            world.run(0.5)
            made.capture()
    found = arrays.image(image.latest), world.model("rosbots").link("base_link").pose
    world.close()
    return found


def test_a_second_run_writes_the_same_files(tmp_path):
    published, base = drive(tmp_path / "a")
    drive(tmp_path / "b")

    def digests(folder):
        files = sorted(file for file in folder.rglob("*") if file.is_file())
        return {
            str(file.relative_to(folder)): hashlib.sha256(file.read_bytes()).hexdigest()
            for file in files
        }

    assert digests(tmp_path / "a") == digests(tmp_path / "b")
    assert len(digests(tmp_path / "a")) == 2 * 2 * 4 + 2
    # The camera of the robot is the one whose images it publishes; the newest is of this moment.
    written = np.asarray(Image.open(tmp_path / "a" / "images" / "rosbots_camera1" / "000001.png"))
    assert np.array_equal(written, published)
    lines = [json.loads(each) for each in (tmp_path / "a" / "poses.jsonl").read_text().splitlines()]
    assert [each["sample"] for each in lines] == [0, 1] and lines[1]["time"] == pytest.approx(1.0)
    stated = lines[1]["models"]["rosbots"]["links"]["base_link"]
    assert stated == {"position": list(base.position), "orientation": list(base.orientation)}
    rear = lines[1]["cameras"]["rear"]["pose"]["position"]
    assert math.dist(rear, base.apply((-1.0, 0.0, 0.8))) < 1e-12
    _, found = read(tmp_path / "a")
    assert any(name.startswith("rosbots::wheel") for name in found)


def test_scans(tmp_path, world):
    file = tmp_path / "lidar.sdf"
    file.write_text("""<sdf version="1.7"><model name="lidar"><static>true</static>
<pose>0 0 1 0 0 0</pose><link name="link"><sensor name="s" type="ray"><update_rate>10</update_rate>
<ray><scan><horizontal><samples>5</samples><min_angle>-0.1</min_angle><max_angle>0.1</max_angle>
</horizontal></scan><range><min>0.1</min><max>10</max></range></ray>
<plugin name="p" filename="libgazebo_ros_ray_sensor.so"><ros>
<remapping>~/out:=/scan</remapping></ros>
<output_type>sensor_msgs/LaserScan</output_type></plugin></sensor></link></model></sdf>""")
    world.spawn(file)
    world.spawn("box_large.urdf", x=3.0, z=1.0)
    with Dataset(tmp_path / "out", world, scans=["/scan"]) as made:
        world.run(0.3)
        made.capture()
    with np.load(tmp_path / "out" / "scans" / "scan" / "000000.npz") as found:
        assert found["ranges"].shape == found["angles"].shape == (5,)
        assert found["limits"].tolist() == pytest.approx([0.1, 10.0])


def test_mistakes(world, tmp_path):
    bad = [{"name": "a/b"}, {"width": 0}, {"fov": 4.0}, {"near": 2.0, "far": 1.0}, {"height": 1.5}]
    for each in bad:
        with raises(DATASET_INVALID):
            Viewpoint(**{"name": "a", "pose": Pose(), **each})
    for options in ({}, {"cameras": [FRONT, FRONT]}, {"cameras": ["ground_plane::eye"]}, {
        "cameras": [FRONT], "objects": "geoms",
    }):  # fmt: skip
        with raises(DATASET_INVALID):
            Dataset(tmp_path / "out", world, **options)
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "file").touch()
    with raises(DATASET_INVALID):
        Dataset(tmp_path / "full", world, cameras=[FRONT])
    with raises(OUTPUT_NOT_WRITTEN):
        Dataset(tmp_path / "full" / "file", world, cameras=[FRONT])
    made = Dataset(tmp_path / "out", world, cameras=[FRONT])
    made.close()
    with raises(DATASET_INVALID):
        made.capture()
