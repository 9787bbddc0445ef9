"""The bumper: what touches, where, how hard, and by which names."""

import dataclasses

import numpy as np
import pytest
from tests.coded import coded

from cartwheel.codes import devices
from cartwheel.geometry import Pose
from cartwheel.simulation.sensing.contacts import read_contacts

COMMAND = "/part2_cmr/cmd_vel"
G, RADIUS, TORQUE = 9.8, 0.26, 20.0
FRONT = 0.6
"""m, of the chassis box ahead of base_link: 0.10 + 1.00 / 2."""
CHASSIS = "rosbots::base_link::base_link_collision"


def vector(message):
    return np.array([message.x, message.y, message.z])


def read(world, seconds):
    box = world.mailbox("/bumpers", size=10_000)
    world.run(seconds)
    box.close()
    return box.drain()


def naming(make, robot, *names):
    """The robot with a bumper that asks for these collisions."""
    return make.with_sensors(
        robot,
        lambda sensor: (
            dataclasses.replace(sensor, collisions=names) if sensor.type == "contact" else sensor
        ),
    )


def push(make, robot, *, static=True, seconds=3.0):
    """The cart at full torque against a wall whose face is at x = 1."""
    wall = make.box(
        "wall", (0.5, 3, 1), mass=2000, mu=0.5, static=static, pose=Pose((1.25, 0, 0.5))
    )
    world = make.world(wall)
    world.session.spawn(robot, pose=Pose((0, 0, 0.01)))
    world.publish(COMMAND, linear_x=0.5)
    world.run(seconds)
    return world


def test_nothing_touches_and_it_says_so_fifty_times_a_second(make, rosbots):
    world = make.world()
    world.session.spawn(rosbots, pose=Pose((0, 0, 0.05)))
    messages = read(world, 2.0)
    assert len(messages) == 101
    assert all(len(message.states) == 0 for message in messages)
    # As Gazebo: the frame's name is the tag's, the values are the world's.
    assert messages[0].header.frame_id == "base_link"


@pytest.mark.parametrize("static", [True, False])
def test_pushing_a_wall(make, rosbots, static):
    """Both motors stall: 2 T / r at the wheels' rims is what the wall bears."""
    world = push(make, rosbots, static=static)
    (state,) = read(world, 0.02)[-1].states
    assert state.collision1_name == CHASSIS
    assert state.collision2_name == "wall::link::collision"
    total = vector(state.total_wrench.force)
    assert total[0] == pytest.approx(-2 * TORQUE / RADIUS, rel=0.01)
    assert total == pytest.approx(
        np.sum([vector(wrench.force) for wrench in state.wrenches], axis=0)
    )
    count = len(state.contact_positions)
    assert count == len(state.contact_normals) == len(state.depths) == len(state.wrenches) >= 1
    for position, normal, depth in zip(
        state.contact_positions, state.contact_normals, state.depths, strict=True
    ):
        # On the wall's face, to half of what the contact gives way; over the box's front.
        assert position.x == pytest.approx(1.0, abs=1e-3)
        assert abs(position.y) <= 0.45 + 1e-3
        assert 0.14 - 1e-2 <= position.z <= 0.36 + 1e-2
        assert vector(normal) == pytest.approx([-1, 0, 0], abs=0.01)
        assert 0 <= depth < 1e-3
    x = world.model("rosbots").pose.x
    assert x == pytest.approx(1.0 - FRONT, abs=1e-3)


def test_torques_are_about_the_links_centre_of_mass(make, rosbots):
    world = push(make, rosbots)
    (state,) = read(world, 0.02)[-1].states
    simulation = world.session.simulation
    centre = simulation.data.body("rosbots::base_link").xipos
    assert len(state.wrenches) >= 1
    for position, wrench in zip(state.contact_positions, state.wrenches, strict=True):
        expected = np.cross(vector(position) - centre, vector(wrench.force))
        assert vector(wrench.torque) == pytest.approx(expected, abs=1e-6)


def contacts_of(world, model):
    """All contacts of a model, each with the model's geom first."""
    simulation = world.session.simulation
    simulation.refresh()
    names = [
        simulation.model.geom(i).name
        for i in range(simulation.model.ngeom)
        if simulation.model.geom(i).name.startswith(f"{model}::")
    ]
    return read_contacts(simulation.model, simulation.data, names)


def test_forces_balance(make, rosbots):
    """In the steady push all contacts and the weight add up to nothing: m a = 0."""
    world = push(make, rosbots)
    contacts = contacts_of(world, "rosbots")
    total = np.sum([contact.force for contact in contacts], axis=0)
    weight = rosbots.mass * G
    assert total == pytest.approx([0, 0, weight], abs=0.01 * weight)
    # And it is no empty balance: the wall takes 154 N of it.
    wall = sum(c.force[0] for c in contacts if c.second.startswith("wall"))
    assert wall < -100


