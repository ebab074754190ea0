"""Files of frames, as Blender, Unreal and others write them: what is chosen by itself, and what must be said."""

import numpy as np
import OpenEXR
import pytest

from refdof import InputError, ThinLens
from refdof.frame.files import load_frame
from refdof.image.file import load_image, save_image
from tests.frame import exr_files

pytestmark = pytest.mark.fast
LENS = ThinLens(0.1, 2.0)
DEPTH = np.array([[1.0, 2.5, np.inf], [4.0, 5.0, 6.0]], dtype=np.float32)
COLOR = np.linspace(0.1, 3.0, 18, dtype=np.float32).reshape(2, 3, 3)


def load(*words, **more):
    return load_frame(*words, fov_y=40.0, **({"lens": LENS} | more))


@pytest.fixture
def folder(tmp_path):
    exr_files.write_blender(tmp_path / "blender.exr", COLOR, DEPTH)
    exr_files.write_blender(tmp_path / "blender_v.exr", COLOR, DEPTH, letter="V")
    exr_files.write_unreal(tmp_path / "unreal.exr", COLOR, DEPTH)
    exr_files.write(tmp_path / "plain.exr", {**exr_files.rgb("", COLOR), "Z": DEPTH})
    exr_files.write(tmp_path / "named.exr", {**exr_files.rgb("", COLOR), "depth.Z": DEPTH})
    exr_files.write_parts(tmp_path / "parts.exr", {"rgba": exr_files.rgb("", COLOR), "depth": {"Z": DEPTH}})
    exr_files.write(tmp_path / "color.exr", exr_files.rgb("", COLOR))
    exr_files.write(tmp_path / "z.exr", {"Z": DEPTH})
    exr_files.write(tmp_path / "y.exr", {"Y": DEPTH})
    exr_files.write(tmp_path / "gray.exr", exr_files.rgb("", np.stack([DEPTH] * 3, axis=-1)))
    np.save(tmp_path / "color.npy", COLOR)
    np.save(tmp_path / "z.npy", DEPTH)
    np.save(tmp_path / "z1.npy", DEPTH[..., None])
    return tmp_path


@pytest.mark.parametrize("name", ["blender", "blender_v", "unreal", "plain", "named", "parts"])
def test_one_file_has_both(folder, name):
    frame = load(folder / f"{name}.exr")
    assert np.array_equal(frame.color, COLOR)
    assert np.array_equal(frame.depth, DEPTH)
    assert frame.depth.dtype == np.float64
    assert (frame.name, frame.camera.size, frame.camera.fov_y) == (name, (3, 2), 40.0)


@pytest.mark.parametrize("color", ["color.exr", "color.npy", "blender.exr", "blender.exr:ViewLayer.Combined"])
@pytest.mark.parametrize(
    "depth",
    ["z.exr", "y.exr", "gray.exr", "z.npy", "z1.npy", "unreal.exr", "blender.exr:ViewLayer.Depth",
     "blender.exr:ViewLayer.Depth.Z", "unreal.exr:FinalImageMovieRenderQueue_WorldDepth.G"],
)  # fmt: skip
def test_two_files(folder, color, depth):
    frame = load(f"{folder}/{color}", f"{folder}/{depth}")
    assert np.array_equal(frame.color, COLOR)
    assert np.array_equal(frame.depth, DEPTH)


def test_what_is_said_counts(folder):
    assert np.array_equal(load(f"{folder}/blender.exr:ViewLayer.DiffCol").color, COLOR + 1)
    assert load(f"{folder}/color.exr", f"{folder}/blender.exr:ViewLayer.Mist", depth_kind="reversed-infinite", near=1.0)
    assert np.array_equal(load_image(f"{folder}/blender.exr:ViewLayer.DiffCol"), COLOR + 1)


def test_radiance_png_and_half_floats(folder):
    # 2^(129 - 136) for each step: 1, 0.5, 0.25.
    (folder / "a.hdr").write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 3\n" + bytes([128, 64, 32, 129]) * 6)
    assert (load(folder / "a.hdr", folder / "z.npy").color == [1.0, 0.5, 0.25]).all()
    save_image(folder / "a.png", np.full((2, 3, 3), 0.5))
    # 0.5 is level 188 of sRGB, which stands for ((188 / 255 + 0.055) / 1.055)^2.4 = 0.50289.
    np.testing.assert_allclose(load(folder / "a.png", folder / "z.npy").color, 0.50289, atol=5e-6)
    half = COLOR.astype(np.float16)
    exr_files.write(folder / "half.exr", {**exr_files.rgb("", half), "Z": DEPTH.astype(np.float16)})
    frame = load(folder / "half.exr")
    assert np.array_equal(frame.color, half)
    assert np.array_equal(frame.depth, DEPTH)


