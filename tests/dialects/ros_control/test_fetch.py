"""``libfetch_gazebo_plugin.so``: the base, the torso, the arm, the head and the gripper."""

import copy

import pytest
import yaml
from tests.coded import coded

from cartwheel.checks.checking import check
from cartwheel.codes import devices, running
from cartwheel.codes import robot as robots
from cartwheel.corpus import try_robot
from cartwheel.messages import from_dict

SUCCEEDED, ABORTED, PREEMPTED = 3, 4, 2
RADIUS, TRACK = 0.06, 0.374
ARM = ["shoulder_joint", "elbow_joint"]
CONTROLLERS = {
    "arm_controller": {
        "follow_joint_trajectory": {
            "type": "robot_controllers/FollowJointTrajectoryController",
            "joints": ARM,
        },
        "gravity_compensation": {
            "type": "robot_controllers/GravityCompensation",
            "root": "torso",
            "tip": "elbow",
            "autostart": True,
        },
    },
    "arm_with_torso_controller": {
        "follow_joint_trajectory": {
            "type": "robot_controllers/FollowJointTrajectoryController",
            "joints": ["torso_joint", *ARM],
        }
    },
    "torso_controller": {
        "follow_joint_trajectory": {
            "type": "robot_controllers/FollowJointTrajectoryController",
            "joints": ["torso_joint"],
        }
    },
    "head_controller": {
        "point_head": {"type": "robot_controllers/PointHeadController"},
        "follow_joint_trajectory": {
            "type": "robot_controllers/FollowJointTrajectoryController",
            "joints": ["head_joint"],
        },
    },
    "base_controller": {"type": "robot_controllers/DiffDriveBaseController", "autostart": True},
    "gripper_controller": {
        "gripper_action": {
            "type": "robot_controllers/ParallelGripperController",
            "centering": {"p": 1000.0, "d": 0.0, "i": 0.0, "i_clamp": 0.0},
        }
    },
    "bellows_controller": {
        "type": "robot_controllers/ScaledMimicController",
        "mimic_joint": "torso_joint",
        "controlled_joint": "bellows_joint",
        "mimic_scale": 0.5,
        "autostart": True,
    },
    "gazebo": {
        "default_controllers": [
            "arm_controller/follow_joint_trajectory",
            "arm_controller/gravity_compensation",
            "arm_with_torso_controller/follow_joint_trajectory",
            "base_controller",
            "head_controller/follow_joint_trajectory",
            "head_controller/point_head",
            "torso_controller/follow_joint_trajectory",
            "gripper_controller/gripper_action",
            "bellows_controller",
        ],
        "l_wheel_joint": {"velocity": {"p": 8.85, "d": 0.0, "i": 0.5, "i_clamp": 6.0}},
    },
}
"""The same structure as Fetch's own file, with fewer joints."""


LINK = """<link name="{name}"><inertial><mass value="{mass}"/><inertia ixx="2e-3" iyy="2e-3"
  izz="2e-3" ixy="0" ixz="0" iyz="0"/></inertial>{shape}</link><joint name="{name}_joint"
  type="{kind}"><parent link="{parent}"/><child link="{name}"/><origin xyz="{origin}"/>
  <axis xyz="{axis}"/><limit {limit}/></joint>"""
WHEEL = f"""<collision><origin rpy="1.5707963 0 0"/><geometry><cylinder radius="{RADIUS}"
  length="0.03"/></geometry></collision>"""
TURNS = {"kind": "revolute", "limit": 'lower="-2" upper="2" effort="60" velocity="1.5"'}
SLIDES = {"kind": "prismatic", "axis": "0 0 1", "parent": "base_link"}
ROLLS = {"kind": "continuous", "axis": "0 1 0", "parent": "base_link", "mass": 1.0,
         "shape": WHEEL, "limit": 'effort="8.85" velocity="17"'}  # fmt: skip
FINGER = {"kind": "prismatic", "parent": "elbow", "origin": "0.3 0 0",
          "limit": 'lower="0" upper="0.05" effort="60" velocity="0.05"'}  # fmt: skip
