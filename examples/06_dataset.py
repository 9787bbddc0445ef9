"""Write images with labels for training, and draw the boxes into one of them."""

import json
import tempfile
from pathlib import Path

from PIL import Image, ImageDraw

import cartwheel as cw
from cartwheel.dataset import Dataset, Viewpoint

folder = Path(tempfile.mkdtemp(prefix="dataset-"))
world = cw.World("empty")
world.spawn("rosbots.xacro")
for number, y in enumerate((-0.6, 0.0, 0.4)):
    world.spawn("object.urdf", name=f"object_{number}", x=1.0 + 0.5 * number, y=y)

above = Viewpoint(name="above", pose=cw.Pose.from_xyz_rpy((-1.7, -1.3, 1.7), (0.0, 0.5, 0.5)))
categories = {"object_*": "object", "ground_plane": None}
cameras = ["rosbots::camera1", above]
with Dataset(folder, world, cameras=cameras, categories=categories) as dataset:
    for _ in range(3):
        world.publish("/part2_cmr/cmd_vel", linear_x=0.3)
        world.run(0.5)
        dataset.capture()

contents = json.loads((folder / "annotations.json").read_text())
names = {each["id"]: each["name"] for each in contents["categories"]}
image = next(each for each in contents["images"] if each["camera"] == "above")
picture = Image.open(folder / image["file_name"])
draw = ImageDraw.Draw(picture)
for each in contents["annotations"]:
    if each["image_id"] == image["id"]:
        x, y, width, height = each["bbox"]
        draw.rectangle((x, y, x + width - 1, y + height - 1), outline="blue", width=2)
        draw.text((x + 4, y + 3), names[each["category_id"]], fill="blue")
        print(f"{names[each['category_id']]}: {width} x {height} pixels, visible {each['visible']}")
picture.save(folder / "boxes.png")
print(f"files in {folder}")
assert len(contents["images"]) == 6
