"""Bundles of rays against single rays of the engine, which make no shortcuts."""

import math

import mujoco
import numpy as np
import pytest
from PIL import Image

from cartwheel.geometry import Pose, quat_from_rpy
from cartwheel.simulation.sensing.rays import RayHandle

COLLISIONS = np.array([0, 0, 0, 0, 1, 0], dtype=np.uint8)
EYE = """<model name="eye"><static>true</static><pose>{x} {y} 0.7 0 0 0</pose><link name="link"/>
  </model>"""


@pytest.fixture(autouse=True, params=["all shapes at once", "the nearest shapes first"])
def way(request, monkeypatch):
    """How the rays of a bundle are cast; which one is taken depends on their number."""
    sorts = request.param == "the nearest shapes first"
    rays = "cartwheel.simulation.sensing.rays"
    monkeypatch.setattr(f"{rays}._WORTH_SORTING", 0 if sorts else math.inf)
    monkeypatch.setattr(f"{rays}._FIRST_SHAPES", 2)


def handle(world, directions, *, maximum=50.0, minimum=0.0):
    made = RayHandle("eye", "link", Pose(), directions, minimum=minimum, maximum=maximum)
    simulation = world.session.simulation
    made.bind(simulation.model, simulation.data)
    return made


def single(world, start, directions, maximum):
    simulation = world.session.simulation
    found = np.array(
        [
            mujoco.mj_ray(simulation.model, simulation.data, start, ray, COLLISIONS, True, -1, None)
            for ray in directions
        ]
    )
    return np.where((found < 0) | (found >= maximum), np.inf, found)


def around(rows, columns, steep=1.2):
    azimuth, elevation = np.meshgrid(
        np.linspace(-math.pi, math.pi, columns), np.linspace(-steep, steep, rows)
    )
    level = np.cos(elevation)
    return np.stack(
        [level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation)], axis=-1
    ).reshape(-1, 3)


def clutter(make, random, count):
    """Links of several shapes each, turned as they like; some of them move."""
    shapes = (
        "<box><size>{} {} {}</size></box>",
        "<sphere><radius>{}</radius></sphere>",
        "<cylinder><radius>{}</radius><length>{}</length></cylinder>",
        "<ellipsoid><radii>{} {} {}</radii></ellipsoid>",
    )
    made = []
    for index in range(count):
        parts = "".join(
            f"""<collision name="c{part}"><pose>{" ".join(map(str, random.uniform(-1.5, 1.5, 6)))}
            </pose><geometry>{shapes[random.integers(4)].format(*random.uniform(0.1, 0.7, 3))}
            </geometry></collision>"""
            for part in range(random.integers(1, 5))
        )
        x, y = random.uniform(-6, 6, 2)
        place = " ".join(map(str, (x, y, *random.uniform(-2, 3, 4))))
        static = "<static>true</static>" if index % 2 else ""
        made.append(
            make.sdf(
                f"""<model name="m{index}">{static}<pose>{place}</pose><link name="l">
                <inertial><mass>1</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz>
                </inertia></inertial>{parts}</link></model>"""
            )
        )
    return made


@pytest.mark.parametrize("seed", range(6))
def test_a_bundle_reads_what_single_rays_read(make, seed):
    random = np.random.default_rng(seed)
    start = (*random.uniform(-3, 3, 2), 0.7)
    eye = make.sdf(EYE.format(x=start[0], y=start[1]))
    world = make.world(*clutter(make, random, 25), eye, gravity=0.0)
    world.run(0.1)
    maximum = float(random.choice([3.0, 8.0, 50.0]))
    rays = around(15, 80)
    read, _ = handle(world, rays, maximum=maximum).cast()
    expected = single(world, start, rays, maximum)
    assert np.isfinite(expected).sum() > 100
    assert read == pytest.approx(expected, abs=1e-9)


