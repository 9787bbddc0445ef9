"""Pictures of a world, and its page in a notebook."""

from __future__ import annotations

import atexit
import io
import re
import sys
import urllib.request
from pathlib import Path

import numpy as np
import pytest
from tests.coded import raises

import cartwheel as cw
from cartwheel.codes.world import NUMBER_OUT_OF_RANGE, SIMULATION_CLOSED

BALL = """<sdf version="1.7"><model name="{name}"><static>{static}</static>
<link name="base"><visual name="v"><geometry><sphere><radius>0.5</radius></sphere></geometry>
<material><ambient>{color}</ambient><diffuse>{color}</diffuse></material></visual>
<collision name="c"><geometry><sphere><radius>0.5</radius></sphere></geometry></collision>
</link></model></sdf>"""


def ball(folder: Path, name: str, color: str, *, static: bool = False) -> Path:
    file = folder / f"{name}.sdf"
    file.write_text(BALL.format(name=name, color=color, static=str(static).lower()))
    return file


def red(pixels: np.ndarray) -> np.ndarray:
    values = pixels.astype(int)
    return (values[..., 0] > 80) & (values[..., 1] < 40) & (values[..., 2] < 40)


def test_a_picture_shows_what_lies_at_its_centre(tmp_path: Path) -> None:
    with cw.World("empty") as world:
        world.spawn(ball(tmp_path, "red", "1 0 0 1"), x=3.0, y=1.0, z=0.5)
        taken = world.picture(200, 100, eye=(3.0, -9.0, 0.5), target=(3.0, 1.0, 0.5))
        rows, columns = np.nonzero(red(taken.pixels))
    # A ball of radius 0.5 m at 10 m subtends 2 asin(0.05); the picture's width is 0.9 rad.
    focal = 100 / np.tan(0.45)
    radius = focal * np.tan(np.arcsin(0.05))
    assert columns.mean() == pytest.approx(99.5, abs=1)
    assert rows.mean() == pytest.approx(49.5, abs=1)
    assert len(rows) == pytest.approx(np.pi * radius**2, rel=0.1)


def test_up_is_up_and_left_is_left(tmp_path: Path) -> None:
    with cw.World("empty") as world:
        world.spawn(ball(tmp_path, "red", "1 0 0 1"), x=10.0, y=2.0, z=2.5)
        ahead = red(world.picture(200, 200, eye=(0, 0, 0.5), target=(10, 0, 0.5)).pixels)
        below = red(world.picture(200, 200, eye=(10, 0, 20), target=(10, 0, 0)).pixels)
    rows, columns = np.nonzero(ahead)
    assert rows.mean() < 90 and columns.mean() < 90
    # From straight above, the y axis points up.
    rows, columns = np.nonzero(below)
    assert rows.mean() < 90 and columns.mean() == pytest.approx(99.5, abs=1)


@pytest.mark.parametrize("size", [(200, 100), (100, 200)])
def test_all_that_can_move_is_visible(tmp_path: Path, size: tuple[int, int]) -> None:
    with cw.World("empty") as world:
        for index, place in enumerate([(-2.0, 0.0), (2.0, 1.0), (0.0, 4.0)]):
            file = ball(tmp_path, f"ball_{index}", "1 0 0 1")
            world.spawn(file, x=place[0], y=place[1], z=0.5)
        world.spawn(ball(tmp_path, "far", "0 0 1 1", static=True), x=300.0)
        whole = red(world.picture(*size).pixels)
        assert not (whole[0].any() or whole[-1].any() or whole[:, 0].any() or whole[:, -1].any())
        # Each ball is more than a few pixels.
        assert whole.sum() > 60


def test_a_picture_changes_nothing(tmp_path: Path) -> None:
    def drive(*, pictures: bool) -> tuple[float, ...]:
        with cw.World("empty") as world:
            cart = world.spawn("rosbots.xacro")
            images = world.mailbox("/rosbots/camera1/image_raw", size=1)
            cart.publish("/part2_cmr/cmd_vel", linear_x=0.4, angular_z=0.3)
            for _ in range(4):
                world.run(0.25)
                if pictures:
                    world.picture(64, 48)
            data = images.get().data
            return (*cart.pose.position, *cart.pose.orientation, int(data.astype(int).sum()))

    assert drive(pictures=True) == drive(pictures=False)


