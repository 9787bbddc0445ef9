"""The packages in which a simulation finds message types."""

from pathlib import Path

import pytest
from tests.message_packages import write_package

from cartwheel.description.files.package_files import SimulationPackages

FILES = {"msg/One.msg": "int8 x\n"}


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """No workspace is sourced, and the current folder is in none."""
    for variable in ("ROS_PACKAGE_PATH", "AMENT_PREFIX_PATH", "CMAKE_PREFIX_PATH"):
        monkeypatch.delenv(variable, raising=False)
    (tmp_path / "empty").mkdir()
    monkeypatch.chdir(tmp_path / "empty")


def test_installed_packages_are_found(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    two = write_package(tmp_path / "install/a_msgs/share/a_msgs", FILES)
    one = write_package(tmp_path / "ros1" / "b_msgs", FILES)
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "install/a_msgs"))
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "ros1"))
    packages = SimulationPackages()
    assert packages.folders("a_msgs") == [two]
    assert packages.folders("b_msgs") == [one]
    assert packages.folders("c_msgs") == []


def test_the_order_of_packages_with_the_same_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    installed = write_package(tmp_path / "install/share/a_msgs", FILES)
    given = write_package(tmp_path / "given" / "a_msgs", FILES)
    near = write_package(tmp_path / "ws" / "src" / "a_msgs", FILES)
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "install"))
    packages = SimulationPackages([tmp_path / "given"])
    assert packages.add(write_package(near.parent / "crate", {"crate.urdf": ""}) / "crate.urdf")
    assert packages.folders("a_msgs") == [given, near, installed]


def test_descriptions_from_the_network_add_no_packages() -> None:
    assert not SimulationPackages().add("<model_xml of x>")


def test_links_of_an_installed_package_may_lead_to_its_source(tmp_path: Path) -> None:
    source = write_package(tmp_path / "src" / "a_msgs", FILES)
    other = write_package(tmp_path / "src" / "b_msgs", FILES)
    installed = write_package(tmp_path / "install/share/a_msgs", {})
    (installed / "msg").mkdir()
    (installed / "msg/One.msg").symlink_to(source / "msg/One.msg")
    (installed / "msg/Two.msg").symlink_to(other / "msg/One.msg")
    packages = SimulationPackages([installed.parent])
    assert packages.may_read(installed / "msg/One.msg", installed)
    assert not packages.may_read(installed / "msg/Two.msg", installed)
