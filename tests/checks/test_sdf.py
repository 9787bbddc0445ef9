"""Models and worlds of SDF go through the same rules."""

import pytest
from tests.checks.seeded import (
    IN_SDF,
    IN_SDF_OF_A_URDF,
    inserted,
    model,
    world,
)
from tests.coded import raises

from cartwheel.checks.checking import check
from cartwheel.codes import code_named, files
from cartwheel.description.files.named_files import shipped_descriptions
from cartwheel.errors import DescriptionError


def test_a_good_model_and_a_good_world_are_clean(bench):
    assert bench.report(model(), "m.sdf").findings == ()
    assert bench.report(world(), "w.world").findings == ()


@pytest.mark.parametrize(("rule", "text", "line"), IN_SDF)
def test_a_fault_is_found_at_its_line(bench, rule, text, line):
    found = bench.find(text, rule, "x.sdf")
    assert found, bench.report(text, "x.sdf").findings
    assert found[0].origin.line == line


def test_advice_is_written_as_sdf_has_it(bench):
    found = bench.find(model(i="100", izz="100"), "inertia-geometry-mismatch", "x.sdf")
    assert found[0].instead == (
        "<inertia><ixx>1</ixx><ixy>0</ixy><ixz>0</ixz><iyy>1</iyy><iyz>0</iyz><izz>1</izz></inertia>"
    )


def test_sdf_in_a_urdf_is_clean_where_it_is_good(bench):
    assert bench.report(inserted(), "r.urdf").findings == ()
    # SDF's 1 kg counts: Gazebo does not drop it, as it would a link of a URDF.
    assert bench.report(inserted('<link name="bare"/>'), "r.urdf").findings == ()


@pytest.mark.parametrize(("rule", "text", "line", "instead"), IN_SDF_OF_A_URDF)
def test_sdf_in_a_urdf_has_its_findings_and_its_words(bench, rule, text, line, instead):
    (found,) = bench.find(text, rule, "r.urdf")
    assert found.origin.line == line
    assert instead in found.instead


def test_degrees_that_say_so_are_none(bench):
    text = model(yaw="90").replace("<pose>", '<pose degrees="true">')
    assert not bench.find(text, "angle-in-degrees", "m.sdf")


def test_the_worlds_own_step_bounds_the_rates(bench):
    rate = "<update_rate>300</update_rate>"
    sensor = f'<link name="eye"><sensor name="s" type="imu">\n{rate}</sensor></link>'
    slow = '<physics type="ode"><max_step_size>0.01</max_step_size></physics>\n'
    assert not bench.find(world(inner=sensor), "rate-above-physics", "w.world")
    found = bench.find(world(slow, sensor), "rate-above-physics", "w.world")
    assert found[0].instead == "<update_rate>100</update_rate>"


@pytest.mark.wording
def test_a_rate_above_that_of_the_physics_has_the_name_of_its_tag(bench):
    tag = "<odom_publish_frequency>2e3</odom_publish_frequency>"
    plugin = f'<plugin name="d" filename="gz-sim-diff-drive-system">{tag}</plugin>'
    text = model().replace("</model>", f"{plugin}</model>")
    (found,) = bench.find(text, "rate-above-physics", "m.sdf")
    assert found.message.startswith("<odom_publish_frequency> of 2000 Hz exceeds")


def test_a_version_too_old_leaves_the_check_incomplete(bench):
    report = bench.report('<gazebo version="0.9"><world name="w"/></gazebo>', "w.world")
    assert not report.complete
    assert report.findings[0].code is code_named("sdf-version")


def test_what_is_no_description_is_refused(bench):
    with raises(files.NOT_A_DESCRIPTION, tag="launch"):
        bench.report("<launch/>", "x.launch")
    with raises(files.NOT_A_DESCRIPTION, tag="robot"):
        bench.report('<robot xmlns:xacro="http://www.ros.org/wiki/xacro"/>', "x.xacro")


@pytest.mark.parametrize("path", list(shipped_descriptions()), ids=lambda path: path.name)
def test_what_is_shipped_is_clean(path):
    if "<robot" in (text := path.read_text()) and "<link" not in text:
        pytest.skip("a file of macros")
    try:
        report = check(path)
    except DescriptionError as error:
        assert error.code is files.NOT_A_DESCRIPTION
        return
    assert report.findings == ()


WHEELS = """<sdf version="1.6"><model name="m">
<link name="base"><inertial><mass>6</mass></inertial></link>
{wheels}
<plugin name="d" filename="libgazebo_ros_diff_drive.so">
<left_joint>left</left_joint><right_joint>right</right_joint>
<wheel_separation>{separation}</wheel_separation></plugin>
</model></sdf>"""


