"""A change of the compiled model gives what a compilation of the changed descriptions gives."""

import dataclasses
import os
from pathlib import Path

import numpy as np
import pytest

import cartwheel as cw

ROOT = Path(__file__).parents[2]
CORPUS = Path(os.environ.get("CARTWHEEL_CORPUS", ROOT.parent / "shared" / "corpus"))
TURTLEBOT = "turtlebot3/turtlebot3_description/urdf/turtlebot3_"
PUBLISHED = {
    "burger": f"{TURTLEBOT}burger.urdf.xacro",
    "waffle": f"{TURTLEBOT}waffle.urdf.xacro",
    "mir": "mir_robot/mir_description/urdf/mir.urdf.xacro",
    "rrbot": "gazebo_ros_demos/rrbot_description/urdf/rrbot.xacro",
}
ROBOTS = ["rosbots.xacro", *PUBLISHED]

BOUNDS = {"bvh_aabb"}
"""Bounding volumes may be larger than needed."""
UNUSED = {"cam_mat0", "cam_pos0", "cam_poscom0", "light_dir0", "light_pos0", "light_poscom0"}
"""Of cameras and lights that follow bodies, which are not used."""


def arrays(model):
    """All arrays of a compiled model."""
    values = {name: getattr(model, name) for name in dir(model) if not name.startswith("_")}
    found = {name: one.copy() for name, one in values.items() if isinstance(one, np.ndarray)}
    for name in BOUNDS | UNUSED:
        found.pop(name, None)
    return found


def changed(before, after):
    """Names of the arrays that differ."""
    assert before.keys() == after.keys()
    return {name for name, one in before.items() if not np.array_equal(one, after[name])}


def compare(world, change, *, expected=()):
    """Makes a change, and compares the model with a compiled one; returns what has changed."""
    simulation = world.session.simulation
    before = arrays(simulation.model)
    model = simulation.model
    change()
    assert simulation.model is model, "it was compiled"
    made = arrays(model)
    world.session.simulation._population.compile()
    different = changed(made, arrays(simulation.model))
    assert different == set(expected), different
    return changed(before, made)


def spawned(name):
    if name in PUBLISHED:
        if not CORPUS.is_dir():
            pytest.skip(f"no corpus of others' robots in {CORPUS}")
        name = str(CORPUS / PUBLISHED[name])
    world = cw.World("empty", lenient=True)
    return world, world.spawn(name, z=0.1)


def redescribe(world, name, links=lambda link: link, joints=lambda joint: joint):
    simulation = world.session.simulation
    before = simulation.truth.description(name)
    after = dataclasses.replace(
        before, links=tuple(map(links, before.links)), joints=tuple(map(joints, before.joints))
    )
    simulation.redescribe(name, after)


def with_surface(link, **values):
    collisions = tuple(
        dataclasses.replace(each, surface=dataclasses.replace(each.surface, **values))
        for each in link.collisions
    )
    return dataclasses.replace(link, collisions=collisions)


def with_inertial(link, **values):
    if link.inertial is None:
        return link
    return dataclasses.replace(link, inertial=dataclasses.replace(link.inertial, **values))


@pytest.mark.parametrize("robot", ROBOTS)
def test_inertials(robot):
    world, model = spawned(robot)
    with world:

        def heavier(link):
            if link.inertial is None:
                return link
            own = link.inertial
            x, y, z = own.pose.position
            pose = cw.Pose.from_xyz_rpy((x + 0.001, y, z - 0.002), (0.1, 0.2, 0.3))
            return with_inertial(
                link, mass=own.mass * 1.5, ixx=own.ixx * 1.1, ixy=own.ixx * 0.01, pose=pose
            )

        made = compare(world, lambda: redescribe(world, model.name, links=heavier))
        assert {"body_mass", "body_inertia", "body_ipos", "dof_M0"} <= made
        simulation = world.session.simulation
        bodies = [simulation.engine.body_id(model.name, link) for link in model.links]
        assert model.mass == pytest.approx(simulation.model.body_mass[bodies].sum(), rel=1e-12)


@pytest.mark.parametrize("robot", ROBOTS)
def test_friction(robot):
    world, model = spawned(robot)
    with world:
        for mu in (0.3, 0.0, 50.0):
            made = compare(
                world,
                lambda mu=mu: redescribe(
                    world, model.name, links=lambda link: with_surface(link, mu1=mu, mu2=mu)
                ),
            )
            assert "geom_friction" in made


@pytest.mark.parametrize("robot", ROBOTS)
def test_damping_friction_and_limits_of_joints(robot):
    world, model = spawned(robot)
    with world:

        def damped(joint):
            return dataclasses.replace(
                joint, axis=dataclasses.replace(joint.axis, damping=0.3, friction=0.1, lower=-1.0)
            )

        made = compare(world, lambda: redescribe(world, model.name, joints=damped))
        assert "dof_damping" in made
        # The motors of wheels replace their friction.
        assert ("dof_frictionloss" in made) == (robot not in ("rosbots.xacro", "burger", "waffle"))


