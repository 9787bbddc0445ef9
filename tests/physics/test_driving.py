"""The cart at the default step: what its command, its ramp, its torque and its tyres say."""

import dataclasses
import itertools
import math

import mujoco
import numpy as np
import pytest

from cartwheel.description import load_text
from cartwheel.description.model import Physics
from cartwheel.geometry import Pose
from cartwheel.world.build import DEFAULT_STEP
from cartwheel.world.joints import STIFF_REFERENCE

COMMAND = "/part2_cmr/cmd_vel"
RADIUS, SEPARATION, TORQUE, RAMP, CONTROL = 0.26, 1.1, 20.0, 1.0, 0.01
"""m, m, N m, m/s² and s: wheelDiameter / 2, wheelSeparation, wheelTorque, wheelAcceleration and
1 / updateRate of the description."""

DROPPED = Pose((0, 0, 0.1))


def stand(make, robot, *, step=None, pose=DROPPED, settle=1.0):
    world = make.world(step=step)
    world.session.spawn(robot, pose=pose)
    world.run(settle)
    return world


def drive(world, seconds, forward=0.0, turn=0.0):
    """Drives on a command; times since then, x, y, yaw and wheel-frame speed at every step."""
    simulation = world.session.simulation
    start = world.time
    rows = []

    def note():
        pose = simulation.pose("rosbots")
        speed = simulation.data.joint("rosbots::base_footprint").qvel
        along = math.cos(pose.yaw) * speed[0] + math.sin(pose.yaw) * speed[1]
        rows.append((world.time - start, pose.x, pose.y, pose.yaw, along))

    task = []
    simulation.schedule(0, after=note, active=lambda: not task)
    world.publish(COMMAND, linear_x=forward, angular_z=turn)
    world.run(seconds)
    task.append("done")
    return np.array(rows)


def effective_mass(robot):
    """Of two rolling wheels and what they carry: m + 2 I / r²."""
    wheels = [robot.link(f"wheel_{side}_link").inertial for side in ("left", "right")]
    return robot.mass + sum(wheel.iyy for wheel in wheels) / RADIUS**2


def test_speed_and_way_follow_the_ramp(make, rosbots):
    world = stand(make, rosbots)
    x0 = world.model("rosbots").pose.x
    rows = drive(world, 6.0, forward=0.5)
    time, way, speed = rows[:, 0], rows[:, 1] - x0, rows[:, 4]
    ramp_end = 0.5 / RAMP
    wanted_speed = np.minimum(RAMP * time, 0.5)
    wanted_way = np.where(time < ramp_end, RAMP * time**2 / 2, 0.5 * time - 0.5 * ramp_end / 2)
    # The ramp is climbed in stairs of one control period. The wheel follows its motor with the
    # time constant of their coupling.
    lag = RAMP * STIFF_REFERENCE[0]
    assert np.abs(speed - wanted_speed).max() < RAMP * CONTROL + lag + RAMP * DEFAULT_STEP
    assert np.abs(way - wanted_way).max() < (RAMP * CONTROL + lag) * ramp_end + 0.5 * DEFAULT_STEP
    # From then on it holds within 2 %.
    held = speed[time > ramp_end + 0.1]
    assert np.abs(held - 0.5).max() < 0.02 * 0.5
    assert np.abs(rows[:, 2]).max() < 1e-3
    assert np.abs(rows[:, 3]).max() < 1e-3


def test_a_commanded_circle_closes_on_its_radius(make, rosbots):
    """0.5 m/s and 0.5 rad/s: a circle of 1 m, once around in 4 π s."""
    world = stand(make, rosbots)
    drive(world, 2.0, forward=0.5, turn=0.5)
    period = 2 * math.pi / 0.5
    rows = drive(world, period, forward=0.5, turn=0.5)
    x, y = rows[:, 1], rows[:, 2]
    # x² + y² = 2 a x + 2 b y + c is linear in the centre (a, b).
    (a, b, c), *_ = np.linalg.lstsq(
        np.column_stack([2 * x, 2 * y, np.ones_like(x)]), x**2 + y**2, rcond=None
    )
    radius = math.sqrt(c + a * a + b * b)
    assert radius == pytest.approx(1.0, rel=0.02)
    distances = np.hypot(x - a, y - b)
    assert np.abs(distances - radius).max() < 2e-3
    assert math.hypot(x[-1] - x[0], y[-1] - y[0]) < 0.02 * 2 * math.pi
    turned = np.unwrap(rows[:, 3])[-1] - rows[0, 3]
    assert turned == pytest.approx(2 * math.pi, rel=0.02)


