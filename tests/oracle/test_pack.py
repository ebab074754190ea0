"""Packs: device depth, bounds of circles, previews, what may be replaced, and the core pack in data/."""

import io
import json
import re
from fractions import Fraction
from pathlib import Path

import imageio.v3 as imageio
import numpy as np
import pytest

from refdof import InputError
from refdof.methods import METHODS
from refdof.oracle import check, write_pack
from refdof.oracle.case_files import ENOUGH
from refdof.oracle.cases import Case, cases_of
from refdof.oracle.circles import circle_bounds, size_bounds
from refdof.oracle.device_depth import DEVICE_DEPTHS, circle_error, device_depth, inverse_depth, planes_of
from refdof.oracle.expectation import expectation_of
from refdof.oracle.files import open_pack
from refdof.oracle.goldens import golden_of
from refdof.oracle.inputs import INPUTS, ORIGINS
from refdof.oracle.pack import goldens_digest, sha256_of
from refdof.oracle.pictures import random
from refdof.oracle.preview import preview_of
from refdof.oracle.shaders.case import case_values
from refdof.rendering import make_params
from refdof.stages import Stages
from tests.methods.poisson.test_params import PLANES, naive

ROOT = Path(__file__).parents[2]
CORE = ROOT / "data" / "packs" / "core"
MOST = 5 * 2**20  # bytes

CASES = [
    Case("cards", "singlepass", "cards", (24, 18), stages=Stages((1, 4))),
    Case("noise_up", "singlepass", "noise", (17, 13), {"row_order": "up", "max_taps": 9}, "up"),
    Case("noise_mirrored", "singlepass", "noise", (17, 13), {"row_order": "up"}, tags=("mirrored_spiral",)),
]


@pytest.fixture
def few(monkeypatch):
    """Packs of three small cases."""
    monkeypatch.setattr("refdof.oracle.pack.cases_of", lambda level, methods: CASES)


def about(folder, name):
    return json.loads((folder / "cases" / name / "case.json").read_text())


