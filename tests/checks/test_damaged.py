"""Damaged descriptions give findings or a user's error, never a crash."""

import re

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from cartwheel.checks.checking import check
from cartwheel.description.convert import to_urdf
from cartwheel.description.files.package_folders import share
from cartwheel.errors import CartwheelError

CART = share() / "robots" / "rosbots_description" / "urdf" / "rosbots.xacro"
URDF = to_urdf(CART, absolute=True)
XACRO = CART.read_text()
WORLD = (share() / "worlds" / "post.world").read_text()
ELEMENT = re.compile(r"<[a-zA-Z][^<>]*?/?>")
ATTRIBUTE = re.compile(r'[\w:]+="[^"]*"')
NUMBER = re.compile(r"(?<![\w.])-?\d+(\.\d+)?")
WHOLE = re.compile(r"<(\w+)[^<>]*>[^<>]*</\1>|<\w+[^<>]*/>")
VALUES = ["", "nan", "inf", "-1", "0", "1e308", "1e-308", "abc", "1 2 3", "ü", "1e9", "90"]

bounded = settings(max_examples=25, suppress_health_check=[HealthCheck.function_scoped_fixture])


@pytest.fixture(scope="module")
def survives(tmp_path_factory):
    folder = tmp_path_factory.mktemp("damaged")

    def look(text):
        path = folder / "robot.urdf"
        path.write_text(text)
        try:
            report = check(path)
        except CartwheelError as error:
            assert str(error)
            return
        for finding in report.findings:
            assert finding.message

    return look


def pick(data, pattern, text):
    return data.draw(st.sampled_from(list(pattern.finditer(text))))


@bounded
@given(st.data(), st.sampled_from([URDF, WORLD, XACRO]))
def test_an_element_cut_out(survives, data, text):
    match = pick(data, WHOLE, text)
    survives(text[: match.start()] + text[match.end() :])


@bounded
@given(st.data(), st.sampled_from([URDF, WORLD]), st.sampled_from(VALUES))
def test_a_number_changed(survives, data, text, value):
    match = pick(data, NUMBER, text)
    survives(text[: match.start()] + value + text[match.end() :])


@bounded
@given(st.data(), st.sampled_from(VALUES))
def test_an_attribute_changed(survives, data, value):
    match = pick(data, ATTRIBUTE, URDF)
    name = match.group().partition("=")[0]
    survives(URDF[: match.start()] + f'{name}="{value}"' + URDF[match.end() :])


@pytest.mark.parametrize("radius", ["1e160", "1e308"])
def test_wheels_of_any_size(survives, radius):
    wheels = list(re.finditer(r'radius="0.26"', URDF))
    assert wheels
    for match in wheels:
        survives(URDF[: match.start()] + f'radius="{radius}"' + URDF[match.end() :])


@bounded
@given(st.data())
def test_an_element_twice(survives, data):
    match = pick(data, WHOLE, URDF)
    survives(URDF[: match.end()] + match.group() + URDF[match.end() :])


@bounded
@given(st.data())
def test_several_things_cut_out(survives, data):
    text = URDF
    for _ in range(4):
        match = pick(data, WHOLE, text)
        text = text[: match.start()] + text[match.end() :]
    survives(text)


@bounded
@given(st.data())
def test_a_line_cut_out(survives, data):
    lines = URDF.splitlines(keepends=True)
    del lines[data.draw(st.integers(1, len(lines) - 1))]
    survives("".join(lines))
