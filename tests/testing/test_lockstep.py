"""Lockstep with a node in another process, from a test in Python."""

import os
import sys
import threading
from pathlib import Path

import pytest
from tests.coded import raises

import cartwheel as cw
from cartwheel.codes.command import COMMAND_MISSING, LAUNCH_FAILED
from cartwheel.codes.graph import MESSAGE_TYPE_UNKNOWN, TOPIC_UNKNOWN
from cartwheel.codes.wires import QOS_INCOMPATIBLE
from cartwheel.codes.world import VALUE_INVALID, WAIT_TIMED_OUT
from cartwheel.errors import CartwheelError, TimedOutError, UnknownNameError
from cartwheel.msgs.geometry_msgs import Twist
from cartwheel.msgs.nav_msgs import Odometry
from cartwheel.msgs.sensor_msgs import Imu, NavSatFix
from cartwheel.testing import Node, launch, reaches

DRIVE = "/part2_cmr/cmd_vel"
CONTROLLER = Path(__file__).parents[2] / "examples" / "scenarios" / "ros2_controller.py"


@pytest.fixture
def domain(monkeypatch):
    """A ROS domain of the test's own."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(60 + os.getpid() % 40))


def drive():
    with cw.World("empty") as world:
        cart = world.spawn("rosbots.xacro")
        world.connect_ros2()
        with (
            launch([sys.executable, str(CONTROLLER)]) as program,
            world.lockstep(DRIVE, check=program.check, wall_timeout=30.0) as lock,
        ):
            world.run(0.5)
            start = world.time
            world.step(10)
            world.run_until(lambda: cart.pose.x > 0.5)
            reached = reaches(cart, (1.5, 0.0), within=0.05, timeout=10)
            assert lock.late == 0 and program.output == ""
        return cart.pose, reached - start


def test_two_runs_with_a_node_have_the_same_bits(domain):
    """Time stands still until the node is connected, so the first command arrives at one time."""
    first = drive()
    assert drive() == first


def test_a_program_that_fails_ends_the_run():
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        with raises(LAUNCH_FAILED, CartwheelError, status=1) as caught:
            fail(world)
        (note,) = caught.value.__notes__
        assert note.splitlines()[-1] == "  no map"
        world.run(0.5)


def fail(world):
    code = "print('one', flush=True); import sys; sys.exit('no map')"
    with (
        launch([sys.executable, "-S", "-c", code]) as program,
        world.lockstep(DRIVE, check=program.check),
    ):
        world.run(1.0)


def test_a_program_that_sends_no_command_ends_the_run(domain):
    with cw.World("empty") as world, Node("deaf") as node:
        world.spawn("rosbots.xacro")
        with (
            world.lockstep(DRIVE, start_timeout=0.3),
            raises(COMMAND_MISSING, TimedOutError, topics=(DRIVE,), connected=False),
        ):
            world.run(0.1)
        world.connect_ros2()
        heard = []
        node.subscribe("/imu/data", heard.append, type=Imu)
        node.subscribe("/gps/fix", heard.append, type=NavSatFix, reliable=True)
        world.graph.advertise("/gps/fix", "sensor_msgs/msg/NavSatFix", qos="sensor")
        with (
            world.lockstep(DRIVE, start_timeout=5.0),
            raises(COMMAND_MISSING, TimedOutError, timeout=5.0, connected=True) as caught,
        ):
            world.step()
        # Sensors are best effort, and the node accepts this unless it must be reliable.
        assert caught.value.values["read"] == ("/imu/data",)
        assert caught.value.values["warnings"] == (QOS_INCOMPATIBLE.number,)
        assert heard and {each.__msgtype__ for each in heard} == {"sensor_msgs/msg/Imu"}


def test_an_error_states_late_messages():
    with cw.World("empty") as world:
        world.spawn("rosbots.xacro")
        world.on(0.05, lambda: world.graph.publish(DRIVE, "geometry_msgs/msg/Twist", Twist()))
        with pytest.raises(ZeroDivisionError) as caught:
            run_late(world)
        (note,) = caught.value.__notes__
        assert "2 periods" in note and DRIVE in note


def run_late(world):
    with world.lockstep(DRIVE, wall_timeout=0.01, period=0.1):
        world.run(0.25)
        _ = 1 / 0


def test_time_runs_freely_again_after_the_block():
    with cw.World("empty") as world:
        cart = world.spawn("rosbots.xacro")
        stop = threading.Event()

        def command() -> None:
            # As fast as a node in another process, which does not wait.
            while not stop.wait(0.001):
                world.graph.publish(DRIVE, "geometry_msgs/msg/Twist", Twist())

        thread = threading.Thread(target=command)
        thread.start()
        try:
            with world.lockstep(DRIVE, period=0.05):
                with raises(WAIT_TIMED_OUT, TimedOutError):
                    world.run_until(lambda: cart.pose.x > 1.0, timeout=0.3)
                with raises(VALUE_INVALID, name="lockstep"):
                    world.lockstep(DRIVE)
        finally:
            stop.set()
            thread.join()
        before = world.time
        world.run(1.0)
        assert world.time == pytest.approx(before + 1.0)


def test_nodes_exchange_messages(domain):
    heard, done = [], threading.Event()

    def take(message: Odometry) -> None:
        heard.append(message.pose.pose.position.x)
        done.set()

    with Node("one") as one, Node("two") as two:
        two.subscribe("/place", take, type=Odometry)
        publisher = one.advertise("place", "nav_msgs/msg/Odometry")
        assert (publisher.topic, publisher.type) == ("/place", "nav_msgs/msg/Odometry")
        for _ in range(300):
            publisher.publish(pose={"pose": {"position": {"x": 2.5}}})
            if done.wait(0.1):
                break
    assert heard[0] == 2.5
    one.close()


def test_nodes_know_the_types_of_packages(domain, tmp_path):
    package = tmp_path / "plant_msgs"
    (package / "msg").mkdir(parents=True)
    (package / "package.xml").write_text(
        "<package><name>plant_msgs</name><depend>ament_cmake</depend></package>"
    )
    (package / "msg" / "Leaf.msg").write_text("float64 area\nstring[] colors\n")
    heard, done = [], threading.Event()
    with Node("one", package_path=[tmp_path]) as one, Node("two") as two:
        with raises(MESSAGE_TYPE_UNKNOWN, UnknownNameError):
            two.advertise("/leaf", "plant_msgs/msg/Stem")
        leaf = one.message_class("plant_msgs/msg/Leaf")
        # A latched message arrives although it was sent before.
        one.advertise("/leaf", leaf, latched=True).publish(area=0.5, colors=["green"])
        two.subscribe(
            "/leaf", lambda message: (heard.append(message), done.set()), type=leaf, latched=True
        )
        assert done.wait(30)
    assert heard == [leaf(area=0.5, colors=["green"])]


def test_what_cannot_run_in_lockstep_is_refused():
    with cw.World("empty") as world:
        with raises(TOPIC_UNKNOWN, UnknownNameError, name="/cmd_vel"):
            world.lockstep("/cmd_vel")
        world.run(0.1)
        world.spawn("rosbots.xacro")
        for name in ("period", "wall_timeout", "start_timeout"):
            with raises(VALUE_INVALID, name=name):
                world.lockstep(DRIVE, **{name: 0.0})
        with raises(VALUE_INVALID, name="commands"):
            world.lockstep([])
        world.run(0.1)
