"""What a saved state contains, and where it can be restored."""

import copy
import gc
import multiprocessing
import os
import pickle
import threading
import weakref
from dataclasses import replace

import numpy as np
import pytest
from tests.coded import raises
from tests.saving.built import restored, run
from tests.saving.journeys import ROBOTS, Journey, traveller

import cartwheel as cw
from cartwheel.codes.world import NUMBER_OUT_OF_RANGE, RUN_NESTED, SIMULATION_CLOSED, STATE_MISMATCH
from cartwheel.messages import encode_cdr, service_classes

CART = {"robot": "rosbots.xacro", "z": 0.05}


@pytest.fixture(scope="module")
def built():
    return cw.build("empty", CART)


@pytest.fixture
def world(built):
    with built.world() as world:
        yield world


def bits(world):
    data = world.session.simulation.data
    return data.qpos.tobytes() + data.qvel.tobytes(), world.session.simulation.time_ns


def test_before_any_step_and_after_reads(world):
    first = world.save()
    expected = run(world)
    world.restore(first)
    assert world.time == 0
    _ = world.model("rosbots").pose, world.contacts(), world.model("rosbots").link("base_link").pose
    second = world.save()
    _ = world.model("rosbots").pose
    assert run(world) == expected
    world.restore(second)
    assert run(world) == expected


def test_saving_changes_nothing(built):
    with built.world() as world, built.world() as other:
        for _ in range(5):
            world.save()
            assert run(world, 0.1) == run(other, 0.1)


def test_models_that_were_spawned_or_deleted_since(world, make):
    world.spawn(make.box("crate", (0.2, 0.2, 0.2)), x=1.0, z=0.1)
    world.run(0.3)
    state = world.save()
    expected = run(world)
    places = {name: world.model(name).pose for name in world.models}
    world.spawn(make.box("more", (0.1, 0.1, 0.1)), x=2.0)
    world.model("rosbots").delete()
    world.model("crate").pose = cw.Pose((5.0, 0.0, 1.0))
    world.run(0.2)
    world.restore(state)
    assert world.models == state.models == ("ground_plane", "rosbots", "crate")
    assert run(world) == expected
    assert {name: world.model(name).pose for name in world.models} == places


def test_a_fixed_model_that_was_moved(world, make):
    world.spawn(make.box("wall", (0.1, 1.0, 1.0), static=True), x=2.0)
    state = world.save()
    world.model("wall").pose = cw.Pose((0.0, 3.0, 0.0))
    world.restore(state)
    assert world.model("wall").pose.x == 2.0
    world.reset()
    assert world.model("wall").pose.x == 2.0


def test_pushes_go_on(world):
    cart = world.model("rosbots")
    cart.push(force=(8.0, 0.0, 0.0), seconds=0.3)
    world.run(0.1)
    state = world.save()
    world.run(0.4)
    expected = bits(world)
    world.restore(state)
    world.run(0.4)
    assert bits(world) == expected


def test_gravity_and_the_compiled_model(world):
    simulation = world.session.simulation
    state = world.save()
    expected = run(world)
    mass = simulation.model.body_mass.copy()
    simulation.change_world(replace(simulation.world, gravity=(0.0, 0.0, -1.6)))
    simulation.model.body_mass[:] *= 2
    simulation.model.geom_friction[:] *= 0.5
    simulation.model.opt.tolerance = 0.1
    run(world)
    world.restore(state)
    assert simulation.world.gravity == (0.0, 0.0, -9.8)
    assert np.array_equal(simulation.model.body_mass, mass)
    assert run(world) == expected


def change(world):
    """Changes properties without a compilation."""
    cart = world.model("rosbots")
    base = cart.link("base_link")
    base.mass = base.mass + 5.0
    base.center_of_mass = (0.03, 0.0, 0.0)
    base.color = (1.0, 0.2, 0.2)
    for wheel in ("wheel_left_link", "wheel_right_link"):
        cart.link(wheel).friction = 0.1
    cart.joints["wheel_left_joint"].damping = 0.5
    cart.joints.friction = {"wheel_left_joint": 0.2, "wheel_right_joint": 0.2}
    world.gravity = (0.0, 0.0, -3.0)
    world.light("sun").intensity = 0.3
    world.model("ground_plane").pose = cw.Pose((0.0, 0.0, -0.1))


