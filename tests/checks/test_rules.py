"""Each rule fires at the right line, and its advice, taken literally, silences it."""

# ruff: noqa: E501  (a case is a table row)

from __future__ import annotations

import pkgutil
import re

import pytest
from tests.checks.seeded import LUMP, WITH_ADVICE, WITHOUT_PLACE

from cartwheel.checks import nodes, rules
from cartwheel.checks.checking import check
from cartwheel.checks.rules import RULES
from cartwheel.checks.spelling import meant


@pytest.mark.parametrize("case", WITH_ADVICE.values(), ids=WITH_ADVICE)
def test_a_fault_is_found_and_its_advice_mends_it(case, bench, spoil, line_of, take):
    rule, changes, there, advice = case
    text = spoil(*changes)
    found = bench.find(text, rule)
    assert found, [str(f) for f in bench.report(text).findings]
    finding = found[0]
    assert finding.origin.line == line_of(text, there)
    assert advice in finding.instead
    mended = text
    for _ in range(4):
        if not found:
            break
        mended = take(mended, found[0])
        found = bench.find(mended, rule)
    assert not found, mended


@pytest.mark.parametrize("case", WITHOUT_PLACE.values(), ids=WITHOUT_PLACE)
def test_a_fault_is_found_without_advice(case, bench, spoil, line_of):
    rule, changes, there, hint = case
    text = spoil(*changes)
    found = bench.find(text, rule)
    assert found, [str(f) for f in bench.report(text).findings]
    if there is not None:
        assert found[0].origin.line == line_of(text, there)
    assert found[0].hint or not hint


HINTS = {name: case for name, case in WITHOUT_PLACE.items() if case[3]}


@pytest.mark.wording
@pytest.mark.parametrize("case", HINTS.values(), ids=HINTS)
def test_a_fault_has_a_hint(case, bench, spoil):
    rule, changes, _, hint = case
    assert hint in bench.find(spoil(*changes), rule)[0].hint


def test_limits_of_many_turns_are_no_degrees(bench, spoil):
    for limits in (
        'lower="-6.28" upper="6.28"',
        'lower="-31.4159" upper="62.8319"',
        'lower="-100" upper="100"',
        'lower="0" upper="25"',
    ):
        assert not bench.find(spoil(('lower="-1" upper="1"', limits)), "limit-in-degrees"), limits


def test_a_file_of_new_gazebo_needs_no_prefix(bench, spoil):
    for name in ("gz-sim-acoustic-comms-system", "gz_ros2_lights-system"):
        found = bench.find(spoil(("libgazebo_ros_imu.so", name)), "plugin-unknown")
        assert [each.severity for each in found] == ["info"], name


def test_what_follows_from_a_fault_is_not_reported_as_well(bench, spoil):
    """Where a joint's place cannot be read nobody knows where its link is."""

    def rules(*changes):
        return [finding.code.name for finding in bench.report(spoil(*changes)).findings]

    assert rules(('<origin xyz="0 0.2 0.08"/>', '<origin xyz="0, 0.2, 0.08"/>')) == [
        "value-invalid"
    ]
    assert rules(('reference="caster_link"', 'reference="castor_link"')) == ["reference-unknown"]
    assert rules(('<sphere radius="0.03"/>', '<sphere diameter="0.06"/>')) == ["tag-missing"]
    assert rules(('name="caster_joint"', 'name="eye_joint"')) == ["duplicate-name"]
    # The joint of a drive exists in the file, though it cannot be simulated.
    for end in ("parent", "child"):
        link = "base_link" if end == "parent" else "left_wheel"
        joint = '<origin xyz="0 0.2 0.08"/>\n    <parent link="base_link"/>\n    <child link="left_wheel"/>'
        found = rules((joint, joint.replace(f'<{end} link="{link}"', f'<{end} link="{link}x"')))
        assert found == ["joint-link-unknown"], end
    # Without its origin a collision is elsewhere: too low, or within another one.
    for origin in ('"0, 0, 0.1"', '"0 0.1"'):
        base = (
            '<collision>\n      <origin xyz="0 0 0.1"/>\n      <geometry>\n        <box size="0.4'
        )
        assert rules((base, base.replace('"0 0 0.1"', origin))) == ["value-invalid"], origin
    box = '<box size="0.4 0.3 0.1"/>\n      </geometry>\n    </collision>'
    assert rules((box, box.replace("<box size=", "<box sizes="))) == ["tag-missing"]


