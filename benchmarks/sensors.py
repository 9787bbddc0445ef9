"""Sensors on a driving cart among walls: speed with subscribers, and the cost of the sensor."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from dataclasses import dataclass

import cartwheel as cw
from benchmarks.carts import Listener
from benchmarks.figure import Effort, Figure, medians
from cartwheel.description import load_robot, load_text
from cartwheel.description.model import RobotDescription

_LINK = "base_link"


@dataclass(frozen=True, kw_only=True, slots=True)
class _Sensor:
    title: str
    rate: float
    """Hz."""
    element: str
    """``<sensor>``."""
    topics: tuple[str, ...]
    """The subscribed topics."""
    goal: float
    """Speed, in multiples of real time."""
    each: str
    """The messages of one measurement, in words."""
    note: str = ""


def scanner(
    *, columns: int, rows: int = 1, rate: float, reach: float, output: str = "LaserScan"
) -> str:
    """A lidar on the cart."""
    tall = 0.26 if rows > 1 else 0.0
    return f"""<sensor name="scanner" type="ray"><pose>0 0 0.3 0 0 0</pose>
        <update_rate>{rate}</update_rate>
        <ray><scan>
          <horizontal><samples>{columns}</samples><min_angle>{-math.pi}</min_angle>
            <max_angle>{math.pi}</max_angle></horizontal>
          <vertical><samples>{rows}</samples><min_angle>{-tall}</min_angle>
            <max_angle>{tall}</max_angle></vertical></scan>
          <range><min>0.12</min><max>{reach}</max></range>
          <noise><type>gaussian</type><mean>0</mean><stddev>0.01</stddev></noise></ray>
        <plugin name="scanner" filename="libgazebo_ros_ray_sensor.so">
          <topicName>scan</topicName><output_type>sensor_msgs/{output}</output_type>
        </plugin></sensor>"""


def _rgbd_camera(*, width: int, height: int, rate: float) -> str:
    return f"""<sensor name="kinect" type="depth"><pose>0.6 0 0.3 0 0 0</pose>
        <update_rate>{rate}</update_rate>
        <camera><horizontal_fov>1.05</horizontal_fov>
          <image><width>{width}</width><height>{height}</height><format>R8G8B8</format></image>
          <clip><near>0.05</near><far>20</far></clip></camera>
        <plugin name="kinect" filename="libgazebo_ros_openni_kinect.so">
          <cameraName>kinect</cameraName><imageTopicName>rgb/image_raw</imageTopicName>
          <depthImageTopicName>depth/image_raw</depthImageTopicName>
          <pointCloudTopicName>depth/points</pointCloudTopicName>
          <frameName>kinect</frameName></plugin></sensor>"""


_SENSORS = (
    _Sensor(
        title="laser of 360 rays at 5 Hz",
        rate=5.0,
        element=scanner(columns=360, rate=5.0, reach=3.5),
        topics=("/scan",),
        goal=20 * 5.3,
        each="a scan",
        note="Gazebo 11: 5.3, a TurtleBot3 burger",
    ),
    _Sensor(
        title="laser of 720 rays at 40 Hz",
        rate=40.0,
        element=scanner(columns=720, rate=40.0, reach=30.0),
        topics=("/scan",),
        goal=10.0,
        each="a scan",
    ),
    _Sensor(
        title="lidar of 16 x 1800 rays at 10 Hz",
        rate=10.0,
        element=scanner(columns=1800, rows=16, rate=10.0, reach=100.0, output="PointCloud2"),
        topics=("/scan",),
        goal=1.5,
        each="a cloud of 28,800 points",
    ),
    _Sensor(
        title="RGB-D camera of 640 x 480 at 30 Hz",
        rate=30.0,
        element=_rgbd_camera(width=640, height=480, rate=30.0),
        topics=("/kinect/rgb/image_raw", "/kinect/depth/image_raw", "/kinect/depth/points"),
        goal=1.0,
        each="an image, its depths and a cloud of 307,200 points",
    ),
)


def figures(effort: Effort) -> Iterator[Figure]:
    """The speed with all topics subscribed, and the cost of the sensor alone."""
    for sensor in _SENSORS:
        yield from _measure(sensor, effort)


def _measure(sensor: _Sensor, effort: Effort) -> Iterator[Figure]:
    seconds = effort.seconds / 4
    with _driving(sensor) as read, _driving(sensor) as unread:
        listener = Listener(read, sensor.topics)
        found = medians(
            effort.rounds,
            {"read": lambda: read.run(seconds), "unread": lambda: unread.run(seconds)},
        )
        times = math.floor(sensor.rate * seconds * (effort.rounds + 1))
        assert listener.count >= len(sensor.topics) * times, "messages were dropped"
    cost = max(found["read"] - found["unread"], 1e-9)
    group = f"1 cart among walls, {sensor.title}"
    yield Figure(
        group=group,
        name="speed",
        value=seconds / found["read"],
        unit="x real time",
        goal=sensor.goal,
        better="more",
        note=sensor.note,
    )
    yield Figure(
        group=group,
        name="cost of the sensor",
        value=cost / seconds,
        unit="s per simulated s",
        note=f"{cost / (sensor.rate * seconds) * 1e3:.2f} ms for {sensor.each}",
    )


def _driving(sensor: _Sensor) -> cw.World:
    world = cw.World("walls")
    world.spawn(carrying(sensor.element))
    world.publish("/part2_cmr/cmd_vel", linear_x=0.2, angular_z=0.4)
    world.run(3)
    return world


def carrying(element: str) -> RobotDescription:
    """The shipped cart with a sensor, a ``<sensor>`` element, mounted on it."""
    described = load_text(
        f"""<sdf version="1.7"><model name="carrier"><link name="link">{element}</link>
        </model></sdf>""",
        file="sensor.sdf",
    )
    assert isinstance(described, RobotDescription)
    mounted = dataclasses.replace(described.links[0].sensors[0], link=_LINK)
    cart = load_robot("rosbots.xacro")
    links = tuple(
        dataclasses.replace(link, sensors=(*link.sensors, mounted)) if link.name == _LINK else link
        for link in cart.links
    )
    return dataclasses.replace(cart, links=links)
