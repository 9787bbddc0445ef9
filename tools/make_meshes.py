#!/usr/bin/env python3
"""Writes all meshes of the repository: those of the rosbots cart and of the models.

The shapes are built here from numbers, so a mesh is changed by changing this file and running it:

    python tools/make_meshes.py            # writes the files in place
    python tools/make_meshes.py --to DIR   # writes the same tree under DIR

Two runs give identical bytes. Units are metres, z is up; a mesh stands in its link's frame.
The triangle counts stay low because a processor without a GPU draws the cart 30 times a second.
"""

from __future__ import annotations

import argparse
import math
from pathlib import Path

import numpy as np

from mesh_collada import Material, Mesh
from mesh_solids import (
    Solid,
    bar,
    bend,
    box,
    lathe,
    loft,
    outward,
    rod,
    rounded_rectangle,
    slab,
    tube,
)

REPOSITORY = Path(__file__).resolve().parent.parent
CART_MESHES = "robots/rosbots_description/meshes"

BLUE = Material("blue_paint", (0.08, 0.26, 0.62), 0.25, 40)
WOOD = Material("wood", (0.66, 0.46, 0.26), 0.03)
WOOD_DARK = Material("wood_dark", (0.56, 0.37, 0.20), 0.03)
GRAPHITE = Material("graphite", (0.17, 0.18, 0.20), 0.2)
RUBBER = Material("rubber", (0.06, 0.06, 0.065), 0.03)
STEEL = Material("steel", (0.66, 0.68, 0.71), 0.5, 60)
RIM = Material("rim", (0.82, 0.83, 0.85), 0.4, 50)
YELLOW = Material("yellow", (0.96, 0.72, 0.08), 0.1)
LAMP = Material("lamp", (0.97, 0.96, 0.88), 0.6, 80)
RED = Material("red", (0.75, 0.06, 0.05), 0.3)
WHITE = Material("white", (0.86, 0.87, 0.89), 0.2)
GLASS = Material("glass", (0.05, 0.09, 0.22), 0.9, 100)
ORANGE = Material("orange", (0.95, 0.35, 0.04), 0.1)
CONCRETE = Material("concrete", (0.58, 0.58, 0.56), 0.03)

# The cart. These numbers are also in rosbots.xacro; tests compare the meshes with it.

WHEEL_RADIUS = 0.26
WHEEL_WIDTH = 0.10
CHASSIS_X, CHASSIS_LENGTH, CHASSIS_WIDTH = 0.10, 1.00, 0.90
CHASSIS_BOTTOM, CHASSIS_TOP = 0.14, 0.36
CASTER_RADIUS = 0.10
HANDLE_X, HANDLE_WIDTH, HANDLE_HEIGHT = -0.37, 0.70, 0.62
MAST_X, MAST_Y, MAST_HEIGHT = 0.42, -0.03, 0.32
TUBE_RADIUS = 0.018


