"""Models in and out, time held and let go, other threads, and runs that fail."""

import tempfile
import threading
import time

import numpy as np
import pytest

import cartwheel as cw
from cartwheel.codes import devices
from cartwheel.codes import world as world_codes
from cartwheel.description import load_text
from cartwheel.description.model import PluginTag
from cartwheel.errors import PluginError, SimulationError, UnknownNameError, WorldError
from cartwheel.geometry import Pose
from cartwheel.simulation import RunState
from cartwheel.simulation.pacing import Pacer

COMMAND = "/part2_cmr/cmd_vel"


def state(world, model, link="link"):
    joint = world.session.simulation.data.joint(f"{model}::{link}")
    return np.concatenate([joint.qpos, joint.qvel])


@pytest.fixture(autouse=True)
def dumps(tmp_path, monkeypatch):
    """Where the last states of a diverged run go."""
    monkeypatch.setattr(tempfile, "tempdir", str(tmp_path))


@pytest.fixture
def driving(make, rosbots):
    """A world in which the cart drives and a box slides."""
    box = make.box("box", (0.4, 0.4, 0.4), mu=0.1, pose=Pose((0, 3, 0.2)))
    world = make.world(box)
    world.session.spawn(rosbots, pose=Pose((0, 0, 0.05)))
    world.publish(COMMAND, linear_x=0.5, angular_z=0.2)
    world.run(1.5)
    world.session.simulation.data.joint("box::link").qvel[0] = 3.0
    world.run(0.2)
    return world


def test_spawn_keeps_everything_elses_state(make, driving):
    before = {name: state(driving, *name) for name in (("rosbots", "base_footprint"), ("box",))}
    time_before = driving.session.simulation.time_ns
    wheel = driving.model("rosbots").joint("wheel_left_joint")
    driving.session.spawn(make.box("new", (1, 1, 1), pose=Pose((10, 0, 0.5))))
    assert driving.session.simulation.time_ns == time_before
    for name, was in before.items():
        assert np.array_equal(state(driving, *name), was)
    assert driving.model("rosbots").joint("wheel_left_joint") == wheel
    # It goes on as if nothing had been spawned: motors still know their target.
    driving.run(1.0)
    assert np.linalg.norm(state(driving, "rosbots", "base_footprint")[7:9]) == pytest.approx(
        0.5, rel=0.02
    )


def test_spawn_and_delete_change_nothing_of_what_follows(make, rosbots):
    """A run in which a model comes and goes ends where one without it does."""

    def run(visit):
        world = make.world()
        world.session.spawn(rosbots, pose=Pose((0, 0, 0.05)))
        world.publish(COMMAND, linear_x=0.5, angular_z=0.3)
        world.run(2.0)
        if visit:
            world.session.spawn(make.box("visitor", (1, 1, 1), pose=Pose((20, 0, 0.5))))
        world.run(1.0)
        if visit:
            world.model("visitor").delete()
        world.run(2.0)
        return world.model("rosbots").pose

    plain, visited = run(False), run(True)
    # More bodies may round otherwise, nothing more.
    assert visited.position == pytest.approx(plain.position, abs=1e-6)
    assert visited.yaw == pytest.approx(plain.yaw, abs=1e-6)


def test_delete_takes_topics_and_body_away(driving):
    before = state(driving, "box")
    driving.model("rosbots").delete()
    assert driving.models == ("ground_plane", "box")
    assert [topic.name for topic in driving.graph.topics()] == ["/clock"]
    assert driving.graph.services() == []
    assert np.array_equal(state(driving, "box"), before)
    with pytest.raises(UnknownNameError):
        driving.model("rosbots")
    driving.run(0.1)


def test_a_taken_name_changes_nothing(driving, rosbots):
    simulation = driving.session.simulation
    before, scene = state(driving, "rosbots", "base_footprint"), simulation.scene
    topics = [(t.name, t.publishers, t.subscribers) for t in driving.graph.topics()]
    with pytest.raises(WorldError) as caught:
        driving.session.spawn(rosbots)
    assert caught.value.code is world_codes.MODEL_NAME_TAKEN
    assert caught.value.values == {"name": "rosbots", "free": "rosbots_1"}
    assert simulation.scene is scene
    assert np.array_equal(state(driving, "rosbots", "base_footprint"), before)
    assert [(t.name, t.publishers, t.subscribers) for t in driving.graph.topics()] == topics


