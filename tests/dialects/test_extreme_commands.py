"""Whatever number comes to a drive or controller, the run goes on and its state stays finite."""

import contextlib
import math

import numpy as np
import pytest
import yaml
from tests.coded import coded
from tests.dialects.ros_control.arms import beam, robot, ros2_joint, ros2_parameters, ros2_plugin
from tests.dialects.ros_control.arms import ros2_system as system

import cartwheel as cw
from cartwheel.codes import running
from cartwheel.codes import world as world_codes
from cartwheel.description import load_text
from cartwheel.errors import CartwheelError
from cartwheel.geometry import Pose
from cartwheel.messages import zero
from cartwheel.messages.fields import fields
from cartwheel.simulation.pacing import Pacer

NUMBERS = (math.nan, math.inf, -math.inf, 1e308, -1e308, 1e10)
JOINTS = ("left_front", "right_front", "left_rear", "right_rear")
WHEEL = "<wheelSeparation>0.3</wheelSeparation><wheelDiameter>0.2</wheelDiameter>"
PLUGINS = {
    "libgazebo_ros_diff_drive.so": f"""<left_joint>left_front_joint</left_joint>
      <right_joint>right_front_joint</right_joint>{WHEEL}""",
    "libgazebo_ros_skid_steer_drive.so": f"""<leftFrontJoint>left_front_joint</leftFrontJoint>
      <rightFrontJoint>right_front_joint</rightFrontJoint>
      <leftRearJoint>left_rear_joint</leftRearJoint>
      <rightRearJoint>right_rear_joint</rightRearJoint>{WHEEL}""",
    "libgazebo_ros_planar_move.so": "",
    "libgazebo_ros_force.so": "<bodyName>body</bodyName><topicName>push</topicName>",
    "libridgeback_ros_force_based_move.so": "<robotBaseFrame>body</robotBaseFrame>",
    "libgazebo_ros_tricycle_drive.so": """<steeringJoint>right_rear_joint</steeringJoint>
      <actuatedWheelJoint>left_rear_joint</actuatedWheelJoint>
      <encoderWheelLeftJoint>left_front_joint</encoderWheelLeftJoint>
      <encoderWheelRightJoint>right_front_joint</encoderWheelRightJoint>
      <actuatedWheelDiameter>0.2</actuatedWheelDiameter>
      <encoderWheelDiameter>0.2</encoderWheelDiameter>
      <encoderWheelSeparation>0.3</encoderWheelSeparation>""",
    "gz-sim-diff-drive-system": """<left_joint>left_front_joint</left_joint>
      <right_joint>right_front_joint</right_joint><wheel_separation>0.3</wheel_separation>
      <wheel_radius>0.1</wheel_radius>""",
    "gz-sim-mecanum-drive-system": """<front_left_joint>left_front_joint</front_left_joint>
      <front_right_joint>right_front_joint</front_right_joint>
      <back_left_joint>left_rear_joint</back_left_joint>
      <back_right_joint>right_rear_joint</back_right_joint>
      <wheelbase>0.4</wheelbase><wheel_separation>0.3</wheel_separation>
      <wheel_radius>0.1</wheel_radius>""",
    "gz-sim-velocity-control-system": "",
    "gz-sim-joint-controller-system": "<joint_name>left_front_joint</joint_name>",
    "gz-sim-joint-position-controller-system": "<joint_name>left_front_joint</joint_name>",
    "gz-sim-apply-joint-force-system": "<joint_name>left_front_joint</joint_name>",
    "gz-sim-joint-trajectory-controller-system": "",
    "libgazebo_ros_joint_pose_trajectory.so": "<topicName>set</topicName>",
    "librotors_gazebo_motor_model.so": """<robotNamespace>cart</robotNamespace>
      <jointName>left_front_joint</jointName><linkName>left_front</linkName>
      <turningDirection>cw</turningDirection><motorNumber>0</motorNumber>
      <motorConstant>1e-5</motorConstant><momentConstant>0.01</momentConstant>
      <maxRotVelocity>2000</maxRotVelocity><commandSubTopic>speeds</commandSubTopic>
      <motorSpeedPubTopic>speed</motorSpeedPubTopic><timeConstantUp>0.01</timeConstantUp>
      <timeConstantDown>0.02</timeConstantDown><rotorDragCoefficient>1e-4</rotorDragCoefficient>
      <rollingMomentCoefficient>1e-6</rollingMomentCoefficient>""",
}
CONTROLLERS = {
    "forward_command_controller/ForwardCommandController": {"interface_name": "velocity"},
    "velocity_controllers/JointGroupVelocityController": {},
    "position_controllers/JointGroupPositionController": {},
    "effort_controllers/JointGroupEffortController": {},
    "joint_trajectory_controller/JointTrajectoryController": {
        "command_interfaces": ["position"],
        "state_interfaces": ["position", "velocity"],
    },
}


