"""One world used by several threads, and by processes that were forked from its own."""

import sys
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from tests import launching

import cartwheel as cw
from cartwheel.simulation.sensing.opengl import ForkedError

_IMAGES = "/rosbots/camera1/image_raw"
_FORK = f"""
import os, sys
import cartwheel as cw

def cart():
    world = cw.World("empty")
    world.spawn("rosbots.xacro", z=0.1)
    return world, world.mailbox("{_IMAGES}", size=1)

def tried(world, images):
    try:
        world.run(0.2)
    except cw.CartwheelError as error:
        return error.code.name
    return bool(images.get().data.std() > 0)

world, images = cart()
"""
_BEFORE = """
assert tried(world, images) is True
child = os.fork()
if not child:
    before = world.time
    for refused in (tried(world, images), tried(*cart())):
        assert refused == "opengl-forked", refused
    # Time goes on, and a world without cameras works.
    assert world.time > before
    other = cw.World("empty")
    other.run(0.5)
    world.close()
    sys.exit(7)
assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
assert tried(world, images) is True
"""
_AFTER = """
child = os.fork()
assert tried(world, images) is True
if not child:
    sys.exit(7)
assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 7
"""
_MULTIPROCESSING = """
import multiprocessing
world = cw.World("empty")
cart = world.spawn("rosbots.xacro", z=0.1)
def drive(speed):
    cart.publish("/part2_cmr/cmd_vel", linear_x=speed)
    world.run(2)
    return cart.pose.x
with multiprocessing.get_context("fork").Pool(2) as pool:
    slow, fast = pool.map_async(drive, [0.2, 0.4]).get(timeout=50)
assert fast > 1.5 * slow > 0.3, (slow, fast)
assert world.time == 0
"""


@pytest.mark.parametrize(
    "script",
    [_FORK + _BEFORE, _FORK + _AFTER, _FORK + _MULTIPROCESSING],
    ids=["after an image", "before any image", "multiprocessing"],
)
def test_a_fork(script):
    done = launching.run(
        [sys.executable, "-c", script], capture_output=True, text=True, timeout=60, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.wording
def test_the_hint_for_a_fork_names_the_way_out():
    assert 'multiprocessing.get_context("spawn")' in ForkedError().hint


def test_images_are_drawn_by_the_thread_that_runs_the_world(make, rosbots):
    world = make.world()
    world.spawn(rosbots, z=0.1)
    images = world.mailbox(_IMAGES, size=1)

    def image():
        world.run(0.2)
        return images.get().data.std()

    with ThreadPoolExecutor(1) as first, ThreadPoolExecutor(1) as second:
        seen = [image(), first.submit(image).result(60), second.submit(image).result(60)]
        seen += [first.submit(image).result(60), image()]
    assert min(seen) > 0
    assert world.time == pytest.approx(1.0)


def test_threads_take_turns(make, rosbots):
    world = make.world()
    cart = world.spawn(rosbots, z=0.1)
    images = world.mailbox(_IMAGES, size=1000)

    def use(count):
        for each in range(count):
            world.run(0.05)
            box = world.spawn(make.box(f"{threading.get_ident()}-{each}", (0.1, 0.1, 0.1)), x=5)
            assert cart.pose.z < 0.2
            box.delete()

    with ThreadPoolExecutor(4) as pool:
        for done in [pool.submit(use, 5) for _ in range(4)]:
            done.result(60)
    assert world.time == pytest.approx(20 * 0.05)
    assert world.models == ("ground_plane", "rosbots")
    assert len(images.drain()) >= 20


def test_an_empty_mailbox_gives_none_where_nothing_can_come(make):
    world = make.world()
    clock = world.mailbox("/clock")
    began = time.monotonic()
    # Each of them would wait.
    assert clock.get() is None
    world.run(0.01)
    assert len(clock.drain()) == 2
    assert clock.get() is None
    assert clock.get(timeout=60) is None
    assert time.monotonic() - began < 30


def test_a_mailbox_waits_for_the_thread_that_runs_the_world(make):
    world = make.world()
    clock = world.mailbox("/clock")
    with ThreadPoolExecutor(1) as pool:
        got = pool.submit(clock.get)
        while not got.running():
            time.sleep(0.001)
        world.run(0.01)
        assert got.result(60).clock.nanosec == 0


def test_a_mailbox_does_not_wait_for_a_thread_that_has_ended(make):
    world = make.world()
    clock = world.mailbox("/clock")
    thread = threading.Thread(target=world.run, args=(0.01,))
    thread.start()
    thread.join()
    assert len(clock.drain()) == 2
    assert clock.get() is None


def test_a_mailbox_wakes_when_its_world_closes(make):
    world = make.world()
    clock = world.mailbox("/clock")
    with ThreadPoolExecutor(1) as pool:
        got = pool.submit(clock.get)
        while not got.running():
            time.sleep(0.001)
        world.close()
        assert got.result(60) is None


def test_worlds_of_several_threads_draw_side_by_side(rosbots):
    def image(_):
        with cw.World("empty") as world:
            world.spawn(rosbots, z=0.1)
            images = world.mailbox(_IMAGES, size=1)
            world.run(0.3)
            return images.get().data.tobytes()

    with ThreadPoolExecutor(3) as pool:
        together = list(pool.map(image, range(3)))
    assert set(together) == {image(0)}


FORKED_CONNECTED = """
import os, sys
import cartwheel as cw

world = cw.World("empty", foxglove=0, record="run.mcap")
world.run(0.1)
child = os.fork()
if child == 0:
    codes = []
    for use in (world.reset, lambda: world.run(0.1), lambda: world.spawn("rosbots.xacro")):
        try:
            use()
        except cw.errors.SimulationError as error:
            codes.append(error.code.number)
    world.close()
    os._exit(0 if codes == ["CW624"] * 3 else 1)
assert os.waitpid(child, 0)[1] == 0
world.run(0.1)
world.close()
print(round(world.time, 3))
"""


def test_a_connected_world_is_refused_in_a_forked_process(tmp_path: Path) -> None:
    done = launching.run(
        [sys.executable, "-c", FORKED_CONNECTED],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=240,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == ["0.2"]
    assert (tmp_path / "run.mcap").stat().st_size > 0
