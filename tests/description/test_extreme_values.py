"""Numbers and names at their extremes: a model that works, or an error with its place."""

import math
import random
import re
import warnings

import mujoco
import pytest
from tests.coded import coded, raises
from tests.description.test_every_tag_has_an_effect import DOCUMENTS

import cartwheel as cw
from cartwheel.checks import kinematic_tree, repairs
from cartwheel.checks.checking import check
from cartwheel.codes import devices
from cartwheel.codes import world as world_codes
from cartwheel.codes.robot import MASS_NOT_POSITIVE
from cartwheel.codes.tags import NAME_TAKEN, VALUE_INVALID
from cartwheel.description import load_text
from cartwheel.description.elements.node import Node
from cartwheel.description.model import WorldDescription
from cartwheel.errors import (
    CartwheelError,
    DivergedError,
    Origin,
    PluginError,
    WorldError,
)
from cartwheel.simulation.dynamics.divergence import Guard

_VALUES = ("0", "-1", "1e308", "-1e308", "1e-308", "nan", "inf", "-inf", "1e9", "1e-9")
_NUMBER = re.compile(r'(?<=[>"\s])-?\d+\.?\d*(?:[eE][-+]?\d+)?(?=[<"\s])')
_SAMPLE = 40
"""Documents of each kind that are compiled and run; all of them are read."""


def _changed(text):
    """The document with each of its numbers at some of the extremes.

    The numbers of a vector, which one function reads, have all of them together. Another number has
    half of them, and its neighbour the other half.
    """
    for count, vector in enumerate(_vectors(text)):
        parts = min(len(vector), 5) if len(vector) > 2 else 2
        for place, found in enumerate(vector):
            first = place if len(vector) > 2 else place + count
            for value in _VALUES[first % parts :: parts]:
                yield text[: found.start()] + value + text[found.end() :]


def _vectors(text):
    """Its numbers, those together with only spaces between them."""
    vectors = []
    end = None
    for found in _NUMBER.finditer(text):
        if end is not None and text[end : found.start()].isspace():
            vectors[-1].append(found)
        else:
            vectors.append([found])
        end = found.end()
    return vectors


def _refused(error):
    assert error.origin is not None or error.code is world_codes.SIMULATION_DIVERGED


@pytest.mark.parametrize("kind", DOCUMENTS)
def test_each_number_at_its_extremes(kind, tmp_path):
    """What is read also runs: a faulty number never ends in an error of Python's."""
    changed = list(_changed(DOCUMENTS[kind]))
    assert len(changed) > 5 * len(_VALUES)
    random.Random(0).shuffle(changed)
    ran = 0
    for count, text in enumerate(changed):
        try:
            description = load_text(text, file=str(tmp_path / "r.sdf"))
        except CartwheelError as error:
            _refused(error)
            continue
        if count >= _SAMPLE:
            continue
        try:
            world = description if isinstance(description, WorldDescription) else "empty"
            with cw.World(world, lenient=True) as made:
                if world == "empty":
                    made.spawn(description)
                made.run(0.02)
                faults = [each for each in made.diagnostics if each.details]
            assert faults == []
            ran += 1
        except CartwheelError as error:
            _refused(error)
    assert ran > 3


_LINK = '<link name="{}"><inertial><mass>{}</mass></inertial></link>'
_BOX = """<model name="b{}"><link name="l"><collision name="c"><geometry><box><size>1 1 1</size>
</box></geometry></collision></link></model>"""


def _world(inside):
    described = load_text(f'<sdf version="1.7"><world name="w">{inside}</world></sdf>', file="w")
    assert isinstance(described, WorldDescription)
    return described


@pytest.mark.parametrize("step", ["1e-12", "0", "-0.001", "1e308", "2", "9e-7"])
def test_a_step_that_cannot_be_made(step):
    with raises(VALUE_INVALID, tag="max_step_size") as got:
        _world(f"<physics><max_step_size>{step}</max_step_size></physics>")
    assert str(got.value.origin) == "w:1"


def test_lights_of_one_name():
    world = _world('<light name="a" type="point"/>\n<light name="a" type="point"/>')
    with cw.World(world) as made:
        made.run(0.01)
        (reported,) = coded(made, NAME_TAKEN, renamed="a_1")
    assert [light.name for light in world.lights] == ["a", "a_1"]
    assert str(reported.origin) == "w:2" and reported.severity == "warning"


