"""Lights on links: where they are while their link moves, and what cameras see by them."""

import math

import numpy as np
import pytest
from tests.devices.cameras.posts import camera, look

from cartwheel.geometry import Pose

LAMP = """<light name="lamp" type="{kind}"><pose>0.1 0 0 0 0 0</pose><direction>1 0 0</direction>
  <diffuse>0.8 0.8 0.8 1</diffuse>{more}<attenuation><range>20</range><constant>1</constant>
  <linear>0</linear><quadratic>0</quadratic></attenuation>
  <spot><inner_angle>0.6</inner_angle><outer_angle>0.6</outer_angle></spot></light>"""


def carrier(kind="spot", more="", pose="0 0 1 0 0 0"):
    return f"""<model name="cart"><pose>{pose}</pose><link name="base"><gravity>0</gravity>
      {LAMP.format(kind=kind, more=more)}</link></model>"""


def test_a_light_moves_with_its_link(make):
    world = make.world(make.sdf(carrier()), ground=None)
    simulation = world.session.simulation
    simulation.set_pose("cart", Pose.from_xyz_rpy((3, 2, 1), (0, 0, math.pi / 2)))
    light = simulation.data.light("cart::base::lamp")
    assert light.xpos == pytest.approx((3, 2.1, 1))
    assert light.xdir == pytest.approx((0, 1, 0), abs=1e-9)


@pytest.mark.parametrize(
    ("kind", "more", "lit"),
    [
        ("spot", "", 0.8),
        ("point", "", 0.8),
        ("spot", "<intensity>0.5</intensity>", 0.4),
        ("spot", "<light_on>false</light_on>", 0.0),
    ],
)
def test_a_camera_sees_by_the_light_that_it_carries(make, kind, more, lit):
    """A white wall, met squarely: with the lamp it shows the lamp's diffuse brighter."""
    wall = make.box("wall", (0.1, 4, 4), static=True, pose=Pose((4, 0, 1)), colour=(0.6, 0.6, 0.6))

    def centre(*models):
        world = make.world(wall, make.sdf(camera(pose="0 0 1 0 0 0")), *models, ground=None)
        return float(np.mean(look(world)[110:130, 150:170]))

    dark = centre()
    seen = centre(make.sdf(carrier(kind, more)))
    assert (seen - dark) / 255 / 0.6 == pytest.approx(lit, abs=0.05)