def test_standing_weight_is_borne_by_wheels_and_caster(make, rosbots):
    """By the lever: the caster bears m g x / x_caster, x that of the centre of mass."""
    world = make.world()
    world.session.spawn(rosbots, pose=Pose((0, 0, 0.01)))
    world.run(2.0)
    borne = {}
    for contact in contacts_of(world, "rosbots"):
        borne[contact.first] = borne.get(contact.first, 0.0) + contact.force[2]
    weight = rosbots.mass * G
    assert sum(borne.values()) == pytest.approx(weight, rel=1e-3)
    moment = sum(
        link.inertial.mass * (link.pose @ link.inertial.pose).x
        for link in rosbots.links
        if link.inertial
    )
    caster = borne["rosbots::caster_link::caster_link_collision"]
    assert caster == pytest.approx(moment * G / 0.45, rel=5e-3)


def test_action_is_reaction(make, rosbots):
    world = push(make, rosbots, static=False)
    ours = [c for c in contacts_of(world, "rosbots") if c.second.startswith("wall")]
    theirs = [c for c in contacts_of(world, "wall") if c.second.startswith("rosbots")]
    assert len(ours) == len(theirs) >= 1
    for one, other in zip(ours, theirs, strict=True):
        assert one.force == pytest.approx(-other.force)
        assert one.normal == pytest.approx(-other.normal)
        assert one.position == pytest.approx(other.position)
        assert (one.first, one.second) == (other.second, other.first)


def test_pushing_a_box_along_takes_its_friction(make, rosbots):
    """A steady push of a box on ground reads mu (m g + F), F what rubs it down on the bumper."""
    mass, mu = 20, 0.3
    box = make.box("box", (0.6, 0.6, 0.6), mass=mass, mu=mu, pose=Pose((1.2, 0, 0.3)))
    world = make.world(box)
    world.session.spawn(rosbots, pose=Pose((0, 0, 0.01)))
    world.publish(COMMAND, linear_x=0.3)
    world.run(4.0)
    messages = read(world, 4.0)
    forces = [
        np.sum(
            [vector(state.total_wrench.force) for state in message.states] or [[0, 0, 0]], axis=0
        )
        for message in messages
    ]
    # Averaged over four seconds, as the box skips a little.
    x, _, z = np.mean(forces, axis=0)
    assert x == pytest.approx(-mu * (mass * G + z), rel=0.05)
    assert {state.collision2_name for m in messages for state in m.states} == {
        "box::link::collision"
    }


@pytest.mark.parametrize(
    "name",
    [
        "base_link_collision",
        "base_footprint_fixed_joint_lump__base_link_collision",
        "base_footprint_collision_base_link",
        "rosbots::base_footprint::base_footprint_fixed_joint_lump__base_link_collision",
        "base_link::base_link_collision",
        "  base_link_collision ",
    ],
)
def test_every_spelling_of_a_collision_works(make, rosbots, name):
    world = push(make, naming(make, rosbots, name))
    assert not coded(world, devices.CONTACT_COLLISION_UNKNOWN)
    assert read(world, 0.02)[-1].states[0].collision1_name == CHASSIS


def test_a_wrong_collision_is_reported_with_the_likely_one(make, rosbots):
    world = make.world()
    world.session.spawn(naming(make, rosbots, "base_link_colision"), pose=Pose((0, 0, 0.05)))
    (reported,) = [d for d in world.diagnostics if d.severity == "warning"]
    assert reported.code is devices.CONTACT_COLLISION_UNKNOWN
    assert reported.values["collision"] == "base_link_colision"
    assert reported.values["meant"] == "base_link_collision"
    assert reported.origin is not None


@pytest.mark.wording
def test_the_hint_and_the_values_name_the_same_collision(make, rosbots):
    world = make.world()
    world.session.spawn(naming(make, rosbots, "base_collide"), pose=Pose((0, 0, 0.05)))
    (warned,) = [d for d in world.diagnostics if d.severity == "warning"]
    assert warned.values["meant"]
    assert str(warned.values["meant"]) in warned.hint


def test_a_bumper_without_a_collision_is_reported(make, rosbots):
    world = make.world()
    world.session.spawn(naming(make, rosbots), pose=Pose((0, 0, 0.05)))
    assert coded(world, devices.SENSOR_INCOMPLETE, missing="collision")


def test_what_rests_on_a_standing_bumper_is_felt_for_as_long_as_it_rests(make):
    """The weight of a box on a plate, also after both have long been at rest."""
    plate = make.sdf(
        """<model name="plate"><static>1</static><link name="link">
        <collision name="c"><pose>0 0 0.05 0 0 0</pose>
          <geometry><box><size>1 1 0.1</size></box></geometry></collision>
        <sensor name="s" type="contact"><update_rate>50</update_rate>
          <contact><collision>c</collision></contact>
          <plugin name="b" filename="libgazebo_ros_bumper.so">
            <bumperTopicName>bumpers</bumperTopicName></plugin></sensor>
        </link></model>"""
    )
    box = make.box("box", (0.3, 0.3, 0.3), mass=5, pose=Pose((0, 0, 0.25)))
    world = make.world(plate, box)
    world.run(5.0)
    messages = read(world, 1.0)
    assert len(messages) == 50
    for message in messages:
        forces = [vector(state.total_wrench.force) for state in message.states]
        assert forces
        assert np.sum(forces, axis=0) == pytest.approx([0, 0, -5 * G], rel=0.01, abs=0.1)


