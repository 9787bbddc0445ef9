"""Ground truth of links and models."""

import math

import numpy as np
import pytest
from tests.coded import coded
from tests.devices.bodies import BOX, arm, turn, vector

from cartwheel.codes import devices
from cartwheel.devices.position.truth import planar_pose, relative
from cartwheel.errors import PluginError
from cartwheel.geometry import IDENTITY, Pose, quat_from_rpy

G = 9.8


def p3d(tags):
    return f"""<model name="unit"><pose>0 0 50 0 0 0</pose>{BOX}
      <plugin name="truth" filename="libgazebo_ros_p3d.so"><bodyName>link</bodyName>
      <topicName>truth</topicName><updateRate>50</updateRate>{tags}</plugin></model>"""


def test_p3d_publishes_a_falling_body(make, read):
    """z = z₀ - g t² / 2, v = -g t, in the world's axes whatever way the body is turned."""
    world = make.world(ground=None)
    world.session.spawn(make.sdf(p3d("")), pose=Pose((1, 2, 50), quat_from_rpy(0.3, 0.2, 1.0)))
    messages = read(world, "/truth", 1.0)
    assert len(messages) == 51
    for message in messages:
        time = message.header.stamp.sec + message.header.stamp.nanosec * 1e-9
        # The step is half-explicit: g h t / 2 beyond the parabola.
        fallen = G * time * (time + 0.005) / 2
        assert vector(message.pose.pose.position) == pytest.approx([1, 2, 50 - fallen], abs=1e-6)
        assert vector(message.twist.twist.linear) == pytest.approx([0, 0, -G * time], abs=1e-6)
    assert turn(messages[-1].pose.pose.orientation) == pytest.approx(quat_from_rpy(0.3, 0.2, 1.0))
    assert messages[0].header.frame_id == "world"
    assert messages[0].child_frame_id == "link"


def test_p3d_adds_its_offsets(make, read):
    tags = f"<xyzOffsets>1 2 3</xyzOffsets><rpyOffsets>0 0 {math.pi / 2}</rpyOffsets>"
    world = make.world(make.sdf(p3d(tags)), gravity=0.0, ground=None)
    message = read(world, "/truth", 0.1)[-1]
    assert vector(message.pose.pose.position) == pytest.approx([1, 2, 53])
    assert turn(message.pose.pose.orientation) == pytest.approx(quat_from_rpy(0, 0, math.pi / 2))


def test_p3d_in_a_links_frame_goes_with_it(make, read):
    """A hand that rests in a turning beam does not move in the beam's axes."""
    plugin = """<plugin name="truth" filename="libgazebo_ros_p3d.so"><body_name>hand</body_name>
      <frame_name>beam</frame_name><update_rate>50</update_rate></plugin>"""
    world = make.world(make.sdf(arm(plugin)), ground=None)
    world.session.simulation.data.joint("arm::turn").qvel[0] = 2.0
    messages = read(world, "/odom", 1.0)
    assert len(messages) == 51
    for message in messages:
        assert vector(message.pose.pose.position) == pytest.approx([1, 0, 0], abs=1e-9)
        # Its place moves with the beam's axes: the difference of the two links' velocities.
        assert np.linalg.norm(vector(message.twist.twist.linear)) == pytest.approx(2.0, rel=1e-3)
        assert vector(message.twist.twist.linear)[1] == pytest.approx(2.0, rel=1e-3)
        assert vector(message.twist.twist.angular) == pytest.approx([0, 0, 0], abs=1e-9)


def test_p3d_noise_has_its_spread_and_seed(make, read):
    def noise(seed):
        world = make.world(
            make.sdf(p3d("<gaussianNoise>0.1</gaussianNoise>")), ground=None, gravity=0.0, seed=seed
        )
        return np.array([vector(m.twist.twist.linear) for m in read(world, "/truth", 10.0)])

    values = noise(1)
    count = values.size
    assert values.std() == pytest.approx(0.1, rel=4 / math.sqrt(2 * count))
    assert np.array_equal(values, noise(1))
    assert not np.array_equal(values, noise(2))


