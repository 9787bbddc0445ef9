"""Shapes that the engine takes only after they are made over."""

import mujoco
import pytest


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
