"""Models in, by their text, and out again."""

import errno
import math
import threading
from concurrent.futures import ThreadPoolExecutor, wait

import pytest
from tests.coded import coded, raises

from cartwheel.api import World
from cartwheel.codes.devices import PLUGIN_PARAMETER_INVALID
from cartwheel.codes.files import FILE_MISSING
from cartwheel.codes.graph import ENTITY_NAME_TAKEN, GRAPH_CLOSED
from cartwheel.codes.running import PLUGIN_LEFT_OUT
from cartwheel.codes.world import UNKNOWN_MODEL
from cartwheel.gazebo.entities import Entities
from cartwheel.gazebo.spawning import Spawning
from cartwheel.geometry import Pose, quat_from_rpy

from .conftest import SDF, URDF, pose_fields

BOTH = pytest.mark.parametrize("service", ["spawn_urdf_model", "spawn_sdf_model"])


@pytest.fixture
def api(make, gazebo):
    return gazebo(make.world())


@pytest.mark.wording
def test_a_world_that_includes_one_model_is_that_model(api):
    include = "<include><uri>model://traffic_cone</uri></include>"
    text = f'<sdf version="1.4"><world name="default">{include}</world></sdf>'
    api.done("spawn_sdf_model", model_name="mine", model_xml=text)
    assert api.world.models == ("ground_plane", "mine")
    two = text.replace(include, include + include.replace("traffic_cone", "wall"))
    refused = api.refused("spawn_sdf_model", model_name="other", model_xml=two)
    assert "not a model" in refused


@BOTH
@pytest.mark.parametrize("text", [URDF, SDF])
def test_either_service_takes_either_text(api, service, text):
    answer = api.done(
        service, model_name="mine", model_xml=text, initial_pose=pose_fields((1, 2, 3))
    )
    assert answer.status_message == "SpawnModel: Successfully spawned entity"
    assert api.world.models == ("ground_plane", "mine")
    # An SDF model's own pose adds to the initial one, as in Gazebo.
    above = 0.5 if text is SDF else 0.0
    assert api.world.model("mine").pose.position == pytest.approx((1, 2, 3 + above))
    api.world.run(3.0)
    assert api.world.model("mine").pose.z == pytest.approx(0.1, abs=2e-3)


def test_without_a_name_it_has_its_own(api):
    api.done("spawn_urdf_model", model_xml=URDF)
    assert api.world.models == ("ground_plane", "brick")


@pytest.mark.parametrize("frame", ["base", "base::link"])
def test_in_the_frame_of_a_model_or_link(make, api, frame):
    turn = quat_from_rpy(0, 0, math.pi / 2)
    api.world.session.spawn(make.box("base", (0.1,) * 3, pose=Pose((5, 0, 1), turn)))
    api.done(
        "spawn_urdf_model",
        model_name="mine",
        model_xml=URDF,
        initial_pose=pose_fields((2, 0, 0.5)),
        reference_frame=frame,
    )
    found = api.world.model("mine").pose
    assert found.position == pytest.approx((5, 2, 1.5))
    assert found.yaw == pytest.approx(math.pi / 2)


@pytest.mark.parametrize("frame", ["", "world", "map", "/map"])
def test_in_the_worlds_frame(api, frame):
    api.done(
        "spawn_urdf_model",
        model_xml=URDF,
        initial_pose=pose_fields((2, 0, 0.5)),
        reference_frame=frame,
    )
    assert api.world.model("brick").pose.position == pytest.approx((2, 0, 0.5))


def test_a_pose_that_was_left_out_is_the_origin(api):
    """As ``Pose()`` in a caller's code: an orientation of zeros."""
    api.done("spawn_urdf_model", model_xml=URDF)
    assert api.world.model("brick").pose.position == (0, 0, 0)
    assert api.world.model("brick").pose.orientation == (0, 0, 0, 1)


def test_namespace_and_prefix(api, rosbots):
    """Relative topics go under the namespace; frames under its tf_prefix."""
    api.world.graph.parameters.set("/left/tf_prefix", "left_robot")
    api.done(
        "spawn_urdf_model",
        model_name="left",
        model_xml=rosbots.text,
        robot_namespace="/left",
        initial_pose=pose_fields((0, 0, 0.05)),
    )
    topics = {topic.name for topic in api.world.graph.topics()}
    assert "/left/imu/data" in topics
    box = api.world.mailbox("/left/imu/data")
    api.world.run(0.2)
    assert box.drain()[-1].header.frame_id.startswith("left_robot/")


