"""`refdof filter`: what `compare` renders, from the files of `export` alone; and every bad word on its line."""

import json
import re

import numpy as np
import pytest
from typer.testing import CliRunner

import refdof
from refdof import InputError, ThinLens, View
from refdof.cli import app
from refdof.export import export_view
from refdof.filtering import filter_frame
from refdof.frame.depth_kinds import DEPTH_KINDS, planar_depth
from refdof.frame.frame import Frame, frame_camera
from refdof.methods._image_validation import as_images, depth_in_range
from refdof.rendering import render_view
from tests.frame import exr_files
from tests.frame.depth_twin import stored_depth

pytestmark = pytest.mark.fast
FILTERS = [name for name, module in refdof.METHODS.items() if module.METHOD.kind == "single image"]
NEAR, FAR = 0.25, 64.0
PLANES = {"device": [NEAR, FAR], "reversed": [NEAR, FAR], "reversed-infinite": [NEAR]}


@pytest.fixture(autouse=True)
def _unwarmed(monkeypatch):
    """Without compiling first: where nothing is compiled, that takes longer than the rest."""
    monkeypatch.setattr("refdof.compare.warm_up", lambda *_: None)
    monkeypatch.setattr("refdof.compare._RUNS", 1)


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    """A view; the folder of its export, where the depth stands in every kind, as float64 and float32; and what each
    filter makes of the scene.
    """
    folder = tmp_path_factory.mktemp("export") / "out"
    scene = refdof.load_scene("fence")
    view = View(scene, scene.camera.with_size((17, 13)), scene.lens)
    export_view(view, folder, [])
    depth = np.load(folder / "depth.npy")
    for kind in DEPTH_KINDS:
        for dtype in (np.float64, np.float32):
            stored = stored_depth(kind, depth, view.camera, NEAR, FAR, dtype)
            np.save(folder / f"{kind}-{np.dtype(dtype).name}.npy", stored)
            if dtype == np.float32:
                exr_files.write(folder / f"{kind}.exr", {"Z": stored})
    return view, folder, {name: render_view(name, view).image for name in FILTERS}


def run(*words):
    """What the command prints; its errors are raised."""
    done = CliRunner().invoke(app, ["filter", *map(str, words)], standalone_mode=False)
    if done.exception is not None:
        raise done.exception
    return done.output


def shot(view):
    camera, lens = view.camera, view.lens
    return ["--fov", camera.fov_y, "--focus", lens.focus_distance, "--lens-radius", lens.radius]


def taken(view):
    """What a single-image method computes with."""
    color, depth, coc = as_images(*view.pinhole(), view.coc_px())
    return color, depth_in_range(np.float32, depth), coc


def planes(kind):
    return [word for pair in zip(["--near", "--far"], PLANES.get(kind, []), strict=False) for word in pair]


@pytest.mark.long
@pytest.mark.parametrize("kind", DEPTH_KINDS)
def test_float64_depth_of_every_kind_gives_the_picture_to_the_bit(exported, tmp_path, kind):
    """Every method gets circles and depths in float32: what float64 rounds on the way there and back is not seen."""
    view, folder, wanted = exported
    words = ["--color", folder / "color.npy", "--depth", folder / f"{kind}-float64.npy", "--depth-kind", kind]
    run(*words, *planes(kind), *shot(view), "--out", tmp_path)
    for name in FILTERS:
        assert np.array_equal(np.load(tmp_path / f"{name}.npy"), wanted[name]), name


@pytest.mark.parametrize("name", ["branches", "cans"])
def test_float64_depth_of_every_kind_gives_methods_the_same_numbers(name):
    """What single-image methods take, on more pixels: circles and depths as float32."""
    scene = refdof.load_scene(name)
    view = View(scene, scene.camera.with_size((40, 30)), scene.lens)
    pinhole, wanted = view.pinhole(), taken(view)
    for kind in DEPTH_KINDS:
        stored = stored_depth(kind, pinhole.depth, view.camera, 0.01, FAR)
        planar = planar_depth(stored, kind, view.camera, *([0.01, FAR][: len(PLANES.get(kind, []))]))
        other = Frame(pinhole.color, planar, frame_camera(view.camera.fov_y, view.camera.size), view.lens).view()
        for found, given in zip(taken(other), wanted, strict=True):
            assert np.array_equal(found, given), kind


@pytest.mark.parametrize("kind", DEPTH_KINDS)
def test_float32_depth_moves_circles_by_its_rounding(exported, kind):
    # A rounding of z is 2^-24 z, of d 2^-25 where it is 0.5 .. 1: dc = P E dz / z^2 and dc = P E dd (1/n - 1/f).
    view, folder, _ = exported
    stored = np.load(folder / f"{kind}-float32.npy")
    planar = planar_depth(stored, kind, view.camera, *PLANES.get(kind, []))
    scale = view.camera.pixels_per_tangent * view.lens.radius
    worst = scale * 2.0**-24 / min(NEAR if kind in PLANES else np.inf, view.pinhole().depth.min())
    moved = np.abs(view.lens.coc_px(planar, view.camera) - view.coc_px()).max()
    assert 0.0 < moved <= worst * (1 + 1e-6)