def test_circles_instead_of_a_lens(folder):
    circles = np.array([[-3.0, 0.0, 1.5], [0.25, 2.0, -1e-3]])
    np.save(folder / "coc.npy", circles)
    exr_files.write(folder / "coc.exr", {"coc": circles.astype(np.float32)})
    frame = load(folder / "plain.exr", lens=None, coc=folder / "coc.npy")
    assert np.array_equal(frame.view().coc_px(), circles)
    frame = load(folder / "plain.exr", lens=None, coc=folder / "coc.exr")
    assert np.array_equal(frame.view().coc_px(), circles.astype(np.float32))
    with pytest.raises(InputError, match="lens: got both lens and coc"):
        load(folder / "plain.exr", coc=folder / "coc.npy")
    with pytest.raises(InputError, match="lens: got neither lens and coc"):
        load(folder / "plain.exr", lens=None)
    with pytest.raises(InputError, match=r"coc: .* has no channel "):
        load(folder / "plain.exr", lens=None, coc=folder / "plain.exr")


def other(folder, name, **channels):
    exr_files.write(folder / name, channels)
    return str(folder / name)


def two_layers(folder):
    return other(folder, "two.exr", **exr_files.rgb("A.", COLOR), **exr_files.rgb("B.", COLOR), Z=DEPTH)


def two_depths(folder):
    path = folder / "depths.exr"
    exr_files.write(path, {**exr_files.rgb("", COLOR), "One.Depth.Z": DEPTH, "Two.Depth.Z": DEPTH})
    return str(path)


REFUSED = {
    "two layers": (two_layers, None, "color: .*two.exr' has several R, G and B .it has A, B.; allowed is one, or its"),
    "no such layer": (lambda f: two_layers(f) + ":C", None, "color: .* has no R, G and B of 'C'"),
    "two depths": (two_depths, None, r"depth: .* has several depth .it has One.Depth.Z, Two.Depth.Z.; allowed"),
    "no depth": (lambda f: str(f / "color.exr"), None, "depth: .* has no depth .it has B, G, R"),
    "no depth in a PNG": (lambda f: str(f / "color.npy"), None, "depth: got none, and .*color.npy' holds none"),
    "one channel": (lambda f: str(f / "z.exr"), None, "color: .* has no R, G and B"),
    "colour as depth": (lambda f: str(f / "color.exr"), "color.exr", "depth: .* has no depth"),
    "PNG depth": (lambda f: str(f / "color.exr"), "d.png", "depth: got .*d.png', whose numbers have no unit; allowed"),
    "HDR depth": (lambda f: str(f / "color.exr"), "d.hdr", "depth: got .*d.hdr', whose numbers have no unit; allowed"),
    "missing": (lambda f: str(f / "none.exr"), None, "color: got .*: there is no such file"),
    "missing depth": (lambda f: str(f / "color.exr"), "none.npy", "depth: got .*: there is no such file"),
    "another suffix": (lambda f: str(f / "a.tif"), None, "color: got .*a.tif'; allowed are names that end in .png"),
    "a folder": (lambda f: f"{f}/folder.exr", None, "color: got .*, which is a folder"),
    "empty path": (lambda f: "", None, "color: got ''; allowed is a path"),
    "other size": (lambda f: str(f / "color.exr"), "wide.npy", r"depth: got shape \(2, 4\); allowed is \(2, 3\)"),
    "three numbers": (lambda f: str(f / "color.exr"), "color.npy", r"depth: got shape \(2, 3, 3\); allowed is"),
    "a flat colour": (lambda f: str(f / "z.npy"), "z.npy", r"color: got shape \(2, 3\); allowed is"),
    "no pixel": (lambda f: str(f / "empty.npy"), "z.npy", "color: (got shape|cannot read)"),
    "NaN colour": (lambda f: str(f / "nan.npy"), "z.npy", "color: has 1 NaN values"),
    "NaN depth": (lambda f: str(f / "color.exr"), "nan_z.npy", "depth: has 1 NaN values; none are allowed"),
    "negative depth": (lambda f: str(f / "color.exr"), "minus.npy", "depth: smallest value is -1; allowed for planar"),
    "words": (lambda f: str(f / "color.exr"), "words.npy", "depth: got .*; allowed are numbers"),
    "objects": (lambda f: str(f / "color.exr"), "objects.npy", "depth: cannot read"),
    "truncated EXR": (lambda f: str(f / "short.exr"), "z.npy", "color: cannot read .* are damaged or missing"),
    "no EXR": (lambda f: str(f / "text.exr"), "z.npy", "color: cannot read"),
    "truncated NPY": (lambda f: str(f / "color.exr"), "short.npy", "depth: cannot read"),
    "cropped": (lambda f: str(f / "crop.exr"), "z.npy", "color: .* holds pixels 1,1 .. 3,2 of 0,0 .. 9,9; allowed is"),
    "long pixels": (lambda f: str(f / "long.exr"), "z.npy", "color: .* has pixels 2 times as wide as high; allowed"),
}  # fmt: skip


