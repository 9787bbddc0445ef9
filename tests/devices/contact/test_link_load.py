"""The external force and torque on a link, against Newton."""

import numpy as np
import pytest

G = 9.8
MASS = 3.0
TURNED = 0.02


def body(make, plugin, *, pose="0 0 0.1 0 0 0", shape=""):
    return make.sdf(f"""<model name="body"><pose>{pose}</pose><link name="link">
      <inertial><mass>{MASS}</mass><inertia><ixx>{TURNED}</ixx><iyy>{TURNED}</iyy>
      <izz>{TURNED}</izz></inertia></inertial>{shape}</link>{plugin}</model>""")


BOX = """<collision name="c"><geometry><box><size>0.2 0.2 0.2</size></box></geometry>
  </collision>"""
F3D = """<plugin name="f" filename="libgazebo_ros_f3d.so"><bodyName>link</bodyName>
  <topicName>wrench</topicName></plugin>"""


def vector(message):
    return np.array([message.x, message.y, message.z])


def test_the_ground_bears_the_weight(make, read):
    world = make.world(body(make, F3D, shape=BOX))
    world.run(1.0)
    reported = read(world, "/wrench", 0.1)
    assert len(reported) == 20
    assert vector(reported[-1].wrench.force) == pytest.approx([0, 0, MASS * G], abs=0.01)
    assert vector(reported[-1].wrench.torque) == pytest.approx([0, 0, 0], abs=0.01)
    assert reported[-1].header.frame_id == "world"


def test_what_falls_feels_nothing_and_what_is_pushed_the_push(make, read):
    world = make.world(body(make, F3D, pose="0 0 9 0 0 0"), ground=None)
    assert vector(read(world, "/wrench", 0.1)[-1].wrench.force) == pytest.approx([0, 0, 0])
    world.session.simulation.forces.wrench("body", "link", force=(1, 2, 3), torque=(0.1, 0, 0.2))
    reported = read(world, "/wrench", 0.1)[-1].wrench
    assert vector(reported.force) == pytest.approx([1, 2, 3])
    assert vector(reported.torque) == pytest.approx([0.1, 0, 0.2], abs=1e-9)
