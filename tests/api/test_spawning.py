"""Models that are spawned together are compiled once, and are as if spawned one by one."""

import numpy as np
import pytest
from tests.coded import coded, raises

import cartwheel as cw
from cartwheel.codes import devices
from cartwheel.codes.files import WRONG_KIND
from cartwheel.codes.running import CONTROLLER_NOT_STARTED
from cartwheel.codes.world import MODEL_NAME_TAKEN, MODELS_OVERLAP
from cartwheel.errors import CartwheelError, DescriptionError, UnknownNameError
from cartwheel.simulation.models import compilations


@pytest.fixture
def compiled(monkeypatch):
    """The number of models in each compilation."""
    sizes = []
    original = compilations.build

    def counted(world, entries, **options):
        entries = list(entries)
        sizes.append(len(entries) - 1)  # without the world's own
        return original(world, entries, **options)

    monkeypatch.setattr(compilations, "build", counted)
    return sizes


def state(world):
    data = world.session.simulation.data
    return np.concatenate([data.qpos, data.qvel, data.act])


def test_all_are_compiled_at_the_end(make, rosbots, compiled):
    world = make.world()
    compiled.clear()
    with world.spawning():
        carts = [world.spawn(rosbots, name=f"cart_{i}", x=i, z=0.05) for i in range(3)]
        assert world.models == ("ground_plane",)
        with pytest.raises(UnknownNameError):
            _ = carts[0].pose
    assert compiled == [4]
    assert world.models == ("ground_plane", "cart_0", "cart_1", "cart_2")
    assert [round(cart.pose.x, 6) for cart in carts] == [0, 1, 2]


def test_they_move_as_if_spawned_one_by_one(make, rosbots):
    """To the last bit."""
    together, one_by_one = make.world(), make.world()
    for world in (together, one_by_one):
        if world is together:
            with world.spawning():
                _spawn(world, rosbots)
        else:
            _spawn(world, rosbots)
        world.publish("/part2_cmr/cmd_vel", linear_x=0.3, angular_z=0.2)
        world.run(1.0)
    assert np.array_equal(state(together), state(one_by_one))
    # What models have in common is reported when all of them are spawned.
    assert sorted(str(each) for each in together.diagnostics) == sorted(
        str(each) for each in one_by_one.diagnostics
    )


def _spawn(world, rosbots):
    for index in range(3):
        world.spawn(rosbots, name=f"cart_{index}", x=1.5 * index, z=0.05)


def test_a_running_world_continues(make, rosbots):
    world = make.world(rosbots)
    world.publish("/rosbots/part2_cmr/cmd_vel", linear_x=0.3)
    world.run(1.0)
    here = world.model("rosbots").pose
    with world.spawning():
        world.spawn(rosbots, name="second", x=3, z=0.05)
        world.spawn(rosbots, name="third", x=5, z=0.05)
    assert world.time == 1.0
    assert world.model("rosbots").pose == here


def test_a_name_is_taken_once(make, rosbots):
    world = make.world()
    with world.spawning():
        world.spawn(rosbots, name="cart", z=0.05)
        with raises(MODEL_NAME_TAKEN, name="cart", free="cart_1"):
            world.spawn(rosbots, name="cart", x=2, z=0.05)
        world.spawn(rosbots, name="cart_1", x=2, z=0.05)
    assert world.models == ("ground_plane", "cart", "cart_1")


def test_an_error_in_the_block_spawns_none(make, rosbots, compiled):
    world = make.world()
    compiled.clear()
    topics = {each.name for each in world.graph.topics()}
    with pytest.raises(ZeroDivisionError), world.spawning():
        world.spawn(rosbots, z=0.05)
        raise ZeroDivisionError
    assert compiled == []
    assert world.models == ("ground_plane",)
    assert {each.name for each in world.graph.topics()} == topics
    world.spawn(rosbots, z=0.05)
    assert world.models == ("ground_plane", "rosbots")


def test_a_model_that_is_refused_leaves_the_others(make, rosbots, tmp_path):
    """The bundled cart has no controller manager."""
    (tmp_path / "controllers.yaml").write_text("a:\n  type: b/B\n")
    world = make.world()
    with world.spawning():
        world.spawn(rosbots, name="first", z=0.05)
        with raises(CONTROLLER_NOT_STARTED, model="second"):
            world.spawn(rosbots, name="second", controllers=tmp_path / "controllers.yaml")
        world.spawn(rosbots, name="third", x=2, z=0.05)
    assert world.models == ("ground_plane", "first", "third")


def test_a_warning_in_strict_mode_spawns_none(make, rosbots):
    wrong = make.with_parameters(rosbots, "imu_plugin", gausianNoise="0.1")
    with cw.World(strict=True) as world:
        before = world.models
        with pytest.raises(CartwheelError) as caught, world.spawning():
            world.spawn(rosbots, name="right", z=0.05)
            world.spawn(wrong, name="wrong", x=2, z=0.05)
        assert caught.value.code is devices.PLUGIN_PARAMETER_UNKNOWN
        assert world.models == before


def test_an_overlap_is_reported_once(make):
    boxes = [make.box(name, (0.5, 0.5, 0.5)) for name in ("low", "high")]
    world = make.world(ground=None)
    with world.spawning():
        for box in boxes:
            world.spawn(box, z=1.0)
    (found,) = coded(world, MODELS_OVERLAP)
    assert found.values["model"] == "high"


def test_blocks_within_blocks_end_with_the_outer_one(make, rosbots, compiled):
    world = make.world()
    compiled.clear()
    with world.spawning():
        with world.spawning():
            world.spawn(rosbots, name="first", z=0.05)
        assert compiled == []
        world.spawn(rosbots, name="second", x=2, z=0.05)
    assert compiled == [3]


def test_an_empty_block_compiles_nothing(make, compiled):
    world = make.world()
    compiled.clear()
    with world.spawning():
        pass
    assert compiled == []


def test_xml_instead_of_a_file():
    text = (
        '<robot name="{}" xmlns:xacro="http://ros.org/wiki/xacro"><xacro:arg name="mass" '
        'default="1"/><link name="a"><inertial><mass value="$(arg mass)"/><inertia ixx="1" '
        'iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>'
    )
    with cw.World("empty") as world:
        one = world.spawn(text.format("one"), z=1.0)
        two = world.spawn(f"\n{text.format('two')}", arguments={"mass": "3"}, x=1.0)
        assert (one.mass, two.mass) == (1.0, 3.0)
        with raises(WRONG_KIND, kind="world"):
            world.spawn('<sdf version="1.6"><world name="w"/></sdf>')
        with pytest.raises(DescriptionError) as caught:
            world.spawn("<robot name='cut'>")
        assert "<string>" in str(caught.value.origin)
    with cw.World('<sdf version="1.6"><world name="w"/></sdf>') as world:
        assert world.models == ()
    with cw.build("empty", [text.format("one"), {"robot": text.format("two")}]).world() as world:
        assert world.models == ("ground_plane", "one", "two")
