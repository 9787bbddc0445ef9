"""Models that stand only by the width of their tyres keep it; others collide as ellipsoids."""

import mujoco
import pytest

import cartwheel as cw
from cartwheel.description import load_text

SOLID = """<inertial><mass value="{m}"/>
  <inertia ixx="0.02" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>"""


def wheel(name, x, y, *, length=0.1, z=0.0, hub=False):
    tyre = f"""<collision name="tyre"><geometry><cylinder radius="0.1" length="{length}"/>
      </geometry></collision>"""
    own = f"""<link name="{name}">{SOLID.format(m=1)}{"" if hub else tyre}</link>
      <joint name="{name}_axle" type="continuous"><parent link="base"/><child link="{name}"/>
      <origin xyz="{x} {y} {z}" rpy="-1.5708 0 0"/><axis xyz="0 0 1"/></joint>"""
    if not hub:
        return own
    return f"""{own}<link name="{name}_tyre">{SOLID.format(m=0.1)}{tyre}</link>
      <joint name="{name}_rim" type="fixed"><parent link="{name}"/><child link="{name}_tyre"/>
      </joint>"""


def vehicle(*wheels, extra=""):
    return load_text(
        f"""<robot name="bike"><link name="base"><inertial><origin xyz="0 0.01 0.1"/>
        <mass value="5"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
        <collision name="frame"><geometry><box size="0.4 0.1 0.05"/></geometry></collision>{extra}
        </link>{"".join(wheels)}</robot>""",
        file="bike.urdf",
    )


def shape(world, name):
    return mujoco.mjtGeom(world.session.simulation.model.geom(name).type[0]).name


@pytest.mark.parametrize("hub", [False, True])
def test_a_bicycle_stands_on_the_width_of_its_tyres(hub):
    robot = vehicle(wheel("front", 0.3, 0, hub=hub), wheel("rear", -0.3, 0, hub=hub))
    with cw.World("empty") as world:
        bike = world.spawn(robot, z=0.1)
        world.run(10)
        assert abs(bike.pose.rpy[0]) < 0.01
        assert bike.pose.z == pytest.approx(0.1, abs=2e-3)


@pytest.mark.parametrize(
    "robot",
    [
        pytest.param(vehicle(wheel("left", 0, 0.2), wheel("right", 0, -0.2)), id="one axle"),
        pytest.param(
            vehicle(
                wheel("front_left", 3, 0.2),
                wheel("left", -3, 0.2),
                wheel("front_right", 3, -0.2),
                wheel("right", -3, -0.2),
            ),
            id="long",
        ),
        pytest.param(
            vehicle(
                wheel("left", 0.3, 0),
                wheel("rear", -0.3, 0),
                extra="""<collision name="stand"><origin xyz="0 0.2 -0.08"/><geometry>
                  <sphere radius="0.02"/></geometry></collision>""",
            ),
            id="kickstand",
        ),
    ],
)
def test_other_wheels_are_round(robot):
    with cw.World("empty") as world:
        world.spawn(robot, z=0.1)
        assert shape(world, "bike::left::tyre_collision") == "mjGEOM_ELLIPSOID"


def test_a_wheel_that_keeps_its_width_still_rolls():
    robot = vehicle(wheel("front", 0.3, 0), wheel("rear", -0.3, 0))
    with cw.World("empty") as world:
        bike = world.spawn(robot, z=0.1)
        assert shape(world, "bike::front::tyre_collision") == "mjGEOM_CYLINDER"
        bike.push(force=(7.0, 0, 0), seconds=0.5)
        world.run(2)
        # 7 N for 0.5 s, and the wheels' inertia as 2 x 0.02 / 0.1**2 kg.
        assert bike.velocity.linear[0] == pytest.approx(3.5 / (7 + 4), rel=0.05)
