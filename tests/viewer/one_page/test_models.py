"""Inserting, moving and deleting models in a real browser."""

import pytest
from tests.viewer.conftest import CART, eventually, row, world_panel, write

from cartwheel.codes.recording import UPLOAD_REFUSED
from cartwheel.codes.tags import VALUE_INVALID
from cartwheel.viewer.uploads import MOST_BYTES


@pytest.fixture(autouse=True)
def world_tab(page):
    yield
    page.get_by_text("World", exact=True).click()


def insert_tab(page):
    page.get_by_text("Insert", exact=True).click()


def test_the_palette_puts_a_barrel_in_front_of_the_cart(page, arena):
    insert_tab(page)
    row(page, "barrel").click()
    eventually(lambda: "barrel" in arena.models(), what="the barrel")
    pose = arena.pose("barrel")
    assert pose.x > 0.5
    assert ((pose.x - 2.4) ** 2 + pose.y**2) ** 0.5 > 0.4, "not in the post"
    page.get_by_text("World", exact=True).click()
    row(page, "barrel").wait_for()


def test_twice_the_same_gets_two_names(page, arena):
    insert_tab(page)
    row(page, "box small").click()
    eventually(lambda: len(arena.models()) == 4, what="the first")
    row(page, "box small").click()
    names = eventually(lambda: len(m := arena.models()) == 5 and m, what="the second")
    assert len({arena.pose(name).position for name in names}) == 5


BALL = """<robot name="ball"><link name="ball">
  <inertial><mass value="1"/>
    <inertia ixx=".01" iyy=".01" izz=".01" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><geometry><sphere radius="0.1"/></geometry></collision>
</link></robot>"""


def upload(page, path):
    insert_tab(page)
    with page.expect_file_chooser() as chooser:
        page.get_by_role("button", name="Open a file").click()
    chooser.value.set_files(path)


def test_after_a_file_that_is_too_large_the_next_one_can_be_opened(page, arena, tmp_path):
    large = tmp_path / "large.urdf"
    large.write_bytes(bytes(MOST_BYTES + 1))
    upload(page, large)
    page.get_by_text(f"Error {UPLOAD_REFUSED.number}").wait_for()
    page.get_by_text("Uploading large.urdf").wait_for(state="hidden")
    upload(page, write(tmp_path, "ball.urdf", BALL))
    eventually(lambda: "ball" in arena.models(), what="the ball")


def test_a_file_of_ones_own(page, arena, tmp_path):
    upload(page, write(tmp_path, "ball.urdf", BALL))
    eventually(lambda: "ball" in arena.models(), what="the ball")
    assert arena.pose("ball").z == pytest.approx(0.1, abs=0.01)


def test_a_broken_file_is_explained_and_disturbs_nothing(page, arena, tmp_path):
    before = arena.ask(lambda: arena.simulation.time_ns)
    text = BALL.replace('radius="0.1"', 'radius="big"')
    upload(page, write(tmp_path, "broken.urdf", text))
    note = page.locator(".mantine-Notification-root", has_text="broken.urdf:4")
    note.first.wait_for()
    assert f"Error {VALUE_INVALID.number}" in note.first.inner_text()
    assert "/tmp" not in note.first.inner_text()
    assert set(arena.models()) == {"ground_plane", "post", CART}
    eventually(lambda: arena.ask(lambda: arena.simulation.time_ns) > before + 10**8, what="time")


def test_the_scene_goes_on_as_the_gizmo_is_let_go(page, arena):
    """Moving a fixed thing builds the world anew and keeps what moves."""
    world = world_panel(arena)
    yaw = arena.pose().yaw
    arena.viewer._page.post(
        lambda: world.move("post", arena.viewer._desk.stage.scene.pose("post").__matmul__(_ahead()))
    )
    eventually(lambda: arena.pose("post").x > 2.8, what="the post half a metre further")
    assert arena.pose().yaw == pytest.approx(yaw, abs=0.01)


def _ahead():
    from cartwheel.geometry import Pose

    return Pose((0.5, 0.0, 0.0))


def test_deleting_the_selected_model(page, arena):
    insert_tab(page)
    row(page, "traffic cone").click()
    name = eventually(lambda: set(arena.models()) - {"ground_plane", "post", CART}, what="it")
    (name,) = name
    page.get_by_text("World", exact=True).click()
    row(page, name).click()
    page.get_by_role("button", name=f"Delete {name}").click()
    eventually(lambda: name not in arena.models(), what="its end")
    row(page, name).wait_for(state="detached")
