#!/usr/bin/env python3
"""Writes the worlds with the same names as those of gazebo_ros, and the range sensors' models.

    python tools/make_worlds.py                # all worlds
    python tools/make_worlds.py mud rubble     # some

The rubble falls in a simulation until it lies, and is written as it lies there.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np

from cartwheel.geometry import rpy_from_quat
from office_floor import office_floor
from world_text import Solid, include, link, model, thing, world

ROOT = Path(__file__).resolve().parent.parent
RED, GREEN, BLUE = (0.8, 0.15, 0.1), (0.15, 0.6, 0.2), (0.15, 0.3, 0.75)
CLAY, STONE, RUST = (0.62, 0.30, 0.20), (0.55, 0.54, 0.50), (0.45, 0.27, 0.16)
BROWN, METAL = (0.28, 0.19, 0.11), (0.62, 0.65, 0.68)
FLOOR = 3.0
"""Distance between the elevator's floors, m."""
SILL = 0.1
"""Height of the elevator's lowest floor above the ground, m."""


def shapes() -> str:
    """A box, a sphere and a cylinder of 1 m, in front of a robot at the origin."""
    return world(
        "A box, a sphere and a cylinder to drive around and to push.",
        thing(_ball("sphere", 0.5, BLUE), pose=(3, 1.8, 0.5, 0, 0, 0), mass=1),
        thing(_box("box", (1, 1, 1), RED), pose=(3, 0, 0.5, 0, 0, 0), mass=1),
        thing(_cylinder("cylinder", 0.5, 1, GREEN), pose=(3, -1.8, 0.5, 0, 0, 0), mass=1),
        eye=(-4, -4, 3, 0, 0.4, 0.75),
    )


def ranges() -> str:
    """Three sensors, each with an object at a known distance."""
    parts = []
    for sensor, y, distance in (
        ("sonar", 2, 1.0),
        ("infrared", 0, 0.5),
        ("laser_scanner", -2, 2.0),
    ):
        parts.append(include(sensor, pose=(2, y, 0.3, 0, 0, 0)))
        face = 2 + distance + 0.1
        parts.append(
            thing(_box(f"target_of_{sensor}", (0.2, 1, 1), RED), pose=(face, y, 0.5, 0, 0, 0))
        )
    return world(
        "Range sensors that see what stands ahead of them: sonar 1 m, infrared 0.5 m, laser 2 m.",
        *parts,
        eye=(-3, -4, 3, 0, 0.5, 0.85),
    )


def mud() -> str:
    """A soft, slippery area in front of a robot at the origin, with dry islands."""
    patch = Solid(
        name="mud",
        kind="box",
        size=(5, 4, 0.2),
        colour=BROWN,
        mu=0.06,
        contact=(8000, 400),
    )
    stones = [
        thing(_cylinder(f"stone_{i}", 0.25, 0.2, STONE), pose=(x, y, 0.0, 0, 0, 0))
        for i, (x, y) in enumerate([(3.0, 2.3), (5.0, -2.4), (7.3, 1.0)])
    ]
    return world(
        "A patch of mud 1.5 m ahead: soft and slippery. A wheel that is driven hard spins in it.",
        model("mud", link("link", [patch]), pose=(4, 0, -0.098, 0, 0, 0), static=True),
        *stones,
        eye=(-3, -4, 3, 0, 0.45, 0.6),
    )