LIFT = 'lower="0" upper="0.4" effort="{}" velocity="0.1"'
LINKS = {
    "l_wheel": {**ROLLS, "origin": f"0 {TRACK / 2} 0"},
    "r_wheel": {**ROLLS, "origin": f"0 {-TRACK / 2} 0"},
    "torso": {**SLIDES, "origin": "0 0 0.3", "limit": LIFT.format(450)},
    "bellows": {**SLIDES, "origin": "0 0 0.2", "limit": LIFT.format(5)},
    "shoulder": {**TURNS, "parent": "torso", "axis": "0 1 0", "origin": "0.3 0 0.4"},
    "elbow": {**TURNS, "parent": "shoulder", "axis": "0 1 0", "origin": "0.3 0 0"},
    "head": {**TURNS, "parent": "torso", "axis": "0 0 1", "origin": "0 0 0.6"},
    "l_gripper_finger": {**FINGER, "axis": "0 1 0"},
    "r_gripper_finger": {**FINGER, "axis": "0 -1 0"},
}


def robot():
    """A base with two wheels and casters, a torso, an arm, a head and two fingers."""
    links = "".join(
        LINK.format(**{"name": name, "mass": 0.2, "shape": ""} | values)
        for name, values in LINKS.items()
    )
    casters = "".join(
        f"""<collision><origin xyz="{x} 0 -0.03"/><geometry><sphere radius="0.03"/></geometry>
        </collision>"""
        for x in (-0.2, 0.2)
    )
    return f"""<robot name="fetch"><link name="base_link"><inertial><mass value="60"/>
      <inertia ixx="2" iyy="2" izz="2" ixy="0" ixz="0" iyz="0"/></inertial>{casters}</link>{links}
      <gazebo><plugin name="fetch_gazebo_plugin" filename="libfetch_gazebo_plugin.so"/></gazebo>
      <gazebo reference="base_link"><mu1>0.1</mu1><mu2>0.1</mu2></gazebo></robot>"""


class Fetch:
    """The robot in a world."""

    def __init__(self, make, folder, controllers=CONTROLLERS):
        urdf, file = folder / "fetch.urdf", folder / "default_controllers.yaml"
        urdf.write_text(robot())
        file.write_text(yaml.safe_dump(controllers))
        self.world = make.world()
        self.model = self.world.spawn(urdf, z=RADIUS, controllers=[file])
        self.world.run(0.5)

    def position(self, name):
        return self.world.session.simulation.joint_position("fetch", name)

    def goal(self, controller, seconds, **positions):
        """Sends a goal; returns a mailbox of the results."""
        name = f"/{controller}/follow_joint_trajectory"
        results = self.world.mailbox(f"{name}/result")
        kind = "control_msgs/msg/FollowJointTrajectoryActionGoal"
        point = {"positions": list(positions.values()), "time_from_start": {"sec": seconds}}
        names = [f"{each}_joint" for each in positions]
        trajectory = {"joint_names": names, "points": [point]}
        message = from_dict(kind, {"goal": {"trajectory": trajectory}})
        self.world.session.graph.publish(f"{name}/goal", kind, message)
        return results


@pytest.fixture
def fetch(make, tmp_path):
    return Fetch(make, tmp_path)


@pytest.mark.parametrize("topic", ["/cmd_vel", "/base_controller/command"])
def test_it_drives_and_turns(fetch, topic):
    world = fetch.world
    odometry = world.mailbox("/odom")
    for _ in range(40):
        world.publish(topic, linear_x=0.5)
        world.run(0.1)
    # It accelerates at 0.75 m/s² for two thirds of a second.
    way = 0.5 * (4.0 - 0.5 / 0.75 / 2)
    assert fetch.model.pose.x == pytest.approx(way, rel=0.03)
    assert odometry.drain()[-1].pose.pose.position.x == pytest.approx(fetch.model.pose.x, abs=0.05)
    world.run(2.0)
    yaw = fetch.model.pose.yaw
    for _ in range(20):
        world.publish(topic, angular_z=0.6)
        world.run(0.1)
    assert fetch.model.pose.yaw - yaw == pytest.approx(0.6 * (2.0 - 0.1), rel=0.1)


