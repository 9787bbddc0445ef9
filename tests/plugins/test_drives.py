"""Skid steer, tricycle, car, planar move and the drives of new Gazebo: by their geometry."""

import math
from dataclasses import replace

import numpy as np
import pytest
import trimesh
from tests.coded import coded

from cartwheel.codes import devices, robot, running
from cartwheel.description.model import Mesh
from cartwheel.errors import PluginError, UnknownNameError
from cartwheel.geometry import Pose, yaw_of
from cartwheel.messages import to_dict

RADIUS = 0.1
START = Pose((0, 0, 0.002))


def where(message):
    place, turn = message.pose.pose.position, message.pose.pose.orientation
    return place.x, place.y, yaw_of((turn.x, turn.y, turn.z, turn.w))


def path(messages):
    return np.array([where(message)[:2] for message in messages])


def turned(messages):
    """rad, summed along the messages."""
    yaws = np.unwrap([where(message)[2] for message in messages])
    return yaws[-1] - yaws[0]


def circle(points):
    """Radius of the circle through points, by least squares: |p|² = 2 c·p + (r² - |c|²)."""
    rows = np.column_stack([2 * points, np.ones(len(points))])
    (cx, cy, rest), *_ = np.linalg.lstsq(rows, (points**2).sum(axis=1), rcond=None)
    return math.sqrt(rest + cx * cx + cy * cy)


def spawn(make, model, pose=START, **more):
    world = make.world(**more)
    world.session.spawn(model, pose=pose)
    world.run(0.5)
    return world


# -- skid steer

FOUR = {
    "left_front": (0.2, 0.15),
    "right_front": (0.2, -0.15),
    "left_rear": (-0.2, 0.15),
    "right_rear": (-0.2, -0.15),
}


def skid(tags=""):
    return f"""<plugin name="drive" filename="libgazebo_ros_skid_steer_drive.so">
      <wheelSeparation>0.3</wheelSeparation><wheelDiameter>0.2</wheelDiameter>
      <torque>50</torque><robotBaseFrame>base_link</robotBaseFrame>{tags}</plugin>"""


def test_skid_steer_goes_straight_as_told(make, cart, read):
    world = spawn(make, cart(FOUR, skid()))
    world.publish("/cmd_vel", linear_x=0.5)
    world.run(1.0)
    told = read(world, "/odom", 4.0)
    assert len(told) == 400
    x, y, yaw = np.array(where(told[-1])) - np.array(where(told[0]))
    assert math.hypot(x, y) == pytest.approx(0.5 * 3.99, rel=0.01)
    assert abs(yaw) < 0.01
    assert np.diag(told[0].pose.covariance.reshape(6, 6)) == pytest.approx(
        [1e-4, 1e-4, 1e12, 1e12, 1e12, 1e-2]
    )


def test_skid_steer_turns_by_what_sliding_leaves(make, cart, read):
    """In place, every tyre slides along and across, and its friction points against the sum.

    A wheel at (L/2, W/2) slides by (ω - ω₀) W/2 along and ω L/2 across, all by the same
    speed; the moments of their friction cancel where (ω - ω₀) W² + ω L² = 0.
    """
    length, width, wanted = 0.4, 0.3, 1.0
    world = spawn(make, cart(FOUR, skid()))
    world.publish("/cmd_vel", angular_z=wanted)
    world.run(2.0)
    told = read(world, "/odom", 6.0)
    rate = turned(told) / 5.99
    assert rate == pytest.approx(wanted * width**2 / (width**2 + length**2), rel=0.1)
    # The odometry is the truth, not what the wheels believe.
    yaw = world.model("cart").pose.yaw
    assert math.remainder(where(told[-1])[2] - yaw, 2 * math.pi) == pytest.approx(0, abs=0.02)
    assert told[-1].twist.twist.angular.z == pytest.approx(rate, rel=0.2)


def test_skid_steer_publishes_its_transform_only_when_asked(make, cart):
    world = spawn(make, cart(FOUR, skid()))
    assert "/tf" not in [topic.name for topic in world.graph.topics()]
    world = spawn(make, cart(FOUR, skid("<broadcastTF>true</broadcastTF>")))
    assert "/tf" in [topic.name for topic in world.graph.topics()]


def test_skid_steer_names_a_wheel_it_lacks(make, cart):
    wheels = {name: place for name, place in FOUR.items() if name != "left_rear"}
    with pytest.raises(UnknownNameError) as caught:
        spawn(make, cart(wheels, skid()))
    assert caught.value.values["name"] == "left_rear_joint"
    assert caught.value.origin is not None


