"""A quadrotor without propellers, for tests of plugins that fly it."""

import numpy as np

STEP = 0.004
MASS, INERTIA = 1.4, 0.1
GAINS = """<rollpitchProportionalGain>10</rollpitchProportionalGain>
  <rollpitchDifferentialGain>5</rollpitchDifferentialGain><rollpitchLimit>0.5</rollpitchLimit>
  <yawProportionalGain>2</yawProportionalGain><yawDifferentialGain>1</yawDifferentialGain>
  <yawLimit>1.5</yawLimit><velocityXYProportionalGain>5</velocityXYProportionalGain>
  <velocityXYDifferentialGain>2.3</velocityXYDifferentialGain><velocityXYLimit>2</velocityXYLimit>
  <velocityZProportionalGain>5</velocityZProportionalGain>
  <velocityZDifferentialGain>1</velocityZDifferentialGain><velocityZLimit>-1</velocityZLimit>
  <maxForce>30</maxForce>"""


class Bird:
    """A quadrotor in a world.

    Args:
        make: Builds worlds.
        filename: File name of the plugin.
        tags: Tags of the plugin.
        sensor: Mass of a sensor that is fixed to the body, kg.
    """

    def __init__(self, make, filename, tags=GAINS, sensor=0.1, step=STEP):
        self.world = make.world(step=step)
        model = make.sdf(f"""<model name="bird"><link name="body"><inertial><mass>{MASS}</mass>
          <inertia><ixx>{INERTIA}</ixx><iyy>{INERTIA}</iyy><izz>{INERTIA}</izz></inertia>
          </inertial><pose>0 0 0.05 0 0 0</pose><collision name="c"><geometry><box>
          <size>0.4 0.4 0.1</size></box></geometry></collision></link>
          <link name="eye"><pose>0 0 0.05 0 0 0</pose><inertial><mass>{sensor}</mass><inertia>
          <ixx>1e-4</ixx><iyy>1e-4</iyy><izz>1e-4</izz></inertia></inertial></link>
          <joint name="mount" type="fixed"><parent>body</parent><child>eye</child></joint>
          <plugin name="flight" filename="{filename}">{tags}</plugin></model>""")
        self.world.session.spawn(model)

    def command(self, x=0.0, y=0.0, z=0.0, turn=0.0, **more):
        self.world.publish("/cmd_vel", linear_x=x, linear_y=y, linear_z=z, angular_z=turn, **more)

    @property
    def _free(self):
        return self.world.session.simulation.data.joint("bird::body")

    @property
    def position(self):
        return np.array(self._free.qpos[:3])

    @property
    def velocity(self):
        return np.array(self._free.qvel[:3])

    @property
    def yaw(self):
        w, x, y, z = self._free.qpos[3:7]
        return float(np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)))
