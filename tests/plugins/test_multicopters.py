"""Propellers and what goes with them: forces by the speed that each turns at."""

import math

import numpy as np
import pytest
from tests.coded import coded

from cartwheel.codes import devices, running
from cartwheel.errors import PluginError
from cartwheel.geometry import Pose

K, MOMENT = 1e-5, 0.02
UP, DOWN = 0.02, 0.04
BODY, ROTOR = 1.5, 0.01
G = 9.8
ARM = 0.2
INERTIA = 0.02
MASS = BODY + 4 * ROTOR
HOVER = math.sqrt(MASS * G / (4 * K))
"""rad/s at which four propellers bear the weight."""


def motor(number, kind="rotors", tags="", direction=None):
    names = {
        "rotors": "librotors_gazebo_motor_model.so",
        "px4": "libgazebo_motor_model.so",
        "gz": "gz-sim-multicopter-motor-model-system",
    }
    sense = direction or ("ccw" if number % 2 == 0 else "cw")
    return f"""<plugin name="motor{number}" filename="{names[kind]}">
      <robotNamespace>bee</robotNamespace><jointName>rotor_{number}_joint</jointName>
      <linkName>rotor_{number}</linkName><turningDirection>{sense}</turningDirection>
      <motorNumber>{number}</motorNumber><maxRotVelocity>2000</maxRotVelocity>
      <motorConstant>{K}</motorConstant><momentConstant>{MOMENT}</momentConstant>
      <timeConstantUp>{UP}</timeConstantUp><timeConstantDown>{DOWN}</timeConstantDown>
      <commandSubTopic>gazebo/command/motor_speed</commandSubTopic>
      <motorSpeedPubTopic>motor_speed/{number}</motorSpeedPubTopic>
      <rotorDragCoefficient>0</rotorDragCoefficient>
      <rollingMomentCoefficient>0</rollingMomentCoefficient>{tags}</plugin>"""


def bee(make, plugins, extra=""):
    """A cross of four propellers around a body, all in one plane."""
    spin = ROTOR * 0.1**2 / 2
    rotors = "".join(
        f"""<link name="rotor_{n}"><pose>{ARM * math.cos(a)} {ARM * math.sin(a)} 0 0 0 0</pose>
        <inertial><mass>{ROTOR}</mass><inertia><ixx>{spin / 2}</ixx><iyy>{spin / 2}</iyy>
        <izz>{spin}</izz></inertia></inertial></link>
        <joint name="rotor_{n}_joint" type="continuous"><parent>body</parent>
        <child>rotor_{n}</child><axis><xyz>0 0 1</xyz></axis></joint>"""
        for n, a in enumerate(math.pi / 2 * k for k in range(4))
    )
    return make.sdf(f"""<model name="bee"><link name="body"><inertial><mass>{BODY}</mass>
      <inertia><ixx>{INERTIA}</ixx><iyy>{INERTIA}</iyy><izz>{INERTIA}</izz></inertia></inertial>
      <collision name="c"><geometry><box><size>0.1 0.1 0.05</size></box></geometry></collision>
      {extra}</link>{rotors}{plugins}</model>""")


TOPICS = {
    "rotors": ("/bee/gazebo/command/motor_speed", "angular_velocities"),
    "px4": ("/bee/gazebo/command/motor_speed", "angular_velocities"),
    "gz": ("/bee/gazebo/command/motor_speed", "velocity"),
}


def fly(make, kind="rotors", tags=""):
    world = make.world()
    model = bee(make, "".join(motor(n, kind, tags) for n in range(4)))
    world.session.spawn(model, pose=Pose((0, 0, 10)))
    return world


def command(world, speeds, kind="rotors"):
    topic, field = TOPICS[kind]
    world.publish(topic, **{field: [float(speed) for speed in speeds]})


def velocity(world, axis):
    """Of the body, 0 to 2 along the world's axes, 3 to 5 about its own."""
    return world.session.simulation.data.joint("bee::body").qvel[axis]


def climb(world, seconds):
    """Mean acceleration upwards, m/s²."""
    before = velocity(world, 2)
    world.run(seconds)
    return (velocity(world, 2) - before) / seconds