def test_properties_that_were_changed(built, world):
    world.run(0.2)
    before = world.save()
    expected = run(world)
    change(world)
    world.run(0.2)
    after = world.save()
    changed = run(world)
    assert changed != expected
    for _ in range(2):
        world.restore(before)
        assert world.gravity == (0.0, 0.0, -9.8)
        assert world.model("ground_plane").pose.z == 0.0
        assert run(world) == expected
        world.restore(pickle.loads(pickle.dumps(after)))
        assert world.gravity == (0.0, 0.0, -3.0)
        assert world.model("rosbots").link("base_link").color == (1.0, 0.2, 0.2, 1.0)
        assert run(world) == changed
    assert restored(built, after) == changed
    assert restored(built, before) == expected


def test_a_step_length_that_was_changed(world):
    simulation = world.session.simulation
    state = world.save()
    expected = run(world)
    physics = replace(simulation.world.physics, max_step_size=0.002)
    simulation.change_world(replace(simulation.world, physics=physics))
    world.run(0.1)
    world.restore(state)
    assert run(world) == expected


def test_the_seed_is_part_of_the_state(built):
    with built.world(seed=3) as world, built.world(seed=4) as other:
        world.run(0.2)
        state = world.save()
        expected = run(world)
        other.restore(state)
        assert run(other) == expected


def test_a_new_seed_is_that_of_a_new_world(built):
    with built.world(seed=3) as world, built.world(seed=4) as other:
        expected = run(world)
        run(other)
        other.reset(seed=3)
        assert run(other) == expected
        other.reset()
        assert run(other) == expected
        for wrong in (-1, 1.5, True):
            with raises(NUMBER_OUT_OF_RANGE):
                other.reset(seed=wrong)


@pytest.mark.parametrize(
    "name", ["libgazebo_imu_plugin.urdf", "librotors_gazebo_imu_plugin-switched.urdf"]
)
def test_a_new_seed_draws_constant_errors_again(name):
    def measured(world):
        boxes = [world.mailbox(t.name) for t in world.graph.topics() if t.publishers]
        world.run(0.3)
        return [repr(message) for box in boxes for message in box.drain()]

    worlds = {}
    for seed in (3, 4):
        worlds[seed] = cw.World(seed=seed)
        worlds[seed].spawn(ROBOTS / name, z=0.2)
    with worlds[3] as world, worlds[4] as other:
        expected = measured(world)
        assert measured(other) != expected
        other.reset(seed=3)
        assert measured(other) == expected


