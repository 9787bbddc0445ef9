"""xacro as in ROS; origins through includes and macros; diagnostics of failures."""

import os
import re
import subprocess
import sys
import threading
from pathlib import Path

import pytest
from tests.coded import named, placed, raises

from cartwheel.codes import files
from cartwheel.description import load_text
from cartwheel.description.elements import xml
from cartwheel.description.files.packages import Packages
from cartwheel.description.xacro import expand, expansion
from cartwheel.errors import DescriptionError
from cartwheel.options import xacro_argument

NS = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The current folder, so that files are shown by their names."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


def write(name, body, attributes='name="r"'):
    """A file whose body begins in line 2."""
    Path(name).parent.mkdir(parents=True, exist_ok=True)
    Path(name).write_text(f"<robot {attributes} {NS}>\n{body}\n</robot>")


def expanded(name="robot.xacro", **arguments):
    path = Path(name)
    packages = Packages(path, environment={})
    return expand(xml.read_bytes(path), xml.shown_path(path), packages, arguments)


def failure(name="robot.xacro", **arguments):
    with pytest.raises(DescriptionError) as caught:
        expanded(name, **arguments)
    return caught.value


def test_properties_conditions_and_arguments(folder):
    write(
        "robot.xacro",
        """<xacro:arg name="side" default="left"/>
<xacro:property name="r" value="0.5"/>
<xacro:if value="${'$(arg side)' == 'left'}"><link name="$(arg side)" d="${2 * r}"/></xacro:if>
<xacro:unless value="true"><link name="never"/></xacro:unless>""",
    )
    root = expanded().root
    assert [(n.tag, dict(n.attributes)) for n in root.children] == [
        ("link", {"name": "left", "d": "1.0"})
    ]
    assert not expanded(side="right").root.children


def test_environment(folder, monkeypatch):
    monkeypatch.setenv("CARTWHEEL_TEST", "7")
    write("robot.xacro", '<a b="$(env CARTWHEEL_TEST) $(optenv CARTWHEEL_NONE 8)"/>')
    assert expanded().root.children[0].attributes["b"] == "7 8"


def test_yaml_dirname_and_find(folder):
    (folder / "cfg").mkdir()
    (folder / "cfg" / "size.yaml").write_text("wheel: {radius: 0.3}\n")
    Path("package.xml").write_text("<package><name>pkg</name></package>")
    write(
        "urdf/robot.xacro",
        """<xacro:property name="c" value="${xacro.load_yaml('$(find pkg)/cfg/size.yaml')}"/>
<a r="${c['wheel']['radius']}" s="${c.wheel.radius}" d="$(dirname)"/>""",
    )
    attributes = dict(expanded("urdf/robot.xacro").root.children[0].attributes)
    assert attributes == {"r": "0.3", "s": "0.3", "d": str(folder / "urdf")}


def test_elements_keep_file_line_and_macro_calls(folder):
    write(
        "parts/wheel.xacro",
        """<xacro:macro name="wheel" params="side">
  <link name="${side}_wheel">
    <visual/>
  </link>
  <xacro:hub side="${side}"/>
</xacro:macro>
<xacro:macro name="hub" params="side">
  <link name="${side}_hub"/>
</xacro:macro>""",
        "",
    )
    write(
        "robot.xacro",
        """<xacro:include filename="parts/wheel.xacro"/>
<link name="base"/>
<xacro:wheel side="left"/>
<xacro:wheel side="right"/>""",
    )
    base, left, left_hub, right, _ = expanded().root.children
    assert (str(base.origin), base.origin.stack) == ("robot.xacro:3", ())
    assert str(left.origin) == "parts/wheel.xacro:3"
    assert left.origin.stack == ("robot.xacro:4 xacro:wheel",)
    assert str(left.children[0].origin) == "parts/wheel.xacro:4"
    assert left.children[0].origin.stack == ("robot.xacro:4 xacro:wheel",)
    assert right.origin.stack == ("robot.xacro:5 xacro:wheel",)
    assert str(left_hub.origin) == "parts/wheel.xacro:9"
    assert left_hub.origin.stack == (
        "parts/wheel.xacro:6 xacro:hub",
        "robot.xacro:4 xacro:wheel",
    )


