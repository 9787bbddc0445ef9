"""A lidar before a wall, and the points at which its rays meet the wall."""

import numpy as np

HEIGHT = 1.0

AZIMUTHS = np.linspace(-0.5, 0.5, 11)

ELEVATIONS = np.linspace(-0.3, 0.2, 6)

DISTANCE = 2.0
"""m, of the wall: near enough that no row meets the ground first."""


def lidar(filename, tags, *, rays="", retro=7, kind="ray", most=10.0):
    """Eleven columns by six rows, and a wall across the x axis in the same model."""
    return f"""<model name="post"><static>true</static><pose>0 0 {HEIGHT} 0 0 0</pose>
      <link name="head">
      <collision name="wall"><pose>{DISTANCE + 0.5} 0 0 0 0 0</pose>
        <laser_retro>{retro}</laser_retro>
        <geometry><box><size>1 40 40</size></box></geometry></collision>
      <sensor name="lidar" type="{kind}"><update_rate>10</update_rate>
        <ray><scan>
          <horizontal><samples>11</samples><min_angle>-0.5</min_angle><max_angle>0.5</max_angle>
          </horizontal>
          <vertical><samples>6</samples><min_angle>-0.3</min_angle><max_angle>0.2</max_angle>
          </vertical></scan>
          <range><min>0.1</min><max>{most}</max></range>{rays}</ray>
        <plugin name="cloud" filename="{filename}"><frameName>optic</frameName>{tags}</plugin>
      </sensor></link></model>"""


def world_of(make, filename, tags="", **more):
    return make.world(make.sdf(lidar(filename, tags, **more)), seed=4)


def messages(world, topic, seconds=0.2):
    inbox = world.mailbox(topic, size=1000)
    world.run(seconds)
    inbox.close()
    return inbox.drain()


def on_the_wall():
    """Where each ray meets the wall, shape (rows, columns, 3)."""
    azimuth, elevation = np.meshgrid(AZIMUTHS, ELEVATIONS)
    return DISTANCE * np.stack(
        [np.ones_like(azimuth), np.tan(azimuth), np.tan(elevation) / np.cos(azimuth)], axis=-1
    )


def fields(message):
    """Those of a PointCloud2 by name, each of shape (height, width), by its own layout."""
    kinds = {4: "<u2", 7: "<f4"}
    layout = np.dtype(
        {
            "names": [field.name for field in message.fields],
            "formats": [kinds[field.datatype] for field in message.fields],
            "offsets": [field.offset for field in message.fields],
            "itemsize": message.point_step,
        }
    )
    assert len(message.data) == message.row_step * message.height
    assert message.row_step == message.point_step * message.width
    assert not message.is_bigendian
    return message.data.view(layout).reshape(message.height, message.width)


def places(cloud):
    return np.stack([cloud["x"], cloud["y"], cloud["z"]], axis=-1)
