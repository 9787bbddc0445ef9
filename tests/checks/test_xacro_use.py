"""What a xacro defines and nothing uses."""

import pytest

HEAD = '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">\n'
LINK = """<link name="base"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
"""


def rules(bench, text, name="robot.xacro"):
    return {
        finding.code.name: finding
        for finding in bench.report(text, name).findings
        if finding.code.name.endswith("-unused")
    }


def test_an_argument_that_nothing_uses_is_reported_at_its_line(bench):
    declared = '<xacro:arg name="width" default="1"/>\n'
    found = rules(bench, HEAD + declared + LINK + "</robot>")
    assert found["argument-unused"].origin.line == 2
    assert found["argument-unused"].values["name"] == "width"
    used = '<xacro:property name="w" value="$(arg width)"/><link name="${w}"/>'
    joint = '<joint name="j" type="fixed"><parent link="base"/><child link="1"/></joint>'
    assert rules(bench, HEAD + declared + LINK + used + joint + "</robot>") == {}


def test_a_property_that_nothing_uses_is_a_note(bench):
    text = HEAD + '<xacro:property name="width" value="1"/>\n' + LINK + "</robot>"
    finding = rules(bench, text)["property-unused"]
    assert (finding.severity, finding.origin.line) == ("info", 2)


def test_a_macro_that_nobody_calls_is_a_note(bench):
    macro = '<xacro:macro name="wheel" params="side">\n<link name="${side}"/></xacro:macro>\n'
    text = HEAD + macro + LINK + "</robot>"
    finding = rules(bench, text)["macro-unused"]
    assert finding.origin.line == 2
    assert finding.values["name"] == "wheel"
    called = '<xacro:wheel side="left"/>'
    joint = '<joint name="j" type="fixed"><parent link="base"/><child link="left"/></joint>'
    assert rules(bench, HEAD + macro + LINK + called + joint + "</robot>") == {}


@pytest.mark.parametrize("use", ['<xacro:call macro="wheel"/>', "<xacro:wheel/>"])
def test_calls_in_either_spelling_count(bench, use):
    macro = '<xacro:macro name="wheel" params="">\n<link name="x"/></xacro:macro>\n'
    joint = '<joint name="j" type="fixed"><parent link="base"/><child link="x"/></joint>'
    assert "macro-unused" not in rules(bench, HEAD + macro + LINK + use + joint + "</robot>")


def test_a_library_may_define_more_than_one_robot_needs(bench, tmp_path):
    library = '<xacro:macro name="a" params=""/><xacro:property name="p" value="1"/>'
    (tmp_path / "library.xacro").write_text(HEAD + library + "</robot>")
    text = HEAD + '<xacro:include filename="library.xacro"/>' + LINK + "</robot>"
    assert rules(bench, text) == {}


def test_what_another_file_of_the_package_uses_is_used(bench, tmp_path):
    (tmp_path / "package.xml").write_text("<package><name>p</name></package>")
    text = HEAD + '<xacro:property name="width" value="1"/>\n' + LINK + "</robot>"
    assert "property-unused" in rules(bench, text)
    (tmp_path / "other.xacro").write_text(HEAD + '<link name="${width}"/></robot>')
    assert rules(bench, text) == {}


def test_findings_of_a_macro_are_reported_once_with_the_calls(bench):
    macro = (
        '<xacro:macro name="part" params="side">\n<link name="${side}"><inertial>'
        '<mass value="1"/>\n'
        '<inertia ixx="1" iyy="1" izz="9" ixy="0" ixz="0" iyz="0"/></inertial></link>\n'
        '<joint name="${side}_joint" type="continuous"><parent link="base"/>'
        '<child link="${side}"/></joint></xacro:macro>\n'
    )
    calls = "".join(f'<xacro:part side="{side}"/>\n' for side in ("a", "b", "c"))
    report = bench.report(HEAD + macro + LINK + calls + "</robot>", "robot.xacro")
    found = [f for f in report.findings if f.code.name == "inertia-impossible"]
    assert len(found) == 1
    assert found[0].origin.line == 4
    assert found[0].origin.stack[0].endswith("xacro:part")
    assert [each.values["link"] for each in found[0].also] == ["b", "c"]


def test_findings_of_one_line_are_distinguished_by_their_values(bench):
    links = "".join(
        f'<link name="{name}">'
        f'<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="9" ixy="0" ixz="0" iyz="0"/>'
        f'</inertial></link><joint name="{name}_joint" type="continuous"><parent link="base"/>'
        f'<child link="{name}"/></joint>'
        for name in ("a", "b")
    )
    found = [
        each
        for each in bench.report(HEAD + LINK + links + "</robot>", "robot.xacro").findings
        if each.code.name == "inertia-impossible"
    ]
    assert [each.values["link"] for each in found] == ["a", "b"]
    assert len({str(each.origin) for each in found}) == 1


def test_a_property_that_is_replaced_before_its_use_is_a_note(bench):
    def found(between):
        twice = (
            f'<xacro:property name="w" value="1"/>\n{between}<xacro:property name="w" value="2"/>'
        )
        link = '<link name="l${w}"/>'
        text = f"{HEAD}{twice}{link}</robot>"
        return [
            f
            for f in bench.report(text, "x.xacro").findings
            if f.code.name == "property-overwritten"
        ]

    (finding,) = found("")
    assert (finding.severity, finding.origin.line) == ("info", 2)
    assert dict(finding.values) == {"name": "w", "value": "1"}
    assert found('<xacro:property name="v" value="3"/>')
    assert not found('<xacro:property name="v" value="${w}"/>')
    assert not found('<link name="k${w}"/>')


def test_a_parameter_that_nothing_uses_is_a_note(bench):
    def found(params, call, inside='<link name="${side}"/>'):
        macro = f'<xacro:macro name="wheel" params="{params}">\n{inside}</xacro:macro>\n'
        text = f"{HEAD}{macro}<xacro:wheel {call}/></robot>"
        return rules(bench, text).get("parameter-unused")

    finding = found("side turn:=1", 'side="left"')
    assert (finding.severity, finding.origin.line) == ("info", 2)
    assert finding.values["name"] == "turn"
    assert found("side", 'side="left"') is None
    # What the macro calls may use it.
    inner = '<xacro:macro name="n" params=""><link name="${side}"/></xacro:macro>'
    assert found("side", 'side="left"', f"{inner}<xacro:n/>") is None


def test_the_namespace_that_is_missing_is_written(bench, take):
    text = '<robot name="r">\n<xacro:property name="w" value="1"/>\n<link name="l${w}"/></robot>'
    (finding,) = bench.find(text, "xacro-namespace", "x.xacro")
    assert not bench.find(take(text, finding), "xacro-namespace", "x.xacro")