# -- several pairs of ROS 2's diff drive, and new Gazebo's

TWO = {"left": (0.0, 0.15), "right": (0.0, -0.15)}
GLIDERS = ((0.15, 0.0), (-0.15, 0.0))


def test_ros2_drives_several_pairs_each_by_its_own_size(make, cart):
    plugin = """<plugin name="drive" filename="libgazebo_ros_diff_drive.so">
      <num_wheel_pairs>2</num_wheel_pairs>
      <left_joint>left_front_joint</left_joint><right_joint>right_front_joint</right_joint>
      <left_joint>left_rear_joint</left_joint><right_joint>right_rear_joint</right_joint>
      <wheel_separation>0.3</wheel_separation><wheel_separation>0.6</wheel_separation>
      <wheel_diameter>0.2</wheel_diameter><wheel_diameter>0.4</wheel_diameter>
      <max_wheel_torque>50</max_wheel_torque></plugin>"""
    # In the air, where nothing holds the wheels.
    world = spawn(make, cart(FOUR, plugin), Pose((0, 0, 500)), ground=None)
    world.publish("/cmd_vel", linear_x=0.5, angular_z=1.0)
    world.run(1.0)
    model, speeds = world.session.simulation, {}
    for name in FOUR:
        before = model.joint_position("cart", f"{name}_joint")
        world.run(0.1)
        speeds[name] = (model.joint_position("cart", f"{name}_joint") - before) / 0.1
    assert speeds["left_front"] == pytest.approx((0.5 - 0.15) / 0.1, rel=0.01)
    assert speeds["right_front"] == pytest.approx((0.5 + 0.15) / 0.1, rel=0.01)
    assert speeds["left_rear"] == pytest.approx((0.5 - 0.3) / 0.2, rel=0.01)
    assert speeds["right_rear"] == pytest.approx((0.5 + 0.3) / 0.2, rel=0.01)
    # ROS 2's plugin publishes only what it is told to.
    assert not {"/odom", "/tf"} & {topic.name for topic in world.graph.topics()}


def test_pairs_must_be_complete(make, cart):
    plugin = """<plugin name="drive" filename="libgazebo_ros_diff_drive.so">
      <num_wheel_pairs>2</num_wheel_pairs><left_joint>left_joint</left_joint></plugin>"""
    with pytest.raises(PluginError) as caught:
        spawn(make, cart(TWO, plugin))
    assert caught.value.code is devices.WHEELS_UNPAIRED
    assert caught.value.values == {"left": 1, "right": 1}


def gz_diff(tags="", prefix="gz-sim"):
    return f"""<plugin name="drive" filename="{prefix}-diff-drive-system">
      <left_joint>left_joint</left_joint><right_joint>right_joint</right_joint>
      <wheel_separation>0.3</wheel_separation><wheel_radius>0.1</wheel_radius>{tags}</plugin>"""


@pytest.mark.parametrize("prefix", ["gz-sim", "ignition-gazebo", "libignition-gazebo"])
def test_gz_diff_drive_closes_a_circle(make, cart, read, prefix):
    """v/ω is the radius, and after 2π/ω the odometry and the robot are where they began."""
    forward, turn = 0.4, 0.8
    world = spawn(make, cart(TWO, gz_diff(prefix=prefix), balls=GLIDERS))
    world.publish("/model/cart/cmd_vel", linear_x=forward, angular_z=turn)
    world.run(1.0)
    told = read(world, "/model/cart/odometry", 2 * math.pi / turn)
    assert circle(path(told)) == pytest.approx(forward / turn, rel=0.02)
    assert told[0].header.frame_id == "cart/odom"
    assert told[0].child_frame_id == "cart/base_link"
    assert len(told) == pytest.approx(50 * 2 * math.pi / turn, abs=1)
    start, end = path(told)[0], path(told)[-1]
    assert np.linalg.norm(end - start) < 0.05
    # The odometry is the wheels' turning; the robot itself lags by what its tyres creep.
    place = world.model("cart").pose
    assert math.hypot(place.x - end[0], place.y - end[1]) < 0.05
    twist = told[-1].twist.twist
    assert (twist.linear.x, twist.angular.z) == pytest.approx((forward, turn), rel=0.01)


