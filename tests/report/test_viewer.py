"""The viewer of a report in headless Chromium: keys, read-out, maps, histogram, profile, each beside the arrays.

The page holds float16: `half` is what it can know. REFDOF_REQUIRE_CHROMIUM=1 makes a missing browser a failure.
"""

import re

import numpy as np
import pytest

from refdof.image.display import to_8_bit
from tests.report.known import (
    FIRST,
    GIVEN,
    HEIGHT,
    IMAGES,
    INF_AT,
    METHODS,
    NAN_AT,
    PAGE,
    SIZE,
    SPOILT,
    WIDTH,
    half,
    luminance,
    relative,
    signed,
)

pytestmark = pytest.mark.slow

CORNERS = ((0, 0), (WIDTH - 1, 0), (0, HEIGHT - 1), (WIDTH - 1, HEIGHT - 1), (17, 4))
ANCHORS = np.array([[120, 230, 255], [30, 110, 230], [0, 0, 0], [230, 90, 20], [255, 225, 120]])  # of signed maps


@pytest.fixture
def viewer(open_report):
    return open_report(PAGE, SIZE)


def assert_shown(viewer, image, stops=0.0):
    """One level at most is another: the page rounds in another precision."""
    assert np.abs(viewer.stage() - to_8_bit(half(image) * 2.0**stops)).max() <= 1


def colors_of(values, most):
    """A signed map's colours: anchors at equal distances, 511 levels."""
    t = np.round((np.clip(values / most, -1, 1) + 1) / 2 * 510) / 510
    return np.stack([np.interp(t, np.linspace(0, 1, 5), ANCHORS[:, c]) for c in range(3)], axis=-1)


def test_nothing_is_decoded_before_it_is_shown(viewer):
    """Two shown pictures are two decoded planes; texts of decoded ones leave the page."""
    count = "document.querySelectorAll('script[id^=plane-]').length"
    total = 2 + 2 * len(METHODS) + 1 + 3
    assert viewer.page.evaluate(count) == total - 1
    viewer.press("3", FIRST + 2)
    assert viewer.page.evaluate(count) == total - 2


def test_keys_flip_in_place(viewer):
    for key, image in {"p": 1, "1": FIRST, "r": 0, "9": FIRST + 8, "0": FIRST + 9}.items():
        viewer.press(key, image)
        assert_shown(viewer, IMAGES[image])
        pressed = viewer.page.locator("#images [aria-pressed=true]")
        assert pressed.count() == 1
        assert pressed.inner_text().split("\n")[-1].endswith(["reference", "pinhole", *METHODS][image])


def test_arrows_and_the_list_reach_all(viewer):
    viewer.press("0 ArrowRight ArrowRight", FIRST + 11)
    assert_shown(viewer, IMAGES[FIRST + 11])
    viewer.press("ArrowRight s", FIRST + 12)
    assert_shown(viewer, GIVEN.standard_error)
    viewer.press("r ArrowLeft", FIRST + 15)
    assert "layers" in viewer.text("#legend-words")
    viewer.page.get_by_label("Image", exact=True).evaluate(
        "(list) => { list.value = 1; list.dispatchEvent(new Event('change')); }"
    )
    viewer.shows(1)


def test_exposure_is_on_linear_values(viewer):
    viewer.press("p e e e", 1, "", -1.5)
    assert_shown(viewer, GIVEN.pinhole, -1.5)
    viewer.press("E E E E", 1, "", 0.5)
    assert_shown(viewer, GIVEN.pinhole, 0.5)
    slider = viewer.page.get_by_label("Exposure")
    slider.fill("-2.5")
    viewer.shows(1, "", -2.5)
    assert_shown(viewer, GIVEN.pinhole, -2.5)
    slider.press("ArrowRight")  # the slider keeps its arrows
    viewer.shows(1, "", -2)
    assert viewer.text("#stops") == "-2 stops"
    slider.press("3")  # and leaves other keys
    viewer.shows(FIRST + 2, "", -2)


