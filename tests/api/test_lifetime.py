"""What a closed world leaves behind: nothing that waits for Python's collector."""

import gc
import subprocess
import sys
import weakref

import pytest
from tests.coded import raises

import cartwheel as cw
from cartwheel.codes.graph import GRAPH_CLOSED
from cartwheel.codes.world import SIMULATION_CLOSED
from cartwheel.description import load_robot
from cartwheel.errors import SimulationError

_IMAGES = "/rosbots/camera1/image_raw"
_WORLDS = """
import gc
from pathlib import Path
import cartwheel as cw
from cartwheel.description import load_robot

gc.disable()
robot = load_robot("rosbots.xacro")
resident = lambda: int(Path("/proc/self/statm").read_text().split()[1]) * 4096
for count in range(25):
    world = cw.World("empty")
    world.spawn(robot)
    boxes = [world.mailbox(topic.name) for topic in world.graph.topics() if topic.publishers]
    world.run(0.2)
    assert world.models == ("ground_plane", "rosbots")
    world.close()
    del world, boxes
    if count == 4:
        first = resident()
print((resident() - first) / 1e6)
"""


@pytest.fixture
def no_collector():
    """Memory that is freed now is freed because nothing refers to it any more."""
    gc.collect()
    gc.disable()
    yield
    gc.enable()


@pytest.mark.usefixtures("no_collector")
@pytest.mark.parametrize("listening", [False, True])
def test_a_closed_world_is_freed_with_its_last_reference(listening):
    world = cw.World("empty")
    cart = world.spawn("rosbots.xacro", z=0.1)
    boxes = []
    if listening:
        boxes = [world.mailbox(topic.name) for topic in world.graph.topics() if topic.publishers]
        assert _IMAGES in [topic.name for topic in world.graph.topics()]
    cart.publish("/part2_cmr/cmd_vel", linear_x=0.5)
    world.run(0.2)
    simulation = world.session.simulation
    kept = [world, world.session, simulation, simulation.engine, simulation.engine.renderer]
    kept += [world.graph, simulation.model, simulation.data]
    names = [type(each).__name__ for each in kept]
    references = [weakref.ref(each) for each in kept if not type(each).__name__.startswith("Mj")]
    counts = [sys.getrefcount(simulation.model), sys.getrefcount(simulation.data)]
    assert len(names) == 8
    assert min(counts) > 0
    model, data = simulation.model, simulation.data
    world.close()
    del world, cart, simulation, kept
    assert [ref() for ref in references] == [None] * 6
    # MuJoCo's take no weak references: ours is the last one, but for that of the count.
    assert sys.getrefcount(data) == 2
    del data
    assert sys.getrefcount(model) == 2
    # A mailbox may outlive its world; what it holds can still be read.
    assert all(box.closed for box in boxes)


def test_many_worlds_take_no_more_memory_than_a_few():
    done = subprocess.run(
        [sys.executable, "-c", _WORLDS], capture_output=True, text=True, check=True, timeout=60
    )
    # With the cycles it was 100 MB.
    assert float(done.stdout) < 30


def test_a_closed_world_is_read_and_not_run(make):
    world = make.world(make.box("box", (0.2, 0.2, 0.2)))
    world.run(0.1)
    place = world.model("box").pose
    box = world.mailbox("/clock")
    world.close()
    world.close()
    assert world.time == 0.1
    assert world.model("box").pose == place
    assert box.get() is None
    for use in (
        lambda: world.run(0.1),
        lambda: world.spawn("rosbots.xacro"),
        world.reset,
        world.model("box").delete,
    ):
        with raises(SIMULATION_CLOSED, SimulationError):
            use()
    with raises(GRAPH_CLOSED):
        world.graph.publish("/clock", "rosgraph_msgs/msg/Clock", None)
    assert world.time == 0.1


def test_who_waits_for_an_answer_gets_it_from_a_world_that_closes(make):
    world = make.world()
    waiting = world.session.simulation.call(lambda: 7)
    world.close()
    assert waiting.result(timeout=60) == 7
    with raises(SIMULATION_CLOSED, SimulationError):
        world.session.simulation.call(lambda: 7)


def test_a_world_closed_in_a_callback_ends_its_run_first(make):
    world = make.world()
    world.subscribe("/clock", lambda _: world.close())
    world.run(1.0)
    assert world.time < 0.1
    assert world.session.simulation.closed


def test_a_description_that_was_read_leaves_nothing_of_its_parser(no_collector, tmp_path):
    file = tmp_path / "robot.urdf"
    file.write_text('<robot name="r"><link name="base"/></robot>')
    load_robot(file)
    gc.collect()
    gc.set_debug(gc.DEBUG_SAVEALL)
    try:
        load_robot(file)
        gc.collect()
        assert [each for each in gc.garbage if type(each).__name__ == "xmlparser"] == []
    finally:
        gc.set_debug(0)
        gc.garbage.clear()
