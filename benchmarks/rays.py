"""Rays in a house of 1,400 shapes: their cost relative to Embree alone, and a large lidar."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

import cartwheel as cw
from benchmarks.figure import Effort, Figure, medians, paired
from benchmarks.sensors import carrying, scanner
from cartwheel.devices.noise import Noise
from cartwheel.devices.rays.outputs import LaserScanOutput, PointCloud2Output
from cartwheel.devices.rays.scan import LEVEL, Scan, ScanPattern, Sweep
from cartwheel.geometry import Pose
from cartwheel.messages import header
from cartwheel.simulation.sensing.embree_rays import SharedRayScenes
from cartwheel.simulation.sensing.ray_shapes import PLANE, triangles_of
from cartwheel.simulation.sensing.ray_triangles import AVAILABLE
from cartwheel.simulation.sensing.rays import RayHandle

_GROUP = "rays in a house of 1,400 shapes"
_SHAPES = 1400
_ALLOWED = 50e-6
"""s of a scan that do not count."""
_RATE = 10.0
_PATTERNS = ((720, 1), (1800, 16), (2048, 128))


def figures(effort: Effort) -> Iterator[Figure]:
    """The cost of scans, and the speed of a robot with a lidar of 128 x 2048 rays."""
    if not AVAILABLE:
        return
    with tempfile.TemporaryDirectory() as folder:
        house = Path(folder) / "house.world"
        house.write_text(_house())
        for columns, rows in _PATTERNS:
            yield from _scan(house, columns, rows, effort)
        yield _lidar(house, effort)


def _house() -> str:
    """Furniture of boxes and a few posts in rooms with walls."""
    random = np.random.default_rng(1)
    parts = []
    for index in range(_SHAPES):
        x, y = random.uniform(-20, 20, 2)
        if abs(x) < 2 and abs(y) < 2:
            x += 5
        place = f"{x:.3f} {y:.3f} {random.uniform(0, 2):.3f} 0 0 {random.uniform(0, 3):.3f}"
        size = " ".join(f"{each:.3f}" for each in random.uniform(0.05, 0.6, 3))
        shape = f"<box><size>{size}</size></box>"
        if index % 10 == 0:
            shape = "<cylinder><radius>0.1</radius><length>2</length></cylinder>"
        parts.append(
            f'<collision name="c{index}"><pose>{place}</pose><geometry>{shape}</geometry>'
            "</collision>"
        )
    return f"""<sdf version="1.7"><world name="house"><include><uri>model://ground_plane</uri>
        </include><model name="house"><static>true</static><link name="link">{"".join(parts)}
        </link></model></world></sdf>"""


def _scan(house: Path, columns: int, rows: int, effort: Effort) -> Iterator[Figure]:
    azimuth, elevation = np.meshgrid(
        np.linspace(-np.pi, np.pi, columns), np.linspace(-0.3, 0.3, rows) * (rows > 1)
    )
    level = np.cos(elevation)
    rays = np.stack([level * np.cos(azimuth), level * np.sin(azimuth), np.sin(elevation)], axis=-1)
    rays = rays.reshape(-1, 3)
    with cw.World(house) as world:
        world.spawn("rosbots.xacro")
        world.run(0.2)
        simulation = world.session.simulation
        handle = RayHandle(
            "rosbots", "base_link", Pose((0.0, 0.0, 1.0)), rays, minimum=0.1, maximum=100.0,
            scenes=SharedRayScenes(),
        )  # fmt: skip
        handle.bind(simulation.model, simulation.data)
        scene = _bare(simulation.model, simulation.data)
        start = np.tile(np.array([0.0, 0.0, 1.0], dtype=np.float32), (len(rays), 1))
        directions = rays.astype(np.float32)
        output = (PointCloud2Output if rows > 1 else LaserScanOutput)(topic="scan")
        scanner: Any = SimpleNamespace(
            directions=rays.reshape(rows, columns, 3), pattern=_pattern(columns, rows)
        )
        moment = header(0, "laser")

        def scan() -> None:
            ranges, intensities = handle.cast()
            found = Scan(
                ranges=ranges.reshape(rows, columns), intensities=intensities.reshape(rows, columns)
            )
            output.message(moment, scanner, found)

        count = max(1, 10_000 // len(rays))

        def scans() -> None:
            for _ in range(count):
                scan()

        def alone() -> None:
            for _ in range(count):
                scene.run(start, directions)

        ratio, base = paired(effort.rounds, scans, alone)
    yield Figure(
        group=_GROUP,
        name=f"{rows} x {columns} rays with their message, relative to Embree alone",
        value=ratio - _ALLOWED * count / base,
        unit="ratio",
        goal=2.0,
        note=f"CPU time, less 0.05 ms; alone {base / count * 1e3:.2f} ms",
    )


def _pattern(columns: int, rows: int) -> ScanPattern:
    return ScanPattern(
        horizontal=Sweep(count=columns, first=-np.pi, last=np.pi),
        vertical=Sweep(count=rows, first=-0.3, last=0.3) if rows > 1 else LEVEL,
        minimum=0.1,
        maximum=100.0,
        noise=Noise(),
    )


def _bare(model: Any, data: Any) -> Any:
    """The house in Embree."""
    from embreex.mesh_construction import TriangleMesh
    from embreex.rtcore_scene import EmbreeScene

    corners, faces, count = [], [], 0
    for geom in np.flatnonzero(model.body_weldid[model.geom_bodyid] == 0).tolist():
        if model.geom_type[geom] == PLANE:
            continue
        own, triangles = triangles_of(model, geom)
        corners.append(own @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom])
        faces.append(triangles + count)
        count += len(own)
    scene = EmbreeScene()
    vertices = np.concatenate(corners).astype(np.float32)
    TriangleMesh(scene, vertices, np.concatenate(faces).astype(np.int32))
    return scene


def _lidar(house: Path, effort: Effort) -> Figure:
    element = scanner(columns=2048, rows=128, rate=_RATE, reach=100.0, output="PointCloud2")
    seconds = max(0.2, effort.seconds / 4)
    with cw.World(house) as world:
        world.spawn(carrying(element))
        messages: list[Any] = []
        world.subscribe("/scan", messages.append)
        world.publish("/part2_cmr/cmd_vel", linear_x=0.2, angular_z=0.4)
        world.run(0.3)
        run = {"run": lambda: world.run(seconds)}
        found = medians(max(2, effort.rounds // 5), run, wall=False)
        assert messages[-1].width * messages[-1].height > 100_000
    return Figure(
        group=_GROUP,
        name="128 x 2048 rays at 10 Hz as point clouds",
        value=seconds / found["run"],
        unit="x real time",
        goal=1.0,
        better="more",
        note="CPU time of one core",
    )
