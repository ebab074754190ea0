"""Image files and atomic writing."""

import flip_evaluator
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from PIL import Image

from refdof._check import InputError
from refdof.image.atomic import atomic_path, write_text
from refdof.image.display import display, display_slope, linear_from_display, to_8_bit
from refdof.image.file import load_image, save_image


def color(*rgb):
    return np.array([[rgb]], dtype=np.float64)


@pytest.fixture
def image():
    return np.random.default_rng(2).uniform(-0.2, 3.0, (7, 5, 3)).astype(np.float32)


def test_display_values_by_hand():
    # IEC 61966-2-1: 12.92 * 0.0031308 = 0.040449936, 1.055 * 0.5^(1/2.4) - 0.055 = 0.735356983; the ends
    # are exact. Tolerance: one rounding to float32 below 1.
    shown = display(color(0.0031308, 0.5, 0.001))[0, 0]
    np.testing.assert_allclose(shown, [0.040449936, 0.735356983, 0.01292], rtol=0, atol=6e-8)
    # Just above the knee: 1.055 * 0.0035^(1/2.4) - 0.055; the straight piece would give 0.04522.
    assert display(color(0.0035, 0, 0))[0, 0, 0] == pytest.approx(0.044987907, abs=6e-8)
    assert display(color(0.0, 1.0, -3.0))[0, 0].tolist() == [0.0, 1.0, 0.0]
    assert display(color(1.5, np.inf, -np.inf))[0, 0].tolist() == [1.0, 1.0, 0.0]
    assert shown.dtype == np.float32


def test_eight_bit_values_by_hand():
    # 0.735356983 * 255 = 187.516, 0.01292 * 255 = 3.29.
    assert to_8_bit(color(0.5, 0.001, 7.0))[0, 0].tolist() == [188, 3, 255]


@settings(deadline=None)
@given(st.floats(0.0, 1.0))
def test_encoding_is_undone(value):
    # Display values are float32 (error 6e-8) and the decoding slope is at most 2.3; the two pieces of sRGB
    # meet with a gap of 3e-8.
    assert linear_from_display(display(color(value, value, value)))[0, 0, 0] == pytest.approx(value, abs=2e-7)


@pytest.mark.parametrize("value", [0.0, 0.001, 0.0029, 0.01, 0.2, 0.9])
def test_slope_is_the_derivative(value):
    step = 1e-4
    low, high = max(0.0, value - step), value + step
    # float32 display values, 6e-8 each, over a step of 1e-4 or 2e-4; the curve's third derivative at 0.01
    # adds 1e-3.
    difference = (display(color(high, 0, 0)).astype(float) - display(color(low, 0, 0)))[0, 0, 0] / (high - low)
    assert display_slope(color(value, 0, 0))[0, 0, 0] == pytest.approx(difference, rel=1e-3, abs=2e-3)


def test_display_refuses_nan_and_other_shapes():
    with pytest.raises(InputError, match="image: has 1 NaN"):
        display(color(np.nan, 0, 0))
    with pytest.raises(InputError, match="image: got shape"):
        display(np.zeros((3, 3)))


@pytest.mark.parametrize("suffix", [".exr", ".npy", ".EXR"])
def test_linear_files_keep_every_bit(tmp_path, image, suffix):
    path = tmp_path / f"new folder/image{suffix}"
    save_image(path, image)
    back = load_image(path)
    assert back.dtype == np.float32
    np.testing.assert_array_equal(back, image)
    assert [file.name for file in path.parent.iterdir()] == [path.name]


def test_npy_keeps_float64(tmp_path, image):
    exact = image.astype(np.float64) / 3.0
    save_image(tmp_path / "image.npy", exact)
    np.testing.assert_array_equal(load_image(tmp_path / "image.npy"), exact)


def test_exr_is_read_alike_by_another_library(tmp_path, image):
    positive = np.abs(image)
    save_image(tmp_path / "image.exr", positive)
    np.testing.assert_array_equal(flip_evaluator.load(str(tmp_path / "image.exr")), positive)


def test_png_holds_the_display_image(tmp_path, image):
    save_image(tmp_path / "image.png", image)
    with Image.open(tmp_path / "image.png") as file:
        assert (file.mode, file.size) == ("RGB", (5, 7))
        np.testing.assert_array_equal(np.asarray(file), to_8_bit(image))
    # Half a level of 255 in display values, times the decoding slope of at most 2.3.
    np.testing.assert_allclose(load_image(tmp_path / "image.png"), np.clip(image, 0, 1), rtol=0, atol=2.3 * 0.5 / 255)


