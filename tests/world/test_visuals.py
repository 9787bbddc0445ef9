"""How things look in a camera: images laid on them as Gazebo lays them, glow and transparency."""

import math

import numpy as np
import pytest
from PIL import Image
from tests.devices.cameras.sensors import SKY, pixels_of, sensor, take

from cartwheel.geometry import Pose

RED, GREEN, BLUE, YELLOW = (255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 0)
UPRIGHT = ((RED, GREEN), (BLUE, YELLOW))
"""The picture's quarters, row by row."""
FAR = 4.0
"""m, of a camera from the middle of what it looks at."""
FROM = {
    # Along which axis, seen from outside; roll, pitch, yaw of the camera.
    "behind": ((-1, 0, 0), (0, 0, 0)),
    "ahead": ((1, 0, 0), (0, 0, math.pi)),
    "left": ((0, 1, 0), (0, 0, -math.pi / 2)),
    "right": ((0, -1, 0), (0, 0, math.pi / 2)),
    # With what is ahead at the upper edge; from below what is behind.
    "above": ((0, 0, 1), (0, math.pi / 2, 0)),
    "below": ((0, 0, -1), (0, -math.pi / 2, 0)),
    # With the left, y, at the upper edge.
    "above_y_up": ((0, 0, 1), (0, math.pi / 2, math.pi / 2)),
}


@pytest.fixture
def picture(tmp_path):
    """A script's ``<material>``, by more that its texture unit says."""
    rows = [np.repeat([row], 256, axis=0).repeat(256, axis=1) for row in np.array(UPRIGHT)]
    Image.fromarray(np.concatenate(rows).astype(np.uint8)).save(tmp_path / "quarters.png")

    def material(more="", passes="", inside=""):
        (tmp_path / "test.material").write_text(
            f"""material Test/Quarters {{ technique {{ pass {{ {passes}
              texture_unit {{
                texture quarters.png
                {more}
              }} }} }} }}"""
        )
        return f"""<material><script><uri>file://{tmp_path}</uri><name>Test/Quarters</name>
          </script>{inside}</material>"""

    return material


def thing(shape, material, more="", name="thing"):
    return f"""<model name="{name}"><static>1</static><link name="link"><visual name="v">
      <geometry>{shape}</geometry>{material}{more}</visual></link></model>"""


def eye(side):
    (x, y, z), (roll, pitch, yaw) = FROM[side]
    place = " ".join(str(FAR * part) for part in (x, y, z))
    pose = f"{place} {roll} {pitch} {yaw}"
    return sensor(pose=pose, name=side, width=64, height=64, fov=0.5)


def views(make, model, *sides):
    world = make.world(make.sdf(model), *(make.sdf(eye(side)) for side in sides), ground=None)
    return [pixels_of(take(world, f"/{side}/image_raw")) for side in sides]


def quarters(image, across=0.125):
    """The colours at four points about the middle, each channel on or off."""
    middle, off = len(image) / 2, across * len(image)
    low, high = int(middle - off), int(middle + off)
    return tuple(tuple(tuple(255 * (image[v, u] > 40)) for u in (low, high)) for v in (low, high))


def test_an_image_stands_upright_on_each_side_of_a_box(make, picture):
    sides = ("behind", "ahead", "left", "right", "above", "below")
    box = thing("<box><size>1 1 1</size></box>", picture())
    for side, image in zip(sides, views(make, box, *sides), strict=True):
        assert quarters(image) == UPRIGHT, side


@pytest.mark.parametrize("size", ["1 1", "60 60"])
def test_an_image_on_a_plane_has_x_to_the_right_and_y_up(make, picture, size):
    """Whole, over all of it, however large it is."""
    plane = thing(f"<plane><normal>0 0 1</normal><size>{size}</size></plane>", picture())
    (image,) = views(make, plane, "above_y_up")
    assert quarters(image) == UPRIGHT


def test_an_image_goes_around_a_sphere_about_y(make, picture):
    """Its left and right edge meet above."""
    ball = thing("<sphere><radius>0.5</radius></sphere>", picture())
    (image,) = views(make, ball, "above_y_up")
    assert quarters(image) == ((GREEN, RED), (YELLOW, BLUE))


def test_an_image_goes_around_a_cylinder_upside_down(make, picture):
    """Its edges meet at the left side; it is turned by half a turn there, not mirrored."""
    can = thing("<cylinder><radius>0.5</radius><length>1</length></cylinder>", picture())
    (image,) = views(make, can, "left")
    assert quarters(image, across=0.0625) == ((BLUE, YELLOW), (RED, GREEN))