@pytest.mark.parametrize("torque", [2.0, 5.0, 8.0])
def test_torque_limits_the_acceleration(make, rosbots, torque):
    """Without a ramp a = 2 T / (r (m + 2 I / r²)) until the speed is reached."""
    weak = make.with_parameters(
        rosbots, "differential_drive_controller", wheelTorque=str(torque), wheelAcceleration="0"
    )
    world = stand(make, weak)
    rows = drive(world, 1.0, forward=3.0)
    expected = 2 * torque / (RADIUS * effective_mass(rosbots))
    assert expected < 2.5, "it would reach its speed"
    window = rows[(rows[:, 0] > 0.3) & (rows[:, 0] < 1.0)]
    measured = np.polyfit(window[:, 0], window[:, 4], 1)[0]
    # The cart leans back on its tyres meanwhile: a percent.
    assert measured == pytest.approx(expected, rel=0.01)


@pytest.mark.parametrize("pose", [Pose((0, 0, 0.1)), Pose.from_xyz_rpy((2, 1, 0.0), (0, 0, 1.0))])
def test_standing_still_stays(make, rosbots, pose):
    world = stand(make, rosbots, pose=pose)
    before = world.model("rosbots").pose
    world.run(60.0)
    after = world.model("rosbots").pose
    assert math.dist(before.position, after.position) < 1e-3
    assert abs(after.yaw - before.yaw) < 1e-3


def test_standing_still_after_driving_stays(make, rosbots):
    world = stand(make, rosbots)
    drive(world, 2.0, forward=0.5, turn=0.4)
    drive(world, 2.0)
    before = world.model("rosbots").pose
    world.run(60.0)
    after = world.model("rosbots").pose
    assert math.dist(before.position, after.position) < 1e-3
    assert abs(after.yaw - before.yaw) < 1e-3


def on_slope(make, rosbots, degrees):
    """The cart on a slope, at the end of its first second, and where it is then."""
    slope = math.radians(degrees)
    up = np.array([math.sin(slope), 0, math.cos(slope)])
    turn = Pose.from_xyz_rpy((0, 0, 0), (0, slope, 0)).orientation
    ramp = make.box("ramp", (60, 4, 0.2), mu=1.0, static=True, pose=Pose(tuple(-0.1 * up), turn))
    world = make.world(ramp, ground=None)
    world.session.spawn(rosbots, pose=Pose(tuple(up * 0.0), turn))
    world.run(1.0)
    return world, world.model("rosbots").pose.position


@pytest.mark.parametrize("degrees", [8, 12, 18])
def test_it_holds_on_a_ramp(make, rosbots, degrees):
    """Wheels with a commanded velocity of zero brake: the pull of the slope, r m g sin α / 2, is
    within the torque.
    """
    torque = RADIUS * rosbots.mass * 9.8 * math.sin(math.radians(degrees)) / 2
    assert torque < TORQUE
    world, before = on_slope(make, rosbots, degrees)
    world.run(10.0)
    assert math.dist(before, world.model("rosbots").pose.position) < 1e-3


def test_a_brake_gives_no_more_than_the_torque(make, rosbots):
    """On 22° it rolls with a = (m g sin α - 2 T / r) / (m + 2 I / r²)."""
    pull = rosbots.mass * 9.8 * math.sin(math.radians(22))
    acceleration = (pull - 2 * TORQUE / RADIUS) / effective_mass(rosbots)
    assert acceleration > 0.3
    world, before = on_slope(make, rosbots, 22)
    world.run(2.0)
    moved = math.dist(before, world.model("rosbots").pose.position)
    # From rest at time zero, seen from 1 s to 3 s.
    assert moved == pytest.approx(acceleration * (3.0**2 - 1.0**2) / 2, rel=0.05)


def test_a_brake_lets_go_when_it_is_commanded_to_drive(make, rosbots):
    """Up the slope from a stand, then a stop that holds again; also over a spawn."""
    world, before = on_slope(make, rosbots, 8)
    drive(world, 3.0, forward=-0.4)
    there = world.model("rosbots").pose.position
    assert math.dist(before, there) > 0.8
    drive(world, 1.5)
    stopped = world.model("rosbots").pose.position
    world.session.spawn(make.box("far", (1, 1, 1), pose=Pose((0, 50, 0)), static=True))
    world.run(5.0)
    assert math.dist(stopped, world.model("rosbots").pose.position) < 1e-3