def test_a_picture_is_displayed_and_saved(tmp_path: Path) -> None:
    from PIL import Image

    with cw.World("post") as world:
        taken = world.picture(64, 48)
    assert np.asarray(taken) is taken.pixels and taken.pixels.shape == (48, 64, 3)
    shown = np.asarray(Image.open(io.BytesIO(taken._repr_png_())))
    assert (shown == taken.pixels).all()
    taken.save(tmp_path / "world.png")
    assert (np.asarray(Image.open(tmp_path / "world.png")) == taken.pixels).all()


def test_sizes_and_points_are_checked() -> None:
    world = cw.World("empty")
    for options in (
        {"width": 0},
        {"height": 8193},
        {"width": 1.5},
        {"width": float("nan")},
        {"eye": (0, 0, float("inf"))},
        {"eye": (1, 1, 1), "target": (1, 1, 1)},
    ):
        with raises(NUMBER_OUT_OF_RANGE):
            world.picture(**options)
    world.close()
    with raises(SIMULATION_CLOSED):
        world.view()


def test_a_closed_world_is_shown_in_its_last_state() -> None:
    with cw.World("walls") as world:
        world.spawn("rosbots.xacro")
        before = world.picture(64, 48)
    assert (world.picture(64, 48).pixels == before.pixels).all()


def test_a_cell_shows_the_page_in_a_frame(tidy: None) -> None:
    with cw.World("empty") as world:
        page = world.view(port=0, width=800, height=300)
        shown = page._repr_html_()
        found = re.search(r'<iframe src="([^"]+)" width="800" height="300"', shown)
        assert found is not None and page.url in shown and repr(page) == page.url
        with urllib.request.urlopen(found[1], timeout=60) as response:
            assert "frame-ancestors" not in response.headers["Content-Security-Policy"]
        with urllib.request.urlopen(page.url, timeout=60) as response:
            assert "frame-ancestors 'self'" in response.headers["Content-Security-Policy"]
        # The same page again.
        assert world.view().url == page.url


def test_a_page_for_other_computers_is_only_linked(tidy: None) -> None:
    with cw.World("empty", host="0.0.0.0") as world:
        page = world.view(port=0)
        assert page.frame is None and "iframe" not in page._repr_html_()


def test_arrays_and_messages_become_pictures() -> None:
    grey = np.array([[0, 100], [200, 255]], dtype=np.uint8)
    assert (cw.Picture.of(grey).pixels == grey[..., None]).all()
    rgba = np.dstack([grey, grey // 2, grey // 4, grey * 0])
    assert (cw.Picture.of(rgba).pixels == rgba[..., :3]).all()
    depth = np.array([[1.0, 3.0], [np.inf, np.nan]], dtype=np.float32)
    assert cw.Picture.of(depth).pixels[..., 0].tolist() == [[0, 255], [0, 0]]
    assert not cw.Picture.of(np.full((2, 2), np.inf)).pixels.any()
    with cw.World("post") as world:
        world.spawn("rosbots.xacro")
        image = world.topic("/rosbots/camera1/image_raw").wait()
        assert (cw.Picture.of(image).pixels == cw.image(image)).all()
    for wrong in (np.zeros(3), np.zeros((2, 2, 2)), np.zeros((0, 3)), np.zeros((1, 2, 3, 4))):
        with raises(NUMBER_OUT_OF_RANGE):
            cw.Picture.of(wrong)


def test_a_shell_displays_image_messages() -> None:
    pytest.importorskip("IPython")
    from IPython.core.interactiveshell import InteractiveShell
    from PIL import Image

    # A shell replaces the main module, which processes that are spawned later read.
    main = sys.modules["__main__"]
    shell = InteractiveShell()
    try:
        shell.extension_manager.load_extension("cartwheel")
        with cw.World("post") as world:
            world.spawn("rosbots.xacro")
            message = world.topic("/rosbots/camera1/image_raw").wait()
            shown, _ = shell.display_formatter.format(message)
            plain, _ = shell.display_formatter.format(world.topic("/odom").wait())
        assert (np.asarray(Image.open(io.BytesIO(shown["image/png"]))) == cw.image(message)).all()
        assert "encoding='rgb8'" in shown["text/plain"] and len(shown["text/plain"]) < 1000
        assert list(plain) == ["text/plain"]
    finally:
        sys.modules["__main__"] = main
        # It would run again at exit, and find nothing.
        atexit.unregister(shell.atexit_operations)
        shell.atexit_operations()