def test_blocks_keep_the_place_of_the_caller(folder):
    write(
        "robot.xacro",
        """<xacro:macro name="part" params="*at **more">
  <part><xacro:insert_block name="at"/><xacro:insert_block name="more"/></part>
</xacro:macro>
<xacro:part>
  <origin xyz="1 2 3"/>
  <more><inner/></more>
</xacro:part>
<xacro:property name="block"><kept/></xacro:property>
<xacro:insert_block name="block"/>""",
    )
    part, kept = expanded().root.children
    origin, inner = part.children
    assert (str(origin.origin), origin.origin.stack) == ("robot.xacro:6", ())
    assert str(inner.origin) == "robot.xacro:7"
    assert str(kept.origin) == "robot.xacro:9"


def test_nothing_of_xacro_is_left(folder):
    write("robot.xacro", '<xacro:property name="a" value="1"/><!-- c --><b c="${a}"/>')
    root = expanded().root
    assert not any(name.startswith("xmlns:xacro") for name in root.attributes)
    assert [child.tag for child in root.children] == ["b"]


def test_dynamic_calls_namespaces_and_optional_includes(folder):
    write("lib.xacro", '<xacro:macro name="m" params="n:=1"><m n="${n}"/></xacro:macro>', "")
    write(
        "robot.xacro",
        """<xacro:include filename="lib.xacro" ns="lib"/>
<xacro:include filename="none.xacro" optional="true"/>
<xacro:call macro="lib.m"/>
<xacro:lib.m n="2"/>""",
    )
    first, second = expanded().root.children
    assert first.attributes["n"] == "1"
    assert second.attributes["n"] == "2"
    assert second.origin.stack == ("robot.xacro:5 xacro:lib.m",)


@pytest.mark.parametrize(
    ("body", "error"),
    [
        (
            '<xacro:macro name="wheel"><a/></xacro:macro>\n<xacro:wheeel/>',
            "robot.xacro:3 xacro-name-unknown xacro:wheel",
        ),
        (
            "<xacro:wheel/>",
            "robot.xacro:2 xacro-name-unknown",
        ),
        (
            '<xacro:property name="radius" value="1"/>\n<a b="${raduis * 2}"/>',
            "robot.xacro:3 xacro-name-unknown radius",
        ),
        (
            '<xacro:arg name="side" default="x"/>\n<a b="${side}"/>',
            "robot.xacro:3 xacro-name-unknown",
        ),
        (
            '<xacro:arg name="side" default="x"/>\n<a b="$(arg sied)"/>',
            "robot.xacro:3 xacro-name-unknown side",
        ),
        (
            '<a b="$(arg side)"/>',
            "robot.xacro:2 xacro-name-unknown",
        ),
        ('<a b="${1 +}"/>', "robot.xacro:2 expression-invalid"),
        ('<a b="${1 / 0}"/>', "robot.xacro:2 expression-invalid"),
        (
            '<xacro:if value="maybe"><a/></xacro:if>',
            "robot.xacro:2 xacro-invalid",
        ),
        ('<xacro:property value="1"/>', "robot.xacro:2 xacro-invalid"),
        (
            '<xacro:insert_block name="nothing"/>',
            "robot.xacro:2 xacro-name-unknown",
        ),
        (
            '<xacro:macro name="w" params="side r"><a/></xacro:macro>\n<xacro:w side="l"/>',
            "robot.xacro:3 macro-call-invalid",
        ),
        (
            '<xacro:macro name="w" params="side"><a/></xacro:macro>\n<xacro:w sied="l"/>',
            "robot.xacro:3 macro-call-invalid side",
        ),
        (
            '<xacro:macro name="w" params="*at"><a/></xacro:macro>\n<xacro:w/>',
            "robot.xacro:3 macro-call-invalid",
        ),
        (
            '<a b="$(fnid pkg)"/>',
            "robot.xacro:2 xacro-name-unknown find",
        ),
        (
            '<a b="$(env CARTWHEEL_NONE)"/>',
            "robot.xacro:2 xacro-name-unknown",
        ),
        (
            '<xacro:property name="a" value="${b}"/><xacro:property name="b" value="${a}"/>\n'
            '<c d="${a}"/>',
            "robot.xacro:3 expression-invalid",
        ),
        (
            '<xacro:macro name="w"><xacro:w/></xacro:macro>\n<xacro:w/>',
            "robot.xacro:2 expansion-too-large",
        ),
        (
            '<xacro:property name="1a" value="1"/>',
            "robot.xacro:2 xacro-invalid",
        ),
        ('<xacro:macro params="a"/>', "robot.xacro:2 xacro-invalid"),
    ],
)
def test_errors(folder, body, error):
    write("robot.xacro", body)
    with pytest.raises(DescriptionError) as caught:
        expanded()
    assert f"{caught.value.origin} {named(caught.value)}" == error