@pytest.mark.parametrize("kind", ["planar", "radial"])
def test_float32_depth_beside_circles_gives_the_picture_to_the_bit(exported, tmp_path, kind):
    """Methods take the order and ratio of depths from float32: planar ones are what they are."""
    view, folder, wanted = exported
    if kind == "planar":
        words = ["--depth", folder / "planar.exr", "--coc", folder / "coc.npy"]
        run("--color", folder / "color.npy", *words, "--out", tmp_path)
    else:  # from float64
        words = ["--depth", folder / "radial-float64.npy", "--coc", folder / "coc.npy", "--fov", view.camera.fov_y]
        run("--color", folder / "color.npy", *words, "--depth-kind", kind, "--out", tmp_path)
    for name in FILTERS:
        assert np.array_equal(np.load(tmp_path / f"{name}.npy"), wanted[name]), name
    table = json.loads((tmp_path / "table.json").read_text())
    assert (table["lens"], table["camera"], table["reference"]) == (None, {"size": [17, 13]}, None)


def named_images(page):
    """Names of what a report's page can show, in its order."""
    about = re.search(r'<script type="application/json" id="about">(.*?)</script>', page)[1]
    return [image["name"] for image in json.loads(about)["images"]]


def test_table_report_and_overview_without_a_reference(exported, tmp_path):
    view, _, _ = exported
    pinhole = view.pinhole()
    exr_files.write_blender(tmp_path / "frame.exr", pinhole.color, pinhole.depth)
    said = run(
        "--color", tmp_path / "frame.exr", *shot(view), "--methods", "scatter, mipmap", "--out", tmp_path / "out"
    )
    assert said.startswith("### frame, 17 x 13\n\n| method ")
    assert "\nNo reference: methods have no scores.\n" in said
    assert max(map(len, said.splitlines()[:-1])) <= 80
    assert re.search(r"\| mipmap +\| +- \| +- \| +- \| +\d", said)
    names = {path.name for path in (tmp_path / "out").iterdir()}
    pictures = {f"{name}.{kind}" for name in ("pinhole", "scatter", "mipmap") for kind in ("png", "npy")}
    assert names == {*pictures, "table.md", "table.csv", "table.json", "overview.png", "report.html"}
    page = (tmp_path / "out" / "report.html").read_text()
    assert named_images(page) == ["pinhole", "scatter", "mipmap", "depth", "circle of confusion"]
    assert "r reference" not in page
    table = json.loads((tmp_path / "out" / "table.json").read_text())
    assert table["reference"] is None
    assert table["rows"][0]["psnr"] is None
    assert table["command"].startswith("refdof ")


def test_scores_with_a_reference_are_those_of_metrics(exported, tmp_path):
    view, folder, _ = exported
    truth = np.clip(view.pinhole().color * 0.9, 0, 1).astype(np.float32)
    np.save(tmp_path / "truth.npy", truth)
    words = ["--color", folder / "color.npy", "--depth", folder / "depth.npy", *shot(view), "--methods", "scatter"]
    printed = run(*words, "--reference", tmp_path / "truth.npy", "--out", tmp_path / "out", "--json")
    (row,) = json.loads(printed)["rows"]
    wanted = refdof.metrics.scores(truth, render_view("scatter", view).image)
    assert {name: row[name] for name in wanted} == pytest.approx(wanted)
    assert json.loads(printed)["reference"] == {
        "samples": None, "seconds": None, "kept": False, "noise_floor_psnr": None,
    }  # fmt: skip
    assert "made elsewhere, noise unknown." in (tmp_path / "out" / "table.md").read_text()
    page = (tmp_path / "out" / "report.html").read_text()
    assert named_images(page)[:3] == ["reference", "pinhole", "scatter"]
    printed = run(*words, "--out", tmp_path / "wide", "--wide")
    assert printed.count("|") > 30
    assert printed.endswith(f"\nReport: {tmp_path}/wide/report.html; table: {tmp_path}/wide/table.md\n")


def test_f_numbers_by_hand(exported, tmp_path):
    # A sensor of 24 mm under 2 atan(0.5) has a focal length of 24 mm; at f/2 and a unit of 0.1 m that is a radius of
    # 0.006 / 0.1 = 0.06 units.
    _, folder, _ = exported
    angle = 2 * np.degrees(np.arctan(0.5))
    words = ["--color", folder / "color.npy", "--depth", folder / "depth.npy", "--methods", "scatter", "--json"]
    found = run(*words, "--fov", angle, "--focus", 3, "--f-number", 2, "--units", 0.1, "--out", tmp_path)
    lens = json.loads(found)["lens"]
    assert lens["radius"] == pytest.approx(0.06, rel=1e-12)
    assert lens["focus_distance"] == 3.0
    found = run(*words, "--fov", angle, "--focus", "inf", "--f-number", 2, "--sensor", 12, "--out", tmp_path)
    assert json.loads(found)["lens"]["radius"] == pytest.approx(0.003, rel=1e-12)