def wheel(name, y):
    """One whose link's frame is that of the model, as many models of SDF have it."""
    return (
        f'<link name="{name}_wheel"><inertial><pose>0 {y} 0 0 0 0</pose></inertial></link>'
        f'<joint name="{name}" type="revolute"><pose>0 {y} 0 -1.5707963 0 0</pose>'
        f"<parent>base</parent><child>{name}_wheel</child><axis><xyz>0 0 1</xyz></axis></joint>"
    )


def test_wheels_are_apart_as_their_joints_are(bench):
    wheels = wheel("left", 0.15) + wheel("right", -0.15)
    good = WHEELS.format(wheels=wheels, separation=0.3)
    assert not bench.find(good, "wheel-separation-mismatch", "x.sdf")
    (finding,) = bench.find(
        WHEELS.format(wheels=wheels, separation=0.6), "wheel-separation-mismatch", "x.sdf"
    )
    assert finding.instead == "<wheel_separation>0.3</wheel_separation>"


def test_tapered_wheels_are_apart_as_the_parts_that_touch_the_ground(bench):
    """A hub of 0.1 m from the joint outward, and a tyre on its outer end."""
    shape = (
        "<collision name='{name}'><pose>0 {y} 0 -1.5707963 0 0</pose><geometry><cylinder><radius>"
        "{radius}</radius><length>{length}</length></cylinder></geometry></collision></link>"
    )
    wheels = ""
    for name, side in (("left", 1), ("right", -1)):
        hub = shape.format(name="hub", y=side * 0.2, radius=0.08, length=0.1)
        tyre = shape.format(name="tyre", y=side * 0.24, radius=0.1, length=0.02)
        text = wheel(name, side * 0.15).replace("</link>", hub, 1)
        wheels += text.replace("</link>", tyre, 1)
    (finding,) = bench.find(
        WHEELS.format(wheels=wheels, separation=0.4), "wheel-separation-mismatch", "x.sdf"
    )
    assert finding.instead == "<wheel_separation>0.48</wheel_separation>"


def test_a_joint_that_cannot_be_read_is_no_missing_one(bench):
    wheels = wheel("left", 0.15) + wheel("right", -0.15).replace("revolute", "revolut")
    text = WHEELS.format(wheels=wheels, separation=0.3).replace("left_joint>", "joint_name>")
    text = text.replace("right_joint>", "joint_name>").replace("diff_drive", "p3d")
    assert not bench.find(text, "plugin-joint-unknown", "x.sdf")
    found = bench.find(text, "joint-type-unknown", "x.sdf")
    assert found[0].values["name"] == "revolut"


def test_attributes_of_urdf_are_written_as_elements(bench, take):
    text = model().replace("<box><size>1 1 1</size></box>", '\n<box size="0.5 1 1"/>\n')
    found = bench.find(text, "tag-ignored", "x.sdf")
    assert [each.severity for each in found] == ["warning", "warning"]
    for finding in found:
        assert finding.instead == "<box><size>0.5 1 1</size></box>"
        text = take(text, finding)
    assert not bench.find(text, "tag-ignored", "x.sdf")


def test_a_misspelt_end_of_a_joint_is_reported_once_with_the_right_one(bench, take):
    rules = {"joint-link-unknown", "value-ignored", "drive-joint-unknown"}
    wheels = wheel("left", 0.15) + wheel("right", -0.15)
    good = WHEELS.format(wheels=wheels, separation=0.3)
    text = good.replace("<child>left_wheel<", "\n<child>left_whele<")
    (finding,) = (f for f in bench.report(text, "x.sdf").findings if f.code.name in rules)
    assert finding.code.name == "joint-link-unknown"
    assert finding.instead == "<child>left_wheel</child>"
    assert finding.origin.line == text[: text.index("<child>left_whele")].count("\n") + 1
    mended = take(text, finding)
    assert not [f for f in bench.report(mended, "x.sdf").findings if f.code.name in rules]


def test_what_a_missing_model_holds_nobody_knows(bench):
    include = "<include><uri>model://nowhere</uri></include>"
    text = WHEELS.format(wheels=include, separation=0.3).replace("diff_drive", "p3d")
    text = text.replace("left_joint>", "joint_name>").replace("right_joint>", "joint_name>")
    assert not bench.find(text, "plugin-joint-unknown", "x.sdf")
    assert bench.find(text.replace(include, ""), "plugin-joint-unknown", "x.sdf")


def test_a_model_of_a_world_that_cannot_be_read_is_reported_as_such(bench):
    text = world(
        '<model name="a"><link name="b"><inertial><mass>-1</mass></inertial></link></model>\n'
    )
    found = [finding.code.name for finding in bench.report(text, "x.sdf").findings]
    assert found == ["mass-not-positive"]


def turning(lower, upper):
    limit = f"<limit><lower>{lower}</lower><upper>{upper}</upper></limit>"
    return model(
        '<link name="arm"/><joint name="j" type="revolute"><parent>box</parent><child>arm</child>\n'
        f"<axis><xyz>0 0 1</xyz>\n{limit}</axis></joint>"
    )


