"""Laser scanners on a driving cart among walls: every scan delivered, and what one costs."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import cartwheel as cw
from benchmarks.carts import Listener
from benchmarks.figure import Effort, Figure, medians
from cartwheel.description import load_robot, load_text
from cartwheel.description.model import RobotDescription

_LINK = "base_link"


@dataclass(frozen=True, kw_only=True, slots=True)
class _Scanner:
    title: str
    columns: int
    rows: int = 1
    rate: float
    """Hz."""
    output: Literal["LaserScan", "PointCloud2"] = "LaserScan"
    reach: float
    """m."""
    goal: float
    """Times real time."""
    note: str = ""


_SCANNERS = (
    _Scanner(
        title="scan of 360 rays at 5 Hz",
        columns=360,
        rate=5.0,
        reach=3.5,
        goal=20 * 5.3,
        note="Gazebo 11: 5.3, a TurtleBot3 burger",
    ),
    _Scanner(title="scan of 1080 rays at 40 Hz", columns=1080, rate=40.0, reach=30.0, goal=10.0),
    _Scanner(
        title="cloud of 16 x 1800 rays at 10 Hz",
        columns=1800,
        rows=16,
        rate=10.0,
        output="PointCloud2",
        reach=100.0,
        goal=1.5,
    ),
)


def figures(effort: Effort) -> Iterator[Figure]:
    """The speed with all scans read, and the time of one scan."""
    for scanner in _SCANNERS:
        yield from _measure(scanner, effort)


def _measure(scanner: _Scanner, effort: Effort) -> Iterator[Figure]:
    seconds = effort.seconds / 2
    with _driving(scanner) as read, _driving(scanner) as unread:
        listener = Listener(read, ("/scan",))
        found = medians(
            effort.rounds,
            {"read": lambda: read.run(seconds), "unread": lambda: unread.run(seconds)},
        )
        simulated = seconds * (effort.rounds + 1)
        assert listener.count >= math.floor(scanner.rate * simulated), "scans were lost"
    group = f"1 cart among walls, {scanner.title}"
    yield Figure(
        group=group,
        name="speed",
        value=seconds / found["read"],
        unit="x real time",
        goal=scanner.goal,
        better="more",
        note=scanner.note,
    )
    yield Figure(
        group=group,
        name="one scan",
        value=max(found["read"] - found["unread"], 1e-9) / (scanner.rate * seconds) * 1e6,
        unit="us",
        note=f"{scanner.columns * scanner.rows} rays, message included",
    )


def _driving(scanner: _Scanner) -> cw.World:
    world = cw.World("walls")
    world.spawn(_cart(scanner))
    world.publish("/part2_cmr/cmd_vel", linear_x=0.2, angular_z=0.4)
    world.run(3)
    return world


def _cart(scanner: _Scanner) -> RobotDescription:
    """The shipped cart with a scanner a little above it."""
    described = load_text(_sensor(scanner), file="scanner.sdf")
    assert isinstance(described, RobotDescription)
    sensor = dataclasses.replace(described.links[0].sensors[0], link=_LINK)
    cart = load_robot("rosbots.xacro")
    links = tuple(
        dataclasses.replace(link, sensors=(*link.sensors, sensor)) if link.name == _LINK else link
        for link in cart.links
    )
    return dataclasses.replace(cart, links=links)


def _sensor(scanner: _Scanner) -> str:
    tall = 0.26 if scanner.rows > 1 else 0.0
    return f"""<sdf version="1.7"><model name="scanner"><link name="link">
      <sensor name="scanner" type="ray"><pose>0 0 0.3 0 0 0</pose>
        <update_rate>{scanner.rate}</update_rate>
        <ray><scan>
          <horizontal><samples>{scanner.columns}</samples><min_angle>{-math.pi}</min_angle>
            <max_angle>{math.pi}</max_angle></horizontal>
          <vertical><samples>{scanner.rows}</samples><min_angle>{-tall}</min_angle>
            <max_angle>{tall}</max_angle></vertical></scan>
          <range><min>0.12</min><max>{scanner.reach}</max></range>
          <noise><type>gaussian</type><mean>0</mean><stddev>0.01</stddev></noise></ray>
        <plugin name="scanner" filename="libgazebo_ros_ray_sensor.so">
          <topicName>scan</topicName><output_type>sensor_msgs/{scanner.output}</output_type>
        </plugin></sensor></link></model></sdf>"""
