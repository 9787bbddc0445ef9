"""A saved world of a robot that others published continues bit for bit."""

import os
from pathlib import Path

import pytest
from tests.golden.adapter import robots_in
from tests.saving.continuing import compare
from tests.saving.journeys import ROBOTS

import cartwheel as cw

CORPUS = Path(os.environ.get("CARTWHEEL_CORPUS", ROBOTS.parents[3] / "shared" / "corpus"))
PACKAGES = (
    sorted(each.name for each in CORPUS.iterdir() if each.is_dir()) if CORPUS.is_dir() else []
)
PARTS = 4
"""Tests of a package, each of a part of its robots."""
TIMES = (0.5, 0.25)
"""Seconds until a world is saved, and after: all commands are given. The slowest sensors do not
publish; `test_robots` looks at these."""
AS_ANOTHER = {"large_model.urdf.xacro"}
"""A chain of 1,200 links, of the same macros as smaller_large_model.urdf.xacro with 40."""

pytestmark = pytest.mark.skipif(not PACKAGES, reason=f"no robots of others in {CORPUS}")


@pytest.fixture(scope="module")
def robots():
    """Found once, and not while tests are collected: that expands all descriptions."""
    return robots_in(CORPUS)


@pytest.mark.parametrize("part", range(PARTS))
@pytest.mark.parametrize("package", PACKAGES or ["none"])
def test_each_robot_of_a_package_continues(package, part, robots, elsewhere):
    of_package = [
        each
        for each in robots
        if each.relative_to(CORPUS).parts[0] == package and each.name not in AS_ANOTHER
    ]
    assert of_package
    left_out, simulated = {}, 0
    for file in of_package[part::PARTS]:
        try:
            left_out[file] = compare(file, elsewhere, TIMES)
            simulated += 1
        except cw.CartwheelError as error:
            error.add_note(f"in {file}")
            if error.code.name in ("state-mismatch", "simulation-diverged"):
                raise
        except AssertionError as error:
            error.add_note(f"in {file}")
            raise
    assert not any(left_out.values()), left_out
    assert simulated or len(of_package) <= PARTS
