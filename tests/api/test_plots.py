"""Numbers of topics over time, and their plots."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest
from tests.coded import raises

import cartwheel as cw
from cartwheel.codes.command import OPTION_INVALID
from cartwheel.codes.graph import FIELD_UNKNOWN
from cartwheel.codes.wires import PACKAGE_MISSING

TWIST = "/part2_cmr/cmd_vel"


@pytest.fixture
def driven() -> cw.Topic:
    with cw.World("empty") as world:
        cart = world.spawn("rosbots.xacro")
        odometry = world.topic("/odom")
        cart.publish(TWIST, linear_x=0.5)
        world.run(2.0)
        return odometry


def test_values_are_those_of_the_messages(driven: cw.Topic) -> None:
    x = driven.values("pose.pose.position.x")
    assert x.tolist() == [message.pose.pose.position.x for message in driven.history()]
    assert x[-1] == pytest.approx(0.875, abs=0.01)
    assert driven.values("header.stamp") == pytest.approx(driven.times())
    assert driven.values("pose.covariance[35]", size=3).shape == (3,)
    assert driven.values("pose.covariance[::7]").shape == (len(driven.history()), 6)


@pytest.mark.parametrize(
    "field",
    ["pose.pose.position.q", "pose", "header.frame_id", "pose.pose.position.x[0]", "", "a..b",
     "pose.covariance[36]", "__class__", "pose.__dict__", "header.frame_id[0]"],
)  # fmt: skip
def test_a_field_that_is_no_number_is_refused(driven: cw.Topic, field: str) -> None:
    with raises(FIELD_UNKNOWN, field=field):
        driven.values(field)


def test_arrays_of_numbers(driven: cw.Topic) -> None:
    table = driven.values("pose.covariance")
    assert table.shape == (201, 36)
    assert table[:, 7].tolist() == driven.values("pose.covariance[7]").tolist()
    plot = driven.plot("pose.covariance")
    assert list(plot.series) == [f"pose.covariance[{index}]" for index in range(36)]


def test_a_plot_draws_its_values(driven: cw.Topic, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    plot = driven.plot("pose.pose.position.x", "twist.twist.linear.x")
    (axes,) = plot.figure().axes
    for line, field in zip(axes.lines, plot.series, strict=True):
        assert line.get_ydata().tolist() == driven.values(field).tolist()
        assert line.get_xdata().tolist() == driven.times()
    assert plot._repr_png_().startswith(b"\x89PNG")
    plot.save(tmp_path / "plot.svg")
    assert "<svg" in (tmp_path / "plot.svg").read_text()


def test_a_plot_without_fields_is_refused(driven: cw.Topic) -> None:
    with raises(OPTION_INVALID):
        driven.plot()


def test_without_matplotlib_the_package_is_named(
    driven: cw.Topic, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with raises(PACKAGE_MISSING, extra="notebook"):
        driven.plot("pose.pose.position.x")