@pytest.mark.parametrize(("presses", "mode", "most"), [("d", "signed", 0.25), ("d d", "relative", 1.0)])
def test_d_shows_errors_in_a_stated_range(viewer, presses, mode, most):
    viewer.press(f"4 {presses}", FIRST + 3, mode)
    error = {"signed": signed, "relative": relative}[mode](IMAGES[FIRST + 3], GIVEN.reference)
    # Half a level of 511, where the colours are steepest, and rounding.
    np.testing.assert_allclose(viewer.stage(), colors_of(error, most), atol=1.6)
    assert viewer.text("#legend-words").endswith(f"luminance: -{most:g} to {most:g}")
    viewer.press("E E", FIRST + 3, mode, 1)
    np.testing.assert_allclose(viewer.stage(), colors_of(error, most / 2), atol=1.6)
    assert viewer.text("#legend-words").endswith(f"luminance: -{most / 2:g} to {most / 2:g}")
    viewer.press("r", 0, mode, 1)
    assert_shown(viewer, GIVEN.reference, 1.0)  # which has no error


def test_d_ends_where_it_began_and_f_shows_flip(viewer):
    viewer.press("1 d d d", FIRST, "")
    assert_shown(viewer, IMAGES[FIRST])
    viewer.press("f", FIRST, "flip")
    shown = viewer.stage().sum(axis=2)  # magma gets brighter
    order = np.argsort(GIVEN.rows[0].flip_map.ravel())
    assert (np.diff(shown.ravel()[order][::40]) > 0).all()  # 1200 values: 40 apart differ by some 1/30
    assert viewer.text("#legend-words") == "FLIP of method 0: 0 to 1"
    viewer.press("d", FIRST, "signed")
    viewer.press("f f", FIRST, "")


@pytest.mark.parametrize(("x", "y"), CORNERS)
def test_readout_has_the_numbers_of_the_arrays(viewer, x, y):
    """Five digits tell two float16 numbers apart; of a difference they are 1 part in 20000."""
    viewer.press("3", FIRST + 2)
    viewer.hover(x, y)
    image, reference = half(IMAGES[FIRST + 2][y, x]), half(GIVEN.reference[y, x])
    np.testing.assert_array_equal(half(viewer.numbers("method 2")), image)
    np.testing.assert_array_equal(half(viewer.numbers("reference")), reference)
    np.testing.assert_array_equal(half(viewer.numbers("standard error")), half(GIVEN.standard_error[y, x]))
    np.testing.assert_allclose(viewer.numbers("|error|"), np.abs(image - reference), rtol=5e-5)
    assert viewer.numbers("layers") == GIVEN.surface_counts[y, x]
    # float16 is right to 1 part in 2048, and five digits to 1 in 20000.
    np.testing.assert_allclose(viewer.numbers("circle of confusion"), GIVEN.coc_px[y, x], rtol=1 / 2048 + 5e-5)
    if np.isinf(GIVEN.depth[y, x]):
        assert viewer.readout()["depth"] == ["background"]
    else:
        np.testing.assert_allclose(viewer.numbers("depth"), GIVEN.depth[y, x], rtol=1 / 2048 + 5e-5)


def test_readout_follows_the_mode(viewer):
    viewer.press("3", FIRST + 2)
    x, y = CORNERS[-1]
    viewer.hover(x, y)
    image, reference = half(IMAGES[FIRST + 2][y, x]), half(GIVEN.reference[y, x])
    viewer.press("d", FIRST + 2, "signed")
    np.testing.assert_allclose(viewer.numbers("signed error"), image - reference, rtol=5e-5)
    viewer.press("d", FIRST + 2, "relative")
    expected = (image - reference) / (np.abs(reference) + 0.01)
    np.testing.assert_allclose(viewer.numbers("relative error"), expected, rtol=5e-5)
    viewer.press("f", FIRST + 2, "flip")
    expected = np.round(GIVEN.rows[2].flip_map[y, x] * 256) / 256
    np.testing.assert_allclose(viewer.numbers("FLIP"), [expected], rtol=5e-5)
    assert not {"|error|", "signed error", "relative error"} & set(viewer.readout())
    viewer.press("f z", FIRST + 13)
    assert next(iter(viewer.readout())) == "depth"
    assert "reference" not in viewer.readout()