def test_limits_of_joints(bench):
    (zero,) = bench.find(turning(0, 0), "limit-zero", "x.sdf")
    assert zero.severity == "info", "models from before fixed joints mean one by it"
    (degrees,) = bench.find(turning(-90, 90), "limit-in-degrees", "x.sdf")
    assert degrees.instead == "<limit><lower>-1.5708</lower><upper>1.5708</upper></limit>"
    assert zero.origin.line == degrees.origin.line
    good = {one.code.name for one in bench.report(turning(-1, 1), "x.sdf").findings}
    assert not good & {"limit-zero", "limit-in-degrees"}


def test_a_misspelt_uri_is_reported_with_the_one_that_was_meant(bench, tmp_path):
    (tmp_path / "crate").mkdir()
    (tmp_path / "crate" / "model.config").write_text("<model><sdf>model.sdf</sdf></model>")
    (tmp_path / "crate" / "model.sdf").write_text(model())
    text = world("<include>\n<uri>model://craet</uri></include>\n")
    (finding,) = bench.find(text, "file-missing", "x.sdf")
    assert finding.instead == "<uri>model://crate</uri>"
    assert finding.place == "element"
    assert finding.origin.line == text[: text.index("<uri>")].count("\n") + 1


def test_an_empty_attribute_says_nothing(bench):
    """Gazebo writes one into each pose of a state that it saves."""
    state = (
        '<state world_name="w"><model name="m"><pose frame="{}">0 0 0 0 0 0</pose></model></state>'
    )
    assert bench.report(world(state.format("")), "x.sdf").findings == ()
    assert bench.find(world(state.format("box")), "tag-ignored", "x.sdf")


@pytest.mark.parametrize(
    ("right", "wrong", "code"),
    [
        ("<box><size>1 1 1</size></box>", "<bxo><size>1 1 1</size></bxo>", "type-unknown"),
        ("<size>1 1 1</size>", "<size>1 1 -1</size>", "value-invalid"),
        ("<xyz>0 0 1</xyz>", "<xyz>0 0 0</xyz>", "axis-zero"),
        ("<lower>-1</lower>", "<lower>3</lower>", "limit-reversed"),
    ],
)
def test_an_element_without_what_could_not_be_read_is_not_reported_as_well(
    bench, right, wrong, code
):
    arm = (
        '<link name="arm"/><joint name="j" type="revolute"><parent>box</parent><child>arm</child>'
        "<axis><xyz>0 0 1</xyz><limit><lower>-1</lower><upper>1</upper></limit></axis></joint>"
    )
    usual = {each.identity for each in bench.report(model(arm), "m.sdf").findings}
    report = bench.report(model(arm).replace(right, wrong, 1), "m.sdf")
    assert [each.code.name for each in report.findings if each.identity not in usual] == [code]


def vehicle(name, port, filename, tag):
    """A model with a flight controller; without a port, it is the default."""
    stated = f"<{tag}>{port}</{tag}>" if port else ""
    text = model(f'<plugin name="p" filename="{filename}">\n{stated}</plugin>')
    inside = text.removeprefix('<sdf version="1.6"><model name="m">').removesuffix("</sdf>")
    return f'<model name="{name}">{inside}'


@pytest.mark.parametrize(
    ("plugin", "default", "free"),
    [
        (("libgazebo_mavlink_interface.so", "mavlink_tcp_port"), 4560, 4561),
        (("ArduPilotPlugin", "fdm_port_in"), 9002, 9012),
    ],
)
@pytest.mark.parametrize("stated", [True, False])
def test_two_vehicles_on_one_port_are_found(bench, plugin, default, free, stated):
    filename, tag = plugin
    one = vehicle("one", "", filename, tag)
    other = vehicle("other", default if stated else "", filename, tag)
    (found,) = bench.find(world(one + other), "port-used-twice", "w.world")
    assert found.values["port"] == default
    if stated:
        assert found.instead == f"<{tag}>{free}</{tag}>"
    apart = vehicle("other", free, filename, tag)
    assert not bench.find(world(one + apart), "port-used-twice", "w.world")


def test_systems_that_open_no_port_do_not_clash(bench):
    systems = "".join(
        f'<plugin name="gz::sim::systems::{name}" filename="gz-sim-{name.lower()}-system"/>'
        for name in ("Imu", "Sensors")
    )
    assert not bench.find(model(systems), "port-used-twice")


def test_tcp_and_udp_ports_do_not_clash(bench):
    one = vehicle("one", 7000, "libgazebo_mavlink_interface.so", "mavlink_tcp_port")
    other = vehicle("other", 7000, "ArduPilotPlugin", "fdm_port_in")
    assert not bench.find(world(one + other), "port-used-twice", "w.world")