def test_trajectories_move_arm_torso_and_head(fetch):
    arm = fetch.goal("arm_controller", 2, shoulder=0.5, elbow=-0.7)
    head = fetch.goal("head_controller", 1, head=0.4)
    fetch.world.run(4.0)
    torso = fetch.goal("torso_controller", 3, torso=0.2)
    fetch.world.run(5.0)
    for results in (arm, head, torso):
        (result,) = results.drain()
        assert result.status.status == SUCCEEDED
    positions = [fetch.position(f"{each}_joint") for each in ("shoulder", "elbow", "head", "torso")]
    assert positions == pytest.approx([0.5, -0.7, 0.4, 0.2], abs=0.01)
    # The bellows follow the torso by half.
    assert fetch.position("bellows_joint") == pytest.approx(0.1, abs=0.01)


def test_a_goal_takes_the_joints_of_another_controller(fetch):
    arm = fetch.goal("arm_controller", 5, shoulder=1.0, elbow=-1.0)
    fetch.world.run(1.0)
    both = fetch.goal("arm_with_torso_controller", 2, torso=0.1, shoulder=0.2, elbow=0.1)
    fetch.world.run(4.0)
    (stopped,), (result,) = arm.drain(), both.drain()
    assert stopped.status.status == PREEMPTED
    assert result.status.status == SUCCEEDED
    positions = [fetch.position(f"{each}_joint") for each in ("torso", "shoulder", "elbow")]
    assert positions == pytest.approx([0.1, 0.2, 0.1], abs=0.01)
    # And back again.
    again = fetch.goal("arm_controller", 1, shoulder=0.0, elbow=0.0)
    fetch.world.run(3.0)
    (result,) = again.drain()
    assert result.status.status == SUCCEEDED
    assert fetch.position("torso_joint") == pytest.approx(0.1, abs=0.01)


def test_the_fingers_open_symmetrically(fetch):
    results = fetch.world.mailbox("/gripper_controller/gripper_action/result")
    kind = "control_msgs/msg/GripperCommandActionGoal"
    goal = from_dict(kind, {"goal": {"command": {"position": 0.08, "max_effort": 30.0}}})
    fetch.world.session.graph.publish("/gripper_controller/gripper_action/goal", kind, goal)
    fetch.world.run(3.0)
    (result,) = results.drain()
    assert result.status.status == SUCCEEDED
    assert result.result.reached_goal
    assert result.result.position == pytest.approx(0.08, abs=0.003)
    fingers = [fetch.position(f"{side}_gripper_finger_joint") for side in "lr"]
    assert fingers == pytest.approx([0.04, 0.04], abs=0.002)


def test_joint_states_are_published(fetch):
    states = fetch.world.mailbox("/joint_states")
    fetch.world.run(1.0)
    messages = states.drain()
    assert len(messages) == pytest.approx(100, abs=1)
    assert set(messages[-1].name) >= {"l_wheel_joint", "torso_joint", "elbow_joint"}


def test_unsupported_controllers_are_reported(fetch):
    (found,) = coded(fetch.world, devices.CONTROLLER_TYPE_UNKNOWN)
    assert found.values["name"] == "robot_controllers/PointHeadController"
    assert not coded(fetch.world, running.CONTROLLER_NOT_STARTED)
    assert not coded(fetch.world, devices.CONTROLLER_PARAMETER_UNKNOWN)


def test_only_the_listed_controllers_start(make, tmp_path):
    fewer = copy.deepcopy(CONTROLLERS)
    fewer["gazebo"]["default_controllers"] = ["base_controller"]
    fetch = Fetch(make, tmp_path, fewer)
    names = {each.name for each in fetch.world.session.graph.topics()}
    assert "/cmd_vel" in names
    assert not [name for name in names if name.startswith("/arm_controller")]