def test_a_robot_with_swapped_wheels_and_reversed_axes_drives_backwards(bench, spoil):
    swapped = [("<leftJoint>left", "<leftJoint>right"), ("<rightJoint>right", "<rightJoint>left")]
    turned = [('xyz="0 1 0"', 'xyz="0 -1 0"')] * 2
    found = {f.code.name for f in bench.report(spoil(*swapped, *turned)).findings}
    assert found >= {"wheels-swapped", "wheel-axis-misaligned"}
    assert bench.find(spoil(*swapped), "wheels-swapped")
    assert len(bench.find(spoil(*turned), "wheel-axis-misaligned")) == 2


def test_an_angle_that_an_editor_let_run_is_none_in_degrees(bench, spoil):
    for angles, count in (
        ("0 0 6.597", 0),
        ("0 0 12.03", 1),
        ("0 12.0321 0", 1),
        ("0 0 7", 1),
        ("0 0 57.3", 1),
        ("0 6.2831 0", 0),
    ):
        found = bench.find(spoil(('rpy="0 0 0"', f'rpy="{angles}"')), "angle-in-degrees")
        assert len(found) == count, angles


def test_a_long_body_is_no_giant(bench, spoil, tmp_path):
    """A car of 12 m among parts of 0.4 m: with a thousandth of that it would be a speck."""
    corners = [(0, 0, 0), (12, 0, 0), (0, 1, 0), (0, 0, 1)]
    faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    lines = [f"v {x} {y} {z}" for x, y, z in corners]
    lines += ["f " + " ".join(str(i + 1) for i in face) for face in faces]
    (tmp_path / "car.obj").write_text("\n".join(lines) + "\n")
    large = [("0.08", "1.3"), ("0.03 0.03 0.01", "1.5 1.5 1.5"), ("0.04 0.04 0.2", "1 1 2"),
             ('<sphere radius="0.03"/>', '<sphere radius="0.8"/>')]  # fmt: skip
    text = spoil(*large, ('<box size="0.4 0.3 0.1"/>', '<mesh filename="car.obj"/>'))
    assert not bench.find(text.replace('radius="0.08"', 'radius="1.3"'), "shape-out-of-scale")


def test_a_speck_of_a_mesh_beside_its_collision_is_reported(bench, spoil, take, tmp_path):
    corners = [(0, 0, 0), (0.0004, 0, 0), (0, 0.0004, 0), (0, 0, 0.0004)]
    faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    lines = [f"v {x} {y} {z}" for x, y, z in corners]
    lines += ["f " + " ".join(str(i + 1) for i in face) for face in faces]
    (tmp_path / "speck.obj").write_text("\n".join(lines) + "\n")
    text = spoil(('<box size="0.4 0.3 0.1"/>', '<mesh filename="speck.obj"/>'))
    (finding,) = bench.find(text, "shape-out-of-scale")
    assert finding.instead == 'scale="1000 1000 1000"'
    assert not bench.find(take(text, finding), "shape-out-of-scale")


def test_a_robot_without_a_fault_gives_no_finding(bench, robot):
    report = bench.report(robot)
    assert report.findings == ()
    assert report.complete
    assert report.name == "tester"


def test_names_of_rules_are_unique_and_every_rule_has_its_line():
    names = [rule.code.name for rule in RULES]
    assert len(set(names)) == len(names)
    for rule in RULES:
        assert rule.code.summary
        assert "\n" not in rule.code.summary
        assert len(rule.code.summary) <= 80, rule.code.name


