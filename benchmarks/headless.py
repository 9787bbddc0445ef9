"""Full speed without a camera: one cart with a subscriber, and many carts."""

from __future__ import annotations

from collections.abc import Iterator

from benchmarks.carts import READ, Bare, Listener, driving
from benchmarks.figure import Effort, Figure, medians

_GAZEBO = {1: 10.0, 5: 3.3, 10: 1.9, 20: 0.94}
"""Speed of Gazebo 11 by the number of carts, in multiples of real time."""
_TIMES_GAZEBO = 20.0


def figures(effort: Effort) -> Iterator[Figure]:
    """Several carts compared with MuJoCo alone, and one cart by subscribed topic."""
    for count in effort.carts:
        yield from _carts(count, effort)
    yield from _reading(effort)


def _carts(count: int, effort: Effort) -> Iterator[Figure]:
    with driving(count) as world:
        listener = Listener(world, READ)
        bare = Bare(world)
        seconds = effort.seconds / count
        found = medians(
            effort.rounds,
            {
                "cartwheel": lambda: world.run(seconds),
                "bare": lambda: bare.step(seconds),
                "chunk": lambda: bare.steps(seconds),
            },
        )
        simulated = seconds * (effort.rounds + 1)
        expected = (100 * 3 + 30) * count * simulated
        assert listener.count >= 0.95 * expected, "messages were dropped"
    group = f"{count} cart{'s' if count > 1 else ''}, odometry, tf, joint states and IMU subscribed"
    yield Figure(
        group=group,
        name="speed",
        value=seconds / found["cartwheel"],
        unit="x real time",
        goal=_TIMES_GAZEBO * _GAZEBO[count] if count in _GAZEBO else None,
        better="more",
        note=f"Gazebo 11: {_GAZEBO[count]:g}" if count in _GAZEBO else "",
    )
    yield Figure(
        group=group,
        name="bare loop",
        value=seconds / found["bare"],
        unit="x real time",
        better="more",
        note=f"{found['bare'] / seconds * bare.model.opt.timestep * 1e6:.1f} us per step",
    )
    yield Figure(
        group=group,
        name="time to bare loop",
        value=found["cartwheel"] / found["bare"],
        unit="ratio",
        goal=1.10,
        note="mj_step for each step",
    )
    yield Figure(
        group=group,
        name="time to bare chunk",
        value=found["cartwheel"] / found["chunk"],
        unit="ratio",
        note="mj_step(nstep) for all steps",
    )


def _reading(effort: Effort) -> Iterator[Figure]:
    """The cost of each topic, and of a simulation without subscribers."""
    sets = {"nothing": (), **{topic: (topic,) for topic in READ}}
    worlds = {name: driving() for name in sets}
    listeners = [Listener(worlds[name], topics) for name, topics in sets.items()]
    bare = Bare(worlds["nothing"])
    seconds = effort.seconds / 4
    ways = {name: (lambda world=world: world.run(seconds)) for name, world in worlds.items()}
    found = medians(effort.rounds, {**ways, "bare": lambda: bare.step(seconds)})
    for name, listener in zip(sets, listeners, strict=True):
        note = ""
        if listener.count:
            added = (found[name] - found["nothing"]) * (effort.rounds + 1) / listener.count
            note = f"{added * 1e6:.1f} us per message"
        yield Figure(
            group="1 cart, by subscribed topic",
            name=name,
            value=found[name] / found["bare"],
            unit="ratio",
            note=note,
        )
    for world in worlds.values():
        world.close()