@pytest.mark.parametrize("kind", ["rotors", "px4", "gz"])
def test_propellers_push_by_the_square_of_their_speed(make, kind):
    """Free fall at rest; the weight borne at one speed, and twice of it at √2 times that."""
    world = fly(make, kind)
    assert climb(world, 0.2) == pytest.approx(-G, rel=1e-6)
    command(world, [HOVER] * 4, kind)
    world.run(15 * UP)
    fades = 1.0
    for factor in (1.0, math.sqrt(2)):
        command(world, [factor * HOVER] * 4, kind)
        world.run(15 * UP)
        speed = abs(velocity(world, 2))
        if kind == "px4":
            fades = 1 - speed / 25
        # The thrust of PX4's fades with the speed, which changes meanwhile by some 1 m/s.
        error = 0.5 if kind == "px4" else 0.02
        assert climb(world, 0.1) == pytest.approx(G * (factor**2 * fades - 1), abs=error)


def test_a_quadrotor_hovers_level_at_its_speed(make):
    world = fly(make)
    command(world, [HOVER] * 4)
    world.run(1.0)
    sunk = velocity(world, 2)
    # The impulse that is missing while the motors speed up: 1 - w² over the time, w = 1 - e^(-t/τ),
    # and while a command becomes a speed and that a thrust, which are steps of their own.
    step = world.session.simulation.step_ns * 1e-9
    assert -G * (1.5 * UP + 3 * step) < sunk < -G * 1.5 * UP
    world.run(2.0)
    model = world.model("bee")
    assert velocity(world, 2) == pytest.approx(sunk, abs=0.02)
    assert model.pose.rpy == pytest.approx((0, 0, 0), abs=1e-3)


def test_propellers_that_turn_one_way_turn_the_body_the_other(make):
    """Two faster, two slower, of the same thrust in all: torque 4 m k a w² about the vertical."""
    share = 0.1
    world = fly(make)
    command(world, [HOVER] * 4)
    world.run(15 * UP)
    fast, slow = HOVER * math.sqrt(1 + share), HOVER * math.sqrt(1 - share)
    command(world, [fast, slow, fast, slow])
    world.run(15 * DOWN)
    before = velocity(world, 5)
    world.run(0.4)
    gained = velocity(world, 5) - before
    torque = 4 * share * MOMENT * K * HOVER**2
    inertia = INERTIA + 4 * ROTOR * ARM**2
    # Those that turn counter-clockwise, 0 and 2, are the faster: the body goes clockwise.
    assert gained / 0.4 == pytest.approx(-torque / inertia, rel=0.02)


def test_speeds_approach_a_command_with_two_time_constants(make):
    world = fly(make)
    told = world.mailbox("/bee/motor_speed/_0", size=10_000)
    step = world.session.simulation.step_ns * 1e-9
    command(world, [100, 0, 0, 0])
    world.run(0.2)
    up = [message.data * 10 for message in told.drain()]
    command(world, [0, 0, 0, 0])
    world.run(0.2)
    down = [message.data * 10 for message in told.drain()]
    # What is told is the joint's speed after a step; it is set before the step.
    count = round(UP / step)
    assert up[count] == pytest.approx(100 * (1 - math.exp(-count * step / UP)), abs=100 * step / UP)
    assert up[-1] == pytest.approx(100, abs=0.1)
    count = round(DOWN / step)
    assert down[count] == pytest.approx(100 * math.exp(-count * step / DOWN), abs=100 * step / DOWN)


def test_a_propeller_that_moves_across_the_air_is_held_back(make):
    """Deceleration 4 w c v / m along x, whatever the height: speeds fall as e^(-t / τ)."""
    drag = 4e-4
    world = make.world()
    tags = f"<rotorDragCoefficient>{drag}</rotorDragCoefficient>"
    plugins = "".join(
        motor(n).replace("<rotorDragCoefficient>0</rotorDragCoefficient>", tags) for n in range(4)
    )
    push = """<plugin name="push" filename="libgazebo_ros_force.so"><bodyName>body</bodyName>
      <topicName>push</topicName></plugin>"""
    world.session.spawn(bee(make, plugins + push), pose=Pose((0, 0, 50)))
    command(world, [HOVER] * 4)
    world.run(15 * UP)
    world.publish("/push", force_x=3.0)
    world.run(0.5)
    world.publish("/push", force_x=0.0)
    world.run(0.02)
    before = velocity(world, 0)
    world.run(0.5)
    left = velocity(world, 0) / before
    rate = 4 * HOVER * drag / MASS
    assert before > 0.5
    assert left == pytest.approx(math.exp(-0.5 * rate), rel=0.01)


