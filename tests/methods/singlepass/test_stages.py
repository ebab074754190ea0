"""Stages of the single pass: against the naive loop, step by step, and by hand."""

import numpy as np
import pytest

import refdof
from refdof import InputError, Stages
from refdof.methods import singlepass
from refdof.methods.singlepass import Params, blur, spiral
from tests.methods.singlepass import naive
from tests.methods.singlepass.test_params import circle_of, picture

pytestmark = pytest.mark.fast

SHORT = {"loop_bound": 6.0}
STEPS = (0, 1, 5, 20)
PIXELS = ((0, 0), (10, 7), (4, 3))
USES = [
    {},
    {"depth_filter": "bilinear"},
    {"depth_filter": "bilinear_depth"},
    {"color_filter": "nearest", "row_order": "up", "shift_x": 0.25, "scale_y": 0.75, "border": "repeat"},
    {"depth_filter": "bilinear", "order": "size"},
    {"depth_filter": "bilinear_depth", "order": "always", "shift_y": 0.5},
    {"behind_factor": 0.5, "precision": "float32", "max_taps": 25},
]


@pytest.fixture(params=USES, ids=lambda use: ",".join(f"{k}={v}" for k, v in use.items()) or "defaults")
def run(request):
    """Picture, what is changed, and what was recorded."""
    images, use = picture(), {**SHORT, **request.param}
    return images, use, blur(*images, Params(**use), stages=Stages(STEPS, PIXELS))


def steps_of(images, use, x, y):
    others = {name: value for name, value in use.items() if name != "depth_filter"}
    return naive.taps_at(x, y, *images, use.get("depth_filter", "nearest"), circle_of, **others)


def test_every_stage_is_the_naive_loops(run):
    images, use, (image, stages) = run
    assert np.array_equal(image, blur(*images, Params(**use)))
    at = {pixel: steps_of(images, use, *pixel) for pixel in PIXELS}
    for (x, y), steps in at.items():
        # "bilinear_depth" fits its line: see test_params.
        tolerance = {"rtol": 0, "atol": 1e-12 if use.get("depth_filter") == "bilinear_depth" else 0}
        for k in STEPS:
            np.testing.assert_allclose(
                stages[f"mean {k}"][y, x], steps[k]["total_color"] / steps[k]["total"], **tolerance
            )
            if k > 0:
                np.testing.assert_allclose(stages[f"reach {k}"][y, x], steps[k]["reach"], **tolerance)
                np.testing.assert_allclose(stages[f"weight {k}"][y, x], steps[k]["weight"], **tolerance)
        # Sums of at most 36 weights, in another order.
        np.testing.assert_allclose(stages["weight_sum"][y, x], sum(s["weight"] for s in steps[1:]), rtol=0, atol=1e-12)
    assert "reach 0" not in stages


def test_every_row_of_a_probe_is_the_naive_loops(run):
    images, use, (image, stages) = run
    columns = next(stage for stage in singlepass.METHOD.stages if stage.name == "probes").columns
    for table, (x, y) in zip(stages["probes"], PIXELS, strict=True):
        row = dict(zip(columns, table.T, strict=True))
        steps = steps_of(images, use, x, y)
        assert len(table) == len(steps)
        # Places are sums of a few numbers below 20; sizes of "bilinear_depth" as in test_params.
        same = {"rtol": 0, "atol": 1e-12}
        for name in ("x", "y", "size", "reach", "weight", "total"):
            np.testing.assert_allclose(row[name][1:], [s[name] for s in steps[1:]], **same)
        sign = -1.0 if use.get("depth_filter") == "bilinear" else 1.0
        depth = np.array([s["depth"] for s in steps[1:]])
        np.testing.assert_allclose(row["depth"][1:], sign / depth if sign < 0 else depth, rtol=1e-13)
        for k, channel in enumerate(("red", "green", "blue")):
            np.testing.assert_allclose(row[channel][1:], [s["color"][k] for s in steps[1:]], **same)
            np.testing.assert_allclose(row[f"sum_{channel}"], [s["total_color"][k] for s in steps], **same)
        assert row["total"][0] == row["weight"][0] == 1.0
        assert np.array_equal(table[-1, -4:-1] / table[-1, -1], image[y, x])