def elevator() -> str:
    """A shaft with three floors, a car with a door, and a box to transport."""
    side, tall, thick = 2.6, 2.3, 0.08
    half, inside = side / 2, side / 2 - thick
    car = [
        _box("floor", (side, side, 0.1), METAL, pose=(0, 0, -0.05)),
        _box("back", (thick, side, tall), METAL, pose=(-half + thick / 2, 0, tall / 2)),
        _box("left", (side, thick, tall), METAL, pose=(0, half - thick / 2, tall / 2)),
        _box("right", (side, thick, tall), METAL, pose=(0, -half + thick / 2, tall / 2)),
        # Beside the opening; the open door is behind these.
        _box("jamb", (0.04, inside, tall), METAL, pose=(half - 0.02, inside / 2, tall / 2)),
    ]
    door = _box("door", (0.04, inside - 0.02, tall - 0.02), RUST)
    joints = [
        '<joint name="lift" type="prismatic">',
        "  <parent>world</parent><child>car</child>",
        "  <axis><xyz>0 0 1</xyz><limit><lower>0</lower><upper>6.5</upper>"
        "<effort>100000</effort></limit>",
        "    <dynamics><damping>50</damping></dynamics></axis>",
        "</joint>",
        '<joint name="door" type="prismatic">',
        "  <parent>car</parent><child>door</child>",
        "  <axis><xyz>0 1 0</xyz><limit><lower>0</lower><upper>1</upper>"
        "<effort>60</effort></limit>",
        "    <dynamics><damping>2</damping></dynamics></axis>",
        "</joint>",
        '<plugin name="elevator" filename="libgazebo_ros_elevator.so">',
        "  <lift_joint>lift</lift_joint>",
        "  <door_joint>door</door_joint>",
        f"  <floor_height>{FLOOR:g}</floor_height>",
        "  <door_wait_time>5</door_wait_time>",
        "  <topic>elevator</topic>",
        "  <bottom_floor>0</bottom_floor>",
        "  <top_floor>2</top_floor>",
        "</plugin>",
    ]
    building = []
    below = 0.0
    for floor in (1, 2):
        top = SILL + floor * FLOOR
        x = half + 1.56
        building.append(_box(f"floor_{floor}", (3, 5, 0.15), STONE, pose=(x, 0, top - 0.075)))
        tall_wall = top - 0.15 - below
        for name, y in (("a", 2.4), ("b", -2.4)):
            wall, z = (3, 0.2, tall_wall), below + tall_wall / 2
            building.append(_box(f"wall_{floor}{name}", wall, STONE, pose=(x, y, z)))
        below = top
    for name, size, place in (
        ("shaft_back", (0.15, side + 0.5, 9), (-half - 0.15, 0, 4.5)),
        ("shaft_left", (side, 0.15, 9), (0, half + 0.15, 4.5)),
        ("shaft_right", (side, 0.15, 9), (0, -half - 0.15, 4.5)),
    ):
        building.append(_box(name, size, STONE, pose=place))
    slope = math.atan2(SILL, 1.0)
    ramp = _box(
        "ramp",
        (math.hypot(SILL, 1.0), 2.4, 0.02),
        STONE,
        # Its upper face is a slope from the sill to the ground.
        pose=(half + 0.52 - 0.01 * math.sin(slope), 0, SILL / 2 - 0.01, 0, slope, 0),
    )
    return world(
        "An elevator: publish the number of a floor, 0 to 2, as a std_msgs/String on /elevator.",
        model(
            "elevator",
            link("car", car, mass=300),
            link("door", [door], pose=(half - 0.07, -inside / 2, tall / 2, 0, 0, 0), mass=20),
            joints,
            pose=(0, 0, SILL, 0, 0, 0),
        ),
        model("building", link("link", [*building, ramp]), static=True),
        thing(_box("parcel", (0.5, 0.5, 0.5), CLAY), pose=(-0.3, 0.2, 0.351, 0, 0, 0), mass=20),
        eye=(11.5, -3.5, 5.5, 0, 0.25, 2.83),
    )


def willowgarage() -> str:
    """An office floor."""
    return world(
        "An office floor of 54 m by 36 m: corridors, offices, halls. The origin is in the main\n"
        "     corridor.",
        *office_floor(),
        eye=(-20, -26, 26, 0, 0.75, 0.9),
    )


