"""Gazebo's material names."""

import pytest

from cartwheel.description.appearance.materials import (
    gazebo_material,
    material_names,
    unknown_material,
)
from cartwheel.errors import Origin


@pytest.mark.parametrize(
    ("name", "diffuse"),
    [
        ("Gazebo/Blue", (0, 0, 1, 1)),
        ("Gazebo/Grey", (0.7, 0.7, 0.7, 1)),
        ("Gazebo/FlatBlack", (0.1, 0.1, 0.1, 1)),
        ("Gazebo/Orange", (1, 0.5088, 0.0468, 1)),
        ("Gazebo/Black", (0, 0, 0, 1)),
        ("Gazebo/BlueLaser", (0, 0, 1, 0.4)),
    ],
)
def test_colours(name, diffuse):
    assert gazebo_material(name).diffuse == diffuse


def test_glowing_materials_emit_their_colour():
    assert gazebo_material("Gazebo/RedGlow").emissive == (1, 0, 0, 1)
    assert gazebo_material("Gazebo/Red").emissive == (0, 0, 0, 1)


def test_every_name_has_a_material_of_that_name():
    assert len(material_names()) > 60
    for name in material_names():
        assert gazebo_material(name).name == name


@pytest.mark.parametrize("name", ["Blue", "Gazebo/blue", "Custom/Paint", ""])
def test_other_names(name):
    assert gazebo_material(name) is None


def test_likely_names():
    place = Origin(file="r.urdf", line=1)
    for name, meant in (
        ("Gazebo/Gray", "Gazebo/Grey"),
        ("skyblue", "Gazebo/SkyBlue"),
        ("Custom/Chequered", ""),
    ):
        diagnostic = unknown_material(name, place)
        assert diagnostic.values == {"name": name, "meant": meant}
        assert bool(diagnostic.hint) == bool(meant)


@pytest.mark.wording
def test_a_hint_names_the_likely_material():
    hint = unknown_material("skyblue", Origin(file="r.urdf", line=1)).hint
    assert "Gazebo/SkyBlue" in hint