@pytest.mark.parametrize("form", ["sdf", "urdf"])
def test_a_mass_that_nothing_has(form):
    links = _LINK.format("a", "1e308") + _LINK.format("b", "1e308")
    joint = '<joint name="j" type="fixed"><parent>a</parent><child>b</child></joint>'
    text = f'<sdf version="1.7"><model name="m">{links}{joint}</model></sdf>'
    if form == "urdf":
        inertia = '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>'
        mass = f'<inertial><mass value="1e308"/>{inertia}</inertial>'
        text = f'<robot name="m"><link name="a">{mass}</link></robot>'
    expected = raises(MASS_NOT_POSITIVE, link="a", stated=1e308)
    if form == "urdf":
        expected = raises(VALUE_INVALID, tag="inertial")
    with expected as got:
        load_text(text, file="m")
    assert str(got.value.origin) == "m:1"


def test_boxes_in_one_place():
    world = _world("\n".join(_BOX.format(count) for count in range(400)))
    with pytest.raises(WorldError) as got:
        cw.World(world)
    assert got.value.code is world_codes.TOO_MANY_CONTACTS
    assert got.value.values["contacts"] > 10_000
    assert str(got.value.origin).startswith("w:")


def test_a_few_boxes_in_one_place_come_apart():
    world = _world("\n".join(_BOX.format(count) for count in range(5)))
    with cw.World(world) as made:
        made.run(0.05)
        assert made.time == pytest.approx(0.05)


@pytest.mark.parametrize("form", ["sdf", "urdf"])
def test_a_chain_of_thousands_of_links(form):
    count = 3000
    joint = '<joint name="j{0}" type="revolute"><parent link="l{0}"/><child link="l{1}"/>'
    joint += '<limit effort="1" velocity="1" lower="-1" upper="1"/></joint>'
    link, ends = '<link name="l{}"/>', ('<robot name="r">', "</robot>")
    if form == "sdf":
        joint = '<joint name="j{0}" type="ball"><parent>l{0}</parent><child>l{1}</child></joint>'
        ends = ('<sdf version="1.7"><model name="r">', "</model></sdf>")
    lines = [link.format(each) for each in range(count)]
    lines += [joint.format(each, each + 1) for each in range(count - 1)]
    described = load_text("\n".join([*ends[:1], *lines, *ends[1:]]), file="r")
    with cw.World("empty") as world, pytest.raises(WorldError) as got:
        world.spawn(described)
    assert got.value.code is world_codes.CHAIN_TOO_LONG
    assert got.value.values["link"] == "l500"
    assert str(got.value.origin) == "r:502"


def test_a_chain_of_hundreds_of_links_works():
    lines = [_LINK.format(each, 1) for each in range(200)]
    lines += [
        f'<joint name="j{each}" type="fixed"><parent>{each}</parent>'
        f"<child>{each + 1}</child></joint>"
        for each in range(199)
    ]
    described = load_text(
        f'<sdf version="1.7"><model name="r">{"".join(lines)}</model></sdf>', file="r"
    )
    with cw.World("empty") as world:
        world.spawn(described)
        world.run(0.02)
        assert len(described.links) == 200


_TWICE = {
    "link": '<link name="a"/><link name="a"/>',
    "joint": '<link name="a"/><link name="b"/><link name="c"/>'
    '<joint name="j" type="ball"><parent>a</parent><child>b</child></joint>'
    '<joint name="j" type="ball"><parent>b</parent><child>c</child></joint>',
    "frame": '<link name="a"/><frame name="f"/><frame name="f"/>',
    "visual": '<link name="a">' + 2 * '<visual name="v"><geometry><sphere><radius>1</radius>'
    "</sphere></geometry></visual>" + "</link>",
    "collision": '<link name="a">' + 2 * '<collision name="v"><geometry><sphere><radius>1</radius>'
    "</sphere></geometry></collision>" + "</link>",
    "sensor": '<link name="a">' + 2 * '<sensor name="s" type="imu"/>' + "</link>",
    "light": '<link name="a">' + 2 * '<light name="s" type="point"/>' + "</link>",
    "plugin": '<link name="a"/>' + 2 * '<plugin name="p" filename="libgazebo_ros_p3d.so">'
    "<bodyName>a</bodyName></plugin>",
    "model": '<link name="a"/>' + 2 * '<model name="m"><link name="a"/></model>',
}


