"""Models that Gazebo downloaded before are found by their URL."""

from __future__ import annotations

import pytest

from cartwheel.description.files import fuel

HOST = "https://fuel.gazebosim.org/1.0"


@pytest.fixture
def cache(tmp_path):
    for version in ("2", "10"):
        folder = tmp_path / "fuel.ignitionrobotics.org/openrobotics/models/construction cone"
        (folder / version / "meshes").mkdir(parents=True)
        (folder / version / "meshes" / "a b.dae").touch()
    return folder


@pytest.mark.parametrize(
    ("rest", "found"),
    [
        ("OpenRobotics/models/Construction Cone", "10"),
        ("openrobotics/models/construction%20cone/", "10"),
        ("OpenRobotics/models/Construction Cone/2", "2"),
        ("OpenRobotics/models/Construction Cone/3", "10"),
        ("OpenRobotics/models/Construction Cone/tip/files/meshes/a b.dae", "10/meshes/a b.dae"),
        ("OpenRobotics/models/Construction Cone/2/files/meshes/a%20b.dae", "2/meshes/a b.dae"),
        ("OpenRobotics/models/Construction Cone/2/files/meshes/c.dae", None),
        ("OpenRobotics/models/Cone", None),
        ("OpenRobotics/worlds/Construction Cone", None),
    ],
)
def test_the_newest_version_or_the_stated_one(cache, tmp_path, rest, found):
    environment = {"GZ_FUEL_CACHE_PATH": str(tmp_path)}
    expected = cache / found if found else None
    assert fuel.cached(f"{HOST}/{rest}", environment) == expected


def test_the_name_of_a_model():
    assert fuel.model_name(f"{HOST}/OpenRobotics/models/X3%20UAV/4") == "X3 UAV"
    assert fuel.model_name("model://sun") is None