def test_the_size_of_the_base_is_stated(make, tmp_path):
    stated = copy.deepcopy(CONTROLLERS)
    stated["base_controller"] |= {"track_width": TRACK, "radians_per_meter": 2 / RADIUS}
    fetch = Fetch(make, tmp_path, stated)
    for _ in range(30):
        fetch.world.publish("/cmd_vel", linear_x=0.2)
        fetch.world.run(0.1)
    # The drive takes the wheels for half as large as they are.
    assert fetch.model.pose.x == pytest.approx(2 * 0.2 * (3.0 - 0.2 / 0.75 / 2), rel=0.03)


def test_the_defaults_of_the_base_do_not_depend_on_its_shapes(make, tmp_path):
    """Wheels of meshes, for example, have no radius."""
    file, urdf = tmp_path / "default_controllers.yaml", tmp_path / "fetch.urdf"
    file.write_text(yaml.safe_dump(CONTROLLERS))
    ball = '<collision><geometry><box size="0.085 0.03 0.085"/></geometry></collision>'
    urdf.write_text(robot().replace(WHEEL, ball))
    world = make.world(gravity=0.0)
    world.spawn(urdf, z=1.0, controllers=[file])

    def drive(seconds):
        for _ in range(round(seconds / 0.1)):
            world.publish("/cmd_vel", linear_x=0.2)
            world.run(0.1)
        return world.session.simulation.joint_position("fetch", "l_wheel_joint")

    before = drive(1.0)
    assert drive(1.0) - before == pytest.approx(0.2 * 16.5289, rel=0.01)


@pytest.mark.parametrize("names", ["all", "base"])
def test_a_launch_file_loads_its_controllers(tmp_path, names):
    base = {each: CONTROLLERS[each] for each in ("base_controller", "gazebo")}
    base["gazebo"] = {"default_controllers": ["base_controller"], "l_wheel_joint": {}}
    loaded = CONTROLLERS if names == "all" else base
    (tmp_path / "package.xml").write_text("<package><name>bot</name></package>")
    (tmp_path / "launch").mkdir()
    (tmp_path / "fetch.urdf").write_text(robot())
    (tmp_path / "settings.yaml").write_text(yaml.safe_dump(loaded))
    (tmp_path / "launch" / "bot.launch").write_text(
        '<launch><rosparam file="$(find bot)/settings.yaml" command="load"/>'
        '<param name="robot_description" textfile="$(find bot)/fetch.urdf"/>'
        '<node name="g" pkg="gazebo_ros" type="spawn_model" args="-urdf -model bot"/></launch>'
    )
    verdict = try_robot(tmp_path / "fetch.urdf", standing=1.0)
    assert {drive.topic for drive in verdict.drives} == {"/base_controller/command", "/cmd_vel"}
    assert verdict.should_move
    assert not verdict.faults
    (tmp_path / "launch" / "bot.launch").unlink()
    (tmp_path / "settings.yaml").unlink()
    verdict = try_robot(tmp_path / "fetch.urdf", standing=1.0)
    assert verdict.should_move
    assert [fault.code for fault in verdict.faults] == [
        devices.CONTROLLERS_FILE_WITHOUT_CONTROLLERS
    ]


def test_without_a_file_nothing_is_driven(make, tmp_path):
    urdf = tmp_path / "fetch.urdf"
    urdf.write_text(robot())
    world = make.world()
    world.spawn(urdf, z=RADIUS)
    assert coded(world, devices.CONTROLLERS_FILE_WITHOUT_CONTROLLERS)


def test_its_controllers_are_known_to_checks(tmp_path):
    urdf, file = tmp_path / "fetch.urdf", tmp_path / "default_controllers.yaml"
    urdf.write_text(robot())
    file.write_text(yaml.safe_dump(CONTROLLERS))
    findings = check(urdf, controller_files=[file]).findings
    (unknown,) = coded(findings, devices.CONTROLLER_TYPE_UNKNOWN)
    assert unknown.values["type"] == "robot_controllers/PointHeadController"
    assert not coded(findings, robots.JOINTS_UNDRIVEN)
    assert not coded(findings, devices.CONTROL_WITHOUT_JOINTS)
