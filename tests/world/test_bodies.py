"""Joints and shapes of a description as they come out of the engine's compiler."""

import numpy as np
import pytest

import cartwheel as cw
from cartwheel.description import load_text

PLANAR = """<robot name="r">
  <link name="base">
    <inertial><mass value="9"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <link name="puck">
    <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
  </link>
  <joint name="j" type="planar">
    <parent link="base"/><child link="puck"/><axis xyz="{axis}"/>
  </joint>
</robot>"""

CONE = """<sdf version="1.10"><model name="pile"><link name="link">
  <inertial><mass>1</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial>
  <collision name="c"><geometry><cone><radius>0.5</radius><length>1</length></cone></geometry>
  </collision></link></model></sdf>"""


@pytest.mark.parametrize("axis", ["0 0 1", "1 0 0", "1 1 1"])
def test_a_planar_joint_slides_across_its_axis_and_turns_about_it(axis: str) -> None:
    with cw.World("empty") as world:
        world.spawn(load_text(PLANAR.format(axis=axis), file="r.urdf"))
        model = world.session.simulation.model
        ids = [model.joint(f"r::j{suffix}").id for suffix in ("::x", "::y", "")]
        normal = np.array([float(word) for word in axis.split()])
        expected = normal / np.linalg.norm(normal)
        x, y, turn = model.jnt_axis[ids]
        assert np.cross(x, y) == pytest.approx(expected, abs=1e-9)
        assert turn == pytest.approx(expected, abs=1e-9)


def test_a_cone_stands_on_its_base() -> None:
    with cw.World("empty") as world:
        pile = world.spawn(load_text(CONE, file="c.sdf"), z=0.51)
        world.run(2.0)
        assert pile.pose.z == pytest.approx(0.5, abs=2e-3)
        assert abs(pile.pose.rpy[0]) + abs(pile.pose.rpy[1]) < 0.01
