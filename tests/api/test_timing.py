"""Steps, conditions and timed actions, and what has been published when a run returns."""

import hashlib
import math
import pickle
import threading
import time as wall
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from tests.coded import raises

import cartwheel as cw
from cartwheel.codes.command import OPTION_INVALID
from cartwheel.codes.world import (
    CONDITION_INVALID,
    NUMBER_OUT_OF_RANGE,
    RUN_NESTED,
    SIMULATION_CLOSED,
    STEP_COUNT_INVALID,
    VALUE_INVALID,
    WAIT_TIMED_OUT,
)
from cartwheel.errors import CartwheelError, SimulationError
from cartwheel.messages import encode_cdr, message_class

CMD = "/part2_cmr/cmd_vel"
STEP = 0.005
BAD = [math.nan, math.inf, -1.0, True, np.True_, "1", None, [1.0], 1e10]


def stamp(message: Any) -> float:
    stamp = message.header.stamp
    return float(stamp.sec + stamp.nanosec * 1e-9)


def traces(pieces: list[float | int], *, look: bool = False) -> dict[str, Any]:
    """States and messages of a cart that is run in pieces: floats are s, integers are steps."""
    with cw.World("walls", seed=3) as world:
        cart = world.spawn("rosbots.xacro")
        topics = [world.topic(each.name, keep=10_000) for each in world.graph.topics()]
        for time, speed in ((0.0, 0.5), (0.5, -0.3), (0.7333, 0.4), (1.0, 0.1)):
            world.on(time, lambda speed=speed: cart.publish(CMD, linear_x=speed, angular_z=0.2))
        for piece in pieces:
            if isinstance(piece, int):
                world.step(piece)
            else:
                world.run(piece)
            if look:
                _ = cart.pose
        data = world.session.simulation.data
        result = {"time": world.time, "state": data.qpos.tobytes() + data.qvel.tobytes()}
        for topic in topics:
            text = b"".join(bytes(encode_cdr(message)) for message in topic.history())
            result[topic.name] = topic.count, hashlib.sha256(text).hexdigest()
        return result


def test_a_run_in_pieces_gives_the_same_states_and_messages() -> None:
    whole = traces([1.2])
    assert whole["/odom"][0] == 121
    assert whole["/imu/data"][0] == 37
    assert whole["/rosbots/camera1/image_raw"][0] == 37
    assert traces([0.6, 0.6]) == whole
    assert traces([0.0, 0.5, 0.0, 0.0, 0.235, 0.465], look=True) == whole
    assert traces([1] * 240) == whole
    assert traces([100, 0.5, 39, 1], look=True) == whole


def test_what_is_due_at_the_target_has_been_published() -> None:
    with cw.World("walls") as world:
        world.spawn("rosbots.xacro")
        odometry, images = world.topic("/odom"), world.topic("/rosbots/camera1/image_raw")
        world.run(1.0)
        assert stamp(odometry.latest) == odometry.latest_time == 1.0
        assert stamp(images.latest) == 1.0
        assert images.count == 31
        world.spin(0.5, speed=20.0)
        assert stamp(odometry.latest) == 1.5
        world.run(0.5, speed=20.0)
        assert stamp(odometry.latest) == 2.0
        assert odometry.count == 201


def test_a_stopped_run_continues_with_what_was_due() -> None:
    with cw.World("empty") as world:
        clock = world.topic("/clock")
        world.on(0.1, world.stop)
        world.run(1.0)
        assert world.time == pytest.approx(0.1)
        world.run(0.1)
        times = [message.clock.nanosec for message in clock.history()]
        assert times == [index * 10_000_000 for index in range(21)]


def test_a_command_between_runs_acts_at_once() -> None:
    """A drive without a ramp has the same path as with commands at the same times of one run."""

    def path(between: bool) -> float:
        with cw.World("empty") as world:
            cart = world.spawn("rosbots.xacro")
            if between:
                world.run(0.5)
                cart.publish(CMD, linear_x=0.3)
                world.run(1.0)
            else:
                world.on(0.5, lambda: cart.publish(CMD, linear_x=0.3))
                world.run(1.5)
            return cart.pose.x

    # The ramp of 1 m/s² begins at the next update, 10 ms later: v dt = 0.3 m/s 0.01 s.
    assert path(True) == pytest.approx(path(False), abs=0.3 * 0.01 + 1e-3)