def test_px4s_reversible_propeller_pushes_down_and_the_others_never(make):
    for reversible, sign in ((True, -1), (False, 1)):
        tags = f"<reversible>{str(reversible).lower()}</reversible>"
        world = make.world()
        plugins = "".join(motor(n, "px4", tags, direction="ccw") for n in range(4))
        world.session.spawn(bee(make, plugins), pose=Pose((0, 0, 30)))
        command(world, [-HOVER] * 4, "px4")
        world.run(15 * DOWN)
        fades = 1 - abs(velocity(world, 2)) / 25
        assert climb(world, 0.05) == pytest.approx(G * (sign * fades - 1), abs=0.5)


def test_a_command_for_fewer_motors_is_ignored_and_told(make):
    world = fly(make)
    command(world, [HOVER, HOVER])
    world.run(0.1)
    told = coded(world, running.COMMAND_IGNORED, speeds=2)
    assert len(told) == 2


def test_new_gazebos_motor_listens_under_the_models_name_by_default(make):
    plugin = motor(0, "gz").replace("<robotNamespace>bee</robotNamespace>", "")
    world = make.world(bee(make, plugin.replace("gazebo/command/motor_speed", "command/speed")))
    assert world.graph.topic("/bee/command/speed").type == "actuator_msgs/msg/Actuators"


@pytest.mark.parametrize(
    ("old", "new", "parameter"),
    [
        ("<timeConstantUp>0.02", "<timeConstantUp>0", "timeConstantUp"),
        ("<motorNumber>0", "<motorNumber>-1", "motorNumber"),
        (">ccw<", ">left<", "turningDirection"),
    ],
)
def test_what_no_motor_can_be_is_an_error(make, old, new, parameter):
    with pytest.raises(PluginError) as caught:
        make.world(bee(make, motor(0).replace(old, new)))
    assert caught.value.code is devices.PLUGIN_PARAMETER_INVALID
    assert caught.value.values["parameter"] == parameter


def test_a_motor_that_is_told_otherwise_than_by_speed_is_left_alone_and_told(make):
    world = make.world(bee(make, motor(0, tags="<motorType>position</motorType>")))
    assert coded(world, devices.PLUGIN_PARAMETER_UNSUPPORTED, value="position")
    assert not any(topic.name == TOPICS["rotors"][0] for topic in world.graph.topics())


# -- what goes with them


def plugin(name, tags):
    return f"""<plugin name="one" filename="librotors_gazebo_{name}.so">
      <robotNamespace>bee</robotNamespace>{tags}</plugin>"""


def test_commands_go_through_the_interface_to_the_motors(make):
    world = make.world()
    plugins = "".join(motor(n) for n in range(4)) + plugin("controller_interface", "")
    world.session.spawn(bee(make, plugins), pose=Pose((0, 0, 10)))
    world.publish("/bee/command/motor_speed", angular_velocities=[HOVER] * 4)
    world.run(15 * UP)
    assert climb(world, 0.2) == pytest.approx(0, abs=0.02)


def test_the_base_tells_speeds_and_angles_in_the_order_of_their_numbers(make):
    world = make.world()
    plugins = "".join(motor(n) for n in range(4))
    base = plugin("multirotor_base_plugin", "<linkName>body</linkName>")
    world.session.spawn(bee(make, plugins + base), pose=Pose((0, 0, 10)))
    boxes = [world.mailbox(topic, size=1) for topic in ("/bee/motor_speed", "/bee/joint_states")]
    command(world, [100, 200, 300, 400])
    world.run(30 * UP)
    (speeds,), (states,) = (box.drain() for box in boxes)
    # Those that turn clockwise turn the other way about their axes.
    assert speeds.angular_velocities == pytest.approx([100, -200, 300, -400], rel=1e-3)
    assert states.name == [f"rotor_{n}_joint" for n in range(4)]
    assert speeds.header.frame_id == "body"


SILENT = "".join(
    f"<{name}>0</{name}>"
    for name in (
        "gyroscopeNoiseDensity",
        "gyroscopeBiasRandomWalk",
        "gyroscopeTurnOnBiasSigma",
        "accelerometerNoiseDensity",
        "accelerometerRandomWalk",
        "accelerometerTurnOnBiasSigma",
    )
)