def test_two_of_a_kind(api):
    for index, name in enumerate(("one", "two")):
        api.done(
            "spawn_urdf_model",
            model_name=name,
            model_xml=URDF,
            initial_pose=pose_fields((index, 0, 1)),
        )
    assert api.world.models == ("ground_plane", "one", "two")


def test_the_text_is_read_on_the_callers_thread(api, monkeypatch):
    """Meshes take long: the simulation goes on while they are read."""
    from cartwheel.gazebo import spawning

    threads = []
    load_plain = spawning.load_plain

    def load(*args, **more):
        threads.append(threading.current_thread())
        return load_plain(*args, **more)

    monkeypatch.setattr(spawning, "load_plain", load)
    api.done("spawn_urdf_model", model_xml=URDF)
    assert threads
    assert threads[0] is not threading.current_thread()


def test_packages_are_found_on_the_path(make, gazebo, tmp_path):
    package = tmp_path / "things"
    package.mkdir()
    (package / "package.xml").write_text("<package><name>things</name></package>")
    (package / "tri.stl").write_text(
        "solid t\n"
        + "".join(
            f"facet normal 0 0 1\nouter loop\nvertex {a}\nvertex {b}\nvertex {c}\n"
            "endloop\nendfacet\n"
            for a, b, c in (
                ("0 0 0", "1 0 0", "0 1 0"),
                ("0 0 0", "0 0 1", "1 0 0"),
                ("0 0 0", "0 1 0", "0 0 1"),
                ("1 0 0", "0 0 1", "0 1 0"),
            )
        )
        + "endsolid t\n"
    )
    text = URDF.replace('<box size="0.2 0.2 0.2"/>', '<mesh filename="package://things/tri.stl"/>')

    def reported(api):
        api.done("spawn_urdf_model", model_xml=text)
        return coded(api.world.session, FILE_MISSING, kind="package", name="things")

    (lost,) = reported(gazebo(make.world()))
    assert lost.severity == "error"
    assert reported(gazebo(make.world(), package_path=[tmp_path])) == []


@BOTH
@pytest.mark.wording
@pytest.mark.parametrize(
    ("fields", "said"),
    [
        ({"model_xml": ""}, "model_xml is empty"),
        ({"model_xml": "hello"}, "<model_xml of mine>:1"),
        ({"model_xml": URDF.replace("</link>", "</lnk>")}, "<model_xml of mine>:"),
        ({"model_xml": URDF.replace('<mass value="', '<mass value="x')}, "<model_xml of mine>:4"),
        ({"model_xml": "<launch/>"}, "a launch file"),
        (
            {"model_xml": '<sdf version="1.6"><world name="w"/></sdf>'},
            'describes the world "w", not a model',
        ),
        ({"reference_frame": "nowhere"}, 'reference frame "nowhere" does not exist'),
        (
            {"initial_pose": {"position": {"x": math.nan}}},
            "initial_pose.position.x must be a finite number (got nan)",
        ),
        ({"initial_pose": {"orientation": {"x": 1e-300, "w": 0.0}}}, "not a rotation"),
        ({"model_name": "ground_plane"}, 'model name "ground_plane" already exists'),
        ({"model_name": "a::b"}, 'must not be empty or contain "::"'),
    ],
)
@pytest.mark.wording
def test_refusals(api, service, fields, said):
    message = api.refused(service, **{"model_name": "mine", "model_xml": URDF} | fields)
    assert message.startswith("SpawnModel: ")
    assert said in message
    assert "\n" not in message


def test_a_taken_name_comes_with_a_free_one(api):
    for name in ("mine", "mine_1"):
        api.done("spawn_urdf_model", model_name=name, model_xml=URDF)
    free = {"name": "mine", "free": "mine_2"}
    api.fails("spawn_urdf_model", ENTITY_NAME_TAKEN, free, model_name="mine", model_xml=URDF)


def test_after_the_end_there_is_an_answer(make, gazebo):
    """Nobody runs what is posted any more."""
    api = gazebo(make.world())
    api.simulation.stop()
    with raises(GRAPH_CLOSED), ThreadPoolExecutor() as pool:
        spawning = Spawning(api.world.session, Entities(api.simulation), ())
        pool.submit(spawning.on_owner, lambda: None).result(timeout=60)
    request = api.request("spawn_urdf_model", model_xml=URDF)
    with ThreadPoolExecutor() as pool:
        future = pool.submit(api.world.graph.call, "/gazebo/spawn_urdf_model", request)
        answer = future.result(timeout=60).result(timeout=60)
    assert not answer.success
    assert answer.status_message


