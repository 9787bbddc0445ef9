"""Gravity, step length and speed while it runs; pause and reset."""

import math

import numpy as np
import pytest
from tests.coded import coded

from cartwheel.codes.graph import SERVICE_FAILED
from cartwheel.geometry import Pose
from cartwheel.simulation import RunState

from .conftest import notes

G = 9.8


def settings(api, **changes):
    """A request of the present settings with changes."""
    now = api.done("get_physics_properties")
    request = api.request("set_physics_properties")
    for field in ("time_step", "max_update_rate", "gravity", "ode_config"):
        setattr(request, field, getattr(now, field))
    for field, value in changes.items():
        target = request
        *outer, last = field.split("__")
        for name in outer:
            target = getattr(target, name)
        setattr(target, last, value)
    return request


def change(api, **changes):
    answer = api("set_physics_properties", settings(api, **changes))
    assert answer.success, answer.status_message
    return answer


def fall(n, h, g=G):
    return g * h * h * n * (n + 1) / 2


@pytest.fixture
def falling(make, gazebo):
    return gazebo(make.world(make.box("cube", (0.5,) * 3, pose=Pose((0, 0, 100))), ground=None))


def test_what_is_published_at_first(falling):
    now = falling.done("get_physics_properties")
    assert now.time_step == 0.005
    assert now.max_update_rate == pytest.approx(200.0)
    assert (now.gravity.x, now.gravity.y, now.gravity.z) == (0.0, 0.0, -G)
    assert not now.pause
    # As Gazebo 11 returns them.
    ode = now.ode_config
    assert (ode.sor_pgs_iters, ode.max_contacts, ode.sor_pgs_w) == (50, 20, 1.3)
    assert (ode.erp, ode.cfm, ode.contact_surface_layer) == (0.2, 0.0, 0.001)


def test_published_values_may_be_set_again(falling):
    version = falling.simulation.scene.version
    answer = change(falling)
    assert answer.status_message == "physics engine updated"
    assert falling.simulation.scene.version == version, "nothing was compiled"
    assert falling.simulation.speed == 1.0


@pytest.mark.parametrize("spawn", [False, True])
def test_gravity(make, falling, spawn):
    """A second of falling, then gravity along x: z goes on at its speed."""
    falling.world.run(1.0)
    change(falling, gravity__x=2.0, gravity__z=0.0)
    if spawn:
        falling.world.session.spawn(make.box("other", (0.1,) * 3, pose=Pose((50, 0, 0))))
    falling.world.run(1.0)
    x, _, z = falling.world.model("cube").pose.position
    assert z == pytest.approx(100 - fall(200, 0.005) - G * 1.0 * 1.0)
    assert x == pytest.approx(fall(200, 0.005, 2.0))


def test_gravity_wakes_what_sleeps(make, gazebo):
    world = make.world(make.box("cube", (0.5,) * 3, mu=1.0, pose=Pose((0, 0, 0.25))))
    api = gazebo(world)
    world.run(5.0)
    assert (api.simulation.data.tree_asleep >= 0).all()
    change(api, gravity__z=5.0)
    world.run(1.0)
    assert world.model("cube").pose.z == pytest.approx(0.25 + fall(200, 0.005, 5.0), abs=1e-2)


def test_the_step_changes_while_time_goes_on(falling):
    """Free fall over n steps is exact for each length, so the steps made are seen in it."""
    world, simulation = falling.world, falling.simulation
    world.run(0.5)
    change(falling, time_step=0.001, max_update_rate=1000.0)
    assert simulation.time_ns == 500_000_000
    assert simulation.speed == pytest.approx(1.0)
    world.run(0.5)
    assert simulation.time_ns == 1_000_000_000
    speed = G * 0.5
    expected = 100 - fall(100, 0.005) - speed * 0.5 - fall(500, 0.001)
    assert world.model("cube").pose.z == pytest.approx(expected, abs=1e-9)
    assert falling.done("get_physics_properties").time_step == 0.001
    assert falling.done("get_world_properties").sim_time == 1.0


def test_a_step_that_is_no_divisor_of_the_run(falling):
    falling.world.run(0.01)
    change(falling, time_step=0.003)
    falling.world.run(0.01)
    assert falling.simulation.time_ns == 10_000_000 + 4 * 3_000_000


