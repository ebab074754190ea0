"""Deep files: samples as surfaces by hand and by a twin, and methods of layers on them."""

import numpy as np
import pytest

import refdof
from refdof import InputError, ThinLens, View
from refdof.filtering import filter_frame, methods_of_frame
from refdof.frame.files import load_frame
from refdof.frame.frame import Frame, frame_camera
from refdof.rendering import render_view
from tests.frame import exr_files

pytestmark = pytest.mark.fast
LENS = ThinLens(0.1, 2.0)


@pytest.fixture(autouse=True)
def _unwarmed(monkeypatch):
    """Without compiling first: where nothing is compiled, that takes longer than the rest."""
    monkeypatch.setattr("refdof.compare.warm_up", lambda *_: None)
    monkeypatch.setattr("refdof.compare._RUNS", 1)


def load(folder, pixels, letters="RGBAZ", **more):
    exr_files.write_deep(folder / "deep.exr", pixels, letters)
    return load_frame(folder / "deep.exr", fov_y=40.0, lens=LENS, **more)


def gray(light, opacity, depth):
    return (light, light, light, opacity, depth)


def test_by_hand(tmp_path):
    pixels = [
        [
            [gray(0.5, 1, 4.0), gray(0.25, 1, 2.0)],  # opaque, not in order
            [],
            [gray(0.125, 0.25, 3.0), gray(0.5, 1, 5.0)],  # a veil belongs to what is behind it
        ],
        [
            [gray(0.25, 0.5, 1.0), gray(0.125, 0.25, 2.0)],  # half hides: a surface; a veil behind is none
            [gray(0.125, 0.25, 1.0), gray(0.25, 0.5, 2.0), gray(1, 1, np.inf)],
            [(1.0, 2.0, 3.0, 1, 1e10)],  # Blender's background
        ],
    ]
    frame = load(tmp_path, pixels)
    depth, color = frame.layers.depth, frame.layers.color[..., 0]
    # Behind a veil of 0.25: 0.125 + 0.75 * 0.5 = 0.5. Half before a veil: 0.25 + 0.5 * 0.125 = 0.3125. A veil before
    # half before white at infinity: 0.125 + 0.75 * (0.25 + 0.5 * 1) = 0.6875.
    assert depth.tolist() == [[[2.0, np.inf, 5.0], [1.0, 2.0, np.inf]], [[4.0, np.inf, np.inf], [np.inf] * 3]]
    assert color[0].tolist() == [[0.25, 0.0, 0.5], [0.3125, 0.6875, 0.0]]
    assert color[1].tolist() == [[0.5, 0.0, 0.0], [0.0, 0.0, 0.0]]
    assert frame.layers.triangle.tolist() == [[[0, -1, 0], [0, 0, -1]], [[1, -1, -1], [-1, -1, -1]]]
    assert np.array_equal(frame.depth, depth[0])
    # Blender's background is seen by the flat picture only.
    assert frame.color.tolist() == [[[c] * 3 for c in (0.25, 0.0, 0.5)], [[0.3125] * 3, [0.6875] * 3, [1.0, 2.0, 3.0]]]


def test_without_opacity_all_is_opaque(tmp_path):
    frame = load(tmp_path, [[[(0.5, 0.25, 0.125, 3.0)], []]], "RGBZ")
    assert frame.color.tolist() == [[[0.5, 0.25, 0.125], [0, 0, 0]]]
    assert frame.depth.tolist() == [[3.0, np.inf]]


def over(samples):
    """What is seen of samples front to back, each before black and the others."""
    light, through = np.zeros(3), 1.0
    for *color, opacity, _ in samples:
        light = light + through * np.float32(color)
        through *= 1 - opacity
    return light


