"""What an inertial measurement unit reads: REP 145, at the place where it is mounted."""

import dataclasses
import math

import numpy as np
import pytest
from tests.coded import coded

from cartwheel.codes import devices, running
from cartwheel.geometry import (
    Pose,
    matrix_from_quat,
    quat_conjugate,
    quat_from_rpy,
    quat_multiply,
    rotate,
)

G = 9.8
COMMAND = "/part2_cmr/cmd_vel"


def unit(pose="0 0 0 0 0 0", parameters=""):
    """A heavy flat box with a unit in it."""
    return f"""
    <model name="unit"><pose>{pose}</pose><link name="link">
      <inertial><mass>4</mass><inertia><ixx>0.06</ixx><iyy>0.06</iyy><izz>0.1</izz></inertia>
      </inertial>
      <collision name="c"><geometry><box><size>0.4 0.4 0.1</size></box></geometry></collision>
    </link>
    <plugin name="imu" filename="libgazebo_ros_imu.so">
      <bodyName>link</bodyName><topicName>imu</topicName><updateRate>100</updateRate>{parameters}
    </plugin></model>"""


def vector(message):
    return np.array([message.x, message.y, message.z])


def quaternion(message):
    return (message.x, message.y, message.z, message.w)


def read(world, seconds, topic="/imu"):
    """Messages of the next `seconds`."""
    box = world.mailbox(topic, size=100_000)
    world.run(seconds)
    box.close()
    return box.drain()


def mean(messages, field):
    return np.mean([vector(getattr(message, field)) for message in messages], axis=0)


def test_at_rest_it_reads_gravity_up_and_no_rates(make, rosbots):
    world = make.world()
    world.session.spawn(rosbots, pose=Pose((0, 0, 0.1)))
    world.run(1.0)
    messages = read(world, 2.0, "/imu/data")
    acceleration = mean(messages, "linear_acceleration")
    # The cart stands tilted by the difference of its tyres' sinking: less than 0.1 mrad.
    assert acceleration == pytest.approx([0, 0, G], abs=1e-3)
    for message in messages:
        assert vector(message.angular_velocity) == pytest.approx([0, 0, 0], abs=1e-5)
    assert messages[0].header.frame_id == "base_link"


def test_in_free_fall_it_reads_nothing(make):
    world = make.world(make.sdf(unit("0 0 50 0 0 0")), ground=None)
    assert mean(read(world, 1.0), "linear_acceleration") == pytest.approx([0, 0, 0], abs=1e-9)


@pytest.mark.parametrize("roll", [0.0, 0.2])
@pytest.mark.parametrize("pitch", [-0.25, 0.15])
def test_on_a_slope_it_reads_gravity_in_its_own_frame(make, roll, pitch):
    turn = quat_from_rpy(roll, pitch, 0.0)
    up = matrix_from_quat(turn)[:, 2]
    ramp = make.box("ramp", (4, 4, 0.2), static=True, pose=Pose(tuple(-0.1 * up), turn))
    world = make.world(ramp, ground=None)
    world.session.spawn(make.sdf(unit()), pose=Pose(tuple(0.05 * up), turn))
    world.run(1.0)
    messages = read(world, 1.0)
    expected = matrix_from_quat(turn).T @ [0, 0, G]
    assert mean(messages, "linear_acceleration") == pytest.approx(expected, abs=2e-3)
    assert quaternion(messages[-1].orientation) == pytest.approx(turn, abs=1e-3)


def test_orientation_is_against_the_world(make, rosbots):
    world = make.world()
    world.session.spawn(rosbots, pose=Pose.from_xyz_rpy((0, 0, 0.05), (0, 0, 1.2)))
    world.run(1.0)
    message = read(world, 0.1, "/imu/data")[-1]
    pose = world.model("rosbots").pose
    assert pose.yaw == pytest.approx(1.2, abs=1e-3)
    assert quaternion(message.orientation) == pytest.approx(pose.orientation, abs=1e-6)


@pytest.mark.parametrize("offset", [(0.0, 0.0, 0.0), (0.4, 0.2, 0.3), (-0.5, 0.0, 0.0)])
def test_in_a_turn_it_reads_the_rate_and_the_pull_to_the_centre(make, rosbots, offset):
    """At (x, y) in the base: a = (-ω² x, v ω - ω² y, g)."""
    forward, turn = 0.5, 0.5
    fitted = make.with_parameters(
        rosbots, "imu_plugin", xyzOffset=" ".join(map(str, offset)), updateRate="100"
    )
    world = make.world()
    world.session.spawn(fitted, pose=Pose((0, 0, 0.05)))
    world.publish(COMMAND, linear_x=forward, angular_z=turn)
    world.run(3.0)
    messages = read(world, 4.0, "/imu/data")
    x, y, _ = offset
    assert mean(messages, "angular_velocity") == pytest.approx([0, 0, turn], rel=0.01, abs=1e-3)
    assert mean(messages, "linear_acceleration") == pytest.approx(
        [-(turn**2) * x, forward * turn - turn**2 * y, G], rel=0.02, abs=5e-3
    )


