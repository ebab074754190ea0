"""The studio's page in headless Chromium: every control does what it says, by mouse and by keyboard.

The scene is three checkered cards at different distances: what is sharp is measured in the pixels of the canvas.
REFDOF_REQUIRE_CHROMIUM=1 makes a missing browser a failure.
"""

import re

import numpy as np
import pytest

import refdof
from refdof.focus.focus_file import load_focus
from refdof.focus.focus_lens import Focus
from refdof.focus.point import FocusPoint
from refdof.image.display import to_8_bit
from tests.studio.browser import HOSTILE, LEFT, MIDDLE, RIGHT, SIZE

pytestmark = pytest.mark.slow


def test_the_fine_picture_replaces_the_coarse_one_and_is_the_methods(open_page, folder):
    """A display's levels are equal: 64 samples are what `Copy command` says, too."""
    studio = open_page()
    steps = studio.page.evaluate("""() => new Promise((done) => {
        const view = document.querySelector('.view'), seen = [];
        new MutationObserver(() => {
            seen.push([view.dataset.step, document.querySelector('.status').textContent]);
            if (view.dataset.step === 'fine') done(seen);
        }).observe(view, {attributeFilter: ['data-step']});
        [...document.querySelectorAll('button')].find((node) => node.textContent === 'Reset view').click();
    })""")
    assert [step for step, _ in steps] == ["coarse", "fine"]
    scene = refdof.load_scene(folder / "cards.ply")
    image = refdof.render("lensblur", scene, scene.camera.with_size(SIZE), scene.lens, samples=64).image
    shown = studio.pixels()
    np.testing.assert_array_equal(shown[..., :3], to_8_bit(image))
    assert np.ptp(shown[..., 1]) > 150  # not blank: the middle card's checks, which are sharp, are black and white
    status = studio.page.locator(".status").inner_text()
    assert re.fullmatch("lensblur \u00b7 320 \u00d7 240 \u00b7 [0-9.]+ m?s", status)


def test_a_click_makes_its_object_sharp_beside_its_neighbours(studio, cards):
    places, depth = cards
    studio.click(places[LEFT])
    left = studio.sharpness(places)
    assert float(studio.value("Focus")) == pytest.approx(depth[LEFT], rel=0.02)  # the pixel is not quite the middle
    assert re.search(
        r"x \d+, y \d+ · depth [\d.]+$", studio.page.inner_text(".readout")
    )  # its circle was another lens's
    studio.click(places[RIGHT])
    right = studio.sharpness(places)
    # A check is some 6 px wide, and circles are wider: less than half of the contrast is a quarter of the energy.
    assert left[LEFT] > 3.0 * right[LEFT]
    assert right[RIGHT] > 3.0 * left[RIGHT]


def test_the_background_is_focused_at_infinity(studio):
    studio.click((SIZE[0] - 4, 4))
    assert studio.value("Focus") == ""
    assert studio.page.get_by_label("Focus", exact=True).get_attribute("placeholder") == "\u221e"


def test_shift_click_adds_points(studio, cards):
    places, _ = cards
    studio.click(places[LEFT])
    alone = studio.sharpness(places)
    assert studio.page.locator(".marker").count() == 1
    studio.click(places[RIGHT], shift=True)
    assert studio.page.locator(".marker").count() == 2
    assert studio.page.get_by_role("combobox", name="Lens", exact=True).input_value() == "surface"
    both = studio.sharpness(places)
    assert both[RIGHT] > 3.0 * alone[RIGHT]
    assert both[LEFT] > 0.7 * alone[LEFT]  # still sharp, but that the surface leans a little
    np.testing.assert_allclose(studio.marker(2), studio.on_screen(places[RIGHT]), atol=4.0)  # a pixel is 2.6 here
    with studio.changed():
        studio.button("Delete point").click()
    assert studio.page.locator(".marker").count() == 1


def test_a_marker_is_dragged(studio, cards):
    places, depth = cards
    studio.click(places[LEFT])
    before = studio.sharpness(places)
    with studio.changed():
        studio.page.mouse.move(*studio.marker(1))
        studio.page.mouse.down()
        for share in (0.3, 0.7, 1.0):
            studio.page.mouse.move(*studio.on_screen(places[LEFT] + share * (places[RIGHT] - places[LEFT])))
        studio.until("document.querySelector('.view').dataset.step === 'coarse'")  # no fine picture while it moves
        studio.page.mouse.up()
    studio.page.wait_for_timeout(300)  # the pick of the release comes after those of the way
    studio.settled()
    np.testing.assert_allclose(studio.marker(1), studio.on_screen(places[RIGHT]), atol=4.0)  # a pixel is 2.6 here
    after = studio.sharpness(places)
    assert after[RIGHT] > 3.0 * before[RIGHT]
    assert before[LEFT] > 3.0 * after[LEFT]
    assert float(studio.value("Focus")) == pytest.approx(depth[RIGHT], rel=0.02)