def test_a_plain_loop_finds_the_same_surfaces(tmp_path):
    random = np.random.default_rng(7)
    pixels = []
    for _ in range(5):
        row = []
        for _ in range(6):
            count = random.integers(0, 7)
            opacity = random.choice([0.125, 0.25, 0.5, 1.0], count)
            values = zip(opacity, *random.random((3, count)), random.integers(1, 9, count), strict=True)
            row.append([(a * r, a * g, a * b, a, z) for a, r, g, b, z in values])
        pixels.append(row)
    frame = load(tmp_path, pixels)
    for y, row in enumerate(pixels):
        for x, samples in enumerate(row):
            found = []
            behind = sorted(samples, key=lambda sample: sample[4])
            start, through = 0, 1.0
            for k, (*_, opacity, depth) in enumerate(behind):
                through *= 1 - opacity
                if through <= 0.5:
                    found.append((over(behind[start:]), depth))
                    start, through = k + 1, 1.0
            np.testing.assert_allclose(frame.color[y, x], over(behind), rtol=1e-6)
            assert (frame.layers.triangle[:, y, x] >= 0).sum() == len(found)
            for k, (color, depth) in enumerate(found):
                assert frame.layers.depth[k, y, x] == depth
                # Opacities are powers of two: only colours round, some times to float64 and once to float32.
                np.testing.assert_allclose(frame.layers.color[k, y, x], color, rtol=1e-6)


@pytest.mark.parametrize(("kind", "planes", "stored"), [
    ("reversed-infinite", {"near": 1.0}, 0.25), ("device", {"near": 1.0, "far": 8.0}, 6 / 7),
    ("reversed", {"near": 1.0, "far": 8.0}, 1 / 7),
])  # fmt: skip
def test_depth_kinds_hold_for_samples(tmp_path, kind, planes, stored):
    # A surface at depth 4: d = 1/4, (1 - 1/4) / (7/8) = 6/7, and 1/7; 6/7 and 1/7 are rounded to float32.
    pixels = [[[gray(0.5, 1, stored), gray(0.25, 1, 0.5)]]]
    assert sorted(load(tmp_path, pixels, depth_kind=kind, **planes).layers.depth[:, 0, 0])[-1] == pytest.approx(
        4.0, rel=2e-6
    )


def test_rays_of_samples_are_their_pixels(tmp_path):
    pixels = [[[gray(0.5, 1, 3.0)], [], [gray(0.5, 1, 3.0)]], [[], [gray(0.5, 1, 3.0)] * 2, []]]
    exr_files.write_deep(tmp_path / "deep.exr", pixels)
    frame = load_frame(tmp_path / "deep.exr", fov_y=90.0, lens=LENS, depth_kind="radial")  # P = 1 px
    # Slopes -1, 0, 1 and 0.5, -0.5: lengths 1.5 and sqrt(1.25). Two rays may share a length, not a pixel.
    assert frame.depth[0] == pytest.approx([2.0, np.inf, 2.0], rel=1e-15)
    assert frame.depth[1] == pytest.approx([np.inf, 3 / 1.25**0.5, np.inf], rel=1e-15)


@pytest.fixture(scope="module")
def view():
    scene = refdof.load_scene("branches")
    assert scene.background != (0.0, 0.0, 0.0)
    return View(scene, scene.camera.with_size((24, 18)), scene.lens)


def frame_of(view):
    pinhole, camera = view.pinhole(), view.camera
    camera, background = frame_camera(camera.fov_y, camera.size), view.scene.background
    return Frame(pinhole.color, pinhole.depth, camera, view.lens, layers=view.layers(), background=background)


@pytest.mark.parametrize(("method", "params"), [
    ("cascaded", {}), ("cascaded", {"buffers": 2}), ("cascaded", {"buffers": "all"}), ("lensblur", {}),
    ("lensblur", {"peel": "umbra", "layers": 0}), ("lensblur", {"peel": "plain", "layers": 2}),
])  # fmt: skip
def test_all_layers_give_the_picture_of_the_scene(view, method, params):
    """Scene and frame have the same surfaces, so every bit is the same."""
    params = params | ({"samples": 16} if method == "lensblur" else {})
    wanted = render_view(method, view, **params).image
    (row,) = filter_frame(frame_of(view), [method], {method: params}).rows
    assert np.array_equal(row.image, wanted)


def test_a_deep_file_gives_it_but_for_roundings(view, tmp_path):
    view = View(view.scene.with_background((0.0, 0.0, 0.0)), view.camera, view.lens)  # of which a file says nothing
    layers = view.layers()
    count, height, width = layers.triangle.shape
    pixels = [
        [
            [
                (*layers.color[k, y, x], 1.0, layers.depth[k, y, x])
                for k in range(count)
                if layers.triangle[k, y, x] >= 0
            ]
            for x in range(width)
        ]
        for y in range(height)
    ]
    exr_files.write_deep(tmp_path / "deep.exr", pixels)
    frame = load_frame(tmp_path / "deep.exr", fov_y=view.camera.fov_y, lens=view.lens)
    assert {"cascaded", "lensblur"} < set(methods_of_frame(frame))
    found = filter_frame(frame, ["cascaded", "lensblur"], {"lensblur": {"samples": 16}})
    for row in found.rows:
        wanted = render_view(row.method, view, **({"samples": 16} if row.method == "lensblur" else {})).image
        # Depths have 24 bits: circles move by 1e-6 px, and with them a few rays across an edge.
        assert np.mean(np.abs(row.image - wanted) > 1e-4) < 0.01