def test_a_change_between_runs_is_not_lost(make: Any) -> None:
    """A forward pass of the last run is reused only while nothing changes."""
    world = make.world(make.box("box", (0.2, 0.2, 0.2), static=False, pose=cw.Pose((0, 0, 5))))
    falling = world.topic("/clock")
    world.run(0.5)
    assert falling.latest_time == 0.5
    box = world.model("box")
    box.pose = cw.Pose((0, 0, 3.0))
    world.step()
    # From rest: g dt².
    assert box.pose.z == pytest.approx(3.0 - 9.8 * STEP**2, abs=1e-6)
    data = world.session.simulation.data
    world.run(0.1)
    data.qvel[2] = 1.0
    before = box.pose.z
    world.step()
    assert box.pose.z == pytest.approx(before + (1.0 - 9.8 * STEP) * STEP, abs=1e-9)


def test_a_forward_pass_is_made_once(make: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    world = make.world(make.box("box", (0.2, 0.2, 0.2), static=False, pose=cw.Pose((0, 0, 5))))
    world.topic("/clock")
    engine = world.session.simulation.engine
    made = []
    monkeypatch.setattr(
        engine, "forward", lambda forward=engine.forward: made.append(engine.step) or forward()
    )
    for _ in range(10):
        world.step(2)
        _ = world.model("box").pose
        _ = world.model("box").pose
    assert made == [0, *range(2, 21, 2)]


def test_steps() -> None:
    with cw.World("empty") as world:
        world.step()
        assert world.time == STEP
        world.step(9)
        assert world.time == 0.05
        for bad in (0, -1, 1.0, True, "1", None, 10**10):
            with raises(STEP_COUNT_INVALID):
                world.step(bad)  # type: ignore[arg-type]
        assert world.time == 0.05


@pytest.mark.parametrize("bad", BAD)
def test_bad_times_are_refused(bad: Any) -> None:
    with cw.World("empty") as world:
        uses: list[Callable[[], object]] = [
            lambda: world.run(bad),
            lambda: world.run_until(lambda: True, timeout=bad),
            lambda: world.on(bad, lambda: None),
            lambda: world.every(bad, lambda: None),
            lambda: world.topic("/clock").wait(timeout=bad),
        ]
        if bad is not None:
            uses += [
                lambda: world.spin(bad),
                lambda: world.run_until(lambda: False, period=bad),
                lambda: world.topic("/clock").hold(rate=bad),
            ]
        uses.append(lambda: world.run_until(lambda: False, period=0))
        for use in uses:
            with raises(NUMBER_OUT_OF_RANGE):
                use()
        assert world.time == 0.0


def test_a_closed_world_refuses() -> None:
    world = cw.World("empty")
    world.close()
    for use in (
        world.step,
        lambda: world.run_until(lambda: True),
        lambda: world.on(1.0, lambda: None),
        lambda: world.every(1.0, lambda: None),
        lambda: world.topic("/clock"),
    ):
        with raises(SIMULATION_CLOSED, SimulationError):
            use()


def test_an_action_is_repeated_at_a_rate() -> None:
    times: list[float] = []
    with cw.World("empty") as world:
        world.run(0.5)
        timer = world.every(10.0, lambda: times.append(world.time))
        world.run(0.35)
        assert times == pytest.approx([0.5, 0.6, 0.7, 0.8])
        times.clear()
        world.reset()
        world.run_until(lambda: world.time > 0.15)
        assert times == pytest.approx([0.0, 0.1]) and timer.pending
        timer.cancel()
        world.run(0.5)
        assert len(times) == 2 and not timer.pending
        world.every(10.0, lambda: 1 / 0)
        with pytest.raises(ZeroDivisionError):
            world.run(0.1)


def test_it_runs_until_a_condition_holds() -> None:
    with cw.World("empty") as world:
        cart = world.spawn("rosbots.xacro")
        cart.publish(CMD, linear_x=0.5)
        world.run_until(lambda: cart.pose.x > 1.0, timeout=5.0)
        assert 1.0 < cart.pose.x < 1.0 + 0.5 * STEP + 1e-9
        reached = world.time
        world.run_until(lambda: cart.pose.x > 1.0)
        assert world.time == reached
        # 0.25 s from 0: the first evaluation after 1.5 m, which is reached at 3.25 s.
        world.run_until(lambda given: given.model("rosbots").pose.x > 1.5, period=0.25)
        assert world.time - reached == pytest.approx(1.0)


def test_a_condition_sees_the_messages_of_its_time() -> None:
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        odometry = world.topic("/odom")
        world.run_until(lambda: odometry.count == 11)
        assert world.time == stamp(odometry.latest) == 0.1


def test_a_timeout_names_the_condition_and_its_values() -> None:
    with cw.World("empty") as world:
        cart = world.spawn("rosbots.xacro")
        limit = 2.0
        with raises(WAIT_TIMED_OUT, cw.TimedOutError, timeout=0.5, time=0.5) as caught:
            world.run_until(lambda: cart.pose.x > limit, timeout=0.5)
        assert isinstance(caught.value, TimeoutError)
        assert isinstance(caught.value, CartwheelError)
        assert world.time == 0.5
        values = caught.value.values
        assert values["condition"] == "cart.pose.x > limit"
        assert abs(float(str(values["cart.pose.x"]))) < 0.01
        assert values["limit"] == "2.0"
        copy = pickle.loads(pickle.dumps(caught.value))
        assert isinstance(copy, cw.TimedOutError)
        assert copy.values == values

        def arrived() -> bool:
            return False

        with raises(WAIT_TIMED_OUT, condition="arrived"):
            world.run_until(arrived, timeout=0.1)


def test_an_error_of_a_condition_is_raised_after_the_step() -> None:
    with cw.World("empty") as world:

        def broken() -> bool:
            if world.time >= 0.1:
                raise ValueError("broken")
            return False

        with pytest.raises(ValueError, match="broken"):
            world.run_until(broken)
        assert world.time == pytest.approx(0.1)
        world.run(0.1)
        assert world.time == pytest.approx(0.2)


def test_an_array_is_no_condition() -> None:
    with cw.World("empty") as world, raises(CONDITION_INVALID):
        world.run_until(lambda: np.zeros(3) > 0, timeout=1.0)


@pytest.mark.parametrize("bad", [True, 1.0, None, "x > 1", lambda a, b: True])
def test_a_condition_that_cannot_be_called(bad: Any) -> None:
    with cw.World("empty") as world, raises(CONDITION_INVALID):
        world.run_until(bad)


def test_a_condition_that_runs_the_world_is_refused() -> None:
    with cw.World("empty") as world, raises(RUN_NESTED):
        world.run_until(lambda: world.run(1.0))


def test_stop_ends_a_wait() -> None:
    with cw.World("empty") as world:
        world.on(0.2, world.stop)
        world.run_until(lambda: False, timeout=10.0)
        assert world.time == pytest.approx(0.2)
        thread = threading.Timer(0.2, world.stop)
        thread.start()
        began = wall.monotonic()
        world.run_until(lambda: False, timeout=1e6)
        thread.join()
        assert wall.monotonic() - began < 30


def test_actions_run_at_their_times_before_the_step() -> None:
    with cw.World("empty") as world:
        reported: list[tuple[str, float]] = []

        def note(name: str) -> None:
            reported.append((name, world.time))

        world.on(0.2, lambda: note("second"))
        world.on(0.1, lambda: note("first"))
        world.on(0.2, lambda: note("third"))
        world.on(0.2012, lambda: note("within a step"))
        cancelled = world.on(0.15, lambda: note("never"))
        later = world.on(5.0, lambda: note("later"))
        assert (cancelled.time, cancelled.pending) == (0.15, True)
        cancelled.cancel()
        cancelled.cancel()
        world.on(0.25, lambda: world.on(0.3, lambda: note("from an action")))
        world.run(0.2)
        assert reported == [("first", 0.1), ("second", 0.2), ("third", 0.2)]
        world.run(0.2)
        assert reported[3:] == [("within a step", 0.205), ("from an action", 0.3)]
        assert not cancelled.pending
        assert later.pending
        with raises(NUMBER_OUT_OF_RANGE):
            world.on(0.39, lambda: None)
        with raises(OPTION_INVALID):
            world.on(0.5, None)  # type: ignore[arg-type]
        world.on(world.time, lambda: note("now"))
        world.step()
        assert reported[5:] == [("now", 0.4)]


def test_an_action_acts_in_its_step() -> None:
    with cw.World("empty") as world:
        cart = world.spawn("rosbots.xacro")
        commands = world.topic(CMD)
        world.on(0.5, lambda: cart.publish(CMD, linear_x=0.5))
        world.run(0.5)
        assert commands.latest_time == 0.5
        world.run(1.5)
        # 1 m/s² from the update at 0.5 s: v t - v²/2a, where each update is a step of the ramp.
        assert cart.pose.x == pytest.approx(0.5 * 1.5 - 0.5**2 / 2, abs=0.5 * 0.02)


def test_a_reset_removes_actions() -> None:
    with cw.World("empty") as world:
        reported: list[float] = []
        timer = world.on(0.2, lambda: reported.append(world.time))
        world.run(0.1)
        world.reset()
        assert not timer.pending
        world.run(0.5)
        assert reported == []
        world.on(0.6, world.reset)
        world.on(0.7, lambda: reported.append(world.time))
        world.run(0.5)
        world.run(1.0)
        assert reported == []


@pytest.mark.parametrize("speed", [None, 100.0])
def test_a_run_starts_again_after_a_reset(speed: float | None) -> None:
    with cw.World("empty") as world:
        world.run(0.3)
        world.on(0.5, world.reset)
        world.run(0.4, speed=speed)
        assert world.time == pytest.approx(0.4, abs=1e-9)
        world.on(0.5, world.reset)
        world.run_until(lambda: world.time < 0.2, timeout=0.4, speed=speed)
        assert world.time < 0.2
        world.on(0.3, world.reset)
        with pytest.raises(cw.TimedOutError) as caught:
            world.run_until(lambda: False, timeout=0.4, speed=speed)
        assert caught.value.values["time"] == pytest.approx(0.4, abs=0.01)
        world.on(world.time + 0.01, world.reset)
        world.step(20)
        assert world.time == pytest.approx(20 * world.step_size, abs=1e-9)


def test_a_reset_at_the_end_of_a_run_ends_it() -> None:
    with cw.World("empty") as world:
        world.on(0.5, world.reset)
        world.run(0.5)
        assert world.time == 0.0


def test_an_error_of_an_action_stops_the_run() -> None:
    with cw.World("empty") as world:

        def broken() -> None:
            raise ValueError("broken")

        world.on(0.1, broken)
        with pytest.raises(ValueError, match="broken"):
            world.run(1.0)
        assert world.time == pytest.approx(0.1, abs=STEP + 1e-9)
        world.on(0.3, broken)
        with pytest.raises(ValueError, match="broken"):
            world.run(0.3 - world.time)
        assert world.time == pytest.approx(0.3)
        world.run(0.1)


def test_a_robot_spawned_between_runs_is_served_at_once() -> None:
    with cw.World("empty") as world:
        world.run(0.5)
        world.spawn("rosbots.xacro")
        odometry = world.topic("/odom")
        world.run(0.0)
        assert odometry.times() == [0.5]
        world.run(0.1)
        assert odometry.count == 11


def test_an_action_that_is_no_function_is_named() -> None:
    with cw.World("empty") as world:
        with pytest.raises(cw.CartwheelError) as caught:
            world.on(99.0, None)  # type: ignore[arg-type]
        assert caught.value.code is OPTION_INVALID
        assert caught.value.values["name"] == "action"


def test_a_stamp_is_a_time():
    with cw.World() as world:
        cart = world.spawn("rosbots.xacro")
        world.keep_transforms()
        odometry = cart.topic("/odom")
        world.run(1.0)
        stamp = odometry.history()[30].header.stamp
        assert cw.seconds(stamp) == odometry.times()[30] == stamp.sec + stamp.nanosec / 1e9
        one, other = (world.transform("odom", "base_link", time=each)
                      for each in (stamp, cw.seconds(stamp)))  # fmt: skip
        assert one == other
        called = []
        stamp = message_class("builtin_interfaces/msg/Time")(sec=1, nanosec=500_000_000)
        world.on(stamp, lambda: called.append(world.time))
        world.run(1.0)
        assert called == [1.5]
        with raises(NUMBER_OUT_OF_RANGE, value=1.5, now=2.0):
            world.on(stamp, print)


def test_the_step_of_a_world_can_be_chosen():
    with cw.World("empty", step_size=0.001) as world:
        world.step(3)
        assert (world.step_size, world.time) == (0.001, 0.003)
    with cw.build("empty", ["rosbots.xacro"], step_size=0.002).world() as world:
        assert world.step_size == 0.002
        world.run(0.1)
    for wrong in (0.0, -1.0, 2.0, float("nan"), "1"):
        with raises(VALUE_INVALID):
            cw.World("empty", step_size=wrong)
