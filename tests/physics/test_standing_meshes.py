"""Meshes that stand still collide with their surface: rooms have an inside, valleys a bottom."""

import mujoco
import numpy as np
import pytest
import trimesh
from tests.coded import coded

from cartwheel.codes.world import MODELS_OVERLAP, PHYSICS_SETTING_IGNORED
from cartwheel.description.meshes.standing import standing_pieces
from cartwheel.geometry import Pose

SURFACE = "the triangle surface of a mesh"
"""What has no effect where a part of it has too many facets."""


def static_mesh(make, path, name="thing"):
    return make.sdf(
        f"""<model name="{name}"><static>true</static><link name="l"><collision name="c"><geometry>
        <mesh><uri>file://{path}</uri></mesh></geometry></collision></link></model>"""
    )


def ball(make, x, y, z, name="ball"):
    return make.sdf(
        f"""<model name="{name}"><pose>{x} {y} {z} 0 0 0</pose><link name="l"><inertial>
        <mass>1</mass><inertia><ixx>0.004</ixx><iyy>0.004</iyy><izz>0.004</izz></inertia>
        </inertial><collision name="c"><geometry><sphere><radius>0.1</radius></sphere></geometry>
        </collision></link></model>"""
    )


@pytest.fixture
def ring(tmp_path):
    """A wall 1 m high of outer radius 3 m and inner radius 2.8 m, in one piece."""
    path = tmp_path / "ring.stl"
    trimesh.creation.annulus(r_min=2.8, r_max=3.0, height=1.0, sections=24).export(path)
    return path


def test_a_ring_has_room_inside_and_its_wall_stops_a_ball(make, ring):
    world = make.world(
        static_mesh(make, ring), ball(make, 0, 0, 0.1), ball(make, 2.9, 0, 0.7, name="top")
    )
    assert not coded(world.session, MODELS_OVERLAP)
    simulation = world.session.simulation
    simulation.data.joint("ball::l").qvel[0] = 2.0
    world.run(3.0)
    # The ball came to the inner face, whose facets lie between 2.8 cos(π/24) and 2.8 m.
    radius = float(np.linalg.norm(simulation.pose("ball").position[:2]))
    assert radius < 2.8 - 0.1 + 5e-3
    # The other lies on the rim: 0.5 m is half of the height.
    assert simulation.pose("top").position[2] == pytest.approx(0.6, abs=5e-3)


def test_a_ball_rolls_into_the_valley_of_a_terrain(make, tmp_path):
    """A sheet without thickness, 4 m by 4 m, that rises by 0.3 m for each metre from y = 0."""
    rows = [(x, y, 1.0 + 0.3 * abs(y)) for y in (-2.0, 0.0, 2.0) for x in (-2.0, 2.0)]
    faces = [(0, 1, 3), (0, 3, 2), (2, 3, 5), (2, 5, 4)]
    path = tmp_path / "valley.stl"
    trimesh.Trimesh(rows, faces).export(path)
    world = make.world(static_mesh(make, path), ball(make, 0.0, 1.0, 1.5), ground=None)
    world.run(12.0)
    x, y, z = world.session.simulation.pose("ball").position
    # It rolls to and fro, and lost most of its height where the slopes meet. Its centre is
    # r / cos(slope) above the surface.
    assert abs(x) < 0.05
    assert abs(y) < 0.5
    assert z == pytest.approx(1.0 + 0.3 * abs(y) + 0.1 * np.hypot(1, 0.3), abs=5e-3)


def grid(height):
    """The corners and faces of a sheet of 10 m by 10 m, with cells of 0.25 m."""
    count = 41
    x, y = np.meshgrid(np.linspace(-5, 5, count), np.linspace(-5, 5, count))
    index = np.arange(count**2).reshape(count, count)
    a, b, c, d = index[:-1, :-1], index[:-1, 1:], index[1:, :-1], index[1:, 1:]
    corners = np.stack([x, y, height(x, y)], axis=-1).reshape(-1, 3)
    return corners, np.concatenate(
        [np.stack([a, b, d], -1).reshape(-1, 3), np.stack([a, d, c], -1).reshape(-1, 3)]
    )