def test_the_rest_is_checked_behind_an_error(bench, spoil):
    text = spoil(
        ('<parent link="arm"/>', '<parent link="arn"/>'),
        ('<axis xyz="0 1 0"/>', '<axis xyz="0 0 0"/>'),
        ('iyy="0.085" izz="0.125"', 'iyy="0.085" izz="0.325"'),
        ("<wheelSeparation>0.4<", "<wheelSeparation>0.45<"),
        ('<sphere radius="0.03"/>', '<sphere radius="wide"/>'),
    )
    report = bench.report(text)
    assert report.complete
    assert {
        "joint-link-unknown", "axis-zero", "inertia-impossible", "wheel-separation-mismatch", "value-invalid",
    } <= {finding.code.name for finding in report.findings}  # fmt: skip
    lines = [finding.origin.line for finding in report.findings]
    assert lines == sorted(lines)


def test_a_cause_is_reported_once(bench, spoil):
    """A link that is cut out because of one number makes no second error."""
    text = spoil(('<mass value="0.3"/>', '<mass value="heavy"/>'))
    errors = [f for f in bench.report(text).findings if f.severity == "error"]
    assert [finding.code.name for finding in errors] == ["value-invalid"]
    assert errors[0].values["stated"] == "heavy"


SPELLINGS = (LUMP, "base_link_collision", "base_footprint_collision_base_link")


def test_a_contact_sensor_hears_all_spellings_of_its_collision(bench, spoil):
    for name in SPELLINGS:
        assert not bench.find(spoil((LUMP, name)), "contact-collision-unknown"), name
    (finding,) = bench.find(spoil((LUMP, "no_such_collision")), "contact-collision-unknown")
    assert (finding.values["collision"], finding.values["meant"]) == ("no_such_collision", LUMP)


@pytest.mark.wording
def test_all_spellings_of_a_collision_are_shown(bench, spoil):
    hint = bench.find(spoil((LUMP, "no_such_collision")), "contact-collision-unknown")[0].hint
    for name in SPELLINGS:
        assert name in hint


def test_a_lumped_link_is_reported_where_its_frame_is_another(bench, spoil):
    moved = ('<child link="base_link"/>', '<child link="base_link"/>\n<origin xyz="0 0 0.1"/>')
    assert bench.find(spoil(moved), "lumped-link")[0].severity == "info"
    snake = spoil(("<bodyName>base_link</bodyName>", "<body_name>base_link</body_name>"))
    found = bench.find(snake, "lumped-link")
    assert found[0].severity == "warning"
    assert '<gazebo reference="base_joint"><preserveFixedJoint>true' in found[0].instead
    kept = snake.replace("</robot>", found[0].instead + "</robot>")
    assert not bench.find(kept, "lumped-link")


def test_a_fixed_joint_that_is_measured_must_be_kept(bench, spoil):
    plugin = '<plugin name="ft" filename="libx.so">\n<jointName>caster_joint</jointName></plugin>'
    text = spoil(("  <gazebo>\n", f"  <gazebo>\n{plugin}"))
    found = bench.find(text, "lumped-joint")
    assert found[0].values["joint"] == "caster_joint"
    assert not bench.find(text.replace("</robot>", found[0].instead + "</robot>"), "lumped-joint")


HOUSING = (
    '<link name="eye"/>',
    '<link name="eye"><visual><origin xyz="0.1 0 0"/><geometry><box size="0.02 0.5 0.5"/>'
    "</geometry></visual></link>",
)


def test_a_camera_that_looks_at_its_housing_is_reported(bench, spoil):
    found = bench.find(spoil(HOUSING), "view-blocked")
    assert found[0].values["sensor"] == "camera"
    assert found[0].values["share"] == 1.0
    assert found[0].values["distance"] == pytest.approx(0.09, abs=0.01), "0.1 - 0.02/2 m"
    # It lies before the near plane, or the camera within it looks out: nothing is seen of it.
    assert not bench.find(spoil(HOUSING, ("<near>0.02<", "<near>0.2<")), "view-blocked")
    inside = (HOUSING[0], HOUSING[1].replace('size="0.02', 'size="0.4'))
    assert not bench.find(spoil(inside), "view-blocked")