def test_while_it_speeds_up_it_reads_the_ramp(make, rosbots):
    """Read at every step: the ramp's stairs are two steps wide, and come within the first."""
    world = make.world()
    world.session.spawn(
        make.with_parameters(rosbots, "imu_plugin", updateRate="0"), pose=Pose((0, 0, 0.05))
    )
    world.run(1.0)
    world.publish(COMMAND, linear_x=1.0)
    world.run(0.3)
    messages = read(world, 0.5, "/imu/data")
    assert len(messages) == 100
    assert mean(messages, "linear_acceleration")[0] == pytest.approx(1.0, rel=0.02)


def test_a_mounting_turns_what_it_reads(make):
    """Mounted a quarter turn about x, the world's up is its own y."""
    offsets = f"<rpyOffsets>{math.pi / 2} 0 0</rpyOffsets>"
    world = make.world(make.sdf(unit("0 0 0.05 0 0 0", offsets)))
    world.run(1.0)
    messages = read(world, 0.5)
    assert mean(messages, "linear_acceleration") == pytest.approx([0, G, 0], abs=1e-3)
    assert quaternion(messages[-1].orientation) == pytest.approx(
        quat_from_rpy(math.pi / 2, 0, 0), abs=1e-4
    )


def readings(make, seed, noise=0.1, seconds=20.0, late=0.0):
    world = make.world(
        make.sdf(unit("0 0 0.05 0 0 0", f"<gaussianNoise>{noise}</gaussianNoise>")), seed=seed
    )
    world.run(1.0 + late)
    messages = read(world, seconds)
    return np.array(
        [
            [*vector(m.angular_velocity), *(vector(m.linear_acceleration) - [0, 0, G])]
            for m in messages
        ]
    ), messages


def test_noise_has_the_spread_that_is_asked_for(make):
    noise = 0.1
    values, messages = readings(make, seed=1)
    count = len(values)
    assert count == 2000
    # Four standard errors of a mean and of a standard deviation.
    assert np.abs(values.mean(axis=0)).max() < 4 * noise / math.sqrt(count)
    spread = values.std(axis=0)
    assert np.abs(spread / noise - 1).max() < 4 / math.sqrt(2 * count)
    # The axes and the moments are independent.
    correlation = np.corrcoef(values.T) - np.eye(6)
    assert np.abs(correlation).max() < 5 / math.sqrt(count)
    follows = [np.corrcoef(column[:-1], column[1:])[0, 1] for column in values.T]
    assert np.abs(follows).max() < 5 / math.sqrt(count)
    assert messages[0].angular_velocity_covariance == pytest.approx(np.diag([noise**2] * 3).ravel())


def test_noise_is_that_of_the_seed(make):
    first, _ = readings(make, seed=7, seconds=1.0)
    again, _ = readings(make, seed=7, seconds=1.0)
    other, _ = readings(make, seed=8, seconds=1.0)
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)


def test_noise_does_not_depend_on_since_when_one_listens(make):
    """Who subscribed a second later reads what the other read then."""
    early, _ = readings(make, seed=7, seconds=2.0)
    late, _ = readings(make, seed=7, seconds=1.0, late=1.0)
    assert np.array_equal(early[100:], late)


def test_nothing_is_measured_for_nobody(make, monkeypatch):
    from cartwheel.simulation.handles import LinkHandle

    calls = []
    measure = LinkHandle.felt
    monkeypatch.setattr(
        LinkHandle,
        "felt",
        lambda self, *a: calls.append(1) or measure(self, *a),
    )
    world = make.world(make.sdf(unit("0 0 0.05 0 0 0")))
    world.run(1.0)
    assert not calls
    read(world, 1.0)
    assert len(calls) == 100


def test_the_sensors_plugin_reads_the_same(make):
    sensor = """
    <model name="unit"><pose>0 0 0.05 0 0 0</pose><link name="link">
      <inertial><mass>4</mass><inertia><ixx>0.06</ixx><iyy>0.06</iyy><izz>0.1</izz></inertia>
      </inertial>
      <collision name="c"><geometry><box><size>0.4 0.4 0.1</size></box></geometry></collision>
      <sensor name="s" type="imu"><update_rate>50</update_rate>
        <plugin name="imu" filename="libgazebo_ros_imu_sensor.so"><topicName>imu</topicName>
        <robotNamespace>/</robotNamespace></plugin></sensor>
    </link></model>"""
    world = make.world(make.sdf(sensor))
    world.run(1.0)
    messages = read(world, 1.0)
    assert len(messages) == 50
    assert mean(messages, "linear_acceleration") == pytest.approx([0, 0, G], abs=1e-3)