def contents(folder):
    return {path.relative_to(folder): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


# Device depth


@pytest.mark.fast
def test_device_depth_by_hand():
    # n = 1, f = 4, z = 2: 4 (2 - 1) / (2 3) = 2/3; 1 (4 - 2) / (2 3) = 1/3; 1/2.
    depth = np.array([[1.0, 2.0, 4.0]], np.float32)
    planes = planes_of(depth)._replace(far=4.0)
    assert planes == (1.0, 4.0)
    expected = {
        "depth_device": [0.0, 2.0 / 3.0, 1.0],
        "depth_device_reversed": [1.0, 1.0 / 3.0, 0.0],
        "depth_device_infinite": [1.0, 0.5, 0.25],
    }
    assert set(expected) == set(DEVICE_DEPTHS)
    for name, values in expected.items():
        assert device_depth(name, depth, planes).tolist() == np.array([values], np.float32).tolist()


@pytest.mark.fast
@pytest.mark.parametrize("name", DEVICE_DEPTHS)
@pytest.mark.parametrize("source", [name for name in INPUTS if name not in ("scene", "distances", "huge")])
def test_circles_come_back_from_device_depth_in_float32(source, name):
    picture = INPUTS[source](31, 23)
    planes = planes_of(picture.depth)
    assert 0.0 < planes.near <= picture.depth.min()
    assert picture.depth.max() <= planes.far
    device = device_depth(name, picture.depth, planes)
    assert device.min() >= 0.0
    assert device.max() <= 1.0
    # As a port does it: all in float32.
    inverse = inverse_depth(name, device, planes)
    assert inverse.dtype == np.float32
    coc = np.float32(picture.coc_scale) * (np.float32(1.0 / picture.focus) - inverse)
    off = np.abs(coc - picture.coc.astype(np.float64)).max()
    assert circle_error(name, picture, planes) <= ENOUGH
    assert off <= 3 * ENOUGH
    # Order is kept, but that depths which are apart by the last bits may become one.
    nearer, farther = picture.depth.ravel()[:-1], picture.depth.ravel()[1:]
    change = np.sign(np.diff(inverse.ravel())) * np.sign(nearer.astype(np.float64) - farther)
    close = np.abs(nearer - farther) <= 2e-6 * np.maximum(nearer, farther)
    assert (change[~close] == np.where(nearer == farther, 0.0, 1.0)[~close]).all()


@pytest.mark.fast
def test_device_depth_that_is_not_enough_is_told():
    picture = INPUTS["distances"](9, 9)
    planes = planes_of(picture.depth)
    assert planes.near == 2.0**-14  # 1e-4 is 1.6 times that
    assert planes.far >= picture.depth.max()
    # A step of d is 2^-24 near 1, and then one of 1 / z 2^-24 / n: 20 px of that, 20 2^14 / 2^24 / 2.
    error = circle_error("depth_device", picture, planes)
    assert 0.005 < error <= 20.0 * 2.0**14 / 2.0**25
    assert error > ENOUGH


@pytest.mark.fast
@pytest.mark.parametrize("name", DEVICE_DEPTHS)
def test_the_largest_error_is_that_of_one_pixel_and_has_no_sign(name):
    picture = INPUTS["noise"](7, 5)
    planes = planes_of(picture.depth)
    each = [circle_error(name, picture._replace(depth=z.reshape(1, 1)), planes) for z in picture.depth.ravel()]
    assert min(each) >= 0.0
    assert max(each) == circle_error(name, picture, planes) > 0.0


@pytest.mark.fast
def test_depths_of_shaders_expressions_are_those_of_the_files(pack):
    task = expectation_of(open_pack(pack), "cards").task
    pictures = case_values(task, mirrored=False).pictures
    for name, file in (("device", ""), ("reversed", "_reversed"), ("reversed_infinite", "_infinite")):
        stored = np.fromfile(task.folder / "inputs" / f"depth_device{file}.f32", "<f4")
        assert np.array_equal(pictures[name].astype(np.float32).ravel(), stored)


# Circles


@pytest.mark.fast
@pytest.mark.parametrize("source", ["cards", "hdr", "noise", "hair", "distances", "huge"])
def test_every_way_to_write_a_circle_in_float32_is_within_bounds(source):
    picture = INPUTS[source](31, 23)
    low, high = circle_bounds(picture)
    own = np.float32
    z, f, s = picture.depth, own(picture.focus), own(picture.coc_scale)
    for coc in (s * (1 / f - 1 / z), s / f - s / z, picture.coc):
        assert coc.dtype == np.float32
        least, greatest = (np.nextafter(b.astype(own), own(t)) for b, t in ((low, -np.inf), (high, np.inf)))
        assert (least <= coc).all()
        assert (coc <= greatest).all()
    assert (high - low).max() <= 20 * 2.0**-23 * picture.coc_scale * (1.0 / picture.focus + 1.0 / z.min())


@pytest.mark.fast
def test_bounds_of_a_circle_by_hand():
    picture = INPUTS["ramp"](1, 1)  # 48 (1/2 - 1/4) = 12
    low, high = (bound.item() for bound in circle_bounds(picture))
    unit = Fraction(1, 2**23)
    least = 48 * (Fraction(1, 2) * (1 - 3 * unit) - Fraction(1, 4) * (1 + 3 * unit)) / (1 + Fraction(3, 2) * unit)
    greatest = 48 * (Fraction(1, 2) * (1 + 3 * unit) - Fraction(1, 4) * (1 - 3 * unit)) * (1 + Fraction(3, 2) * unit)
    assert low == pytest.approx(float(least), rel=1e-14)
    assert high == pytest.approx(float(greatest), rel=1e-14)
    low, high = np.array([-3.0, -1.0, 2.0, 30.0]), np.array([-2.0, 4.0, 2.5, 31.0])
    assert [bound.tolist() for bound in size_bounds(low, high, 20.0)] == [[2.0, 0.0, 2.0, 20.0], [3.0, 4.0, 2.5, 20.0]]


@pytest.mark.fast
def test_random_numbers_are_those_of_numpy():
    expected = np.random.default_rng(7)
    for shape, found in zip([(2, 3), (1,), (4,)], random(7, (2, 3), (1,), (4,)), strict=True):
        assert np.array_equal(found, expected.random(shape))


@pytest.mark.fast
def test_every_input_says_what_it_is_for():
    for name, made in INPUTS.items():
        assert made.__doc__
        if name in ORIGINS:
            assert len(ORIGINS[name]) > 20


@pytest.mark.fast
def test_a_preview_is_a_png_of_some_pixels():
    image = np.random.default_rng(0).random((70, 130, 3)) * 2.0
    pixels = imageio.imread(io.BytesIO(preview_of(image)), extension=".png")
    expected = np.sqrt(np.clip(image[::3, ::3], 0.0, 1.0)) * 255.0
    assert pixels.shape == (24, 44, 3)
    assert np.abs(pixels - expected).max() <= 0.5 + 1e-9


# What a pack holds


def test_what_a_case_says(few, tmp_path):
    write_pack(tmp_path / "pack", exr=True)
    said = about(tmp_path / "pack", "cards")
    assert set(said["expected"]["stages"]) == {"coc", "size", "limit", "mean_1", "mean_4"}
    image = said["expected"]["image"]
    assert 0.0 < image["wide_share"] <= image["ambiguous_share"] < 0.6
    assert said["notes"].startswith("A near, a sharp and a far card")
    assert "32 families" in said["origin"]
    assert said["device_depth"]["depth_device"]["enough"] is True
    assert about(tmp_path / "pack", "noise_up")["capabilities"] == ["max_taps"]
    assert about(tmp_path / "pack", "noise_up")["tags"] == ["singlepass", "noise", "max_taps"]
    assert about(tmp_path / "pack", "noise_mirrored")["capabilities"] == ["mirrored_spiral"]
    lines = dict(line.split() for line in (tmp_path / "pack/cases/noise_up/params.txt").read_text().splitlines())
    assert lines["row_step"] == "1"
    assert lines["radius_start"] == "0.5"
    assert float(lines["near"]) <= 1.0
    assert float(lines["far"]) == 1e6


def test_arrays_say_the_same_in_every_form(few, tmp_path):
    import OpenEXR

    write_pack(tmp_path / "pack", exr=True)
    for case in CASES:
        folder = tmp_path / "pack" / "cases" / case.name
        said = about(tmp_path / "pack", case.name)
        for entry in (*said["inputs"].values(), said["expected"]["image"]):
            values = np.load(folder / entry["npy"])
            assert list(values.shape) == entry["shape"]
            assert np.array_equal(np.fromfile(folder / entry["raw"], "<f4").reshape(values.shape), values)
            with OpenEXR.File(str(folder / entry["exr"])) as file:
                assert np.array_equal(file.channels()["RGB" if values.ndim == 3 else "Y"].pixels, values)
        low, high, image, ambiguity = (
            np.load(folder / "expected" / f"{part}.npy") for part in ("low", "high", "image", "ambiguity")
        )
        assert np.array_equal((low < high).any(axis=-1), ambiguity)
        assert np.array_equal(low[~ambiguity], image[~ambiguity])


def test_a_right_port_of_poisson_passes_and_a_wrong_one_fails(monkeypatch, tmp_path):
    case = Case("hdr", "poisson", "hdr", (16, 12), PLANES, stages=Stages((4,)))
    monkeypatch.setattr("refdof.oracle.pack.cases_of", lambda level, methods: [case])
    write_pack(tmp_path / "pack")
    assert set(about(tmp_path / "pack", "hdr")["expected"]["stages"]) == {"coc", "code", "small", "mean_4"}
    lines = dict(line.split() for line in (tmp_path / "pack/cases/hdr/params.txt").read_text().splitlines())
    assert (lines["method"], lines["tap_count"]) == ("poisson", "12")
    assert (lines["tap_0_0"], lines["tap_0_1"], lines["row_step"]) == ("-0.326212", "-0.40581", "1")

    def port(color, depth, coc, params, **changes):
        given = {**params, **changes}
        few = {"image": given, "mean_4": {**given, "max_taps": 4}}
        images = [image.astype(np.float64) for image in (color, depth, coc)]
        return {name: naive(*images, **use).astype(np.float32) for name, use in few.items()}

    assert check(port, tmp_path / "pack").passed
    for change in ({"taps": "eight"}, {"small_radius": 0.5}, {"row_order": "up"}, {"max_radius": 4.0}):
        report = check(lambda *words, change=change: port(*words, **change), tmp_path / "pack")
        assert report.counts()["fail"] == 1


# What may be replaced


def test_another_pack_is_replaced_only_where_that_is_asked_for(few, tmp_path, monkeypatch):
    place = tmp_path / "pack"
    write_pack(place)
    before = contents(place)
    write_pack(place)  # the same content
    assert contents(place) == before
    for changed in (CASES[:2], [CASES[0], CASES[1], Case("noise_mirrored", "singlepass", "noise", (17, 13))]):
        monkeypatch.setattr("refdof.oracle.pack.cases_of", lambda level, methods, changed=changed: changed)
        with pytest.raises(InputError, match=r"^out: got .*, a pack whose .* differ; allowed is .*--update"):
            write_pack(place)
        assert contents(place) == before
    write_pack(place, update=True)
    assert contents(place) != before
    assert list(tmp_path.iterdir()) == [place]


@pytest.mark.fast
def test_a_folder_of_other_things_is_never_replaced(tmp_path):
    (tmp_path / "mine.txt").write_text("mine")
    for update in (False, True):
        with pytest.raises(InputError, match=r"^out: got .*, which holds other files"):
            write_pack(tmp_path, update=update)
    assert (tmp_path / "mine.txt").read_text() == "mine"


# The core pack


@pytest.fixture(scope="module")
def manifest():
    return json.loads((CORE / "manifest.json").read_text())


@pytest.mark.fast
def test_the_core_pack_is_small(manifest):
    sizes = [path.stat().st_size for path in CORE.rglob("*") if path.is_file()]
    assert sum(sizes) < MOST
    assert len(sizes) == len(manifest["files"]) + 1


@pytest.mark.fast
def test_goldens_change_with_a_line_in_the_changelog(manifest):
    files = {path.relative_to(CORE).as_posix(): path.read_bytes() for path in CORE.rglob("*") if path.is_file()}
    digests = {name: sha256_of(content) for name, content in files.items() if name != "manifest.json"}
    assert digests == manifest["files"]
    assert goldens_digest(digests) == manifest["goldens"]
    named = re.findall(r"core pack's goldens: `([0-9a-f]{64})`", (ROOT / "CHANGELOG.md").read_text())
    assert named[:1] == [manifest["goldens"]], "CHANGELOG.md has to name the digest of new goldens, newest first"


@pytest.mark.slow
def test_the_code_makes_the_core_pack(tmp_path):
    """Every byte. Where it differs, the names of the files are shown."""
    write_pack(tmp_path / "core")
    made, kept = contents(tmp_path / "core"), contents(CORE)
    assert sorted(made) == sorted(kept)
    assert [str(name) for name in made if made[name] != kept[name]] == []


@pytest.mark.fast
@pytest.mark.parametrize("level", ["core", "full", "extreme"])
def test_names_of_cases_are_folders_and_differ(level):
    names = [case.name for case in cases_of(level)]
    assert len(set(names)) == len(names)
    assert all(re.fullmatch(r"[a-z0-9_]{1,80}", name) for name in names)


@pytest.mark.fast
@pytest.mark.parametrize("method", ["singlepass", "poisson"])
def test_rows_as_they_are_stored_give_the_picture_as_it_is_stored(method):
    """No port turns rows round; 11 rows are no multiple of 4, and the small picture leaves out the last as stored."""
    planes = {"near_plane": 1.0, "focus_plane": 2.0, "far_plane": 8.0} if method == "poisson" else {}
    case = Case("c", method, "noise", (9, 11), {"row_order": "up", **planes}, rows="up")
    golden = golden_of(case)
    assert np.array_equal(golden.picture.depth, INPUTS["noise"](9, 11).depth[::-1])
    image = METHODS[method].blur(*golden.picture[:3], make_params(method, planes))
    one = golden.expected["image"]
    room = one.tolerance.max_abs
    assert ((one.low - room <= image) & (image <= one.high + room)).all()