def test_a_lidar_within_a_collision_is_reported(bench, spoil):
    around = HOUSING[1].replace("visual", "collision").replace("0.02 0.5 0.5", "0.3 0.3 0.3")
    text = spoil((HOUSING[0], around))
    found = bench.find(text, "view-blocked")
    assert found[0].values["sensor"] == "lidar"
    assert not bench.find(spoil((HOUSING[0], around), ("<min>0.05<", "<min>0.7<")), "view-blocked")


def test_a_dwarf_mesh_is_reported_with_its_scale(bench, spoil, take, tmp_path):
    corners = [(0, 0, 0), (300, 0, 0), (0, 300, 0), (0, 0, 300)]
    faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    lines = [f"v {x} {y} {z}" for x, y, z in corners]
    lines += ["f " + " ".join(str(i + 1) for i in face) for face in faces]
    (tmp_path / "big.obj").write_text("\n".join(lines) + "\n")
    text = spoil(('<box size="0.4 0.3 0.1"/>', '<mesh filename="big.obj"/>'))
    found = bench.find(text, "shape-out-of-scale")
    assert found[0].instead == 'scale="0.001 0.001 0.001"'
    assert not bench.find(take(text, found[0]), "shape-out-of-scale")


def test_a_damaged_mesh_is_reported(bench, spoil, tmp_path):
    (tmp_path / "bad.stl").write_bytes(b"solid nothing")
    text = spoil(('<box size="0.03 0.03 0.01"/>', '<mesh filename="bad.stl"/>'))
    assert bench.find(text, "mesh-unreadable")


def test_a_mesh_of_nearly_that_name_is_offered(bench, spoil, take, tmp_path):
    (tmp_path / "finger.stl").write_bytes(b"")
    text = spoil(('<box size="0.03 0.03 0.01"/>', '<mesh filename="fingr.stl"/>'))
    found = bench.find(text, "file-missing")
    assert found[0].instead == 'filename="finger.stl"'
    assert not bench.find(take(text, found[0]), "file-missing")


def test_what_nothing_collides_with_is_reported(bench, spoil, take):
    text = spoil(
        (
            '<collision>\n      <origin xyz="0 0 0.1"/>\n      <geometry>\n'
            '        <box size="0.4 0.3 0.1"/>\n      </geometry>\n    </collision>',
            "",
        ),
        ("<collision>\n      <geometry>\n        <sphere", "<visual><geometry><sphere"),
        ('radius="0.03"/>\n      </geometry>\n    </collision>',
         'radius="0.03"/></geometry></visual>'),
        (LUMP, "left_wheel_collision"),
    )  # fmt: skip
    found = bench.find(text, "base-without-collision")
    assert '<box size="0.4 0.3 0.1"/>' in found[0].instead
    assert not bench.find(take(text, found[0]), "base-without-collision")


@pytest.mark.parametrize(
    ("more", "gravity", "reported"),
    [("", "1", True), ("<static>1</static>", "1", False), ("", "0", False)],
)
def test_a_model_of_a_sensor_alone_falls(tmp_path, more, gravity, reported):
    path = tmp_path / "eye.sdf"
    sensor = f'<link name="l"><gravity>{gravity}</gravity><sensor name="s" type="imu"/></link>'
    path.write_text(f'<sdf version="1.9"><model name="eye">{more}{sensor}</model></sdf>')
    codes = [each.code.name for each in check(path).findings]
    assert ("base-without-collision" in codes) == reported


def test_what_is_written_already_is_not_what_was_meant(bench, spoil):
    """A parameter that resembles one that is there is no misspelt one."""
    more = "<wheelDiameter>0.16</wheelDiameter>\n<wheelDiameters>0.2</wheelDiameters>"
    found = bench.find(
        spoil(("<wheelDiameter>0.16</wheelDiameter>", more)), "plugin-parameter-unknown"
    )
    assert (found[0].severity, found[0].instead) == ("info", "")
    limit = ('effort="5" velocity="20"', 'effort="5" velocity="20" q_velocity="10"')
    found = bench.find(spoil(limit), "tag-ignored")
    assert (found[0].severity, found[0].instead) == ("info", "")


