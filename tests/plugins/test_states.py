"""True poses, joint states, wrenches, pushes and coupled joints: against the state itself."""

import math

import numpy as np
import pytest
from tests.coded import coded

from cartwheel.codes import devices, running
from cartwheel.errors import PluginError, UnknownNameError
from cartwheel.geometry import Pose, matrix_from_quat, quat_from_rpy
from cartwheel.messages import message_class

G = 9.8

BOX = """<link name="link"><inertial><mass>4</mass><inertia><ixx>0.06</ixx><iyy>0.06</iyy>
  <izz>0.1</izz></inertia></inertial><collision name="c"><geometry><box><size>0.4 0.4 0.1</size>
  </box></geometry></collision></link>"""

ARM = """<model name="arm"><pose>0 0 1 0 0 0</pose>
  <link name="post"><inertial><mass>1</mass></inertial></link>
  <link name="beam"><inertial><pose>0.5 0 0 0 0 0</pose><mass>3</mass>
    <inertia><ixx>.1</ixx><iyy>.1</iyy><izz>.1</izz></inertia></inertial></link>
  <link name="hand"><pose>1 0 0 0 0 0</pose><inertial><mass>2</mass>
    <inertia><ixx>.1</ixx><iyy>.1</iyy><izz>.1</izz></inertia></inertial></link>
  <joint name="bolt" type="fixed"><parent>world</parent><child>post</child></joint>
  <joint name="turn" type="revolute"><parent>post</parent><child>beam</child>
    <axis><xyz>0 0 1</xyz></axis></joint>
  <joint name="wrist" type="{wrist}"><parent>beam</parent><child>hand</child>{axis}{sensor}</joint>
  {plugin}</model>"""
AXIS = "<axis><xyz>0 0 1</xyz></axis>"


def arm(plugin="", wrist="fixed", sensor=""):
    axis = "" if wrist == "fixed" else AXIS
    return ARM.format(plugin=plugin, wrist=wrist, axis=axis, sensor=sensor)


def vector(message):
    return np.array([message.x, message.y, message.z])


def turn(message):
    return (message.x, message.y, message.z, message.w)


# -- ground truth


def p3d(tags):
    return f"""<model name="unit"><pose>0 0 50 0 0 0</pose>{BOX}
      <plugin name="truth" filename="libgazebo_ros_p3d.so"><bodyName>link</bodyName>
      <topicName>truth</topicName><updateRate>50</updateRate>{tags}</plugin></model>"""


def test_p3d_tells_a_falling_body(make, read):
    """z = z₀ - g t² / 2, v = -g t, in the world's axes whatever way the body is turned."""
    world = make.world(ground=None)
    world.session.spawn(make.sdf(p3d("")), pose=Pose((1, 2, 50), quat_from_rpy(0.3, 0.2, 1.0)))
    messages = read(world, "/truth", 1.0)
    assert len(messages) == 50
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
    assert len(messages) == 50
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


def test_pal_s_world_odometry_tells_the_twist_in_the_link_s_axes(make, read):
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


def test_p3d_of_a_frame_that_is_no_link_is_told(make, read):
    world = make.world(make.sdf(p3d("<frameName>odom_combined</frameName>")), ground=None)
    assert coded(world, devices.FRAME_UNKNOWN, frame="odom_combined")
    assert read(world, "/truth", 0.1)[0].header.frame_id == "odom_combined"


def test_gz_odometry_publisher_tells_the_model_in_its_own_axes(make, read):
    plugin = """<plugin name="o" filename="gz-sim-odometry-publisher-system">
      <odom_frame>odom</odom_frame><robot_base_frame>base</robot_base_frame>
      <dimensions>3</dimensions><odom_publish_frequency>25</odom_publish_frequency></plugin>"""
    world = make.world(ground=None, gravity=0.0)
    model = f'<model name="unit">{BOX}{plugin}</model>'
    world.session.spawn(make.sdf(model), pose=Pose((1, 2, 3), quat_from_rpy(0, 0, math.pi / 2)))
    world.session.simulation.data.joint("unit::link").qvel[:3] = [0.0, 0.5, 0.2]
    messages = read(world, "/model/unit/odometry", 2.0)
    assert len(messages) == 50
    last = messages[-1]
    assert (last.header.frame_id, last.child_frame_id) == ("odom", "base")
    seconds = 49 / 25
    assert vector(last.pose.pose.position) == pytest.approx(
        [1, 2 + 0.5 * seconds, 3 + 0.2 * seconds], abs=1e-6
    )
    # It looks along y: what goes along y is forward.
    assert vector(last.twist.twist.linear) == pytest.approx([0.5, 0, 0.2], abs=1e-6)


