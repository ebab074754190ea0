"""The studio's page for everybody: keyboard only, wide and narrow, without its server, twice in one document.

The scene is that of `test_page`.
"""

import re
import signal

import numpy as np
import pytest

import refdof
from tests.studio.browser import LEFT, RIGHT, SIZE, Studio, served

pytestmark = pytest.mark.slow

CONTROLS = "[...document.querySelectorAll('.refdof-studio :is(canvas, button, select, input, textarea)')]"
NAME = "node.getAttribute('aria-label') ?? node.textContent"
VISIBLE = (
    CONTROLS
    + f""".filter((node) => node.checkVisibility()).map((node) => {{
    const box = node.getBoundingClientRect();
    return [{NAME}, box.left, box.right, box.width, box.height];
}})"""
)
NAMELESS = CONTROLS + f".filter((node) => !({NAME}).trim()).map((node) => node.outerHTML)"
CENTRE = (SIZE[0] // 2, SIZE[1] // 2)


def focused(studio):
    return studio.page.evaluate(
        "document.activeElement.getAttribute('aria-label') ?? document.activeElement.textContent"
    )


def test_keyboard_only(studio, cards):
    places, depth = cards
    page = studio.page
    seen = []
    for _ in range(60):
        page.keyboard.press("Tab")
        seen.append(focused(studio))
        outline = page.evaluate("getComputedStyle(document.activeElement).outlineWidth")
        assert outline == "3px" or seen[-1] in ("", "refdof studio"), seen[-1]
        if len(seen) > 5 and seen[-1] == seen[0]:
            break
    for name in ("Keys and mouse", "Method", "Lens", "f-number", "Focus, slider", "Play", "Open", "Save PNG"):
        assert any(name in text for text in seen), (name, seen)
    page.locator("canvas.picture").focus()
    page.keyboard.press("ArrowRight")
    assert page.locator(".crosshair").is_visible()
    step = round(0.02 * SIZE[1])
    for key, count in (
        ("ArrowLeft", round((CENTRE[0] - places[LEFT][0]) / step) + 1),
        ("ArrowUp", round((CENTRE[1] - places[LEFT][1]) / step)),
    ):
        for _ in range(count):
            page.keyboard.press(key)
    with studio.changed():
        page.keyboard.press("Enter")
    assert float(studio.value("Focus")) == pytest.approx(depth[LEFT], rel=0.02)  # within a step of the middle
    for _ in range(round((places[RIGHT][0] - places[LEFT][0]) / step)):
        page.keyboard.press("ArrowRight")
    for _ in range(round((places[LEFT][1] - places[RIGHT][1]) / step)):
        page.keyboard.press("ArrowUp")
    with studio.changed():
        page.keyboard.press("Shift+Enter")
    assert page.locator(".marker").count() == 2
    with studio.changed():
        page.keyboard.press("Delete")
    assert page.locator(".marker").count() == 1
    with studio.changed():
        page.keyboard.press("]")
    assert studio.value("Frame") == "1"
    with studio.changed():
        page.keyboard.press("1")
    assert studio.value("Show") == "coc"
    assert page.locator(".legend .bar").is_visible()
    with studio.changed():
        page.keyboard.press("0")
    page.keyboard.press("?")
    assert page.locator("dialog").is_visible()
    page.keyboard.press("Escape")
    assert not page.locator("dialog").is_visible()


MOVES = {  # where the marker of the left card goes, which is nearer than the target: signs of x and y, 0 is either
    "Shift+ArrowLeft": (-1, 0),
    "Shift+ArrowDown": (0, 1),
    "+": (-1, 0),
    "-": (1, 0),
    "wheel": (-1, 0),
    "pinch": (-1, 0),
    "right drag": (1, 1),
    "alt drag": (1, 1),
    "middle drag": (1, 1),
}


@pytest.mark.parametrize("press", MOVES)
def test_the_camera_moves_and_is_reset(shared, cards, press):
    studio, page, places = shared, shared.page, cards[0]
    if page.locator(".marker").count() == 0:
        studio.click(places[LEFT])
    before, start = studio.pixels(), np.array(studio.marker(1))
    x, y = studio.on_screen(CENTRE)
    with studio.changed():
        if press == "wheel":
            page.mouse.move(x, y)
            page.mouse.wheel(0, -100)
        elif press == "pinch":
            pinch(page, x, y)
        elif press.endswith("drag"):
            drag(page, press.split()[0], x, y)
        else:
            page.locator("canvas.picture").focus()
            page.keyboard.press(press)
    page.wait_for_timeout(400)  # small moves ask for the fine picture once they rest
    studio.settled()
    moved = studio.pixels()
    assert (moved != before).any(axis=2).mean() > 0.02  # of the pixels; the cards are an eighth of them
    way = np.array(studio.marker(1)) - start
    for axis, sign in enumerate(MOVES[press]):
        assert sign * way[axis] >= abs(sign)  # at least a pixel of the screen
    with studio.changed():
        studio.button("Reset view").click()
    np.testing.assert_array_equal(studio.pixels(), before)


def test_a_drag_moves_what_is_at_the_targets_distance_with_the_mouse(shared, cards, folder):
    studio, (places, depth) = shared, cards
    if studio.page.locator(".marker").count() == 0:
        studio.click(places[LEFT])
    camera = refdof.load_scene(folder / "cards.ply").camera
    nearer = np.linalg.norm(np.subtract(camera.eye, camera.target)) / depth[LEFT]
    start = np.array(studio.marker(1))
    with studio.changed():
        drag(studio.page, "middle", *studio.on_screen(CENTRE))
    np.testing.assert_allclose(np.array(studio.marker(1)) - start, nearer * np.array([40.0, 10.0]), rtol=0.02)
    with studio.changed():
        studio.button("Reset view").click()


def drag(page, what, x, y):
    """40 pixels to the right and 10 down."""
    if what == "alt":
        page.keyboard.down("Alt")
    page.mouse.move(x, y)
    page.mouse.down(button="left" if what == "alt" else what)
    page.mouse.move(x + 40, y + 10, steps=3)
    page.mouse.up(button="left" if what == "alt" else what)
    page.keyboard.up("Alt")


def pinch(page, x, y):
    """Two fingers go apart."""
    touch = page.context.new_cdp_session(page)
    for kind, apart in (("touchStart", 100), ("touchMove", 107), ("touchMove", 115), ("touchEnd", None)):
        points = [] if apart is None else [{"x": x - apart, "y": y, "id": 0}, {"x": x + apart, "y": y, "id": 1}]
        touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})


