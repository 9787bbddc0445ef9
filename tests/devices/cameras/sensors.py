"""Camera sensors and their messages, for tests."""

import math

import numpy as np

RED = (0.9, 0.05, 0.05)

SKY = 178
"""Gazebo's 0.7 as a byte."""


def sensor(
    *,
    kind="camera",
    name="cam",
    pose="0 0 1 0 0 0",
    width=320,
    height=240,
    fov=1.04,
    near=0.1,
    far=50.0,
    form="R8G8B8",
    rate=30,
    inside="",
    lenses=None,
    plugin="",
    filename="libgazebo_ros_camera.so",
    more="",
):
    """A model with one camera sensor; `lenses` are the insides of several cameras, by name."""
    tag = f'<plugin name="p" filename="{filename}">{plugin}</plugin>' if filename else ""
    cameras = "".join(
        f"""<camera name="{lens}"><horizontal_fov>{fov}</horizontal_fov>
          <image><width>{width}</width><height>{height}</height><format>{form}</format></image>
          <clip><near>{near}</near><far>{far}</far></clip>{inner}
        </camera>"""
        for lens, inner in (lenses or {"lens": inside}).items()
    )
    return f"""
    <model name="{name}_eye"><static>1</static><pose>{pose}</pose><link name="link">
      <sensor name="{name}" type="{kind}"><update_rate>{rate}</update_rate>{more}
        {cameras}{tag}
      </sensor></link></model>"""


def take(world, topic):
    """The next message."""
    box = world.mailbox(topic, size=100)
    while not (messages := box.drain()):
        world.run(0.005)
    box.close()
    return messages[0]


def pixels_of(message):
    return np.asarray(message.data).reshape(message.height, message.width, -1)


def depths_of(message):
    return np.asarray(message.data).view("<f4").reshape(message.height, message.width)


def cloud_of(message):
    """x, y, z, rgb of an organised cloud, by the fields that it states."""
    layout = np.dtype(
        {
            "names": [field.name for field in message.fields],
            "formats": [{7: "<f4"}[field.datatype] for field in message.fields],
            "offsets": [field.offset for field in message.fields],
            "itemsize": message.point_step,
        }
    )
    assert message.row_step == message.point_step * message.width
    return np.asarray(message.data).view(layout).reshape(message.height, message.width)


def reds(pixels):
    pixels = pixels.astype(int)
    return (pixels[..., 0] > 60) & (pixels[..., 0] > 3 * pixels[..., 1])


def focal(width=320, fov=1.04):
    return width / (2 * math.tan(fov / 2))


def rays(width=320, height=240, fov=1.04):
    """What each pixel's middle looks at at depth 1: right, down."""
    f = focal(width, fov)
    right = (np.arange(width) + 0.5 - width / 2) / f
    down = (np.arange(height) + 0.5 - height / 2) / f
    return np.meshgrid(right, down)


def service_names(world):
    return {service.name for service in world.session.graph.services()}


def topic_names(world):
    return {topic.name for topic in world.session.graph.topics()}
