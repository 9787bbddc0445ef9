"""Shapes that the engine takes only after they are made over."""

import mujoco
import numpy as np
import pytest
import trimesh


@pytest.mark.parametrize("turn", ["0 0 0", "0.4 0 0"])
def test_a_mesh_without_thickness_falls_and_lies_flat(make, tmp_path, turn):
    (tmp_path / "sheet.obj").write_text(
        "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3\nf 1 3 4\n"
    )
    sheet = make.sdf(
        f"""<model name="sheet"><pose>0 0 0.3 {turn}</pose><link name="l">
        <inertial><mass>1</mass></inertial><collision name="c"><geometry><mesh>
        <uri>{tmp_path}/sheet.obj</uri></mesh></geometry></collision></link></model>"""
    )
    world = make.world(sheet)
    world.run(4.0)
    z, w = world.session.simulation.data.qpos[2:4]
    # Half of a plate's millimetre, less what a contact gives way.
    assert 0 < z < 1e-3
    assert abs(w) == pytest.approx(1, abs=1e-3)


@pytest.mark.parametrize(
    ("kind", "limit", "crowned"),
    [
        ("continuous", "", True),
        ("revolute", "", True),
        ("revolute", "<limit><lower>-1e16</lower><upper>1e16</upper></limit>", True),
        ("revolute", "<limit><lower>-1</lower><upper>1</upper></limit>", False),
        ("fixed", "", False),
    ],
)
def test_what_turns_without_end_about_its_own_axis_has_a_tyre(make, kind, limit, crowned):
    cart = make.sdf(
        f"""<model name="cart"><link name="base"/><link name="wheel"><collision name="c">
        <pose>0 0 0 -1.5708 0 0</pose><geometry><cylinder><radius>0.1</radius><length>0.04</length>
        </cylinder></geometry></collision></link><joint name="j" type="{kind}">
        <parent>base</parent><child>wheel</child><axis><xyz>0 1 0</xyz>{limit}</axis></joint>
        </model>"""
    )
    geom = make.world(cart).session.simulation.model.geom("cart::wheel::c")
    kinds = mujoco.mjtGeom
    assert geom.type == (kinds.mjGEOM_ELLIPSOID if crowned else kinds.mjGEOM_CYLINDER)


def wheel(make, geometry, *, pose="0 0 0 -1.5708 0 0", fixed=False):
    """The type and the half sizes of a wheel's geom that turns about y; maybe fixed to its hub."""
    tyre = f'<collision name="c"><pose>{pose}</pose><geometry>{geometry}</geometry></collision>'
    turning = (
        '<joint name="j" type="continuous"><parent>base</parent><child>{}</child>'
        "<axis><xyz>0 1 0</xyz></axis></joint>"
    )
    parts = f'<link name="wheel">{tyre}</link>' + turning.format("wheel")
    if fixed:
        parts = (
            '<link name="hub"><pose>0 0.2 0 0 0 0.5</pose></link>' + turning.format("hub")
            + f'<link name="wheel"><pose>0 0.2 0 0 0 0.5</pose>{tyre}</link><joint name="k" '
            'type="fixed"><parent>hub</parent><child>wheel</child></joint>'
        )  # fmt: skip
    cart = make.sdf(f'<model name="cart"><link name="base"/>{parts}</model>')
    model = make.world(cart).session.simulation.model
    geom = model.geom("cart::wheel::c")
    return geom.type[0], geom.size, geom.pos


CYLINDER = "<cylinder><radius>0.1</radius><length>0.04</length></cylinder>"


@pytest.mark.parametrize(
    ("pose", "crowned"),
    [
        ("0.001 0 0 -1.57 0 0", True),
        ("0 0.05 0 -1.5708 0 0", True),
        ("0.03 0 0 -1.5708 0 0", False),
        ("0 0 0 -1.3 0 0", False),
    ],
)
def test_a_wheel_may_be_drawn_a_little_askew(make, pose, crowned):
    kind, _, place = wheel(make, CYLINDER, pose=pose)
    assert (kind == mujoco.mjtGeom.mjGEOM_ELLIPSOID) == crowned
    assert place == pytest.approx([float(value) for value in pose.split()[:3]])


def test_a_tyre_that_is_fixed_to_its_hub_is_one(make):
    kind, size, _ = wheel(make, CYLINDER, fixed=True)
    assert kind == mujoco.mjtGeom.mjGEOM_ELLIPSOID
    assert size == pytest.approx([0.1, 0.1, 0.02])


