"""Links that Gazebo merges across fixed joints have one gravity, by the order of sdformat."""

import pytest
from tests.coded import coded

from cartwheel.codes.devices import LUMPED_LINK
from cartwheel.description import load_text

BODY = (
    '<inertial><mass value="1"/>'
    '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'
)


def robot(*tags, preserved=""):
    """base - (b_mount) camera - (lens_mount) lens, base - (a_mount) laser, base - (hinge) arm."""
    links = "".join(
        f'<link name="{name}">{BODY}</link>' for name in ("base", "camera", "lens", "laser", "arm")
    )
    joints = "".join(
        f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
        "</joint>"
        for name, kind, parent, child in (
            ("b_mount", "fixed", "base", "camera"),
            ("lens_mount", "fixed", "camera", "lens"),
            ("a_mount", "fixed", "base", "laser"),
            ("hinge", "continuous", "base", "arm"),
        )
    )
    keep = "<preserveFixedJoint>true</preserveFixedJoint>"
    kept = f'<gazebo reference="{preserved}">{keep}</gazebo>' if preserved else ""
    return load_text(f'<robot name="r">{links}{joints}{"".join(tags)}{kept}</robot>', file="r.urdf")


def gravity(link, value, tag="gravity"):
    return f'<gazebo reference="{link}"><{tag}>{value}</{tag}></gazebo>'


def weightless(description):
    return {link.name for link in description.links if not link.gravity}


MERGED = {"base", "camera", "lens", "laser"}


@pytest.mark.parametrize(
    ("tags", "expected"),
    [
        ([gravity("base", 0)], MERGED),
        ([gravity("arm", 0)], {"arm"}),
        # The parent's tag is first, wherever it is in the file.
        ([gravity("lens", 1), gravity("base", 0)], MERGED),
        ([gravity("lens", 0), gravity("base", 1)], set()),
        # Of siblings, that of the first joint in alphabetical order.
        ([gravity("camera", 1), gravity("laser", 0)], MERGED),
        # turnGravityOff replaces the first tag, and the next one is then the first.
        ([gravity("base", 1), gravity("lens", "true", "turnGravityOff")], MERGED),
        (
            [
                gravity("base", 1),
                gravity("laser", 1),
                gravity("camera", "true", "turnGravityOff"),
            ],
            set(),
        ),
        # Of two tags of one link, too, the first one counts.
        ([gravity("base", 0), gravity("base", 1)], MERGED),
    ],
)
def test_merged_links_have_the_first_gravity(tags, expected):
    assert weightless(robot(*tags)) == expected


def test_a_preserved_joint_separates_the_gravity_of_its_links():
    assert weightless(robot(gravity("base", 0), preserved="b_mount")) == {"base", "laser"}
    assert weightless(robot(gravity("camera", 0), preserved="b_mount")) == {"camera", "lens"}


def test_a_sensor_that_turns_off_the_gravity_of_the_base_is_reported():
    (found,) = coded(robot(gravity("lens", "1", "turnGravityOff")), LUMPED_LINK)
    assert (found.values["link"], found.values["root"]) == ("lens", "base")


def test_a_tag_that_another_one_overrules_is_reported():
    (found,) = coded(robot(gravity("base", 1), gravity("camera", 0)), LUMPED_LINK)
    assert (found.values["link"], found.values["tag"]) == ("camera", "gravity")
    agreeing = robot(gravity("base", 1), gravity("camera", 1))
    assert not coded(agreeing, LUMPED_LINK)
