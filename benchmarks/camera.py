"""The cart's camera: speed with every frame delivered, CPU time at real time, time of one image."""

from __future__ import annotations

import copy
import dataclasses
import time
from collections.abc import Callable, Iterator
from typing import Any

import mujoco

import cartwheel as cw
from benchmarks.carts import IMAGE, Listener, driving
from benchmarks.figure import Effort, Figure, medians
from cartwheel.simulation import CameraHandle

_SIZES = ((320, 240), (640, 480))
_RATE = 30
_REAL = 4.0
"""Wall time of the run at real time, s."""


def figures(effort: Effort) -> Iterator[Figure]:
    """Full speed, real time, and images of several sizes compared with MuJoCo's renderer."""
    yield from _lockstep(effort)
    yield _paced(effort)
    for size in _SIZES:
        yield from _image(size, effort)


def _lockstep(effort: Effort) -> Iterator[Figure]:
    with driving(world="post") as world:
        listener = Listener(world, (IMAGE,))
        seconds = effort.seconds / 4
        found = medians(effort.rounds, {"camera": lambda: world.run(seconds)})
        frames = listener.count / (seconds * (effort.rounds + 1))
    group = "1 cart, camera 320x240 at 30 Hz"
    yield Figure(
        group=group,
        name="speed",
        value=seconds / found["camera"],
        unit="x real time",
        goal=5.6,
        better="more",
        note="Gazebo 11: 1.1",
    )
    yield Figure(
        group=group,
        name="frames delivered",
        value=frames,
        unit="per simulated s",
        goal=_RATE * 0.95,
        better="more",
        note="all, except at the ends of short runs",
    )


def _paced(effort: Effort) -> Figure:
    seconds = min(_REAL, effort.rounds * effort.seconds)
    with driving(world="post") as world:
        listener = Listener(world, (IMAGE,))
        world.run(0.2)
        simulation = world.session.simulation
        simulation.set_speed(1.0)
        start, used = time.perf_counter(), time.process_time()
        world.session.pacer(until_ns=simulation.time_ns + round(seconds * 1e9)).run()
        used, wall = time.process_time() - used, time.perf_counter() - start
        frames = listener.count
    return Figure(
        group="1 cart, camera 320x240 at 30 Hz",
        name="CPU at real time",
        value=used / wall,
        unit="CPU s per s",
        goal=0.4,
        note=f"{frames} frames in {wall:.1f} s, all threads; Gazebo 11: 1.8",
    )


def _image(size: tuple[int, int], effort: Effort) -> Iterator[Figure]:
    with driving(world="post") as world:
        simulation = world.session.simulation
        simulation.refresh()
        ours = _ours(world, size)
        plain = _Theirs(world, size, defaults=False)
        defaults = _Theirs(world, size, defaults=True)
        found = medians(
            effort.rounds,
            {
                "ours": lambda: [ours() for _ in range(effort.images)],
                "plain": lambda: [plain.render() for _ in range(effort.images)],
                "defaults": lambda: [defaults.render() for _ in range(effort.images)],
            },
        )
        plain.close()
        defaults.close()
    group = f"One image, {size[0]}x{size[1]}"
    milliseconds = {name: 1e3 * value / effort.images for name, value in found.items()}
    yield Figure(group=group, name="Cartwheel", value=milliseconds["ours"], unit="ms")
    yield Figure(
        group=group,
        name="to mujoco.Renderer, plain",
        value=found["ours"] / found["plain"],
        unit="ratio",
        goal=1.0,
        note=f"{milliseconds['plain']:.2f} ms without multisampling and shadows",
    )
    yield Figure(
        group=group,
        name="to mujoco.Renderer, defaults",
        value=found["ours"] / found["defaults"],
        unit="ratio",
        note=f"{milliseconds['defaults']:.2f} ms with its multisampling and shadows",
    )


def _ours(world: cw.World, size: tuple[int, int]) -> Callable[[], object]:
    simulation = world.session.simulation
    camera = next(
        sensor.cameras[0]
        for placed in simulation.scene.models
        for link in placed.description.links
        for sensor in link.sensors
        if sensor.cameras
    )
    lens = dataclasses.replace(camera, width=size[0], height=size[1])
    handle = CameraHandle("cart_0", "camera1", lens)
    handle.bind(simulation.model, simulation.data)
    return lambda: simulation.engine.renderer.render(handle)


class _Theirs:
    """MuJoCo's renderer with the same scene, with its default options or without any."""

    def __init__(self, world: cw.World, size: tuple[int, int], *, defaults: bool) -> None:
        simulation = world.session.simulation
        visuals, self._data = simulation.engine.visuals.current()
        model = copy.deepcopy(visuals)
        model.vis.global_.offwidth, model.vis.global_.offheight = size
        fresh = mujoco.MjSpec().compile()
        if defaults:
            for name in ("offsamples", "shadowsize"):
                setattr(model.vis.quality, name, getattr(fresh.vis.quality, name))
            model.light_castshadow[:] = 1
        self._renderer: Any = mujoco.Renderer(model, height=size[1], width=size[0])

    def render(self) -> object:
        """Renders one image, as in MuJoCo's documentation."""
        self._renderer.update_scene(self._data, camera=0)
        return self._renderer.render()

    def close(self) -> None:
        self._renderer.close()
