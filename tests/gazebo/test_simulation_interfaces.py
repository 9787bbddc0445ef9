"""simulation_interfaces beyond coming and going: what entities are, where, and what there is."""

import math
from pathlib import Path

import pytest
from tests.coded import coded
from tests.gazebo.conftest import Gazebo

import cartwheel as cw
from cartwheel.codes.tags import NAME_UNKNOWN
from cartwheel.gazebo.ros2_api import Ros2Api
from cartwheel.geometry import Pose
from cartwheel.messages import message_class

UNSUPPORTED, OK, NOT_FOUND, _, FAILED = range(5)
OBJECT, ROBOT, STATIC = 0, 1, 5
EMPTY, BOX, CONVEX_HULL, SPHERE = range(4)
URDF = "<robot name='pebble'><link name='l'><collision><geometry><sphere radius='0.1'/></geometry>\
</collision></link></robot>"
WORLD = """<sdf version="1.9"><world name="hall">
  <frame name="door"><pose>1 2 0 0 0 1.5707963267948966</pose></frame>
  <frame name="mat" attached_to="door"><pose>1 0 0 0 0 0</pose></frame>
  <frame name="hand" attached_to="crate"/>
  <frame name="lost"><pose relative_to="nobody">0 0 1 0 0 0</pose></frame>
  <model name="crate"><pose>0 0 0.5 0 0 0</pose><link name="l">
    <inertial><mass>1</mass></inertial>
    <collision name="c"><geometry><box><size>1 1 1</size></box></geometry></collision>
  </link></model></world></sdf>"""
ARM = """<model name="arm"><link name="base">
    <collision name="c"><geometry><sphere><radius>0.25</radius></sphere></geometry></collision>
    </link>
    <joint name="fix" type="fixed"><parent>world</parent><child>base</child></joint>
    <link name="bar"><inertial><mass>1</mass>
      <inertia><ixx>.5</ixx><iyy>.5</iyy><izz>.5</izz></inertia></inertial>
      <collision name="c"><pose>1 0 0 0 1.5707963267948966 0</pose><geometry>
        <capsule><radius>0.1</radius><length>1.8</length></capsule></geometry></collision></link>
    <joint name="hinge" type="revolute"><parent>base</parent><child>bar</child>
      <axis><xyz>0 0 1</xyz></axis></joint></model>"""


def interfaces(world: cw.World) -> Gazebo:
    return Gazebo(world, api=Ros2Api, prefix="/gz_server")


def corners(answer) -> list[tuple[float, float, float]]:
    assert answer.result.result == OK, answer.result.error_message
    return [(each.x, each.y, each.z) for each in answer.bounds.points]


def test_an_entity_is_what_it_can_do_until_somebody_says_otherwise(make):
    cube = make.box("cube", (0.5,) * 3, mass=2.0, pose=Pose((0, 0, 5)))
    api = interfaces(make.world(cube, make.sdf(ARM)))
    api.world.spawn("rosbots.xacro", name="cart", x=3.0)

    def category(name: str) -> int:
        return api("get_entity_info", entity=name).info.category.category

    assert [category(name) for name in ("cube", "cart", "ground_plane")] == [OBJECT, ROBOT, STATIC]
    assert category("arm") == OBJECT
    said = {"category": {"category": 2}, "description": "a walker", "tags": ["person", "busy"]}
    assert api("set_entity_info", entity="cube", info=said).result.result == OK
    reported = api("get_entity_info", entity="cube").info
    assert (reported.category.category, reported.description, reported.tags) == (
        2,
        *list(said.values())[1:],
    )

    def found(**filters) -> list[str]:
        answer = api("get_entities", filters=filters)
        assert answer.result.result == OK, answer.result.error_message
        return answer.entities

    assert found(categories=[{"category": ROBOT}]) == ["cart"]
    assert found(categories=[{"category": 2}, {"category": STATIC}]) == ["ground_plane", "cube"]
    assert found(tags={"tags": ["person", "idle"]}) == ["cube"]
    assert found(tags={"tags": ["person", "idle"], "filter_mode": 1}) == []
    assert found(tags={"tags": ["person", "busy"], "filter_mode": 1}, filter="c.*") == ["cube"]
    assert found(filter="c.*") == ["cube", "cart"]

    # Another thing of that name is not what was said of the first one.
    api.simulation.delete("cube")
    api.world.spawn(make.sdf('<model name="cube"><link name="l"/></model>'))
    api("set_entity_info", entity="arm", info=said)
    assert found(tags={"tags": ["busy"]}) == ["arm"]
    assert api("reset_simulation").result.result == OK
    assert found(tags={"tags": ["busy"]}) == []

    wrong = api("set_entity_info", entity="arm", info={"category": {"category": 3}})
    assert (wrong.result.result, category("arm")) == (FAILED, OBJECT)
    assert api("get_entity_info", entity="nobody").result.result == NOT_FOUND
    assert api("get_entities", filters={"filter": "("}).result.result == FAILED
    assert api("get_entities", filters={"categories": [{"category": 9}]}).result.result == FAILED