LEGS = {
    "turning on the spot": [(5, 0.5, 0), (5, 0.5, 0.3), (5, 0, -0.5), (3, 0, 0)],
    "backing": [(5, 0.5, 0), (5, 0.5, 0.3), (5, -0.5, 0), (3, 0, 0)],
}
STARTS = {
    "dropped": DROPPED,
    "on the ground": Pose((0, 0, 0)),
    "turned": Pose.from_xyz_rpy((3, -2, 0.05), (0, 0, 2.1)),
    "from high": Pose.from_xyz_rpy((-1, 1, 0.3), (0, 0, -0.7)),
}


def end_of(make, robot, legs, pose, step=None):
    """Where a sequence of commands ends, in the frame of where it began."""
    world = stand(make, robot, pose=pose, step=step)
    for seconds, forward, turn in legs:
        world.publish(COMMAND, linear_x=forward, angular_z=turn)
        world.run(seconds)
    start = Pose((pose.x, pose.y, 0), pose.orientation)
    return start.inverse() @ world.model("rosbots").pose


@pytest.fixture(scope="module", params=LEGS)
def reference(request, make_once, rosbots):
    """The legs, and their end at steps of 0.1 ms."""
    legs = LEGS[request.param]
    return legs, end_of(make_once, rosbots, legs, STARTS["dropped"], step=1e-4)


@pytest.mark.parametrize("start", STARTS)
def test_default_step_ends_where_a_fine_one_does(make, rosbots, reference, start):
    """Within 5 mm and 5 mrad after 18 s, wherever and however it is set down."""
    legs, expected = reference
    found = end_of(make, rosbots, legs, STARTS[start])
    assert math.hypot(found.x - expected.x, found.y - expected.y) < 5e-3
    assert abs(math.remainder(found.yaw - expected.yaw, 2 * math.pi)) < 5e-3


def test_a_worlds_own_step_is_taken(make):
    world = make.world(step=0.002)
    assert world.session.simulation.step_ns == 2_000_000
    description = dataclasses.replace(
        world.session.simulation.world, physics=Physics(max_step_size=None)
    )
    from cartwheel.world.build import step_of

    assert step_of(description) == DEFAULT_STEP == 0.005


DRAGGING = """<robot name="drag">
<link name="base"><inertial><mass value="10"/>
  <inertia ixx="0.1" ixy="0" ixz="0" iyy="0.2" iyz="0" izz="0.2"/></inertial>
  <collision><geometry><box size="0.4 0.3 0.1"/></geometry></collision></link>
<link name="caster"><inertial><mass value="0.5"/>
  <inertia ixx="0.001" ixy="0" ixz="0" iyy="0.001" iyz="0" izz="0.001"/></inertial>
  <collision><geometry><sphere radius="0.05"/></geometry></collision></link>
<joint name="fixed" type="fixed"><origin xyz="0.14 0 -0.05"/>
  <parent link="base"/><child link="caster"/></joint>
{wheels}
<gazebo><plugin name="drive" filename="libgazebo_ros_diff_drive.so">
  <leftJoint>left_joint</leftJoint><rightJoint>right_joint</rightJoint>
  <wheelSeparation>0.36</wheelSeparation><wheelDiameter>0.2</wheelDiameter>
  <wheelTorque>20</wheelTorque></plugin></gazebo></robot>"""
WHEEL = """<link name="{side}"><inertial><mass value="0.5"/>
  <inertia ixx="0.002" ixy="0" ixz="0" iyy="0.003" iyz="0" izz="0.002"/></inertial>
  <collision><origin rpy="1.5707963 0 0"/>
  <geometry><cylinder radius="0.1" length="0.04"/></geometry></collision></link>
<joint name="{side}_joint" type="continuous"><origin xyz="-0.12 {y} 0"/><axis xyz="0 1 0"/>
  <parent link="base"/><child link="{side}"/></joint>"""


