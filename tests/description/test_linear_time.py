"""Texts of strangers that would be searched for minutes: the time grows with their length alone."""

import time

import pytest
from tests.coded import raises

from cartwheel.bridges.recording import decoding
from cartwheel.checks import spelling
from cartwheel.checks.checking import check
from cartwheel.codes.files import XML_MALFORMED
from cartwheel.codes.tags import VALUE_INVALID
from cartwheel.corpus import finding
from cartwheel.corpus.worlds import text_of
from cartwheel.description import load, load_text
from cartwheel.description.elements import numbers, xml
from cartwheel.description.files import install_rules as installed
from cartwheel.dialects.ros_control.substitution import substitute
from cartwheel.errors import CartwheelError
from cartwheel.similar_names import meant

MOST = 3.0
"""s of CPU time. Each takes a minute and more where a search begins anew at each character."""


@pytest.fixture(autouse=True)
def soon():
    start = time.thread_time()
    yield
    assert time.thread_time() - start < MOST


def test_a_long_number():
    digits = "1" * 100_000 + "x"
    with raises(VALUE_INVALID, name="mass"):
        load_text(
            f'<robot name="r"><link name="l"><inertial><mass value="{digits}"/>'
            '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link></robot>'
        )


def test_long_numbers_in_a_joint():
    digits = "1" * 100_000 + "x"
    joint = '<joint name="j" type="fixed"><parent link="a"/><child link="b"/><calibration rising="'
    load_text(f'<robot name="r"><link name="a"/><link name="b"/>{joint}{digits}"/></joint></robot>')


@pytest.mark.parametrize("begin", ["<!--", "<![CDATA["])
@pytest.mark.parametrize("kind", [str, str.encode])
def test_comments_without_an_end(begin, kind):
    with pytest.raises(CartwheelError):
        xml.parse(kind("<robot>" + begin * 100_000))


def test_a_comment_without_an_end_is_an_error():
    with raises(XML_MALFORMED):
        xml.parse("<robot><!-- a -- b </robot>")


def test_comments_of_other_files(tmp_path):
    file = tmp_path / "a.world"
    file.write_text("a<!--" * 100_000)
    assert text_of(file) == "a"


@pytest.mark.parametrize(("begin", "left"), [('"\\', ""), ("/*-", "")])
def test_definitions_in_a_recording(begin, left):
    assert decoding._NO_CODE.sub("", begin * 200_000) == left


def test_spaces_in_a_parameter_file(tmp_path):
    text = "$(find " + " " * 100_000
    assert substitute({"a": text}, tmp_path / "a.yaml", {}) == {"a": text}


def test_spaces_in_a_list_of_what_is_installed():
    assert installed._INSTALL.search("install(DIRECTORY" + " " * 100_000) is None


def test_long_names():
    names = [f"{'ab' * 3000}{i}" for i in range(300)]
    assert meant("ba" * 3000, names) == ""
    assert numbers.likely("ba" * 3000, names) is None
    assert spelling.meant("ba" * 3000, names) == ""


def test_one_script_of_many_materials(tmp_path):
    (tmp_path / "s.material").write_text(
        "".join(f"material M{i}\n{{\n technique {{ pass {{ diffuse 1 0 0 1 }} }}\n}}\n"
                for i in range(3000))
    )  # fmt: skip
    visual = (
        '<visual name="v{}"><geometry><box><size>1 1 1</size></box></geometry><material><script>'
        "<uri>s.material</uri><name>M2999</name></script></material></visual>"
    )
    file = tmp_path / "m.sdf"
    file.write_text(
        '<sdf version="1.6"><model name="m"><link name="l">'
        + "".join(visual.format(i) for i in range(500))
        + "</link></model></sdf>"
    )
    colours = {each.material.diffuse for each in load(file).links[0].visuals}
    assert colours == {(1.0, 0.0, 0.0, 1.0)}


def test_a_rule_stops_after_many_findings(tmp_path):
    file = tmp_path / "r.urdf"
    joints = "".join(
        f'<joint name="j{i}" type="fixed"><parent link="no"/><child link="l"/></joint>'
        for i in range(300)
    )
    file.write_text(f'<robot name="r"><link name="l"/>{joints}</robot>')
    found = [each for each in check(file).findings if each.code.name == "joint-link-unknown"]
    assert len(found) <= 201
    assert [each.values["most"] for each in found if "most" in each.values] == [200]


@pytest.mark.parametrize("text", ["<macro ", "<macro ></macro", "<macro></macro>"])
def test_macros_that_do_not_end(text):
    assert finding._only_defines(text * 100_000) == text.endswith("/macro>")