def test_bounds_are_a_box_in_the_frame_of_the_canonical_link(make):
    turned = Pose.from_xyz_rpy((1, 2, 3), (0.3, 0.2, 0.1))
    brick = make.box("brick", (0.2, 0.4, 0.6), mass=1.0, pose=turned)
    api = interfaces(make.world(brick, make.sdf(ARM), gravity=0.0))
    high, low = corners(api("get_entity_bounds", entity="brick"))
    assert high == pytest.approx((0.1, 0.2, 0.3), abs=1e-9)
    assert low == pytest.approx((-0.1, -0.2, -0.3), abs=1e-9)
    # A sphere of 0.25 at the base, and a bar to 1 + 0.9 + 0.1 along its x axis.
    high, low = corners(api("get_entity_bounds", entity="arm"))
    assert high == pytest.approx((2.0, 0.25, 0.25), abs=1e-9)
    assert low == pytest.approx((-0.25, -0.25, -0.25), abs=1e-9)
    api.simulation.set_joint_positions("arm", {"hinge": math.pi / 2})
    high, low = corners(api("get_entity_bounds", entity="arm"))
    assert high == pytest.approx((0.25, 2.0, 0.25), abs=1e-9)
    endless = api("get_entity_bounds", entity="ground_plane")
    assert (endless.bounds.type, corners(endless)) == (EMPTY, [])
    assert api("get_entity_bounds", entity="nobody").result.result == NOT_FOUND


def test_entities_are_found_by_where_they_reach(make):
    turned = Pose.from_xyz_rpy((0, 0, 1), (0, 0, math.pi / 4))
    cube = make.box("cube", (1.0,) * 3, mass=1.0, pose=turned)
    api = interfaces(make.world(cube, make.sdf(ARM), gravity=0.0))

    def found(kind: int, *points: tuple[float, float, float]) -> list[str]:
        bounds = {"type": kind, "points": [dict(zip("xyz", each, strict=True)) for each in points]}
        answer = api("get_entities", filters={"bounds": bounds})
        assert answer.result.result == OK, answer.result.error_message
        return answer.entities

    # The cube's edge is at sqrt(0.5) on the x axis, its side at 0.5 on the diagonal.
    edge = math.sqrt(0.5)
    assert found(SPHERE, (edge + 0.3, 0, 1), (0.301, 0, 0)) == ["cube"]
    assert found(SPHERE, (edge + 0.3, 0, 1), (0.299, 0, 0)) == []
    side = (0.5 + 0.2) * edge
    assert found(SPHERE, (side, side, 1), (0.199, 0, 0)) == []
    assert found(SPHERE, (side, side, 1), (0.201, 0, 0)) == ["cube"]
    assert found(BOX, (edge + 1, 0.1, 1.1), (edge - 0.01, -0.1, 0.9)) == ["cube"]
    assert found(BOX, (edge + 1, 0.1, 1.1), (edge + 0.01, -0.1, 0.9)) == []
    assert found(CONVEX_HULL, (1.9, 0, -1), (2.1, 0, 1), (2.1, 1, 0)) == ["ground_plane", "arm"]
    assert found(CONVEX_HULL, (3, 0, 1), (5, 0, 1), (4, 1, 2)) == []
    # What is beneath the ground's surface is in the ground.
    assert found(BOX, (9, 9, -1), (8, 8, -2)) == ["ground_plane"]
    assert found(EMPTY) == ["ground_plane", "cube", "arm"]

    def refused(kind: int, count: int, **point: float) -> int:
        bounds = {"type": kind, "points": [point] * count}
        return api("get_entities", filters={"bounds": bounds}).result.result

    assert [refused(BOX, 1), refused(CONVEX_HULL, 2), refused(SPHERE, 3)] == [FAILED] * 3
    assert [refused(SPHERE, 2, x=-1.0), refused(BOX, 2, x=math.nan)] == [FAILED] * 2
    assert refused(7, 2) == UNSUPPORTED


def test_a_state_contains_the_acceleration_too(make):
    cube = make.box("cube", (0.5,) * 3, mass=2.0, pose=Pose((0, 0, 5)))
    api = interfaces(make.world(cube, make.sdf(ARM)))

    def acceleration(name: str):
        return api("get_entity_state", entity=name).state.acceleration

    falling = acceleration("cube").linear
    assert (falling.x, falling.y, falling.z) == pytest.approx((0, 0, -9.8), abs=1e-9)
    fixed = acceleration("arm").linear
    assert (fixed.x, fixed.y, fixed.z) == (0, 0, 0)
    twist = {"twist": {"linear": {"x": 1.0}}}
    assert (
        api("set_entity_state", entity="arm", state=twist, set_twist=True).result.result == FAILED
    )
    assert api("set_entity_state", entity="arm", state=twist).result.result == OK
    assert api("set_entity_state", entity="cube", state=twist, set_twist=True).result.result == OK