def test_gz_topics_and_frames_can_be_named(make, cart):
    tags = """<topic>cmd_vel</topic><odom_topic>odom</odom_topic><tf_topic>tf</tf_topic>
      <frame_id>odom</frame_id><child_frame_id>base_link</child_frame_id>
      <odom_publish_frequency>20</odom_publish_frequency>"""
    world = spawn(make, cart(TWO, gz_diff(tags), balls=GLIDERS))
    boxes = {topic: world.mailbox(topic, size=1000) for topic in ("/odom", "/tf")}
    world.publish("/cmd_vel", linear_x=0.2)
    world.run(2.0)
    odometry, transforms = boxes["/odom"].drain(), boxes["/tf"].drain()
    assert len(odometry) == len(transforms) == 40
    sent = transforms[-1].transforms[0]
    assert (sent.header.frame_id, sent.child_frame_id) == ("odom", "base_link")
    assert sent.transform.translation.x == odometry[-1].pose.pose.position.x > 0.3


def test_gz_limits_are_kept(make, cart, read):
    """At most 0.3 m/s, reached by 0.5 m/s²: after 0.6 s."""
    tags = """<max_linear_velocity>0.3</max_linear_velocity>
      <max_linear_acceleration>0.5</max_linear_acceleration><max_jerk>1</max_jerk>"""
    world = spawn(make, cart(TWO, gz_diff(tags), balls=GLIDERS))
    world.publish("/model/cart/cmd_vel", linear_x=5.0)
    told = read(world, "/model/cart/odometry", 2.0)
    speeds = np.array([message.twist.twist.linear.x for message in told])
    times = np.array([m.header.stamp.sec + m.header.stamp.nanosec * 1e-9 for m in told]) - 0.5
    on_the_way = (times > 0.1) & (times < 0.55)
    assert speeds[on_the_way] == pytest.approx(0.5 * times[on_the_way], abs=0.02)
    assert speeds[times > 0.7] == pytest.approx(0.3, abs=0.01)
    assert coded(world, devices.PLUGIN_PARAMETER_IGNORED)


def test_a_limit_that_contradicts_itself_is_refused(make, cart):
    tags = "<min_velocity>1</min_velocity><max_velocity>-1</max_velocity>"
    with pytest.raises(PluginError) as caught:
        spawn(make, cart(TWO, gz_diff(tags), balls=GLIDERS))
    assert caught.value.code is devices.PLUGIN_RANGE_REVERSED


# -- hector's multi wheel


def test_multi_wheel_drives_sides_of_unlike_count(make, cart, read):
    wheels = {**FOUR, "left_middle": (0.0, 0.15)}
    plugin = """<plugin name="drive" filename="libdiffdrive_plugin_multi_wheel.so">
      <leftJoints>left_front_joint left_middle_joint left_rear_joint</leftJoints>
      <rightJoints>right_front_joint right_rear_joint</rightJoints>
      <wheelSeparation>0.3</wheelSeparation><wheelDiameter>0.2</wheelDiameter>
      <torque>50</torque><robotBaseFrame>base_link</robotBaseFrame></plugin>"""
    world = spawn(make, cart(wheels, plugin))
    world.publish("/cmd_vel", linear_x=0.5)
    world.run(1.0)
    told = read(world, "/odom", 2.0)
    x, y, _ = np.array(where(told[-1])) - np.array(where(told[0]))
    assert math.hypot(x, y) == pytest.approx(0.5 * 1.99, rel=0.01)
    speeds = [world.session.simulation.data.joint(f"cart::{name}_joint").qvel[0] for name in wheels]
    assert speeds == pytest.approx([0.5 / RADIUS] * 5, rel=0.01)


# -- tricycle

THREE = {"front": (0.3, 0.0), "left": (0.0, 0.15), "right": (0.0, -0.15)}


def tricycle(tags=""):
    return f"""<plugin name="drive" filename="libgazebo_ros_tricycle_drive.so">
      <steeringJoint>front_steering</steeringJoint><actuatedWheelJoint>front_joint</actuatedWheelJoint>
      <encoderWheelLeftJoint>left_joint</encoderWheelLeftJoint>
      <encoderWheelRightJoint>right_joint</encoderWheelRightJoint>
      <actuatedWheelDiameter>0.2</actuatedWheelDiameter>
      <encoderWheelDiameter>0.2</encoderWheelDiameter>
      <encoderWheelSeparation>0.3</encoderWheelSeparation><wheelTorque>20</wheelTorque>
      {tags}</plugin>"""