LAMP = """<?xml version="1.0"?>
<!-- a lamp -->
<sdf version="1.6">
  <light name="lamp" type="point"><pose>0 0 1 0 0 0</pose>
    <diffuse>0.25 0.5 0.75 1</diffuse></light>
</sdf>"""


def test_a_light(make, api):
    """As Gazebo does: a light alone may be spawned, and is deleted as a light."""
    api.world.session.spawn(make.box("base", (0.1,) * 3, pose=Pose((5, 0, 1))))
    api.done(
        "spawn_sdf_model",
        model_name="mine",
        model_xml=LAMP,
        initial_pose=pose_fields((0, 2, 0)),
        reference_frame="base",
    )
    light = api.simulation.model.light("mine")
    assert light.pos.tolist() == pytest.approx([5, 2, 2])
    assert light.diffuse.tolist() == pytest.approx([0.25, 0.5, 0.75])
    lights = api.simulation.model.nlight
    assert api.refused("spawn_sdf_model", model_name="mine", model_xml=LAMP)
    assert api.simulation.model.nlight == lights
    broken = LAMP.replace("point", "pint")
    assert "<model_xml of other>:4" in api.refused(
        "spawn_sdf_model", model_name="other", model_xml=broken
    )
    api.done("delete_light", light_name="mine")
    api.done("spawn_sdf_model", model_xml=LAMP)
    assert api.done("get_light_properties", light_name="lamp").diffuse.g == pytest.approx(0.5)


def test_a_hundred_comments_do_not_hang_the_search_for_a_light(api):
    """Looking for a light must not try every way to part a hundred comments."""
    text = SDF.replace("<sdf", "<!-- a -->" * 100 + "<sdf").replace(
        "<model", "<!-- b -->" * 100 + "<model"
    )
    api.done("spawn_sdf_model", model_xml=text)


def test_an_error_that_looks_like_a_wait_that_is_over_is_raised(api):
    """The file system of another computer raises the error that a bounded wait ends with."""

    def load():
        raise TimeoutError(errno.ETIMEDOUT, "the file server does not answer")

    spawning = Spawning(api.world.session, Entities(api.simulation), ())
    with ThreadPoolExecutor() as pool:
        future = pool.submit(spawning.on_owner, load)
        while not future.done():
            api.simulation.drain()
            wait((future,), timeout=0.01)
        with pytest.raises(TimeoutError):
            future.result()


def test_on_the_owners_own_thread(api):
    """A script of one thread: nobody else could run it."""
    request = api.request("spawn_urdf_model", model_name="mine", model_xml=URDF)
    answer = api.world.graph.call("/gazebo/spawn_urdf_model", request).result(timeout=60)
    assert answer.success
    assert api.world.models == ("ground_plane", "mine")


def test_delete(api):
    api.done("spawn_urdf_model", model_name="mine", model_xml=URDF)
    api.world.run(0.1)
    answer = api.done("delete_model", model_name="mine")
    assert answer.status_message == "DeleteModel: successfully deleted model"
    assert api.world.models == ("ground_plane",)
    meant = {"name": "ground_plan", "meant": "ground_plane"}
    api.fails("delete_model", UNKNOWN_MODEL, meant, model_name="ground_plan")
    api.done("spawn_urdf_model", model_name="mine", model_xml=URDF)


def test_while_it_is_paused(api):
    api("pause_physics")
    api.done("spawn_urdf_model", model_name="mine", model_xml=URDF)
    assert api.done("get_model_state", model_name="mine").success
    assert api.simulation.time_ns == 0


@BOTH
@pytest.mark.parametrize("lenient", [True, False])
def test_a_service_leaves_out_plugins_as_spawn_does(make, gazebo, service, lenient):
    plugin = (
        '<gazebo><plugin name="p" filename="libgazebo_ros_p3d.so"><bodyName>base</bodyName>'
        "<updateRate>-5</updateRate></plugin></gazebo></robot>"
    )
    text = URDF.replace("</robot>", plugin)
    with World("empty", lenient=lenient) as world:
        api = gazebo(world)
        if not lenient:
            api.refused(service, model_name="mine", model_xml=text)
            assert world.models == ("ground_plane",)
            return
        api.done(service, model_name="mine", model_xml=text)
        assert world.models == ("ground_plane", "mine")
        (left_out,) = coded(world, PLUGIN_LEFT_OUT)
        assert left_out.values["cause"] == PLUGIN_PARAMETER_INVALID.number