@pytest.mark.parametrize(
    ("asked", "sensors", "counted"), [(100, 50, 50), (25, 50, 25), (0, 40, 40), (20, 0, 20)]
)
def test_the_slower_of_the_two_rates_counts(make, asked, sensors, counted):
    model = f"""<model name="unit"><static>1</static><link name="link">
      <sensor name="s" type="imu"><update_rate>{sensors}</update_rate>
        <plugin name="imu" filename="libgazebo_ros_imu_sensor.so"><topicName>/imu</topicName>
        <updateRateHZ>{asked}</updateRateHZ></plugin></sensor></link></model>"""
    assert len(read(make.world(make.sdf(model)), 1.0)) == counted + 1


@pytest.mark.parametrize("how", ["spawned", "of the world"])
def test_its_orientation_can_be_against_the_first(make, how):
    """A unit on its side, on a model that is turned by 1 rad, and later by 1.7 rad more."""
    model = make.sdf(
        """<model name="unit"><link name="base"><pose>0 0 1 0 0 0.3</pose></link>
        <link name="link"><pose>1 0 1 0.4 0 0</pose>
        <inertial><mass>4</mass><inertia><ixx>0.06</ixx><iyy>0.06</iyy><izz>0.1</izz></inertia>
        </inertial><sensor name="s" type="imu"><pose>0 0 0 0 1.2 0</pose>
        <update_rate>50</update_rate><plugin name="p" filename="libgazebo_ros_imu_sensor.so">
        <topicName>/imu</topicName><initialOrientationAsReference>true
        </initialOrientationAsReference></plugin></sensor></link>
        <joint name="fix" type="fixed"><parent>base</parent><child>link</child></joint>
        <joint name="turn" type="revolute"><parent>world</parent><child>base</child>
        <axis><xyz>0 0 1</xyz></axis></joint></model>"""
    )
    pose = Pose((0, 0, 0), quat_from_rpy(0, 0, 1.0))
    if how == "spawned":
        world = make.world()
        world.session.spawn(model, pose=pose)
    else:
        world = make.world(dataclasses.replace(model, pose=pose))
    first = read(world, 0.2)[-1].orientation
    assert [first.x, first.y, first.z] == pytest.approx([0, 0, 0], abs=1e-9)
    world.session.simulation.data.joint("unit::turn").qpos[0] = 1.7
    turned = read(world, 0.2)[-1].orientation
    # The vertical in the unit's axes at first: the turn's axis is the same in both.
    x, y, z = rotate(quat_conjugate(quat_multiply(
        quat_from_rpy(0.4, 0, 0), quat_from_rpy(0, 1.2, 0))), (0.0, 0.0, 1.0))  # fmt: skip
    sin = math.sin(0.85)
    expected = [sin * x, sin * y, sin * z, math.cos(0.85)]
    assert [turned.x, turned.y, turned.z, turned.w] == pytest.approx(expected, abs=1e-9)


def test_its_service_answers_as_gazebos(make):
    world = make.world(make.sdf(unit(parameters="<serviceName>imu/service</serviceName>")))
    service = world.graph.service("/imu/service")
    assert service.type == "std_srvs/srv/Empty"
    service.handler(None)


def test_a_second_robot_with_the_same_service_is_let_in_and_reported(make):
    first = make.sdf(unit("0 0 0.05 0 0 0"))
    world = make.world(first)
    world.session.spawn(first, name="second", pose=Pose((2, 0, 0.05)))
    assert "second" in world.models
    assert coded(world, running.SERVICE_TAKEN)
    # Both publish on the one topic.
    assert len(world.graph.topic("/imu").publishers) == 2


def test_a_standing_one_reads_gravity(make):
    """In a model that is static, or bolted to the world."""
    turn = quat_from_rpy(0, 0.2, 0)
    static = unit("0 0 1 0 0.2 0").replace("<link", "<static>1</static><link", 1)
    bolt = "<joint name='j' type='fixed'><parent>world</parent><child>link</child></joint><plugin"
    bolted = unit("0 0 1 0 0.2 0").replace("<plugin", bolt, 1)
    for model in (static, bolted):
        world = make.world(make.sdf(model))
        world.run(1.0)
        expected = matrix_from_quat(turn).T @ [0, 0, G]
        assert mean(read(world, 1.0), "linear_acceleration") == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize(
    ("parameters", "name"),
    [
        ("<gaussianNoise>-1</gaussianNoise>", "gaussianNoise"),
        ("<gaussianNoise>much</gaussianNoise>", "gaussianNoise"),
        ("<xyzOffset>1 2</xyzOffset>", "xyzOffset"),
    ],
)
def test_parameters_without_sense_name_their_line(make, parameters, name):
    from cartwheel.errors import PluginError

    world = make.world()
    with pytest.raises(PluginError) as caught:
        world.session.spawn(make.sdf(unit(parameters=parameters)))
    assert caught.value.code is devices.PLUGIN_PARAMETER_INVALID
    assert caught.value.values["parameter"] == name
    assert caught.value.origin is not None
    assert "unit" not in world.models
