"""Calls that a world refuses at once."""

import math
import subprocess
import sys
import traceback

import numpy as np
import pytest
from tests.coded import raises

import cartwheel as cw
from cartwheel.codes.command import OPTION_INVALID, OPTIONS_CONFLICT
from cartwheel.codes.graph import FIELD_VALUE_INVALID, GRAPH_NAME_INVALID, MESSAGE_TYPE_UNKNOWN
from cartwheel.codes.world import (
    MODEL_NAME_INVALID,
    NUMBER_OUT_OF_RANGE,
    PROPERTY_ABSENT,
    REAL_TIME_FACTOR_INVALID,
    SIMULATION_CLOSED,
    VALUE_INVALID,
)
from cartwheel.errors import CartwheelError, GraphError, SimulationError
from cartwheel.messages import from_dict
from cartwheel.msgs.geometry_msgs import Twist, Vector3


def test_a_callback_cannot_run_its_world(make):
    world = make.world()
    world.subscribe("/clock", lambda _: world.run(0.1))
    with pytest.raises(SimulationError) as caught:
        world.run(0.5)
    assert caught.value.code.name == "run-nested"
    assert world.time < 0.1


@pytest.mark.parametrize("value", ["hi", 3, object()])
def test_a_value_that_is_no_message_is_refused_at_once(value, make, rosbots):
    world = make.world()
    cart = world.spawn(rosbots, z=0.1)
    topic = "/part2_cmr/cmd_vel"
    with pytest.raises(GraphError) as caught:
        world.publish(topic, value)
    assert caught.value.code.name == "field-value-invalid"
    assert caught.value.values["type"] == "geometry_msgs/msg/Twist"
    # The drive works as before.
    world.publish(topic, from_dict("geometry_msgs/msg/Twist", {}))
    cart.publish(topic, linear_x=0.4)
    world.run(2)
    assert cart.pose.x > 0.3


def test_a_message_of_another_type_is_refused_at_once(make, rosbots):
    world = make.world()
    world.spawn(rosbots, z=0.1)
    with pytest.raises(GraphError) as caught:
        world.publish("/part2_cmr/cmd_vel", from_dict("std_msgs/msg/String", {}))
    assert caught.value.values["given"] == "std_msgs/msg/String"


@pytest.mark.parametrize("value", ["hi", 3, from_dict("std_msgs/msg/String", {})])
def test_a_publisher_refuses_what_is_no_message_of_its_type(value, make):
    world = make.world()
    publisher = world.advertise("/level", "std_msgs/Float32")
    level = world.mailbox("/level")
    with pytest.raises(GraphError) as caught:
        publisher.publish(value)
    assert caught.value.code is FIELD_VALUE_INVALID
    assert caught.value.values["type"] == "std_msgs/msg/Float32"
    assert (level.drain(), publisher.sent) == ([], 0)
    publisher.publish(from_dict("std_msgs/msg/Float32", {"data": 2.0}))
    assert [message.data for message in level.drain()] == [2.0]


def twist(x):
    return Twist(linear=Vector3(x=x))


def of_values(x):
    return {"linear": {"x": x}}


def of_parts(x):
    return {"linear": Vector3(x=x)}


@pytest.mark.parametrize("value", [np.array([0.2]), None, "0.2", True, [0.2], 10**400])
@pytest.mark.parametrize("made", [twist, of_values, of_parts])
def test_a_wrong_value_in_a_message_is_refused_at_once(made, value, make, rosbots):
    world = make.world()
    cart = world.spawn(rosbots, z=0.1)
    topic = world.topic("/part2_cmr/cmd_vel")
    publisher = world.advertise("/part2_cmr/cmd_vel", Twist)
    with raises(FIELD_VALUE_INVALID, GraphError, field="linear.x"):
        cart.publish("/part2_cmr/cmd_vel", made(value))
    with raises(FIELD_VALUE_INVALID, GraphError, field="linear.x"):
        topic.hold(made(value))
    if made is twist:
        with raises(FIELD_VALUE_INVALID, GraphError, field="linear.x"):
            publisher.publish(made(value))
    if made is of_values:
        with raises(FIELD_VALUE_INVALID, GraphError, field="linear.x"):
            cart.publish("/part2_cmr/cmd_vel", linear_x=value)
    assert topic.count == 0
    # The drive works as before.
    cart.publish("/part2_cmr/cmd_vel", made(0.4))
    world.run(2)
    assert cart.pose.x > 0.3


@pytest.mark.parametrize("value", [np.array(0.5), np.float32(0.5), np.float64(0.5)])
def test_numbers_of_numpy_are_numbers(value, make):
    world = make.world()
    topic = world.topic("/command", Twist)
    publisher = world.advertise("/command", Twist)
    publisher.publish(twist(value))
    world.publish("/command", twist(value))
    world.publish("/command", of_values(value))
    world.publish("/command", linear_x=value)
    world.run(0.1)
    assert [message.linear.x for message in topic.history()] == [0.5] * 4
    assert all(isinstance(message.linear.x, float) for message in topic.history())


