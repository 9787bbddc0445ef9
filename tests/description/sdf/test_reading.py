"""Repeated diagnostics of an SDF file: each is kept once, recognised by code, place and values."""

from dataclasses import replace

import pytest
from tests.coded import coded, raises

from cartwheel.codes import robot, tags
from cartwheel.description import load_text
from cartwheel.description.sdf.reading import _distinct
from cartwheel.errors import Origin

LINK = '<link name="l"><inertial><mass>1</mass></inertial>{parts}</link>'


def diagnostics(*parts):
    """Those of a model whose link has these parts, all in line 1."""
    link = LINK.format(parts="".join(parts))
    return load_text(f'<sdf version="1.7"><model name="m">{link}</model></sdf>').diagnostics


@pytest.mark.parametrize(
    ("part", "code"),
    [
        ('<visual name="{}"/>', tags.VALUE_IGNORED),
        ('<visual name="{}"><geometry/></visual>', tags.TAG_EMPTY),
    ],
)
def test_diagnostics_of_one_line_differ_by_the_name_of_their_element(part, code):
    reported = coded(diagnostics(part.format("a"), part.format("b")), code)
    assert [each.values["element"] for each in reported] == ["a", "b"]
    assert {str(each.origin) for each in reported} == {"<string>:1"}


@pytest.mark.parametrize("severity", ["info", "warning"])
def test_diagnostics_are_distinct_by_their_values_whatever_their_words(severity):
    first = robot.INERTIA_IMPOSSIBLE.diagnostic(
        "words",
        origin=Origin(file="m.sdf", line=3),
        severity=severity,
        values={"link": "a", "moments": (1.0, 1.0, 9.0)},
    )
    reordered = dict(reversed(first.values.items()))
    same = replace(first, message="other words", hint="Try this.", values=reordered)
    other = replace(first, values={**first.values, "link": "b"})
    less = replace(first, values={"link": "a"})
    assert list(_distinct([first, same, other, less, same])) == [first, other, less]
    assert [each.values for each in _distinct([first, other])] == [first.values, other.values]


def test_warnings_are_distinct_by_their_lines_but_notes_are_not():
    warning = tags.TAG_EMPTY.diagnostic(
        "words", origin=Origin(file="m.sdf", line=3), severity="warning", values={"tag": "geometry"}
    )
    later = replace(warning, origin=Origin(file="m.sdf", line=4))
    note, later_note = (replace(each, severity="info") for each in (warning, later))
    assert list(_distinct([warning, later, note, later_note])) == [warning, later, note]


@pytest.mark.parametrize("size", ["0 0 0", "0 1 2"])
def test_a_box_without_thickness_is_loaded(size):
    part = f'<visual name="a"><geometry><box><size>{size}</size></box></geometry></visual>'
    text = f'<sdf version="1.7"><model name="m">{LINK.format(parts=part)}</model></sdf>'
    robot = load_text(text)
    (visual,) = robot.links[0].visuals
    assert min(visual.shape.size) > 0
    assert coded(robot.diagnostics, tags.VALUE_IGNORED)


def test_a_missing_mesh_is_not_why_a_model_cannot_be_loaded():
    mesh = "<geometry><mesh><uri>no_such.stl</uri></mesh></geometry>"
    text = f"""<sdf version="1.7"><model name="m"><link name="a"><visual name="v">{mesh}</visual>
        </link><link name="b"><pose relative_to="absent"/></link></model></sdf>"""
    with raises(tags.NAME_UNKNOWN, name="absent"):
        load_text(text)