def test_what_is_measured_on_a_part_only_is_not_reported(bench, spoil):
    """Where a mesh is missing the rest of the link's geometry says nothing of its inertia."""
    large = ('ixx="0.001" iyy="0.001" izz="0.00008"', 'ixx="1" iyy="1" izz="1"')
    assert bench.find(spoil(large), "inertia-geometry-mismatch")
    lost = (
        '<collision>\n      <origin xyz="0 0 0.1"/>\n      <geometry>\n        <box size="0.04',
        '<visual><geometry><mesh filename="no.stl"/></geometry></visual>'
        '<collision>\n      <origin xyz="0 0 0.1"/>\n      <geometry>\n        <box size="0.04',
    )
    assert not bench.find(spoil(large, lost), "inertia-geometry-mismatch")


def test_an_inertia_that_does_not_matter_is_a_note(bench, spoil):
    """A light link's too large inertia counts little on a robot whose own is far larger."""
    caster = 'ixx="0.000036" iyy="0.000036" izz="0.000036"'
    for moment, severity in (("0.3", "warning"), ("0.004", "info")):
        changed = caster.replace("0.000036", moment)
        light = f'<mass value="0.001"/>\n      <inertia {changed}'
        text = spoil((f'<mass value="0.1"/>\n      <inertia {caster}', light))
        found = bench.find(text, "inertia-geometry-mismatch")
        assert [f.severity for f in found if "caster_link" in f.values.values()] == [severity]


def test_two_giant_wheels_are_reported_though_they_are_alike(bench, spoil):
    wheel = 'radius="0.08" length="0.04"'
    giant = wheel.replace("0.08", "30").replace("0.04", "4")
    found = bench.find(spoil((wheel, giant), (wheel, giant)), "shape-out-of-scale")
    assert len(found) == 2
    assert found[0].instead == '<cylinder radius="0.03" length="0.004"/>'


def test_a_plugin_of_gazebos_own_is_no_misspelt_one(bench, spoil):
    """libgazebo_ros_video.so resembles other plugins of Gazebo, and Cartwheel does not simulate it."""
    changed = ("libgazebo_ros_imu.so", "libgazebo_ros_video.so")
    found = bench.find(spoil(changed), "plugin-unknown")
    assert [(f.severity, f.instead) for f in found] == [("info", "")]


def test_a_material_of_the_robots_own_script_is_a_note(bench, spoil):
    found = bench.find(spoil(("Gazebo/Black", "PR2/Black")), "material-unknown")
    assert [(f.severity, f.instead) for f in found] == [("info", "")]


def test_a_name_is_proposed_only_where_it_was_surely_meant(bench, spoil):
    def proposed(name):
        (finding,) = bench.find(
            spoil(('reference="caster_link"', f'reference="{name}"')), "reference-unknown"
        )
        return finding.instead

    assert proposed("castor_link") == 'reference="caster_link"'
    assert proposed("Caster-Link") == 'reference="caster_link"'
    assert proposed("robot_caster_link") == 'reference="caster_link"'
    for other in ("roller_link", "caster_link_2", "wheel"):
        assert proposed(other) == "", other


@pytest.mark.wording
@pytest.mark.parametrize("name", ["roller_link", "caster_link_2", "wheel"])
def test_similar_names_are_shown(bench, spoil, name):
    text = spoil(('reference="caster_link"', f'reference="{name}"'))
    (finding,) = bench.find(text, "reference-unknown")
    assert finding.hint.startswith("Similar names: ")


def test_another_word_is_no_slip():
    assert meant("arm_lft_joint", ["arm_left_joint", "arm_right_joint"]) == "arm_left_joint"
    assert meant("armleft_jiont", ["arm_left_joint"]) == "arm_left_joint"
    for name, other in (("arm_l_joint", "arm_r_joint"), ("wheel_fl", "wheel_fr"),
                        ("waffle_base.stl", "waffle_pi_base.stl")):  # fmt: skip
        assert meant(name, [other]) == "", name


