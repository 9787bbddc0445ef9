"""A camera on a post, and the outline of a box in its image."""

import math

import numpy as np

RED = (0.9, 0.05, 0.05)

SKY = 178
"""Gazebo's 0.7 as a byte."""


def camera(
    *,
    pose="0 0 1 0 0 0",
    width=320,
    height=240,
    fov=1.04,
    near=0.1,
    far=50.0,
    form="R8G8B8",
    rate=30,
    plugin="",
    inside="",
):
    """A camera that stands in the air."""
    return f"""
    <model name="eye"><static>1</static><pose>{pose}</pose><link name="link">
      <sensor name="cam" type="camera"><update_rate>{rate}</update_rate>
        <camera><horizontal_fov>{fov}</horizontal_fov>
          <image><width>{width}</width><height>{height}</height><format>{form}</format></image>
          <clip><near>{near}</near><far>{far}</far></clip>{inside}
        </camera>
        <plugin name="p" filename="libgazebo_ros_camera.so">{plugin}</plugin>
      </sensor></link></model>"""


def look(world, topic="/cam/image_raw"):
    """The next image, as an array."""
    message = take(world, topic)
    return np.asarray(message.data).reshape(message.height, message.width, -1)


def take(world, topic):
    box = world.mailbox(topic, size=100)
    while not (messages := box.drain()):
        world.run(0.005)
    box.close()
    return messages[0]


def reds(pixels):
    pixels = pixels.astype(int)
    return (pixels[..., 0] > 60) & (pixels[..., 0] > 3 * pixels[..., 1])


def silhouette(eye, box_pose, size, *, width, height, fov):
    """Left, right, top and bottom of a box in pixels from the image's corner."""
    focal = width / (2 * math.tan(fov / 2))
    columns, rows = [], []
    for corner in np.ndindex(2, 2, 2):
        point = [(index - 0.5) * edge for index, edge in zip(corner, size, strict=True)]
        x, y, z = eye.inverse().apply(box_pose.apply(point))
        assert x > 0
        columns.append(width / 2 - focal * y / x)
        rows.append(height / 2 - focal * z / x)
    return min(columns), max(columns), min(rows), max(rows)
