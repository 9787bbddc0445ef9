"""The TurtleBot 2's base: its drive, and what its own sensors publish."""

import math

import pytest

from cartwheel.codes import running
from cartwheel.errors import UnknownNameError
from cartwheel.geometry import Pose

RADIUS, TRACK = 0.035, 0.23
BODY, HEIGHT = 0.17, 0.08
BASE = "/mobile_base"
LEFT, CENTER, RIGHT = 0, 1, 2


def wheel(name, y):
    turn = 0.05 * RADIUS**2
    return f"""<link name="{name}"><pose>0 {y} {RADIUS} {-math.pi / 2} 0 0</pose>
      <inertial><mass>0.1</mass><inertia><ixx>{turn}</ixx><iyy>{turn}</iyy><izz>{turn}</izz>
      </inertia></inertial>
      <collision name="tyre"><geometry><cylinder><radius>{RADIUS}</radius><length>0.02</length>
      </cylinder></geometry></collision>
      <sensor name="drop_{name}" type="contact"><contact><collision>tyre</collision></contact>
      </sensor></link>
    <joint name="{name}_joint" type="continuous"><parent>base</parent><child>{name}</child>
      <axis><xyz>0 0 1</xyz></axis></joint>"""


def eye(name, angle):
    x, y = 0.15 * math.cos(angle), 0.15 * math.sin(angle)
    return f"""<sensor name="{name}" type="ray"><pose>{x} {y} 0.03 0 {math.pi / 2} 0</pose>
      <ray><scan><horizontal><samples>1</samples></horizontal></scan>
      <range><min>0.01</min><max>0.15</max></range></ray></sensor>"""


PLUGIN = """<plugin name="kobuki" filename="libgazebo_ros_kobuki.so"><publish_tf>1</publish_tf>
  <left_wheel_joint_name>left_joint</left_wheel_joint_name>
  <right_wheel_joint_name>right_joint</right_wheel_joint_name>
  <wheel_separation>0.23</wheel_separation><wheel_diameter>0.07</wheel_diameter>
  <torque>1.0</torque><velocity_command_timeout>0.6</velocity_command_timeout>
  <cliff_sensor_left_name>eye_left</cliff_sensor_left_name>
  <cliff_sensor_center_name>eye_front</cliff_sensor_center_name>
  <cliff_sensor_right_name>eye_right</cliff_sensor_right_name>
  <cliff_detection_threshold>0.04</cliff_detection_threshold>
  <bumper_name>bumpers</bumper_name><imu_name>gyro</imu_name>
  <wheel_drop_left_sensor_name>drop_left</wheel_drop_left_sensor_name>
  <wheel_drop_right_sensor_name>drop_right</wheel_drop_right_sensor_name>
  <update_rate>50</update_rate></plugin>"""


def gliders():
    return "".join(
        f"""<collision name="glider{i}"><pose>{x} 0 0.01 0 0 0</pose><geometry><sphere>
        <radius>0.01</radius></sphere></geometry><surface><friction><ode><mu>0</mu><mu2>0</mu2>
        </ode></friction></surface></collision>"""
        for i, x in enumerate((0.11, -0.11))
    )


def kobuki(make, plugin=PLUGIN):
    inertia = 2.4 * BODY**2 / 4
    return make.sdf(f"""<model name="kobuki"><link name="base">
      <inertial><pose>0 0 0.04 0 0 0</pose><mass>2.4</mass><inertia><ixx>{inertia}</ixx>
      <iyy>{inertia}</iyy><izz>{2 * inertia}</izz></inertia></inertial>
      <collision name="shell"><pose>0 0 {0.03 + HEIGHT / 2} 0 0 0</pose><geometry><cylinder>
      <radius>{BODY}</radius><length>{HEIGHT}</length></cylinder></geometry>
      <surface><friction><ode><mu>0.3</mu><mu2>0.3</mu2></ode></friction></surface></collision>
      {gliders()}
      <sensor name="bumpers" type="contact"><contact><collision>shell</collision></contact></sensor>
      <sensor name="gyro" type="imu"><always_on>1</always_on></sensor>
      {eye("eye_left", 1.0)}{eye("eye_front", 0.0)}{eye("eye_right", -1.0)}</link>
      {wheel("left", TRACK / 2)}{wheel("right", -TRACK / 2)}{plugin}</model>""")


