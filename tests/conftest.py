"""Worlds and models for tests, made in a line."""

from __future__ import annotations

import contextlib
import dataclasses
import gc
import importlib
import os
import re
import signal
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings
from tests import launching
from tests.devices.drives.carts import cart_sdf

import cartwheel as cw
from cartwheel.description import load_robot, load_text
from cartwheel.description.model import (
    Box,
    Collision,
    Element,
    Inertial,
    Link,
    Material,
    Physics,
    Plane,
    PluginTag,
    RobotDescription,
    Surface,
    Visual,
    WorldDescription,
)
from cartwheel.errors import Origin
from cartwheel.geometry import Pose
from cartwheel.messages import from_dict

if os.environ.get("CARTWHEEL_CODES_ONLY"):
    from tests.codes_only import sitecustomize

GRAVITY = 9.8
HERE = Pose()
_TESTS = Path(__file__).parent
_WAITING = (
    *("ros1", "viewer", "cli", "bridges", "docs", "testing", "campaign", "benchmarks"),
    *("scenarios", "sweeps", "codes_only"),
)
"""Folders whose tests start many processes and wait for them."""
_BUSY = ("saving", "api", "batch")
"""Folders whose tests take long, and use a processor all the time."""
_SPREAD = ("tests/docs/test_commands.py",)
"""Files whose tests need not run in the same process, and take long together."""
_TOGETHER = ("tests/viewer/one_page/",)
"""Folders whose tests run in the same process, because they share what takes long to start."""
_PLACE = Origin(file="test.sdf", line=1)