MISSPELT = '<mesh filename="package://tester_descripton/finger.stl"/>'


@pytest.fixture
def misspelt(spoil, tmp_path):
    """A robot with a package's name misspelt twice."""
    package = tmp_path / "tester_description"
    package.mkdir()
    (package / "package.xml").write_text("<package><name>tester_description</name></package>")
    (package / "finger.stl").write_text("solid s\nendsolid s\n")
    return spoil(('<box size="0.03 0.03 0.01"/>', MISSPELT), ('<sphere radius="0.03"/>', MISSPELT))


def lines_of(text, part):
    return [number for number, line in enumerate(text.splitlines(), 1) if part in line]


def test_a_package_that_is_missing_is_reported_once_with_the_one_that_was_meant(bench, misspelt):
    (finding,) = bench.find(misspelt, "file-missing")
    assert (finding.values["name"], finding.values["places"]) == ("tester_descripton", 2)
    assert finding.values["meant"] == "tester_description"
    assert finding.instead == 'filename="package://tester_description/finger.stl"'
    assert finding.origin.line == lines_of(misspelt, MISSPELT)[0]


@pytest.mark.wording
def test_the_other_places_of_a_missing_package_are_shown(bench, misspelt):
    (finding,) = bench.find(misspelt, "file-missing")
    assert f"robot.urdf:{lines_of(misspelt, MISSPELT)[1]}" in finding.hint


def test_a_mesh_without_its_scale_is_a_giant(bench, spoil, tmp_path):
    corners = [(0, 0, 0), (3, 0, 0), (0, 3, 0), (0, 0, 3)]
    faces = [(0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3)]
    lines = [f"v {x} {y} {z}" for x, y, z in corners]
    lines += ["f " + " ".join(str(i + 1) for i in face) for face in faces]
    (tmp_path / "tip.obj").write_text("\n".join(lines))
    text = spoil(('<box size="0.03 0.03 0.01"/>', '<mesh filename="tip.obj"/>'))
    assert bench.find(text, "shape-out-of-scale")[0].instead == 'scale="0.001 0.001 0.001"'


def test_wheels_that_skid_may_state_a_wider_separation(bench, spoil):
    more = "<leftJoint>left_wheel_joint</leftJoint>\n<rightJoint>right_wheel_joint</rightJoint>\n"
    pairs = ("<wheelSeparation>", more + "<wheelSeparation>")
    wide = ("<wheelSeparation>0.4<", "<wheelSeparation>0.6<")
    assert bench.find(spoil(wide), "wheel-separation-mismatch")
    assert not bench.find(spoil(wide, pairs), "wheel-separation-mismatch")
    narrow = ("<wheelSeparation>0.4<", "<wheelSeparation>0.3<")
    assert bench.find(spoil(narrow, pairs), "wheel-separation-mismatch")


def test_a_wheel_beside_its_axis_has_its_own_diameter(bench, spoil):
    """A cylinder 4 mm off: it reaches 0.084 m from the axis, and is 0.16 m wide all the same."""
    assert not bench.find(
        spoil(('<origin rpy="1.5707963 0 0"/>', '<origin xyz="0 0 0.004" rpy="1.5707963 0 0"/>')),
        "wheel-diameter-mismatch",
    )


def test_a_caster_wheel_that_does_not_swivel_slides_in_turns(bench, spoil):
    rough = ("<mu1>0.0</mu1>", "<mu1>1.0</mu1>")
    wheel = ('<joint name="caster_joint" type="fixed">', '<joint name="caster_joint" type="{}">')

    def found(kind, axis):
        joint = (wheel[0], wheel[1].format(kind) + f'<axis xyz="{axis}"/>')
        return bench.find(spoil(rough, joint), "caster-friction")

    (finding,) = found("continuous", "0 1 0")
    assert finding.values["link"] == "caster_link"
    # A ball that turns only about the vertical slides, too.
    (pivot,) = found("continuous", "0 0 1")
    assert pivot.values["link"] == "caster_link"
    assert not found("continuous", "1 0 0")