def rubble() -> str:
    """The ruins of a wall: static slabs and pipes, and fallen bricks."""
    generator = np.random.default_rng(5)

    def somewhere(height: float) -> tuple[float, float, float]:
        x, y = (float(value) for value in generator.uniform((1.8, -3.2), (8.2, 3.2)))
        return x, y, height

    stuck = []
    for i in range(28):
        size = (*(round(float(side), 2) for side in generator.uniform(0.4, 0.9, 2)), 0.08)
        tilt = tuple(float(angle) for angle in generator.uniform(-0.22, 0.22, 2))
        pose = (*somewhere(0.03), *tilt, float(generator.uniform(-np.pi, np.pi)))
        stuck.append(thing(_box(f"slab_{i}", size, STONE), pose=pose))
    for i in range(10):
        pipe = _cylinder(f"pipe_{i}", 0.04, round(float(generator.uniform(0.5, 1.1)), 2), RUST)
        pose = (*somewhere(0.035), np.pi / 2, 0, float(generator.uniform(-np.pi, np.pi)))
        stuck.append(thing(pipe, pose=pose))
    bricks: dict[str, tuple[float, ...]] = {}
    for i in range(110):
        turn = (0, 0, float(generator.uniform(-np.pi, np.pi)))
        bricks[f"brick_{i}"] = (*somewhere(0.3 + 0.12 * i), *turn)
    lying = _settled(stuck, bricks)
    return world(
        "Rubble from 2 m ahead of the origin on: slabs and pipes that are stuck,\n"
        f"     and {len(lying)} loose bricks.",
        *stuck,
        *(_brick(name, pose) for name, pose in lying.items()),
        eye=(-1, -4.5, 3, 0, 0.5, 0.7),
    )


def _brick(name: str, pose: tuple[float, ...]) -> list[str]:
    return thing(_box(name, (0.24, 0.115, 0.071), CLAY), pose=pose, mass=3.6)


def _settled(
    stuck: list[list[str]], bricks: dict[str, tuple[float, ...]]
) -> dict[str, tuple[float, ...]]:
    """Drops bricks and returns the poses of those that come to rest."""
    from cartwheel.codes.world import MODELS_OVERLAP
    from cartwheel.description import load_text
    from cartwheel.description.model import WorldDescription
    from cartwheel.simulation import Simulation

    while True:
        text = world("", *stuck, *(_brick(*each) for each in bricks.items()), eye=(0,) * 6)
        described = load_text(text, file=str(ROOT / "worlds/rubble.world"))
        assert isinstance(described, WorldDescription)
        simulation = Simulation(described)
        buried = {
            str(each.values["model"])
            for each in simulation.diagnostics
            if each.code is MODELS_OVERLAP
        }
        simulation.advance(10_000_000_000)
        before = {name: simulation.pose(name) for name in bricks}
        asleep = simulation.data.tree_asleep
        model = simulation.model
        # Exclude bricks that still move or are buried.
        restless = buried | {
            name for name in bricks if asleep[model.body_treeid[model.body(f"{name}::link").id]] < 0
        }
        simulation.close()
        bricks = {
            name: (*pose.position, *rpy_from_quat(pose.orientation))
            for name, pose in before.items()
            if name not in restless
        }
        if not restless:
            return bricks


def _box(
    name: str,
    size: tuple[float, ...],
    colour: tuple[float, ...],
    *,
    pose: tuple[float, ...] = (),
) -> Solid:
    full = (*pose, *([0.0] * (6 - len(pose))))
    return Solid(name=name, kind="box", size=size, pose=full, colour=colour)


def _cylinder(name: str, radius: float, length: float, colour: tuple[float, ...]) -> Solid:
    return Solid(name=name, kind="cylinder", size=(radius, length), colour=colour)


def _ball(name: str, radius: float, colour: tuple[float, ...]) -> Solid:
    return Solid(name=name, kind="sphere", size=(radius,), colour=colour)


WORLDS: dict[str, Callable[[], str]] = {
    "shapes": shapes,
    "range": ranges,
    "mud": mud,
    "elevator": elevator,
    "willowgarage": willowgarage,
    "rubble": rubble,
}

if __name__ == "__main__":
    for wanted in sys.argv[1:] or WORLDS:
        (ROOT / "worlds" / f"{wanted}.world").write_text(WORLDS[wanted]())
        print(f"worlds/{wanted}.world")