@pytest.mark.parametrize("source", ["world", "encoder"])
def test_tricycle_circles_about_its_rear_axle(make, cart, read, source):
    """The front wheel at L steers by a: the rear axle's middle goes round at L / tan a.

    The front wheel, which has the commanded speed v, is at L / sin a.
    """
    speed, angle, base = 0.4, 0.5, 0.3
    tags = f"<odometrySource>{source}</odometrySource>"
    world = spawn(make, cart(THREE, tricycle(tags), forks=("front",)))
    world.publish("/cmd_vel", linear_x=speed, angular_z=angle)
    world.run(1.5)
    told = read(world, "/odom", 10.0)
    assert circle(path(told)) == pytest.approx(base / math.tan(angle), rel=0.03)
    assert turned(told) / 9.99 == pytest.approx(speed * math.sin(angle) / base, rel=0.03)
    truth = world.model("cart").pose
    if source == "world":
        assert where(told[-1])[:2] == pytest.approx((truth.x, truth.y), abs=0.01)


def test_tricycle_ramps_its_wheel_and_swings_its_fork(make, cart):
    """0 to 4 rad/s at 2 rad/s² takes 2 s; 0.6 rad at 0.5 rad/s takes 1.2 s."""
    tags = """<wheelAcceleration>2</wheelAcceleration><steeringSpeed>0.5</steeringSpeed>
      <publishWheelJointState>true</publishWheelJointState>"""
    world = spawn(make, cart(THREE, tricycle(tags), forks=("front",)))
    box = world.mailbox("/joint_states", size=1000)
    world.publish("/cmd_vel", linear_x=0.4, angular_z=0.6)
    world.run(3.0)
    states = box.drain()
    assert states[0].name == ["front_steering", "front_joint", "left_joint", "right_joint"]
    times = np.arange(len(states)) / 100
    angles = np.array([state.position[0] for state in states])
    speeds = np.array([state.velocity[1] for state in states])
    assert angles == pytest.approx(np.minimum(0.5 * times, 0.6), abs=0.03)
    assert speeds == pytest.approx(np.minimum(2 * times, 4), abs=0.2)
    assert len(states[0].effort) == 4


ROS2_TRICYCLE = """<steering_joint>front_steering</steering_joint>
  <actuated_wheel_joint>front_joint</actuated_wheel_joint>
  <encoder_wheel_left_joint>left_joint</encoder_wheel_left_joint>
  <encoder_wheel_right_joint>right_joint</encoder_wheel_right_joint>"""


def ros2_tricycle(tags=""):
    return f"""<plugin name="drive" filename="libgazebo_ros_tricycle_drive.so">{ROS2_TRICYCLE}
      {tags}</plugin>"""


def test_every_tag_of_ros2s_tricycle_says_what_ros1s_does(make, cart):
    """The same command gives the same messages, bit for bit."""
    ros1 = tricycle("""<wheelAcceleration>2</wheelAcceleration>
      <wheelDeceleration>3</wheelDeceleration>
      <wheelSpeedTolerance>0.02</wheelSpeedTolerance><steeringSpeed>0.5</steeringSpeed>
      <steeringAngleTolerance>0.02</steeringAngleTolerance><odometrySource>encoder</odometrySource>
      <odometryFrame>map</odometryFrame><robotBaseFrame>left_wheel</robotBaseFrame>
      <updateRate>50</updateRate><publishWheelTF>true</publishWheelTF>
      <publishWheelJointState>true</publishWheelJointState>""")
    ros2 = ros2_tricycle("""<ros/><actuated_wheel_diameter>0.2</actuated_wheel_diameter>
      <encoder_wheel_diameter>0.2</encoder_wheel_diameter><wheel_separation>0.3</wheel_separation>
      <max_wheel_torque>20</max_wheel_torque><max_wheel_acceleration>2</max_wheel_acceleration>
      <max_wheel_deceleration>3</max_wheel_deceleration>
      <max_wheel_speed_tolerance>0.02</max_wheel_speed_tolerance>
      <max_steering_speed>0.5</max_steering_speed>
      <max_steering_angle_tolerance>0.02</max_steering_angle_tolerance>
      <odometry_source>0</odometry_source><odometry_frame>map</odometry_frame>
      <robot_base_frame>left_wheel</robot_base_frame><update_rate>50</update_rate>
      <publish_odom>true</publish_odom><publish_wheel_tf>true</publish_wheel_tf>
      <publish_wheel_joint_state>true</publish_wheel_joint_state>""")
    told = []
    for plugin in (ros1, ros2):
        world = spawn(make, cart(THREE, plugin, forks=("front",)))
        boxes = [world.mailbox(topic, size=1000) for topic in ("/odom", "/tf", "/joint_states")]
        world.publish("/cmd_vel", linear_x=0.4, angular_z=0.6)
        world.run(1.0)
        told.append([[to_dict(message) for message in box.drain()] for box in boxes])
        assert not coded(world, devices.PLUGIN_PARAMETER_UNKNOWN)
    assert all(told[0])
    assert told[0] == told[1]


