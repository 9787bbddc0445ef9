"""A robot whose lidar measures meshes; processes of `test_scans` import this file."""

from __future__ import annotations

import math
from pathlib import Path

import cartwheel as cw
from cartwheel.messages import encode_cdr

ROWS, COLUMNS = 24, 48
"""Of the mesh, which has more triangles than a lidar casts without Embree."""
ROBOT = """<sdf version="1.7"><model name="robot"><pose>0 0 2 0 0 0</pose>
  <joint name="foot" type="fixed"><parent>world</parent><child>base</child></joint>
  <link name="base">{inertia}
    <collision name="c">{stands}</collision><visual name="v">{stands}</visual>{on_base}</link>
  <link name="arm"><pose>0 0 0.3 0 0.2 0</pose>{inertia}
    <collision name="c">{swings}</collision><visual name="v">{swings}</visual>{on_arm}</link>
  <joint name="hinge" type="revolute"><parent>base</parent><child>arm</child>
    <axis><xyz>0 1 0</xyz></axis></joint>
  </model></sdf>"""
INERTIA = """<inertial><mass>1</mass><pose>0 0 -0.3 0 0 0</pose>
  <inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial>"""
MESH = """<pose>{place} 0 0 0</pose><geometry><mesh><uri>bumps.obj</uri></mesh></geometry>"""
LIDAR = """<sensor name="lidar" type="{kind}"><topic>scan</topic><update_rate>50</update_rate>
  <ray><scan><horizontal><samples>360</samples><min_angle>-3.1</min_angle><max_angle>3.1</max_angle>
  </horizontal></scan><range><min>0.05</min><max>20</max></range></ray></sensor>"""


def write_robot(folder: Path, kind: str, link: str) -> Path:
    """Writes the robot: one mesh stands, another one swings.

    Args:
        folder: Where.
        kind: ``lidar`` or ``gpu_lidar``, which measure collisions or visuals.
        link: The link with the lidar, ``base`` or ``arm``.
    """
    lines = []
    for row in range(ROWS + 1):
        for column in range(COLUMNS):
            up, around = math.pi * row / ROWS, math.tau * column / COLUMNS
            radius = 0.3 + 0.03 * math.sin(5 * up) * math.cos(7 * around)
            x, y = math.sin(up) * math.cos(around), math.sin(up) * math.sin(around)
            lines.append(f"v {radius * x:.6f} {radius * y:.6f} {radius * math.cos(up):.6f}")
    for row in range(ROWS):
        for column in range(COLUMNS):
            a, b = (1 + row * COLUMNS + each % COLUMNS for each in (column, column + 1))
            lines += [f"f {a} {a + COLUMNS} {b}", f"f {b} {a + COLUMNS} {b + COLUMNS}"]
    (folder / "bumps.obj").write_text("\n".join(lines))
    lidar = LIDAR.format(kind=kind)
    file = folder / "robot.sdf"
    file.write_text(
        ROBOT.format(
            inertia=INERTIA,
            stands=MESH.format(place="0 0.9 0"),
            swings=MESH.format(place="0.8 0 -0.3"),
            on_base=lidar if link == "base" else "",
            on_arm=lidar if link == "arm" else "",
        )
    )
    return file


def make_world(file: Path) -> cw.World:
    """A world with the robot."""
    world = cw.World("empty")
    world.spawn(file)
    return world


def scans(world: cw.World, seconds: float = 0.3) -> list[bytes]:
    """The next messages of the lidar."""
    box = world.mailbox("/scan", size=100)
    world.run(seconds)
    box.close()
    return [bytes(encode_cdr(message)) for message in box.drain()]


def restored(file: Path, state: cw.State) -> list[bytes]:
    """What `scans` returns in a new world that restores a state."""
    with make_world(file) as world:
        world.restore(state)
        return scans(world)