def prism(tmp_path, sides, *, hub=0.0):
    """A mesh about y of that many sides, radius 0.1 m from y = 0.01 to 0.05, and a thin hub."""
    lines = []
    rings = [(0.1, 0.01), (0.1, 0.05)] + ([(0.02, 0.05 + hub)] if hub else [])
    for radius, y in rings:
        for i in range(sides):
            a = 2 * np.pi * i / sides
            lines.append(f"v {radius * np.cos(a)} {y} {radius * np.sin(a)}")
    for ring in range(len(rings) - 1):
        for i in range(sides):
            a, b = ring * sides + i + 1, ring * sides + (i + 1) % sides + 1
            lines += [f"f {a} {b} {a + sides}", f"f {b} {b + sides} {a + sides}"]
    path = tmp_path / f"prism{sides}.obj"
    path.write_text("\n".join(lines))
    return f"<mesh><uri>{path}</uri></mesh>"


@pytest.mark.parametrize("hub", [0.0, 0.03])
def test_a_mesh_that_is_round_about_its_axle_is_a_tyre_as_wide_as_its_tread(make, tmp_path, hub):
    kind, size, place = wheel(make, prism(tmp_path, 32, hub=hub), pose="0 0 0 0 0 0")
    assert kind == mujoco.mjtGeom.mjGEOM_ELLIPSOID
    assert size == pytest.approx([0.1, 0.1, 0.02], rel=1e-3)
    assert place == pytest.approx([0, 0.03, 0], abs=1e-6)


def test_a_mesh_with_corners_stays_one(make, tmp_path):
    kind, _, _ = wheel(make, prism(tmp_path, 6), pose="0 0 0 0 0 0")
    assert kind == mujoco.mjtGeom.mjGEOM_MESH


def test_a_fine_round_has_a_hull_of_few_corners_that_is_as_large(make, tmp_path):
    """A cap of the sphere for each corner: 4π/n of its solid angle, so a sag of 2 r/n."""
    radius = 0.3
    path = tmp_path / "ball.stl"
    trimesh.creation.icosphere(subdivisions=5, radius=radius).export(path)
    ball = make.sdf(
        f"""<model name="ball"><pose>0 0 0.31 0 0 0</pose><link name="l"><collision name="c">
        <geometry><mesh><uri>file://{path}</uri></mesh></geometry></collision></link></model>"""
    )
    world = make.world(ball)
    model = world.session.simulation.model
    mesh = model.geom("ball::l::c").dataid[0]
    corners = int(model.mesh_graph[model.mesh_graphadr[mesh]])
    assert corners <= 2000
    world.run(2.0)
    # It may come to rest on any of them, and is a contact's depth deep.
    assert world.model("ball").pose.z == pytest.approx(radius, abs=4 * 2 * radius / corners)


def test_a_lone_triangle_is_drawn_as_it_is_and_is_solid(make, tmp_path):
    """Such parts are all over what architects' programs write."""
    (tmp_path / "shard.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    shape = f"<geometry><mesh><uri>file://{tmp_path}/shard.obj</uri></mesh></geometry>"
    shard = make.sdf(
        f"""<model name="shard"><static>1</static><link name="l">
        <visual name="v">{shape}</visual><collision name="c">{shape}</collision></link></model>"""
    )
    simulation = make.world(shard).session.simulation
    visuals, _ = simulation.engine.visuals.current()
    (drawn,) = np.flatnonzero(visuals.geom_bodyid == visuals.body("shard::l").id)
    assert visuals.mesh_facenum[visuals.geom_dataid[drawn]] == 1
    model = simulation.model
    (solid,) = np.flatnonzero(model.geom_bodyid == model.body("shard::l").id)
    # The engine takes no shape without a volume.
    assert model.geom(solid).name == "shard::l::c"
    assert model.mesh_facenum[model.geom_dataid[solid]] > 1
    assert model.geom_contype[solid] != 0


def test_a_plane_that_is_seen_on_a_moving_link_is_a_plate(make):
    """Where its normal and its size put it; the engine's planes stand still."""
    label = make.sdf(
        """<model name="label"><pose>0 0 0.1 0 0 0</pose><link name="l">
        <collision name="c"><geometry><box><size>0.2 0.2 0.2</size></box></geometry></collision>
        <visual name="v"><pose>0.101 0 0 0 0 0</pose><geometry><plane><normal>1 0 0</normal>
        <size>0.1 0.06</size></plane></geometry></visual></link></model>"""
    )
    model, _ = make.world(label).session.simulation.engine.visuals.current()
    body = model.body("label::l").id
    (seen,) = [model.geom(i) for i in range(model.ngeom) if model.geom_bodyid[i] == body]
    assert seen.type[0] == mujoco.mjtGeom.mjGEOM_BOX
    axis = np.zeros(9)
    mujoco.mju_quat2Mat(axis, seen.quat)
    assert axis.reshape(3, 3)[:, 2] == pytest.approx([1, 0, 0], abs=1e-9)
    assert seen.size[:2] == pytest.approx([0.05, 0.03])