def wheel() -> Mesh:
    """Axis along y, outer side +y: tyre with lugs, rim with five double spokes, yellow cap."""
    mesh = Mesh(f"{CART_MESHES}/wheel.dae")
    half, depth = WHEEL_WIDTH / 2, 0.009
    tread = WHEEL_RADIUS - depth
    segments = 36

    def upright(solid: Solid) -> Solid:
        return solid.turned("x", -math.pi / 2)  # the axis of rotation, z, becomes y

    tyre = [
        (0.196, -half + 0.012), (0.222, -half), (tread - 0.012, -half + 0.003),
        (tread, -half + 0.010), (tread, half - 0.010), (tread - 0.012, half - 0.003),
        (0.222, half), (0.196, half - 0.012),
    ]  # fmt: skip
    mesh.add(RUBBER, upright(lathe(tyre, segments, closed=True)))

    # Lugs in two staggered rows, slanted as on a tractor tyre. The outer corners lie on the
    # wheel's radius, which is where the collision cylinder ends.
    count = 18
    for row in (-1, 1):
        for k in range(count):
            angle = 2 * math.pi * (k + (0.5 if row > 0 else 0.0)) / count
            inner, outer, low = 0.003 * row, row * (half - 0.005), tread - 0.016
            lug = []
            for side, slant in ((inner, 0.0), (outer, 0.5)):
                shift = 2 * math.pi * slant / count
                top = WHEEL_RADIUS if slant == 0.0 else WHEEL_RADIUS - 0.004
                ring = [(low, 0.068), (top, 0.052), (top, -0.052), (low, -0.068)]
                lug.append(
                    np.array(
                        [
                            (r * math.cos(angle + shift + w), r * math.sin(angle + shift + w), side)
                            for r, w in ring
                        ]
                    )
                )
            solid = outward(loft(lug))
            # The face between the low corners, 0 and 3 of each ring, lies in the tyre.
            keep = [face for face in solid.faces if not set(face) <= {0, 3, 4, 7}]
            mesh.add(RUBBER, upright(Solid(solid.vertices, np.array(keep))))

    rim = [
        (0.176, -half + 0.016), (0.204, -half + 0.006), (0.204, half - 0.006),
        (0.176, half - 0.016), (0.184, 0.0),
    ]  # fmt: skip
    mesh.add(RIM, upright(lathe(rim, segments, closed=True)))

    hub = [
        (0.0, -half), (0.045, -half), (0.052, -half + 0.010), (0.052, half - 0.028),
        (0.040, half - 0.016), (0.0, half - 0.016),
    ]  # fmt: skip
    mesh.add(GRAPHITE, upright(lathe(hub, 20)))
    mesh.add(YELLOW, upright(rod(0.030, 0.020, 16, 0.004).moved(z=half - 0.012)))

    for k in range(5):
        for split in (-0.020, 0.020):
            spoke = bar(0.142, 0.020, 0.030, 0.006).turned("z", split * 3.0)
            spoke = spoke.moved(0.115, split * 1.25, 0.012)
            mesh.add(RIM, upright(spoke.turned("z", 2 * math.pi * k / 5)))
        bolt = rod(0.006, 0.008, 6).moved(0.042, 0.0, half - 0.018)
        mesh.add(STEEL, upright(bolt.turned("z", 2 * math.pi * (k + 0.5) / 5)))
    # One red valve makes the rotation visible.
    mesh.add(RED, upright(rod(0.007, 0.03, 8).moved(0.168, 0.0, 0.030).turned("z", math.pi / 5)))
    return mesh


def chassis() -> Mesh:
    """The parts that are blue in Gazebo: tub, platform rim and stakes."""
    mesh = Mesh(f"{CART_MESHES}/chassis.dae")
    height = CHASSIS_TOP - CHASSIS_BOTTOM
    tub = slab(
        CHASSIS_LENGTH - 0.05,
        CHASSIS_WIDTH - 0.05,
        height - 0.03,
        0.09,
        0.012,
        segments=5,
        foot=0.05,
    )
    mesh.add(BLUE, tub.moved(CHASSIS_X, 0, CHASSIS_BOTTOM + (height - 0.03) / 2))
    rim = slab(CHASSIS_LENGTH, CHASSIS_WIDTH, 0.045, 0.11, 0.012, segments=6)
    mesh.add(BLUE, rim.moved(CHASSIS_X, 0, CHASSIS_TOP - 0.0225))
    for x, y in stakes():
        stake = slab(0.05, 0.03, 0.20, 0.008, 0.006, segments=2)
        mesh.add(BLUE, stake.moved(x, y, CHASSIS_TOP + 0.09))
    return mesh


def stakes() -> list[tuple[float, float]]:
    """The positions of the posts that hold the side boards, in base_link."""
    return [(x, side * 0.415) for side in (-1, 1) for x in (-0.30, 0.10, 0.50)]


