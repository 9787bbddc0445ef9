"""Bodies on bodies that turn keep their place as long as friction holds them."""

from __future__ import annotations

import math

import numpy as np
import pytest

import cartwheel as cw
from cartwheel.description import load_text

BOX = """<model name="box"><pose>{x} 0 {z} 0 0 0</pose><link name="link"><inertial><mass>1</mass>
<inertia><ixx>0.0017</ixx><iyy>0.0017</iyy><izz>0.0017</izz></inertia></inertial>
<collision name="c"><geometry><box><size>0.1 0.1 0.1</size></box></geometry><surface><friction><ode>
<mu>{mu}</mu><mu2>{mu}</mu2></ode></friction></surface></collision></link></model>"""

TURNTABLE = """<model name="table"><joint name="fix" type="fixed"><parent>world</parent>
<child>post</child></joint><link name="post"><pose>0 0 0.2 0 0 0</pose><inertial><mass>5</mass>
<inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial></link>
<link name="disc"><pose>0 0 0.45 0 0 0</pose><inertial><mass>10</mass><inertia><ixx>1</ixx>
<iyy>1</iyy><izz>2</izz></inertia></inertial><collision name="c"><geometry><cylinder>
<radius>0.6</radius><length>0.1</length></cylinder></geometry></collision></link>
<joint name="spin" type="revolute"><parent>post</parent><child>disc</child><axis><xyz>0 0 1</xyz>
</axis></joint><plugin name="gz::sim::systems::JointController"
filename="gz-sim-joint-controller-system"><joint_name>spin</joint_name><topic>speed</topic></plugin>
</model>"""

WAGON = """<model name="wagon"><pose>0 0 0.1 0 0 0</pose><link name="bed"><gravity>0</gravity>
<inertial><mass>20</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>
<collision name="c"><geometry><box><size>0.8 0.8 0.1</size></box></geometry></collision></link>
<plugin name="gz::sim::systems::VelocityControl" filename="gz-sim-velocity-control-system">
<topic>cmd_vel</topic></plugin></model>"""


def scene(*models: str, step: float) -> cw.World:
    text = f"""<sdf version="1.9"><world name="w"><physics type="ode">
      <max_step_size>{step}</max_step_size></physics>{"".join(models)}</world></sdf>"""
    return cw.World(load_text(text, file="w.sdf"))


def turntable(step: float = 0.005, mu: float = 1.0) -> cw.World:
    return scene(TURNTABLE, BOX.format(x=0.2, z=0.55, mu=mu), step=step)


def start(world: cw.World, speed: float) -> None:
    """Turns the table slowly at first, so that nothing slides."""
    world.run(0.2)
    for part in range(1, 101):
        world.publish("/speed", data=speed * part / 100)
        world.run(0.02)


def place(world: cw.World, carrier: str) -> np.ndarray:
    """The position of the box in the frame of a link."""
    model, _, link = carrier.partition("::")
    frame = world.model(model).link(link).pose
    return np.array((frame.inverse() @ world.model("box").pose).position)


@pytest.mark.parametrize("step", [0.005, 0.001])
@pytest.mark.parametrize("speed", [1.0, 3.0])
def test_a_box_keeps_its_place_on_a_turntable(speed, step):
    """The centripetal acceleration needs up to a fifth of the friction."""
    with turntable(step) as world:
        start(world, speed)
        assert world.model("table").joints.velocities["spin"] == pytest.approx(speed, rel=1e-2)
        before = place(world, "table::disc")
        world.run(3.0)
        # 0.1 mm of 0.6 to 1.8 m of way; without the term it is 1 to 60 mm.
        assert place(world, "table::disc") == pytest.approx(before, abs=1e-4)
        assert abs(world.model("box").pose.pitch) < 1e-3


def test_what_friction_cannot_hold_slides_off():
    """3 rad/s at 0.2 m need a coefficient of 0.18."""
    with turntable(mu=0.1) as world:
        start(world, 3.0)
        world.run(1.0)
        assert np.linalg.norm(place(world, "table::disc")[:2]) > 0.3


def test_a_box_keeps_its_place_on_a_wagon_in_a_curve():
    with scene(WAGON, BOX.format(x=0.3, z=0.2, mu=1.0), step=0.005) as world:
        for part in range(1, 51):
            world.publish("/cmd_vel", angular={"z": part / 50}, linear={"x": 0.4 * part / 50})
            world.run(0.02)
        before = place(world, "wagon::bed")
        world.run(3.0)
        assert place(world, "wagon::bed") == pytest.approx(before, abs=2e-4)


def test_a_run_in_pieces_and_a_restored_one_have_the_same_bits():
    def state(world: cw.World) -> bytes:
        return b"".join(
            np.array([*pose.position, *pose.orientation]).tobytes()
            for pose in (world.model(name).pose for name in world.models)
        )

    with turntable() as world:
        start(world, 2.0)
        saved = world.save()
        world.run(0.5)
        expected = state(world)
        world.restore(saved)
        for count in (1, 2, 3, 5, 8, 13):
            world.step(count)
            assert world.contacts()
            assert math.isfinite(world.model("box").velocity.linear[0])
        world.run(0.5 - 32 * 0.005)
        assert state(world) == expected
        world.restore(saved)
        world.run(0.5)
        assert state(world) == expected


def test_steps_are_as_fast_as_before_once_the_box_is_gone():
    with turntable() as world:
        start(world, 2.0)
        engine = world.session.simulation.engine
        assert engine.carries
        world.model("box").delete()
        world.run(0.1)
        assert not engine.carries
