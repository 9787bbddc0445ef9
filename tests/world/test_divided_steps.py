"""A step that something reads is the step that would have been made unread."""

import mujoco
import numpy as np

BODY = """<inertial><mass>{m}</mass><inertia><ixx>{i}</ixx><iyy>{i}</iyy><izz>{i}</izz></inertia>
  </inertial>"""
BALL = "<collision name='c'><geometry><sphere><radius>0.1</radius></sphere></geometry></collision>"


def wheel(name, y):
    return f"""<link name="{name}"><pose>0 {y} 0 0 0 0</pose>{BODY.format(m=1, i=0.005)}{BALL}
      </link><joint name="{name}_joint" type="revolute"><parent>base</parent><child>{name}</child>
      <axis><xyz>0 1 0</xyz><dynamics><damping>0.5</damping></dynamics></axis></joint>"""


ROBOT = f"""<model name="m"><pose>0 0 0.1 0 0 0</pose>
  <link name="base">{BODY.format(m=5, i=0.1)}
  <collision name="c"><pose>-0.2 0 -0.05 0 0 0</pose>
  <geometry><sphere><radius>0.05</radius></sphere>
  </geometry></collision></link>{wheel("left", 0.2)}{wheel("right", -0.2)}
  <plugin name="drive" filename="libgazebo_ros_diff_drive.so"><leftJoint>left_joint</leftJoint>
  <rightJoint>right_joint</rightJoint><wheelTorque>5</wheelTorque></plugin></model>"""


def test_damping_counts_once_whether_a_step_is_read_or_not(make):
    states = []
    for read in (False, True):
        simulation = make.world(make.sdf(ROBOT)).session.simulation
        model, data = simulation.model, simulation.data
        for number in range(200):
            for side, turn in (("left", 1.0), ("right", 2.0)):
                data.joint(f"m::{side}_joint::rotor").qvel[0] = turn * np.sin(number / 5)
            if read:
                mujoco.mj_forward(model, data)
                mujoco.mj_Euler(model, data)
            else:
                mujoco.mj_step(model, data)
        states.append(np.concatenate([data.qpos, data.qvel]))
    assert np.abs(states[0]).max() > 0.1
    assert np.allclose(*states, rtol=0, atol=1e-9)