def test_what_the_frame_says_in_python(exported):
    view, _, _ = exported
    pinhole, camera = view.pinhole(), frame_camera(view.camera.fov_y, view.camera.size)
    frame = refdof.Frame(pinhole.color, pinhole.depth, camera, view.lens)
    found = refdof.filter_frame(frame, ["scatter"], {"scatter": {"order": "far_to_near"}})
    assert np.array_equal(found.rows[0].image, render_view("scatter", view, order="far_to_near").image)
    assert found.standard[0] == "pinhole"
    assert np.isnan(found.noise_floor_psnr)
    with pytest.raises(InputError, match=r"reference: got shape \(1, 1, 3\)"):
        filter_frame(frame, ["scatter"], reference=np.ones((1, 1, 3)))
    with pytest.raises(InputError, match=r"methods: got 'multiview', which needs triangles; allowed on this frame are"):
        filter_frame(frame, ["multiview"])
    tiny = Frame(np.ones((2, 2, 3)), np.ones((2, 2)), frame_camera(40.0, (2, 2)), ThinLens(0.1, 2.0))
    assert len(filter_frame(tiny, ["scatter"]).rows) == 1
    with pytest.raises(InputError, match="size: got 2x2; allowed for scores"):
        filter_frame(tiny, ["scatter"], reference=np.ones((2, 2, 3)))


LENS = ["--fov", 40, "--focus", 3, "--lens-radius", 0.1]
WRONG = [
    ([], "fov: got none; allowed is the vertical field of view"),
    (["--fov", 40], "focus: got none; allowed is the distance in focus"),
    (["--fov", 40, "--focus", 3], "f-number: got neither --lens-radius nor --f-number; allowed is one of the two"),
    ([*LENS, "--f-number", 2], "f-number: got --lens-radius and --f-number; allowed is one of the two"),
    (["--fov", 190, "--focus", 3, "--lens-radius", 1], "fov: got 190; allowed is"),
    (["--fov", 40, "--focus", 0, "--lens-radius", 1], "focus: got 0; allowed is"),
    (["--fov", 40, "--focus", 3, "--lens-radius", -1], "lens-radius: got -1; allowed is"),
    (["--fov", 40, "--focus", 3, "--f-number", 0], "f-number: got 0; allowed is"),
    (["--fov", 40, "--focus", 0.01, "--f-number", 2], "focus: got 0.01; allowed is a distance above the focal length"),
    (["--fov", 40, "--focus", 3, "--f-number", 2, "--units", 0], "units: got '0'; allowed are"),
    (["--fov", 40, "--focus", 3, "--f-number", 2, "--sensor", "nan"], "sensor: got nan; allowed is"),
    ([*LENS, "--depth-kind", "z"], "kind: got 'z'; allowed are planar, radial"),
    ([*LENS, "--depth-kind", "device"], "near: got none; allowed for device"),
    ([*LENS, "--near", 1], "near: got 1 for planar, which has no such plane"),
    ([*LENS, "--depth-kind", "reversed", "--near", 1, "--far", 2], "depth: largest value is"),
    ([*LENS, "--methods", "accumulation"], "methods: got 'accumulation', which needs triangles; allowed on this frame"),
    ([*LENS, "--methods", "scater"], "methods: got 'scater'; did you mean 'scatter'?"),
    ([*LENS, "--reference", "small.npy"], r"reference: got shape \(2, 2, 3\); allowed is"),
    ([*LENS, "--reference", "none.npy"], "reference: got 'none.npy': there is no such file"),
    ([*LENS, "--out", "file"], "out: got 'file', but"),
    ([*LENS, "--set", "order=none"], "set: got"),
    (["--coc", "coc.npy"], r"coc: got shape \(2, 2\); allowed is"),
    (["--coc", "infinite.npy"], "coc: has 1 infinite values"),
    (["--coc", "a.png"], "coc: got 'a.png', whose numbers have no unit"),
    (["--coc", "coc.npy", "--depth-kind", "radial"], "fov: got none"),
]  # fmt: skip


@pytest.mark.parametrize(("words", "said"), WRONG, ids=lambda part: str(part)[:50])
def test_bad_words_are_one_line(exported, tmp_path, monkeypatch, words, said):
    _, folder, _ = exported
    monkeypatch.chdir(tmp_path)
    np.save("small.npy", np.ones((2, 2, 3)))
    np.save("coc.npy", np.ones((2, 2)))
    circles = np.ones((13, 17))
    circles[0, 0] = np.inf
    np.save("infinite.npy", circles)
    (tmp_path / "file").write_text("")
    with pytest.raises(InputError, match=f"^{said}") as caught:
        run("--color", folder / "color.npy", "--depth", folder / "depth.npy", *words)
    assert len(str(caught.value).splitlines()) == 1
    assert not (tmp_path / "out").exists()