def test_reset_after_a_change_of_the_step(falling):
    falling.world.run(0.5)
    change(falling, time_step=0.002)
    falling.world.run(0.5)
    falling("reset_simulation")
    assert falling.simulation.time_ns == 0
    falling.world.run(1.0)
    assert falling.world.model("cube").pose.z == pytest.approx(100 - fall(500, 0.002))
    assert falling.simulation.time_ns == 1_000_000_000


def test_clock_and_rates_go_on_over_a_change(make, gazebo, rosbots):
    """/clock 100 Hz, odometry 100 Hz, IMU 30 Hz: at the first step at or after each due time."""
    world = make.world()
    world.session.spawn(rosbots, pose=Pose((0, 0, 0.05)))
    api = gazebo(world)
    boxes = {name: world.mailbox(name) for name in ("/clock", "/odom", "/imu/data")}
    world.run(0.335)
    change(api, time_step=0.002)
    world.run(0.665)
    steps = [*range(0, 335_000_000, 5_000_000), *range(335_000_000, 1_002_000_000, 2_000_000)]

    def expected(rate):
        due = [math.ceil(k * 1e9 / rate) for k in range(rate + 1)]
        return [next(step for step in steps if step >= time) for time in due]

    def stamps(messages):
        return [m.sec * 1_000_000_000 + m.nanosec for m in messages]

    assert stamps([m.clock for m in boxes["/clock"].drain()]) == expected(100)
    assert stamps([m.header.stamp for m in boxes["/odom"].drain()]) == expected(100)
    assert stamps([m.header.stamp for m in boxes["/imu/data"].drain()]) == expected(30)


def test_the_cart_drives_as_far_at_another_step(make, gazebo, rosbots):
    """Contacts and motors are those of the new step: 0.5 m/s reached with 1 m/s2."""
    world = make.world()
    world.session.spawn(rosbots, pose=Pose((0, 0, 0.05)))
    api = gazebo(world)
    world.run(1.0)
    change(api, time_step=0.001)
    start = world.model("rosbots").pose.x
    world.publish("/part2_cmr/cmd_vel", linear_x=0.5)
    world.run(4.0)
    assert world.model("rosbots").pose.x - start == pytest.approx(4 * 0.5 - 0.125, abs=0.02)


@pytest.mark.parametrize(
    ("rate", "speed"), [(200.0, 1.0), (100.0, 0.5), (1000.0, 5.0), (0.0, None), (-1.0, None)]
)
def test_the_rate_is_the_speed(falling, rate, speed):
    change(falling, max_update_rate=rate)
    assert falling.simulation.speed == (None if speed is None else pytest.approx(speed))
    reported = falling.done("get_physics_properties").max_update_rate
    assert reported == pytest.approx(max(rate, 0.0))


def test_odes_parameters_are_kept_and_that_is_said(falling):
    answer = change(falling, ode_config__sor_pgs_iters=300, ode_config__erp=0.5)
    assert len(notes(answer)) == 1
    ode = falling.done("get_physics_properties").ode_config
    assert (ode.sor_pgs_iters, ode.erp) == (300, 0.5)
    assert not notes(change(falling))


@pytest.mark.wording
def test_odes_parameters_without_effect_are_named(falling):
    answer = change(falling, ode_config__sor_pgs_iters=300, ode_config__erp=0.5)
    assert "sor_pgs_iters, erp: stored, but has no effect" in answer.status_message


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"time_step": 0.0}, "time_step must be above 0"),
        ({"time_step": -0.001}, "above 0"),
        ({"time_step": math.nan}, "time_step must be a finite number (got nan)"),
        ({"time_step": 1.0}, "at most 0.1 s"),
        ({"gravity__y": math.inf}, "gravity.y must be a finite number (got inf)"),
        ({"max_update_rate": math.nan}, "max_update_rate must be a finite number (got nan)"),
        ({"ode_config__cfm": math.nan}, "ode_config.cfm must be a finite number (got nan)"),
    ],
)
@pytest.mark.wording
def test_refusals_change_nothing(falling, changes, said):
    before = falling.done("get_physics_properties")
    request = settings(falling, **{"gravity__x": 3.0} | changes)
    answer = falling("set_physics_properties", request)
    assert not answer.success
    assert said in answer.status_message
    assert falling.done("get_physics_properties") == before