# -- joint states


def joint_states(tags, name="libgazebo_ros_joint_state_publisher.so"):
    return f'<plugin name="s" filename="{name}">{tags}</plugin>'


def test_classic_joint_states_go_under_the_models_name(make, read):
    plugin = joint_states("<jointName>wrist, turn</jointName><updateRate>50</updateRate>")
    world = make.world(make.sdf(arm(plugin, "revolute")), ground=None)
    world.session.simulation.data.joint("arm::turn").qvel[0] = 1.0
    messages = read(world, "/arm/joint_states", 1.0)
    assert len(messages) == 50
    assert messages[0].name == ["wrist", "turn"]
    data = world.session.simulation.data
    # One period ago, and the joint turns steadily.
    last = messages[-1]
    expected = data.joint("arm::turn").qpos[0] - 0.02 * data.joint("arm::turn").qvel[0]
    assert last.position[1] == pytest.approx(expected, abs=1e-3)
    assert last.velocity[1] == pytest.approx(data.joint("arm::turn").qvel[0], abs=1e-2)
    assert len(last.effort) == 0


def test_ros2_joint_states_of_all_joints_that_move(make, read):
    plugin = joint_states("<ros><namespace>/r</namespace></ros>")
    world = make.world(make.sdf(arm(plugin)), ground=None)
    messages = read(world, "/r/joint_states", 1.0)
    assert len(messages) == 100
    assert messages[0].name == ["turn"]


def test_gz_joint_states_tell_efforts(make, cart, read):
    """A cart that rolls steadily needs nothing; at its torque limit its wheels give just that."""
    plugin = """<plugin name="d" filename="gz-sim-diff-drive-system">
      <left_joint>left_joint</left_joint><right_joint>right_joint</right_joint>
      <wheel_separation>0.3</wheel_separation><wheel_radius>0.1</wheel_radius></plugin>
      <plugin name="s" filename="gz-sim-joint-state-publisher-system">
      <joint_name>left_joint</joint_name><update_rate>50</update_rate></plugin>"""
    wheels = {"left": (0.0, 0.15), "right": (0.0, -0.15)}
    model = cart(wheels, plugin, balls=((0.15, 0.0), (-0.15, 0.0)))
    world = make.world(model)
    world.run(0.5)
    world.publish("/model/cart/cmd_vel", linear_x=0.5)
    world.run(1.0)
    messages = read(world, "/world/test/model/cart/joint_state", 1.0)
    assert len(messages) == 50
    assert messages[-1].velocity[0] == pytest.approx(5.0, rel=0.01)
    assert abs(np.mean([m.effort[0] for m in messages])) < 0.05


def test_joint_states_of_unknown_joints_name_the_likely_one(make):
    plugin = joint_states("<jointName>trun</jointName>")
    with pytest.raises(UnknownNameError) as caught:
        make.world(make.sdf(arm(plugin)), ground=None)
    assert (caught.value.values["name"], caught.value.values["meant"]) == ("trun", "turn")


def test_a_fixed_joint_has_no_state_and_that_is_told(make, read):
    plugin = joint_states("<jointName>turn,wrist</jointName>")
    world = make.world(make.sdf(arm(plugin)), ground=None)
    assert read(world, "/arm/joint_states", 0.1)[0].name == ["turn"]
    assert coded(world, running.JOINT_WITHOUT_STATE, joint="wrist")


# -- force and torque


def ft(tags):
    return f"""<plugin name="f" filename="libgazebo_ros_ft_sensor.so"><topicName>ft</topicName>
      <updateRate>50</updateRate>{tags}</plugin>"""