@pytest.mark.parametrize("kind", _TWICE)
def test_a_name_that_stands_twice(kind):
    text = (
        f'<sdf version="1.7"><world name="w"><model name="r">{_TWICE[kind]}</model></world></sdf>'
    )
    try:
        with cw.World(load_text(text, file="w")) as world:
            world.run(0.01)
            assert world.time > 0
    except CartwheelError as error:
        assert error.origin is not None
        assert error.code is NAME_TAKEN


_MENDED = {
    "a plane's tiny normal": ("model", "<normal>0 1 0<", "<normal>0 1e-308 0<"),
    "a polyline's tiny side": ("model", "<point>1 0</point>", "<point>1e-308 0</point>"),
    "a link far from the next": ("state", "<pose>0 0 1 0 0 0<", "<pose>0 0 1e9 0 0 0<"),
}


@pytest.mark.parametrize("case", _MENDED)
def test_extremes_that_work_without_a_warning(case, tmp_path):
    kind, old, new = _MENDED[case]
    text = DOCUMENTS[kind].replace(old, new, 1)
    assert text != DOCUMENTS[kind]
    with warnings.catch_warnings():
        warnings.simplefilter("error", RuntimeWarning)
        warnings.simplefilter("error", UserWarning)
        description = load_text(text, file=str(tmp_path / "r.sdf"))
        world = description if isinstance(description, WorldDescription) else "empty"
        with cw.World(world, lenient=True) as made:
            if world == "empty":
                made.spawn(description)
            made.run(0.02)
            assert made.time == pytest.approx(0.02)


_REFUSED = {
    "height": ("model", "<height>2<", "<height>1e308<", "height"),
    "angle": ("state", '<angle axis="0">0.3<', '<angle axis="0">1e308<', "angle"),
}


@pytest.mark.parametrize("case", _REFUSED)
def test_extremes_that_are_refused_with_their_place(case, tmp_path):
    kind, old, new, tag = _REFUSED[case]
    text = DOCUMENTS[kind].replace(old, new, 1)
    with raises(VALUE_INVALID, tag=tag) as got:
        load_text(text, file=str(tmp_path / "r.sdf"))
    assert got.value.origin is not None
    line = text[: text.index(new)].count("\n") + 1
    assert str(got.value.origin).endswith(f":{line}")


def test_a_state_beyond_all_numbers_ends_without_a_warning_of_numpy():
    model = mujoco.MjModel.from_xml_string(
        "<mujoco><worldbody><body><freejoint/><geom size='1'/></body></worldbody></mujoco>"
    )
    data = mujoco.MjData(model)
    guard = Guard()
    guard.bind(model, data)
    data.qpos[0] = 1e200
    with warnings.catch_warnings(), pytest.raises(DivergedError):
        warnings.simplefilter("error")
        guard.check()


@pytest.mark.parametrize("form", ["urdf", "sdf"])
def test_a_check_of_a_long_chain_looks_at_each_joint_a_few_times(form, tmp_path, monkeypatch):
    count = 600
    links = "".join(f'<link name="l{each}"/>' for each in range(count))
    joint = '<joint name="j{0}" type="fixed"><parent link="l{0}"/><child link="l{1}"/></joint>'
    ends = ('<robot name="r">', "</robot>")
    if form == "sdf":
        joint = '<joint name="j{0}" type="fixed"><parent>l{0}</parent><child>l{1}</child></joint>'
        ends = ('<sdf version="1.7"><model name="r">', "</model></sdf>")
    joints = "".join(joint.format(each, each + 1) for each in range(count - 1))
    file = tmp_path / f"r.{form}"
    file.write_text(ends[0] + links + joints + ends[1])
    looks = 0
    original = kinematic_tree.ends

    def counted(node):
        nonlocal looks
        looks += 1
        return original(node)

    monkeypatch.setattr(kinematic_tree, "ends", counted)
    monkeypatch.setattr(repairs, "ends", counted)
    assert check(file).complete
    assert looks < 30 * count


def test_rings_of_joints_are_found_once_each():
    def holder(parent):
        place = Origin(file="r", line=1)
        return Node("joint", {}, place, [Node("parent", {"link": parent}, place)])

    parents = {"a": "b", "b": "c", "c": "b", "d": "e", "e": "root", "f": "f", "g": "a"}
    found = kinematic_tree.rings({link: holder(parent) for link, parent in parents.items()})
    assert found == [["b", "c"], ["f"]]