def test_many_are_spawned_and_each_is_answered(make):
    api = interfaces(make.world())
    good = {"name": "one", "entity_resource": {"resource_string": URDF}}
    made = api("spawn_entities", spawn_requests=[good, good, {**good, "allow_renaming": True}])
    assert [each.result.result for each in made.results] == [OK, 101, OK]
    assert [each.entity_name for each in made.results] == ["one", "", "one_1"]
    assert made.result.result == 150 and made.result.error_message
    assert api.simulation.models == ("ground_plane", "one", "one_1")
    fine = api("spawn_entities", spawn_requests=[{**good, "name": "two"}])
    assert fine.result.result == OK
    named = api("spawn_entity", **good | {"name": "three", "entity_namespace": "3 bots"})
    assert named.result.result == 105  # NAMESPACE_INVALID
    assert api("reset_simulation", scope=4).result.result == OK
    assert api.simulation.models == ("ground_plane",)


def test_what_is_listed_can_be_spawned(make, tmp_path: Path):
    world = make.world()
    world.session.allow_path = (tmp_path, Path("/nowhere"))
    api = interfaces(world)
    (tmp_path / "a rock").mkdir()
    (tmp_path / "a rock" / "model.sdf").write_text(
        '<sdf version="1.6"><model name="rock"><link name="l"/></model></sdf>'
    )
    (tmp_path / "pebble.urdf").write_text(URDF)
    (tmp_path / "part.xacro").write_text("<robot/>")
    (tmp_path / "yard.world").write_text('<sdf version="1.6"><world name="yard"/></sdf>')
    (tmp_path / "torn.sdf").write_text("<sdf")
    listed = api("get_spawnables", sources=[str(tmp_path), "/nowhere"])
    assert listed.result.result == OK and "/nowhere" in listed.result.error_message
    uris = {each.description: each.entity_resource.uri for each in listed.spawnables}
    assert uris["rock"] == (tmp_path / "a rock" / "model.sdf").as_uri()
    assert uris.keys() >= {"rosbots", "traffic_cone", "rock", "pebble"}
    assert not uris.keys() & {"yard", "empty", ""}
    for name in ("rock", "pebble", "traffic_cone"):
        made = api("spawn_entity", entity_resource={"uri": uris[name]})
        assert (made.result.result, made.entity_name) == (OK, name), made.result.error_message

    worlds = api("get_available_worlds", additional_sources=[tmp_path.as_uri()])
    found = [(each.name, each.world_resource.uri) for each in worlds.worlds]
    assert ("yard", (tmp_path / "yard.world").as_uri()) in found
    assert "rock" not in {name for name, _ in found}
    assert any(uri.endswith("/worlds/empty.world") for _, uri in found)
    tagged = api("get_available_worlds", filter={"tags": ["indoor"]})
    assert (tagged.result.result, tagged.worlds) == (OK, [])
    lost = api("get_available_worlds", additional_sources=["/nowhere"])
    assert lost.result.result == FAILED
    partly = api("get_available_worlds", additional_sources=["/nowhere"], continue_on_error=True)
    assert (partly.result.result, len(partly.worlds)) == (OK, len(found) - 1)


def test_places_are_the_frames_that_stay(tmp_path: Path):
    file = tmp_path / "hall.world"
    file.write_text(WORLD)
    with cw.World(str(file)) as world:
        api = interfaces(world)
        (reported,) = coded(world, NAME_UNKNOWN)
        assert (reported.severity, reported.origin.line) == ("warning", 5)
        places = {each.name: each.pose for each in api("get_named_poses").poses}
        assert list(places) == ["door", "mat"]
        mat = places["mat"].position
        assert (mat.x, mat.y, mat.z) == pytest.approx((1, 3, 0), abs=1e-9)
        assert api("get_named_poses", tags={"tags": ["spawn"]}).poses == []
        assert api("get_named_pose_bounds", name="mat").result.result == UNSUPPORTED
        assert api("get_named_pose_bounds", name="hand").result.result == NOT_FOUND
        now = api("get_current_world").world
        assert (now.name, now.world_resource.uri) == ("hall", file.as_uri())


def test_features_say_what_is_answered(make):
    api = interfaces(make.world())
    known = vars(message_class("simulation_interfaces/msg/SimulatorFeatures"))
    names = {number: name for name, number in known.items() if name.isupper()}
    reported = {names[each] for each in api("get_simulator_features").features.features.tolist()}
    absent = set(names.values()) - reported
    assert len(names) == 32
    refused = {
        "POSE_BOUNDS": None,
        "SIMULATION_RESET_TIME": ("reset_simulation", {"scope": 1}),
        "WORLD_LOADING": ("load_world", {}),
        "WORLD_RESOURCE_STRING": ("load_world", {"world_resource": {"resource_string": WORLD}}),
        "WORLD_UNLOADING": ("unload_world", {}),
        "WORLD_TAGS": None,
    }
    assert absent == refused.keys()
    for name, request in filter(None, refused.values()):
        assert api(name, **request).result.result == UNSUPPORTED
    assert api("reset_simulation", scope=64).result.result == UNSUPPORTED
