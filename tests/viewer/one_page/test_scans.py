"""Laser scans in a real browser."""

import numpy as np
import pytest
from tests.viewer.conftest import eventually

from cartwheel.description import load_text
from cartwheel.geometry import Pose
from cartwheel.viewer.scans import Scans

TOPIC = "/watch/scan"
WATCH = """<sdf version="1.7"><model name="watch"><static>true</static><link name="eye">
  <sensor name="lidar" type="ray"><update_rate>10</update_rate>
    <ray><scan><horizontal><samples>721</samples><min_angle>-3.1416</min_angle>
      <max_angle>3.1416</max_angle></horizontal></scan>
      <range><min>0.05</min><max>6</max></range></ray>
    <plugin name="laser" filename="libgazebo_ros_laser.so"><topicName>/watch/scan</topicName>
    </plugin></sensor></link></model></sdf>"""
PLACE = Pose.from_xyz_rpy((-1.0, 1.8, 0.25), (0.0, 0.0, 0.7))
POST = (2.4, 0.0, 0.1)
"""Place of the world's square post, and half its width."""


def drawn(arena):
    """The cloud of the scan as the page has it; None without."""
    scans = arena.viewer._desk.panel(Scans)
    cloud = scans._clouds.get(TOPIC)
    return cloud if cloud is not None and len(cloud.points) else None


def test_a_scan_is_drawn_where_it_was_measured_and_read_only_while_it_is_on(page, arena):
    watch = load_text(WATCH, file="watch.sdf")
    arena.ask(lambda: arena.session.spawn(watch, pose=PLACE))
    points = np.array(eventually(lambda: drawn(arena), what="the points").points)
    assert points[:, 2] == pytest.approx(np.full(len(points), 0.25), abs=1e-5)
    x, y, half = POST
    aside = np.abs(points[:, :2] - (x, y)).max(axis=1)
    on_post = aside[aside < 2 * half]
    assert len(on_post) >= 3
    assert on_post == pytest.approx(np.full(len(on_post), half), abs=1e-3)

    page.get_by_text("View", exact=True).click()
    box = page.get_by_label("Laser scans")
    box.click()
    eventually(lambda: "viewer" not in arena.readers(TOPIC), what="the end of the subscription")
    eventually(lambda: drawn(arena) is None, what="a scene without the points")
    box.click()
    eventually(lambda: drawn(arena), what="the points")
