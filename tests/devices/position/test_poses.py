"""Poses of a model and its parts."""

import math

import pytest

POSES = """<plugin name="p" filename="gz-sim-pose-publisher-system">
  <update_frequency>50</update_frequency>{}</plugin>"""
SWING = """<model name="swing"><pose>1 2 3 0 0 0.5</pose>
  <link name="base"><inertial><mass>1</mass></inertial></link>
  <link name="arm"><pose>0.5 0 0 0 0 0</pose><inertial><mass>1</mass></inertial>
    <collision name="c"><pose>0 0 0.2 0 0 0</pose><geometry><sphere><radius>0.01</radius></sphere>
    </geometry></collision></link>
  <joint name="bolt" type="fixed"><parent>world</parent><child>base</child></joint>
  <joint name="turn" type="revolute"><parent>base</parent><child>arm</child>
    <pose>-0.5 0 0 0 0 0</pose><axis><xyz>0 0 1</xyz></axis></joint>{}</model>"""


def transforms(message):
    return {each.child_frame_id: each for each in message.transforms}


def test_poses_are_published_in_the_frame_of_what_a_part_belongs_to(make, read):
    tags = """<use_pose_vector_msg>1</use_pose_vector_msg><publish_model_pose>1</publish_model_pose>
      <publish_collision_pose>1</publish_collision_pose>"""
    world = make.world(make.sdf(SWING.format(POSES.format(tags))), ground=None)
    world.session.simulation.set_joint_positions("swing", {"turn": 0.7})
    reported = transforms(read(world, "/model/swing/pose", 0.1)[-1])
    assert set(reported) == {"swing", "swing/base", "swing/arm", "swing/arm/c"}
    arm = reported["swing/arm"]
    assert arm.header.frame_id == "swing"
    place = arm.transform.translation
    assert (place.x, place.y) == pytest.approx((0.5 * math.cos(0.7), 0.5 * math.sin(0.7)), abs=1e-3)
    model = reported["swing"]
    assert model.header.frame_id == "test"
    assert model.transform.translation.z == pytest.approx(3)
    assert model.transform.rotation.z == pytest.approx(math.sin(0.25))
    shape = reported["swing/arm/c"]
    assert shape.header.frame_id == "swing/arm"
    assert shape.transform.translation.z == 0.2


def test_what_no_joint_moves_can_go_on_a_topic_of_its_own(make, read):
    tags = """<static_publisher>1</static_publisher>
      <static_update_frequency>10</static_update_frequency>"""
    world = make.world(make.sdf(SWING.format(POSES.format(tags))), ground=None)
    still = world.mailbox("/model/swing/pose_static")
    moved = read(world, "/model/swing/pose", 1.0)
    assert {message.child_frame_id for message in moved} == {"swing/arm"}
    assert len(moved) == 51
    reported = still.drain()
    assert {message.child_frame_id for message in reported} == {"swing/base"}
    assert len(reported) == 11