def test_pal_s_world_odometry_publishes_the_twist_in_the_link_s_axes(make, read):
    """It lies on its side, with its z axis along the world's y: it falls along its own y."""
    model = p3d("").replace("libgazebo_ros_p3d.so", "libgazebo_world_odometry.so")
    world = make.world(ground=None)
    world.session.spawn(make.sdf(model), pose=Pose((0, 0, 50), quat_from_rpy(-math.pi / 2, 0, 0)))
    message = read(world, "/truth", 0.5)[-1]
    time = message.header.stamp.nanosec * 1e-9
    assert vector(message.twist.twist.linear) == pytest.approx([0, G * time, 0], abs=1e-6)
    assert message.child_frame_id == "link"


def test_pal_s_world_odometry_needs_no_body_and_is_in_the_world_s_axes(make, read):
    model = p3d("<frameName>link</frameName>").replace("<bodyName>link</bodyName>", "")
    model = model.replace("libgazebo_ros_p3d.so", "libgazebo_world_odometry.so")
    world = make.world(ground=None, gravity=0.0)
    world.session.spawn(make.sdf(model), pose=Pose((1, 2, 3), (0.0, 0.0, 0.0, 1.0)))
    message = read(world, "/truth", 0.1)[0]
    assert vector(message.pose.pose.position) == pytest.approx([1, 2, 3], abs=1e-9)
    assert (message.header.frame_id, message.child_frame_id) == ("link", "link")


def test_p3d_of_a_frame_that_is_no_link_is_reported(make, read):
    world = make.world(make.sdf(p3d("<frameName>odom_combined</frameName>")), ground=None)
    assert coded(world, devices.FRAME_UNKNOWN, frame="odom_combined")
    assert read(world, "/truth", 0.1)[0].header.frame_id == "odom_combined"


def test_gz_odometry_publisher_publishes_the_model_in_its_own_axes(make, read):
    plugin = """<plugin name="o" filename="gz-sim-odometry-publisher-system">
      <odom_frame>odom</odom_frame><robot_base_frame>base</robot_base_frame>
      <dimensions>3</dimensions><odom_publish_frequency>25</odom_publish_frequency></plugin>"""
    world = make.world(ground=None, gravity=0.0)
    model = f'<model name="unit">{BOX}{plugin}</model>'
    world.session.spawn(make.sdf(model), pose=Pose((1, 2, 3), quat_from_rpy(0, 0, math.pi / 2)))
    world.session.simulation.data.joint("unit::link").qvel[:3] = [0.0, 0.5, 0.2]
    messages = read(world, "/model/unit/odometry", 2.0)
    assert len(messages) == 51
    last = messages[-1]
    assert (last.header.frame_id, last.child_frame_id) == ("odom", "base")
    seconds = 50 / 25
    assert vector(last.pose.pose.position) == pytest.approx(
        [1, 2 + 0.5 * seconds, 3 + 0.2 * seconds], abs=1e-6
    )
    # It looks along y: what goes along y is forward.
    assert vector(last.twist.twist.linear) == pytest.approx([0.5, 0, 0.2], abs=1e-6)


@pytest.mark.parametrize(
    ("model", "parameter"),
    [
        (p3d("<gaussianNoise>-1</gaussianNoise>"), "gaussianNoise"),
    ],
)
def test_parameters_without_sense_name_their_line(make, model, parameter):
    with pytest.raises(PluginError) as caught:
        make.world(make.sdf(model), ground=None)
    assert caught.value.values["parameter"] == parameter
    assert caught.value.origin is not None


def test_a_state_relative_to_a_frame_is_along_its_axes():
    """A frame that looks along y and moves with it."""
    state = ((1.0, 5.0, 0.0), IDENTITY, (0.0, 3.0, 0.0), (0.0, 0.0, 2.0))
    frame = ((1.0, 2.0, 0.0), quat_from_rpy(0, 0, math.pi / 2), (0.0, 1.0, 0.0), (0.0, 0.0, 0.5))
    place, orientation, linear, angular = relative(state, frame)
    assert place == pytest.approx((3, 0, 0))
    assert orientation == pytest.approx(quat_from_rpy(0, 0, -math.pi / 2))
    assert linear == pytest.approx((2, 0, 0))
    assert angular == pytest.approx((0, 0, 1.5))


def test_a_planar_pose_keeps_the_heading():
    place, orientation = planar_pose((1.0, 2.0, 3.0), quat_from_rpy(0.1, -0.2, 0.9))
    assert place == (1.0, 2.0, 0.0)
    assert orientation == pytest.approx(quat_from_rpy(0, 0, 0.9))