def test_a_scale_lays_several_copies_about_the_middle(make, picture):
    """At half the size one copy fills the middle, and a quarter of another is in each corner."""
    box = thing("<box><size>1 1 1</size></box>", picture("scale 0.5 0.5"))
    (image,) = views(make, box, "behind")
    # A face of 1 m at 3.5 m is 0.5 / tan(0.25) / 3.5 of half the picture wide.
    half = 0.5 / 3.5 / math.tan(0.25) / 2
    assert quarters(image, across=half / 4) == UPRIGHT
    assert quarters(image, across=half * 3 / 4) == ((YELLOW, BLUE), (GREEN, RED))


def test_an_image_is_coloured_by_the_diffuse_colour(make, picture):
    """Red light on the quarters: green and blue are dark, yellow is red."""
    red = picture(inside="<diffuse>1 0 0 1</diffuse>")
    (image,) = views(make, thing("<box><size>1 1 1</size></box>", red), "behind")
    assert quarters(image) == ((RED, (0, 0, 0)), ((0, 0, 0), RED))


def test_an_ambient_colour_does_not_colour_an_image(make, picture):
    dark = picture(passes="ambient 0 0 0 1\n")
    (image,) = views(make, thing("<box><size>1 1 1</size></box>", dark), "behind")
    assert quarters(image) == UPRIGHT


BLACK = "<material><ambient>0 0 0 1</ambient><diffuse>0 0 0 1</diffuse>{}</material>"


@pytest.mark.parametrize("transparency", [0.2, 0.5, 0.8])
def test_the_sky_and_things_show_through_what_is_transparent(make, transparency):
    """Black glass of that transparency lets that part of the light through."""
    glass = make.sdf(
        thing(
            "<box><size>0.1 1 1</size></box>",
            BLACK.format(""),
            f"<transparency>{transparency}</transparency>",
        )
    )
    wall = make.box("wall", (0.1, 0.2, 8), static=True, pose=Pose((1, 0, 0)))
    world = make.world(glass, wall, make.sdf(eye("behind")), ground=None)
    image = pixels_of(take(world, "/behind/image_raw")).astype(int)
    assert tuple(image[32, 2]) == (SKY,) * 3
    assert image[32, 24] == pytest.approx(SKY * transparency, abs=2)
    # The wall beside the glass and behind it.
    assert image[32, 32] == pytest.approx(image[2, 32] * transparency, abs=2)


def test_what_is_opaque_hides_a_transparent_thing_and_the_sky(make):
    glass = make.sdf(
        thing(
            "<box><size>0.1 1 1</size></box>", BLACK.format(""), "<transparency>0.5</transparency>"
        )
    )
    wall = make.box("wall", (0.1, 2, 2), static=True, pose=Pose((-1, 0, 0)))

    def seen(*models):
        world = make.world(wall, make.sdf(eye("behind")), *models, ground=None)
        return pixels_of(take(world, "/behind/image_raw"))

    assert np.array_equal(seen(), seen(glass))


@pytest.mark.parametrize(
    "material",
    [
        BLACK.format("<emissive>1 0 0 1</emissive>"),
        "<material><script><name>Gazebo/RedGlow</name></script></material>",
    ],
)
def test_what_glows_is_seen_in_the_dark(make, material):
    (image,) = views(make, thing("<box><size>1 1 1</size></box>", material), "behind")
    assert image[32, 32] == pytest.approx((255, 0, 0), abs=3)


def test_the_sky_is_whole_around_something_transparent(make):
    """Up to the picture's edges, with a far plane that is near."""
    pane = thing(
        "<box><size>0.1 0.2 0.2</size></box>", BLACK.format(""), "<transparency>0.5</transparency>"
    )
    look = sensor(pose=f"-{FAR} 0 0 0 0 0", width=40, height=64, fov=0.3, far=1.5 * FAR)
    world = make.world(make.sdf(pane), make.sdf(look), ground=None)
    image = pixels_of(take(world, "/cam/image_raw"))
    assert set(image[0].ravel()) == set(image[:, 0].ravel()) == set(image[:, -1].ravel()) == {SKY}
    assert image[32, 20] == pytest.approx(SKY / 2, abs=2)


def test_white_glass_before_a_white_sky_is_white(make):
    white = """<material><diffuse>1 1 1 1</diffuse><emissive>1 1 1 1</emissive></material>
      <transparency>0.37</transparency>"""
    glass = make.sdf(thing("<box><size>1 1 1</size></box>", white))
    sky = (1.0, 1.0, 1.0, 1.0)
    world = make.world(glass, make.sdf(eye("behind")), ground=None, background=sky)
    assert pixels_of(take(world, "/behind/image_raw")).min() >= 253