@pytest.mark.parametrize("kind", ["plane", "distance", "surface", "file", "thin"])
def test_every_kind_of_lens_gives_a_picture(shared, kind):
    lens = shared.page.get_by_role("combobox", name="Lens", exact=True)
    if lens.input_value() == kind:  # it is chosen at the start
        kind = "distance"
    with shared.changed():
        lens.select_option(kind)
    assert lens.input_value() == kind
    assert shared.page.locator("[role=alert]").inner_text() == ""
    assert np.ptp(shared.pixels()[..., 1]) > 60  # checks, if not sharp ones
    followed = kind in ("plane", "distance", "surface")
    assert shared.page.get_by_label("Focus", exact=True).is_disabled() == followed
    assert shared.page.get_by_role("combobox", name="File", exact=True).is_visible() == (kind == "file")


def test_what_is_under_the_resting_mouse_is_told(shared, cards):
    places, depth = cards
    shared.page.mouse.move(*shared.on_screen((4, 4)))
    shared.until("document.querySelector('.readout').textContent.includes('background')")
    shared.page.mouse.move(*shared.on_screen(places[MIDDLE]))
    shared.until("document.querySelector('.readout').textContent.includes('depth')")
    told = re.search(r"depth ([0-9.]+) . circle of confusion ([0-9.]+) px", shared.page.inner_text(".readout"))
    assert float(told[1]) == pytest.approx(depth[MIDDLE], rel=0.02)  # the pixel is not quite the middle


def radius_told(studio):
    return float(studio.page.get_by_text(re.compile("radius")).inner_text().split()[1])


def test_f_number_and_focus_by_slider(studio, cards):
    places, depth = cards
    studio.fill("Focus", depth[RIGHT] * 0.9)
    narrow = studio.sharpness(places)
    slider = studio.page.get_by_label("f-number, slider")
    number, radius = float(studio.value("f-number")), radius_told(studio)
    with studio.changed():
        slider.fill("0")
    assert float(studio.value("f-number")) == pytest.approx(number / 4, rel=1e-3)  # four digits are shown
    assert radius_told(studio) == pytest.approx(4.0 * radius, rel=1e-2)  # as many digits
    wide = studio.sharpness(places)
    assert wide[RIGHT] < 0.5 * narrow[RIGHT]
    focus = studio.page.get_by_label("Focus, slider")
    with studio.changed():
        focus.press("End")
    assert studio.value("Focus") == ""
    with studio.changed():
        focus.press("Home")
    near = float(studio.value("Focus"))
    assert near < depth[LEFT]  # the nearest surface of all
    studio.fill("Focus", depth[RIGHT])
    assert studio.sharpness(places)[RIGHT] > 3.0 * wide[RIGHT]
    assert 0 < int(focus.input_value()) < 990


def test_keyframes_are_drawn_interpolated_and_played(studio, cards):
    places, _ = cards
    studio.click(places[LEFT])
    keys = {0: 1.0, 10: 0.7, 24: 0.1}  # a slope in the middle, none at the ends
    with studio.changed():
        studio.button("Set a key of blur at frame 0").click()
    for frame in (10, 24):
        studio.fill("Frame", frame)
        studio.fill("Blur", keys[frame])
    marks = studio.page.locator(".track button")
    assert [marks.nth(k).get_attribute("aria-label") for k in range(marks.count())] == [
        f"Blur: key at frame {frame}" for frame in keys
    ]
    point = FocusPoint(0, (1.0, 0.0, 0.0), aperture=list(keys.items()))
    for frame in (5, 17, 30):
        studio.fill("Frame", frame)
        assert float(studio.value("Blur")) == pytest.approx(point.value("aperture", frame), rel=5e-4)  # four digits
    studio.fill("Frame", 10)
    with studio.changed():
        studio.button("Remove key").click()
    assert marks.count() == 2
    with studio.changed():
        studio.button("Add key").click()  # of all three
    assert marks.count() == 5
    studio.button("Play").click()
    studio.until("Number(document.querySelector('[aria-label=\"Frame\"]').value) > 13")
    with studio.changed():
        studio.button("Pause").click()
    stopped = studio.value("Frame")
    studio.page.wait_for_timeout(300)
    assert studio.value("Frame") == stopped


