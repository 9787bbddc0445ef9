"""The plugin of the page about plugins, installed as a package of its own."""

import re
import shutil
import subprocess
import sys
import tomllib

from .pages import DOCS, blocks
from .test_snippets import is_excerpt

EXAMPLE = DOCS / "how-to" / "files" / "tilt_alarm"
SCRIPT = """
import cartwheel as cw

with cw.World("empty", strict=True) as world:
    crate = world.spawn("robot.urdf", z=0.1)
    alarms = world.mailbox("/tilt_alarm")
    world.run(seconds=0.5)
    assert [alarm.data for alarm in alarms.drain()] == [False] * 5
    crate.pose = cw.Pose.from_xyz_rpy((0.0, 0.0, 0.5), (0.6, 0.0, 0.0))
    world.run(seconds=0.1)
    assert alarms.drain()[-1].data
"""


def test_an_installed_plugin_works(tmp_path):
    """Its entry point is that of pyproject.toml, as pip would write it."""
    shutil.copytree(EXAMPLE, tmp_path, dirs_exist_ok=True)
    project = tomllib.loads((EXAMPLE / "pyproject.toml").read_text())["project"]
    points = project["entry-points"]["cartwheel.plugins"]
    installed = tmp_path / f"tilt_alarm-{project['version']}.dist-info"
    installed.mkdir()
    lines = [f"{name} = {value}" for name, value in points.items()]
    (installed / "entry_points.txt").write_text("\n".join(["[cartwheel.plugins]", *lines]))
    about = f"Metadata-Version: 2.1\nName: {project['name']}\nVersion: {project['version']}\n"
    (installed / "METADATA").write_text(about)
    (tmp_path / "drive.py").write_text(SCRIPT)
    done = subprocess.run(
        [sys.executable, "drive.py"], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr


def test_how_to_pages_quote_their_files():
    for page in sorted((DOCS / "how-to").glob("*.md")):
        folders = re.findall(r"\]\((files/\w+)/", page.read_text())
        files = [each for name in folders for each in (page.parent / name).rglob("*.*")]
        for block in blocks(page, "python", "xml", "toml"):
            if "not run" not in block.notes and files:
                assert is_excerpt(block, files), f"{block} is in none of {folders}"