@pytest.mark.parametrize("width", [1280, 800, 390])
def test_all_controls_fit(open_page, cards, width):
    studio = open_page(width=width, height=844)
    studio.click(cards[0][LEFT])
    studio.click(cards[0][RIGHT], shift=True)
    studio.button("Add key").click()
    studio.button("Copy command").click()
    studio.until("document.querySelector('.command').value !== ''")
    assert studio.page.evaluate("document.documentElement.scrollWidth") <= width
    boxes = studio.page.evaluate(VISIBLE)
    assert len(boxes) > 30
    for name, left, right, wide, high in boxes:
        assert left >= 0, name
        assert right <= width, name
        assert min(wide, high) >= (10 if "key at frame" in name else 16), name
    assert studio.page.evaluate(NAMELESS) == []


def test_a_server_that_is_gone_is_said_in_words(browser, folder, cards):
    with served(folder, "cards.ply") as (address, process):
        context = browser.new_context()
        studio = Studio(context.new_page(), address)
        before = studio.pixels()
        process.send_signal(signal.SIGINT)
        process.wait(timeout=30)
    status = studio.page.locator(".status")
    studio.until("document.querySelector('.view').dataset.online === 'false'")
    assert status.inner_text().startswith("The server is gone.")
    studio.page.mouse.click(*studio.on_screen(cards[0][LEFT]))
    studio.page.get_by_label("f-number", exact=True).fill("3")
    studio.page.keyboard.press("Enter")
    studio.button("Save PNG").click()
    studio.page.wait_for_timeout(2500)  # a try to reach it lies in between
    assert float(studio.value("f-number")) == 3.0
    np.testing.assert_array_equal(studio.pixels(), before)
    assert [fault for fault in studio.faults if not re.search("WebSocket|ERR_CONNECTION", fault)] == []
    context.close()


def test_a_lost_connection_is_made_anew_with_the_pages_state(browser, url, cards):
    context = browser.new_context()
    page = context.new_page()
    sockets = []

    def between(socket):
        socket.connect_to_server()
        sockets.append(socket)

    page.route_web_socket(re.compile("/socket"), between)
    studio = Studio(page, url)
    studio.click(cards[0][LEFT])
    sockets[0].close()
    studio.until("document.querySelector('.view').dataset.online === 'false'")
    studio.page.get_by_label("f-number", exact=True).fill("1")
    studio.page.keyboard.press("Enter")
    studio.until("document.querySelector('.view').dataset.online === 'true'")
    studio.settled()
    assert len(sockets) == 2
    assert float(studio.value("f-number")) == 1.0
    assert page.locator(".marker").count() == 1
    assert studio.faults == []
    context.close()


def test_two_views_in_one_document_and_one_goes(studio, cards):
    """As in a notebook: no names clash, and nothing of a view is left when it is taken away."""
    counts = studio.page.evaluate("""async () => {
        const {default: view} = await import('./studio.js' + location.search);
        const values = {scene: window.scene, state: null}, listeners = new Map();
        const model = {
            get: (name) => values[name], set: (name, value) => { values[name] = value; }, save_changes() {}, send() {},
            on: (event, act) => listeners.set(event, new Set([...(listeners.get(event) ?? []), act])),
            off: (event, act) => listeners.get(event).delete(act),
        };
        const before = Object.keys(window).length, place = document.body.appendChild(document.createElement('div'));
        const stop = view.render({model, el: place});
        const views = document.querySelectorAll('.refdof-studio').length;
        const ids = [...document.querySelectorAll('[id]')].map((node) => node.id);
        stop();
        return {views, ids, left: place.childElementCount, globals: Object.keys(window).length - before,
                listeners: [...listeners.values()].reduce((sum, acts) => sum + acts.size, 0)};
    }""")
    assert counts == {"views": 2, "ids": ["studio"], "left": 0, "globals": 0, "listeners": 0}
    studio.click(cards[0][LEFT])
    assert studio.page.locator(".marker").count() == 1