@pytest.mark.parametrize("name", ["", "a::b"])
def test_a_name_that_is_none_is_refused(make, name):
    import dataclasses

    with pytest.raises(WorldError) as caught:
        make.world().session.spawn(dataclasses.replace(make.box("box", (1, 1, 1)), name=name))
    assert caught.value.code is world_codes.MODEL_NAME_INVALID


BAD_PLANE = (
    '<model name="bad"><link name="l"><collision name="c"><geometry><plane/></geometry>'
    "</collision></link></model>"
)
_LOOPS = "".join(
    f'<joint name="{a}{b}" type="fixed"><parent>{a}</parent><child>{b}</child></joint>'
    for a, b in ("ab", "ba", "cd", "dc", "ac", "ca")
)
BAD_LOOP = (
    f'<model name="bad"><link name="a"/><link name="b"/><link name="c"/><link name="d"/>{_LOOPS}'
    "</model>"
)


@pytest.mark.parametrize("text", [BAD_PLANE, BAD_LOOP])
def test_a_model_that_cannot_be_built_changes_nothing(make, driving, text):
    simulation = driving.session.simulation
    scene, before = simulation.scene, state(driving, "box")
    bad = make.sdf(text)
    with pytest.raises(WorldError) as caught:
        driving.session.spawn(bad)
    assert caught.value.origin is not None
    assert caught.value.origin.line > 0
    assert simulation.scene is scene
    assert driving.models == ("ground_plane", "box", "rosbots")
    assert np.array_equal(state(driving, "box"), before)
    driving.run(0.1)


def test_a_plugin_without_sense_leaves_the_graph_as_it_was(make, rosbots, driving):
    """The drive is made first and advertises; then the IMU fails, and both are gone."""
    topics = [(t.name, t.publishers, t.subscribers) for t in driving.graph.topics()]
    services = driving.graph.services()
    bad = make.with_parameters(rosbots, "imu_plugin", gaussianNoise="-1")
    with pytest.raises(PluginError) as caught:
        driving.session.spawn(bad, name="other")
    assert caught.value.values["parameter"] == "gaussianNoise"
    assert [(t.name, t.publishers, t.subscribers) for t in driving.graph.topics()] == topics
    assert driving.graph.services() == services
    assert "other" not in driving.models
    driving.run(0.1)


def test_a_model_that_cannot_be_built_takes_its_plugins_along(make, rosbots):
    """Its plugins were made, its bodies cannot be: nothing of it stays on the graph."""
    import dataclasses

    plane = make.sdf(BAD_PLANE).links[0].collisions
    base = rosbots.links[0]
    bad = dataclasses.replace(
        rosbots, links=(dataclasses.replace(base, collisions=plane), *rosbots.links[1:])
    )
    world = make.world()
    with pytest.raises(WorldError) as caught:
        world.session.spawn(bad)
    assert caught.value.code is world_codes.PLANE_NOT_STATIC
    assert [topic.name for topic in world.graph.topics()] == ["/clock"]
    assert world.graph.services() == []


def test_an_unknown_plugin_is_reported(make, rosbots):
    import dataclasses

    tag = rosbots.plugins[0]
    wrong = PluginTag(
        name="x", filename="libgazebo_ros_dif_drive.so", element=tag.element, origin=tag.origin
    )
    world = make.world()
    world.session.spawn(dataclasses.replace(rosbots, plugins=(wrong,)), pose=Pose((0, 0, 0.1)))
    (reported,) = [d for d in world.diagnostics if d.severity == "warning"]
    assert reported.code is devices.PLUGIN_UNKNOWN
    assert reported.values["meant"] == "libgazebo_ros_diff_drive.so"


def test_reset_takes_all_back_to_where_it_was_spawned(driving):
    driving.run(3.0)
    stamps = driving.mailbox("/odom")
    driving.reset()
    assert driving.time == 0.0
    assert driving.model("rosbots").pose == Pose((0, 0, 0.05))
    assert driving.model("box").pose == Pose((0, 3, 0.2))
    assert driving.model("rosbots").joint("wheel_left_joint") == 0.0
    driving.run(2.0)
    # Commands are forgotten as well: it stands.
    assert abs(driving.model("rosbots").pose.x) < 1e-3
    reported = stamps.drain()
    assert [m.header.stamp.sec * 10**9 + m.header.stamp.nanosec for m in reported] == [
        i * 10_000_000 for i in range(201)
    ]


def test_reset_notifies_its_listeners(driving):
    reported = []
    driving.session.simulation.on_reset.append(lambda: reported.append(driving.time))
    driving.reset()
    assert reported == [0.0]


