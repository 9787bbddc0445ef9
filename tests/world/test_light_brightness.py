"""Lamps over a floor: as bright as distance and slant make it, wherever its own corners are."""

import math

import numpy as np
import pytest

import cartwheel as cw
from cartwheel.description import load_text

WORLD = """<sdf version="1.7"><world name="w"><scene><ambient>0 0 0 1</ambient></scene>
  <light type="{kind}" name="lamp"><pose>0 0 1.5 0 0 0</pose>
    <diffuse>{glow} {glow} {glow} 1</diffuse>
    <direction>0 0 -1</direction><attenuation><range>20</range><constant>1</constant>
    <linear>0.2</linear><quadratic>0.1</quadratic></attenuation>
    <spot><inner_angle>{inner}</inner_angle><outer_angle>1.6</outer_angle>
      <falloff>{falloff}</falloff></spot>
  </light>
  <model name="floor"><static>1</static><link name="l"><visual name="v"><geometry><plane>
    <normal>0 0 1</normal><size>16 12</size></plane></geometry>
    <material><diffuse>0.6 0.6 0.6 1</diffuse></material></visual></link></model>
  <model name="eye"><static>1</static><pose>0 0 5 0 1.5707963 0</pose><link name="l">
    <sensor name="cam" type="camera"><update_rate>10</update_rate><camera>
    <horizontal_fov>1.5707963</horizontal_fov><image><width>200</width><height>200</height></image>
    <clip><near>0.1</near><far>20</far></clip></camera>
    <plugin name="p" filename="libgazebo_ros_camera.so"/></sensor></link></model>
  </world></sdf>"""


SHARP = {"inner": 1.6, "falloff": 1}


def picture(*, glow=0.9, **values):
    with cw.World(load_text(WORLD.format(glow=glow, **values), file="lamp.world")) as world:
        box = world.mailbox("/cam/image_raw")
        world.run(0.1)
        return np.asarray(box.drain()[-1].data).reshape(200, 200, 3)[..., 0].astype(float)


@pytest.mark.parametrize("kind", ["point", "spot"])
def test_a_floor_is_lit_as_its_distance_says(kind):
    """Lambert's law and the attenuation of SDF; the camera's own light is taken off."""
    lit = picture(kind=kind, **SHARP) - picture(kind=kind, **SHARP, glow=0.0)
    height, colour = 1.5, 0.6
    column = lit[:, 100]
    aside = (np.arange(200) + 0.5 - 100) / 100 * 5.0
    away = np.hypot(aside, height)
    strength = 0.9 * colour * (height / away) / (1 + 0.2 * away + 0.1 * away**2)
    if kind == "spot":
        edge = height * math.tan(0.8)
        outside = np.abs(aside) > edge + 0.3
        assert np.abs(column[outside]).max() <= 1
        # Cells have a diagonal of 28 cm.
        inside = np.abs(aside) < edge - 0.3
        assert column[inside] == pytest.approx(255 * strength[inside], abs=4)
    else:
        assert column == pytest.approx(255 * strength, abs=4)


@pytest.mark.parametrize("falloff", [0.5, 1, 2])
def test_a_spot_fades_from_its_inner_to_its_outer_edge(falloff):
    """Half-way between them it has 0.5 to the falloff of what it would have without."""
    soft = {"inner": 0.4, "falloff": falloff}
    sharp = picture(kind="spot", **SHARP) - picture(kind="spot", **SHARP, glow=0.0)
    faded = picture(kind="spot", **soft) - picture(kind="spot", **soft, glow=0.0)
    # Its edges are 0.2 and 0.8 rad off its axis; a pixel is 5 cm wide there.
    place = 100 + round(1.5 * math.tan(0.5) / 5.0 * 100)
    assert faded[place, 100] == pytest.approx(sharp[place, 100] * 0.5**falloff, abs=6)
    assert faded[100, 100] == pytest.approx(sharp[100, 100], abs=4)
