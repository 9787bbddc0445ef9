"""Joint states, coupled joints and trajectories: against the state itself."""

import numpy as np
import pytest
from tests.coded import coded
from tests.devices.bodies import arm

from cartwheel.codes import running
from cartwheel.errors import PluginError, UnknownNameError
from cartwheel.messages import message_class

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
    before = world.session.simulation.data.qpos.copy()
    for names, positions, model in (
        (["trun"], [0.1], "arm"),
        (["turn"], [0.1, 0.2], "arm"),
        (["turn"], [0.1], "leg"),
    ):
        answer = ask(names, positions, model)
        assert not answer.success and answer.status_message
        assert (world.session.simulation.data.qpos == before).all()


@pytest.mark.parametrize(
    ("model", "parameter"),
    [
        (arm(joint_states("<updateRate>-1</updateRate>")), "updateRate"),
    ],
)
def test_parameters_without_sense_name_their_line(make, model, parameter):
    with pytest.raises(PluginError) as caught:
        make.world(make.sdf(model), ground=None)
    assert caught.value.values["parameter"] == parameter
    assert caught.value.origin is not None