@pytest.mark.parametrize("robot", ROBOTS)
def test_efforts_and_velocities_of_joints(robot):
    world, model = spawned(robot)
    with world:
        for limit in (0.5, 30.0, None):

            def limited(limit=limit):
                for joint in model.joints.names:
                    model.joints[joint].effort_limit = limit

            made = compare(world, limited)
            assert "jnt_actfrcrange" in made or robot == "rrbot"

        def slow(joint):
            return dataclasses.replace(joint, axis=dataclasses.replace(joint.axis, velocity=0.3))

        compare(world, lambda: redescribe(world, model.name, joints=slow))


def test_gravity(make):
    world, model = spawned("rosbots.xacro")
    with world:
        for gravity in (False, True):
            made = compare(
                world,
                lambda gravity=gravity: redescribe(
                    world,
                    model.name,
                    links=lambda link: dataclasses.replace(link, gravity=gravity),
                ),
            )
            assert made == {"body_gravcomp"}
            assert world.session.simulation.model.flg_gravcomp is not gravity


@pytest.mark.parametrize("robot", ["wall", "rrbot"])
def test_poses_of_fixed_models(make, robot):
    if robot == "wall":
        world = cw.World("empty")
        model = world.spawn(make.box("wall", (0.2, 2, 1), static=True))
    else:
        world, model = spawned(robot)
    with world:
        world.spawn("object.urdf", name="box", x=5)
        pose = cw.Pose.from_xyz_rpy((1.0, 0.3, 0.5), (0.1, 0.2, 0.3))
        made = compare(world, lambda: setattr(model, "pose", pose))
        assert {"body_pos", "body_quat"} <= made


def test_different_coefficients_of_a_sliding_body(make):
    world = make.world(make.box("box", (0.2,) * 3, pose=cw.Pose((0, 0, 0.1))))
    for mu1, mu2 in ((0.5, 0.1), (0.1, 0.5), (0.3, 0.3)):
        compare(
            world,
            lambda mu1=mu1, mu2=mu2: redescribe(
                world, "box", links=lambda link: with_surface(link, mu1=mu1, mu2=mu2)
            ),
        )
        assert world.session.simulation.model.pair_friction[0, :2].tolist() == [
            max(mu1, mu2),
            min(mu1, mu2),
        ]


def test_what_changes_the_structure_is_compiled(make):
    """Different coefficients of a wheel need pairs that the model does not have."""
    world, cart = spawned("rosbots.xacro")
    with world:
        simulation = world.session.simulation
        before = simulation.model

        def slippery(link):
            return with_surface(link, mu1=1.0, mu2=0.1) if "wheel" in link.name else link

        redescribe(world, cart.name, links=slippery)
        assert simulation.model is not before
        assert (simulation.model.pair_friction[:, :2] == (1.0, 0.1)).all(axis=1).sum() == 2
        # The centre of mass of a body without joints leaves its frame.
        box = world.spawn(make.box("box", (0.2,) * 3), x=3)
        before = simulation.model
        redescribe(world, "box", links=lambda link: with_inertial(link, pose=cw.Pose((0.1, 0, 0))))
        assert simulation.model is not before
        compare(
            world,
            lambda: redescribe(
                world, "box", links=lambda link: with_inertial(link, pose=cw.Pose((0.2, 0, 0)))
            ),
        )
        assert box.mass == 2


@pytest.mark.parametrize("change", ["mass", "friction", "damping", "pose"])
def test_the_motion_has_the_same_bits(make, change):
    """Of a cart that drives into a wall on which a box rests: with and without a compilation."""

    def drive(*, compiles):
        world = make.world(
            make.box("wall", (0.2, 2, 0.4), static=True, pose=cw.Pose((2, 0, 0.2))),
            make.box("box", (0.2,) * 3, mass=0.5, pose=cw.Pose((2, 0, 0.5))),
        )
        cart = world.spawn("rosbots.xacro", z=0.05)
        world.publish("/part2_cmr/cmd_vel", linear_x=0.4, angular_z=0.1)
        world.run(2.0)
        assert (world.session.simulation.data.tree_asleep >= 0).any()
        if change == "mass":
            redescribe(
                world,
                cart.name,
                links=lambda link: (
                    with_inertial(link, mass=2 * link.inertial.mass) if link.inertial else link
                ),
            )
        elif change == "friction":
            redescribe(world, "box", links=lambda link: with_surface(link, mu1=0.1, mu2=0.1))
            redescribe(world, "wall", links=lambda link: with_surface(link, mu1=0.2, mu2=0.2))
        elif change == "damping":
            redescribe(
                world,
                cart.name,
                joints=lambda joint: dataclasses.replace(
                    joint, axis=dataclasses.replace(joint.axis, damping=0.5)
                ),
            )
        else:
            world.model("wall").pose = cw.Pose.from_xyz_rpy((1.2, 0, 0.2), (0, 0.2, 0.3))
        if compiles:
            world.session.simulation._population.compile()
        world.run(2.0)
        data = world.session.simulation.data
        return data.qpos.tolist(), data.qvel.tolist()

    assert drive(compiles=False) == drive(compiles=True)
