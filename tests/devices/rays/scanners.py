"""A post with a laser scanner, for the tests of scans."""

import math

import numpy as np

from cartwheel.geometry import Pose

HEIGHT = 0.5
"""m, of the sensor above the ground."""


def sensor(
    *,
    samples=181,
    low=-math.pi / 2,
    high=math.pi / 2,
    least=0.1,
    most=10.0,
    rate=10,
    resolution=1,
    vertical="",
    noise="",
    pose="0 0 0 0 0 0",
    kind="ray",
    plugin="libgazebo_ros_laser.so",
    tags="<topicName>scan</topicName><frameName>laser</frameName>",
):
    return f"""
    <sensor name="lidar" type="{kind}"><pose>{pose}</pose><update_rate>{rate}</update_rate>
      <ray><scan><horizontal><samples>{samples}</samples><resolution>{resolution}</resolution>
        <min_angle>{low}</min_angle><max_angle>{high}</max_angle></horizontal>{vertical}</scan>
        <range><min>{least}</min><max>{most}</max></range>{noise}</ray>
      <plugin name="laser" filename="{plugin}">{tags}</plugin>
    </sensor>"""


def model(sensor_text, *, bodies="", pose=f"0 0 {HEIGHT} 0 0 0"):
    """A post that stands still with a scanner at its frame."""
    return f"""
    <model name="post"><static>true</static><pose>{pose}</pose>
      <link name="laser">{bodies}{sensor_text}</link></model>"""


def box(name, size, pose="0 0 0 0 0 0", *, visual=False, retro=None):
    kind = "visual" if visual else "collision"
    reported = f"<laser_retro>{retro}</laser_retro>" if retro is not None else ""
    return f"""<{kind} name="{name}"><pose>{pose}</pose>{reported}
      <geometry><box><size>{size}</size></box></geometry></{kind}>"""


def scans(world, seconds=0.05, topic="/scan"):
    inbox = world.mailbox(topic, size=10_000)
    world.run(seconds)
    inbox.close()
    return inbox.drain()


def scan(world, topic="/scan"):
    return scans(world, 0.2, topic)[0]


def angles(message):
    return message.angle_min + np.arange(len(message.ranges)) * message.angle_increment


def wall(make, distance, *, width=50.0, name="wall"):
    """Across the x axis; its near face at `distance`."""
    return make.box(name, (1.0, width, 4.0), static=True, pose=Pose((distance + 0.5, 0, 0)))


NOISE = "<noise><type>gaussian</type><mean>{mean}</mean><stddev>{stddev}</stddev></noise>"
