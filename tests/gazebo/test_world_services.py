"""New Gazebo's services of a world, as ros_gz_bridge brings them to ROS 2."""

import math

import pytest
from tests.coded import coded
from tests.gazebo.conftest import CHAIN, SDF, Gazebo

import cartwheel as cw
from cartwheel.codes.graph import (
    ENTITY_NAME_TAKEN,
    ENTITY_UNKNOWN,
    REQUEST_INVALID,
    REQUEST_UNSUPPORTED,
    SERVICE_FAILED,
)
from cartwheel.codes.world import UNKNOWN_MODEL
from cartwheel.description.model import WorldDescription
from cartwheel.gazebo.ros2_api import Ros2Api
from cartwheel.geometry import Pose
from cartwheel.simulation import RunState

LAMP = (
    """<sdf version="1.6"><light name="lamp" type="point"><pose>0 0 9 0 0 0</pose></light></sdf>"""
)
UPRIGHT = {"w": 1.0}


def services(world: cw.World) -> Gazebo:
    return Gazebo(world, api=Ros2Api, prefix="/world/test")


def test_models_and_lights_are_created_moved_and_removed(make):
    api = services(make.world(ground=None, gravity=0.0))
    simulation = api.simulation

    def create(**fields) -> bool:
        return api("create", entity_factory=fields).success

    # The request's pose is the model's, not one upon that of the file, which is 0.5 m up.
    where = {"position": {"x": 2.0, "z": 0.25}, "orientation": UPRIGHT}
    assert create(sdf=SDF, pose=where)
    assert simulation.pose("brick").position == pytest.approx((2.0, 0.0, 0.25))
    taken = {"name": "brick", "free": "brick_1"}
    api.fails("create", ENTITY_NAME_TAKEN, taken, entity_factory={"sdf": SDF, "pose": where})
    assert create(sdf=SDF, pose={"position": {"y": 3.0}}, allow_renaming=True)
    assert create(name="copy", clone_name="brick", relative_to="brick", pose={"position": {"z": 1}})
    assert simulation.models == ("brick", "brick_1", "copy")
    assert simulation.pose("copy").position == pytest.approx((2.0, 0.0, 1.25))
    assert create(name="cone", sdf_filename="traffic_cone", pose={"position": {"x": 9.0}})
    api.fails("create", REQUEST_INVALID, entity_factory={"name": "none"})
    both = {"name": "both", "sdf": SDF, "clone_name": "brick"}
    api.fails("create", REQUEST_INVALID, entity_factory=both)
    unknown = {"name": "bricks", "meant": "brick"}
    api.fails("create", ENTITY_UNKNOWN, unknown, entity_factory={"clone_name": "bricks"})
    assert create(sdf=LAMP, pose={"position": {"z": 2.0}})
    assert [(each.name, each.pose.z) for each in simulation.world.lights] == [("lamp", 2.0)]

    simulation.set_state("brick", Pose(), linear=(0.5, 0.0, 0.0))
    turned = {"position": {"x": 7.0}, "orientation": {"z": 1.0, "w": 0.0}}
    assert api("set_pose", entity={"name": "brick", "type": 2}, pose=turned).success
    assert simulation.pose("brick").yaw == pytest.approx(math.pi)
    simulation.advance(100_000_000)
    simulation.refresh()
    # It goes on as it went.
    assert simulation.pose("brick").x == pytest.approx(7.05, abs=1e-6)
    api.fails("set_pose", ENTITY_UNKNOWN, unknown, entity={"name": "bricks"}, pose=turned)
    kind = {"name": "brick", "type": 3}
    api.fails("set_pose", REQUEST_UNSUPPORTED, {"type": 3}, entity=kind, pose=turned)

    api.fails("remove", UNKNOWN_MODEL, {"name": "lamp"}, entity={"name": "lamp", "type": 2})
    assert api("remove", entity={"name": "lamp"}).success
    api.fails("remove", ENTITY_UNKNOWN, {"name": "lamp"}, entity={"name": "lamp", "type": 1})
    assert api("remove", entity={"name": "copy", "type": 2}).success
    assert "copy" not in simulation.models


def test_control_holds_steps_and_resets(make):
    api = services(make.world(make.sdf(CHAIN), gravity=0.0))
    simulation = api.simulation
    step_s = simulation.step_ns / 1e9

    def control(**fields) -> bool:
        return api("control", world_control=fields).success

    assert control(pause=True)
    assert simulation.run_state is RunState.PAUSED
    assert control(pause=True, multi_step=3)
    api.world.run(10 * step_s)
    assert simulation.current_step == 3
    assert control(pause=True, step=True)
    api.world.run(10 * step_s)
    assert simulation.current_step == 4
    until = 20 * simulation.step_ns
    assert control(run_to_sim_time={"nanosec": until})
    api.world.run(50 * step_s)
    assert (simulation.time_ns, simulation.run_state) == (until, RunState.PAUSED)

    before = simulation.pose("chain")
    simulation.set_pose("chain", Pose((5, 5, 5)))
    assert control(pause=True, reset={"model_only": True})
    assert (simulation.pose("chain"), simulation.time_ns) == (before, until)
    assert not control(pause=True, reset={"time_only": True})
    assert simulation.time_ns == until
    assert control(reset={"all": True}, seed=4)
    assert (simulation.time_ns, simulation.run_state) == (0, RunState.RUNNING)
    assert coded(api.world.diagnostics, SERVICE_FAILED, field="seed")


def test_a_name_that_ros_does_not_take_is_spelled_so_that_it_does():
    for name, spelled in (("my small-house", "my_small_house"), ("3d", "_3d"), ("a", "a")):
        with cw.World(WorldDescription(name=name)) as world:
            api = Gazebo(world, api=Ros2Api, prefix=f"/world/{spelled}")
            assert api("control", world_control={"pause": True}).success