def test_pause_holds_time_and_steps_are_counted(driving):
    simulation = driving.session.simulation
    start = simulation.current_step
    simulation.pause()
    driving.run(1.0)
    assert simulation.current_step == start
    simulation.step(3)
    driving.run(1.0)
    assert simulation.current_step == start + 3
    assert simulation.run_state is RunState.PAUSED
    simulation.step()
    simulation.step()
    driving.run(1.0)
    assert simulation.current_step == start + 5
    simulation.resume()
    driving.run(0.05)
    assert simulation.current_step == start + 15


def test_a_command_may_pause_the_run_it_comes_in(driving):
    simulation = driving.session.simulation
    simulation.schedule(
        10, after=lambda: simulation.post(simulation.pause) if driving.time >= 2.0 else None
    )
    driving.run(5.0)
    assert driving.time == pytest.approx(2.0, abs=0.011)


def pacing(world, **more):
    """The world's pacer running on a thread of its own."""
    pacer = Pacer(world.session.simulation, **more)
    thread = threading.Thread(target=pacer.run)
    return pacer, thread


def test_other_threads_post_and_call(make, rosbots):
    world = make.world()
    simulation = world.session.simulation
    world.session.spawn(rosbots, pose=Pose((0, 0, 0.05)))
    simulation.set_speed(None)
    _, thread = pacing(world)
    thread.start()
    try:
        owner = simulation.call(threading.get_ident).result(120)
        assert owner == thread.ident
        box = make.box("box", (1, 1, 1), pose=Pose((5, 0, 0.5)))
        assert simulation.call(lambda: world.session.spawn(box)).result(120) == "box"
        with pytest.raises(WorldError) as caught:
            simulation.call(lambda: world.session.spawn(box)).result(120)
        assert caught.value.code is world_codes.MODEL_NAME_TAKEN
        # Eight threads publish at once; the last word is the stop.
        publishers = [
            threading.Thread(
                target=lambda: [world.publish(COMMAND, linear_x=0.1) for _ in range(50)]
            )
            for _ in range(8)
        ]
        for publisher in publishers:
            publisher.start()
        for publisher in publishers:
            publisher.join(120)
    finally:
        simulation.post(simulation.stop)
        thread.join(120)
    assert not thread.is_alive()
    assert simulation.run_state is RunState.STOPPED


def test_pace_is_kept(make):
    """Twice real time: a second of simulation takes half a one."""
    world = make.world()
    world.session.simulation.set_speed(2.0)
    pacer = Pacer(world.session.simulation, until_ns=1_000_000_000)
    start = time.perf_counter()
    pacer.run()
    wall = time.perf_counter() - start
    assert world.time == 1.0
    # Never faster than asked; slower only as far as a busy machine makes it.
    assert 0.48 < wall < 10


def test_listeners_see_time_go_on(make, rosbots):
    world = make.world()
    world.session.spawn(rosbots, pose=Pose((0, 0, 0.05)))
    world.session.simulation.set_speed(10.0)
    pacer = Pacer(world.session.simulation, until_ns=5_000_000_000)
    seen = []
    pacer.add_listener(seen.append, rate=40.0)
    pacer.run()
    times = [snapshot.time_ns for snapshot in seen]
    assert times == sorted(times)
    assert len(set(times)) > 10
    # Each is a copy: the first still shows the cart at its start.
    first = seen[0]
    row = first.scene.links.index(("rosbots", "base_footprint"))
    assert first.positions[row] == pytest.approx([0, 0, 0.05], abs=0.06)
    assert first.positions.base is None or first.positions is not seen[-1].positions


def test_a_state_that_is_no_number_stops_the_run(driving):
    driving.session.simulation.data.joint("box::link").qvel[0] = np.nan
    with pytest.raises(SimulationError) as caught:
        driving.run(1.0)
    assert caught.value.code is world_codes.SIMULATION_DIVERGED
    assert caught.value.values["body"] == "box::link"
    assert int(caught.value.values["time"]) == 1
    with np.load(caught.value.values["states"]) as dump:
        assert set(dump) == {"time", "qpos", "qvel"}
        assert np.isfinite(dump["qpos"][0]).all()
        assert not np.isfinite(dump["qpos"][-1]).all()
        assert len(dump["time"]) == len(dump["qpos"]) > 10