@pytest.fixture
def world(make):
    return make.world(kobuki(make), ground=1.0)


def drive(world, seconds, forward, turn=0.0):
    """With a command every half a second: it stands after 0.6 s without."""
    while seconds > 1e-9:
        world.publish(f"{BASE}/commands/velocity", linear_x=forward, angular_z=turn)
        world.run(min(0.5, seconds))
        seconds -= 0.5


def heading(pose):
    return 2 * math.atan2(pose.orientation.z, pose.orientation.w)


def test_it_drives_and_its_odometry_knows_where_it_is(world, read):
    start = world.model("kobuki").pose
    drive(world, 4.0, 0.2, 0.4)
    reported = read(world, "/odom", 0.1)[-1]
    pose = world.model("kobuki").pose
    assert pose.yaw - start.yaw == pytest.approx(4.1 * 0.4, rel=0.05)
    where = reported.pose.pose.position
    assert (where.x, where.y) == pytest.approx(pose.position[:2], abs=0.02)
    # The turning is the gyroscope's: exact, whatever the wheels slip, and up to 20 ms old.
    assert heading(reported.pose.pose) == pytest.approx(pose.yaw - 0.4 * 0.01, abs=0.4 * 0.015)
    assert reported.child_frame_id == "base_footprint"
    assert reported.pose.covariance[[0, 7, 14, 35]].tolist() == [0.1, 0.1, 1e6, 0.05]


def test_without_a_command_it_stands_after_its_timeout(world, read):
    world.publish(f"{BASE}/commands/velocity", linear_x=0.2)
    world.run(0.55)
    assert read(world, "/odom", 0.04)[-1].twist.twist.linear.x == pytest.approx(0.2, rel=0.05)
    world.run(0.4)
    assert read(world, "/odom", 0.1)[-1].twist.twist.linear.x == pytest.approx(0, abs=1e-3)


def test_motors_that_are_off_do_not_drive(world):
    world.publish(f"{BASE}/commands/motor_power", state=0)
    drive(world, 1.0, 0.2)
    assert world.model("kobuki").pose.x == pytest.approx(0, abs=1e-3)
    world.publish(f"{BASE}/commands/motor_power", state=1)
    drive(world, 1.0, 0.2)
    assert world.model("kobuki").pose.x == pytest.approx(0.2, rel=0.1)


def test_the_odometry_starts_again_where_it_is_set(world, read):
    drive(world, 2.0, 0.2)
    world.publish(f"{BASE}/commands/reset_odometry")
    world.run(1.0)
    # The last command holds for 0.1 s more.
    reported = read(world, "/odom", 0.1)[-1]
    assert reported.pose.pose.position.x == pytest.approx(0.2 * 0.1, abs=5e-3)


def test_joint_states_have_names_velocities_and_a_frame(world, read):
    drive(world, 1.0, 0.2)
    reported = read(world, "/joint_states", 0.1)[-1]
    assert reported.name == ["left_joint", "right_joint"]
    assert reported.velocity == pytest.approx([0.2 / RADIUS] * 2, rel=0.03)
    assert reported.header.frame_id == "base_link"


def test_the_gyroscope_is_published_with_its_covariances(world, read):
    world.run(1.0)
    reported = read(world, f"{BASE}/sensors/imu_data", 0.1)[-1]
    assert reported.linear_acceleration.z == pytest.approx(9.8, abs=0.2)
    drive(world, 1.0, 0.0, 0.5)
    reported = read(world, f"{BASE}/sensors/imu_data", 0.08)[-1]
    assert reported.angular_velocity.z == pytest.approx(0.5, rel=0.05)
    assert reported.angular_velocity_covariance[8] == 0.05


