"""Names of collisions and visuals for which Gazebo does not apply the tags of their link."""

import pytest

from cartwheel.checks import check
from cartwheel.codes.tags import GAZEBO_IGNORES

BOX = '<geometry><box size="0.2 0.2 0.2"/></geometry>'
BODY = (
    '<link name="{}"><inertial><mass value="1"/>'
    '<inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.1"/></inertial>{}</link>'
)
FRICTION = "<mu1>0.2</mu1><mu2>0.2</mu2>"


@pytest.fixture
def found(tmp_path):
    def run(shape, tags=FRICTION, *, root="base", link="lid", kind="fixed", more=""):
        parts = (
            BODY.format(root, ""),
            f"\n{BODY.format(link, shape)}",
            f'<joint name="j" type="{kind}"><parent link="{root}"/><child link="{link}"/></joint>',
            f'<gazebo reference="{link}">{tags}</gazebo>{more}',
        )
        file = tmp_path / "r.urdf"
        file.write_text(f'<robot name="r">{"".join(parts)}</robot>')
        return [each for each in check(file).findings if each.code is GAZEBO_IGNORES]

    return run


def collision(name):
    return (
        f'<collision name="{name}">{BOX}</collision>' if name else f"<collision>{BOX}</collision>"
    )


@pytest.mark.parametrize("kind", ["fixed", "continuous"])
@pytest.mark.parametrize(
    ("name", "if_merged", "if_own"),
    [
        ("", False, False),
        ("lid", False, False),
        ("lid_collision", False, False),
        ("lid_box", True, False),
        ("box", True, True),
        ("base_lid", True, True),
    ],
)
def test_the_name_of_a_collision_decides_whether_gazebo_applies_the_friction(
    found, kind, name, if_merged, if_own
):
    """As `InsertSDFExtensionCollision` in the parser_urdf.cc of sdformat 4 to 14."""
    ignored = found(collision(name), kind=kind)
    assert bool(ignored) == (if_merged if kind == "fixed" else if_own)
    for each in ignored:
        assert (each.severity, each.origin.line) == ("warning", 2)
        assert each.values == {"link": "lid", "name": name, "tags": ("mu1", "mu2")}


def test_a_link_whose_name_begins_with_that_of_the_link_it_is_merged_into(found):
    (ignored,) = found(collision(""), link="base_lid")
    assert ignored.values["name"] == ""
    kept = '<gazebo reference="j"><preserveFixedJoint>true</preserveFixedJoint></gazebo>'
    assert not found(collision(""), link="base_lid", more=kept)
    assert not found(collision(""), link="base_lid", root="world")


@pytest.mark.parametrize(
    ("tags", "severity"),
    [
        ("<mu1>1.0</mu1><mu2 value='1'/>", "info"),
        ("<mu1>1.0</mu1><mu2 value='0'/>", "warning"),
        ("<kp>1e6</kp>", "info"),
        ("<selfCollide>true</selfCollide>", None),
        ("<material>Gazebo/Red</material>", None),
    ],
)
def test_other_tags_than_friction_hardly_matter(found, tags, severity):
    ignored = found(collision("box"), tags)
    assert [each.severity for each in ignored] == ([severity] if severity else [])


def test_materials_of_visuals(found):
    visual = f'<visual name="box">{BOX}</visual><visual name="lid">{BOX}</visual>'
    (ignored,) = found(visual, "<material>Gazebo/Red</material>" + FRICTION)
    assert (ignored.severity, ignored.values["tags"]) == ("info", ("material",))
