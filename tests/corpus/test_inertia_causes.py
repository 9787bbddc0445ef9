"""Inertias that are far too large for a body."""

import pytest
from tests.corpus.carts import cart, plugin, written

import cartwheel
from cartwheel.codes.robot import INERTIA_GEOMETRY_MISMATCH
from cartwheel.corpus import try_robot

USUAL = 'ixx="0.02" iyy="0.02" izz="0.02"'
MISSING = '<visual><geometry><mesh filename="body.stl"/></geometry></visual>'


def base(moment, more=""):
    """The cart, whose body has three equal moments of inertia in kg m²."""
    inertia = USUAL.replace("0.02", f"{moment:g}")
    text = cart().replace(USUAL, inertia, 1).replace("</inertial>", f"</inertial>{more}", 1)
    assert moment == 0.02 or inertia in text
    return text


@pytest.mark.parametrize("more", ["", MISSING])
def test_a_body_that_no_tyre_turns_is_the_reason(tmp_path, more):
    verdict = try_robot(written(tmp_path, base(1e5, more), plugin()), standing=1.0)
    turned = [fault for fault in verdict.faults if fault.test == "turn"]
    assert [(each.code, each.source) for each in turned] == [(INERTIA_GEOMETRY_MISMATCH, "file")]


@pytest.mark.parametrize(
    ("moment", "more", "told"),
    [
        (0.02, "", False),
        (0.5, "", True),
        # The mesh may be larger than the collision.
        (0.5, MISSING, False),
        (1e3, MISSING, True),
    ],
)
def test_a_missing_mesh_only_excuses_what_it_may_contain(tmp_path, moment, more, told):
    found = cartwheel.check(written(tmp_path, base(moment, more), plugin())).findings
    links = [each.values["link"] for each in found if each.code is INERTIA_GEOMETRY_MISMATCH]
    assert ("base" in links) is told
