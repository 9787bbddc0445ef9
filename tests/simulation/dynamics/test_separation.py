"""A model put where another one stands is not thrown across the room."""

import numpy as np
import pytest
from tests.coded import coded

import cartwheel as cw
from cartwheel.codes import world as world_codes
from cartwheel.description import load_text


@pytest.fixture
def world():
    with cw.World("empty") as made:
        yield made


def fastest(world: cw.World) -> float:
    return float(np.abs(world.session.simulation.data.qvel).max())


def test_overlapping_models_come_apart_at_walking_pace_and_it_is_said(world):
    first = world.spawn("object.urdf", name="first", x=2.0)
    world.run(0.5)
    second = world.spawn("object.urdf", name="second", x=2.05)
    (said,) = coded(world, world_codes.MODELS_OVERLAP, model="second")
    assert all(other.startswith("first::") for other in said.values["others"])
    speeds = []
    for _ in range(600):
        world.run(0.005)
        speeds.append(fastest(world))
    # A post of 1 m that tips over ends faster than what pushed it: g and its height bound that.
    assert max(speeds) < 8.0
    assert np.hypot(first.pose.x - 2.0, first.pose.y) < 1.5
    assert np.hypot(second.pose.x - 2.05, second.pose.y) < 1.5
    world.run(5.0)
    assert fastest(world) < 0.05


def test_a_model_moved_into_another_one_comes_out_gently(world):
    first = world.spawn("box_medium.urdf", name="first", x=2.0)
    second = world.spawn("box_medium.urdf", name="second", x=4.0)
    world.run(0.5)
    second.pose = cw.Pose((2.1, 0.0, second.pose.z))
    world.run(0.05)
    assert fastest(world) <= 2.0
    world.run(3.0)
    assert abs(first.pose.x - 2.0) < 1.0
    assert fastest(world) < 0.05


def test_models_that_only_touch_are_left_alone(world):
    world.spawn("box_medium.urdf", name="first", x=2.0)
    world.run(1.0)
    assert not coded(world, world_codes.MODELS_OVERLAP)


PERSON = """<sdf version="1.9"><model name="person"><static>true</static><link name="l">
  <collision name="c"><geometry><box><size>0.3 0.3 1</size></box></geometry></collision>
  </link></model></sdf>"""


@pytest.mark.parametrize("rate", [200, 50])
def test_what_an_obstacle_on_a_path_pushes_has_its_speed(world, rate):
    pushed = world.spawn("box_medium.urdf", name="pushed")
    person = world.spawn(PERSON, name="person", x=-1.0, z=0.5)
    world.run(0.2)
    begin = world.time

    def walk() -> None:
        person.pose = cw.Pose((-1.0 + 1.3 * (world.time - begin), 0.0, 0.5))

    world.every(rate, walk)
    world.run(1.5)
    before = pushed.pose.x
    speeds = []
    for _ in range(100):
        world.step()
        speeds.append(pushed.velocity.linear[0])
    assert (pushed.pose.x - before) / (100 * world.step_size) == pytest.approx(1.3, rel=0.1)
    assert np.mean(speeds) == pytest.approx(1.3, rel=0.1)
    assert world.clearance(pushed, person).distance > -0.06
    assert not coded(world, world_codes.MODELS_OVERLAP)


def test_an_obstacle_that_jumps_onto_a_model_separates_gently_and_says_so(world):
    pushed = world.spawn("box_medium.urdf", name="pushed")
    person = world.spawn(PERSON, name="person", x=-3.0, z=0.5)
    world.run(1.0)
    for x in (-2.99, -2.98, -0.1):
        person.pose = cw.Pose((x, 0.0, 0.5))
        world.run(0.05)
    assert fastest(world) <= 2.0
    assert coded(world, world_codes.MODELS_OVERLAP, model="person")
    assert abs(pushed.pose.x) < 0.5


WALKER = """<robot name="walker"><link name="pelvis"><inertial><mass value="10"/>
  <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial></link>{}</robot>"""
LEG = """<link name="{name}"><inertial><origin xyz="0 0 -0.2"/><mass value="2"/>
  <inertia ixx="0.03" iyy="0.03" izz="0.003" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><origin xyz="0.1 0 -0.2"/>
  <geometry><box size="0.06 0.06 0.4"/></geometry></collision></link>
  <joint name="{name}_joint" type="revolute"><parent link="{parent}"/><child link="{name}"/>
  <origin xyz="0 {y} {z}"/><axis xyz="0 1 0"/>
  <limit lower="-2" upper="2" effort="50" velocity="20"/></joint>"""


def test_a_walker_put_up_to_its_hips_into_the_ground_is_not_thrown_by_its_legs(world):
    legs = ""
    for side, y in (("left", 0.1), ("right", -0.1)):
        legs += LEG.format(name=f"{side}_thigh", parent="pelvis", y=y, z=0)
        legs += LEG.format(name=f"{side}_shin", parent=f"{side}_thigh", y=0, z=-0.4)
    walker = world.spawn(load_text(WALKER.format(legs)))
    (said,) = coded(world, world_codes.MODELS_OVERLAP)
    assert said.values["z"] == pytest.approx(0.8)
    for _ in range(10):
        world.run(0.05)
        assert fastest(world) < 8.0  # a fall from 0.8 m turns them no faster
    world.run(4.5)
    assert np.hypot(walker.pose.x, walker.pose.y) < 1.5
    assert walker.pose.z < 0.8