def test_a_message_with_the_types_of_its_fields_is_published_itself(make):
    world = make.world()
    topic = world.topic("/command", Twist)
    message = twist(0.5)
    world.publish("/command", message)
    world.run(0.1)
    assert topic.latest is message
    given = twist(1)
    world.publish("/command", given)
    world.run(0.1)
    assert topic.latest == given and topic.latest is not given


@pytest.mark.parametrize("type", ["nonsense", "std_msgs/msg/Nothing", "a/b/c/d", "", 3])
def test_a_subscription_to_a_type_that_does_not_exist_is_refused(type, make):
    world = make.world()
    with raises(MESSAGE_TYPE_UNKNOWN, CartwheelError):
        world.subscribe("/level", print, type=type)
    assert "/level" not in [topic.name for topic in world.graph.topics()]
    heard = []
    world.subscribe("/level", heard.append, type="std_msgs/Float32")
    world.publish("/level", data=1.0)
    world.run(0.1)
    assert [message.data for message in heard] == [1.0]


@pytest.mark.parametrize("seconds", [-1, -1e-9, math.nan, math.inf, -math.inf, 2e9])
@pytest.mark.parametrize("method", ["run", "spin"])
def test_a_run_has_a_finite_duration(method, seconds, make):
    world = make.world()
    with raises(NUMBER_OUT_OF_RANGE, CartwheelError):
        getattr(world, method)(seconds)
    # Differences of times are rounded.
    getattr(world, method)(-1e-12)
    getattr(world, method)(0)
    assert world.time == 0


def test_a_closed_world_refuses_everything_but_its_results(make, rosbots):
    world = make.world()
    cart = world.spawn(rosbots, z=0.1)
    clock = world.mailbox("/clock")
    world.run(0.1)
    pose, models = cart.pose, world.models
    world.close()
    for use in (
        lambda: world.run(0.1),
        lambda: world.spin(0.1),
        lambda: world.spawn(rosbots),
        lambda: world.publish("/part2_cmr/cmd_vel"),
        lambda: cart.publish("/part2_cmr/cmd_vel"),
        lambda: world.subscribe("/clock", print),
        lambda: world.subscribe("/level", print, type="std_msgs/Float32"),
        lambda: world.advertise("/level", "std_msgs/Float32"),
        lambda: world.mailbox("/clock"),
        world.reset,
        world.show,
        cart.delete,
    ):
        with raises(SIMULATION_CLOSED, SimulationError):
            use()
    world.stop()
    world.close()
    assert (cart.pose, world.models, world.time) == (pose, models, 0.1)
    assert len(clock.drain()) == 11


def test_options_of_ros2_and_mailboxes_are_checked(make):
    with raises(OPTION_INVALID, CartwheelError, option="rmw", value="fastrtps"):
        cw.World("empty", ros2=True, rmw="fastrtps")
    world = make.world()
    with raises(OPTION_INVALID, CartwheelError, option="rmw", value=""):
        world.connect_ros2(rmw="")
    for size in (0, -1):
        with raises(NUMBER_OUT_OF_RANGE, CartwheelError, value=size):
            world.mailbox("/clock", size=size)


def test_a_pose_and_a_velocity_have_their_classes(make, rosbots):
    cart = make.world().spawn(rosbots)
    for wrong in ((1.0, 2.0, 3.0), None):
        with raises(VALUE_INVALID, name="pose"):
            cart.pose = wrong
        with raises(VALUE_INVALID, name="velocity"):
            cart.velocity = wrong


def test_a_link_without_a_mass_names_those_with_one(make, rosbots):
    base = make.world().spawn(rosbots).link("base_footprint")
    for use in (lambda: setattr(base, "mass", 2.0), lambda: base.inertia):
        with raises(PROPERTY_ABSENT, name="base_footprint", property="mass") as caught:
            use()
        assert "base_link" in caught.value.values["links"]
    with raises(PROPERTY_ABSENT, property="collision") as caught:
        base.friction = 1.0
    assert "wheel_left_link" in caught.value.values["links"]


def test_completion_knows_what_has_not_been_imported():
    code = "import cartwheel, sys; print(*dir(cartwheel)); assert 'numpy' not in sys.modules"
    shown = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert set(cw.__all__) | {"__version__"} <= set(shown.stdout.split())