_SENSOR = """<robot name="r"><link name="a"/><gazebo reference="a">
<sensor name="s" type="{}"><update_rate>{}</update_rate>
{}
<plugin name="p" filename="{}"/></sensor></gazebo></robot>"""
_SCAN = """<ray><scan><horizontal>
<samples>{}</samples>
<resolution>{}</resolution><min_angle>-1</min_angle><max_angle>1</max_angle></horizontal>
<vertical><samples>{}</samples></vertical></scan><range><min>0.1</min><max>9</max></range>
<noise><type>gaussian</type>
<stddev>{}</stddev></noise></ray>"""
_CAMERA = """<camera><image><width>{}</width><height>{}</height></image>
<clip><near>{}</near><far>{}</far></clip></camera>"""
_TOO_MUCH = {
    "no samples": ((0, 1, 1, 0), 4, devices.SCAN_SAMPLES_INVALID),
    "negative": ((-1, 1, 1, 0), 4, devices.SCAN_SAMPLES_INVALID),
    "samples": (("1e9", 1, 1, 0), 4, devices.SCAN_SAMPLES_INVALID),
    "resolution": ((9, "1e308", 1, 0), 5, devices.PLUGIN_PARAMETER_INVALID),
    "both": ((9, "1e9", 1, 0), 5, devices.SCAN_SAMPLES_INVALID),
    "rows": ((2000, 1, 2000, 0), 4, devices.SCAN_SAMPLES_INVALID),
    "noise": ((9, 1, 1, "1e308"), 8, devices.PLUGIN_PARAMETER_INVALID),
}  # fmt: skip


@pytest.mark.parametrize("case", _TOO_MUCH)
def test_scans_beyond_their_bounds(case):
    values, line, code = _TOO_MUCH[case]
    text = _SENSOR.format("ray", 10, _SCAN.format(*values), "libgazebo_ros_laser.so")
    with cw.World("empty") as world, pytest.raises(PluginError) as got:
        world.spawn(load_text(text, file="r"))
    assert got.value.code is code
    assert str(got.value.origin) == f"r:{line}"


@pytest.mark.parametrize("rate", ["1e-308", "1e300", "1e-9"])
def test_a_rate_beyond_all_clocks(rate):
    text = _SENSOR.format("ray", rate, _SCAN.format(9, 1, 1, 0.1), "libgazebo_ros_laser.so")
    with cw.World("empty") as world:
        world.spawn(load_text(text, file="r"))
        (topic,) = (each.name for each in world.graph.topics() if "LaserScan" in each.type)
        scans = world.mailbox(topic)
        world.run(0.02)
        assert scans.get() is not None
        assert [each for each in world.diagnostics if each.details] == []


@pytest.mark.parametrize(
    ("values", "line", "tag"),
    [
        ((1_000_000, 1_000_000, 0.1, 9), 3, "height"),
        (("1e308", 1, 0.1, 9), 3, "height"),
        ((-1, 1, 0.1, 9), 3, "width"),
        ((9, 9, "1e-308", 9), 4, "near"),
        ((9, 9, 0.1, "1e308"), 4, "far"),
        ((9, 9, 9, 0.1), 4, "near"),
    ],
)
def test_cameras_beyond_their_bounds(values, line, tag):
    text = _SENSOR.format("camera", 10, _CAMERA.format(*values), "libgazebo_ros_camera.so")
    (error,) = coded(load_text(text, file="r"), VALUE_INVALID, tag=tag, left_out="sensor")
    assert str(error.origin) == f"r:{line}"


_PLACES = {
    "urdf origin": ('<robot name="r"><link name="a"/><link name="b"/>'
                    '<joint name="j" type="fixed"><parent link="a"/><child link="b"/>\n'
                    '<origin xyz="0 0 {}"/></joint></robot>', "origin xyz"),
    "sdf model": ('<sdf version="1.7"><model name="m">\n<pose>0 {} 0 0 0 0</pose>'
                  '<link name="a"/></model></sdf>', "pose"),
    "sdf quaternion": ('<sdf version="1.9"><model name="m">\n'
                       '<pose rotation_format="quat_xyzw">{} 0 0 0 0 0 1</pose>'
                       '<link name="a"/></model></sdf>', "pose"),
}  # fmt: skip


