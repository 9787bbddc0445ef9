"""The scene in a real browser: what is drawn, and what a click in it meets."""

import math

import pytest
from tests.viewer.conftest import (
    CART,
    RIGHT,
    close_notes,
    count,
    eventually,
    open_page,
    opened_page,
    project,
    row,
    screenshot,
    stage,
    world_panel,
)

from cartwheel.geometry import Pose

RED, BLUE = 0, 2


@pytest.fixture(scope="module")
def shared_page(browser, arena):
    with opened_page(browser, arena, drawn=True) as page:
        yield page


@pytest.fixture(autouse=True, scope="module")
def no_pyramid(shared_page, arena):
    """The camera's pyramid is blue, and has the post's red in it."""
    hide_frustum(shared_page)


def hide_frustum(page):
    """Uncovers what stands behind the camera's pyramid; each browser has its own toggles."""
    page.get_by_text("View", exact=True).click()
    page.get_by_label("Camera frustum").click()
    page.get_by_text("World", exact=True).click()


def colours(page):
    picture = stage(screenshot(page))
    return count(picture, RED), count(picture, BLUE)


def test_the_cart_is_blue_and_the_post_red(page):
    assert page.title() == "Cartwheel"
    close_notes(page)
    page.get_by_text("View", exact=True).click()
    red, _ = eventually(lambda: min(c := colours(page)) > 400 and c, what="red and blue")
    # It is the visuals that are seen: without them nothing of either colour is left.
    page.get_by_label("Visual shapes").click()
    eventually(lambda: max(colours(page)) < 20, what="the empty scene")
    page.get_by_label("Visual shapes").click()
    eventually(lambda: abs(colours(page)[0] - red) < 0.2 * red, what="the post")
    page.get_by_text("World", exact=True).click()


def test_the_post_is_drawn_where_it_stands(page, arena):
    """Every corner of the picture's red lies where the eight corners of the post project to."""
    close_notes(page)
    box = page.locator("canvas[data-engine]").bounding_box()
    post = arena.pose("post")
    corners = [
        project(arena.camera(), (post.x + x, post.y + y, post.z + z), box)
        for x in (-0.1, 0.1)
        for y in (-0.1, 0.1)
        for z in (0.0, 1.0)
    ]

    def is_there():
        picture = screenshot(page)
        red = picture[:, :, RED]
        is_red = (red > 90) & (red > 2.2 * picture[:, :, 1:].max(axis=2))
        # The cart's lights are red as well, further to the left.
        is_red[:, : int(min(x for x, _ in corners)) - 30] = is_red[:, RIGHT:] = False
        rows, columns = is_red.nonzero()
        return (
            rows.size > 0
            and abs(columns.min() - min(x for x, _ in corners)) < 6
            and abs(columns.max() - max(x for x, _ in corners)) < 6
            and abs(rows.min() - min(y for _, y in corners)) < 6
        )

    eventually(is_there, what="the post at its place")


def test_links_follow_the_simulation(page, arena):
    before = eventually(lambda: colours(page)[0], what="the post")
    arena.ask(lambda: arena.simulation.set_pose("post", Pose((0.0, 60.0, 0.0))))
    eventually(lambda: colours(page)[0] < 0.1 * before, what="the post to leave the picture")


def point_at(page, place):
    """Moves the mouse, and gives the page two pictures to see what is under it."""
    page.mouse.move(*place)
    page.evaluate(
        "() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))"
    )


def test_a_click_in_the_scene_selects(page, arena):
    close_notes(page)
    box = page.locator("canvas[data-engine]").bounding_box()
    post = arena.pose("post")
    point_at(page, project(arena.camera(), (post.x, post.y, 0.6), box))
    page.mouse.down()
    page.mouse.up()
    page.locator("[data-model='post']").wait_for()
    assert "10 kg" in page.locator("[data-model='post']").inner_text()
    row(page, "post").click()
    page.locator("[data-model='post']").wait_for(state="detached")


def test_the_gizmo_lifts_the_post_and_holds_it_until_let_go(page, arena):
    close_notes(page)
    row(page, "post").click()
    page.locator("[data-model='post']").wait_for()
    gizmo = world_panel(arena)._gizmo
    box = page.locator("canvas[data-engine]").bounding_box()
    post = arena.pose("post")
    at = lambda z: project(arena.camera(), (post.x, post.y, post.z + z), box)  # noqa: E731
    tip = 0.85 * gizmo.scale  # where the head of the arrow is thickest
    point_at(page, at(tip))
    page.mouse.down()
    for i in range(1, 9):
        point_at(page, at(tip + 0.05 * i))
    eventually(lambda: arena.pose("post").z > 0.3, what="the post in the air")
    # 0.4 m would be fallen through in 0.29 s.
    start = arena.ask(lambda: arena.simulation.time_ns)
    eventually(lambda: arena.ask(lambda: arena.simulation.time_ns) > start + 5 * 10**8)
    assert arena.pose("post").z > 0.25
    page.mouse.up()
    eventually(lambda: arena.pose("post").z < 0.05, what="the fall")
    row(page, "post").click()


def test_two_browsers_see_the_same(browser, arena, page):
    second = open_page(browser, arena, drawn=True)
    close_notes(page)
    close_notes(second)
    hide_frustum(second)
    arena.ask(arena.simulation.pause)
    arena.ask(lambda: arena.simulation.set_pose("post", Pose((1.6, 0.4, 0.0))))
    for one in (page, second):
        one.locator(".cw-paused").wait_for()

    def same():
        # The edges differ: each browser draws at the resolution that it is fast enough for.
        red, other = colours(page)[0], colours(second)[0]
        return red > 400 and math.isclose(red, other, rel_tol=0.08) and red

    red = eventually(same, what="the same post in both")
    # What one does, the other sees.
    second.get_by_role("button", name="post", exact=True).click()
    second.get_by_role("button", name="Delete post").click()
    for one in (page, second):
        one.get_by_role("button", name="post", exact=True).wait_for(state="detached")
        eventually(lambda one=one: colours(one)[0] < 0.1 * red, what="the post to go")
    second.close()
    assert set(arena.models()) == {"ground_plane", CART}


def test_toggles_outlive_a_reload(page):
    def toggle():
        page.get_by_text("View", exact=True).click()
        return page.get_by_label("Link names")

    toggle().click()
    kept = "document.cookie.includes('names')"
    eventually(lambda: page.evaluate(kept), what="the cookie")
    page.reload()
    page.locator("[data-key='i']").wait_for()
    eventually(lambda: toggle().is_checked(), what="the toggle")
    toggle().click()
    eventually(lambda: not page.evaluate(kept), what="the cookie")