# -- pause and reset


def test_pause_and_unpause(falling):
    falling("pause_physics")
    assert falling.simulation.run_state is RunState.PAUSED
    assert falling.done("get_physics_properties").pause
    falling.world.run(0.5)
    assert falling.simulation.time_ns == 0
    falling("unpause_physics")
    assert not falling.done("get_physics_properties").pause
    falling.world.run(0.5)
    assert falling.simulation.time_ns == 500_000_000


def moved(make, gazebo, rosbots):
    """A cart and a box spawned while it ran, both far from where they began."""
    world = make.world()
    world.session.spawn(rosbots, pose=Pose((0, 0, 0.05)))
    api = gazebo(world)
    world.publish("/part2_cmr/cmd_vel", linear_x=0.5)
    world.run(2.0)
    world.session.spawn(make.box("late", (0.2,) * 3, pose=Pose((0, 3, 2.0))))
    world.run(1.0)
    assert world.model("late").pose.z < 0.2
    assert world.model("rosbots").pose.x > 1.0
    return api


@pytest.mark.parametrize("service", ["reset_simulation", "reset_world"])
def test_reset_returns_every_model(make, gazebo, rosbots, service):
    """Those that were spawned stay, where and as they were spawned."""
    api = moved(make, gazebo, rosbots)
    api(service)
    world = api.world
    assert world.models == ("ground_plane", "rosbots", "late")
    assert world.model("late").pose.position == pytest.approx((0, 3, 2))
    assert world.model("rosbots").pose.position == pytest.approx((0, 0, 0.05))
    assert world.model("rosbots").joint("wheel_left_joint") == 0.0
    assert np.abs(api.simulation.data.qvel).max() == 0.0
    time = 0 if service == "reset_simulation" else 3_000_000_000
    assert api.simulation.time_ns == time
    # It stands until it is commanded to drive.
    world.run(2.0)
    assert world.model("rosbots").pose.x == pytest.approx(0.0, abs=0.01)
    assert api.simulation.time_ns == time + 2_000_000_000


def test_the_clock_goes_on_over_a_reset_of_the_world(make, gazebo, rosbots):
    api = moved(make, gazebo, rosbots)
    box = api.world.mailbox("/clock", size=1000)
    api("reset_world")
    api.world.run(0.1)
    assert [message.clock.sec for message in box.drain()] == [3] * 10


def test_a_reset_while_it_is_paused_leaves_it_paused(falling):
    falling.world.run(1.0)
    falling("pause_physics")
    falling("reset_simulation")
    assert falling.simulation.run_state is RunState.PAUSED
    assert falling.world.model("cube").pose.z == 100.0


def run_with_calls(make, gazebo, rosbots, pieces):
    """All kinds of calls at simulated times, the run cut into pieces."""
    world = make.world(make.box("cube", (0.3,) * 3, pose=Pose((2, 0.1, 0.15))))
    world.session.spawn(rosbots, pose=Pose((0, 0, 0.05)))
    api = gazebo(world)
    world.publish("/part2_cmr/cmd_vel", linear_x=0.5, angular_z=0.1)
    states = []
    calls = {
        0.5: lambda: api.done(
            "apply_body_wrench",
            body_name="cube::link",
            wrench={"force": {"x": 3.0, "y": 9.0}},
            start_time={"nanosec": 801_234_567},
            duration={"nanosec": 300_000_001},
        ),
        1.0: lambda: change(api, time_step=0.003),
        1.5: lambda: world.session.spawn(make.box("late", (0.2,) * 3, pose=Pose((0, 3, 1)))),
        2.0: lambda: api.done(
            "set_link_properties",
            link_name="cube::link",
            mass=4.0,
            ixx=0.1,
            iyy=0.1,
            izz=0.1,
            gravity_mode=True,
        ),
        2.5: lambda: api.done("set_model_state", model_state={"model_name": "late"}),
    }
    for start, call in {0.0: lambda: None, **calls}.items():
        call()
        end = round((start + 0.5) * 1e9)
        for piece in pieces:
            world.run(piece)
            world.model("cube")
        world.session.simulation.advance(end)
        states.append(np.concatenate([api.simulation.data.qpos, api.simulation.data.qvel]))
    return states


