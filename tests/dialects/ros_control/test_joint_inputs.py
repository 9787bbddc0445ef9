"""Positions by hand: whatever controller has the joint, it goes there."""

import pytest
from tests.dialects.ros_control.arms import ROS1, beam, robot, transmission

GOAL = 0.4
PID = {"p": 800.0, "d": 80.0}
UPRIGHT = {"axis": "0 0 1"}
"""A joint about which nothing weighs."""


def one(interface):
    return robot(beam("beam", "world", **UPRIGHT) + transmission("beam_joint", interface), ROS1)


@pytest.mark.parametrize(
    ("interface", "parameters"),
    [
        ("Position", {"type": "position_controllers/JointPositionController"}),
        ("Effort", {"type": "effort_controllers/JointPositionController", "pid": PID}),
        (
            "Position",
            {"type": "position_controllers/JointGroupPositionController", "joints": ["beam_joint"]},
        ),
        (
            "Effort",
            {
                "type": "effort_controllers/JointGroupPositionController",
                "joints": ["beam_joint"],
                "beam_joint": {"pid": PID},
            },
        ),
        (
            "Position",
            {"type": "position_controllers/JointTrajectoryController", "joints": ["beam_joint"]},
        ),
        ("Position", {"type": "position_controllers/GripperActionController"}),
    ],
    ids=lambda value: value["type"] if isinstance(value, dict) else value,
)
def test_a_joint_goes_where_it_is_put(bench, interface, parameters):
    made = bench(one(interface), {"c": {"joint": "beam_joint", **parameters}})
    made.world.run(0.1)
    (taker,) = made.world.graph.joint_inputs.all()
    assert (taker.model, taker.owner, taker.joints) == ("arm", "c", ("beam_joint",))
    taker.put({"beam_joint": GOAL}, 0.5)
    made.world.run(3.0)
    assert made.position("beam_joint") == pytest.approx(GOAL, abs=0.01)


@pytest.mark.parametrize("kind", ["velocity", "effort"])
def test_what_takes_no_positions_is_not_offered(bench, kind):
    type_name = f"{kind}_controllers/Joint{kind.capitalize()}Controller"
    made = bench(one(kind.capitalize()), {"c": {"type": type_name, "joint": "beam_joint"}})
    made.world.run(0.1)
    assert made.world.graph.joint_inputs.all() == ()


def test_it_is_offered_while_the_controller_runs_and_every_change_is_published(bench):
    parameters = {"type": "position_controllers/JointPositionController", "joint": "beam_joint"}
    made = bench(one("Position"), {"c": parameters})
    graph = made.world.graph
    made.world.run(0.1)
    before = graph.changed
    switch = {"strictness": 2, "start_asap": False, "timeout": 0.0}
    made.call(
        "/controller_manager/switch_controller",
        start_controllers=[], stop_controllers=["c"], **switch,
    )  # fmt: skip
    made.world.run(0.1)
    assert graph.joint_inputs.all() == ()
    assert graph.changed > before
    made.call(
        "/controller_manager/switch_controller",
        start_controllers=["c"], stop_controllers=[], **switch,
    )  # fmt: skip
    made.world.run(0.1)
    assert len(graph.joint_inputs.all()) == 1
    made.model.delete()
    assert graph.joint_inputs.all() == ()
