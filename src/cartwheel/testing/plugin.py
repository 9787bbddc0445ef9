"""The plugin for pytest: fixtures, marks and options.

pytest imports this module in each run in which Cartwheel is installed, so it imports nothing of the
simulation.
"""

from __future__ import annotations

import sysconfig
from collections.abc import Generator, Iterator
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, Any

import pytest

from cartwheel.errors import CartwheelError
from cartwheel.watchers import watch

if TYPE_CHECKING:
    from cartwheel.api import Model, World
    from cartwheel.testing.bench import Bench
    from cartwheel.testing.witnesses import Witnesses

_MARKS = (
    "world(name, **options): the world of the fixture `world`: a bundled world or a file. The "
    "options are those of cartwheel.build.",
    "robot(file, **options): a robot in the fixture `world`. The options are those of World.spawn. "
    "The fixture `robot` is the first one.",
    "seed(number): the seed of the fixture `world`.",
    "cartwheel(world=, robot=, seed=, record=, **options): world, robots and seed in one mark. "
    "`record` selects topics, such as `record='/odom'`.",
)
_SOURCE = Path(__file__).parents[1]
_LIBRARIES = frozenset({"site-packages", "dist-packages"})
_BENCH: pytest.StashKey[Bench] = pytest.StashKey()
_ITEM: pytest.StashKey[pytest.Item | None] = pytest.StashKey()
"""The current test."""
_WITNESSES: pytest.StashKey[Witnesses] = pytest.StashKey()


def pytest_addoption(parser: pytest.Parser) -> None:
    """Adds the options."""
    group = parser.getgroup("cartwheel")
    group.addoption(
        "--cartwheel-view",
        action="store_true",
        help="show the world of each test in the browser, in real time",
    )
    group.addoption(
        "--cartwheel-artifacts",
        metavar="DIR",
        help="folder for recordings and pictures of failed tests (default: cartwheel-failures)",
    )
    group.addoption(
        "--cartwheel-record",
        metavar="SECONDS|all|off",
        help="what the recording of a failed test contains: the last seconds (default: 10)",
    )
    group.addoption(
        "--cartwheel-robot", metavar="FILE", help="robot of tests without a mark `robot`"
    )
    parser.addini("cartwheel_robot", "robot of tests without a mark `robot`")
    parser.addini("cartwheel_world", "world of tests without a mark `world`", default="empty")
    parser.addini("cartwheel_artifacts", "folder for recordings and pictures of failed tests")
    parser.addini("cartwheel_record", "as --cartwheel-record", default="10")


def pytest_configure(config: pytest.Config) -> None:
    """Registers the marks."""
    for mark in _MARKS:
        config.addinivalue_line("markers", mark)
    if config.option.cartwheel_view and getattr(config.option, "numprocesses", None):
        raise pytest.UsageError("--cartwheel-view cannot be used with -n")


def pytest_sessionstart(session: pytest.Session) -> None:
    """Records each world that a test makes, and each program that it starts, from now on."""
    config = session.config
    config.add_cleanup(watch(lambda made: _witnesses(config).note(made)))


def _witnesses(config: pytest.Config) -> Witnesses:
    """Records the worlds of tests; made for the first of them."""
    if _WITNESSES not in config.stash:
        from cartwheel.testing.witnesses import Witnesses

        config.stash[_WITNESSES] = Witnesses(config)
        item = config.stash.get(_ITEM, None)
        if item is not None:
            config.stash[_WITNESSES].begin(item)
    return config.stash[_WITNESSES]


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Generator[None, Any, None]:
    """Assigns the worlds that are made during a test to it."""
    stash = item.config.stash
    stash[_ITEM] = item
    if _WITNESSES in stash:
        stash[_WITNESSES].begin(item)
    try:
        yield
    finally:
        stash[_ITEM] = None
        if _WITNESSES in stash:
            stash[_WITNESSES].end()


@pytest.fixture
def world(request: pytest.FixtureRequest) -> Iterator[World]:
    """A world for the test, made from files that were read once. It is closed after the test."""
    from cartwheel.testing.bench import Bench

    bench: Bench | None = None
    wrong = ""
    try:
        bench = Bench(request, _witnesses(request.config))
    except CartwheelError as error:
        wrong = f"{error.code.number}: {error}"
    if bench is None:
        # The mark or the file is wrong, so the source of Cartwheel does not help. Within the block
        # above, pytest would show both errors.
        pytest.fail(wrong, pytrace=False)
    request.node.stash[_BENCH] = bench
    try:
        yield bench.world
    finally:
        bench.close()


@pytest.fixture
def robot(request: pytest.FixtureRequest, world: World) -> Model:  # noqa: ARG001 - it is made first
    """The first robot of the marks, or the robot of the option or ini file."""
    bench: Bench = request.node.stash[_BENCH]
    missing = bench.missing_robot
    if missing is not None:
        pytest.fail(f"{missing.code.number}: {missing}", pytrace=False)
    return bench.robot


@pytest.hookimpl(hookwrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[Any]
) -> Generator[None, Any, None]:
    """Adds what is known about the worlds of a failed test to its report.

    An error of Cartwheel, or of a function of the test that Cartwheel has called, shows the lines
    of the test, but not those of Cartwheel.
    """
    excinfo = call.excinfo
    if (
        excinfo is None
        or not (isinstance(excinfo.value, CartwheelError) or _is_of_callback(excinfo.value))
        or item.config.getoption("fulltrace")
    ):
        outcome = yield
    else:
        error, whole = excinfo.value, excinfo.value.__traceback__
        trace = _own(whole)
        if trace is not None:
            error = error.with_traceback(trace)
            call.excinfo = pytest.ExceptionInfo.from_exc_info((type(error), error, trace))
        outcome = yield
        call.excinfo, error.__traceback__ = excinfo, whole
    witnesses = item.config.stash.get(_WITNESSES, None)
    if witnesses is not None and call.excinfo is not None and call.when != "teardown":
        report = outcome.get_result()
        if report.failed:
            witnesses.complete(report, item)


def _is_of_callback(error: BaseException) -> bool:
    """Whether a function of the test that Cartwheel has called raised an error."""
    after: Path | None = None
    entry = error.__traceback__
    while entry is not None:
        file = Path(entry.tb_frame.f_code.co_filename)
        if _SOURCE in file.parents:
            after = _SOURCE
        elif after is _SOURCE:
            after = file
        entry = entry.tb_next
    if after is None or after is _SOURCE or not after.is_absolute():
        return False
    # Libraries that Cartwheel itself calls are no functions of the test.
    library = Path(sysconfig.get_paths()["stdlib"])
    return library not in after.parents and _LIBRARIES.isdisjoint(after.parts)


def _own(trace: TracebackType | None) -> TracebackType | None:
    """A traceback without the frames of Cartwheel; the same one if it has no others."""
    entries = []
    entry = trace
    while entry is not None:
        if _SOURCE not in Path(entry.tb_frame.f_code.co_filename).parents:
            entries.append(entry)
        entry = entry.tb_next
    made: TracebackType | None = None
    for each in reversed(entries):
        made = TracebackType(made, each.tb_frame, each.tb_lasti, each.tb_lineno)
    return made or trace