def test_boxes_that_fall_on_a_sheet_of_many_pieces_stay_flat(make, tmp_path):
    """They overlap some pieces by less than they sink in, so the shortest way out is sideways."""
    path = tmp_path / "sheet.stl"
    trimesh.Trimesh(*grid(lambda x, y: 0.2 * ((x < -4.9) & (y < -4.9)))).export(path)
    places = [(0.113 * k - 2 + 0.5 * k, 0.07 * k, 0.1 * k) for k in range(10)]
    boxes = [
        make.box(f"box{k}", (0.2, 0.2, 0.2), pose=Pose((x, y, 0.11 + drop)))
        for k, (x, y, drop) in enumerate(places)
    ]
    world = make.world(static_mesh(make, path), *boxes, ground=None)
    world.run(2.0)
    for k, (x, y, drop) in enumerate(places):
        pose = world.model(f"box{k}").pose
        assert pose.position == pytest.approx((x, y, 0.1), abs=0.02), drop
        assert pose.rpy == pytest.approx((0, 0, 0), abs=0.02), drop


def test_pieces_reach_below_their_neighbours_but_not_out_of_the_surface():
    def height(x, y):
        return 0.3 * np.sin(2 * x) * np.cos(1.5 * y)

    pieces = standing_pieces(*grid(height)).pieces
    assert len(pieces) > 500
    sides = 0
    for piece in pieces:
        x, y, z = piece.T
        # The facets are up to 1 cm beside the function.
        assert (z <= height(x, y) + 0.015).all()
        sides += len(piece) > 6
    assert sides > len(pieces) / 2


def test_a_room_with_a_door_is_open_and_its_walls_are_where_they_are_drawn(make, tmp_path):
    """Walls of 0.1 m around 4 m by 4 m, in one mesh; a ray finds each face."""
    import mujoco

    def wall(x, y, w, d):
        box = trimesh.creation.box((w, d, 2.0))
        box.apply_translation((x, y, 1.0))
        return box

    mesh = trimesh.util.concatenate(
        [wall(2, 0, 0.1, 4), wall(-2, 0, 0.1, 4), wall(0, 2, 3.9, 0.1), wall(-1.2, -2, 1.5, 0.1)]
    )
    path = tmp_path / "room.stl"
    mesh.export(path)
    world = make.world(
        static_mesh(make, path), make.box("b", (0.2, 0.2, 0.2), pose=Pose((0, 0, 0.1)))
    )
    simulation = world.session.simulation
    group = np.array([0, 0, 0, 0, 1, 0], dtype=np.uint8)
    hit = np.zeros(1, dtype=np.int32)
    start = np.array([0.0, 0.0, 1.0])
    for direction, expected in (((1.0, 0, 0), 1.95), ((-1.0, 0, 0), 1.95), ((0, 1.0, 0), 1.95)):
        found = mujoco.mj_ray(
            simulation.model, simulation.data, start, np.array(direction), group, 1, -1, hit
        )
        assert found == pytest.approx(expected, abs=1e-4)
    # Out of the door there is nothing.
    free = mujoco.mj_ray(
        simulation.model, simulation.data, np.array([0.8, 0, 1.0]), np.array([0, -1.0, 0]),
        group, 1, -1, hit,
    )  # fmt: skip
    assert free == -1


def test_a_convex_mesh_stays_one_hull_and_one_that_moves_too(make, tmp_path, ring):
    path = tmp_path / "box.stl"
    trimesh.creation.box((1, 1, 1)).export(path)
    world = make.world(static_mesh(make, path), ground=None)
    assert world.session.simulation.model.ngeom == 1
    moving = make.sdf(
        f"""<model name="r"><link name="l"><inertial><mass>1</mass></inertial><collision name="c">
        <geometry><mesh><uri>file://{ring}</uri></mesh></geometry></collision></link></model>"""
    )
    assert make.world(moving, ground=None).session.simulation.model.ngeom == 1


def test_a_surface_of_too_many_facets_is_reported(make, ring, monkeypatch):
    from cartwheel.description.meshes import loading, standing

    loading._standing.clear()
    monkeypatch.setattr(standing, "MOST_PIECES", 10)
    world = make.world(static_mesh(make, ring), ground=None)
    loading._standing.clear()
    assert world.session.simulation.model.ngeom == 1
    assert coded(world.session, PHYSICS_SETTING_IGNORED, setting=SURFACE)


