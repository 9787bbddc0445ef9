"""Links of which ROS and Gazebo read only a part."""

import pytest

from cartwheel.checks import check
from cartwheel.checks.project.fixing import fixes
from cartwheel.codes.tags import ELEMENT_LEFT_OUT, LINK_CUT_SHORT
from cartwheel.description import load_text

MASS = '<mass value="1"/>'
SIX = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
SPACED = SIX.replace('iyy="1"', 'iyy="1 "')
THREE = '<inertia ixx="1" iyy="1" izz="1"/>'
BOX = '<geometry><box size="1 1 1"/></geometry>'
SEEN, FELT = f"<visual>{BOX}</visual>", f"<collision>{BOX}</collision>"
BODY = f"<inertial>{MASS}{SIX}</inertial>"


def urdf(arm, kind="revolute"):
    limit = '<limit lower="-1" upper="1" effort="10" velocity="1"/>'
    return (
        f'<robot name="r"><link name="base">{BODY}{FELT}</link>\n<link name="arm">{arm}</link>\n'
        f'<joint name="j" type="{kind}"><parent link="base"/><child link="arm"/>{limit}</joint>'
        "</robot>"
    )


def cut(text):
    robot = load_text(text)
    assert [each.name for each in robot.links] == ["base", "arm"]
    return [each for each in robot.diagnostics if each.values.get("cut") is True]


def solid(shape, kind="collision"):
    return f"<{kind}><geometry>{shape}</geometry></{kind}>"


SHORT = {
    "no products": (f"<inertial>{MASS}{THREE}</inertial>{SEEN}{FELT}", "error", ()),
    "no inertia": (f"<inertial>{MASS}</inertial>{SEEN}{FELT}", "error", ("visual", "collision")),
    "no mass": (f"<inertial>{SIX}</inertial>{SEEN}{FELT}", "error", ()),
    "no value": (f"<inertial><mass/>{SIX}</inertial>{SEEN}{FELT}", "error", ()),
    "space after the mass": (
        f'<inertial><mass value="1 "/>{SIX}</inertial>{SEEN}{FELT}',
        "error",
        (),
    ),
    "space after a moment": (
        f"<inertial>{MASS}{SPACED}</inertial>{SEEN}{FELT}",
        "error",
        (),
    ),
    "capsule": (
        BODY + SEEN + FELT + solid('<capsule radius="1" length="1"/>'),
        "error",
        ("collision",),
    ),
    "capsule that is only seen": (
        BODY + solid('<capsule radius="1" length="1"/>', "visual") + SEEN,
        "warning",
        ("visual",),
    ),
    "capsule that is only seen, and collisions": (
        BODY + SEEN + solid('<capsule radius="1" length="1"/>', "visual") + FELT,
        "error",
        ("visual", "collision"),
    ),
    "another element before the shape": (
        BODY + solid('<material name="m"/><box size="1 1 1"/>'),
        "error",
        ("collision",),
    ),
    "space after a radius": (
        BODY + solid('<cylinder radius="1 " length="1"/>'),
        "error",
        ("collision",),
    ),
    "no geometry": (f"{BODY}{SEEN}<collision/>{FELT}", "error", ("collision",)),
    "empty geometry": (f"{BODY}<visual><geometry/></visual>", "warning", ("visual",)),
}
ALL = ("inertia", "visual", "collision")


@pytest.mark.parametrize("case", SHORT)
def test_the_rest_of_the_link_is_read_and_reported(case):
    arm, severity, lost = SHORT[case]
    (found,) = cut(urdf(arm))
    assert (found.code, found.severity, found.origin.line) == (LINK_CUT_SHORT, severity, 2)
    assert found.values["link"] == "arm"
    assert found.values["lost"] == (lost or ALL)


COMPLETE = {
    "complete": BODY + SEEN + FELT,
    "frame": "",
    "space before a number": BODY + solid('<sphere radius=" 1"/>'),
    "spaces in a vector": BODY + solid('<box size=" 1  1 1 "/>'),
    # Nothing follows that could be lost.
    "point mass": f"<inertial>{MASS}</inertial>",
}


@pytest.mark.parametrize("case", COMPLETE)
def test_a_complete_link_is_not_reported(case):
    assert not cut(urdf(COMPLETE[case]))


@pytest.mark.parametrize("kind", ["fixed", "revolute"])
def test_the_inertia_of_a_part_that_is_fixed_to_another_hardly_matters(kind):
    (found,) = cut(urdf(f"<inertial>{MASS}{THREE}</inertial>{SEEN}", kind))
    assert found.severity == ("warning" if kind == "fixed" else "error")


def test_what_cartwheel_reads_of_the_link():
    arm = load_text(urdf(f"<inertial>{MASS}{THREE}</inertial>{SEEN}{FELT}")).link("arm")
    assert (arm.inertial.mass, arm.inertial.products) == (1.0, (0.0, 0.0, 0.0))
    assert len(arm.visuals) == len(arm.collisions) == 1


def test_a_material_without_a_name_is_an_error_if_collisions_are_lost():
    nameless = f"<visual>{BOX}<material/></visual>"
    for rest, severity in ((FELT, "error"), ("", "warning")):
        (found,) = cut(urdf(BODY + nameless + rest))
        assert (found.code, found.severity) == (ELEMENT_LEFT_OUT, severity)


def test_the_missing_moments_are_written(tmp_path):
    path = tmp_path / "r.urdf"
    path.write_text(urdf(f"\n<inertial>{MASS}\n{THREE}</inertial>{SEEN}{FELT}"))
    found = [each for each in check(path).findings if each.code is LINK_CUT_SHORT]
    (fix,) = fixes(found, tmp_path)
    fix.write()
    assert not [each for each in check(path).findings if each.code is LINK_CUT_SHORT]


@pytest.mark.parametrize(
    ("wrong", "meant"),
    [('<mass vlue="1"/>', "vlue"), ('<mas value="1"/>', "mas"), ("<mass/>", "")],
)
def test_a_likely_misspelling(wrong, meant):
    (found,) = cut(urdf(f"<inertial>{wrong}{SIX}</inertial>{FELT}"))
    assert found.values["meant"] == meant


@pytest.mark.parametrize(("version", "lost"), [("1.0", True), ("1.2", False)])
def test_a_capsule_belongs_to_a_later_version_of_urdf(version, lost):
    text = urdf(BODY + solid('<capsule radius="1" length="1"/>')).replace(
        "<robot", f'<robot version="{version}"', 1
    )
    assert bool(cut(text)) == lost