def test_missing_include_names_the_likely_file(folder):
    write("wheel.xacro", "", "")
    write("robot.xacro", '\n<xacro:include filename="whel.xacro"/>')
    error = failure()
    assert placed(error.diagnostic()) == "robot.xacro:3 error file-missing wheel.xacro"


def test_missing_package_has_the_place_of_the_include(folder):
    write("robot.xacro", '\n<xacro:include filename="$(find nowhere)/a.xacro"/>')
    with pytest.raises(DescriptionError) as caught:
        expanded()
    assert str(caught.value.origin) == "robot.xacro:3"
    assert named(caught.value) == "file-missing"


def test_missing_package_within_an_expression(folder):
    write("robot.xacro", "\n<a b=\"${xacro.load_yaml('$(find nowhere)/a.yaml')}\"/>")
    with pytest.raises(DescriptionError) as caught:
        expanded()
    assert str(caught.value.origin) == "robot.xacro:3"
    assert named(caught.value) == "file-missing"


def test_malformed_include_names_its_own_line(folder):
    Path("wheel.xacro").write_text("<robot>\n<link>\n</robot>")
    write("robot.xacro", '<xacro:include filename="wheel.xacro"/>')
    with pytest.raises(DescriptionError) as caught:
        expanded()
    assert str(caught.value.origin) == "wheel.xacro:3"
    assert named(caught.value) == "xml-malformed"


def test_include_of_itself_ends(folder):
    write("robot.xacro", '<xacro:include filename="robot.xacro"/>')
    error = failure()
    assert error.code is files.INCLUDE_RECURSIVE
    assert error.values == {"file": "robot.xacro", "length": 1}


def test_files_that_include_each_other_end(folder):
    write("robot.xacro", '<xacro:include filename="arm.xacro"/>')
    write("arm.xacro", '<xacro:include filename="hand.xacro"/>')
    write("hand.xacro", '<xacro:include filename="arm.xacro"/>')
    error = failure()
    assert error.code is files.INCLUDE_RECURSIVE and error.values["length"] == 2
    assert {str(error.origin.file), error.values["file"]} <= {"arm.xacro", "hand.xacro"}


def test_a_macro_that_calls_itself_ends(folder):
    write(
        "robot.xacro",
        '<xacro:macro name="arm"><xacro:arm/></xacro:macro><xacro:arm/>',
    )
    assert failure().code is files.EXPANSION_TOO_LARGE


def test_errors_within_macros_show_the_calls(folder):
    write(
        "robot.xacro",
        """<xacro:macro name="outer">
  <xacro:inner/>
</xacro:macro>
<xacro:macro name="inner">
  <a b="${nothing}"/>
</xacro:macro>
<xacro:outer/>""",
    )
    error = failure()
    assert placed(error.diagnostic()) == "robot.xacro:6 error xacro-name-unknown"
    assert (error.values["name"], error.values["expression"]) == ("nothing", "nothing")
    assert error.origin.stack == ("robot.xacro:3 xacro:inner", "robot.xacro:8 xacro:outer")


def test_macros_that_grow_without_bound_end(folder, monkeypatch):
    monkeypatch.setattr(expansion, "MAX_ELEMENTS", 20_000)
    doubling = "".join(
        f'<xacro:macro name="m{n}"><xacro:m{n - 1}/><xacro:m{n - 1}/></xacro:macro>'
        for n in range(1, 40)
    )
    body = f'<xacro:macro name="m0">{"<a/>" * 100}</xacro:macro>{doubling}<xacro:m39/>'
    write("robot.xacro", body)
    error = failure()
    assert error.code is files.EXPANSION_TOO_LARGE and error.values["kind"] == "elements"