def test_the_imu_feels_gravity_and_says_that_it_knows_no_orientation(make):
    tags = "<linkName>body</linkName>" + SILENT
    world = make.world()
    world.session.spawn(bee(make, plugin("imu_plugin", tags)), pose=Pose((0, 0, 0.025)))
    box = world.mailbox("/bee/imu", size=1)
    world.run(1.0)
    (message,) = box.drain()
    assert message.linear_acceleration.z == pytest.approx(G, abs=0.01)
    assert message.orientation_covariance.tolist() == [-1.0] * 9
    assert message.header.frame_id == "body"


def test_the_imus_noise_has_the_density_that_is_stated(make):
    density = 0.01
    tags = "<linkName>body</linkName>" + SILENT.replace(
        "<gyroscopeNoiseDensity>0", f"<gyroscopeNoiseDensity>{density}"
    )
    world = make.world()
    world.session.spawn(bee(make, plugin("imu_plugin", tags)), pose=Pose((0, 0, 0.025)))
    world.run(1.0)
    box = world.mailbox("/bee/imu", size=10_000)
    world.run(5.0)
    rates = np.array([message.angular_velocity.x for message in box.drain()])
    step = world.session.simulation.step_ns * 1e-9
    # The spread of a spread is 1/√(2n) of it, 2 % for a thousand: five of them.
    assert rates.std() == pytest.approx(density / math.sqrt(step), rel=0.12)


def test_odometry_tells_the_truth_in_five_forms(make, read):
    world = make.world()
    tags = "<linkName>body</linkName><childFrameId>bee/eye</childFrameId>"
    model = bee(make, plugin("odometry_plugin", tags))
    world.session.spawn(model, pose=Pose.from_xyz_rpy((1, 2, 30), (0, 0, 1.0)))
    topics = ("pose", "pose_with_covariance", "position", "transform", "odometry")
    boxes = {topic: world.mailbox(f"/bee/{topic}", size=1) for topic in topics}
    world.run(0.5)
    told = {topic: box.drain()[-1] for topic, box in boxes.items()}
    odometry = told["odometry"]
    place = odometry.pose.pose.position
    # It falls for half a second, and is told up to one step before the end.
    step = world.session.simulation.step_ns * 1e-9
    assert (place.x, place.y) == pytest.approx((1, 2))
    assert place.z == pytest.approx(30 - G * 0.5**2 / 2, abs=G * 0.5 * 2 * step)
    assert odometry.twist.twist.linear.z == pytest.approx(-G * 0.5, abs=2 * G * step)
    assert (odometry.header.frame_id, odometry.child_frame_id) == ("world", "bee/eye")
    assert told["pose"].position == place
    assert told["pose_with_covariance"].pose.pose.position == place
    assert told["position"].point == place
    where = told["transform"].transform.translation
    assert (where.x, where.y, where.z) == (place.x, place.y, place.z)
    (tf,) = read(world, "/tf", step)[-1].transforms
    assert (tf.header.frame_id, tf.child_frame_id) == ("world", "bee/eye")


def test_odometry_comes_every_so_many_steps_with_its_noise(make, read):
    tags = """<linkName>body</linkName><measurementDivisor>4</measurementDivisor>
      <noiseNormalPosition>0.1 0 0</noiseNormalPosition>
      <noiseUniformPosition>0 0.2 0</noiseUniformPosition>"""
    world = make.world()
    world.session.spawn(bee(make, plugin("odometry_plugin", tags)), pose=Pose((0, 0, 0.025)))
    world.run(1.0)
    told = read(world, "/bee/odometry", 10.0)
    step = world.session.simulation.step_ns * 1e-9
    assert len(told) == pytest.approx(10.0 / step / 4, abs=1)
    x = np.array([message.pose.pose.position.x for message in told])
    y = np.array([message.pose.pose.position.y for message in told])
    assert x.std() == pytest.approx(0.1, rel=0.2)
    assert y.std() == pytest.approx(0.2 / math.sqrt(3), rel=0.2)
    assert np.abs(y - y.mean()).max() <= 0.2 + 0.05
    assert told[0].pose.covariance[0] == pytest.approx(0.01)