@pytest.fixture
def hostile(folder):
    (folder / "folder.exr").mkdir()
    (folder / "text.exr").write_text("nothing")
    np.save(folder / "wide.npy", np.ones((2, 4)))
    np.save(folder / "empty.npy", np.ones((0, 3, 3)))
    for name, values in (("nan", COLOR), ("nan_z", DEPTH), ("minus", DEPTH)):
        bad = values.astype(np.float64)
        bad[0, 0] = -1.0
        bad.flat[0] = -1.0 if name == "minus" else np.nan
        np.save(folder / f"{name}.npy", bad)
    np.save(folder / "words.npy", np.full((2, 3), "a"))
    np.save(folder / "objects.npy", np.full((2, 3), None, dtype=object), allow_pickle=True)
    whole = (folder / "blender.exr").read_bytes()
    (folder / "short.exr").write_bytes(whole[: len(whole) - 60])
    (folder / "short.npy").write_bytes((folder / "z.npy").read_bytes()[:-4])
    window = np.array([1, 1], np.int32), np.array([3, 2], np.int32)
    display = np.array([0, 0], np.int32), np.array([9, 9], np.int32)
    exr_files.write(folder / "crop.exr", exr_files.rgb("", COLOR), dataWindow=window, displayWindow=display)
    exr_files.write(folder / "long.exr", exr_files.rgb("", COLOR), pixelAspectRatio=2.0)
    return folder


@pytest.mark.parametrize("name", REFUSED)
def test_what_is_no_frame_is_refused_in_one_line(hostile, name):
    color, depth, said = REFUSED[name]
    with pytest.raises(InputError, match=f"^{said}") as caught:
        load(color(hostile), None if depth is None else f"{hostile}/{depth}")
    assert len(str(caught.value).splitlines()) == 1


def test_nothing_else_is_printed(hostile, capfd):
    with pytest.raises(InputError, match="color: cannot read"):
        load(hostile / "short.exr")
    print("but this")
    assert capfd.readouterr() == ("but this\n", "")


def test_a_pipe_does_not_hang(folder):
    import os

    for name, words in (("p.exr", ()), ("p.npy", ("z.npy",)), ("p.hdr", ("z.npy",)), ("p.png", ("z.npy",))):
        os.mkfifo(folder / name)
        with pytest.raises(InputError, match=r"color: .* which is a pipe or a device"):
            load(folder / name, *(folder / word for word in words))


def test_depths_of_all_sizes_are_kept(folder):
    np.save(folder / "far.npy", np.array([[1e300, 1e-300, np.inf], [1.0, 2.0, 3.0]]))
    frame = load(folder / "color.exr", folder / "far.npy")
    assert frame.depth[0].tolist() == [1e300, 1e-300, np.inf]


def huge_exr(path, side, monkeypatch=None):
    """A small file that says it is large: the windows of another are written over."""
    exr_files.write(path, exr_files.rgb("", COLOR))
    content = bytearray(path.read_bytes())
    for name in (b"dataWindow\0box2i\0", b"displayWindow\0box2i\0"):
        start = content.index(name) + len(name) + 4
        content[start : start + 16] = np.array([0, 0, side - 1, side - 1], "<i4").tobytes()
    path.write_bytes(content)


@pytest.mark.parametrize("side", [20000, 2**30])
def test_an_exr_that_says_it_is_huge_is_refused_at_once(folder, side):
    huge_exr(folder / "huge.exr", side)
    with pytest.raises(InputError, match="color: ") as caught:
        load(folder / "huge.exr", folder / "z.npy")
    if side == 20000:
        assert "has 20000x20000 pixels of 3 channels; allowed are at most 67108864 pixels" in str(caught.value)


def test_an_npy_and_a_png_that_lie_about_their_size_are_refused_at_once(folder):
    with open(folder / "lie.npy", "wb") as file:
        np.lib.format.write_array_header_1_0(file, {"descr": "<f8", "fortran_order": False, "shape": (60000, 60000, 3)})
    with pytest.raises(InputError, match="color: cannot read"):
        load(folder / "lie.npy", folder / "z.npy")
    save_image(folder / "lie.png", COLOR)
    content = bytearray((folder / "lie.png").read_bytes())
    content[16:24] = (50000).to_bytes(4, "big") * 2
    (folder / "lie.png").write_bytes(content)
    with pytest.raises(InputError, match=r"color: .* has 50000x50000 pixels"):
        load(folder / "lie.png", folder / "z.npy")


def test_the_file_of_another_library_version_is_the_same(folder):
    """What is read with the library's own joined RGB is what is read by channels."""
    with OpenEXR.File(str(folder / "color.exr")) as file:
        assert np.array_equal(file.channels()["RGB"].pixels, load_image(folder / "color.exr"))