def test_a_flat_sheet_carries_what_lies_on_it(make, tmp_path):
    path = tmp_path / "sheet.stl"
    corners = [(-1, -1, 0.5), (1, -1, 0.5), (1, 1, 0.5), (-1, 1, 0.5)]
    trimesh.Trimesh(corners, [(0, 1, 2), (0, 2, 3)]).export(path)
    world = make.world(static_mesh(make, path), ball(make, 0.3, 0.2, 0.8), ground=None)
    world.run(2.0)
    assert world.session.simulation.pose("ball").position[2] == pytest.approx(0.6, abs=5e-3)


def test_a_finely_meshed_ring_is_as_hollow_as_a_coarse_one(make, tmp_path):
    """A tyre of 16,384 facets, each of which would be a slab, is made of fewer larger ones."""
    path = tmp_path / "tyre.stl"
    tyre = trimesh.creation.torus(0.5, 0.1, major_sections=128, minor_sections=64)
    tyre.export(path)
    world = make.world(static_mesh(make, path), ground=None)
    assert not coded(world.session, PHYSICS_SETTING_IGNORED, setting=SURFACE)
    simulation = world.session.simulation
    # Corners within 3 cm along each axis are one, in their middle.
    off = 0.03 * np.sqrt(3)
    geom = np.zeros(1, np.int32)

    def reach(start, along):
        return mujoco.mj_ray(
            simulation.model, simulation.data, start, along, None, 1, -1, geom, None
        )

    # Off the seams between facets, through which a ray may slip.
    for angle in 0.01 + np.linspace(0.0, 2 * np.pi, 48, endpoint=False):
        out = np.array([np.cos(angle), np.sin(angle), 0.0])
        assert reach(np.zeros(3), out) == pytest.approx(0.4, abs=off)
        assert reach(0.5 * out + (0, 0, 1), np.array([0, 0, -1.0])) == pytest.approx(0.9, abs=off)
    assert reach(np.array([0, 0, 1.0]), np.array([0, 0, -1.0])) == -1


def test_a_small_part_is_its_hull():
    washer = trimesh.creation.annulus(r_min=0.01, r_max=0.02, height=0.005, sections=24)
    wheel = trimesh.creation.annulus(r_min=0.1, r_max=0.2, height=0.05, sections=24)
    assert not standing_pieces(washer.vertices, washer.faces).pieces
    assert len(standing_pieces(wheel.vertices, wheel.faces).pieces) >= 2 * 24


def test_slabs_are_as_thick_as_half_of_the_wall_behind_each():
    """A wall that is folded 119 times at 30°: 6 cm upright, 6 cm cos(30°) across each fold."""
    x = 0.2 * np.arange(121)
    z = 0.2 * np.tan(np.pi / 6) * (np.arange(121) % 2)
    rows = [np.column_stack([x, 0 * x + y, z + up]) for up in (0.06, 0.0) for y in (0.0, 1.0)]
    a, b, c, d = (121 * k + np.arange(120) for k in range(4))
    sides = [(a, a + 1, b + 1, b), (d, d + 1, c + 1, c), (c, c + 1, a + 1, a), (b, b + 1, d + 1, d)]
    quads = np.concatenate([np.column_stack(side) for side in sides])
    quads = np.concatenate([quads, [(0, 121, 363, 242), (120, 362, 483, 241)]])
    faces = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    made = trimesh.Trimesh(np.concatenate(rows), faces, process=False)
    assert made.is_watertight
    found = standing_pieces(made.vertices, made.faces).pieces
    long = [piece for piece in found if np.ptp(piece[:, 1]) == pytest.approx(1.0)]
    normals = [(np.sin(a), 0.0, np.cos(a)) for a in (np.pi / 6, -np.pi / 6)]
    depths = [min(np.ptp(piece @ np.array(n)) for n in normals) for piece in long]
    half = 0.06 * np.cos(np.pi / 6) / 2
    assert sum(abs(depth - half) < 1e-6 for depth in depths) == 2 * 120
