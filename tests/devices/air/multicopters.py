"""A quadrotor for tests of propellers."""

import math

from cartwheel.geometry import Pose

K, MOMENT = 1e-5, 0.02
UP, DOWN = 0.02, 0.04
BODY, ROTOR = 1.5, 0.01
G = 9.8
ARM = 0.2
INERTIA = 0.02
MASS = BODY + 4 * ROTOR
HOVER = math.sqrt(MASS * G / (4 * K))
"""Speed at which four propellers carry the weight, rad/s."""


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
    """Returns a body with four propellers in one plane."""
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
    """Returns a velocity of the body: 0 to 2 along the world's axes, 3 to 5 about its own."""
    return world.session.simulation.data.joint("bee::body").qvel[axis]


def climb(world, seconds):
    """Returns the mean upward acceleration, m/s²."""
    before = velocity(world, 2)
    world.run(seconds)
    return (velocity(world, 2) - before) / seconds