@pytest.mark.parametrize(
    ("joint", "mass", "reach"), [("wrist", 2, 0.0), ("turn", 5, (3 * 0.5 + 2 * 1.0) / 5)]
)
def test_a_joint_bears_weight_times_arm(make, read, joint, mass, reach):
    """What hangs behind the joint pulls down with its weight, and turns about y with its arm."""
    world = make.world(make.sdf(arm(ft(f"<jointName>{joint}</jointName>"))), ground=None)
    messages = read(world, "/ft", 1.0)
    assert len(messages) == 50
    wrench = messages[-1].wrench
    assert vector(wrench.force) == pytest.approx([0, 0, -mass * G], abs=1e-6)
    assert vector(wrench.torque) == pytest.approx([0, mass * G * reach, 0], abs=1e-6)
    assert messages[0].header.frame_id == ("hand" if joint == "wrist" else "beam")


def test_ft_sensor_feels_what_pushes_the_hand(make, read):
    plugin = (
        ft("<jointName>wrist</jointName>")
        + """<plugin name="p"
      filename="libgazebo_ros_force.so"><bodyName>hand</bodyName><topicName>push</topicName>
      </plugin>"""
    )
    # Held by the wrist along x, where the arm is stiff.
    world = make.world(make.sdf(arm(plugin)), ground=None)
    wrench = message_class("geometry_msgs/msg/Wrench")
    three = message_class("geometry_msgs/msg/Vector3")
    world.graph.publish(
        "/push", "geometry_msgs/msg/Wrench", wrench(three(7.0, 0.0, 5.0), three(0.0, 0.0, 0.0))
    )
    message = read(world, "/ft", 0.5)[-1]
    assert vector(message.wrench.force) == pytest.approx([7.0, 0.0, 5.0 - 2 * G], abs=1e-6)


def test_ft_noise_has_its_spread(make, read):
    tags = "<jointName>wrist</jointName><gaussianNoise>0.5</gaussianNoise>"
    world = make.world(make.sdf(arm(ft(tags))), ground=None)
    values = np.array([vector(m.wrench.torque) for m in read(world, "/ft", 20.0)])
    assert values.std() == pytest.approx(0.5, rel=4 / math.sqrt(2 * values.size))


@pytest.mark.parametrize(
    ("words", "sign", "frame"),
    [
        ("", 1, "hand"),
        ("<measure_direction>parent_to_child</measure_direction>", -1, "hand"),
        ("<frame>parent</frame>", 1, "beam"),
    ],
)
def test_gz_force_torque_sensor_says_who_pulls(make, read, words, sign, frame):
    sensor = f"""<sensor name="ft" type="force_torque"><update_rate>50</update_rate>
      <topic>ft</topic><force_torque>{words}</force_torque></sensor>"""
    world = make.world(make.sdf(arm(sensor=sensor)), ground=None)
    message = read(world, "/ft", 0.5)[-1]
    assert vector(message.wrench.force) == pytest.approx([0, 0, -sign * 2 * G], abs=1e-6)
    assert message.header.frame_id == frame


@pytest.mark.parametrize(
    ("words", "sign", "axes", "frame"),
    [
        ("", 1, "child", "hand"),
        ("<frame>parent</frame>", 1, "parent", "beam"),
        ("<frame>sensor</frame>", 1, "sensor", "ft"),
        (
            "<frame>sensor</frame><measure_direction>parent_to_child</measure_direction>",
            -1,
            "sensor",
            "ft",
        ),
    ],
)
@pytest.mark.parametrize("relative", ["", "beam"])
def test_a_wrench_is_in_the_axes_that_are_asked_for(  # noqa: PLR0917
    make, read, words, sign, axes, frame, relative
):
    """Beam, hand, joint and sensor are all turned; what hangs pulls straight down."""
    turns = {"beam": (0, 0, 0.5), "hand": (0.3, 0, 0), "joint": (0, 0.4, 0), "own": (0, 0, 1.1)}
    beam, hand, joint, own = (matrix_from_quat(quat_from_rpy(*each)) for each in turns.values())
    of = f' relative_to="{relative}"' if relative else ""
    model = f"""<model name="unit"><link name="beam"><pose>0 0 2 0 0 0.5</pose></link>
      <link name="hand"><pose>0 0 1 0.3 0 0</pose><inertial><pose>0.1 0 0 0 0 0</pose>
        <mass>2</mass><inertia><ixx>.1</ixx><iyy>.1</iyy><izz>.1</izz></inertia></inertial></link>
      <joint name="bolt" type="fixed"><parent>world</parent><child>beam</child></joint>
      <joint name="wrist" type="fixed"><pose>0 0 0 0 0.4 0</pose><parent>beam</parent>
        <child>hand</child><sensor name="ft" type="force_torque"><pose{of}>0 0 0 0 0 1.1</pose>
        <topic>ft</topic><update_rate>50</update_rate><force_torque>{words}</force_torque>
        </sensor></joint></model>"""
    world = make.world(make.sdf(model), ground=None)
    message = read(world, "/ft", 0.1)[-1]
    in_world = {"child": hand, "parent": beam, "sensor": (beam if relative else hand @ joint) @ own}
    force = np.array([0, 0, -2 * G])
    torque = np.cross(hand @ [0.1, 0, 0], force)
    turned = sign * in_world[axes].T
    assert vector(message.wrench.force) == pytest.approx(turned @ force, abs=1e-9)
    assert vector(message.wrench.torque) == pytest.approx(turned @ torque, abs=1e-9)
    assert message.header.frame_id == frame


