"""Sweeps that are refused before any case runs, and results that would hide a parameter."""

from __future__ import annotations

import pytest
from tests.coded import raises
from tests.sweeps.duties import drive

import cartwheel as cw
from cartwheel.codes.world import SWEEP_INVALID


def test_a_world_is_not_what_build_returns(built):
    with built.world() as world, raises(SWEEP_INVALID) as caught:
        cw.sweep(drive, [{"speed": 0.1}], world, jobs=0)
    assert "got a World" in str(caught.value)
    with raises(SWEEP_INVALID) as caught:
        cw.sweep(drive, [{"speed": 0.1}], "empty", jobs=0)
    assert "got 'empty'" in str(caught.value)
    with raises(SWEEP_INVALID) as caught:
        cw.sweep(3, [{"speed": 0.1}], built, jobs=0)
    assert "got 3" in str(caught.value)


def test_a_function_must_be_known_to_other_processes(built):
    with raises(SWEEP_INVALID) as caught:
        cw.sweep(lambda world, case: 1, [{}], built, jobs=2)
    assert "top level of a module" in str(caught.value)
    assert cw.sweep(lambda world, case: 1, [{}], built, jobs=0)[0].values == {"result": 1}


@pytest.mark.parametrize("name", ["speed", "error"])
def test_a_result_does_not_hide_a_parameter(built, name):
    (row,) = cw.sweep(lambda world, case: {name: 3.0}, [{"speed": 0.1}], built, jobs=0)
    assert f'"{name}"' in row.error and row.values == {}


def test_a_result_may_repeat_its_case(built):
    (row,) = cw.sweep(lambda world, case: {**case, "x": 1}, [{"speed": 0.1}], built, jobs=0)
    assert row.flat() == {"speed": 0.1, "x": 1, "error": ""}


def test_a_parameter_cannot_be_the_column_of_errors(built):
    with raises(SWEEP_INVALID) as caught:
        cw.sweep(drive, [{"error": 1}], built, jobs=0)
    assert '"error"' in str(caught.value)