def test_ros2s_tricycle_tells_nothing_unless_it_is_asked(make, cart):
    world = spawn(make, cart(THREE, ros2_tricycle(), forks=("front",)))
    topics = {topic.name for topic in world.graph.topics()}
    assert "/cmd_vel" in topics
    assert not topics & {"/odom", "/tf", "/joint_states"}


@pytest.mark.parametrize(
    ("plugin", "torque"),
    [
        (ros2_tricycle("<publish_wheel_joint_state>1</publish_wheel_joint_state>"), 0.15),
        (
            tricycle("<publishWheelJointState>1</publishWheelJointState>").replace(
                "<wheelTorque>20</wheelTorque>", ""
            ),
            5.0,
        ),
    ],
    ids=["ROS 2", "ROS 1"],
)
def test_a_tricycle_that_states_no_torque_has_its_gazebos(make, cart, plugin, torque):
    """Towards a speed that it cannot reach in that time the motor gives all it has."""
    world = spawn(make, cart(THREE, plugin, forks=("front",)))
    box = world.mailbox("/joint_states")
    world.publish("/cmd_vel", linear_x=100.0)
    world.run(0.05)
    state = box.drain()[-1]
    assert state.effort[state.name.index("front_joint")] == pytest.approx(torque, rel=1e-3)


def test_a_fork_that_is_seldom_steered_stands_still(make, cart):
    """At 10 Hz a fork that went on at full speed would be far past its angle at the next call."""
    tags = "<updateRate>10</updateRate>"
    world = spawn(make, cart(THREE, tricycle(tags), forks=("front",)))
    world.publish("/cmd_vel", linear_x=0.0, angular_z=0.5)
    world.run(5.0)
    simulation = world.session.simulation
    for _ in range(20):
        world.run(0.05)
        assert simulation.joint_position("cart", "front_steering") == pytest.approx(0.5, abs=0.01)


# -- cars

CAR = {
    "front_left": (0.4, 0.15),
    "front_right": (0.4, -0.15),
    "rear_left": (0.0, 0.15),
    "rear_right": (0.0, -0.15),
}
FRONT = ("front_left", "front_right")


def ackermann(tags=""):
    return f"""<plugin name="drive" filename="libgazebo_ros_ackermann_drive.so">
      <left_steering_joint>front_left_steering</left_steering_joint>
      <right_steering_joint>front_right_steering</right_steering_joint>
      <publish_odom>true</publish_odom><publish_distance>true</publish_distance>
      <publish_steerangle>true</publish_steerangle><robot_base_frame>base_link</robot_base_frame>
      <left_steering_pid_gain>1 0 0</left_steering_pid_gain>{tags}</plugin>"""


def test_car_circles_about_one_point(make, cart, read):
    """Radius L / tan a at the rear axle; each front wheel square to the centre of the turn."""
    speed, angle, base, track = 0.6, 0.4, 0.4, 0.3
    world = spawn(make, cart(CAR, ackermann(), forks=FRONT))
    world.publish("/cmd_vel", linear_x=speed, angular_z=angle)
    world.run(2.0)
    extra = {topic: world.mailbox(topic, size=10_000) for topic in ("/distance", "/steerangle")}
    told = read(world, "/odom", 8.0)
    radius = base / math.tan(angle)
    assert circle(path(told)) == pytest.approx(radius, rel=0.03)
    assert turned(told) / 7.99 == pytest.approx(speed / radius, rel=0.03)
    simulation = world.session.simulation
    left = simulation.joint_position("cart", "front_left_steering")
    right = simulation.joint_position("cart", "front_right_steering")
    assert left == pytest.approx(math.atan2(base, radius - track / 2), abs=0.01)
    assert right == pytest.approx(math.atan2(base, radius + track / 2), abs=0.01)
    angles = [message.data for message in extra["/steerangle"].drain()]
    assert angles[-1] == pytest.approx((left + right) / 2, abs=1e-3)
    ways = [message.data for message in extra["/distance"].drain()]
    assert ways[-1] - ways[0] == pytest.approx(speed * 7.99, rel=0.03)
    assert coded(world, devices.PLUGIN_PARAMETER_IGNORED)


