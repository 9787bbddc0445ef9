"""Damaged descriptions end in an error that is the user's to mend, never in a crash or a hang."""

import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from cartwheel.description import load_text
from cartwheel.description.convert import to_urdf
from cartwheel.description.files.package_folders import share
from cartwheel.description.kinematics import link_poses
from cartwheel.description.model import RobotDescription
from cartwheel.errors import CartwheelError

CART = share() / "robots" / "rosbots_description" / "urdf" / "rosbots.xacro"
SOURCES = {path.name: path.read_text() for path in sorted(CART.parent.glob("*.xacro"))}
URDF = to_urdf(CART)
ELEMENT = re.compile(r"<[a-zA-Z][^<>]*?/?>")
ATTRIBUTE = re.compile(r'[\w:]+="[^"]*"')
NUMBER = re.compile(r"(?<![\w.])-?\d+(\.\d+)?")
NAME = re.compile(r"(?<=[<\"/ ])[a-z_]{3,}")
VALUES = ["", "nan", "inf", "-1", "0", "1e308", "1e-308", "abc", "1 2 3", "${x}", "$(find x)", "ü"]

bounded = settings(max_examples=120)
texts = st.sampled_from([URDF, *SOURCES.values()])


def survives(text):
    """Loads, or fails with a diagnostic; returns which."""
    try:
        found = load_text(text, file=str(CART))
    except CartwheelError as error:
        assert str(error)
        assert error.origin is not None
        return False
    if isinstance(found, RobotDescription):
        assert set(link_poses(found, {})) == {link.name for link in found.links}
    return True


def pick(data, pattern, text):
    found = list(pattern.finditer(text))
    return data.draw(st.sampled_from(found)) if found else None


@bounded
@given(st.data(), texts)
def test_truncated(data, text):
    assert not survives(text[: data.draw(st.integers(0, len(text) - 12))])


@bounded
@given(st.data(), texts)
def test_a_piece_cut_out(data, text):
    start = data.draw(st.integers(0, len(text) - 1))
    survives(text[:start] + text[start + data.draw(st.integers(1, 200)) :])


@bounded
@given(st.data(), texts, st.sampled_from([ELEMENT, ATTRIBUTE]))
def test_deleted_and_doubled_parts(data, text, pattern):
    part = pick(data, pattern, text)
    survives(text[: part.start()] + text[part.end() :])
    survives(text[: part.end()] + " " + text[part.start() :])


@bounded
@given(st.data(), st.integers(0, 10_000))
def test_whole_elements_gone_doubled_and_moved(data, seed):
    from cartwheel.description.elements import xml
    from cartwheel.description.xml_text import write_xml

    root = xml.parse(URDF)
    nodes = [root]
    for node in nodes:
        nodes.extend(node.children)
    holders = [node for node in nodes if node.children]
    source, target = data.draw(st.sampled_from(holders)), data.draw(st.sampled_from(holders))
    moved = source.children[seed % len(source.children)]
    source.drop(moved)
    survives(write_xml(root))
    inside = [moved]
    for node in inside:
        inside.extend(node.children)
    if target not in inside:
        target.children.append(moved)
        survives(write_xml(root))
        source.children.append(moved)
        survives(write_xml(root))


@bounded
@given(st.data(), texts)
def test_renamed(data, text):
    part = pick(data, NAME, text)
    other = pick(data, NAME, text)
    survives(text[: part.start()] + other[0] + text[part.end() :])


@bounded
@given(st.data(), texts)
def test_numbers_swapped_and_replaced(data, text):
    part = pick(data, NUMBER, text)
    other = pick(data, NUMBER, text)[0]
    survives(text[: part.start()] + other + text[part.end() :])
    survives(text[: part.start()] + data.draw(st.sampled_from(VALUES)) + text[part.end() :])


@bounded
@given(st.data(), texts)
def test_values_replaced(data, text):
    part = pick(data, re.compile(r'(?<=")[^"<>]*(?=")'), text)
    survives(text[: part.start()] + data.draw(st.sampled_from(VALUES)) + text[part.end() :])


@bounded
@given(st.data(), texts, st.binary(min_size=1, max_size=8))
def test_bytes_overwritten(data, text, junk):
    content = text.encode()
    start = data.draw(st.integers(0, len(content) - 1))
    survives(content[:start] + junk + content[start + len(junk) :])


@bounded
@given(st.binary(max_size=300))
def test_noise(content):
    assert not survives(content)


@bounded
@given(st.text(max_size=200))
def test_noise_within_a_robot(text):
    survives(f'<robot name="r"><link name="a"/>{text}</robot>')
    survives(f'<robot name="r" xmlns:xacro="x"><xacro:property name="a" value="1"/>{text}</robot>')


@bounded
@given(st.text(alphabet="${}()'\"+-*/ .,abx01[]:^|", max_size=40))
def test_noise_within_expressions(text):
    escaped = text.replace('"', "&quot;")
    survives(
        '<robot name="r" xmlns:xacro="x"><xacro:property name="a" value="1"/>'
        f'<xacro:property name="b" value="${{a}}"/><link name="l" x="{escaped}"/></robot>'
    )
    survives(
        f'<robot name="r" xmlns:xacro="x"><xacro:macro name="m" params="{escaped}"><a/>'
        f'</xacro:macro><xacro:m a="1" b="{escaped}"/><link name="l"/></robot>'
    )


@pytest.mark.parametrize("name", SOURCES)
def test_undamaged(name):
    assert survives(SOURCES[name]) is (name == "rosbots.xacro")
