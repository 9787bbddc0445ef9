"""Bundles of rays against single rays of the engine, which make no shortcuts."""

import math

import mujoco
import numpy as np
import pytest
from PIL import Image

from cartwheel import Twist
from cartwheel.codes.world import EMBREE_MISSING
from cartwheel.geometry import Pose, quat_from_rpy
from cartwheel.simulation.sensing.rays import RayHandle

COLLISIONS = np.array([0, 0, 0, 0, 1, 0], dtype=np.uint8)
EYE = """<model name="eye"><static>true</static><pose>{x} {y} 0.7 0 0 0</pose><link name="link"/>
  </model>"""


@pytest.fixture(
    autouse=True,
    params=["Embree", "MuJoCo, all shapes at once", "MuJoCo, the nearest shapes first"],
)
def way(request, monkeypatch):
    """How the rays of a bundle are cast; which one is taken depends on the machine and number."""
    sensing = "cartwheel.simulation.sensing"
    if request.param == "Embree":
        pytest.importorskip("embreex")
        monkeypatch.setattr(f"{sensing}.rays._WORTH_EMBREE", 0)
        return
    monkeypatch.setattr(f"{sensing}.rays.AVAILABLE", False)
    sorts = request.param == "MuJoCo, the nearest shapes first"
    monkeypatch.setattr(f"{sensing}.mujoco_rays._WORTH_SORTING", 0 if sorts else math.inf)
    monkeypatch.setattr(f"{sensing}.mujoco_rays._FIRST_SHAPES", 2)


def handle(world, directions, *, maximum=50.0, minimum=0.0):
    simulation = world.session.simulation
    made = RayHandle(
        "eye", "link", Pose(), directions, minimum=minimum, maximum=maximum,
        scenes=simulation.engine.ray_scenes,
    )  # fmt: skip
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


def test_rays_beside_curved_shapes_see_what_is_behind(make):
    """They pass between the shapes and the triangles that enclose them."""
    shapes = (
        "<sphere><radius>0.4</radius></sphere>",
        "<cylinder><radius>0.4</radius><length>3</length></cylinder>",
        "<capsule><radius>0.4</radius><length>1</length></capsule>",
        "<ellipsoid><radii>0.4 0.4 0.7</radii></ellipsoid>",
    )
    for shape in shapes:
        post = make.sdf(
            f"""<model name="post"><static>true</static><pose>3 0 0.7 0 0 0</pose><link name="l">
            <collision name="a"><geometry>{shape}</geometry></collision>
            <collision name="b"><pose>2 0 0 0 0 0</pose><geometry><box><size>0.2 9 9</size></box>
            </geometry></collision></link></model>"""
        )
        world = make.world(post, make.sdf(EYE.format(x=0, y=0)))
        # Tangents pass at 0.4 m from the axis, which is 3 m ahead.
        edge = math.asin(0.4 / 3.0)
        angles = edge + np.concatenate(
            [np.linspace(-1e-3, 1e-3, 201), np.linspace(-1e-6, 1e-6, 41)]
        )
        rays = np.stack([np.cos(angles), np.sin(angles), np.zeros(len(angles))], axis=1)
        read, _ = handle(world, rays).cast()
        expected = single(world, (0, 0, 0.7), rays, 50.0)
        assert (expected < 4).any() and (expected > 4).any()
        # At a tangent, a root of rounding errors.
        assert read == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("static", ["true", "false"])
def test_a_ray_almost_along_a_cylinder_sees_its_side(make, static):
    post = make.sdf(
        f"""<model name="post"><static>{static}</static><pose>0.49999 0 4 0 0 0</pose>
        <link name="l"><gravity>false</gravity><collision name="c"><geometry><cylinder>
        <radius>0.5</radius><length>6</length></cylinder></geometry></collision></link></model>"""
    )
    world = make.world(post, make.sdf(EYE.format(x=1, y=0)))
    # The first ray enters 0.2 m above the lower end, and the second one through this end.
    rays = np.array([[-2e-5, 0.0, 1.0], [-1.0, 0.0, 1.0]])
    rays /= np.linalg.norm(rays, axis=1)[:, None]
    read, _ = handle(world, rays).cast()
    expected = single(world, (1, 0, 0.7), rays, 50.0)
    assert expected == pytest.approx([0.5, 0.3 * math.sqrt(2)], abs=1e-6)
    assert read == pytest.approx(expected, abs=1e-6)


