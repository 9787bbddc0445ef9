"""The wheel holds everything that a user needs, and works in a folder of its own."""

import os
import subprocess
import sys
import sysconfig
import venv
import zipfile
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]


def run(command: list[str], folder: Path) -> str:
    # The checkout must not be found by accident.
    environment = {k: v for k, v in os.environ.items() if not k.startswith("PYTHON")}
    done = subprocess.run(
        command,
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=240,
        check=False,
    )
    assert done.returncode == 0, f"{' '.join(command)}\n{done.stdout}\n{done.stderr}"
    return done.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Built without a network: by the build backend of this environment."""
    folder = tmp_path_factory.mktemp("wheel")
    build = f"from hatchling.build import build_wheel; build_wheel({str(folder)!r})"
    run([sys.executable, "-c", build], ROOT)
    (built,) = folder.glob("cartwheel-*.whl")
    return built


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of programs of a new virtual environment with the wheel in it.

    What Cartwheel depends on is borrowed from this environment: fetching it anew would test the
    network.
    """
    folder = tmp_path_factory.mktemp("venv")
    venv.create(folder, with_pip=False)
    programs = folder / "bin"
    # This environment's pip: installing another one takes longer than all the rest.
    pip = [sys.executable, "-m", "pip", "--python", str(programs / "python"), "install"]
    run([*pip, "--quiet", "--no-deps", "--no-index", "--no-compile", str(wheel)], folder)
    (packages,) = folder.glob("lib/python3*/site-packages")
    borrowed = folder / "borrowed"
    borrowed.mkdir()
    for entry in Path(sysconfig.get_path("purelib")).iterdir():
        # Without the editable install's own traces of Cartwheel.
        if "cartwheel" not in entry.name and entry.suffix != ".pth":
            (borrowed / entry.name).symlink_to(entry)
    (packages / "borrowed.pth").write_text(f"{borrowed}\n")
    return programs


def test_robots_worlds_models_and_stand_ins_are_in_the_wheel(wheel: Path) -> None:
    names = set(zipfile.ZipFile(wheel).namelist())
    for kind in ("robots", "worlds", "models", "standins"):
        files = [file for file in (ROOT / kind).rglob("*") if file.is_file()]
        assert files, kind
        for file in files:
            assert f"cartwheel/share/{file.relative_to(ROOT)}" in names


def test_everything_that_is_not_python_is_in_the_wheel(wheel: Path) -> None:
    """Message definitions, the page's script and style, the marker of typed packages."""
    names = set(zipfile.ZipFile(wheel).namelist())
    source = ROOT / "src"
    for file in source.rglob("*"):
        if file.is_file() and "__pycache__" not in file.parts:
            assert str(file.relative_to(source)) in names


def test_nothing_else_is_in_the_wheel(wheel: Path) -> None:
    tops = {name.split("/")[0] for name in zipfile.ZipFile(wheel).namelist()}
    assert tops == {
        "cartwheel",
        "rtps_lite",
        next(top for top in tops if top.endswith(".dist-info")),
    }


def test_the_sdist_builds_the_same_wheel(wheel: Path, tmp_path: Path) -> None:
    build = f"from hatchling.build import build_sdist; build_sdist({str(tmp_path)!r})"
    run([sys.executable, "-c", build], ROOT)
    (sdist,) = tmp_path.glob("cartwheel-*.tar.gz")
    # Python 3.11.2, that of Debian 12, cannot unpack safely.
    run(["tar", "-xf", str(sdist)], tmp_path)
    (unpacked,) = (path for path in tmp_path.iterdir() if path.is_dir())
    build = f"from hatchling.build import build_wheel; build_wheel({str(tmp_path)!r})"
    run([sys.executable, "-c", build], unpacked)
    (built,) = tmp_path.glob("cartwheel-*.whl")
    assert set(zipfile.ZipFile(built).namelist()) == set(zipfile.ZipFile(wheel).namelist())


def test_the_licence_and_the_readme_are_in_the_wheel(wheel: Path) -> None:
    archive = zipfile.ZipFile(wheel)
    names = archive.namelist()
    assert any(name.endswith("LICENSE") for name in names)
    (metadata,) = (name for name in names if name.endswith("/METADATA"))
    text = archive.read(metadata).decode()
    assert "License-Expression: Apache-2.0" in text
    assert (ROOT / "README.md").read_text().strip().splitlines()[0] in text


def test_an_installed_cartwheel_runs_in_an_empty_folder(installed: Path, tmp_path: Path) -> None:
    output = run(
        [str(installed / "cartwheel"), "run", "--headless", "--speed", "max", "--for", "2"],
        tmp_path,
    )
    assert "rosbots" in output
    assert "simulated 2.000 s" in output
    assert not list(tmp_path.iterdir()), "a run leaves files behind"


def test_an_installed_cartwheel_finds_what_it_ships(installed: Path, tmp_path: Path) -> None:
    show = "from cartwheel.description.files.package_folders import share; print(share())"
    share = Path(run([str(installed / "python"), "-c", show], tmp_path).strip())
    assert share.is_relative_to(installed.parent)
    assert (share / "robots" / "rosbots_description" / "package.xml").is_file()