@pytest.mark.parametrize(
    ("angle", "bumper", "bit"),
    [(0.0, CENTER, 2), (math.radians(45), LEFT, 4), (math.radians(-45), RIGHT, 1)],
)
def test_each_bumper_is_pressed_by_what_stands_there(make, angle, bumper, bit):
    """A post on the way, as far aside as makes the contact's normal point at `angle`."""
    reach = BODY + 0.02
    along = 0.35 + reach * math.cos(angle)
    post = make.sdf(f"""<model name="post"><static>1</static><pose>{along} {reach * math.sin(angle)}
      0.1 0 0 0</pose><link name="link"><collision name="c"><geometry><cylinder>
      <radius>0.02</radius><length>0.2</length></cylinder></geometry></collision></link></model>""")
    world = make.world(kobuki(make), post, ground=1.0)
    events = world.mailbox(f"{BASE}/events/bumper")
    core = world.mailbox(f"{BASE}/sensors/core")
    drive(world, 2.0, 0.2)
    first, *later = events.drain()
    assert (first.bumper, first.state) == (bumper, first.PRESSED)
    assert any(message.bumper == bit for message in core.drain())
    drive(world, 1.0, -0.2)
    # It may bounce off just before it drives away.
    last = [*later, *events.drain()][-1]
    assert (last.bumper, last.state) == (bumper, last.RELEASED)


def test_what_touches_it_from_behind_presses_none(make):
    wall = make.box("wall", (0.1, 1, 0.5), static=True, pose=Pose((-0.4, 0, 0.25)))
    world = make.world(kobuki(make), wall, ground=1.0)
    events = world.mailbox(f"{BASE}/events/bumper")
    drive(world, 2.0, -0.2)
    assert not events.drain()


def test_an_edge_is_a_cliff_with_the_reading_of_its_converter(make):
    """It stands on a table of which the front eye looks over the edge."""
    table = make.box("table", (0.28, 1, 0.5), mu=1.0, static=True, pose=Pose((-0.01, 0, 0.25)))
    robot = kobuki(make)
    world = make.world(table, ground=1.0)
    world.session.spawn(robot, pose=Pose((0, 0, 0.5)))
    box = world.mailbox(f"{BASE}/events/cliff")
    core = world.mailbox(f"{BASE}/sensors/core")
    world.run(0.5)
    (event,) = box.drain()
    assert (event.sensor, event.state) == (CENTER, event.CLIFF)
    # Nothing within 15 cm.
    assert event.bottom == int(76123 * math.atan2(0.995, 150))
    assert core.drain()[-1].cliff == 2


def test_wheels_in_the_air_are_dropped_until_they_stand(make):
    world = make.world(ground=1.0)
    world.session.spawn(kobuki(make), pose=Pose((0, 0, 0.2)))
    box = world.mailbox(f"{BASE}/events/wheel_drop")
    world.run(0.1)
    assert [(e.wheel, e.state) for e in box.drain()] == [(0, 1), (1, 1)]
    world.run(1.5)
    last = {event.wheel: event.state for event in box.drain()}
    assert last == {0: 0, 1: 0}


def test_the_tags_of_wheel_drops_may_be_absent_as_in_older_versions(make):
    older = "\n".join(line for line in PLUGIN.splitlines() if "wheel_drop" not in line)
    world = make.world(ground=1.0)
    world.session.spawn(kobuki(make, older), pose=Pose((0, 0, 0.2)))
    box = world.mailbox(f"{BASE}/events/wheel_drop")
    world.run(1.0)
    assert box.drain() == []
    drive(world, 2.0, 0.2)
    assert world.model("kobuki").pose.x == pytest.approx(0.4, rel=0.1)


def test_a_sensor_that_is_not_there_is_refused_with_the_likely_one(make):
    wrong = PLUGIN.replace("<imu_name>gyro<", "<imu_name>gyr<")
    with pytest.raises(UnknownNameError) as caught:
        make.world(kobuki(make, wrong))
    assert caught.value.code is running.UNKNOWN_SENSOR
    assert caught.value.values["meant"] == "gyro"
