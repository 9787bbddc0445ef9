"""Which controllers can start and stop, without a simulation."""

from types import SimpleNamespace

import pytest

from cartwheel.codes import running
from cartwheel.dialects.ros_control.chaining import Reference
from cartwheel.dialects.ros_control.switching import plan_switch, update_order, with_leaders
from cartwheel.errors import GraphError


def controller(name, *joints, leads=None, runs=False):
    """A controller of some joints, or of a reference of another controller."""
    claims = dict.fromkeys(joints)
    made = SimpleNamespace(name=name, claims=claims, running=runs, references=[])
    if leads is not None:
        reference = Reference.__new__(Reference)
        reference.owner = leads.name
        leads.references.append(reference)
        claims[f"{leads.name}/joint"] = reference
    return made


def by_name(*controllers):
    return {each.name: each for each in controllers}


def planned(controllers, start=(), stop=(), report=None):
    switch = plan_switch(
        controllers, update_order(controllers), start=start, stop=stop, report=report
    )
    return [[each.name for each in part] for part in (switch.stopping, switch.starting)]


def test_controllers_are_updated_before_those_that_they_command():
    low = controller("low", "joint")
    middle = controller("middle", leads=low)
    top = controller("top", leads=middle)
    order = update_order(by_name(low, top, middle))
    assert [each.name for each in order] == ["top", "middle", "low"]


def test_running_controllers_stop_with_those_that_they_command():
    low = controller("low", "joint", runs=True)
    middle = controller("middle", leads=low, runs=True)
    top = controller("top", leads=middle, runs=True)
    order = update_order(by_name(low, middle, top))
    assert with_leaders(order, ["low"]) == ["low", "middle", "top"]
    top.running = False
    assert with_leaders(order, ["low"]) == ["low", "middle"]


def test_a_joint_has_one_controller():
    controllers = by_name(controller("one", "joint", runs=True), controller("two", "joint"))
    assert planned(controllers, start=["two"], stop=["one"]) == [["one"], ["two"]]
    with pytest.raises(GraphError) as caught:
        planned(controllers, start=["two"])
    assert caught.value.code is running.CONTROLLER_CONFLICT
    assert caught.value.values == {"controller": "two", "by": "one"}


def test_other_controllers_are_switched_if_conflicts_are_reported():
    controllers = by_name(
        controller("one", "joint", runs=True),
        controller("two", "joint"),
        controller("three", "other"),
    )
    reported = []
    plan = planned(controllers, start=["two", "three"], report=reported.append)
    assert plan == [[], ["three"]]
    assert [error.values["controller"] for error in reported] == ["two"]


def test_a_controller_starts_only_with_the_controller_that_it_commands():
    low = controller("low", "joint")
    controllers = by_name(low, controller("top", leads=low))
    with pytest.raises(GraphError) as caught:
        planned(controllers, start=["top"])
    assert caught.value.values == {"controller": "top", "by": "low"}
    assert planned(controllers, start=["top", "low"]) == [[], ["top", "low"]]
    # After a reload, the controller has new references.
    low.references = []
    with pytest.raises(GraphError):
        planned(controllers, start=["top", "low"])