def test_terrain_and_meshes_are_read_as_single_rays_read_them(make, tmp_path):
    random = np.random.default_rng(5)
    heights = random.integers(0, 255, (17, 17)).astype(np.uint8)
    Image.fromarray(heights).save(tmp_path / "terrain.png")
    corners = random.uniform(-1, 1, (12, 3))
    (tmp_path / "spikes.obj").write_text(
        "".join(f"v {x} {y} {z}\n" for x, y, z in corners)
        + "".join(f"f {i} {i + 1} {i + 2}\n" for i in range(1, 11))
    )
    terrain = f"""<heightmap><uri>file://{tmp_path}/terrain.png</uri><size>9 7 1.5</size>
      <pos>0.5 1 -1.2</pos></heightmap>"""
    spikes = f"<mesh><uri>file://{tmp_path}/spikes.obj</uri></mesh>"
    models = [
        f"""<model name="m{index}"><static>true</static><pose>{pose}</pose><link name="link">
        <collision name="c"><geometry>{shape}</geometry></collision></link></model>"""
        for index, (shape, pose) in enumerate(
            [
                (terrain, "0 0 0 0 0 0.4"),
                (spikes, "3 1 1 0.3 0.2 0.1"),
                (spikes, "-2 -2 1 1 -0.5 2"),
            ]
        )
    ]
    world = make.world(*map(make.sdf, models), make.sdf(EYE.format(x=0, y=0)), ground=None)
    rays = around(15, 80)
    read, _ = handle(world, rays).cast()
    expected = single(world, (0, 0, 0.7), rays, 50.0)
    assert 400 < np.isfinite(expected).sum() < 1100
    assert read == pytest.approx(expected, abs=1e-9)


def test_every_shape_of_a_turned_link_is_seen(make):
    """Turned a quarter, what its link has at x = 3 m stands at y = 3 m."""
    gate = make.sdf(
        """<model name="gate"><static>true</static><link name="link">
        <collision name="a"><geometry><box><size>0.2 0.2 4</size></box></geometry></collision>
        <collision name="b"><pose>3 0 0 0 0 0</pose><geometry><box><size>0.2 0.2 4</size></box>
        </geometry></collision></link></model>"""
    )
    world = make.world(make.sdf(EYE.format(x=-2, y=0)))
    world.session.spawn(gate, pose=Pose((0, 0, 0), quat_from_rpy(0, 0, math.pi / 2)))
    toward = np.array([[1.0, 0.0, 0.0], [2.0, 3.0, 0.0]])
    toward /= np.linalg.norm(toward, axis=1)[:, None]
    read, _ = handle(world, toward).cast()
    # The second ray meets the post at (0, 3) on the side x = -0.1 where y = 2.85, outside it,
    # and so on the side y = 2.9.
    assert read == pytest.approx([1.9, 2.9 / toward[1, 1]])


def test_the_ground_is_seen_however_far_its_frame_is(make):
    world = make.world(make.sdf(EYE.format(x=150, y=-80)))
    read, _ = handle(world, np.array([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]), maximum=2.0).cast()
    assert read.tolist() == [pytest.approx(0.7), math.inf]


def test_a_long_wall_is_seen_up_to_its_edge(make):
    """In the middle its upper edge stands higher in the sky than its corners do."""
    wall = make.sdf(
        """<model name="wall"><static>true</static><pose>2.5 0 0.85 0 0 0</pose><link name="l">
        <collision name="a"><geometry><box><size>1 40 1.7</size></box></geometry></collision>
        <collision name="b"><pose>5 0 0 0 0 0</pose><geometry><sphere><radius>0.1</radius></sphere>
        </geometry></collision></link></model>"""
    )
    world = make.world(wall, make.sdf(EYE.format(x=0, y=0)))
    # The edge is 1 m above the eye and 2 m ahead.
    angles = np.linspace(0.0, 1.2 * math.atan(0.5), 200)
    rays = np.stack([np.cos(angles), np.zeros(200), np.sin(angles)], axis=1)
    read, _ = handle(world, rays).cast()
    assert np.isfinite(read).tolist() == (np.tan(angles) < 0.5).tolist()


def test_a_cast_leaves_the_model_as_it_was(make):
    world = make.world(*clutter(make, np.random.default_rng(1), 10), make.sdf(EYE.format(x=0, y=0)))
    model = world.session.simulation.model
    fields = (model.geom_group, model.body_bvhadr, model.body_geomnum)
    before = [field.copy() for field in fields]
    assert (before[1] >= 0).any()
    assert (before[2] > 1).any()
    handle(world, around(3, 50), minimum=0.5).cast()
    assert all(np.array_equal(*pair) for pair in zip(fields, before, strict=True))