def test_the_same_calls_at_the_same_times_give_the_same_bits(make, gazebo, rosbots):
    once = run_with_calls(make, gazebo, rosbots, [])
    again = run_with_calls(make, gazebo, rosbots, [0.006, 0.03, 0.2])
    for first, second in zip(once, again, strict=True):
        assert first.tobytes() == second.tobytes()


# -- dynamic_reconfigure


def configure(api, **values):
    lists = {"doubles": [], "ints": [], "bools": []}
    for name, value in values.items():
        kind = {float: "doubles", int: "ints", bool: "bools"}[type(value)]
        lists[kind].append({"name": name, "value": value})
    return reported(api("set_parameters", config=lists).config)


def reported(config):
    return {
        item.name: item.value
        for kind in ("doubles", "ints", "bools")
        for item in getattr(config, kind)
    }


def latest(api, topic):
    box = api.world.mailbox(f"/gazebo/{topic}")
    api.simulation.drain()
    message = box.drain()[-1]
    box.close()
    return message


def test_parameters_are_those_of_gazebo(falling):
    """Names, bounds and values as a Gazebo 11 printed them; the step and its rate are our own."""
    description = latest(falling, "parameter_descriptions")
    (group,) = description.groups
    assert [parameter.name for parameter in group.parameters] == [
        "time_step",
        "max_update_rate",
        "gravity_x",
        "gravity_y",
        "gravity_z",
        "auto_disable_bodies",
        "sor_pgs_precon_iters",
        "sor_pgs_iters",
        "sor_pgs_w",
        "sor_pgs_rms_error_tol",
        "cfm",
        "erp",
        "contact_surface_layer",
        "contact_max_correcting_vel",
        "max_contacts",
    ]
    assert reported(description.max)["gravity_z"] == 100.0
    assert reported(description.min)["sor_pgs_rms_error_tol"] == -1.0
    assert reported(description.dflt)["sor_pgs_iters"] == 20
    assert reported(latest(falling, "parameter_updates")) == {
        "auto_disable_bodies": False,
        "sor_pgs_precon_iters": 0,
        "sor_pgs_iters": 50,
        "max_contacts": 20,
        "time_step": 0.005,
        "max_update_rate": 200.0,
        "gravity_x": 0.0,
        "gravity_y": 0.0,
        "gravity_z": -9.8,
        "sor_pgs_w": 1.3,
        "sor_pgs_rms_error_tol": 0.0,
        "cfm": 0.0,
        "erp": 0.2,
        "contact_surface_layer": 0.001,
        "contact_max_correcting_vel": 100.0,
    }


def test_a_parameter_counts_and_is_reported(falling):
    answer = configure(falling, gravity_z=0.0, time_step=0.002)
    assert answer["gravity_z"] == 0.0
    falling.world.run(1.0)
    assert falling.world.model("cube").pose.z == pytest.approx(100.0)
    assert falling.simulation.step_ns == 2_000_000
    assert falling.done("get_physics_properties").time_step == 0.002
    assert reported(latest(falling, "parameter_updates"))["time_step"] == 0.002


def test_the_service_returns_the_parameters(falling):
    change(falling, gravity__y=1.5)
    assert reported(latest(falling, "parameter_updates"))["gravity_y"] == 1.5


def test_a_parameter_leaves_what_was_changed_elsewhere(falling):
    """The page's speed is not taken back by a client that sets gravity."""
    falling.simulation.set_speed(3.0)
    answer = configure(falling, gravity_x=1.0)
    assert falling.simulation.speed == pytest.approx(3.0)
    assert answer["max_update_rate"] == pytest.approx(600.0)


def test_a_parameter_that_cannot_be_is_answered_with_what_is(falling):
    answer = configure(falling, time_step=0.0)
    assert answer["time_step"] == 0.005
    assert coded(falling.world.diagnostics, SERVICE_FAILED, property="time_step")
