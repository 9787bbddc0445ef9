"""Wrenches and efforts: what a body gains is force times duration, about the right point."""

import math

import numpy as np
import pytest
from tests.coded import coded

from cartwheel.codes.graph import SERVICE_FAILED
from cartwheel.geometry import Pose, quat_from_rpy, rotate

from .conftest import notes, vec, xyz

MASS, SIDE = 2.0, 0.5
INERTIA = MASS * SIDE**2 / 6
STEP = 0.005
TURNED = quat_from_rpy(0.3, -0.4, 1.1)


def floating(make, gazebo):
    """A cube without weight, somewhere and turned."""
    at = Pose((3.0, -1.0, 5.0), TURNED)
    world = make.world(make.box("cube", (SIDE,) * 3, mass=MASS, pose=at), ground=None, gravity=0.0)
    return gazebo(world)


def motion(api, link="cube::link"):
    state = api.done("get_link_state", link_name=link).link_state
    return vec(state.twist.linear), vec(state.twist.angular)


def time(seconds):
    return {"sec": math.floor(seconds), "nanosec": round((seconds % 1) * 1e9)}


def push(api, force=(0, 0, 0), torque=(0, 0, 0), *, body="cube::link", start=0.0, last=0.0, **more):
    return api.done(
        "apply_body_wrench",
        body_name=body,
        wrench={"force": xyz(force), "torque": xyz(torque)},
        start_time=time(start),
        duration=time(last),
        **more,
    )