@pytest.mark.parametrize("name", ["image.jpg", "image", "image.exr.gz", ""])
def test_other_suffixes_are_refused(tmp_path, image, name):
    with pytest.raises(InputError, match=r"out: got .* end in \.png, \.exr, \.npy"):
        save_image(tmp_path / name, image)
    with pytest.raises(InputError, match=r"path: got .* end in \.png, \.exr, \.npy"):
        load_image(tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_images_that_cannot_be_kept_leave_no_file(tmp_path, image):
    image[1, 2, 0] = np.nan
    with pytest.raises(InputError, match="image: has 1 NaN"):
        save_image(tmp_path / "image.png", image)
    with pytest.raises(InputError, match="at least one pixel"):
        save_image(tmp_path / "image.exr", np.zeros((0, 3, 3)))
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("suffix", [".png", ".exr", ".npy"])
def test_damaged_and_missing_files_are_named(tmp_path, image, suffix):
    path = tmp_path / f"image{suffix}"
    with pytest.raises(InputError, match=r"path: got .*: there is no such file; allowed is a file"):
        load_image(path)
    path.write_bytes(b"not an image")
    with pytest.raises(InputError, match="path: cannot read"):
        load_image(path)
    save_image(path, image)
    path.write_bytes(path.read_bytes()[:-40])
    with pytest.raises(InputError, match="path: "):
        load_image(path)


def test_a_header_that_python_cannot_take_apart_is_refused(tmp_path):
    words = b"{'descr': '<f4', 'fortran_order': False, 'shape': (3, 4"
    (tmp_path / "image.npy").write_bytes(b"\x93NUMPY\x01\x00" + len(words).to_bytes(2, "little") + words)
    with pytest.raises(InputError, match=r"path: cannot read .*; allowed is an image file"):
        load_image(tmp_path / "image.npy")


def test_a_crash_leaves_the_old_file_and_nothing_else(tmp_path):
    target = tmp_path / "table.md"
    target.write_text("old")

    def crash(error):
        with atomic_path(target) as temporary:
            assert temporary.suffix == ".md"
            temporary.write_text("half of the n")
            raise error

    for error in (RuntimeError("crash"), KeyboardInterrupt()):
        with pytest.raises(type(error)):
            crash(error)
        assert target.read_text() == "old"
        assert list(tmp_path.iterdir()) == [target]
    with pytest.raises(InputError, match=r"out: cannot write .*No space left"):
        crash(OSError(28, "No space left on device"))
    assert target.read_text() == "old"
    write_text(target, "new \N{GREEK SMALL LETTER ALPHA}\n")
    assert target.read_bytes() == b"new \xce\xb1\n"
    assert list(tmp_path.iterdir()) == [target]


def test_targets_that_cannot_be_written_are_named(tmp_path):
    (tmp_path / "file").write_text("")
    (tmp_path / "folder.md").mkdir()
    for target in (tmp_path / "folder.md", tmp_path / "file" / "table.md", tmp_path / "a\0b.md", ""):
        with pytest.raises(InputError, match="out: "):
            write_text(target, "text")
    assert sorted(file.name for file in tmp_path.iterdir()) == ["file", "folder.md"]


def test_a_symbolic_link_stays_a_link(tmp_path):
    (tmp_path / "link.md").symlink_to(tmp_path / "real.md")
    write_text(tmp_path / "link.md", "text")
    assert (tmp_path / "link.md").is_symlink()
    assert (tmp_path / "real.md").read_text() == "text"


def test_a_grey_png_of_16_bits_is_read_as_grey(tmp_path):
    from PIL import Image

    values = np.array([[0, 1000, 30000, 65535]], dtype=np.uint16)
    Image.fromarray(values).save(tmp_path / "a.png")
    display = values / 65535.0
    linear = np.where(display <= 0.04045, display / 12.92, ((display + 0.055) / 1.055) ** 2.4)
    np.testing.assert_allclose(load_image(tmp_path / "a.png"), np.repeat(linear[..., None], 3, axis=2), atol=1e-6)