def cart(make, plugin):
    wheels = "".join(
        f"""<link name="{name}"><pose>{x} {y} 0.1 -1.5707963 0 0</pose><inertial><mass>0.5</mass>
        <inertia><ixx>0.00125</ixx><iyy>0.00125</iyy><izz>0.0025</izz></inertia></inertial>
        <collision name="c"><geometry><cylinder><radius>0.1</radius><length>0.04</length>
        </cylinder></geometry></collision></link>
        <joint name="{name}_joint" type="continuous"><parent>body</parent><child>{name}</child>
        <axis><xyz>0 0 1</xyz></axis></joint>"""
        for name, (x, y) in zip(
            JOINTS, ((0.2, 0.15), (0.2, -0.15), (-0.2, 0.15), (-0.2, -0.15)), strict=True
        )
    )
    tag = f'<plugin name="p" filename="{plugin}">{PLUGINS[plugin]}</plugin>'
    return make.sdf(
        f"""<model name="cart"><link name="body"><pose>0 0 0.15 0 0 0</pose><inertial><mass>8</mass>
        <inertia><ixx>0.1</ixx><iyy>0.2</iyy><izz>0.3</izz></inertia></inertial>
        <collision name="c"><geometry><box><size>0.4 0.2 0.05</size></box></geometry></collision>
        </link>{wheels}{tag}</model>"""
    )


def filled(type_name, number):
    """A message in which every number with a fraction is `number`, arrays have 1 to 4 of them."""
    message = zero(type_name)
    for field in fields(type_name):
        if field.kind == "float":
            value = number
            if field.array:
                value = np.full(field.length or 4, number, dtype=field.type)
            setattr(message, field.name, value)
        elif field.kind == "message" and field.type not in ("std_msgs/msg/Header",):
            inner = filled(field.type, number)
            setattr(message, field.name, [inner] if field.array else inner)
        elif field.name == "joint_names":
            message.joint_names = ["left_front_joint"]
    return message


def inputs(world):
    """Topics that a model reads."""
    return [topic for topic in world.graph.topics() if topic.subscribers]


def run(world, seconds):
    """As `cartwheel run` does, without waiting for the clock."""
    simulation = world.session.simulation
    simulation.set_speed(None)
    pacer = Pacer(simulation, until_ns=simulation.time_ns + round(seconds * 1e9))
    pacer.run()
    assert np.isfinite(simulation.data.qpos).all()
    assert np.isfinite(simulation.data.qvel).all()


def assail(world):
    topics = inputs(world)
    assert topics
    for topic in topics:
        for number in NUMBERS:
            with np.errstate(over="ignore"):
                message = filled(topic.type, number)
            world.graph.publish(topic.name, topic.type, message)
            run(world, 0.3)


@pytest.mark.parametrize("plugin", PLUGINS)
def test_no_number_on_a_topic_ends_the_run(make, plugin):
    world = make.world(cart(make, plugin), step=0.005)
    run(world, 0.2)
    assail(world)
    assert len(coded(world, running.COMMAND_NOT_SIMULATED)) == len(inputs(world))


@pytest.mark.parametrize("kind", CONTROLLERS)
def test_no_number_for_a_controller_ends_the_run(tmp_path, kind):
    file = tmp_path / "own.yaml"
    settings = {"type": kind, "joints": ["left_front_joint"], **CONTROLLERS[kind]}
    file.write_text(yaml.safe_dump(ros2_parameters(100, own=settings)))
    interfaces = ("position", "velocity", "effort")
    body = beam("left_front", "world") + system(ros2_joint("left_front_joint", *interfaces))
    world = cw.World("empty")
    try:
        world.spawn(load_text(robot(body, ros2_plugin(file)), file=str(tmp_path / "arm.urdf")))
        run(world, 0.2)
        assail(world)
        for action in world.graph.actions():
            for number in NUMBERS:
                goal = filled(f"{action.type}_Goal", number)
                goal.trajectory.points[0].time_from_start.sec = 1
                action.submit(goal)
                run(world, 0.3)
    finally:
        world.close()


