"""Measures one robot or world: loads it, simulates it with commands, and records all it does."""

from __future__ import annotations

import contextlib
import hashlib
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import mujoco
import numpy as np

from .adapter import (
    CartwheelError,
    World,
    call,
    check,
    compiled,
    controller_files,
    encode_cdr,
    load_robot,
    now_ns,
    request,
    run_with,
    subscribe,
    to_dict,
)
from .commanding import PERIOD, Commands
from .plain import PLACES, diagnostic, digest, error, numbers, path, value
from .subjects import ROBOTS, Subject

IMAGES = 3
"""Messages of an image topic: rendering in software takes long."""
HEAVY = ("/Image", "/CompressedImage", "/PointCloud2", "/DisparityImage", "/Packet")
_SHOWN = 1500
"""Largest message that is kept in full as an example, bytes."""
_HIGH = 20.0
_LARGE, _SHORT = 500, 0.5
"""Degrees of freedom or links from which a shorter time is simulated, s."""


def measure(subject: Subject) -> dict[str, Any]:
    """What a robot or a world does, as JSON."""
    with _files(subject) as (robot, world):
        found: dict[str, Any] = {"check": _checked(robot or world)}
        try:
            _simulate(found, robot, world, subject.seconds)
        except CartwheelError as refused:
            found["error"] = error(refused)
    return found


@contextlib.contextmanager
def _files(subject: Subject) -> Iterator[tuple[Path | None, Path | None]]:
    if not subject.filename:
        yield subject.robot, subject.world
        return
    source = subject.robot or subject.world
    assert source is not None
    text = source.read_text()
    before, mark, rest = text.rpartition('filename="')
    assert mark, source
    text = before + mark + subject.filename + rest[rest.index('"') :]
    with tempfile.TemporaryDirectory(prefix="golden") as folder:
        # The package that the robots name lies beside them.
        Path(folder, "my_robot").symlink_to(ROBOTS / "my_robot")
        made = Path(folder, f"renamed{source.suffix}")
        made.write_text(text)
        PLACES[folder] = "<folder>"
        yield (None, made) if subject.world else (made, None)


def _checked(file: Path | None) -> Any:
    assert file is not None
    try:
        result = check(file, settings=False, use_baseline=False)
    except CartwheelError as refused:
        return {"error": error(refused)}
    return {
        "complete": result.complete,
        "suppressed": result.suppressed,
        "findings": [diagnostic(each) for each in result.findings],
    }


def _simulate(found: dict[str, Any], robot: Path | None, file: Path | None, seconds: float) -> None:
    description = load_robot(robot) if robot else None
    height = resting_height(description) if description is not None else 0.0
    with World(file or "empty", lenient=True) as world:
        try:
            if description is not None:
                controllers = controller_files(description)
                found["controllers"] = [path(str(each)) for each in controllers]
                name = description.name
                world.spawn(
                    description,
                    name=f"{name}_tried" if name in world.models else name,
                    z=height,
                    controllers=controllers,
                )
            found["compiled"] = _compiled(world)
            ears = Ears(world)
            commands = Commands(world)
            model, _ = compiled(world)
            with _noted(found, "error"):
                _run(world, ears, commands, seconds if model.nv < _LARGE else _SHORT)
            found["state"] = state(world)
            found["topics"] = ears.heard()
            found["commands"] = commands.given
            found["refused"] = commands.refused
            found["services"] = {each.name: each.type for each in world.graph.services()}
            found["actions"] = {each.name: each.type for each in world.graph.actions()}
            found["diagnostics"] = [diagnostic(each) for each in world.diagnostics]
            before = len(found["diagnostics"])
            with _noted(found, "error after reset"):
                world.reset()
                world.run(0.3)
                found["after reset"] = fingerprint(world)
                found["answers"] = _answers(world)
            more = world.diagnostics[before:]
            found["later diagnostics"] = [diagnostic(each) for each in more]
        except CartwheelError as refused:
            found["error"] = error(refused)
            found["diagnostics"] = [diagnostic(each) for each in world.diagnostics]


@contextlib.contextmanager
def _noted(found: dict[str, Any], name: str) -> Iterator[None]:
    try:
        yield
    except CartwheelError as refused:
        found[name] = error(refused)


def resting_height(description: Any) -> float:
    """The height at which the lowest collision shape touches the ground; 0 for what is fixed."""
    if len(description.links) > _LARGE:
        return 0.0
    with World(lenient=True) as world:
        known = set(world.models)
        try:
            model = world.spawn(description, name="golden_probe", z=_HIGH)
        except CartwheelError:
            return 0.0
        assert model.name not in known
        mj, data = compiled(world)
        free = mujoco.mjtJoint.mjJNT_FREE
        if not any(
            mj.jnt_type[each] == free and _name(mj, "jnt", each).startswith("golden_probe::")
            for each in range(mj.njnt)
        ):
            return 0.0
        lowest = np.inf
        for geom in range(mj.ngeom):
            body = _name(mj, "body", int(mj.geom_bodyid[geom]))
            solid = mj.geom_contype[geom] or mj.geom_conaffinity[geom]
            if not body.startswith("golden_probe::") or not solid:
                continue
            if mj.geom_type[geom] in (mujoco.mjtGeom.mjGEOM_PLANE, mujoco.mjtGeom.mjGEOM_HFIELD):
                continue
            centre, half = mj.geom_aabb[geom][:3], mj.geom_aabb[geom][3:]
            turn = data.geom_xmat[geom].reshape(3, 3)
            middle = data.geom_xpos[geom] + turn @ centre
            lowest = min(lowest, float(middle[2] - np.abs(turn[2]) @ half))
    if not np.isfinite(lowest):
        return 0.0
    return float(np.round(_HIGH - lowest, 6)) or 1e-6