@pytest.mark.parametrize("speed", [0.2, 1.0])
def test_a_caster_that_drags_neither_hops_nor_brakes_its_robot(make, speed):
    """Nearly half the weight lies on a ball that does not turn, at μ = 1.

    The wheels carry more than half at the same μ: Coulomb's friction lets them drive on.
    """
    wheels = [WHEEL.format(side=side, y=y) for side, y in (("left", 0.18), ("right", -0.18))]
    robot = load_text(DRAGGING.format(wheels="".join(wheels)), file="drag.urdf")
    world = stand(make, robot, pose=Pose((0, 0, 0.1)))
    world.publish("/cmd_vel", linear_x=speed)
    world.run(4.0)
    robot = world.model("drag")
    before, pitches = robot.pose.x, []
    for _ in range(20):
        world.run(0.1)
        pitches.append(robot.pose.rpy[1])
    assert (robot.pose.x - before) / 2.0 == pytest.approx(speed, rel=0.06)
    assert max(pitches) - min(pitches) < 0.02


@pytest.mark.parametrize("axis", ["1 1 1", "1 0 0", "0 0 1"])
def test_a_ball_on_a_joint_that_cannot_roll_forward_is_a_caster(make, axis):
    """It slides like a ball on a fixed joint, and may lead the robot on an arc."""
    wheels = [WHEEL.format(side=side, y=y) for side, y in (("left", 0.18), ("right", -0.18))]
    text = DRAGGING.format(wheels="".join(wheels))
    text = text.replace(
        'name="fixed" type="fixed">', f'name="b" type="continuous"><axis xyz="{axis}"/>'
    )
    world = stand(make, load_text(text, file="drag.urdf"), pose=Pose((0, 0, 0.1)))
    world.publish("/cmd_vel", linear_x=0.2)
    world.run(4.0)
    robot = world.model("drag")
    places, pitches = [robot.pose.position], []
    for _ in range(20):
        world.run(0.1)
        places.append(robot.pose.position)
        pitches.append(robot.pose.rpy[1])
    way = sum(math.dist(a, b) for a, b in itertools.pairwise(places))
    assert way / 2.0 == pytest.approx(0.2, rel=0.08)
    assert max(pitches) - min(pitches) < 0.02


CASTERS = """<robot name="cart"><link name="base"><inertial><origin xyz="0 0 0.02"/>
  <mass value="16"/>
  <inertia ixx="0.34" iyy="0.6" izz="0.93" ixy="0" ixz="0" iyz="0"/></inertial></link>{parts}
<gazebo><plugin name="drive" filename="libgazebo_ros_diff_drive.so">
  <left_joint>left_joint</left_joint><right_joint>right_joint</right_joint>
  <wheel_separation>0.52</wheel_separation><wheel_diameter>0.2</wheel_diameter></plugin></gazebo>
</robot>"""
HEAVY_WHEEL = """<link name="{side}"><inertial><mass value="1.3"/>
  <inertia ixx="0.004" iyy="0.0075" izz="0.004" ixy="0" ixz="0" iyz="0"/></inertial><collision>
  <origin rpy="1.5707963 0 0"/><geometry><cylinder radius="0.1" length="0.03"/></geometry>
  </collision></link>
<joint name="{side}_joint" type="continuous"><origin xyz="0 {y} 0.055"/><axis xyz="0 1 0"/>
  <parent link="base"/><child link="{side}"/></joint>"""
SWIVEL = """<link name="fork_{i}"><inertial><mass value="0.007"/>
  <inertia ixx="1.4e-6" iyy="1.4e-6" izz="1.3e-7" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="swivel_{i}" type="continuous"><origin xyz="{at} 0" rpy="0 0 {yaw}"/>
  <axis xyz="0 0 1"/><parent link="base"/><child link="fork_{i}"/></joint>
<link name="roll_{i}"><inertial><mass value="0.004"/>
  <inertia ixx="2.5e-7" iyy="4.8e-7" izz="2.5e-7" ixy="0" ixz="0" iyz="0"/></inertial><collision>
  <origin rpy="1.5707963 0 0"/><geometry><cylinder radius="0.015" length="0.01"/></geometry>
  </collision></link>
<joint name="roll_{i}" type="continuous"><origin xyz="-{trail} 0 -0.03"/><axis xyz="0 1 0"/>
  <parent link="fork_{i}"/><child link="roll_{i}"/></joint>"""
PLACES = [("0.3 0.2", 0.3), ("0.3 -0.2", 0.3), ("-0.3 0.2", -1.0), ("-0.3 -0.2", -2.0)]