@pytest.mark.parametrize("last", [0.005, 0.1, 0.1234567, 0.002, 1.0])
@pytest.mark.parametrize("start", [0.0, 0.3, 0.3021])
def test_momentum_is_force_times_duration(make, gazebo, start, last):
    """Also where neither begin nor end falls on a step."""
    api = floating(make, gazebo)
    push(api, (4.0, -2.0, 1.0), start=start, last=last)
    api.world.run(start // STEP * STEP)
    before, _ = motion(api)
    assert np.abs(before).max() == 0.0, "it began too early"
    api.world.run(2.0)
    linear, angular = motion(api)
    assert linear == pytest.approx(np.array([4.0, -2.0, 1.0]) * last / MASS, rel=1e-9)
    assert np.abs(angular).max() < 1e-12
    assert not api.simulation.forces.active


def test_a_turning_push_turns_about_the_centre(make, gazebo):
    api = floating(make, gazebo)
    push(api, torque=(0.0, 0.0, 0.6), last=0.5)
    api.world.run(1.0)
    linear, angular = motion(api)
    assert angular == pytest.approx([0, 0, 0.6 * 0.5 / INERTIA], abs=1e-9)
    assert np.abs(linear).max() < 1e-12


def test_a_torque_is_given_in_the_frames_axes(make, gazebo):
    api = floating(make, gazebo)
    push(api, torque=(0.6, 0.0, 0.0), reference_frame="cube::link", last=0.01)
    api.world.run(0.01)
    expected = np.array(rotate(TURNED, (0.6, 0.0, 0.0))) * 0.01 / INERTIA
    assert motion(api)[1] == pytest.approx(expected, rel=1e-9)


def test_without_duration_it_lasts_one_step(make, gazebo):
    api = floating(make, gazebo)
    push(api, (10.0, 0.0, 0.0))
    api.world.run(1.0)
    assert motion(api)[0] == pytest.approx([10.0 * STEP / MASS, 0, 0], rel=1e-9)


def test_below_zero_it_lasts_until_it_is_cleared(make, gazebo):
    api = floating(make, gazebo)
    push(api, (1.0, 0.0, 0.0), last=-1)
    api.world.run(3.0)
    assert motion(api)[0][0] == pytest.approx(3.0 / MASS, rel=1e-9)
    api("clear_body_wrenches", body_name="cube::link")
    api.world.run(1.0)
    assert motion(api)[0][0] == pytest.approx(3.0 / MASS, rel=1e-9)
    assert not api.simulation.forces.active


def test_pushes_add_up(make, gazebo):
    api = floating(make, gazebo)
    push(api, (1.0, 0.0, 0.0), last=1.0)
    push(api, (2.0, 3.0, 0.0), start=0.5, last=0.25)
    api.world.run(2.0)
    assert motion(api)[0] == pytest.approx([1.5 / MASS, 0.75 / MASS, 0], rel=1e-9)


ARM = np.array([0.0, 0.2, 0.1])
FORCE = np.array([1.5, -0.5, 0.7])


@pytest.mark.parametrize(
    ("frame", "turn", "arm"),
    [
        # In the world's frame and in the body's own the point counts from the centre of mass.
        ("", (0, 0, 0, 1), ARM),
        ("world", (0, 0, 0, 1), ARM),
        ("map", (0, 0, 0, 1), ARM),
        ("cube::link", TURNED, rotate(TURNED, ARM)),
        # In another's it is that point: 2 m to the left of the cube.
        ("other", (0, 0, 0, 1), ARM + np.array([0, 2, 0])),
    ],
)
def test_the_point_of_a_push(make, gazebo, frame, turn, arm):
    """One short push: angular momentum r x F t, the cube's inertia being the same all round."""
    api = floating(make, gazebo)
    api.world.session.spawn(make.box("other", (0.1,) * 3), pose=Pose((3.0, 1.0, 5.0)))
    push(api, FORCE, reference_frame=frame, reference_point=xyz(ARM), last=0.01)
    api.world.run(0.01)
    force = np.array(rotate(turn, FORCE))
    linear, angular = motion(api)
    assert linear == pytest.approx(force * 0.01 / MASS, rel=1e-6)
    assert angular == pytest.approx(np.cross(arm, force) * 0.01 / INERTIA, rel=1e-3, abs=1e-6)


def test_a_push_keeps_its_direction_while_the_body_turns(make, gazebo):
    """Given in the body's frame, it is turned into the world's axes once, as in Gazebo."""
    api = floating(make, gazebo)
    push(api, torque=(0, 0, 1.0), last=0.5)
    push(api, (1.0, 0, 0), reference_frame="cube::link", last=2.0)
    api.world.run(2.0)
    direction = np.array(rotate(TURNED, (1.0, 0, 0)))
    assert motion(api)[0] == pytest.approx(direction * 2.0 / MASS, rel=1e-9)
    assert motion(api)[1][2] > 1.0, "it should have turned"


def test_off_the_links_origin_it_acts_at_the_centre_of_mass(make, gazebo):
    """A rod whose mass is 1 m from its link's origin: pushed at its centre, it does not turn."""
    rod = make.sdf(
        """<model name="rod"><link name="l"><inertial><pose>1 0 0 0 0 0</pose><mass>3</mass>
        <inertia><ixx>.1</ixx><iyy>.2</iyy><izz>.2</izz></inertia></inertial></link></model>"""
    )
    api = gazebo(make.world(rod, ground=None, gravity=0.0))
    push(api, (0.0, 6.0, 0.0), body="rod::l", last=0.5)
    api.world.run(0.5)
    linear, angular = motion(api, "rod::l")
    assert linear == pytest.approx([0, 1.0, 0], abs=1e-9)
    assert np.abs(angular).max() < 1e-9


def test_it_goes_on_when_another_model_is_spawned_and_deleted(make, gazebo):
    api = floating(make, gazebo)
    push(api, (4.0, 0.0, 0.0), last=1.0)
    api.world.run(0.303)
    api.world.session.spawn(make.box("other", (0.1,) * 3), pose=Pose((0, 0, 9.0)))
    api.world.run(0.2)
    api.done("delete_model", model_name="other")
    api.world.run(1.0)
    assert motion(api)[0][0] == pytest.approx(4.0 / MASS, rel=1e-9)


def test_it_goes_on_over_a_change_of_the_step(make, gazebo):
    api = floating(make, gazebo)
    push(api, (4.0, 0.0, 0.0), start=0.2, last=0.7)
    api.world.run(0.4)
    set_step(api, 0.003)
    api.world.run(1.0)
    assert motion(api)[0][0] == pytest.approx(4.0 * 0.7 / MASS, rel=1e-9)


def set_step(api, step):
    now = api.done("get_physics_properties")
    request = api.request("set_physics_properties")
    for field in ("max_update_rate", "gravity", "ode_config"):
        setattr(request, field, getattr(now, field))
    request.time_step = step
    assert api("set_physics_properties", request).success


def test_it_ends_with_its_model(make, gazebo):
    api = floating(make, gazebo)
    push(api, (4.0, 0.0, 0.0), last=-1)
    api.world.run(0.1)
    api.done("delete_model", model_name="cube")
    api.world.run(0.1)
    api.world.session.spawn(make.box("cube", (SIDE,) * 3), pose=Pose((0, 0, 5.0)))
    api.world.run(0.5)
    assert motion(api)[0][0] == 0.0


def test_reset_ends_it_and_reset_world_does_not(make, gazebo):
    api = floating(make, gazebo)
    push(api, (4.0, 0.0, 0.0), last=-1)
    api.world.run(0.5)
    api("reset_world")
    api.world.run(0.5)
    assert motion(api)[0][0] == pytest.approx(4.0 * 0.5 / MASS, rel=1e-9)
    api("reset_simulation")
    api.world.run(0.5)
    assert motion(api)[0][0] == 0.0


def test_a_sleeping_box_is_woken(make, gazebo):
    """It rests until it sleeps, and slides off under more than its friction."""
    world = make.world(
        make.box("cube", (SIDE,) * 3, mass=MASS, mu=0.5, pose=Pose((0, 0, SIDE / 2)))
    )
    api = gazebo(world)
    world.run(5.0)
    assert (api.simulation.data.tree_asleep >= 0).all(), "it should sleep"
    resting = world.model("cube").pose.x
    push(api, (2 * 0.5 * MASS * 9.8, 0.0, 0.0), start=6.0, last=0.5)
    world.run(1.0)
    assert world.model("cube").pose.x == resting
    world.run(0.5)
    # a = (2 - 1) mu g.
    assert world.model("cube").pose.x - resting == pytest.approx(0.5 * 0.5 * 9.8 * 0.25, rel=0.03)


ARM_MODEL = """<model name="arm"><link name="base"/>
    <joint name="fix" type="fixed"><parent>world</parent><child>base</child></joint>
    <link name="bar"><inertial><mass>1</mass>
      <inertia><ixx>.5</ixx><iyy>.5</iyy><izz>.5</izz></inertia></inertial></link>
    <joint name="hinge" type="revolute"><parent>base</parent><child>bar</child>
      <axis><xyz>0 0 1</xyz>{limit}</axis></joint></model>"""


def arm(make, gazebo, limit=""):
    return gazebo(make.world(make.sdf(ARM_MODEL.format(limit=limit)), ground=None, gravity=0.0))


@pytest.mark.parametrize("name", ["hinge", "arm::hinge"])
def test_joint_effort(make, gazebo, name):
    api = arm(make, gazebo)
    api.done(
        "apply_joint_effort", joint_name=name, effort=2.0, start_time=time(0.1), duration=time(0.33)
    )
    api.world.run(1.0)
    rate = api.done("get_joint_properties", joint_name=name).rate
    assert rate == pytest.approx([2.0 * 0.33 / 0.5], rel=1e-9)


def test_joint_effort_until_cleared(make, gazebo):
    api = arm(make, gazebo)
    api.done("apply_joint_effort", joint_name="hinge", effort=1.0, duration={"sec": -1})
    api.world.run(1.0)
    api("clear_joint_forces", joint_name="hinge")
    api.world.run(1.0)
    rate = api.done("get_joint_properties", joint_name="hinge").rate
    assert rate == pytest.approx([1.0 / 0.5], rel=1e-9)


def test_joint_effort_stays_within_the_joints_limit(make, gazebo):
    api = arm(make, gazebo, "<limit><effort>0.5</effort></limit>")
    answer = api.done("apply_joint_effort", joint_name="hinge", effort=-3.0, duration=time(1))
    assert len(notes(answer)) == 1
    api.world.run(2.0)
    rate = api.done("get_joint_properties", joint_name="hinge").rate
    assert rate == pytest.approx([-0.5 / 0.5], rel=1e-9)


@pytest.mark.wording
def test_the_effort_within_the_limit_is_said(make, gazebo):
    api = arm(make, gazebo, "<limit><effort>0.5</effort></limit>")
    answer = api.done("apply_joint_effort", joint_name="hinge", effort=-3.0, duration=time(1))
    assert "reduces the effort to -0.5" in answer.status_message


def test_none_cost_nothing(make, gazebo):
    api = floating(make, gazebo)
    push(api, (1.0, 0, 0), last=0.1)
    served = []
    forces = api.simulation.forces
    serve = forces.serve
    forces.serve = lambda: served.append(api.simulation.time_ns) or serve()
    api.world.run(0.2)
    assert not forces.active
    assert not api.simulation.data.xfrc_applied.any()
    # It is asked while something pushes, and not once more.
    before = len(served)
    assert before >= 2
    api.world.run(0.2)
    assert len(served) == before


@pytest.mark.wording
def test_refusals(make, gazebo):
    api = arm(make, gazebo)
    wrench = {"force": {"x": 1.0}}
    assert 'Did you mean "arm::bar"?' in api.refused("apply_body_wrench", body_name="arm::baar")
    message = api.refused(
        "apply_body_wrench", body_name="bar", reference_frame="bra", wrench=wrench
    )
    assert "reference frame" in message
    message = api.refused("apply_body_wrench", body_name="base", wrench=wrench)
    assert "fixed to the world" in message
    message = api.refused("apply_body_wrench", body_name="bar", wrench={"force": {"y": math.nan}})
    assert "wrench.force.y must be a finite number (got nan)" in message
    message = api.refused("apply_body_wrench", body_name="bar", wrench={"torque": {"z": 1e300}})
    assert "wrench.torque.z" in message
    assert '"hinge"' in api.refused("apply_joint_effort", joint_name="hing", effort=1.0)
    assert "cannot be moved by a force" in api.refused(
        "apply_joint_effort", joint_name="fix", effort=1.0
    )
    assert "effort must be a finite number (got inf)" in api.refused(
        "apply_joint_effort", joint_name="hinge", effort=math.inf
    )


def test_clearing_what_does_not_exist_is_reported_once(make, gazebo):
    api = arm(make, gazebo)
    for _ in range(3):
        api("clear_body_wrenches", body_name="nobody")
        api("clear_joint_forces", joint_name="nothing")
    failed = coded(api.world.diagnostics, SERVICE_FAILED)
    assert [each.values["name"] for each in failed] == ["nobody", "nothing"]