def test_a_divergence_is_found_at_any_rate_of_work(driving):
    """A task at every step leaves no room in which the engine checks by itself."""
    driving.session.simulation.schedule(0, after=lambda: None)
    driving.session.simulation.data.joint("box::link").qpos[2] = np.inf
    with pytest.raises(SimulationError) as caught:
        driving.run(1.0)
    assert caught.value.code is world_codes.SIMULATION_DIVERGED


def test_an_absurd_inertia_is_named(make, driving):
    """1e-9 kg m² on a hinge under a motor's torque: which body, how small, what to do."""
    bad = make.sdf(
        """<model name="bad"><pose>5 5 1 0 0 0</pose>
        <link name="arm"><inertial><mass>1e-3</mass>
          <inertia><ixx>1e-9</ixx><iyy>1e-9</iyy><izz>1e-9</izz></inertia></inertial></link>
        <joint name="j" type="revolute"><parent>world</parent><child>arm</child>
          <axis><xyz>0 0 1</xyz></axis></joint></model>"""
    )
    driving.session.spawn(bad)
    simulation = driving.session.simulation
    simulation.data.joint("bad::j").qfrc_applied[0] = 1e8
    with pytest.raises(SimulationError) as caught:
        driving.run(1.0)
    assert caught.value.values["body"] == "bad::arm"
    assert caught.value.values["inertia"] == pytest.approx(1e-9)


def test_one_simulations_divergence_is_not_anothers(make, driving):
    other = make.world(make.box("box", (1, 1, 1), pose=Pose((0, 0, 0.5))))
    other.session.simulation.data.joint("box::link").qvel[0] = np.nan
    with pytest.raises(SimulationError):
        other.run(1.0)
    driving.run(1.0)


def test_reset_ends_a_divergence(driving):
    driving.session.simulation.data.joint("box::link").qvel[0] = np.nan
    with pytest.raises(SimulationError):
        driving.run(1.0)
    driving.reset()
    driving.run(1.0)
    assert driving.model("box").pose.z == pytest.approx(0.2, abs=1e-3)


def test_a_world_saved_with_turned_joints_begins_and_begins_again_with_them():
    """A pendulum without gravity, saved at a right angle: its bob stands beside the pin."""
    found = load_text(
        """<sdf version="1.6"><world name="w"><gravity>0 0 0</gravity><model name="m">
        <link name="bob"><pose>0 0 -1 0 0 0</pose></link><link name="pin"/>
        <joint name="hang" type="fixed"><parent>world</parent><child>pin</child></joint>
        <joint name="swing" type="revolute"><parent>pin</parent><child>bob</child>
        <pose>0 0 1 0 0 0</pose><axis><xyz>0 1 0</xyz></axis></joint></model>
        <state world_name="w"><model name="m"><pose>0 0 2 0 0 0</pose>
        <link name="pin"><pose>0 0 2 0 0 0</pose></link>
        <link name="bob"><pose>-1 0 2 0 1.570796 0</pose></link></model></state></world></sdf>""",
        file="saved.world",
    )
    with cw.World(found) as world:
        simulation = world.session.simulation
        for _ in range(2):
            place = simulation.engine.link_pose("m", "bob").position
            assert place == pytest.approx((-1, 0, 2), abs=1e-5)
            simulation.data.joint("m::swing").qvel[0] = 1.0
            world.run(0.5)
            assert simulation.engine.link_pose("m", "bob").position[2] > 2.1
            world.reset()


ROOT_LAST = """<model name="sled"><pose>0 0 1 0 0 0</pose>
  <link name="mast"><pose>0 0 0.5 0 0 0</pose></link>
  <link name="body"><collision name="c"><geometry><box><size>1 1 0.2</size></box></geometry>
  </collision></link>
  <joint name="step" type="{kind}"><parent>{parent}</parent><child>{child}</child></joint>
</model>"""


@pytest.mark.parametrize(
    ("kind", "parent", "child"),
    [("fixed", "body", "mast"), ("ball", "body", "mast"), ("fixed", "mast", "body")],
)
def test_a_model_moves_whichever_of_its_links_is_the_root(make, kind, parent, child):
    """The root of the joints need not be the first link."""
    world = make.world()
    model = world.spawn(make.sdf(ROOT_LAST.format(kind=kind, parent=parent, child=child)))
    assert world.session.simulation.moves(model.name)
    start = model.pose.x
    world.session.simulation.truth.set_velocity(model.name, (1.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    world.run(0.1)
    assert model.pose.x - start == pytest.approx(0.1, rel=0.05)