def test_tags_of_a_link_that_stand_at_its_joint_are_reported_together(bench, spoil, take):
    text = spoil(('reference="caster_link"', 'reference="caster_joint"'))
    (finding,) = bench.find(text, "tag-misplaced")
    assert finding.values["tags"] == ("mu1", "mu2")
    assert finding.values["needs"] == "link"
    assert finding.instead == 'reference="caster_link"'
    assert not bench.find(take(text, finding), "tag-misplaced")


def test_a_motor_without_force_is_given_what_bears_its_load(bench, spoil):
    """The arm's 0.3 kg at 0.1 m and the finger's 0.1 kg at 0.21 m, twice: 1 N m, so the least."""
    drive = (
        "  <gazebo>\n",
        '<ros2_control name="c" type="system"><joint name="arm_joint"/></ros2_control><gazebo>\n',
    )
    weak = ('lower="-1" upper="1" effort="5"', 'lower="-1" upper="1" effort="0"')
    assert bench.find(spoil(drive, weak), "effort-zero")[0].instead == 'effort="10"'
    measured = '<joint name="arm_joint"><state_interface name="position"/></joint>'
    only_measured = (drive[0], drive[1].replace('<joint name="arm_joint"/>', measured))
    assert not bench.find(spoil(only_measured, weak), "effort-zero")
    # 30 kg at 0.1 m and 0.1 kg at 0.21 m: 2 * 9.8 * 3.021 = 59.2
    heavy = ('<mass value="0.3"/>', '<mass value="30"/>')
    assert bench.find(spoil(drive, weak, heavy), "effort-zero")[0].instead == 'effort="60"'


INTERFACE, GAIN = '<command_interface name="{}"/>', '<param name="pos_kp">9</param>'


@pytest.mark.parametrize(
    ("inside", "plugin", "reported"),
    [
        (INTERFACE.format("position"), "libgazebo_ros2_control.so", False),
        (INTERFACE.format("velocity"), "libgazebo_ros2_control.so", False),
        (INTERFACE.format("effort"), "libgazebo_ros2_control.so", True),
        (f"{INTERFACE.format('position')}{GAIN}", "libgazebo_ros2_control.so", True),
        (INTERFACE.format("position"), "gz_ros2_control-system", True),
    ],
)
@pytest.mark.parametrize("limit", ["effort", "velocity"])
def test_positions_that_gazebo_classic_sets_need_no_motor(
    *, bench, spoil, inside, plugin, reported, limit
):
    """gazebo_ros2_control sets positions and velocities, whatever the limits of the joint."""
    drive = (
        "  <gazebo>\n",
        '<ros2_control name="c" type="system"><hardware>'
        "<plugin>gazebo_ros2_control/GazeboSystem</plugin></hardware>"
        f'<joint name="arm_joint">{inside}</joint></ros2_control>'
        f'<gazebo><plugin filename="{plugin}" name="control"/></gazebo><gazebo>\n',
    )
    old = 'lower="-1" upper="1" effort="5" velocity="2"'
    assert f'{limit}="' in old
    new = re.sub(f'{limit}="[0-9]+"', f'{limit}="0"', old)
    assert bool(bench.find(spoil(drive, (old, new)), "effort-zero")) is reported


CONTROLLERS = """arm:
  ros__parameters:
    joints:
      - arm_joint
      - fingr_joint
"""