def frame() -> Mesh:
    """The parts in frame_link: planks, boards, handle and mast; below these, bumper and lamps."""
    mesh = Mesh(f"{CART_MESHES}/frame.dae")

    planks, gap, run = 6, 0.006, 0.76
    width = run / planks
    for k in range(planks):
        length = 0.92 if k in (0, planks - 1) else 0.95
        plank = bar(length, width - gap, 0.016, 0.003)
        mesh.add(
            WOOD if k % 2 else WOOD_DARK, plank.moved(CHASSIS_X, (k + 0.5) * width - run / 2, 0.006)
        )

    for side in (-1, 1):
        for height, wood in ((0.060, WOOD_DARK), (0.138, WOOD)):
            board = bar(0.90, 0.018, 0.062, 0.004)
            mesh.add(wood, board.moved(CHASSIS_X, side * 0.392, height))

    # Handle: one bent tube with a cross bar and a grip.
    half, radius = HANDLE_WIDTH / 2 - TUBE_RADIUS, 0.10
    top = HANDLE_HEIGHT - TUBE_RADIUS
    outline = [(-half, 0.0)]
    outline += bend((-half, 0.0), (-half, top), (half, top), radius, 5)
    outline += bend((-half, top), (half, top), (half, 0.0), radius, 5)
    outline += [(half, 0.0)]
    mesh.add(GRAPHITE, tube([(HANDLE_X, y, z) for y, z in outline], TUBE_RADIUS, 10))
    for height in (0.20, 0.36):
        cross = tube([(HANDLE_X, -half, height), (HANDLE_X, half, height)], 0.012, 8)
        mesh.add(GRAPHITE, cross)
    grip = rod(TUBE_RADIUS + 0.005, 0.40, 12, 0.004).turned("x", math.pi / 2)
    mesh.add(RUBBER, grip.moved(HANDLE_X, 0, top))
    for side in (-1, 1):
        mesh.add(STEEL, rod(0.036, 0.014, 12, 0.003).moved(HANDLE_X, side * half, 0.018))

    # Mast with flange and the joint under the camera.
    mesh.add(STEEL, rod(0.045, 0.014, 14, 0.003).moved(MAST_X, MAST_Y, 0.018))
    mesh.add(GRAPHITE, rod(TUBE_RADIUS, MAST_HEIGHT, 12).moved(MAST_X, MAST_Y, MAST_HEIGHT / 2))
    mesh.add(YELLOW, rod(TUBE_RADIUS + 0.005, 0.045, 12, 0.004).moved(MAST_X, MAST_Y, 0.30))
    mesh.add(RUBBER, rod(0.011, 0.03, 8).moved(MAST_X, MAST_Y, 0.335))

    # Bumper: a rubber band around the tub.
    band = rounded_rectangle(CHASSIS_LENGTH, CHASSIS_WIDTH, 0.11, 6)
    rings = []
    profile = [(0.05, 0.0), (0.008, 0.0), (0.0, 0.012), (0.0, 0.048), (0.008, 0.06), (0.05, 0.06)]
    for inset, height in profile:
        scale = 1 - 2 * inset / np.array([CHASSIS_LENGTH, CHASSIS_WIDTH])
        rings.append(np.column_stack([band * scale, np.full(len(band), height)]))
    bumper = loft(rings, cap=False).moved(CHASSIS_X, 0, 0.165 - CHASSIS_TOP)
    mesh.add(RUBBER, bumper)

    front, rear = CHASSIS_X + CHASSIS_LENGTH / 2, CHASSIS_X - CHASSIS_LENGTH / 2
    for side in (-1, 1):
        lamp = slab(0.05, 0.13, 0.020, 0.009, 0.004, segments=2).turned("y", math.pi / 2)
        mesh.add(LAMP, lamp.moved(front - 0.024, side * 0.26, 0.272 - CHASSIS_TOP))
        light = slab(0.05, 0.10, 0.020, 0.009, 0.004, segments=2).turned("y", math.pi / 2)
        mesh.add(RED, light.moved(rear + 0.024, side * 0.27, 0.272 - CHASSIS_TOP))
        axle = rod(0.028, 0.10, 12).turned("x", math.pi / 2)
        mesh.add(STEEL, axle.moved(0, side * 0.46, WHEEL_RADIUS - CHASSIS_TOP))
    return mesh


def caster() -> Mesh:
    """A ball in a cup, about the ball's centre."""
    mesh = Mesh(f"{CART_MESHES}/caster.dae")
    rings = 7
    profile = [(0.0, -CASTER_RADIUS)]
    for k in range(1, rings):
        angle = -math.pi / 2 + k * math.radians(100) / (rings - 1)
        profile.append((CASTER_RADIUS * math.cos(angle), CASTER_RADIUS * math.sin(angle)))
    mesh.add(STEEL, lathe(profile, 20))
    cup = [
        (0.101, 0.000), (0.112, 0.002), (0.116, 0.030), (0.100, 0.075), (0.0, 0.080),
    ]  # fmt: skip
    mesh.add(GRAPHITE, lathe(cup, 20))
    return mesh