@pytest.mark.parametrize("call", ["<xacro:m{}/>", '<xacro:call macro="m{}"/>'])
def test_macro_calls_are_bounded(folder, call, monkeypatch):
    monkeypatch.setattr(expansion, "MAX_CALLS", 1000)
    each = "".join(
        f'<xacro:macro name="m{n}">{call.format(n - 1) * 2}</xacro:macro>\n' for n in range(1, 40)
    )
    write("robot.xacro", f'<xacro:macro name="m0"/>\n{each}<xacro:m39/>')
    error = failure()
    assert error.code is files.EXPANSION_TOO_LARGE and error.origin.file == "robot.xacro"
    assert (error.values["kind"], error.values["most"]) == ("calls", 1000)
    assert re.fullmatch(r"xacro:m\d+", error.values["tag"])
    assert error.hint
    assert len(error.origin.stack) == 6
    assert re.fullmatch(r"robot\.xacro:\d+ xacro:m\d+", error.origin.stack[0])


def test_nine_thousand_macro_calls_expand(folder):
    macro = '<xacro:macro name="m0"/>\n<xacro:macro name="m1"><xacro:m0/><xacro:m0/></xacro:macro>'
    write("robot.xacro", macro + "<xacro:m1/>" * 3000 + "<a/>")
    assert [child.tag for child in expanded().root.children] == ["a"]


def test_unknown_argument_is_reported_with_the_declared_ones(folder):
    write("part.xacro", '<xacro:arg name="laser_enabled" default="1"/>', "")
    write("robot.xacro", '<xacro:include filename="part.xacro"/>')
    (reported,) = expanded(laser_enable="true").diagnostics
    assert placed(reported) == "robot.xacro warning argument-unknown laser_enabled"
    assert not expanded(laser_enabled="true").diagnostics


def test_messages_of_xacro_become_diagnostics(folder, capfd):
    write(
        "robot.xacro",
        """<xacro:property name="pi" value="3"/>
<a b="${xacro.warning('look here')}"/>
<xacro:include filename="no*.xacro"/>""",
    )
    reported = expanded().diagnostics
    assert [placed(each) for each in reported] == [
        f"robot.xacro:{line} warning xacro-message" for line in (2, 3, 4)
    ]
    assert reported[1].values == {"text": "look here"}
    assert capfd.readouterr() == ("", "")


def test_messages_of_one_line_are_distinguished_by_their_text(folder):
    write(
        "robot.xacro",
        """<xacro:if value="${[xacro.warning('one')] and [xacro.warning('one')] and True}"/>
<xacro:if value="${[xacro.warning('one')] and [xacro.warning('this is deprecated')] and True}"/>""",
    )
    reported = [(placed(each), each.values["text"]) for each in expanded().diagnostics]
    warning = "warning xacro-message"
    assert reported == [
        (f"robot.xacro:2 {warning}", "one"),
        (f"robot.xacro:3 {warning}", "one"),
        (f"robot.xacro:3 {warning}", "this is deprecated"),
    ]


def test_missing_namespace_is_reported(folder):
    Path("robot.xacro").write_text(
        '<robot name="r">\n<xacro:property name="a" value="1"/><b c="${a}"/></robot>'
    )
    found = expanded()
    assert found.root.children[0].attributes["c"] == "1"
    assert named(found.diagnostics[0]) == "xacro-namespace"