def test_car_in_reverse_turns_the_way_it_is_told(make, cart, read):
    world = spawn(make, cart(CAR, ackermann(), forks=FRONT))
    world.publish("/cmd_vel", linear_x=-0.5, angular_z=0.4)
    world.run(1.0)
    told = read(world, "/odom", 2.0)
    assert told[-1].twist.twist.linear.x == pytest.approx(-0.5, rel=0.05)
    assert turned(told) > 0


def test_car_is_measured_at_its_axles_where_meshes_are_elsewhere(make, cart, read, tmp_path):
    """As CAD exports them: each mesh where it is in the whole car, its frame set back by that."""
    base, away = 0.4, 5.0
    tyre = trimesh.creation.cylinder(radius=RADIUS, height=0.04)
    tyre.apply_translation((away, 0, 0))
    tyre.export(tmp_path / "tyre.stl")
    shape = Mesh(uri="tyre.stl", path=tmp_path / "tyre.stl")
    car = cart(CAR, ackermann(), forks=FRONT)
    front = [f"{name}_wheel" for name in FRONT]
    links = [
        replace(link, collisions=(replace(link.collisions[0], shape=shape, pose=back),))
        if link.name in front
        else link
        for link in car.links
        for back in [Pose((-away, 0, 0))]
    ]
    world = spawn(make, replace(car, links=tuple(links)))
    world.publish("/cmd_vel", linear_x=0.6, angular_z=0.4)
    world.run(2.0)
    assert circle(path(read(world, "/odom", 5.0))) == pytest.approx(base / math.tan(0.4), rel=0.03)


def gz_ackermann(tags=""):
    return f"""<plugin name="drive" filename="gz-sim-ackermann-steering-system">
      <left_joint>rear_left_joint</left_joint><right_joint>rear_right_joint</right_joint>
      <left_steering_joint>front_left_steering</left_steering_joint>
      <right_steering_joint>front_right_steering</right_steering_joint>
      <wheel_separation>0.3</wheel_separation><kingpin_width>0.3</kingpin_width>
      <wheel_base>0.4</wheel_base><wheel_radius>0.1</wheel_radius>
      <steering_limit>0.6</steering_limit>{tags}</plugin>"""


def test_gz_car_goes_round_at_the_rate_it_is_told(make, cart, read):
    speed, turn = 0.5, 0.4
    world = spawn(make, cart(CAR, gz_ackermann(), forks=FRONT))
    world.publish("/model/cart/cmd_vel", linear_x=speed, angular_z=turn)
    world.run(2.0)
    start = world.model("cart").pose.yaw
    told = read(world, "/model/cart/odometry", 5.0)
    assert circle(path(told)) == pytest.approx(speed / turn, rel=0.02)
    true_turn = math.remainder(world.model("cart").pose.yaw - start, 2 * math.pi)
    assert true_turn == pytest.approx(5.0 * turn, rel=0.03)


def test_gz_car_steers_no_further_than_its_limit(make, cart):
    """Told to turn tighter than L / tan 0.6 it goes round at that radius."""
    world = spawn(make, cart(CAR, gz_ackermann(), forks=FRONT))
    world.publish("/model/cart/cmd_vel", linear_x=0.3, angular_z=5.0)
    world.run(1.0)
    left = world.session.simulation.joint_position("cart", "front_left_steering")
    radius = 0.4 / math.tan(0.6)
    assert left == pytest.approx(math.atan2(0.4, radius - 0.15), abs=0.01)


# -- planar move

PLANAR = """<plugin name="drive" filename="libgazebo_ros_planar_move.so">
  <robotBaseFrame>base_link</robotBaseFrame>{}</plugin>"""


def test_planar_move_goes_sideways_in_its_own_frame(make, cart, read):
    world = spawn(make, cart(FOUR, PLANAR.format("")), Pose.from_xyz_rpy((0, 0, 0.002), (0, 0, 1)))
    world.publish("/cmd_vel", linear_x=0.2, linear_y=0.4)
    world.run(0.5)
    told = read(world, "/odom", 4.0)
    assert len(told) == 80
    (x0, y0, yaw), (x1, y1, _) = where(told[0]), where(told[-1])
    seconds = 79 / 20
    cos, sin = math.cos(1), math.sin(1)
    # The tyres' friction mu g takes 1/5 of what the servo has: 0.05 / 5 m/s.
    assert (x1 - x0) / seconds == pytest.approx(0.2 * cos - 0.4 * sin, abs=0.012)
    assert (y1 - y0) / seconds == pytest.approx(0.2 * sin + 0.4 * cos, abs=0.012)
    assert yaw == pytest.approx(1.0, abs=0.01)
    twist = told[-1].twist.twist
    assert (twist.linear.x, twist.linear.y) == pytest.approx((0.2, 0.4), abs=0.012)


