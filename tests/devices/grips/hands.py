"""A hand with two fingers on a lift."""

from cartwheel.geometry import Pose

SIDE = 0.06
MASS = 0.5
HAND = """<model name="hand"><pose>0 0 0.2 0 0 0</pose>
  <link name="palm"><inertial><mass>2</mass></inertial></link>
  <joint name="up" type="prismatic"><parent>world</parent><child>palm</child>
    <axis><xyz>0 0 1</xyz></axis></joint>
  {fingers}{plugin}</model>"""
FINGER = """<link name="{name}"><pose>0 {y} -0.16 0 0 0</pose>
    <inertial><mass>0.2</mass></inertial><collision name="pad"><geometry>
    <box><size>0.04 0.01 0.04</size></box></geometry><surface><friction><ode><mu>{mu}</mu><mu2>{mu}
    </mu2></ode></friction></surface></collision></link>
  <joint name="{name}_joint" type="prismatic"><parent>palm</parent><child>{name}</child>
    <axis><xyz>0 1 0</xyz><limit><lower>-0.2</lower><upper>0.2</upper></limit></axis></joint>"""


class Hand:
    """A hand on a lift, with a box between its fingers that are too smooth to lift it."""

    def __init__(self, make, plugin, *, sides=("left", "right"), mu=0.0, extra=()):
        places = {"left": 0.05, "right": -0.05}
        fingers = "".join(FINGER.format(name=side, y=places[side], mu=mu) for side in sides)
        hand = make.sdf(HAND.format(fingers=fingers, plugin=plugin))
        cube = make.box("cube", (SIDE,) * 3, mass=MASS, mu=0.5, pose=Pose((0, 0, SIDE / 2)))
        self.world = make.world(hand, cube, *extra, ground=1.0, step=0.002)
        self.simulation = self.world.session.simulation
        self.sides = sides
        self.simulation.drive("hand", "up", velocity=0.0, max_effort=200.0)
        self.press(0.0)

    def press(self, speed):
        for side in self.sides:
            toward = -speed if side == "left" else speed
            self.simulation.drive("hand", f"{side}_joint", velocity=toward, max_effort=5.0)

    def lift(self, height, speed=0.1):
        self.simulation.drive("hand", "up", velocity=speed)
        self.world.run(height / speed)
        self.simulation.drive("hand", "up", velocity=0.0)

    @property
    def cube(self):
        return self.world.model("cube").pose