@pytest.mark.parametrize("static", ["true", "false"])
@pytest.mark.parametrize("shape", ["box", "mesh"])
def test_housings_and_near_shapes_of_its_own_robot_are_not_seen(make, tmp_path, shape, static):
    """Ahead of the eye, 0.1 m and 0.5 m away, and on its left on a link that turns."""
    corners = [(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]
    faces = "124 143 587 576 156 126 348 387 137 175 268 284"
    (tmp_path / "cube.obj").write_text(
        "".join(f"v {x} {y} {z}\n" for x, y, z in corners)
        + "".join(f"f {a} {b} {c}\n" for a, b, c in faces.replace("126", "162").split())
    )

    def cube(name, size, place):
        geometry = (
            f"<box><size>{size} {size} {size}</size></box>"
            if shape == "box"
            else f"<mesh><uri>file://{tmp_path}/cube.obj</uri><scale>{size / 2} {size / 2} "
            f"{size / 2}</scale></mesh>"
        )
        return (
            f'<collision name="{name}"><pose>{place} 0 0 0</pose><geometry>{geometry}</geometry>'
            "</collision>"
        )

    inertial = """<inertial><mass>1</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia>
      </inertial>"""
    eye = make.sdf(
        f"""<model name="eye"><static>{static}</static><pose>0 0 0.7 0 0 0</pose>
        <link name="link">{inertial}{cube("housing", 0.08, "0 0 0")}
          {cube("near", 0.1, "0.15 0 0")}{cube("far", 0.1, "0.55 0 0")}</link>
        <link name="arm">{inertial}{cube("near", 0.1, "0 0.15 0")}{cube("far", 0.1, "0 0.55 0")}
        </link><joint name="j" type="revolute"><parent>link</parent><child>arm</child>
        <axis><xyz>0 0 1</xyz></axis></joint></model>"""
    )
    wall = make.sdf(
        f"""<model name="wall"><static>true</static><pose>-0.15 0 0.7 0 0 0</pose><link name="l">
        {cube("c", 0.1, "0 0 0")}</link></model>"""
    )
    world = make.world(eye, wall, gravity=0.0)
    rays = np.array([[1.0, 0, 0], [0, 1.0, 0], [-1.0, 0, 0], [0, -1.0, 0]])
    found = handle(world, rays, minimum=0.2)
    read, _ = found.cast()
    assert read.tolist() == [pytest.approx(0.5), pytest.approx(0.5), -math.inf, math.inf]
    if static == "false":
        arm = world.session.simulation.data.joint("eye::j")
        arm.qpos[0] = -math.pi / 2
        mujoco.mj_kinematics(world.session.simulation.model, world.session.simulation.data)
        read, _ = found.cast()
        assert read.tolist() == [pytest.approx(0.5), math.inf, -math.inf, math.inf]


def test_changes_of_the_model_are_seen(make):
    """A wall that is moved without a compilation, and one that becomes invisible."""
    wall = make.sdf(
        """<model name="wall"><static>true</static><pose>2 0 0.7 0 0 0</pose><link name="l">
        <collision name="c"><geometry><box><size>0.2 1 1</size></box></geometry></collision>
        </link></model>"""
    )
    world = make.world(wall, make.sdf(EYE.format(x=0, y=0)))
    ahead = handle(world, np.array([[1.0, 0.0, 0.0]]))
    model = world.session.simulation.model
    assert ahead.cast()[0] == pytest.approx([1.9])
    world.model("wall").pose = Pose((3.0, 0.0, 0.7))
    world.step()
    body = model.body("wall::l").id
    assert ahead.cast()[0] == pytest.approx([2.9])
    model.geom_rgba[model.body_geomadr[body], 3] = 0.0
    assert ahead.cast()[0].tolist() == [math.inf]
    model.geom_rgba[model.body_geomadr[body], 3] = 1.0
    assert ahead.cast()[0] == pytest.approx([2.9])


@pytest.mark.parametrize("eye", [False, True], ids=["a standing eye", "a moving eye"])
def test_models_that_move_at_a_velocity_are_seen(make, eye):
    """While they move, after they have stopped, and beside others that stand."""
    random = np.random.default_rng(7)
    world = make.world(*clutter(make, random, 25), make.sdf(EYE.format(x=0.5, y=0.2)), gravity=0.0)
    found, rays = handle(world, around(15, 80)), around(15, 80)
    scenes = world.session.simulation.engine.ray_scenes._scenes
    for moves in (True, False):
        for index in range(1, 25, 4):
            turn = (0.2, 0.1 * index, 0.5) if moves else (0.0, 0.0, 0.0)
            velocity = Twist((0.3, -0.1 * index, 0.1) if moves else (0.0, 0.0, 0.0), turn)
            world.model(f"m{index}").velocity = velocity
        if eye:
            world.model("eye").velocity = Twist((0.2, 0.1, 0.0) if moves else (0.0, 0.0, 0.0))
        versions = set()
        for _ in range(3):
            world.run(0.1)
            place = world.model("eye").pose.position
            read, _ = found.cast()
            assert read == pytest.approx(single(world, place, rays, 50.0), abs=1e-9)
            versions |= {each.version for each in scenes.values()}
        # The shapes of what stands are not prepared again.
        assert len(versions) == len(scenes)


def test_far_from_the_origin_rays_are_as_exact(make):
    random = np.random.default_rng(3)
    posts = "".join(
        f"""<collision name="c{i}"><pose>{2 + i} {y} 0.7 0 0 {y}</pose><geometry><box>
        <size>0.2 0.3 1</size></box></geometry></collision>"""
        for i, y in enumerate(random.uniform(-2, 2, 9))
    )
    row = make.sdf(
        f"""<model name="row"><static>true</static><pose>70000 -40000 0 0 0 0.3</pose>
        <link name="l">{posts}</link></model>"""
    )
    world = make.world(row, make.sdf(EYE.format(x=70000, y=-40000)))
    rays = around(3, 300, steep=0.2)
    read, _ = handle(world, rays).cast()
    expected = single(world, (70000, -40000, 0.7), rays, 50.0)
    assert np.isfinite(expected).sum() > 20
    assert read == pytest.approx(expected, abs=1e-6)


def test_a_missing_embree_is_reported_once(make, monkeypatch):
    monkeypatch.setattr("cartwheel.simulation.sensing.embree_rays.AVAILABLE", False)
    laser = """<model name="{name}"><static>true</static><link name="l"><sensor name="s" type="ray">
      <ray><scan><horizontal><samples>3</samples><min_angle>0</min_angle><max_angle>1</max_angle>
      </horizontal></scan><range><min>0.1</min><max>9</max></range></ray>
      <plugin name="{name}" filename="libgazebo_ros_laser.so"/></sensor></link></model>"""
    world = make.world(*(make.sdf(laser.format(name=name)) for name in "ab"))
    reported = [each for each in world.diagnostics if each.code is EMBREE_MISSING]
    assert len(reported) == 1