def test_planar_move_closes_a_circle_looking_outwards(make, cart, read):
    """Sideways at v and turning at ω: round a centre ahead or behind at v/ω."""
    speed, turn = 0.4, 0.8
    world = spawn(make, cart(FOUR, PLANAR.format(""), mu=0.1))
    world.publish("/cmd_vel", linear_y=speed, angular_z=turn)
    world.run(1.0)
    told = read(world, "/odom", 2 * math.pi / turn)
    assert circle(path(told)) == pytest.approx(speed / turn, rel=0.02)
    assert np.linalg.norm(path(told)[-1] - path(told)[0]) < 0.06


def test_planar_move_stops_at_a_wall(make, cart):
    wall = make.box("wall", (0.1, 4, 1), static=True, pose=Pose((1.05, 0, 0.5)))
    world = make.world(wall)
    world.session.spawn(cart(FOUR, PLANAR.format("")), pose=START)
    world.publish("/cmd_vel", linear_x=0.5)
    world.run(6.0)
    # Its front wheels touch the wall's face at 1 m, with the give of a contact.
    assert world.model("cart").pose.x == pytest.approx(1.0 - 0.2 - RADIUS, abs=0.02)
    assert abs(world.model("cart").pose.yaw) < 0.05


def test_planar_move_stands_after_its_timeout(make, cart, read):
    world = spawn(make, cart(FOUR, PLANAR.format("<cmdTimeout>0.5</cmdTimeout>")))
    world.publish("/cmd_vel", linear_x=0.4)
    world.run(0.4)
    assert read(world, "/odom", 0.05)[-1].twist.twist.linear.x > 0.35
    world.run(0.5)
    assert abs(read(world, "/odom", 0.05)[-1].twist.twist.linear.x) < 0.01


def test_planar_move_of_what_is_fixed_is_refused(make):
    plugin = PLANAR.format("")
    model = f'<model name="post"><static>1</static><link name="link"/>{plugin}</model>'
    with pytest.raises(PluginError) as caught:
        spawn(make, make.sdf(model))
    assert caught.value.code is running.MODEL_NOT_MOVABLE


def test_velocity_control_flies_once_it_is_told(make):
    model = """<model name="drone"><link name="link"><inertial><mass>2</mass>
      <inertia><ixx>.02</ixx><iyy>.02</iyy><izz>.02</izz></inertia></inertial></link>
      <plugin name="fly" filename="gz-sim-velocity-control-system"/></model>"""
    world = make.world(ground=None)
    world.session.spawn(make.sdf(model), pose=Pose((0, 0, 50)))
    world.run(1.0)
    fallen = 50 - world.model("drone").pose.z
    assert fallen == pytest.approx(9.8 / 2, rel=0.02)
    world.publish("/model/drone/cmd_vel", linear_x=1.0, linear_z=0.5, angular_z=0.5)
    world.run(3.0)
    before = world.model("drone").pose
    world.run(1.0)
    after = world.model("drone").pose
    # Its weight takes 1/5 of what the servo has.
    assert after.z - before.z == pytest.approx(0.5, abs=0.012)
    assert after.yaw - before.yaw == pytest.approx(0.5, abs=0.01)
    assert math.dist(before.position[:2], after.position[:2]) == pytest.approx(
        2 * 1.0 / 0.5 * math.sin(0.25), abs=0.02
    )


# -- wheels with rollers

MECANUM = """<plugin name="drive" filename="gz-sim-mecanum-drive-system">
  <front_left_joint>left_front_joint</front_left_joint>
  <front_right_joint>right_front_joint</front_right_joint>
  <back_left_joint>left_rear_joint</back_left_joint>
  <back_right_joint>right_rear_joint</back_right_joint>
  <wheelbase>0.4</wheelbase><wheel_separation>0.3</wheel_separation>
  <wheel_radius>0.1</wheel_radius></plugin>"""


