"""What programs that show robots elsewhere may read, and what they may not."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from cartwheel.assembly.assets import Assets
from cartwheel.description import load_robot, load_text
from cartwheel.description.model import RobotDescription, WorldDescription
from cartwheel.session import Session

ROBOT = """<robot name="box"><link name="base">{inertial}<visual><geometry>
<box size="1 1 1"/></geometry></visual></link><!-- {uri} --></robot>"""
INERTIAL = """<inertial><mass value="1"/>
<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial>"""

Spawn = Callable[[RobotDescription], Assets]


@pytest.fixture
def package(tmp_path: Path) -> Path:
    """A package with a mesh, in a workspace."""
    made = tmp_path / "src" / "robots"
    (made / "meshes").mkdir(parents=True)
    (made / "package.xml").write_text("<package><name>robots</name></package>")
    (made / "meshes" / "a.stl").write_bytes(b"solid")
    (made / "secret.txt").write_text("secret")
    (tmp_path / "secret.stl").write_text("secret")
    return made


@pytest.fixture
def spawned() -> Iterator[Spawn]:
    session = Session(WorldDescription(name="empty"))

    def spawn(description: RobotDescription) -> Assets:
        session.spawn(description)
        return Assets(session, ())

    yield spawn
    session.close()


def text(uri: str = "") -> str:
    return ROBOT.format(inertial=INERTIAL, uri=uri)


def from_file(package: Path, uri: str = "") -> RobotDescription:
    file = package / "robot.urdf"
    file.write_text(text(uri))
    return load_robot(file)


def from_wire(uri: str = "") -> RobotDescription:
    found = load_text(text(uri), file="<model_xml of box>")
    assert isinstance(found, RobotDescription)
    return found


def test_shapes_of_packages(package: Path, spawned: Spawn) -> None:
    assets = spawned(from_file(package))
    assert assets("package://robots/meshes/a.stl") == b"solid"
    assert assets("package://robots/secret.txt") is None
    assert assets("package://robots/meshes/none.stl") is None


@pytest.mark.parametrize(
    "uri",
    ["package://robots/../../secret.stl", "package://robots/meshes/../../../secret.stl",
     "package://robots/%2e%2e/%2e%2e/secret.stl", "package://robots/..%2f..%2fsecret.stl",
     "package://robots/%252e%252e/secret.stl", "package://../secret.stl",
     "package://robots//{outer}/secret.stl", "package://$(find robots)/../../secret.stl",
     "package:///{outer}/secret.stl", "model://../secret.stl", "model://robots/../../secret.stl",
     "{outer}/secret.stl", "http://localhost/secret.stl", "package://robots/secret.txt%00.stl",
     "package://robots\\..\\..\\secret.stl", "file://{outer}/secret.stl", "", "package://"],
)  # fmt: skip
def test_nothing_else_is_reached(package: Path, spawned: Spawn, uri: str) -> None:
    outer = package.parent.parent
    assets = spawned(from_file(package))
    assert assets(uri.replace("{outer}", str(outer))) is None


def test_links_lead_no_further_than_their_package(package: Path, spawned: Spawn) -> None:
    outer = package.parent.parent
    (package / "meshes" / "out.stl").symlink_to(outer / "secret.stl")
    (package / "meshes" / "name.stl").symlink_to(package / "secret.txt")
    (package / "meshes" / "all").symlink_to(outer)
    (package / "meshes" / "same.stl").symlink_to("a.stl")
    assets = spawned(from_file(package))
    assert assets("package://robots/meshes/same.stl") == b"solid"
    for name in ("out.stl", "name.stl", "all/secret.stl"):
        assert assets(f"package://robots/meshes/{name}") is None, name


def test_an_installed_package_whose_files_are_links_to_its_source(
    package: Path, spawned: Spawn, monkeypatch: pytest.MonkeyPatch
) -> None:
    prefix = package.parent.parent / "install"
    share = prefix / "share" / "robots"
    share.mkdir(parents=True)
    for name in ("package.xml", "meshes"):
        (share / name).symlink_to(package / name)
    monkeypatch.setenv("AMENT_PREFIX_PATH", str(prefix))
    assert spawned(from_wire())("package://robots/meshes/a.stl") == b"solid"


def test_a_pipe_is_not_waited_for(package: Path, spawned: Spawn) -> None:
    os.mkfifo(package / "meshes" / "pipe.stl")
    assert spawned(from_file(package))("package://robots/meshes/pipe.stl") is None


def test_a_file_that_is_too_large(
    package: Path, spawned: Spawn, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("cartwheel.assembly.assets.LARGEST", 4)
    assert spawned(from_file(package))("package://robots/meshes/a.stl") is None


def test_files_that_a_description_from_a_file_names(package: Path, spawned: Spawn) -> None:
    mesh = package / "meshes" / "a.stl"
    (package / "meshes" / "out.stl").symlink_to(package.parent.parent / "secret.stl")
    assets = spawned(from_file(package, f"file://{mesh}"))
    assert assets(f"file://{mesh}") == b"solid"
    assert assets(f"file://{mesh.with_name('out.stl')}") is None
    assert assets(f"file://{package.parent.parent}/secret.stl") is None


def test_text_that_came_over_a_wire_names_no_files(package: Path, spawned: Spawn) -> None:
    mesh = package / "meshes" / "a.stl"
    assets = spawned(from_wire(f"file://{mesh}"))
    assert assets(f"file://{mesh}") is None