@pytest.mark.parametrize("value", ["1.1e9", "-1e10", "1e12", "9e14"])
@pytest.mark.parametrize("case", _PLACES)
def test_a_pose_far_beyond_all_worlds(case, value):
    text, name = _PLACES[case]
    with raises(VALUE_INVALID, name=name, stated=float(value)) as got:
        load_text(text.format(value), file="r")
    assert str(got.value.origin) == "r:2"
    assert load_text(text.format("1e9"), file="r")


_ARM = """<robot name="r"><link name="a"/>{}{}
<joint name="i" type="continuous"><parent link="a"/><child link="b"/></joint>
<joint name="j" type="continuous"><parent link="a"/><child link="c"/>
{}</joint>
{}</robot>""".replace("{}{}", "".join(
    f'<link name="{name}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" '
    'ixz="0" iyz="0"/></inertial></link>' for name in "bc"
))  # fmt: skip
_FOLLOWER = """<gazebo><plugin name="p" filename="libgazebo_mimic_joint_plugin.so">
<joint>i</joint><mimicJoint>j</mimicJoint>
<{0}>{1}</{0}></plugin></gazebo>"""


@pytest.mark.parametrize("value", ["1e308", "-1e15", "1.1e6"])
@pytest.mark.parametrize("name", ["multiplier", "offset"])
def test_a_joint_that_follows_by_an_absurd_ratio(name, value):
    mimic = f'<mimic joint="i" {name}="{value}"/>'
    with raises(VALUE_INVALID, name=f"mimic {name}", stated=float(value)) as got:
        load_text(_ARM.format(mimic, ""), file="r")
    assert str(got.value.origin) == "r:4"
    described = load_text(_ARM.format("", _FOLLOWER.format(name, value)), file="r")
    with cw.World("empty") as world, pytest.raises(PluginError) as failed:
        world.spawn(described)
    assert failed.value.code is devices.PLUGIN_PARAMETER_INVALID
    assert failed.value.values["parameter"] == name
    assert str(failed.value.origin) == "r:7"


_DRIVES = {
    "skid steer": ("libgazebo_ros_skid_steer_drive.so", "wheelSeparation"),
    "new diff drive": ("gz-sim-diff-drive-system", "wheel_radius"),
}


@pytest.mark.parametrize("value", ["1e308", "1e15", "1e-300"])
@pytest.mark.parametrize("case", _DRIVES)
def test_wheels_of_an_absurd_size(case, value):
    filename, tag = _DRIVES[case]
    plugin = f"""<gazebo><plugin name="p" filename="{filename}">
<leftFrontJoint>i</leftFrontJoint><rightFrontJoint>j</rightFrontJoint>
<leftRearJoint>i</leftRearJoint><rightRearJoint>j</rightRearJoint>
<left_joint>i</left_joint><right_joint>j</right_joint>
<{tag}>{value}</{tag}></plugin></gazebo>"""
    described = load_text(_ARM.format("", plugin), file="r")
    with cw.World("empty") as world, pytest.raises(PluginError) as got:
        world.spawn(described)
    assert got.value.code is devices.PLUGIN_PARAMETER_INVALID
    assert str(got.value.origin) == ("r:9" if value == "1e308" else "r:5")


def test_a_divergence_names_the_place_of_its_link():
    text = _ARM.format("", "").replace("<link", "\n<link", 1)
    described = load_text(text, file="r")
    with cw.World("empty") as world:
        world.spawn(described)
        world.session.simulation.data.joint("r::j").qvel[0] = math.nan
        with pytest.raises(DivergedError) as got:
            world.run(0.1)
    assert got.value.values["body"] == "r::a"
    assert str(got.value.origin) == "r:2"


_CAMERA_NUMBERS = {
    "distortion": ("<distortion><k1>{}</k1></distortion>", "<k1>"),
    "noise": ("<noise><type>gaussian</type><stddev>{}</stddev></noise>", "<stddev>"),
}


@pytest.mark.parametrize("case", _CAMERA_NUMBERS)
def test_a_lens_that_nothing_has(case):
    inside, name = _CAMERA_NUMBERS[case]
    camera = f"<camera>\n{inside.format('1e308')}</camera>"
    text = _SENSOR.format("camera", 10, camera, "libgazebo_ros_camera.so")
    robot = load_text(text, file="r")
    (error,) = coded(robot, VALUE_INVALID, name=name, stated=1e308, left_out="sensor")
    assert str(error.origin) == "r:4"