# The same examples in each run, however long a busy machine takes to make and to try them.
settings.register_profile(
    "cartwheel",
    derandomize=True,
    deadline=None,
    database=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
settings.load_profile("cartwheel")


def pytest_configure(config: pytest.Config) -> None:
    # Worlds are to be as in programs: without a recording, and freed with the last reference.
    if config.pluginmanager.has_plugin("cartwheel"):
        config.pluginmanager.unregister(name="cartwheel")
    launching.replace_starts()
    if hasattr(config, "workerinput"):
        launching.share(config.workerinput["launcher"])
    # A shell starts background jobs with this signal ignored, and programs that tests start and
    # interrupt would inherit that.
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        signal.signal(signal.SIGINT, signal.default_int_handler)
    if os.environ.get("CARTWHEEL_CODES_ONLY"):
        sitecustomize.install_services()
        folder = str(Path(sitecustomize.__file__).parent)
        os.environ["PYTHONPATH"] = os.pathsep.join(
            filter(None, (folder, os.environ.get("PYTHONPATH", "")))
        )


@pytest.hookimpl(optionalhook=True)
def pytest_configure_node(node: Any) -> None:
    """Called for each worker of pytest-xdist. All of them share a launcher."""
    node.workerinput["launcher"] = launching.shared()


def pytest_sessionstart(session: pytest.Session) -> None:
    """Imports all tests in a worker of a run of all, each worker from another place on.

    Pytest rewrites the assertions of each file that has changed, which takes longer than everything
    else before the first test. Workers that collect in the same order all rewrite the same file at
    the same time. So each rewrites a part, and reads what the others have written.
    """
    config = session.config
    worker = getattr(config, "workerinput", None)
    folders = set(config.args)
    if worker is None or folders != set(config.getini("testpaths")):
        return
    gc.disable()  # `pytest_collection` enables it.
    files = sorted(_TESTS.rglob("test_*.py"))
    first = len(files) * int(worker["workerid"].removeprefix("gw")) // worker["workercount"]
    for file in files[first:] + files[:first]:
        name = ".".join(file.relative_to(_TESTS.parent).with_suffix("").parts)
        # The collection imports it again, and reports the error.
        with contextlib.suppress(Exception, pytest.skip.Exception):
            importlib.import_module(name)


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Iterator[None]:
    """Keeps what imports and the collection make from the garbage collector.

    There are a million objects of all tests. To go through them takes most of a second each time.
    """
    gc.disable()
    try:
        return (yield)
    finally:
        gc.collect()
        gc.freeze()
        gc.set_threshold(*launching.RARE_COLLECTIONS)
        gc.enable()


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    places = _places([item.path for item in items])
    items.sort(key=lambda item: places[item.path])
    if os.environ.get("CARTWHEEL_CODES_ONLY"):
        left_out = [item for item in items if item.get_closest_marker("wording")]
        config.hook.pytest_deselected(items=left_out)
        items[:] = [item for item in items if not item.get_closest_marker("wording")]


def _places(files: Sequence[Path]) -> dict[Path, float]:
    """The place of each file, from 0 to 1, in the order in which the files are distributed.

    Files that wait and files that use a processor alternate, so that the processors are used while
    tests wait. Long files come first, so that at the end no process runs one of them alone.
    """
    unique = dict.fromkeys(files)
    found = {}
    names = {file: file.relative_to(_TESTS).parts[0] for file in unique}
    for folders, end in ((_WAITING, 0.9), (_BUSY, 1.0)):
        order = {name: place for place, name in enumerate(folders)}
        chosen = [
            file for file, name in names.items() if (name in _WAITING) == (folders is _WAITING)
        ]
        chosen.sort(key=lambda file: order.get(names[file], len(order)))
        found |= {file: end * place / len(chosen) for place, file in enumerate(chosen)}
    return found


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """With ``--dist loadfile``, some files are distributed by tests, and some folders as one."""
    if config.getvalue("dist") != "loadfile":
        return None
    from xdist.scheduler import LoadFileScheduling

    class Scheduling(LoadFileScheduling):
        def _split_scope(self, nodeid: str) -> str:
            file = str(super()._split_scope(nodeid))
            folder = next((each for each in _TOGETHER if file.startswith(each)), None)
            return nodeid if file in _SPREAD else folder or file

    return Scheduling(config, log)


@pytest.fixture
def tmp_path(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder without others beside it, in which robots would be searched like in a workspace.

    Its path is shorter than that of pytest's fixture, because sockets of programs are in it.
    """
    name = re.sub(r"\W", "_", request.node.name)[:16]
    folder = tmp_path_factory.mktemp(name) / "f"
    folder.mkdir()
    return folder


@pytest.fixture(scope="session", autouse=True)
def temporary_files(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Keeps what others put among temporary files from tests, and from programs they start."""
    folder = str(tmp_path_factory.getbasetemp())
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("TMPDIR", folder)
        patch.setattr(tempfile, "tempdir", folder)
        yield


@pytest.fixture
def runtime_folder() -> Iterator[Path]:
    """A folder for sockets: its path is short enough for them, wherever tests keep their files."""
    with tempfile.TemporaryDirectory(prefix="cw", dir="/tmp") as folder:
        yield Path(folder)


class Make:
    """Builds what a test needs; closes the worlds it made."""

    def __init__(self) -> None:
        self._worlds: list[cw.World] = []
        self.expects_faults = False
        """Whether plugins are to raise errors."""

    def world(
        self,
        *models: RobotDescription,
        step: float | None = None,
        ground: float | None = 100.0,
        gravity: float = GRAVITY,
        seed: int = 0,
        without: Sequence[str] = (),
        **more: Any,
    ) -> cw.World:
        """A world of models on a ground of friction `ground`; None is without ground."""
        standing = (() if ground is None else (self.ground(ground),)) + models
        description = WorldDescription(
            name="test",
            models=standing,
            gravity=(0.0, 0.0, -gravity),
            physics=Physics(max_step_size=step),
            **more,
        )
        world = cw.World(description, seed=seed, without=without)
        self._worlds.append(world)
        return world

    @staticmethod
    def ground(mu: float = 100.0) -> RobotDescription:
        """An endless plane, light grey."""
        surface = Surface(mu1=mu, mu2=mu)
        link = Link(
            name="link",
            collisions=(
                Collision(name="collision", shape=Plane(), surface=surface, origin=_PLACE),
            ),
            visuals=(
                Visual(
                    name="visual",
                    shape=Plane(),
                    material=Material(diffuse=(0.7, 0.7, 0.7, 1.0)),
                    origin=_PLACE,
                ),
            ),
            origin=_PLACE,
        )
        return RobotDescription(
            name="ground_plane", links=(link,), static=True, canonical_link="link", origin=_PLACE
        )

    @staticmethod
    def box(
        name: str,
        size: tuple[float, float, float],
        *,
        mass: float = 2.0,
        mu: float = 1.0,
        pose: Pose = HERE,
        static: bool = False,
        colour: tuple[float, float, float] = (0.7, 0.7, 0.7),
    ) -> RobotDescription:
        """A uniform box about its link's origin."""
        x, y, z = size
        link = Link(
            name="link",
            inertial=Inertial(
                mass=mass,
                ixx=mass * (y * y + z * z) / 12,
                iyy=mass * (x * x + z * z) / 12,
                izz=mass * (x * x + y * y) / 12,
                origin=_PLACE,
            ),
            collisions=(
                Collision(
                    name="collision",
                    shape=Box(size=size),
                    surface=Surface(mu1=mu, mu2=mu),
                    origin=_PLACE,
                ),
            ),
            visuals=(
                Visual(
                    name="visual",
                    shape=Box(size=size),
                    material=Material(diffuse=(*colour, 1.0)),
                    origin=_PLACE,
                ),
            ),
            origin=_PLACE,
        )
        return RobotDescription(
            name=name, links=(link,), static=static, pose=pose, canonical_link="link", origin=_PLACE
        )

    @staticmethod
    def sdf(model: str) -> RobotDescription:
        """What ``<model name="…">…</model>`` describes."""
        text = f'<sdf version="1.7">{model}</sdf>'
        described = load_text(text, file="test.sdf")
        assert isinstance(described, RobotDescription)
        return described

    @staticmethod
    def with_parameters(
        description: RobotDescription, plugin: str, **tags: str
    ) -> RobotDescription:
        """The description with tags of the plugin of that name written anew."""
        found = []

        def edit(tag: PluginTag) -> PluginTag:
            if tag.name != plugin:
                return tag
            found.append(tag)
            kept = tuple(child for child in tag.element.children if child.tag not in tags)
            new = tuple(
                Element(tag=name, text=text, origin=tag.origin) for name, text in tags.items()
            )
            element = dataclasses.replace(tag.element, children=kept + new)
            return dataclasses.replace(tag, element=element)

        links = tuple(
            dataclasses.replace(
                link,
                sensors=tuple(
                    dataclasses.replace(sensor, plugins=tuple(edit(tag) for tag in sensor.plugins))
                    for sensor in link.sensors
                ),
            )
            for link in description.links
        )
        plugins = tuple(edit(tag) for tag in description.plugins)
        assert found, f"no plugin named {plugin}"
        return dataclasses.replace(description, links=links, plugins=plugins)

    @staticmethod
    def with_sensors(
        description: RobotDescription, change: Callable[[Any], Any]
    ) -> RobotDescription:
        """The description with every sensor changed."""
        links = tuple(
            dataclasses.replace(link, sensors=tuple(change(sensor) for sensor in link.sensors))
            for link in description.links
        )
        return dataclasses.replace(description, links=links)

    def close(self) -> None:
        for world in self._worlds:
            world.close()
        # A plugin that raises an error is disabled, and the run goes on: here it is a failure.
        faults = [each.details for world in self._worlds for each in world.diagnostics]
        assert self.expects_faults or not any(faults), "\n".join(faults)


@pytest.fixture
def make() -> Iterator[Make]:
    made = Make()
    yield made
    made.close()


@pytest.fixture(scope="module")
def make_once() -> Iterator[Make]:
    """`make` for worlds that the tests of a module share."""
    made = Make()
    yield made
    made.close()


@pytest.fixture(scope="session")
def rosbots() -> RobotDescription:
    return load_robot("rosbots.xacro")


@pytest.fixture
def read():
    """Returns the messages of a topic in the next seconds."""

    def read(world, topic, seconds):
        box = world.mailbox(topic, size=100_000)
        world.run(seconds)
        box.close()
        return box.drain()

    return read


@pytest.fixture
def ask():
    """Calls a service, runs one step, and returns the response."""

    def asked(world, name, **request):
        kind = world.graph.service(name).type
        future = world.graph.call(name, from_dict(f"{kind}_Request", request))
        world.run(world.session.simulation.step_ns * 1e-9)
        return future.result(timeout=60)

    return asked


@pytest.fixture
def cart(make):
    """`cart_sdf` as a description."""
    return lambda wheels, plugin, **more: make.sdf(cart_sdf(wheels, plugin, **more))