PLATE = """<model name="plate">{static}<link name="foot"><pose>0 0 2 0 0 0</pose></link>
  <link name="plate"><pose>0 0 2.2 0 0 0</pose><inertial><mass>2</mass><inertia><ixx>.1</ixx>
    <iyy>.1</iyy><izz>.1</izz></inertia></inertial><collision name="c"><geometry><box>
    <size>1 1 .1</size></box></geometry></collision></link>{bolt}
  <joint name="cell" type="fixed"><parent>foot</parent><child>plate</child></joint>{plugin}</model>
"""
BOLT = """<joint name="bolt" type="fixed"><parent>world</parent><child>foot</child></joint>"""


@pytest.mark.parametrize("stands", [{"static": "<static>1</static>", "bolt": ""},
                                    {"static": "", "bolt": BOLT}])  # fmt: skip
@pytest.mark.parametrize(
    ("tags", "weight", "frame"),
    [
        ("<jointName>cell</jointName>", 7, "plate"),
        ("<ros/><joint_name>cell</joint_name>", 7, "plate"),
        ("<ros/><body_name>plate</body_name>", 5, "world"),
        ("<ros/><body_name>plate</body_name><frame_name>foot</frame_name>", 5, "foot"),
    ],
)
def test_a_scale_feels_what_lies_on_it_for_as_long_as_it_lies(  # noqa: PLR0917
    make, read, stands, tags, weight, frame
):
    """A joint bears the plate of 2 kg and the box of 5; on the plate itself the box presses."""
    box = make.box("box", (0.3, 0.3, 0.3), mass=5, pose=Pose((0, 0, 2.4)))
    world = make.world(make.sdf(PLATE.format(plugin=ft(tags), **stands)), box)
    world.run(5.0)
    assert not world.diagnostics
    messages = read(world, "/ft", 0.1)
    assert messages
    for message in messages:
        assert vector(message.wrench.force) == pytest.approx([0, 0, -weight * G], abs=1e-3)
        assert message.header.frame_id == frame


def test_a_frame_of_a_joints_wrench_is_told_as_idle(make):
    tags = "<jointName>wrist</jointName><frame_name>beam</frame_name>"
    (told,) = make.world(make.sdf(arm(ft(tags)))).diagnostics
    assert told.code is devices.PLUGIN_PARAMETER_IGNORED
    assert told.values["parameter"] == "frame_name"


# -- pushes


def test_a_push_accelerates_by_newton_and_ends_with_the_next(make):
    model = f"""<model name="unit">{BOX}<plugin name="p" filename="libgazebo_ros_force.so">
      <bodyName>link</bodyName><topicName>push</topicName></plugin></model>"""
    world = make.world(make.sdf(model), gravity=0.0, ground=None)
    wrench = message_class("geometry_msgs/msg/Wrench")
    three = message_class("geometry_msgs/msg/Vector3")
    none = three(0.0, 0.0, 0.0)
    data = world.session.simulation.data
    for force, speed in ((8.0, 2.0), (0.0, 2.0), (-4.0, 1.0)):
        world.graph.publish(
            "/push", "geometry_msgs/msg/Wrench", wrench(three(force, 0.0, 0.0), none)
        )
        world.run(1.0)
        assert data.joint("unit::link").qvel[0] == pytest.approx(speed, abs=1e-9)