def test_loads_do_not_disturb_each_other(folder):
    write("bad.xacro", '<xacro:property name="left" value="1"/>\n<xacro:nothing/>')
    write("good.xacro", '<xacro:arg name="n" default="0"/><a n="$(arg n)"/>')
    write("needs.xacro", '<a n="${left}"/>')
    failure("bad.xacro")
    error = failure("needs.xacro")
    assert error.code is files.XACRO_NAME_UNKNOWN and error.values["name"] == "left"
    expanded("good.xacro", n="5")
    assert expanded("good.xacro").root.children[0].attributes["n"] == "0"

    results = {}

    def run(number):
        results[number] = expanded("good.xacro", n=str(number)).root.children[0].attributes["n"]

    threads = [threading.Thread(target=run, args=(number,)) for number in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert results == {number: str(number) for number in range(8)}


def test_the_package_xacro_itself_is_left_alone(folder):
    import xacro

    before = dict(vars(xacro))
    write("robot.xacro", '<xacro:property name="a" value="1"/>')
    expanded()
    assert vars(xacro) == before
    assert xacro.process_file("robot.xacro").documentElement.tagName == "robot"


def test_another_xacro_before_ours_is_passed_over(tmp_path):
    """A sourced ROS workspace has one of its own in PYTHONPATH."""
    (tmp_path / "xacro.py").write_text("raise ImportError('the wrong one')")
    (tmp_path / "robot.xacro").write_text(
        '<robot name="r" xmlns:xacro="http://ros.org/wiki/xacro">'
        '<xacro:property name="n" value="a"/><link name="${n}"/></robot>'
    )
    code = f"from cartwheel.description import load; print(load({str(tmp_path / 'robot.xacro')!r}))"
    done = subprocess.run(
        [sys.executable, "-c", code],
        env={**os.environ, "PYTHONPATH": str(tmp_path)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert "name='a'" in done.stdout


def test_what_is_deprecated_and_works_is_a_note(folder):
    (folder / "size.yaml").write_text("radius: 0.3\n")
    write("robot.xacro", """<a r="${load_yaml('size.yaml')['radius']}"/>""")
    found = expanded()
    assert dict(found.root.children[0].attributes) == {"r": "0.3"}
    (reported,) = found.diagnostics
    assert placed(reported) == "robot.xacro:2 info xacro-deprecated xacro.load_yaml"
    assert reported.values["name"] == "load_yaml"


def test_the_empty_name_of_a_yaml_file_is_an_error(folder):
    write("robot.xacro", """<xacro:arg name="f" default=""/>\n<a r="${load_yaml('$(arg f)')}"/>""")
    with pytest.raises(DescriptionError) as caught:
        expanded()
    assert caught.value.code is files.FILE_UNREADABLE
    assert caught.value.origin.line == 3


def test_a_robot_keeps_the_values_of_its_arguments_given_or_not():
    text = (
        '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><link name="a"/>'
        '<xacro:arg name="one" default="1"/><xacro:arg name="two" default="$(arg one)2"/></robot>'
    )
    assert load_text(text).arguments == {"one": "1", "two": "12"}
    assert load_text(text, arguments={"one": "3"}).arguments == {"one": "3", "two": "32"}


def test_an_argument_without_a_value_is_named_within_an_expression_too():
    with raises(files.XACRO_NAME_UNKNOWN, kind="argument", name="side", meant=""):
        load_text(
            '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
            '<xacro:property name="p" value="x"/><link name="${p + \'$(arg side)\'}"/></robot>'
        )


@pytest.mark.wording
def test_the_hint_shows_how_to_set_an_argument():
    with raises(files.XACRO_NAME_UNKNOWN) as caught:
        load_text(
            '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro">'
            '<link name="$(arg side)"/></robot>'
        )
    assert xacro_argument("side") in caught.value.hint


def test_an_element_named_by_an_expression_keeps_its_own_name(folder):
    """``xacro:name`` and ``name`` are two attributes, which also macros copy."""
    write(
        "robot.xacro",
        """<xacro:macro name="make" params="kind">
        <xacro:element xacro:name="${kind}" name="made" gz:name="other"/></xacro:macro>
        <xacro:make kind="link"/><xacro:element xacro:name="a"/>""",
        'name="r" xmlns:gz="http://gazebosim.org/schema"',
    )
    root = expanded().root
    link, other = root.children
    assert (link.tag, link.attributes) == ("link", {"name": "made", "gz:name": "other"})
    assert (other.tag, other.attributes) == ("a", {})


def test_an_attribute_set_to_a_number(folder):
    write("robot.xacro", '<a><xacro:attribute name="b" value="${1 + 1}"/></a>')
    assert expanded().root.children[0].attributes == {"b": "2"}


def test_an_expression_with_quotes_is_reported_as_a_whole(folder):
    write("robot.xacro", """<a b="${missing['key'] + 'x'}"/>""")
    assert failure().values["expression"] == "missing['key'] + 'x'"
    write("robot.xacro", """<a b="${missing + 'a' 'when evaluating' + ''}"/>""")
    assert failure().values["expression"] == "missing + 'a' 'when evaluating' + ''"


def test_a_text_of_the_description_is_not_taken_for_an_error_of_xacro(folder):
    write("robot.xacro", """<a b="${xacro.fatal('name \\'wheel\\' is not defined')}"/>""")
    assert named(failure()) == "expression-invalid"
    write("robot.xacro", """<a b="${xacro.fatal('Undefined substitution argument wheel')}"/>""")
    assert named(failure()) == "expression-invalid"


@pytest.mark.parametrize(
    "expression", ["wheel_radius", "xacro.wheel", "1 if wheel else 2"], ids=["plain", "in", "if"]
)
def test_an_undefined_property_is_named(folder, expression):
    write("robot.xacro", f'<a b="${{{expression}}}"/>')
    with raises(files.XACRO_NAME_UNKNOWN, kind="property", expression=expression) as error:
        expanded()
    assert error.value.values["name"] in expression
    assert error.value.origin.line == 2


@pytest.mark.parametrize("text", ["$(arg wheel)", "${'$(arg wheel)' + 'x'}"])
def test_an_argument_without_value_is_named(folder, text):
    write("robot.xacro", f'<a b="{text}"/>')
    with raises(files.XACRO_NAME_UNKNOWN, kind="argument", name="wheel") as error:
        expanded()
    assert error.value.origin.line == 2


def test_tags_without_prefix_are_taken_as_ros_did_until_melodic(folder):
    write(
        "macros.xacro",
        """<macro name="ball" params="m r:=0.1"><link name="${m}" r="${r}"/></macro>
<xacro:macro name="mount" params="n *at"><joint name="${n}"><insert_block name="at"/></joint>
</xacro:macro>
<xacro:macro name="camera" params="name"><never/></xacro:macro>""",
        "",
    )
    write(
        "robot.xacro",
        """<include filename="macros.xacro"/>
<property name="size" value="2"/><property name="mass" value="${2 * size}"/>
<if value="${size == 2}"><ball m="${mass}"/></if><unless value="1"><ball m="no"/></unless>
<ball m="5" r="1"/>
<mount n="j"><origin xyz="1 2 3"/></mount>
<camera name="c"/><include><uri>model://a</uri></include><ball mass="1"/>""",
    )
    expansion = expanded()
    ball, other, mount, *plain = expansion.root.children
    assert [ball.tag, dict(ball.attributes)] == ["link", {"name": "4", "r": "0.1"}]
    assert dict(other.attributes) == {"name": "5", "r": "1"}
    assert [mount.tag, *(each.tag for each in mount.children)] == ["joint", "origin"]
    # Nothing else has the name of a macro's, or its parameters.
    assert [each.tag for each in plain] == ["camera", "include", "ball"]
    reported = [placed(each) for each in expansion.diagnostics]
    assert reported[1] == "robot.xacro:3 warning xacro-prefix xacro:property"
    # Of calls, the first of each macro.
    assert sum(each.endswith("xacro-prefix xacro:ball") for each in reported) == 1
    assert len(reported) == 8


def test_what_a_macro_makes_may_have_its_own_name(folder):
    write(
        "robot.xacro",
        """<xacro:macro name="part" params="n:=1"><part n="${n}"/></xacro:macro>
<xacro:part n="2"/>""",
    )
    (part,) = expanded().root.children
    assert (part.tag, part.attributes["n"]) == ("part", "2")


def test_a_property_that_is_defined_after_its_use_is_named_with_its_line(folder):
    write(
        "robot.xacro",
        """<link name="a${width}"/>
<xacro:macro name="m"><xacro:property name="width" value="1"/></xacro:macro>

<xacro:property name="width" value="2"/>""",
    )
    with raises(files.XACRO_NAME_UNKNOWN, kind="property", name="width") as caught:
        expanded()
    use = caught.value.origin.line
    assert caught.value.values["defined"] == f"robot.xacro:{use + 3}"
    assert caught.value.values["meant"] == "width"
    write("robot.xacro", '<link name="a${width}"/><xacro:property name="with" value="2"/>')
    with raises(files.XACRO_NAME_UNKNOWN, kind="property", name="width") as caught:
        expanded()
    assert "defined" not in caught.value.values