def camera() -> Mesh:
    """A camera that looks along +x; modelled at a quarter of its size, as in the tutorials."""
    mesh = Mesh(f"{CART_MESHES}/camera.dae")

    def add(material: Material, solid: Solid) -> None:
        mesh.add(material, solid.scaled(0.25))

    def along_x(solid: Solid) -> Solid:
        return solid.turned("y", math.pi / 2)

    add(WHITE, along_x(slab(0.076, 0.116, 0.078, 0.016, 0.005, segments=3)).moved(-0.077, 0, 0.002))
    add(
        GRAPHITE,
        along_x(slab(0.066, 0.106, 0.008, 0.012, 0.003, segments=3)).moved(-0.036, 0, 0.002),
    )
    barrel = [(0.034, -0.036), (0.034, -0.010), (0.031, -0.004), (0.026, -0.004), (0.023, -0.014)]
    add(GRAPHITE, along_x(lathe(barrel, 20)))
    ring = [(0.0345, -0.024), (0.0355, -0.022), (0.0355, -0.016), (0.0345, -0.014)]
    add(STEEL, along_x(lathe(ring, 20)))
    add(GLASS, along_x(lathe([(0.023, -0.014), (0.015, -0.0105), (0.0, -0.009)], 20)))
    add(RED, along_x(rod(0.004, 0.006, 8)).moved(-0.032, 0.044, 0.026))
    add(BLUE, bar(0.100, 0.112, 0.006, 0.002).moved(-0.060, 0, 0.042))
    add(GRAPHITE, box(0.050, 0.050, 0.014).moved(-0.066, 0, -0.041))
    return mesh


def traffic_cone() -> Mesh:
    """An object 0.5 m high, with its lower face at z = 0."""
    mesh = Mesh("models/traffic_cone/meshes/traffic_cone.dae")
    mesh.add(RUBBER, slab(0.30, 0.30, 0.03, 0.04, 0.006, segments=3).moved(z=0.015))

    def radius(height: float) -> float:
        return 0.115 - (height - 0.03) * (0.115 - 0.022) / 0.47

    def belt(low: float, high: float) -> Solid:
        return lathe([(radius(low), low), (radius(high), high)], 24)

    mesh.add(ORANGE, belt(0.03, 0.17), belt(0.25, 0.33), belt(0.39, 0.50))
    mesh.add(ORANGE, lathe([(radius(0.50), 0.50), (0.0, 0.50)], 24))
    mesh.add(WHITE, belt(0.17, 0.25), belt(0.33, 0.39))
    return mesh


RAMP_ANGLE = math.radians(12)
RAMP_PLATFORM, RAMP_WIDTH, RAMP_HEIGHT = 1.4, 1.6, 0.3


def ramp() -> Mesh:
    """A concrete block with yellow edges and treads on its slopes, along x, standing on z = 0."""
    mesh = Mesh("models/ramp/meshes/ramp.dae")
    run, flat = RAMP_HEIGHT / math.tan(RAMP_ANGLE), RAMP_PLATFORM / 2
    side = [(-flat - run, 0.0), (flat + run, 0.0), (flat, RAMP_HEIGHT), (-flat, RAMP_HEIGHT)]
    ends = [np.array([(x, y, z) for x, z in side]) for y in (-RAMP_WIDTH / 2, RAMP_WIDTH / 2)]
    mesh.add(CONCRETE, outward(loft(ends)))

    # Paint, raised by 3 mm to prevent flicker: strips along the edges, cleats on the slopes.
    slope = math.hypot(run, RAMP_HEIGHT)
    for edge in (-1, 1):
        y = edge * (RAMP_WIDTH / 2 - 0.05)
        mesh.add(YELLOW, box(RAMP_PLATFORM, 0.1, 0.006).moved(0, y, RAMP_HEIGHT))
        for way in (-1, 1):
            strip = box(slope, 0.1, 0.006).turned("y", way * RAMP_ANGLE)
            mesh.add(YELLOW, strip.moved(way * (flat + run / 2), y, RAMP_HEIGHT / 2))
    for way in (-1, 1):
        for k in range(8):
            part = (k + 0.5) / 8
            cleat = box(0.03, RAMP_WIDTH - 0.3, 0.006).turned("y", way * RAMP_ANGLE)
            mesh.add(GRAPHITE, cleat.moved(way * (flat + run * part), 0, RAMP_HEIGHT * (1 - part)))
    return mesh


def all_meshes() -> list[Mesh]:
    return [wheel(), chassis(), frame(), caster(), camera(), traffic_cone(), ramp()]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--to", type=Path, default=REPOSITORY, help="folder to write under")
    arguments = parser.parse_args()
    for mesh in all_meshes():
        mesh.write(arguments.to)
        print(f"{mesh.triangles():6d} triangles  {mesh.path}")


if __name__ == "__main__":
    main()