# -- coupled joints


def test_a_mimic_joint_follows(make):
    plugin = """<plugin name="m" filename="libroboticsgroup_upatras_gazebo_mimic_joint_plugin.so">
      <joint>turn</joint><mimicJoint>wrist</mimicJoint><multiplier>-0.5</multiplier>
      <offset>0.2</offset></plugin>"""
    world = make.world(make.sdf(arm(plugin, "revolute")), ground=None)
    world.session.simulation.data.joint("arm::turn").qvel[0] = 1.0
    world.run(1.0)
    simulation = world.session.simulation
    leader = simulation.joint_position("arm", "turn")
    assert abs(leader) > 0.1
    assert simulation.joint_position("arm", "wrist") == pytest.approx(0.2 - leader / 2, abs=0.01)


# -- trajectories

TRAJECTORY = """<plugin name="t" filename="libgazebo_ros_joint_pose_trajectory.so"/>"""


def trajectory(names, points, frame=""):
    """``JointTrajectory`` of (seconds, positions)."""
    point, duration = (
        message_class("trajectory_msgs/msg/JointTrajectoryPoint"),
        message_class("builtin_interfaces/msg/Duration"),
    )
    nothing = np.zeros(0)
    made = [
        point(np.array(positions), nothing, nothing, nothing,
              duration(int(seconds), int(seconds % 1 * 1e9)))
        for seconds, positions in points
    ]  # fmt: skip
    time = message_class("builtin_interfaces/msg/Time")
    header = message_class("std_msgs/msg/Header")(time(0, 0), frame)
    return message_class("trajectory_msgs/msg/JointTrajectory")(header, names, made)


def test_a_trajectory_sets_joints_at_its_times(make):
    world = make.world(make.sdf(arm(TRAJECTORY, "revolute")), ground=None, gravity=0.0)
    world.run(1.0)
    message = trajectory(["turn", "wrist"], [(0.5, [0.3, -0.2]), (1.0, [0.6, -0.4])])
    world.graph.publish("/set_joint_trajectory", "trajectory_msgs/msg/JointTrajectory", message)
    position = world.session.simulation.joint_position
    for seconds, turned, bent in ((0.45, 0, 0), (0.1, 0.3, -0.2), (0.5, 0.6, -0.4), (1, 0.6, -0.4)):
        world.run(seconds)
        assert position("arm", "turn") == pytest.approx(turned, abs=1e-9)
        assert position("arm", "wrist") == pytest.approx(bent, abs=1e-9)


def test_a_trajectory_that_cannot_be_followed_is_refused(make):
    world = make.world(make.sdf(arm(TRAJECTORY)), ground=None)
    request = message_class("gazebo_msgs/srv/SetJointTrajectory_Request")
    pose = message_class("geometry_msgs/msg/Pose")
    point = message_class("geometry_msgs/msg/Point")(0.0, 0.0, 0.0)
    where = pose(point, message_class("geometry_msgs/msg/Quaternion")(0.0, 0.0, 0.0, 1.0))

    def ask(names, positions, model="arm"):
        service = world.graph.service("/set_joint_trajectory")
        return service.handler(
            request(
                model_name=model,
                joint_trajectory=trajectory(names, [(0, positions)]),
                model_pose=where,
                set_model_pose=False,
                disable_physics_updates=False,
            )
        )

    assert ask(["turn"], [0.1]).success
    for names, positions, model, what in (
        (["trun"], [0.1], "arm", "no movable joint"),
        (["turn"], [0.1, 0.2], "arm", "2 positions for 1 joints"),
        (["turn"], [0.1], "leg", '"leg"'),
    ):
        answer = ask(names, positions, model)
        assert not answer.success
        assert what in answer.status_message


@pytest.mark.parametrize(
    ("model", "parameter"),
    [
        (p3d("<gaussianNoise>-1</gaussianNoise>"), "gaussianNoise"),
        (arm(ft("")), "jointName"),
        (arm(joint_states("<updateRate>-1</updateRate>")), "updateRate"),
    ],
)
def test_parameters_without_sense_name_their_line(make, model, parameter):
    with pytest.raises(PluginError) as caught:
        make.world(make.sdf(model), ground=None)
    assert caught.value.values["parameter"] == parameter
    assert caught.value.origin is not None