@pytest.mark.parametrize("trail", [0.0, 0.005])
@pytest.mark.parametrize(("forward", "turn"), [(0.2, 0.0), (0.0, 0.4)])
def test_casters_below_their_swivel_axis_neither_hop_nor_brake_their_robot(
    make, trail, forward, turn
):
    """They carry more than half the weight at μ = 1, and friction does not turn them ahead.

    They slide across their wheels only, at angles at which the driven wheels are stronger.
    """
    parts = [HEAVY_WHEEL.format(side=side, y=y) for side, y in (("left", 0.26), ("right", -0.26))]
    parts += [SWIVEL.format(i=i, at=at, yaw=yaw, trail=trail) for i, (at, yaw) in enumerate(PLACES)]
    robot = load_text(CASTERS.format(parts="".join(parts)), file="cart.urdf")
    world = stand(make, robot, pose=Pose((0, 0, 0.045)))
    world.publish("/cmd_vel", linear_x=forward, angular_z=turn)
    world.run(2.0)
    robot = world.model("cart")
    before, heights = robot.pose, []
    for _ in range(20):
        world.run(0.1)
        heights.append(robot.pose.z)
    assert math.dist(robot.pose.position, before.position) / 2.0 == pytest.approx(forward, abs=2e-3)
    assert (robot.pose.yaw - before.yaw) / 2.0 == pytest.approx(turn, abs=4e-3)
    assert max(heights) - min(heights) < 1e-4


@pytest.mark.parametrize(("limit", "round_"), [(1000.0, True), (3.0, False)])
def test_limits_many_turns_away_leave_a_wheel_a_wheel(make, limit, round_):
    turning = f'type="revolute"><limit lower="-{limit}" upper="{limit}" effort="9" velocity="99"/>'
    wheels = [WHEEL.format(side=side, y=y) for side, y in (("left", 0.18), ("right", -0.18))]
    text = DRAGGING.format(wheels="".join(wheels)).replace('type="continuous">', turning)
    world = make.world()
    world.spawn(load_text(text, file="drag.urdf"), z=0.1)
    model = world.session.simulation.model
    kind = model.geom_type[model.geom("drag::left::left_collision").id]
    ellipsoid, cylinder = (
        int(getattr(mujoco.mjtGeom, f"mjGEOM_{k}")) for k in ("ELLIPSOID", "CYLINDER")
    )
    assert kind == (ellipsoid if round_ else cylinder)


TURNING = """<robot name="slab">
<link name="trunk"><inertial><mass value="2"/>
  <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.02"/></inertial>
  <collision><geometry><box size="0.4 0.4 0.1"/></geometry></collision></link>
<link name="disc"><inertial><mass value="0.05"/>
  <inertia ixx="1e-4" ixy="0" ixz="0" iyy="1e-4" iyz="0" izz="1e-4"/></inertial>
  <collision><origin rpy="{rpy}"/>
  <geometry><cylinder radius="0.1" length="0.01"/></geometry></collision></link>
<joint name="spin" type="continuous"><origin xyz="{xyz}"/><axis xyz="{axis}"/>
  <parent link="trunk"/><child link="disc"/></joint></robot>"""


@pytest.mark.parametrize(
    ("xyz", "axis", "rpy"),
    [("0 0 0.1", "0 0 1", "0 0 0"), ("0 0 0.4", "0 1 0", "1.5707963 0 0")],
    ids=["rotor", "wrist"],
)
def test_a_trunk_without_wheels_beside_it_slides_as_coulomb_says(make, xyz, axis, rpy):
    """Struck at μ = 1: it is sped up by F / m - g, and stopped by g."""
    robot = load_text(TURNING.format(xyz=xyz, axis=axis, rpy=rpy), file="slab.urdf")
    world = stand(make, robot, pose=Pose((0, 0, 0.05)))
    before = world.model("slab").pose.x
    mass, force, seconds, gravity = 2.05, 205.0, 0.01, 9.8
    world.session.simulation.forces.wrench(
        "slab", "trunk", force=(force, 0, 0), torque=(0, 0, 0), duration_ns=int(seconds * 1e9)
    )
    world.run(1.0)
    speed = (force / mass - gravity) * seconds
    way = speed * seconds / 2 + speed**2 / (2 * gravity)
    assert world.model("slab").pose.x - before == pytest.approx(way, rel=0.1)