def test_methods_that_need_more_are_refused_by_name(view):
    frame = frame_of(view)
    for name in ("multiview", "accumulation"):
        with pytest.raises(
            InputError, match=f"methods: got '{name}', which needs triangles; allowed on this frame are"
        ):
            filter_frame(frame, [name])
    with pytest.raises(InputError, match=r"lensblur.deferred: got True, which needs triangles"):
        filter_frame(frame, ["lensblur"], {"lensblur": {"deferred": True}})
    flat = Frame(frame.color, frame.depth, frame.camera, frame.lens)
    with pytest.raises(InputError, match="methods: got 'cascaded', which needs a deep file; allowed"):
        filter_frame(flat, ["cascaded"])
    circles = Frame(frame.color, frame.depth, frame.camera, coc=np.ones(frame.depth.shape), layers=frame.layers)
    with pytest.raises(InputError, match="methods: got 'lensblur', which needs a lens instead of circles"):
        filter_frame(circles, ["lensblur"])
    with pytest.raises(InputError, match="lacks triangles"):
        frame.view().triangles()
    with pytest.raises(InputError, match="lacks a deep file"):
        flat.view().layers()


@pytest.mark.parametrize(("pixels", "said"), [
    ([[[gray(0.5, 1, np.nan)]]], "depth: has 1 NaN"),
    ([[[gray(np.nan, 1, 1.0)]]], "color: has 3 NaN"),
    ([[[gray(0.5, 2, 1.0)]]], "opacity: largest value is 2"),
    ([[[gray(0.5, -1, 1.0)]]], "opacity: smallest value is -1"),
    ([[[gray(0.5, 1, -1.0)]]], "depth: smallest value is -1; allowed for planar"),
    ([[[gray(0.5, 1, 1.0)] * 1025]], "depth: a pixel has 1025 surfaces; allowed are at most 1024"),
])  # fmt: skip
def test_bad_samples_are_named(tmp_path, pixels, said):
    with pytest.raises(InputError, match=said):
        load(tmp_path, pixels)


def test_a_deep_file_has_its_own_depth_and_one_layer(tmp_path):
    exr_files.write_deep(tmp_path / "deep.exr", [[[gray(0.5, 1, 2.0)]]])
    with pytest.raises(InputError, match=r"depth: got .* with a deep file; allowed is none"):
        load_frame(tmp_path / "deep.exr", tmp_path / "deep.exr", lens=LENS)
    with pytest.raises(InputError, match=r"color: got 'a' with a deep file"):
        load_frame(f"{tmp_path}/deep.exr:a", lens=LENS)
    np.save(tmp_path / "color.npy", np.ones((1, 1, 3)))
    with pytest.raises(InputError, match=r"depth: .* is a deep file; allowed is a flat one"):
        load_frame(tmp_path / "color.npy", tmp_path / "deep.exr", lens=LENS)
    exr_files.write_deep(tmp_path / "z.exr", [[[(1.0,)]]], "Z")
    with pytest.raises(InputError, match=r"color: .* has no R, G, B and Z"):
        load_frame(tmp_path / "z.exr", lens=LENS)
    whole = (tmp_path / "deep.exr").read_bytes()
    (tmp_path / "short.exr").write_bytes(whole[:-8])
    with pytest.raises(InputError, match=r"color: cannot read"):
        load_frame(tmp_path / "short.exr", lens=LENS)


def test_nothing_but_background(tmp_path):
    frame = load(tmp_path, [[[gray(0.5, 1, np.inf)], []], [[], []]])
    assert np.isinf(frame.depth).all()
    assert frame.color[..., 0].tolist() == [[0.5, 0.0], [0.0, 0.0]]
    lensblur, scatter = filter_frame(frame, ["lensblur", "scatter"]).rows
    assert not lensblur.image.any()  # for methods of layers, all is before black
    assert scatter.image.any()