def test_points_are_saved_and_opened_again(studio, cards, folder):
    places, _ = cards
    studio.click(places[LEFT])
    studio.click(places[RIGHT], shift=True)
    with studio.changed():
        studio.page.get_by_label("Name").first.fill("<b>right</b>")
        studio.page.keyboard.press("Enter")
    studio.fill("Offset", 0.125)
    files = studio.page.get_by_role("region", name="Files")
    files.get_by_label("Name").fill("mine")
    studio.button("Save focus.toml").click()
    files.get_by_text("Saved mine.toml.").wait_for()
    saved = load_focus(folder / "mine.toml")
    assert isinstance(saved, Focus)
    assert [(point.name, point.offset) for point in saved.points] == [("", 0.0), ("<b>right</b>", 0.125)]
    studio.button("Copy command").click()
    studio.until("document.querySelector('.command').value.startsWith('refdof ')")
    assert "cards.ply" in studio.value("Command line")
    for name in ("Save PNG", "Save EXR"):
        studio.button(name).click()
        files.get_by_text(f"Saved mine.{name[-3:].lower()}.").wait_for()
        assert (folder / f"mine.{name[-3:].lower()}").stat().st_size > 1000
    before = [studio.marker(k) for k in (1, 2)]
    with studio.changed():
        studio.button("Delete point").click()
    with studio.changed():
        files.get_by_label("Scene, lens or focus file").select_option("mine.toml")
        studio.button("Open").click()
        files.get_by_text("Opened mine.toml.").wait_for()
    assert studio.page.locator(".marker").count() == 2
    np.testing.assert_allclose([studio.marker(k) for k in (1, 2)], before, atol=0.1)  # of a pixel: rounding of boxes
    assert studio.page.locator(".points button").nth(1).inner_text() == "2 <b>right</b>"


def test_meshes_are_opened_and_dropped_and_names_are_text(studio, folder):
    files = studio.page.get_by_role("region", name="Files")
    with studio.changed():
        files.get_by_label("Scene, lens or focus file").select_option(HOSTILE)
        studio.button("Open").click()
        files.get_by_text("Opened").wait_for()
    assert studio.page.locator("h2").inner_text() == HOSTILE
    with studio.changed():
        transfer = studio.page.evaluate_handle(
            "(text) => {const data = new DataTransfer(); data.items.add(new File([text], 'thing.ply')); return data;}",
            (folder / "cards.ply").read_text(),
        )
        studio.page.dispatch_event(".refdof-studio", "drop", {"dataTransfer": transfer})
        files.get_by_text(re.compile(r"Opened .*thing.*\.ply")).wait_for()
    with studio.changed():
        files.locator("input[type=file]").set_input_files(folder / "cards.ply")
        files.get_by_text(re.compile(r"Opened .*cards.*\.ply")).wait_for()
    assert studio.page.locator("img, script:not([src])").count() == 0
    assert studio.page.title() == "refdof studio"


def test_faults_are_one_line_of_words(studio, cards):
    studio.click(cards[0][LEFT])
    studio.page.get_by_label("Name").last.fill("../up")
    studio.button("Save PNG").click()
    alert = studio.page.locator("[role=alert]")
    studio.until("document.querySelector('[role=alert]').textContent !== ''")
    assert re.match(r"name: got .*; allowed", alert.inner_text())
    with studio.changed():
        studio.page.get_by_label("Method").select_option("scatter")
    assert alert.inner_text() == ""
    assert studio.page.locator(".status").inner_text().startswith("scatter")


def test_two_pages_do_not_disturb_each_other(open_page, cards):
    places, _ = cards
    one, other = open_page(), open_page(width=390, height=844)
    before = other.pixels()
    one.click(places[LEFT])
    with one.changed():
        one.page.get_by_label("Show").select_option("depth")
    assert other.page.locator(".marker").count() == 0
    np.testing.assert_array_equal(other.pixels(), before)
    other.click(places[RIGHT])
    assert one.page.locator(".legend").is_visible()
    assert one.value("Show") == "depth"
    np.testing.assert_allclose(one.marker(1), one.on_screen(places[LEFT]), atol=4.0)  # a pixel is 2.6 here
