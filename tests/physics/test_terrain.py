"""Heightmaps and polylines that things lie on and fall through."""

import numpy as np
import pytest
from PIL import Image

from cartwheel.geometry import Pose

RING = """<polyline><point>-1 -1</point><point>1 -1</point><point>1 1</point><point>-1 1</point>
  <height>0.4</height></polyline><polyline><point>-0.5 -0.5</point><point>0.5 -0.5</point>
  <point>0.5 0.5</point><point>-0.5 0.5</point><height>0.4</height></polyline>"""


def hills(make, tmp_path):
    """A stair of 33 x 33 pixels over 8 m: 1 m where y is above 0, 3 m in the strip x < -2."""
    pixels = np.zeros((33, 33), dtype=np.uint8)
    pixels[:14] = 80  # rows begin at +y
    pixels[:, :9] = 240
    Image.fromarray(pixels).save(tmp_path / "hills.png")
    geometry = f"""<geometry><heightmap><uri>file://{tmp_path}/hills.png</uri><size>8 8 3</size>
      <pos>10 0 0.5</pos></heightmap></geometry>"""
    return make.sdf(
        f"""<model name="hills"><static>true</static><link name="l">
        <collision name="c">{geometry}</collision><visual name="v">{geometry}</visual></link>
        </model>"""
    )


def ball(make, name, x, y, z):
    return make.sdf(
        f"""<model name="{name}"><pose>{x} {y} {z} 0 0 0</pose><link name="l"><inertial>
        <mass>1</mass><inertia><ixx>0.004</ixx><iyy>0.004</iyy><izz>0.004</izz></inertia>
        </inertial><collision name="c"><geometry><sphere><radius>0.1</radius></sphere></geometry>
        </collision></link></model>"""
    )


def test_balls_come_to_rest_at_the_heights_of_the_image(make, tmp_path):
    world = make.world(
        hills(make, tmp_path),
        ball(make, "low", 12.0, -2.0, 0.8),
        ball(make, "middle", 12.0, 2.0, 1.8),
        ball(make, "high", 7.0, 0.0, 3.8),
        ground=None,
    )
    world.run(2.0)
    # pos z, and the pixel's share of the brightest; ±5 mm is what a contact may give way.
    for name, height in (("low", 0.5), ("middle", 0.5 + 1.0), ("high", 0.5 + 3.0)):
        assert world.model(name).pose.z == pytest.approx(height + 0.1, abs=5e-3), name


def level(make, tmp_path):
    """A heightmap of 129 x 129 pixels over 20 m, whose surface is at 1 m, except in two corners."""
    pixels = np.full((129, 129), 128, dtype=np.uint8)
    pixels[0, 0], pixels[0, 1] = 255, 0
    Image.fromarray(pixels).save(tmp_path / "level.png")
    geometry = f"""<geometry><heightmap><uri>file://{tmp_path}/level.png</uri>
      <size>20 20 {255 / 128}</size></heightmap></geometry>"""
    return make.sdf(
        f"""<model name="level"><static>true</static><link name="l">
        <collision name="c">{geometry}</collision></link></model>"""
    )


def test_boxes_that_fall_on_a_heightmap_stay_flat(make, tmp_path):
    # They overlap the corners of cells by less than they sink in, where a push to the side would be
    # the shortest way out.
    places = [(0.013 * k, 0.007 * k, 0.05 * k) for k in range(10)]
    boxes = [
        make.box(f"box{k}", (0.2, 0.2, 0.2), pose=Pose((x + k, y, 1.11 + drop)))
        for k, (x, y, drop) in enumerate(places)
    ]
    world = make.world(level(make, tmp_path), *boxes, ground=None)
    world.run(2.0)
    for k, (x, y, drop) in enumerate(places):
        pose = world.model(f"box{k}").pose
        assert pose.position == pytest.approx((x + k, y, 1.1), abs=0.01), drop
        assert pose.rpy == pytest.approx((0, 0, 0), abs=0.02), drop


def test_the_clearance_to_a_heightmap(make, tmp_path):
    boxes = [
        make.box(f"box{k}", (0.2, 0.2, 0.2), pose=Pose((0.3 + k, 0.0, 1.1 + height)))
        for k, height in enumerate((-0.01, 0.0005, 0.03, 0.9))
    ]
    world = make.world(level(make, tmp_path), hills(make, tmp_path), *boxes, ground=None)
    for k, height in enumerate((-0.01, 0.0005, 0.03, 0.9)):
        found = world.clearance(f"box{k}", "level")
        assert found.distance == pytest.approx(height, abs=1e-5)
        assert found.points[1][2] == pytest.approx(1.0, abs=1e-5)
        assert world.clearance("level", f"box{k}").points == found.points[::-1]
    # In front of the stair, the step is nearer than the floor.
    probe = make.box("probe", (0.1, 0.1, 0.1), pose=Pose((11.0, 0.2, 1.2)))
    world = make.world(hills(make, tmp_path), probe, ground=None)
    before = world.session.simulation.model.hfield_data.copy()
    found = world.clearance("probe")
    # It rises by 1 m over a pixel of 0.25 m, from y = 0.5 and z = 0.5.
    assert found.distance == pytest.approx((0.25 * 1.0 + 0.65 * 0.25) / np.hypot(1.0, 0.25))
    assert (world.session.simulation.model.hfield_data == before).all()


def test_a_hole_in_a_polyline_lets_things_through_and_its_rim_does_not(make):
    ring = make.sdf(
        f'<model name="ring"><static>true</static><pose>0 0 1 0 0 0</pose><link name="l">'
        f'<collision name="c"><geometry>{RING}</geometry></collision></link></model>'
    )
    world = make.world(
        ring, ball(make, "through", 0.0, 0.0, 2.0), ball(make, "rests", 0.75, 0.0, 1.6)
    )
    world.run(2.0)
    assert world.model("through").pose.z == pytest.approx(0.1, abs=5e-3)
    assert world.model("rests").pose.z == pytest.approx(1.5, abs=5e-3)


def test_all_parts_of_a_polyline_report_as_their_collision(make):
    sensor = """<sensor name="s" type="contact"><contact><collision>c</collision></contact>
      </sensor>"""
    ring = make.sdf(
        f'<model name="ring"><static>true</static><link name="l">'
        f'<collision name="c"><geometry>{RING}</geometry></collision>{sensor}</link></model>'
    )
    stones = [
        make.box(f"stone{i}", (0.1, 0.1, 0.1), pose=Pose((x, y, 0.451)))
        for i, (x, y) in enumerate([(0.75, 0), (-0.75, 0), (0, 0.75), (0, -0.75)])
    ]
    world = make.world(ring, *stones)
    world.run(0.5)
    world.session.simulation.refresh()
    from cartwheel.simulation.sensing.contacts import read_contacts

    simulation = world.session.simulation
    found = read_contacts(simulation.model, simulation.data, ["ring::l::c"])
    assert {contact.second for contact in found} == {f"stone{i}::link::collision" for i in range(4)}
    back = read_contacts(simulation.model, simulation.data, ["stone1::link::collision"])
    assert {contact.second for contact in back} == {"ring::l::c"}
