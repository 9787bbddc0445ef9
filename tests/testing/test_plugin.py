"""The plugin in runs of pytest of its own."""

from __future__ import annotations

import math
import os
import subprocess
import sys
import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
from tests import launching

from cartwheel.msgs.nav_msgs import Odometry
from cartwheel.msgs.sensor_msgs import Image, LaserScan
from cartwheel.msgs.tf2_msgs import TFMessage
from cartwheel.testing.summary import summary

SEEDS = """
import pytest

@pytest.mark.parametrize("seed", [4, 5])
def test_parameter(world, seed):
    assert world.session.simulation.engine.seed == seed

@pytest.mark.seed(3)
@pytest.mark.parametrize("seed", ["a", 6])
def test_mark(world, seed):
    assert world.session.simulation.engine.seed == 3

@pytest.mark.parametrize("seed", [True, 2.0, None])
def test_something_else(world, seed):
    assert world.session.simulation.engine.seed == 0
"""
PASSING = """
import pytest

@pytest.mark.robot("rosbots.xacro", name="cart", x=1.0)
@pytest.mark.world("walls")
@pytest.mark.seed(3)
def test_marks(robot, world):
    assert robot.name == "cart" and robot.pose.x == pytest.approx(1.0)
    assert "wall_south_1" in world.models

@pytest.mark.cartwheel(world="walls", robots=["rosbots.xacro", {"robot": "object.urdf", "x": 3}])
def test_one_mark(robot, world):
    assert robot.name == "rosbots" and world.models[-1] == "my_object"

def test_empty(world):
    assert world.models == ("ground_plane",)
"""
FAILING = """
import pytest
from cartwheel.testing import reaches

@pytest.mark.robot("rosbots.xacro")
@pytest.mark.parametrize("speed", [0.2])
def test_fails(robot, speed):
    robot.publish("/part2_cmr/cmd_vel", linear_x=speed)
    reaches(robot, (5, 0), timeout=1)
"""
Run = Callable[..., subprocess.CompletedProcess[str]]


