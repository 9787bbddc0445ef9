"""Worlds that are compiled once are as if made by hand, in every process."""

import copy
import multiprocessing
import pickle
import shutil
import threading
from pathlib import Path

import numpy as np
import pytest
from tests.api.built import drive, drive_pickled
from tests.coded import raises
from tests.devices.cameras.sensors import pixels_of, sensor, take

import cartwheel as cw
from cartwheel.codes.command import OPTION_INVALID, OPTIONS_CONFLICT
from cartwheel.codes.world import MODEL_NAME_TAKEN
from cartwheel.simulation.models import compilations

ROBOT = Path(__file__).parents[2] / "robots" / "rosbots_description"


@pytest.fixture(scope="module")
def noisy(make_once, rosbots):
    """The example cart with a noisy IMU, so that its messages depend on the seed."""
    return make_once.with_parameters(rosbots, "imu_plugin", gaussianNoise="0.1")


@pytest.fixture(scope="module")
def built(noisy):
    return cw.build("empty", {"robot": noisy, "z": 0.05})


@pytest.fixture
def compiled(monkeypatch):
    """The kinds of the compilations so far."""
    kinds = []

    def count(name, original):
        def counted(*arguments, **options):
            kinds.append(name)
            return original(*arguments, **options)

        monkeypatch.setattr(compilations, name, counted)

    count("build", compilations.build)
    count("build_visuals", compilations.build_visuals)
    return kinds


def test_a_world_is_as_if_made_by_hand(built, noisy):
    """To the last bit of its state and messages, images and noise included."""

    class ByHand:
        def world(self, *, seed):
            world = cw.World("empty", seed=seed)
            world.spawn(noisy, z=0.05)
            return world

    for seed in (0, 7):
        assert drive(built, seed) == drive(ByHand(), seed)
    assert drive(built, 0) != drive(built, 7)


def test_nothing_is_read_or_compiled_again(compiled, monkeypatch):
    built = cw.build("empty", "rosbots.xacro")
    assert compiled == ["build"] * 2
    monkeypatch.setattr("cartwheel.description.load_robot", None)
    monkeypatch.setattr("cartwheel.description.load_world", None)
    for _ in range(3):
        with built.world() as world:
            take(world, "/rosbots/camera1/image_raw")
    assert compiled == ["build"] * 2 + ["build_visuals"]


def test_visuals_are_compiled_in_advance(request):
    built = pickle.loads(pickle.dumps(cw.build("empty", "rosbots.xacro", visuals=True)))
    compiled = request.getfixturevalue("compiled")
    with built.world() as world:
        take(world, "/rosbots/camera1/image_raw")
    assert compiled == []


def test_without_its_files_it_has_the_same_bits(tmp_path):
    """As on another computer: a process that has read none of them."""
    package = shutil.copytree(ROBOT, tmp_path / ROBOT.name)
    built = cw.build("empty", {"robot": package / "urdf" / "rosbots.xacro", "z": 0.05})
    built.compile_visuals()
    data = pickle.dumps(built)
    shutil.rmtree(package)
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        found = pool.apply(drive_pickled, [data])
    assert found == drive(cw.build("empty", {"robot": "rosbots.xacro", "z": 0.05}))


def test_a_world_changes_no_other(built):
    expected = drive(built)
    with built.world() as world:
        world.session.simulation.model.body_mass[:] *= 2
        world.session.simulation.model.opt.gravity[:] = 0
        world.spawn("object.urdf", x=3)
        world.model("rosbots").delete()
        world.run(0.1)
    assert drive(built) == expected


def test_a_world_can_be_changed_like_any_other(built):
    with built.world() as world:
        world.spawn("rosbots.xacro", name="second", x=2, z=0.05)
        world.run(0.1)
        assert world.models == (*built.models, "second")


def test_what_a_load_reports_is_reported_by_each_world(built):
    with cw.World("empty") as by_hand:
        by_hand.spawn("rosbots.xacro", z=0.05)
        expected = [str(each) for each in by_hand.diagnostics]
    assert expected
    assert [str(each) for each in built.diagnostics] == expected
    with built.world() as world:
        assert [str(each) for each in world.diagnostics] == expected


def test_it_pickles(built):
    other = pickle.loads(pickle.dumps(built))
    assert other.models == built.models == ("ground_plane", "rosbots")
    assert [each.code for each in other.diagnostics] == [each.code for each in built.diagnostics]
    assert drive(other) == drive(built)
    assert drive(copy.deepcopy(built)) == drive(built)


def test_processes_have_the_same_bits(built):
    with multiprocessing.get_context("spawn").Pool(2) as pool:
        found = pool.starmap(drive, [(built, 0), (built, 0), (built, 7)])
    assert found == [drive(built, 0), drive(built, 0), drive(built, 7)]


def test_threads_have_the_same_bits():
    """The first images of all threads compile the visuals once."""
    built = cw.build("empty", {"robot": "rosbots.xacro", "z": 0.05})
    found = []
    threads = [threading.Thread(target=lambda: found.append(drive(built))) for _ in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [drive(built)] * 3


def test_several_robots_and_their_arguments(make):
    eye = make.sdf(sensor(width=16, height=12))
    built = cw.build(
        "empty",
        ["rosbots.xacro", {"robot": "rosbots.xacro", "name": "second", "x": 2, "yaw": 1.0}, eye],
        without="all",
    )
    assert built.models == ("ground_plane", "rosbots", "second", "cam_eye")
    with built.world() as world:
        assert world.model("second").pose.yaw == pytest.approx(1.0)
        assert world.session.simulation.engine.without
        assert np.ptp(pixels_of(take(world, "/cam/image_raw"))) > 0


def test_options_of_the_world_and_of_the_build(built, tmp_path):
    with built.world(record=tmp_path / "drive.mcap") as world:
        world.run(0.2)
    assert (tmp_path / "drive.mcap").stat().st_size > 0
    for options in ({"strict": True}, {"world": "walls"}, {"without": "all"}):
        with raises(OPTIONS_CONFLICT, name=next(iter(options))):
            built.world(**options)
    with pytest.raises(TypeError):
        built.world(colour="red")


def test_mistakes_in_the_robots():
    with raises(MODEL_NAME_TAKEN, name="rosbots", free="rosbots_1"):
        cw.build("empty", ["rosbots.xacro", "rosbots.xacro"])
    with raises(OPTION_INVALID, name="nmae", meant="name"):
        cw.build("empty", {"robot": "rosbots.xacro", "nmae": "cart"})
    with raises(OPTION_INVALID, name="robots"):
        cw.build("empty", {"name": "rosbots"})