def test_a_contact_sensor_of_new_gazebo_needs_no_plugin(make):
    box = make.sdf(
        """<model name="box"><pose>0 0 0.5 0 0 0</pose><link name="l"><inertial><mass>3</mass>
        <inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>
        <collision name="c"><geometry><box><size>1 1 1</size></box></geometry></collision>
        <sensor name="s" type="contact"><update_rate>10</update_rate>
        <contact><collision>c</collision><topic>touch</topic></contact></sensor></link>
        <plugin name="p" filename="gz-sim-contact-system"/></model>"""
    )
    world = make.world(box)
    world.run(1.0)
    mailbox = world.mailbox("/touch", size=100)
    world.run(1.0)
    messages = mailbox.drain()
    assert len(messages) == 10
    (state,) = messages[-1].states
    assert state.collision1_name == "box::l::c"
    assert state.total_wrench.force.z == pytest.approx(3 * G, rel=0.02)


STOOL = """<model name="stool"><pose>0 0 0.25 0 0 0</pose><link name="seat"><inertial>
  <pose>0 0.1 0 0 0 0</pose><mass>4</mass><inertia><ixx>.2</ixx><iyy>.2</iyy><izz>.2</izz></inertia>
  </inertial>{legs}
  <sensor name="s" type="contact"><update_rate>50</update_rate><contact>{watched}</contact>
    <plugin name="b" filename="libgazebo_ros_bumper.so">
    <bumperTopicName>bumpers</bumperTopicName><frameName>seat</frameName></plugin></sensor>
  </link></model>"""
LEGS = {"left": (-0.4, -0.2), "right": (0.4, -0.2), "back": (0.0, 0.4)}


def test_a_sensor_watches_several_collisions(make):
    """Three legs bear the load that follows from the lever; the unnamed one is not published."""
    legs = "".join(
        f"""<collision name="{name}"><pose>{x} {y} 0 0 0 0</pose><geometry><sphere>
        <radius>0.25</radius></sphere></geometry></collision>"""
        for name, (x, y) in LEGS.items()
    )
    watched = "".join(f"<collision>{name}</collision>" for name in ("back", "left"))
    world = make.world(make.sdf(STOOL.format(legs=legs, watched=watched)))
    world.run(2.0)
    message = read(world, 0.1)[-1]
    assert [state.collision1_name for state in message.states] == [
        "stool::seat::back",
        "stool::seat::left",
    ]
    # The weight lies 0.3 m of 0.6 m behind the front legs, which share the other half.
    borne = dict(zip(("back", "left"), (0.5, 0.25), strict=True))
    for state, (leg, share) in zip(message.states, borne.items(), strict=True):
        assert state.collision2_name == "ground_plane::link::collision"
        assert vector(state.total_wrench.force) == pytest.approx([0, 0, share * 4 * G], abs=0.02)
        (place,), (normal,) = state.contact_positions, state.contact_normals
        assert vector(place) == pytest.approx([*LEGS[leg], 0], abs=1e-3)
        assert vector(normal) == pytest.approx([0, 0, 1], abs=1e-6)
        assert 0 <= state.depths[0] < 1e-3
        # About the centre of mass of the seat.
        arm = vector(place) - [0, 0.1, 0.25]
        lever = np.cross(arm, vector(state.total_wrench.force))
        assert vector(state.total_wrench.torque) == pytest.approx(lever, abs=1e-3)
    assert message.header.frame_id == "seat"


def test_what_rests_on_a_bumper_that_is_bolted_down_is_felt_too(make):
    plate = make.sdf(
        """<model name="plate"><link name="link"><pose>0 0 0.05 0 0 0</pose>
        <collision name="c"><geometry><box><size>1 1 0.1</size></box></geometry></collision>
        <sensor name="s" type="contact"><update_rate>50</update_rate>
          <contact><collision>c</collision></contact>
          <plugin name="b" filename="libgazebo_ros_bumper.so">
            <bumperTopicName>bumpers</bumperTopicName></plugin></sensor></link>
        <joint name="bolt" type="fixed"><parent>world</parent><child>link</child></joint></model>"""
    )
    world = make.world(plate, make.box("box", (0.3, 0.3, 0.3), mass=5, pose=Pose((0, 0, 0.25))))
    world.run(5.0)
    messages = read(world, 0.1)
    assert len(messages) == 5
    for message in messages:
        (state,) = message.states
        assert vector(state.total_wrench.force) == pytest.approx([0, 0, -5 * G], abs=1e-3)