@pytest.fixture
def pytester_run(tmp_path: Path) -> Run:
    """Writes a test file and runs pytest in its folder."""

    def run(
        text: str, *arguments: str, ini: str = "", start: Any = launching
    ) -> subprocess.CompletedProcess[str]:
        (tmp_path / "test_it.py").write_text(textwrap.dedent(text))
        (tmp_path / "pytest.ini").write_text(f"[pytest]\naddopts = --strict-markers\n{ini}\n")
        environment = {**os.environ, "PYTEST_ADDOPTS": "", "COLUMNS": "200"}
        return start.run(
            [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", *arguments],
            cwd=tmp_path,
            env=environment,
            capture_output=True,
            text=True,
            timeout=300,
            check=False,
        )

    return run


def test_marks_select_world_robots_and_seed(pytester_run):
    done = pytester_run(PASSING)
    assert done.returncode == 0, done.stdout
    assert "3 passed" in done.stdout


def test_a_parameter_is_the_seed(pytester_run):
    done = pytester_run(SEEDS)
    assert "7 passed" in done.stdout, done.stdout


def test_a_summary_of_a_message() -> None:
    scan = LaserScan(ranges=[math.inf, *range(10)], intensities=[1, 2.5], range_max=0.1)
    found = summary(scan)
    assert "ranges: 11 numbers, 0 to 9" in found and "intensities: [1, 2.5]" in found
    assert "range_max: 0.1" in found and not any("header" in each for each in found)
    nothing = summary(LaserScan(ranges=[math.inf] * 11))
    assert "ranges: 11 numbers, none of them finite" in nothing
    odometry = Odometry(child_frame_id="x" * 300)
    odometry.pose.pose.position.x = 1.25
    text = "\n".join(summary(odometry))
    assert "    position: x 1.25, y 0, z 0" in text and "covariance" not in text
    assert "(300 characters)" in text
    assert summary(Image(data=np.zeros(20, np.uint8)))[-1] == "data: 20 numbers, 0 to 0"
    assert summary(TFMessage()) == ["transforms: 0 x geometry_msgs/msg/TransformStamped"]


def test_ini_and_options_name_a_robot(pytester_run):
    test = "def test_it(robot, world):\n    assert ('post' in world.models) is {}\n"
    ini = "cartwheel_robot = rosbots.xacro\ncartwheel_world = post"
    assert pytester_run(test.format(True), ini=ini).returncode == 0
    assert pytester_run(test.format(False), "--cartwheel-robot=rosbots.xacro").returncode == 0


def test_files_beside_the_test_are_found(pytester_run, tmp_path):
    (tmp_path / "my.urdf").write_text(
        '<robot name="mine"><link name="base"><inertial><mass value="1"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>'
    )
    done = pytester_run(
        'import pytest\n@pytest.mark.robot("my.urdf")\ndef test_it(robot):\n'
        '    assert robot.name == "mine"\n',
        "--rootdir=/",
    )
    assert done.returncode == 0, done.stdout


def test_a_failed_test_has_a_report_and_artifacts(pytester_run, tmp_path):
    done = pytester_run(FAILING, "--cartwheel-artifacts=out", "--junit-xml=junit.xml")
    assert done.returncode == 1
    for text in (
        "cartwheel: world", "cartwheel: last messages", "cartwheel: artifacts", "/odom at 1.000",
        "test_it.py::test_fails[0.2]", "--cartwheel-view",
    ):  # fmt: skip
        assert text in done.stdout
    # A text that is published once is not shown, and each error is reported once.
    assert "/robot_description at" not in done.stdout and "<?xml" not in done.stdout
    (recording,) = (tmp_path / "out").glob("*.mcap")
    (picture,) = (tmp_path / "out").glob("*.png")
    properties = ElementTree.parse(tmp_path / "junit.xml").iter("property")
    assert {each.get("name"): each.get("value") for each in properties} == {
        "cartwheel_recording": str(recording), "cartwheel_picture": str(picture),
    }  # fmt: skip
    assert "linear_acceleration: x " in done.stdout and "covariance" not in done.stdout
    assert "name: [wheel_right_joint, wheel_left_joint]" in done.stdout
    assert picture.stat().st_size > 1000 and (tmp_path / "out/.gitignore").exists()
    info = launching.run(
        [sys.executable, "-m", "cartwheel", "info", str(recording)],
        capture_output=True, text=True, check=True,
    )  # fmt: skip
    for topic in ("/odom", "/robot_description", "/tf_static"):
        assert topic in info.stdout


OWN_WORLDS = """
import sys
import time
import pytest
import cartwheel as cw
from cartwheel.testing import launch

@pytest.fixture(scope="module")
def driven():
    with cw.World("empty") as world:
        cart = world.spawn("rosbots.xacro", name="driven")
        cart.publish("/part2_cmr/cmd_vel", linear_x=0.2)
        world.run(0.3)
        yield world

@pytest.fixture
def program():
    code = "import time; print('no map', flush=True); time.sleep(60)"
    with launch([sys.executable, "-S", "-c", code]) as program:
        while not program.output:
            time.sleep(0.01)
        yield program

def test_program(program):
    raise ValueError

def test_closed():
    with cw.World("post") as world:
        world.spawn("rosbots.xacro", name="cart")
        world.run(0.5)
        assert world.models == ()

def test_many():
    built = cw.build("empty", ["rosbots.xacro"])
    worlds = [built.world(seed=seed) for seed in range(9)]
    assert not worlds

def test_shared(driven):
    assert driven.time == 0

def test_without():
    assert cw.build("empty") is None

def test_shared_again(driven):
    driven.run(0.1)
    driven.close()
    assert driven.time == 0
"""


def test_worlds_that_a_test_makes_are_reported_too(pytester_run, tmp_path):
    done = pytester_run(OWN_WORLDS, "--cartwheel-artifacts=out")
    assert "6 failed" in done.stdout, done.stdout
    _, *reports = done.stdout.partition("short test summary")[0].split("____ test_")
    program, closed, many, shared, without, again = reports
    assert "cartwheel: program" in program and "  no map" in program
    for text in ("cart: x 0.000", "/odom at 0.500", "recording: ", "test_it.py_test_closed.png"):
        assert text in closed
    # Those that were made last; without a run, there is nothing to show.
    assert many.count("cartwheel: world (world ") == 3 and "(world 3 of 3)" in many
    assert ".mcap" not in many
    assert "driven: x 0.0" in shared and "/odom at 0.300" in shared and "test_shared.mcap" in shared
    assert "cartwheel: " not in without
    assert "time: 0.400 s" in again
    recordings = list((tmp_path / "out").glob("*.mcap"))
    pictures = list((tmp_path / "out").glob("*.png"))
    assert len(recordings) >= 2 and len(pictures) == 3
    assert all(each.stat().st_size > 1000 for each in recordings + pictures)


def test_worlds_of_tests_are_freed_after_them(pytester_run):
    done = pytester_run(
        """
        import gc
        import weakref

        import cartwheel as cw
        from cartwheel.batch import Batch

        alive = []

        def test_it():
            world = cw.World("empty")
            world.run(0.1)
            closed = cw.World("empty")
            closed.close()
            alive.extend(map(weakref.ref, (world, closed)))

        def test_after():
            gc.collect()
            assert [each() for each in alive] == [None, None]

        def test_a_batch():
            built = cw.build("empty", "rosbots.xacro")
            with Batch(built, 1, act={}, obs={"/odom": "pose.pose.position.x"}, workers=0) as batch:
                assert "/robot_description" not in batch.world(0).topics
        """
    )
    assert done.returncode == 0, done.stdout


def test_the_recording_contains_the_last_seconds(pytester_run, tmp_path):
    from cartwheel.bridges.recording.opening import open_recording
    from cartwheel.bridges.recording.reading import span_of

    spans = {}
    for seconds in ("0.5", "all"):
        pytester_run(FAILING, "--cartwheel-artifacts=out", f"--cartwheel-record={seconds}")
        (file,) = (tmp_path / "out").glob("*.mcap")
        recording = open_recording(file)
        begin, end = span_of(recording) or (0, 0)
        spans[seconds] = (end - begin) / 1e9
        recording.close()
    # Messages are published at 100 Hz.
    assert spans["0.5"] == pytest.approx(0.5, abs=0.03)
    assert spans["all"] == pytest.approx(1.0, abs=0.03)


def test_nothing_is_recorded_when_off(pytester_run, tmp_path):
    done = pytester_run(FAILING, "--cartwheel-artifacts=out", "--cartwheel-record=off")
    assert done.returncode == 1 and not list((tmp_path / "out").glob("*.mcap"))


def test_it_works_with_xdist(pytester_run, tmp_path):
    done = pytester_run(PASSING + FAILING, "-n", "1", "--cartwheel-artifacts=out")
    assert "1 failed, 3 passed" in done.stdout
    assert "cartwheel: artifacts" in done.stdout
    assert len(list((tmp_path / "out").glob("*.mcap"))) == 1


def test_view_is_refused_with_xdist(pytester_run):
    assert pytester_run(PASSING, "-n", "2", "--cartwheel-view").returncode == 4


def test_view_shows_the_world_in_real_time(pytester_run):
    done = pytester_run(
        """
        import time, urllib.request
        import pytest

        @pytest.mark.robot("rosbots.xacro")
        def test_it(robot, world):
            begin = time.monotonic()
            world.run(seconds=1)
            assert time.monotonic() - begin > 0.9
            assert urllib.request.urlopen(world.show(), timeout=60).status == 200
        """,
        "--cartwheel-view",
    )
    assert done.returncode == 0, done.stdout
    assert "test_it.py::test_it: http://" in done.stdout


def test_a_test_without_a_robot_is_an_error(pytester_run):
    done = pytester_run("def test_it(robot): pass")
    assert done.returncode == 1 and "1 error" in done.stdout


def test_a_world_is_built_once_and_closed_after_each_test(pytester_run):
    done = pytester_run(
        """
        import pytest
        from cartwheel.testing import bench

        worlds, calls = [], []
        original = bench.build

        @pytest.fixture(autouse=True, scope="module")
        def counting():
            bench.build = lambda *a, **k: calls.append(1) or original(*a, **k)
            yield
            bench.build = original

        @pytest.mark.parametrize("number", range(3))
        @pytest.mark.robot("rosbots.xacro")
        def test_it(robot, world, number):
            worlds.append(world)
            assert number == 1

        def test_after():
            assert len(calls) == 1 and len(worlds) == 3
            assert all(each.session.simulation.closed for each in worlds)
        """
    )
    assert "2 failed, 2 passed" in done.stdout, done.stdout


def test_other_runs_import_nothing_of_the_simulation(pytester_run):
    done = pytester_run(
        """
        import sys

        def test_it():
            heavy = {"numpy", "mujoco", "cartwheel.api", "cartwheel.testing.witnesses", "yaml"}
            assert not heavy & set(sys.modules)
        """,
        start=subprocess,
    )
    assert done.returncode == 0, done.stdout


def test_fixtures_of_a_project_replace_those_of_the_plugin(pytester_run):
    done = pytester_run(
        """
        import pytest

        @pytest.fixture
        def world():
            return "mine"

        def test_it(world):
            assert world == "mine"
            assert 0
        """
    )
    assert "cartwheel:" not in done.stdout and done.returncode == 1


@pytest.mark.wording
def test_a_condition_that_is_not_met_shows_the_test_and_not_cartwheel(pytester_run):
    done = pytester_run(
        """
        def test_it(world):
            world.run_until(lambda: world.time > 5, timeout=0.1)

        def test_topic(world):
            world.topic("/nothing", "std_msgs/msg/Empty").wait(timeout=0.1)

        def test_misuse(world):
            world.on(0.05, lambda: world.publish("/clock", clok=3))  # my mistake
            world.run(0.1)
        """
    )
    assert done.returncode == 1 and "3 failed" in done.stdout
    assert "# my mistake" in done.stdout and "src/cartwheel" not in done.stdout
    assert "within 0.1 s" in done.stdout
    for part in ("timing.py", "topics.py", "def run_until", "def wait"):
        assert part not in done.stdout, done.stdout


def test_an_error_in_a_callback_shows_the_test_and_not_cartwheel(pytester_run):
    done = pytester_run(
        """
        import json

        def test_callback(world):
            def check(message):
                json.loads("{")  # my mistake

            world.subscribe("/clock", check)
            world.run(0.1)
        """
    )
    assert done.returncode == 1 and "# my mistake" in done.stdout
    assert "world.run(0.1)" in done.stdout and "JSONDecodeError" in done.stdout
    assert "src/cartwheel" not in done.stdout, done.stdout


def test_an_error_in_a_library_that_cartwheel_calls_shows_cartwheel(pytester_run):
    done = pytester_run(
        """
        import json

        def test_it(world):
            world.subscribe("/clock", json.loads)
            world.run(0.1)
        """
    )
    assert done.returncode == 1 and "TypeError" in done.stdout
    assert "messaging.py" in done.stdout


def test_the_fixture_of_the_page(pytester_run):
    """A state that is made once for a module."""
    page = (Path(__file__).parents[2] / "docs/testing.md").read_text()
    (text,) = (
        block.partition("```")[0]
        for block in page.split("```python\n")[1:]
        if "def under_way" in block.partition("```")[0]
    )
    done = pytester_run(text)
    assert done.returncode == 0 and "1 passed" in done.stdout, done.stdout


@pytest.mark.wording
def test_an_unknown_option_of_a_mark_is_an_error(pytester_run):
    done = pytester_run(
        'import pytest\n@pytest.mark.cartwheel(worl="walls")\ndef test_it(world): pass'
    )
    assert done.returncode == 1 and '"worl"' in done.stdout and '"world"' in done.stdout


def test_a_wrong_mark_shows_only_the_error(pytester_run):
    marks = ('robot("no_such.urdf")', 'world("no_such")', "seed(-1)", "cartwheel(strikt=True)")
    tests = [f"@pytest.mark.{mark}\ndef test_it(world): pass\n" for mark in marks]
    tests = [each.replace("test_it", f"test_{index}") for index, each in enumerate(tests)]
    done = pytester_run("import pytest\n" + "".join(tests))
    assert done.returncode == 1 and "4 errors" in done.stdout
    _, *errors = done.stdout.partition("short test summary")[0].split("ERROR at setup of test_")
    assert len(errors) == len(marks) and all("CW" in each for each in errors)
    assert "bench.py" not in done.stdout and "Traceback" not in done.stdout
    assert all(len(each.splitlines()) < 20 for each in errors)
    assert "another exception" not in done.stdout