def test_controllers_of_joints_that_are_not_there_are_reported_in_their_file(
    bench, spoil, tmp_path
):
    plugin = (
        "  <gazebo>\n",
        '  <gazebo><plugin name="c" filename="libgazebo_ros2_control.so">\n'
        "<parameters>arm.yaml</parameters></plugin>\n",
    )
    text = spoil(plugin)
    assert bench.find(text, "controllers-file-unreadable")[0].values["file"]
    (tmp_path / "arm.yaml").write_text(CONTROLLERS)
    assert not bench.find(text, "controllers-file-unreadable")
    (finding,) = bench.find(text, "controller-joint-unknown")
    assert finding.origin.file.endswith("arm.yaml")
    assert finding.origin.line == 5
    assert (finding.instead, finding.place) == ("- finger_joint", "line")
    (tmp_path / "arm.yaml").write_text("arm: [")
    assert bench.find(text, "controllers-file-unreadable")[0].origin.file.endswith("arm.yaml")


def test_a_lidar_of_a_gpu_sees_what_is_drawn(bench, spoil):
    """From within a visual it looks out; a lidar of the physics ends at a collision's inside."""
    around = HOUSING[1].replace("0.02 0.5 0.5", "0.3 0.3 0.3")
    gpu = ('type="ray" name="lidar"', 'type="gpu_ray" name="lidar"')
    assert not bench.find(spoil((HOUSING[0], around), gpu), "view-blocked")
    collision = around.replace("visual", "collision")
    assert not bench.find(spoil((HOUSING[0], collision), gpu), "view-blocked")
    (finding,) = bench.find(spoil((HOUSING[0], collision)), "view-blocked")
    assert finding.values["link"]
    assert finding.values["within"] is True


@pytest.mark.parametrize(
    ("changes", "rule"),
    [
        ([('<child link="finger"/>', '<child link="fingr"/>')], "joint-link-unknown"),
        ([('name="arm_joint" type="revolute"', 'name="arm_joint" type="revolut"')],
         "joint-type-unknown"),
        ([("<horizontal_fov>", "<horizonatl_fov>")], "tag-ignored"),
        ([('name="left_wheel_joint" type="continuous"', 'name="left_wheel_joint" type="revolute"'),
          ('<limit effort="5" velocity="20"/>',
           '<limit lower="0" upper="0" effort="5" velocity="20"/>')], "drive-joint-not-continuous"),
    ],
)  # fmt: skip
def test_one_fault_is_one_finding(bench, spoil, changes, rule):
    eye = ("<camera>", "<camera>\n<horizontal_fov>1</horizontal_fov>")
    text = spoil(eye, *changes).replace("1</horizontal_fov>", "1</horizonatl_fov>")
    if "horizonatl_fov>1" not in text:
        text = text.replace("</horizonatl_fov>", "</horizontal_fov>")
    assert [finding.code.name for finding in bench.report(text).findings] == [rule]


def test_the_time_of_unknown_tags_is_linear(bench, monkeypatch):
    """The tree is not searched for each of them."""
    walks = []
    walk = nodes.walk
    monkeypatch.setattr(nodes, "walk", lambda node: walks.append(node) or walk(node))
    tags = "".join(f"<velocty_{number}/>" for number in range(1000))
    tags += "".join(f"<gazebo><mu1>{number}</mu1></gazebo>" for number in range(1000))
    report = bench.report(f'<robot name="r"><link name="base"/>{tags}</robot>')
    assert {"tag-ignored", "tag-misplaced"} < {each.code.name for each in report.findings}
    assert len(walks) < 200


def test_each_file_of_rules_has_rules_that_are_applied():
    found = {rule.find.__module__ for rule in RULES}
    rooms = pkgutil.walk_packages(rules.__path__, "cartwheel.checks.rules.")
    assert found == {each.name for each in rooms if not each.ispkg}


def test_only_that_it_has_no_effect_is_reported_about_a_tag(bench, spoil):
    plugin = (
        '<gazebo><plugin name="p" filename="libgazebo_ros_planar_move.so">'
        "<leftFrontJoint>no_such_joint</leftFrontJoint></plugin></gazebo></robot>"
    )
    text = spoil(("</robot>", plugin))
    (finding,) = bench.find(text, "plugin-parameter-unknown")
    assert finding.values["parameter"] == "leftFrontJoint"
    assert not bench.find(text, "plugin-joint-unknown")