@pytest.mark.parametrize(("presses", "mode"), [("", ""), (" d", "signed"), (" d d", "relative")])
def test_histogram_counts_all_pixels(viewer, presses, mode):
    viewer.press("2" + presses, SPOILT, mode)
    with np.errstate(invalid="ignore"):
        values = {"": lambda a, _: luminance(a), "signed": signed, "relative": relative}[mode](
            IMAGES[SPOILT], GIVEN.reference
        )
    finite = values[np.isfinite(values)]
    expected, _ = np.histogram(finite, 64)
    counts = viewer.page.eval_on_selector_all("#histogram rect", "(bars) => bars.map((bar) => bar.dataset.count)")
    np.testing.assert_array_equal(np.array(counts, int), expected)
    assert viewer.text("#histogram-nan") == str(len(NAN_AT))
    assert viewer.text("#histogram-inf") == str(len(INF_AT))
    low, mean, high = (float(viewer.text(f"#histogram-{name}").split()[-1]) for name in ("low", "mean", "high"))
    np.testing.assert_allclose([low, mean, high], [finite.min(), finite.mean(), finite.max()], rtol=5e-4)  # 4 digits
    tall = viewer.page.eval_on_selector_all(
        "#histogram rect", "(bars) => bars.map((bar) => +bar.getAttribute('height'))"
    )
    np.testing.assert_allclose(tall, 60 * np.log1p(expected) / np.log1p(expected.max()), rtol=1e-9)


def test_histogram_of_depth_counts_the_background(viewer):
    viewer.press("z", FIRST + 13)
    assert viewer.text("#histogram-inf") == str(np.isinf(GIVEN.depth).sum())
    assert viewer.text("#histogram-nan") == "0"


def test_numbers_that_are_none_have_colours_of_their_own(viewer):
    viewer.press("2", SPOILT)
    shown = viewer.stage()
    for places, color in ((NAN_AT, (255, 0, 255)), (INF_AT, (0, 150, 170))):
        for x, y in places:
            assert tuple(shown[y, x]) == color


@pytest.mark.parametrize("y", [0, 7, HEIGHT - 1])
def test_profile_is_the_row_under_the_cursor(viewer, y):
    viewer.press("2", SPOILT)
    viewer.hover(11, y)
    with np.errstate(invalid="ignore"):
        row = luminance(IMAGES[SPOILT][y])
    row[~np.isfinite(row)] = np.nan
    # The same sum of three products of the same numbers.
    np.testing.assert_allclose(viewer.profile(), row, rtol=1e-12)
    np.testing.assert_allclose(viewer.profile("reference"), luminance(GIVEN.reference[y]), rtol=1e-12)
    assert viewer.text("#profile-title").startswith(f"row {y}:")
    viewer.press("d", SPOILT, "signed")
    np.testing.assert_allclose(viewer.profile(), row - luminance(GIVEN.reference[y]), rtol=1e-12)
    assert np.isnan(viewer.profile("reference")).all()
    viewer.press("c", FIRST + 14, "signed")
    np.testing.assert_allclose(viewer.profile(), GIVEN.coc_px[y], rtol=1 / 2048)  # float16


def test_profile_stands_below_the_pictures_columns(viewer):
    zoom, left, _ = viewer.fit()
    place = re.findall(r"-?[\d.]+", viewer.page.get_attribute("#profile .shown", "transform"))
    assert (float(place[0]), float(place[4])) == (zoom, left)
    assert float(place[3]) < 0.0  # larger values are higher
    low, high = map(float, viewer.text("#profile-range").split(" to "))
    row = luminance(GIVEN.reference[HEIGHT // 2])
    assert (low, high) == (0.0, pytest.approx(row.max(), rel=5e-4))  # 4 digits
