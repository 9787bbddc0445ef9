"""Cameras with and without OpenGL and a display, and their memory."""

import importlib
import os
import subprocess
import sys
from pathlib import Path

import pytest
from tests.coded import coded
from tests.devices.cameras.posts import camera

from cartwheel.codes import world as world_codes
from cartwheel.geometry import Pose


def resident_bytes():
    pages = Path("/proc/self/statm").read_text().split()[1]
    return int(pages) * os.sysconf("SC_PAGE_SIZE")


def test_memory_does_not_grow_with_images(make):
    world = make.world(make.sdf(camera(rate=200)))
    images = []
    world.subscribe("/cam/image_raw", lambda message: images.append(message.header.stamp))
    world.run(1.0)
    before = resident_bytes()
    world.run(10.0)
    assert len(images) == 2201
    # A leak of one image in a hundred would be 4.6 MB.
    assert resident_bytes() - before < 4e6


def test_a_machine_without_opengl_says_so_once_and_drives_on(make, rosbots, monkeypatch):
    from cartwheel.simulation.sensing import opengl as offscreen

    real = importlib.import_module

    def absent(name, *rest):
        if name.startswith("mujoco."):
            raise ImportError(f"{name}: no library")
        return real(name, *rest)

    monkeypatch.setattr(offscreen.importlib, "import_module", absent)
    world = make.world()
    world.session.spawn(rosbots, pose=Pose((0, 0, 0.05)))
    images = world.mailbox("/rosbots/camera1/image_raw")
    info, odometry = world.mailbox("/rosbots/camera1/camera_info"), world.mailbox("/odom")
    world.publish("/part2_cmr/cmd_vel", linear_x=0.5)
    world.run(2.0)
    assert images.drain() == []
    assert len(info.drain()) == 61
    assert len(odometry.drain()) == 201
    assert world.model("rosbots").pose.x > 0.5
    (reported,) = coded(
        world, world_codes.OPENGL_MISSING, packages=("libegl1", "libgl1", "libgl1-mesa-dri")
    )
    assert reported.severity == "warning"


SCRIPT = """
import cartwheel as cw
world = cw.World("post")
world.spawn("rosbots.xacro", z=0.05)
box = world.mailbox("/rosbots/camera1/image_raw")
world.run(0.1)
image = box.drain()[-1]
warnings = [d for d in world.diagnostics if d.severity != "info"]
print(len(image.data), int(image.data.max()) > int(image.data.min()), len(warnings))
"""


@pytest.mark.parametrize("gl", [None, "egl", ""])
def test_no_display_is_needed(gl):
    environment = {
        name: value
        for name, value in os.environ.items()
        if name not in ("DISPLAY", "MUJOCO_GL", "PYOPENGL_PLATFORM")
    }
    if gl is not None:
        environment["MUJOCO_GL"] = gl
    done = subprocess.run(
        [sys.executable, "-c", SCRIPT],
        env=environment,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    assert done.stdout.split() == ["230400", "True", "0"], done.stderr


BLIND = """
import cartwheel as cw
world = cw.World("post")
cart = world.spawn("rosbots.xacro", z=0.05)
box = world.mailbox("/rosbots/camera1/image_raw")
cart.publish("/part2_cmr/cmd_vel", linear_x=0.5)
world.run(2.0)
warnings = [d for d in world.diagnostics if d.severity != "info"]
print(len(box.drain()), cart.pose.x > 0.5, len(warnings))
print(warnings[0].code, warnings[0].values["packages"], sep="\\n")
print(*warnings[0].values["reasons"], sep="\\n")
"""


def test_opengl_that_is_named_and_missing_is_reported_and_no_more(tmp_path):
    """MuJoCo's own package loads what MUJOCO_GL names while it is imported, or fails."""
    (tmp_path / "OpenGL").mkdir()
    (tmp_path / "OpenGL" / "__init__.py").write_text('raise ImportError("no OpenGL here")')
    path = os.pathsep.join((str(tmp_path), os.environ.get("PYTHONPATH", "")))
    environment = {**os.environ, "MUJOCO_GL": "osmesa", "PYTHONPATH": path}
    # Left by pictures of tests before.
    environment.pop("PYOPENGL_PLATFORM", None)
    done = subprocess.run(
        [sys.executable, "-c", BLIND],
        env=environment,
        capture_output=True,
        text=True,
        timeout=60,
        check=False,
    )
    counts, *reported = done.stdout.splitlines()
    assert counts.split() == ["0", "True", "1"], done.stderr
    assert reported[:2] == [
        str(world_codes.OPENGL_MISSING),
        "('libegl1', 'libgl1', 'libgl1-mesa-dri')",
    ]
    assert "no OpenGL here" in reported[2]