def test_in_threads_and_processes_with_a_camera(built, world):
    world.publish("/part2_cmr/cmd_vel", linear_x=0.2)
    world.run(0.25)
    state = world.save()
    expected = run(world)
    found = []
    threads = [
        threading.Thread(target=lambda: found.append(restored(built, state))) for _ in range(2)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [expected] * 2
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.starmap(restored, [(built, state)]) == [expected]


def test_it_pickles_and_copies(built, world):
    world.run(0.2)
    state = world.save()
    expected = run(world)
    for other in (pickle.loads(pickle.dumps(state)), copy.deepcopy(state)):
        assert (other.time, other.models, other.left_out) == (0.2, state.models, state.left_out)
        world.restore(other)
        assert run(world) == expected
        assert restored(built, other) == expected


def test_after_a_fork():
    # Without a camera: after an image, a forked process cannot render.
    with cw.World("empty") as world:
        world.spawn(ROBOTS / "gz-sim-diff-drive-system.urdf", z=0.2)
        world.run(0.2)
        state = world.save()
        world.run(0.2)
        expected = bits(world)
        child = os.fork()
        if not child:
            world.restore(state)
            world.run(0.2)
            os._exit(0 if bits(world) == expected else 1)
        assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0


def test_timed_actions_and_held_messages(world):
    cart = world.model("rosbots")
    times = []
    world.topic("/part2_cmr/cmd_vel").hold({"linear": {"x": 0.3}}, rate=7.0)
    world.on(0.5, lambda: times.append(world.time))
    cancelled = world.on(0.6, lambda: times.append(world.time))
    world.run(0.25)
    state = world.save()
    assert "action at 0.5 s" in state.left_out
    world.run(0.1)
    # The actions are still pending.
    world.restore(state)
    world.run(0.5)
    expected = bits(world)
    assert times == [0.5, 0.6]
    world.on(0.8, lambda: times.append(world.time))
    cancelled.cancel()
    world.restore(state)
    world.run(0.5)
    assert bits(world) == expected
    world.run(0.3)
    assert times == [0.5, 0.6, 0.5]
    assert cart.pose.x > 0.1


def test_what_is_left_out_is_listed(world, tmp_path):
    assert world.save().left_out == ()
    world.subscribe("/odom", lambda _: None)
    assert world.save().left_out == ("subscriber of /odom",)
    with cw.World("empty", record=tmp_path / "run.mcap") as recorded:
        assert "connections and recordings" in recorded.save().left_out


def test_subscribers_stay(world):
    state = world.save()
    seen = []
    world.subscribe("/clock", seen.append)
    world.run(0.1)
    world.restore(state)
    seen.clear()
    world.run(0.1)
    assert len(seen) >= 10


def test_links_that_are_attached():
    request, _ = service_classes("linkattacher_msgs/srv/AttachLink")

    def call(name):
        asked = request(model1_name="box_0", link1_name=link, model2_name="box_1", link2_name=link)
        done = world.graph.call(name, asked)
        world.run(0.1)
        assert done.result(1).success

    with cw.World(ROBOTS / "libgazebo_link_attacher.world") as world:
        for index in range(2):
            world.spawn("object.urdf", name=f"box_{index}", x=float(index), z=1.0)
        link = world.model("box_0").links[0]
        world.run(0.05)
        free = world.save()
        call("/ATTACHLINK")
        attached = world.save()
        world.run(0.3)
        expected = bits(world)
        call("/DETACHLINK")
        for state in (attached, pickle.loads(pickle.dumps(attached))):
            world.restore(free)
            world.run(0.2)
            world.restore(state)
            world.run(0.3)
            assert bits(world) == expected
    with cw.World(ROBOTS / "libgazebo_link_attacher.world") as world:
        world.restore(state)
        world.run(0.3)
        assert bits(world) == expected


def test_controllers_that_were_unloaded_or_stopped():
    journey = Journey(traveller(ROBOTS / "libgazebo_ros2_control.urdf"))
    with journey.world as world:
        journey.set_out()
        manager = next(
            plugin.manager
            for plugin in world.session.simulation.population.resident("my_robot").behaviours
            if getattr(plugin, "manager", None) is not None
        )
        names = [each.name for each in manager.controllers]
        assert names
        state = world.save()
        expected = journey.go_on()
        manager.switch([], [each.name for each in manager.controllers if each.running])
        world.run(0.1)
        for name in names:
            manager.unload(name)
        world.run(0.1)
        world.restore(state)
        assert [each.name for each in manager.controllers] == names
        world.run(0.5)
        positions = world.session.simulation.data.qpos.copy()
        world.restore(pickle.loads(pickle.dumps(state)))
        world.run(0.5)
        assert np.array_equal(world.session.simulation.data.qpos, positions)
        assert expected


PLUGIN = """
from cartwheel.plugin import Plugin, tag
from dataclasses import dataclass, field
import numpy as np
import threading

@dataclass(frozen=True, kw_only=True)
class Nothing:
    pass

class Counter(Plugin[Nothing]):
    filenames = ("libcounter.so",)

    def configure(self):
        self.publisher = self.advertise("count", "std_msgs/msg/Float64")
        self.values = {"count": 0, "history": [np.zeros(2)]}
        self.random = np.random.default_rng(5)
        self.lock = threading.Lock()
        self.numbers = self.endless()
        self.part.schedule(50.0, after=self.count)
        calls = 0

        def counted():
            nonlocal calls
            calls += 1
            return calls

        self.counted = counted

    def endless(self):
        yield 1

    def count(self):
        self.values["count"] += 1
        self.values["history"].append(self.random.normal(size=2))
        total = sum(each.sum() for each in self.values["history"]) + self.counted()
        self.publisher.publish(self.message_class("std_msgs/msg/Float64")(total))

class Declared(Counter):
    filenames = ("libdeclared.so",)

    def configure(self):
        super().configure()
        self.counted = int

    def save(self):
        return {"values": self.values, "random": self.random.bit_generator.state}

    def restore(self, saved):
        self.values = saved["values"]
        self.random.bit_generator.state = saved["random"]
"""
ROBOT = """<robot name="thing"><link name="base"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
<gazebo><plugin name="counter" filename="{}"/></gazebo></robot>"""


@pytest.mark.parametrize("name", ["libcounter.so", "libdeclared.so"])
def test_a_plugin_of_others(name, tmp_path):
    (tmp_path / "plugin.py").write_text(PLUGIN)
    (tmp_path / "thing.urdf").write_text(ROBOT.format(name))

    def opened():
        world = cw.World("empty", plugins=tmp_path / "plugin.py")
        world.spawn(tmp_path / "thing.urdf")
        return world, world.mailbox("/count")

    def counted(world, box):
        box.drain()
        world.run(0.5)
        return [each.data for each in box.drain()]

    world, box = opened()
    other, other_box = opened()
    with world, other:
        counted(world, box)
        state = world.save()
        expected = counted(world, box)
        assert len(expected) >= 25
        world.restore(state)
        assert counted(world, box) == expected
        (left_out,) = [each for each in state.left_out if not each.startswith("subscriber")] or [""]
        # A generator cannot be copied. A plugin with `save` decides for itself.
        assert ("numbers (generator)" in left_out) == (name == "libcounter.so")
        other.run(0.1)
        if name == "libcounter.so":
            other.restore(pickle.loads(pickle.dumps(state)))
            assert counted(other, other_box) == expected
        else:
            other.restore(state)
            assert counted(other, other_box) == expected


def test_a_plugin_that_failed_since(tmp_path):
    failing = PLUGIN.replace(
        'self.values["count"] += 1',
        'self.values["count"] += 1\n        assert self.values["count"] < 30',
    )
    (tmp_path / "plugin.py").write_text(failing)
    (tmp_path / "thing.urdf").write_text(ROBOT.format("libcounter.so"))
    with cw.World("empty", plugins=tmp_path / "plugin.py") as world:
        world.spawn(tmp_path / "thing.urdf")
        world.run(0.3)
        state = world.save()
        world.run(1.0)
        failed = world.save()
        world.restore(state)
        box = world.mailbox("/count")
        world.run(0.2)
        assert len(box.drain()) >= 10
        world.restore(failed)
        world.run(0.2)
        assert box.drain() == []


def test_worlds_that_differ(world, make):
    state = world.save()
    expected = run(world)
    with cw.World("empty", without="all") as other, raises(STATE_MISMATCH):
        other.restore(state)
    # Both worlds have the name "default" and start with other models.
    with cw.World("walls") as other, raises(STATE_MISMATCH):
        other.restore(state)
    with cw.World("empty") as other:
        # The models of the state replace others.
        other.spawn(make.box("rosbots", (0.1, 0.1, 0.1)))
        other.restore(pickle.loads(pickle.dumps(state)))
        assert other.models == state.models
        assert run(other) == expected


@pytest.mark.parametrize("kept", [True, False])
def test_a_world_that_cannot_restore_a_state_is_unchanged(kept, tmp_path):
    (tmp_path / "plugin.py").write_text(PLUGIN)
    (tmp_path / "thing.urdf").write_text(ROBOT.format("libcounter.so"))
    with cw.World("empty", plugins=tmp_path / "plugin.py") as richer:
        richer.spawn("rosbots.xacro", z=0.05)
        richer.spawn(tmp_path / "thing.urdf", y=5.0)
        richer.gravity = (0.0, 0.0, -1.62)
        richer.run(0.3)
        state = pickle.loads(pickle.dumps(richer.save()))

    def made():
        world = cw.World("empty")
        # It is deleted by the attempt, or changed in place.
        world.spawn("rosbots.xacro", name="rosbots" if kept else "other", z=0.05, x=1.0)
        world.spawn("object.urdf", name="crate", x=3.0)
        world.on(1.0, lambda: world.model("crate").push(force=(50.0, 0.0, 0.0)))
        world.publish("/part2_cmr/cmd_vel", linear_x=0.4)
        world.run(0.5)
        return world

    def ahead(world):
        odometry, imu = world.mailbox("/odom"), world.mailbox("/imu/data")
        world.run(1.0)
        found = [encode_cdr(message) for box in (odometry, imu) for message in box.drain()]
        assert len(found) > 100
        return found, [world.model(name).pose for name in world.models], world.gravity

    with made() as untouched, made() as world:
        before = untouched.models
        with raises(STATE_MISMATCH):
            world.restore(state)
        assert world.models == before
        assert ahead(world) == ahead(untouched)


def test_not_while_it_runs_and_not_when_closed(world):
    state = world.save()
    codes = []

    def use(_):
        for call in (world.save, lambda: world.restore(state)):
            try:
                call()
            except cw.CartwheelError as error:
                codes.append(error.code)

    world.subscribe("/clock", use)
    world.run(0.01)
    assert set(codes) == {RUN_NESTED}
    world.close()
    with raises(SIMULATION_CLOSED):
        world.save()
    with raises(SIMULATION_CLOSED):
        world.restore(state)


def test_a_state_keeps_no_world_in_memory(built):
    world = built.world()
    world.run(0.1)
    state = world.save()
    session = weakref.ref(world.session)
    world.close()
    del world
    gc.collect()
    assert session() is None
    assert restored(built, state)
