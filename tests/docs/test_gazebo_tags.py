"""The page of tags: each row is tried, and no tag that is known is missing."""

import re
from dataclasses import replace

import pytest
from tests.coded import coded
from tests.docs.pages import ROOT

import cartwheel as cw
from cartwheel.codes.tags import TAG_IGNORED
from cartwheel.description import load_text
from cartwheel.description.urdf import gazebo_link_tags as of_links
from cartwheel.description.urdf import gazebo_tags as of_others

PAGE = (ROOT / "docs" / "gazebo-tags.md").read_text()
ROW = re.compile(r"^\| `(<.*?>)` \| (yes|note|warning) \| (.*) \|$", re.MULTILINE)
SEVERITY = {"note": "info", "warning": "warning"}
BODY = (
    '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" '
    'ixy="0" ixz="0" iyz="0"/></inertial><collision><geometry>'
    '<box size="1 1 1"/></geometry></collision><visual><geometry><box size="1 1 1"/></geometry>'
    "</visual>"
)
URDF = (
    '<robot name="r"><link name="base">{body}</link><link name="arm">{body}</link>'
    '<joint name="hinge" type="{type}"><parent link="base"/><child link="arm"/></joint>{tags}'
    "</robot>"
)
SECTIONS = {"link": "base", "joint": "hinge", "robot": ""}
KNOWN = {
    "link": {*of_links.LINK_TAGS, *of_links._IDLE},
    "joint": {*of_others.JOINT_TAGS},
    "robot": {*of_others.ROBOT_TAGS, *of_others._ROBOT_IDLE},
}


def section(kind):
    text = PAGE.split(f"## {kind.capitalize()} tags")[1]
    return ROW.findall(text.split("\n## ")[0])


ROWS = [(kind, *row) for kind in SECTIONS for row in section(kind)]


def tag_of(example):
    return re.match(r"<(\w+)", example)[1]


@pytest.mark.parametrize("kind", SECTIONS)
def test_no_tag_is_missing_from_the_page(kind):
    assert {tag_of(example) for example, _, _ in section(kind)} == KNOWN[kind]


def load(kind, example):
    fixed = "ixed" in example
    reference = SECTIONS[kind]
    attribute = f' reference="{reference}"' if reference else ""
    tags = f"<gazebo{attribute}>{example}</gazebo>" if example else ""
    joint = "fixed" if fixed else "continuous"
    return load_text(URDF.format(body=BODY, type=joint, tags=tags)), joint


def reported(description):
    """The diagnostics of a spawned robot."""
    with cw.World("empty") as world:
        before = len(world.diagnostics)
        world.spawn(description)
        return world.diagnostics[before:]


@pytest.mark.parametrize(("kind", "example", "acts", "said"), ROWS)
def test_each_tag_acts_or_is_reported(kind, example, acts, said):
    found, joint = load(kind, example)
    plain = load_text(URDF.format(body=BODY, type=joint, tags=""))
    changed = replace(found, text="", diagnostics=()) != replace(plain, text="", diagnostics=())
    if acts == "yes":
        assert changed
        return
    # A robot without tags gives no diagnostics.
    assert [each for each in reported(found) if each.severity == SEVERITY[acts]], said


@pytest.mark.wording
@pytest.mark.parametrize(
    ("kind", "example", "said"),
    [(kind, example, said) for kind, example, acts, said in ROWS if acts != "yes"],
)
def test_the_page_says_what_the_message_says(kind, example, said):
    ignored = coded(reported(load(kind, example)[0]), TAG_IGNORED)
    assert all(said in each.message for each in ignored)