@contextlib.contextmanager
def refusal(code):
    with pytest.raises(CartwheelError) as caught:
        yield
    assert caught.value.code is code


def test_a_number_that_cannot_be_simulated_is_refused_where_it_enters(make):
    world = make.world(cart(make, "gz-sim-joint-controller-system"))
    simulation = world.session.simulation
    before = world.model("cart").pose
    for wrong in (math.nan, math.inf, 1e308, -1e7):
        where = Pose((0.0, wrong, 0.0))
        for refused in (
            lambda where=where: simulation.set_pose("cart", where),
            lambda where=where: simulation.set_state("cart", where),
            lambda where=where: simulation.spawn(make.box("b", (1, 1, 1)), pose=where),
            lambda wrong=wrong: simulation.set_state("cart", before, linear=(wrong, 0, 0)),
            lambda wrong=wrong: simulation.set_joint_positions("cart", {"left_front_joint": wrong}),
            lambda wrong=wrong: simulation.drive("cart", "left_front_joint", velocity=wrong),
            lambda wrong=wrong: simulation.set_speed(wrong),
        ):
            with pytest.raises(CartwheelError):
                refused()
    for wrong in (math.nan, math.inf, 1e308):
        with refusal(world_codes.NUMBER_OUT_OF_RANGE):
            simulation.forces.wrench("cart", "body", force=(wrong, 0, 0), torque=(0, 0, 0))
        with refusal(world_codes.NUMBER_OUT_OF_RANGE):
            simulation.forces.effort("cart", "left_front_joint", wrong)
    for wrong in (0, -1, 1 << 62):
        with refusal(world_codes.STEP_COUNT_INVALID):
            simulation.step(wrong)
    for wrong in (0.0, 5e-324, 1e308):
        with refusal(world_codes.REAL_TIME_FACTOR_INVALID):
            simulation.set_speed(wrong)
    run(world, 0.2)
    assert world.models == ("ground_plane", "cart")


@pytest.fixture
def pushed(make):
    """A world with a box, after 30 pushes that diverge."""
    world = make.world(make.box("box", (1, 1, 1), mass=0.01))
    simulation = world.session.simulation
    run(world, 0.1)
    for _ in range(30):
        simulation.forces.wrench("box", "link", force=(0, 0, 1e10), torque=(1e10, 0, 0))
        before = simulation.time_ns
        run(world, 0.2)
        assert simulation.time_ns == before + 200_000_000
    return world


def test_a_push_that_diverges_takes_all_back_and_the_run_goes_on(pushed):
    assert abs(pushed.model("box").pose.z) < 10
    received = coded(pushed, world_codes.SIMULATION_RECOVERED)
    assert len(received) == 20
    # Who sends such things must not fill the disk either.
    assert sum(bool(each.values["states"]) for each in received) == 3


@pytest.mark.wording
def test_the_last_divergence_that_is_reported_says_so(pushed):
    received = coded(pushed, world_codes.SIMULATION_RECOVERED)
    assert received[-1].hint.endswith("Further divergences are not reported.")


@pytest.mark.parametrize(
    ("rate", "expected"), [(1e-300, 0), (5e-324, 0), (1e308, 21), (math.inf, 21), (math.nan, 21)]
)
def test_no_rate_of_the_clock_ends_the_run(make, rate, expected):
    """The slowest are once in many days, the fastest every step of 5 ms."""
    world = make.world(make.box("box", (1, 1, 1)), step=0.005)
    seen = []
    world.subscribe("/clock", seen.append)
    world.run(0.1)
    world.session.set_clock_rate(rate)
    seen.clear()
    world.run(0.1)
    assert len(seen) == expected


def test_many_single_steps_let_listeners_see_what_goes_on(make):
    world = make.world(make.box("box", (1, 1, 1)), step=0.005)
    simulation = world.session.simulation
    simulation.step(100)
    pacer = Pacer(simulation)
    seen = []

    def look(snapshot):
        seen.append(snapshot.time_ns)
        if not simulation.steps_allowed:
            simulation.stop()

    pacer.add_listener(look, rate=1e6)
    pacer.run()
    assert seen[-1] == 500_000_000
    assert len(set(seen)) >= 10
