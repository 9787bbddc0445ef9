"""Force and torque on joints."""

import math

import numpy as np
import pytest
from tests.devices.bodies import arm, vector

from cartwheel.codes import devices
from cartwheel.errors import PluginError
from cartwheel.geometry import Pose, matrix_from_quat, quat_from_rpy
from cartwheel.messages import message_class

G = 9.8


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
    assert len(messages) == 51
    wrench = messages[-1].wrench
    assert vector(wrench.force) == pytest.approx([0, 0, -mass * G], abs=1e-6)
    assert vector(wrench.torque) == pytest.approx([0, mass * G * reach, 0], abs=1e-6)
    assert messages[0].header.frame_id == ("hand" if joint == "wrist" else "beam")


@pytest.mark.parametrize(
    ("without", "force", "moment"), [("hand", 3 * G, 1.5 * G), ("beam", 2 * G, 2 * G)]
)
def test_a_joint_does_not_bear_the_weight_of_a_link_without_gravity(
    make, read, without, force, moment
):
    """Neither of the joint's own link, nor of one that it carries."""
    text = arm(ft("<jointName>turn</jointName>"))
    text = text.replace(f'<link name="{without}">', f'<link name="{without}"><gravity>0</gravity>')
    world = make.world(make.sdf(text), ground=None)
    wrench = read(world, "/ft", 0.5)[-1].wrench
    assert vector(wrench.force) == pytest.approx([0, 0, -force], abs=1e-6)
    assert vector(wrench.torque) == pytest.approx([0, moment, 0], abs=1e-6)


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
    # The box's own contact parameters are softened, which is a note.
    assert all(each.severity == "info" for each in world.diagnostics)
    messages = read(world, "/ft", 0.1)
    assert messages
    for message in messages:
        assert vector(message.wrench.force) == pytest.approx([0, 0, -weight * G], abs=1e-3)
        assert message.header.frame_id == frame


def test_a_frame_of_a_joints_wrench_is_reported_as_idle(make):
    tags = "<jointName>wrist</jointName><frame_name>beam</frame_name>"
    (reported,) = make.world(make.sdf(arm(ft(tags)))).diagnostics
    assert reported.code is devices.PLUGIN_PARAMETER_IGNORED
    assert reported.values["parameter"] == "frame_name"


@pytest.mark.parametrize(
    ("model", "parameter"),
    [
        (arm(ft("")), "jointName"),
    ],
)
def test_parameters_without_sense_name_their_line(make, model, parameter):
    with pytest.raises(PluginError) as caught:
        make.world(make.sdf(model), ground=None)
    assert caught.value.values["parameter"] == parameter
    assert caught.value.origin is not None