@pytest.mark.parametrize("motion", [(0.3, 0.0, 0.0), (0.0, 0.3, 0.0), (0.2, 0.1, 0.5)])
def test_mecanum_goes_where_it_is_told_and_believes_its_wheels(make, cart, read, motion):
    forward, sideways, turn = motion
    world = spawn(make, cart(FOUR, MECANUM, mu=0.3))
    world.publish("/model/cart/cmd_vel", linear_x=forward, linear_y=sideways, angular_z=turn)
    world.run(0.5)
    start = world.model("cart").pose
    told = read(world, "/model/cart/odometry", 2.0)
    end = start.inverse() @ world.model("cart").pose
    # Along the chord of an arc of 2 s.
    chord = 2.0 * (math.sin(turn) / turn if turn else 1.0)
    cos, sin = math.cos(turn), math.sin(turn)
    expected = (
        chord * (cos * forward - sin * sideways),
        chord * (sin * forward + cos * sideways),
    )
    assert (end.x, end.y) == pytest.approx(expected, abs=0.02)
    assert end.yaw == pytest.approx(2.0 * turn, abs=0.03)
    twist = told[-1].twist.twist
    assert (twist.linear.x, twist.linear.y, twist.angular.z) == pytest.approx(
        (forward, sideways, turn), abs=0.01
    )


def test_mecanum_wheels_speed_up_no_faster_than_they_may(make, cart, read):
    limits = "<max_velocity>0.4</max_velocity><max_acceleration>0.5</max_acceleration>"
    drive = MECANUM.replace("</plugin>", f"{limits}<max_jerk>1</max_jerk></plugin>")
    world = spawn(make, cart(FOUR, drive, mu=0.3))
    (warning,) = [d for d in world.diagnostics if d.severity == "warning"]
    assert warning.code is devices.PLUGIN_PARAMETER_IGNORED
    assert warning.values["parameter"] == "max_jerk"
    world.publish("/model/cart/cmd_vel", linear_x=1.0)
    world.run(0.4)
    slow = read(world, "/model/cart/odometry", 0.02)[-1].twist.twist.linear.x
    assert slow == pytest.approx(0.5 * 0.4, abs=0.03)
    world.run(1.0)
    fast = read(world, "/model/cart/odometry", 0.02)[-1].twist.twist.linear.x
    assert fast == pytest.approx(0.4, abs=0.01)


def test_a_wheel_on_the_wrong_side_is_told(make, cart, read):
    """As in Gazebo's own pioneer3dx: it turns to the right when it is told to turn left."""
    swapped = {"left": (0.0, -0.15), "right": (0.0, 0.15)}
    world = spawn(make, cart(swapped, gz_diff(), balls=GLIDERS))
    assert coded(world, robot.WHEELS_SWAPPED)
    world.publish("/model/cart/cmd_vel", angular_z=0.5)
    world.run(1.0)
    assert world.model("cart").pose.yaw < -0.3


# -- two of a kind


@pytest.mark.parametrize(
    ("wheels", "plugin", "forks"),
    [
        (FOUR, skid("<broadcastTF>true</broadcastTF>"), ()),
        (FOUR, PLANAR.format(""), ()),
        (CAR, ackermann("<publish_odom_tf>true</publish_odom_tf>"), FRONT),
    ],
)
def test_a_namespace_and_a_prefix_keep_two_apart(make, cart, wheels, plugin, forks):
    world = make.world()
    model = cart(wheels, plugin, forks=forks)
    for name, y in (("one", 0.0), ("two", 3.0)):
        world.session.spawn(
            model, name=name, pose=Pose((0, y, 0.002)), namespace=name, frame_prefix=name
        )
    boxes = {topic: world.mailbox(topic, size=1000) for topic in ("/one/odom", "/two/odom", "/tf")}
    world.run(0.5)
    world.publish("/one/cmd_vel", linear_x=0.3)
    world.run(2.0)
    one, two = (boxes[f"/{name}/odom"].drain()[-1] for name in ("one", "two"))
    assert (one.header.frame_id, one.child_frame_id) == ("one/odom", "one/base_link")
    assert (two.header.frame_id, two.child_frame_id) == ("two/odom", "two/base_link")
    assert one.pose.pose.position.x > 0.4
    assert abs(two.pose.pose.position.x) < 0.01
    children = {t.child_frame_id for m in boxes["/tf"].drain() for t in m.transforms}
    assert children == {"one/base_link", "two/base_link"}


def test_a_reset_takes_drives_back(make, cart):
    world = spawn(make, cart(TWO, gz_diff(), balls=GLIDERS))
    box = world.mailbox("/model/cart/odometry", size=1000)
    world.publish("/model/cart/cmd_vel", linear_x=0.4)
    world.run(2.0)
    assert world.model("cart").pose.x > 0.5
    world.session.simulation.reset()
    box.drain()
    world.run(1.0)
    assert abs(world.model("cart").pose.x) < 1e-3
    told = box.drain()[-1]
    assert where(told)[:2] == pytest.approx((0, 0), abs=1e-3)
    assert told.twist.twist.linear.x == pytest.approx(0, abs=1e-3)
