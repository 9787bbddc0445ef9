"""Makes docs/images/cart.webp: the cart drives to a post and back, with the image of its camera.

Run: python tools/make_animation.py [FILE]

Cartwheel's own cameras render all frames: one beside the scene, and the cart's.
"""

from __future__ import annotations

import io
import sys
import tempfile
from pathlib import Path
from typing import Any

from PIL import Image

import cartwheel as cw

TARGET = Path(__file__).resolve().parent.parent / "docs" / "images" / "cart.webp"
LARGEST = 1_200_000
"""Bytes."""
QUALITIES = (75, 65, 55, 45)
RATE = 15
"""Frames per second."""
WIDTH, HEIGHT = 960, 540
INSET = (256, 192)
"""Size of the image of the cart's camera in pixels."""
MARGIN = 12
"""Pixels between that image and the edges."""
OBSERVER = f"""<sdf version="1.6"><model name="observer"><static>true</static><link name="link">
  <sensor name="camera" type="camera"><always_on>true</always_on><update_rate>{RATE}</update_rate>
    <camera><horizontal_fov>0.95</horizontal_fov>
      <image><width>{WIDTH}</width><height>{HEIGHT}</height><format>R8G8B8</format></image>
      <clip><near>0.05</near><far>60</far></clip></camera>
    <plugin name="camera" filename="libgazebo_ros_camera.so">
      <cameraName>observer</cameraName><imageTopicName>image</imageTopicName>
      <cameraInfoTopicName>info</cameraInfoTopicName><frameName>link</frameName></plugin>
  </sensor></link></model></sdf>"""
THINGS = (
    ("traffic_cone", 1.7, -1.0),
    ("barrel.urdf", 2.6, 1.4),
    ("box_medium.urdf", 0.5, 1.6),
)
"""Models beside the way, with x and y in m."""
DRIVE = (
    (0.5, 0.9, 1.0),
    (0.5, -0.9, 1.3),
    (0.5, 0.0, 2.4),
    (-0.5, 0.0, 1.2),
    (-0.4, 0.9, 1.5),
    (0.0, 0.0, 0.6),
)
"""Linear velocity in m/s, angular velocity in rad/s, and for how many s."""


def picture(message: Any) -> Image.Image:
    """The image of an RGB camera's message."""
    return Image.fromarray(message.data.reshape(message.height, message.width, 3))


def frames(observer: Path) -> list[Image.Image]:
    """Drives, and returns one image for each 1 / RATE s.

    Args:
        observer: File of the model with the camera beside the scene.
    """
    images = []
    with cw.World("post") as world:
        cart = world.spawn("rosbots.xacro", z=0.1)
        for name, x, y in THINGS:
            world.spawn(name, x=x, y=y, z=0.01)
        world.spawn(str(observer), x=-2.1, y=-2.3, z=1.7, pitch=0.36, yaw=0.66)
        scenes = world.mailbox("/observer/image", size=1)
        views = world.mailbox("/rosbots/camera1/image_raw", size=1)
        world.run(seconds=0.5)
        for linear, angular, seconds in DRIVE:
            cart.publish("/part2_cmr/cmd_vel", linear_x=linear, angular_z=angular)
            for _ in range(round(seconds * RATE)):
                world.run(seconds=1 / RATE)
                images.append(composed(picture(scenes.get()), picture(views.get())))
    return images


def composed(scene: Image.Image, view: Image.Image) -> Image.Image:
    """The scene with the cart's view in a white frame at the lower right."""
    framed = Image.new("RGB", (INSET[0] + 4, INSET[1] + 4), "white")
    framed.paste(view.resize(INSET), (2, 2))
    corner = (WIDTH - framed.width - MARGIN, HEIGHT - framed.height - MARGIN)
    scene.paste(framed, corner)
    return scene


def encoded(images: list[Image.Image]) -> bytes:
    """The images as an animated WebP, at the best quality that LARGEST allows."""
    for quality in QUALITIES:
        out = io.BytesIO()
        images[0].save(
            out,
            "WEBP",
            save_all=True,
            append_images=images[1:],
            duration=round(1000 / RATE),
            loop=0,
            quality=quality,
            method=4,
        )
        if out.tell() <= LARGEST:
            return out.getvalue()
    raise SystemExit(f"the animation is larger than {LARGEST} bytes at any quality")


def main() -> None:
    """Runs it."""
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else TARGET
    with tempfile.TemporaryDirectory() as folder:
        observer = Path(folder) / "observer.sdf"
        observer.write_text(OBSERVER)
        images = frames(observer)
    target.write_bytes(encoded(images))
    print(f"{target.name}: {len(images)} frames, {target.stat().st_size} bytes")


if __name__ == "__main__":
    main()