def test_arguments_of_a_wrong_kind_are_named(make, rosbots):
    world = make.world()
    wrong = {
        "world": [lambda: cw.World(5), lambda: cw.World(None), lambda: cw.build(5)],
        "strict": [lambda: cw.World(strict="no")],
        "viewer": [lambda: cw.World(viewer="x")],
        "foxglove": [lambda: cw.World(foxglove="x")],
        "package_path": [
            lambda: cw.World(package_path=5),
            lambda: world.spawn(rosbots, package_path=5),
        ],
        "plugins": [lambda: cw.World(plugins=b"x")],
        "bridge": [lambda: cw.World(bridge=[5])],
        "record": [lambda: cw.World(record=5)],
        "without": [lambda: cw.World(without=5)],
        "robot": [lambda: world.spawn(5), lambda: cw.build("empty", [5])],
        "robots": [lambda: cw.build("empty", 5)],
        "name": [
            lambda: world.spawn(rosbots, name=5),
            lambda: world.model(5),
            lambda: world.model("ground_plane").link(5),
            lambda: world.model("ground_plane").joint(5),
            lambda: world.light(5),
            lambda: world.topic(5),
        ],
        "namespace": [lambda: world.spawn(rosbots, namespace=5)],
        "frame_prefix": [lambda: world.spawn(rosbots, frame_prefix=5)],
        "arguments": [lambda: world.spawn(rosbots, arguments=5)],
        "controllers": [lambda: world.spawn(rosbots, controllers=5)],
        "topic": [
            lambda: world.publish(5),
            lambda: world.subscribe(5, print),
            lambda: world.advertise(5, "std_msgs/msg/Empty"),
            lambda: world.mailbox(5),
        ],
        "callback": [lambda: world.subscribe("/clock", 5)],
        "service": [lambda: world.call(5)],
        "action": [lambda: world.send_goal(5)],
        "file": [lambda: world.record(5).__enter__()],
    }
    for name, calls in wrong.items():
        for call in calls:
            with raises(OPTION_INVALID, name=name):
                call()
    assert world.models == ("ground_plane",)


@pytest.mark.parametrize("prefix", ["a b", " ", "left\n", "a/\tb"])
def test_a_frame_prefix_without_a_valid_name(prefix, make, rosbots):
    world = make.world()
    with raises(GRAPH_NAME_INVALID, name=prefix):
        world.spawn(rosbots, frame_prefix=prefix)
    assert world.models == ("ground_plane",)


@pytest.mark.parametrize("seed", ["x", -1, 1.5, True, None])
def test_a_wrong_seed(seed):
    with raises(NUMBER_OUT_OF_RANGE):
        cw.World(seed=seed)


def test_values_of_a_wrong_kind(make, rosbots):
    world = make.world()
    for call in (
        lambda: world.spawn(rosbots, pose=(1, 2, 3)),
        lambda: world.spawn(rosbots, x="far"),
        lambda: world.restore(5),
    ):
        with raises(VALUE_INVALID):
            call()
    for name in ("", "a::b", "\ud800"):
        with raises(MODEL_NAME_INVALID):
            world.spawn(rosbots, name=name)
    assert world.models == ("ground_plane",)


def test_the_current_folder_was_deleted(tmp_path):
    folder = tmp_path / "gone"
    folder.mkdir()
    code = (
        "import os; os.rmdir(os.getcwd())\n"
        "import cartwheel as cw\n"
        "world = cw.World(); world.spawn('rosbots.xacro'); world.run(0.1); print(world.time)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.stdout.strip() == "0.1", done.stderr


def test_an_error_in_a_xacro_file_has_one_traceback(tmp_path, make):
    file = tmp_path / "robot.xacro"
    file.write_text(
        '<robot name="x" xmlns:xacro="http://www.ros.org/wiki/xacro">\n'
        '<link name="${nope}"/></robot>'
    )
    with pytest.raises(CartwheelError) as caught:
        make.world().spawn(file)
    assert caught.value.origin.line == 2
    shown = traceback.format_exception(caught.value)
    assert sum(line.startswith("Traceback") for line in shown) == 1


@pytest.mark.parametrize("speed", ["fast", 0, -1, math.nan, True])
def test_a_wrong_speed(speed, make):
    world = make.world()
    for run in (world.run, world.spin):
        with raises(REAL_TIME_FACTOR_INVALID):
            run(0.1, speed=speed)


def test_a_message_and_fields_are_refused_together(make, rosbots):
    world = make.world()
    cart = world.spawn(rosbots, z=0.1)
    topic = world.topic("/part2_cmr/cmd_vel")
    for publish in (cart.publish, world.publish):
        with raises(OPTIONS_CONFLICT) as caught:
            publish("/part2_cmr/cmd_vel", {"linear": {"y": 1.0}}, linear_x=1.0)
        assert "linear_x" in str(caught.value)
    with raises(OPTIONS_CONFLICT):
        topic.hold(Twist(), linear_x=1.0)
    assert topic.count == 0