def _run(world: World, ears: Ears, commands: Commands, seconds: float) -> None:
    times = [step * PERIOD for step in range(round(seconds / PERIOD))]
    run_with(world, times, commands.give, ears.listen)


class Ears:
    """Subscribes to every topic and adds up its messages.

    Args:
        world: The world.
        images: Messages of each topic with images after which it is left.
        summed: Whether the messages are hashed.
    """

    def __init__(self, world: World, *, images: int = IMAGES, summed: bool = True) -> None:
        self._world = world
        self._images, self._summed = images, summed
        self._topics: dict[str, Heard] = {}

    def listen(self) -> None:
        """Subscribes to the topics that are new."""
        for topic in self._world.graph.topics():
            if topic.name not in self._topics and topic.publishers:
                most = self._images if topic.type.endswith(HEAVY) else 0
                heard = Heard(self._world, most=most, summed=self._summed)
                self._topics[topic.name] = heard
                heard.close = subscribe(self._world, topic.name, topic.type, heard)

    def heard(self) -> dict[str, Any]:
        found = {}
        for topic in self._world.graph.topics():
            entry: dict[str, Any] = {
                "type": topic.type,
                "rate": topic.rate,
                "qos": topic.qos,
                "publishers": list(topic.publishers),
                "subscribers": [each for each in topic.subscribers if each != "golden"],
            }
            heard = self._topics.get(topic.name)
            found[topic.name] = entry | (heard.summary() if heard is not None else {})
        return found


class Heard:
    """The messages of a topic."""

    def __init__(self, world: World, *, most: int, summed: bool) -> None:
        self._world = world
        self._most, self._summed = most, summed
        self._sum = hashlib.sha256()
        self.count = 0
        self._first = self._last_ns = 0
        self._last: Any = None
        self._size = 0
        self.close: Callable[[], None] = lambda: None

    def __call__(self, message: Any) -> None:
        self.count += 1
        if self._summed:
            self._add(message)
        if self.count == self._most:
            self.close()

    def _add(self, message: Any) -> None:
        data = bytes(encode_cdr(message))
        self._sum.update(len(data).to_bytes(8, "little"))
        self._sum.update(data)
        self._last_ns = now_ns(self._world)
        if self.count == 1:
            self._first = self._last_ns
        self._last, self._size = message, len(data)

    def summary(self) -> dict[str, Any]:
        found: dict[str, Any] = {"count": self.count, "sha256": self._sum.hexdigest()}
        if self.count:
            found["first_ns"], found["last_ns"] = self._first, self._last_ns
            if self._last is not None and self._size <= _SHOWN:
                found["last"] = value(to_dict(self._last))
        return found


def _name(model: Any, kind: str, index: int) -> str:
    objects = {"jnt": mujoco.mjtObj.mjOBJ_JOINT, "body": mujoco.mjtObj.mjOBJ_BODY}
    return mujoco.mj_id2name(model, objects[kind], index) or ""


_SIZES = {0: (7, 6), 1: (4, 3)}
"""Numbers of the position and the velocity of free and ball joints."""


def state(world: World) -> dict[str, Any]:
    """Poses of models and links, and positions and velocities of joints, in MuJoCo's order."""
    model, data = compiled(world)
    joints = {}
    for index in range(model.njnt):
        wide, fast = _SIZES.get(int(model.jnt_type[index]), (1, 1))
        at, rate = model.jnt_qposadr[index], model.jnt_dofadr[index]
        joints[_name(model, "jnt", index)] = {
            "position": numbers(data.qpos[at : at + wide]),
            "velocity": numbers(data.qvel[rate : rate + fast]),
        }
    models = {}
    for name in world.models:
        pose = world.model(name).pose
        models[name] = numbers((*pose.position, *pose.orientation))
    links = {
        _name(model, "body", index): numbers((*data.xpos[index], *data.xquat[index]))
        for index in range(1, model.nbody)
    }
    time = now_ns(world)
    return {"time_ns": time, "models": models, "links": links, "joints": joints}


def fingerprint(world: World) -> str:
    """A hash of the time, positions and velocities."""
    _, data = compiled(world)
    return digest(data.qpos.tobytes(), data.qvel.tobytes(), str(now_ns(world)).encode())


def _compiled(world: World) -> dict[str, str]:
    """A hash of each array of the compiled model, which MuJoCo names."""
    model, _ = compiled(world)
    found = {"opt": digest(repr(model.opt).encode())}
    for name in dir(model):
        given = getattr(model, name)
        # Names lie in one array in the order of compilation.
        if isinstance(given, np.ndarray) and not name.startswith("name_") and given.size:
            found[name] = digest(np.ascontiguousarray(given).tobytes())
    return found


def _answers(world: World) -> dict[str, Any]:
    """The responses of all services to requests of zeros, in order of their names."""
    found = {}
    for service in world.graph.services():
        if service.threaded:
            continue
        try:
            future = call(world, service.name, request(service.type))
            world.run(0.02)
            found[service.name] = value(to_dict(future.result(timeout=1.0)))
        except CartwheelError as refused:
            found[service.name] = {"error": error(refused)}
    return found