def test_a_mean_after_some_taps_is_a_port_with_a_lower_bound():
    images = picture()
    radius = spiral()[:, 2]
    stages = blur(*images, stages=Stages((12,))).stages
    assert np.array_equal(stages["mean 12"], blur(*images, Params(loop_bound=(radius[11] + radius[12]) / 2)))
    assert np.array_equal(stages["mean 12"], blur(*images, Params(max_taps=12)))


def test_what_is_recorded_is_what_is_declared():
    images = picture(np.float32)
    height, width = images[1].shape
    sides = {"H": height, "W": width, "N": 398, "N+1": 399, "P": 2}
    stages = blur(*images, stages=Stages((1, 398), ((0, 0), (1, 1)))).stages
    declared = singlepass.METHOD.stages
    for name, stage in stages.items():
        (one,) = [s for s in declared if s.names(name)]
        assert stage.shape == tuple(sides[word] if word in sides else int(word) for word in one.axes.split())
        assert not one.columns or len(one.columns) == stage.shape[-1]
    assert all(any(s.names(name) for name in stages) for s in declared)
    always = blur(*images, stages=True).stages
    assert set(always) == {"coc", "size", "limit", "taps", "weight_sum"}


def test_stages_by_hand():
    # Three texels in a row; the middle one is sharp enough to hold back the far right one: 0.25 px, times 2.
    color = np.zeros((1, 3, 3))
    color[0, 2] = 1.0
    depth, coc = np.array([[1.0, 1.0, 5.0]]), np.array([[-3.0, 0.25, 7.0]])
    stages = blur(color, depth, coc, stages=Stages((1,), ((1, 0),))).stages
    assert stages["limit"].tolist() == [[6.0, 0.5, 14.0]]
    assert stages["size"].tolist() == [[3.0, 0.25, 7.0]]
    assert stages["reach 1"][0, 1] == 0.5  # min(7, 0.5)
    assert stages["weight 1"][0, 1] == 0.5  # smoothstep(0, 1, 0.5)
    # 0 + mix(0 / 1, 1/2, 1/2), over 2.
    assert stages["mean 1"][0, 1].tolist() == [0.125] * 3
    #                          x    y    depth  colour           size reach weight sum             total
    assert stages["probes"][0, 1].tolist() == [2.0, 0.5, 5.0, 0.5, 0.5, 0.5, 7.0, 0.5, 0.5, 0.25, 0.25, 0.25, 2.0]


def test_render_shows_depth_in_the_scenes_unit():
    scene = refdof.load_scene("branches")
    camera = scene.camera.with_size((12, 9))
    result = refdof.render("singlepass", scene, camera, stages=Stages(pixels=((5, 4),)), max_taps=3)
    depth = refdof.View(scene, camera, scene.lens).pinhole().depth
    assert result.stages["probes"][0, 0, 2] == depth[4, 5]
    assert result.stages["probes"].shape == (1, 4, 13)


def test_background_in_probes_is_infinite():
    color, depth, _ = picture()
    depth[:, 4:] = np.inf
    for depth_filter in ("nearest", "bilinear", "bilinear_depth"):
        probes = blur(color, depth, circle_of(depth), Params(depth_filter), stages=Stages(pixels=((5, 3),))).stages
        assert np.isinf(probes["probes"][0, 0, 2])
        assert np.isfinite(probes["probes"][0, :, 3:]).all()


@pytest.mark.parametrize(
    ("wanted", "words"),
    [
        (Stages((399,)), r"steps: got 399; allowed are 0 \.\. 398"),
        (Stages(pixels=((11, 0),)), r"pixels: got \(11, 0\); allowed are pixels of 11 x 8"),
        (1, "stages: got a int; allowed are True, False and a refdof.Stages"),
    ],
)
def test_what_cannot_be_recorded_is_named(wanted, words):
    with pytest.raises(InputError, match=f"^{words}"):
        blur(*picture(), stages=wanted)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"steps": 3}, "steps: got a int; allowed is a list"),
        ({"steps": (-1,)}, "steps: got -1"),
        ({"pixels": (1, 2)}, "pixels: got 1"),
        ({"pixels": ((0, 0),) * 17}, "pixels: got 17; allowed are at most 16"),
    ],
)
def test_bad_wishes_are_named(values, words):
    with pytest.raises(InputError, match=f"^{words}"):
        Stages(**values)
