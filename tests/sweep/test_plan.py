"""What a sweep measures."""

import pickle

import numpy as np
import pytest

from refdof import METHODS, InputError
from refdof.optics.systems.prescription import load_lens
from refdof.optics.systems.system_lens import SystemLens
from refdof.rendering import make_params
from refdof.sweep import Axis, axis_of, jobs_of, shots_of
from refdof.view import View
from tests.sweep.points import small_view

pytestmark = pytest.mark.fast


def test_axis():
    assert axis_of("samples=4, 8,16") == Axis("samples", (4, 8, 16))
    assert axis_of("deferred=true,false") == Axis("deferred", (True, False))
    assert axis_of("lens-radius=0.5,1e-3") == Axis("lens_radius", (0.5, 0.001))
    assert axis_of("size=8x8,16x12") == Axis("size", ("8x8", "16x12"))


@pytest.mark.parametrize("text", ["samples", "samples=", "=4", "samples=4,,8", "samples= ", ""])
def test_bad_axis(text):
    with pytest.raises(InputError, match=r"vary: got .*; allowed is KEY=VALUE,VALUE"):
        axis_of(text)


def test_axis_of_too_many_values():
    with pytest.raises(InputError, match="vary: got 257 values of samples; allowed are at most 256"):
        axis_of("samples=" + ",".join(str(k) for k in range(1, 258)))


def test_every_tradeoff_is_allowed_and_differs():
    for name, module in METHODS.items():
        if module.METHOD.tradeoff is not None:
            key, values = module.METHOD.tradeoff
            params = [make_params(name, {key: value}) for value in values]
            assert len(set(map(repr, params))) == len(values) > 1, name


def test_combinations():
    jobs = jobs_of(["lensblur"], [axis_of("samples=4,8"), axis_of("layers=1,2,3")], {"lensblur": {"filter": "nearest"}})
    assert [(job.params.samples, job.params.layers, job.params.filter) for job in jobs] == [
        (samples, layers, "nearest") for samples in (4, 8) for layers in (1, 2, 3)
    ]
    assert all(job.varied == ("samples", "layers") for job in jobs)


def test_a_method_takes_its_own_tradeoff_unless_its_parameter_is_named_or_set():
    jobs = jobs_of(["mipmap", "separable", "pyramidal"], [axis_of("largest_side=2,4"), axis_of("size=16x12,32x24")])
    assert [(job.method, dict(job.settings)) for job in jobs] == [
        *(("mipmap", {"foreground_points": count}) for count in (0, 5, 9)),
        ("separable", {}),
        ("pyramidal", {"largest_side": 2}),
        ("pyramidal", {"largest_side": 4}),
    ]
    fixed = jobs_of(["mipmap"], [], {"mipmap": {"foreground_points": 5}})
    assert [(dict(job.settings), job.varied) for job in fixed] == [({"foreground_points": 5}, ())]


def test_equal_settings_are_one_job():
    assert len(jobs_of(["lensblur"], [axis_of("samples=8,8,16")])) == 2


@pytest.mark.parametrize(
    ("axes", "fixed", "says"),
    [
        (["sample=4"], {}, "parameter of lensblur: got 'sample'; did you mean 'samples'"),
        (["samples=4", "samples=8"], {}, "vary: got samples twice; allowed is once"),
        (["samples=0"], {}, "samples: got 0"),
        (["samples=4,8"], {"lensblur": {"samples": 4}}, "set: got lensblur.samples, which --vary names"),
        (["samples=" + ",".join(map(str, range(1, 201))), "layers=" + ",".join(map(str, range(0, 51)))], {}, "10000"),
    ],
)
def test_bad_jobs(axes, fixed, says):
    with pytest.raises(InputError, match=says):
        jobs_of(["lensblur"], [axis_of(text) for text in axes], fixed)


def test_shots():
    shots = shots_of(small_view(), [axis_of("size=16x12,32x24"), axis_of("samples=4"), axis_of("focus=1,2")])
    assert [(shot.view.camera.size, shot.view.lens.focus_distance) for shot in shots] == [
        ((16, 12), 1.0),
        ((16, 12), 2.0),
        ((32, 24), 1.0),
        ((32, 24), 2.0),
    ]
    assert shots[1].name == "triangle size=16x12 focus=2"
    assert shots_of(small_view(), [axis_of("lens_radius=0,0.5")])[1].view.lens.radius == 0.5


def test_bad_shots():
    for text, says in {
        "size=16": "size: got '16'; allowed is WIDTHxHEIGHT",
        "focus=-1": "vary: focus: got -1",
        "lens_radius=wide": "vary: lens_radius: got",
    }.items():
        with pytest.raises(InputError, match=says):
            shots_of(small_view(), [axis_of(text)])
    view = small_view()
    real = View(view.scene, view.camera, SystemLens(load_lens("double_gauss"), 2.0, None, 100.0))
    with pytest.raises(InputError, match="vary: got focus with a lens that sets it"):
        shots_of(real, [axis_of("focus=1,2")])


def test_a_shot_travels_without_products():
    (shot,) = shots_of(small_view(), [])
    shot.view.tracer()
    shot.image = np.zeros((12, 16, 3), dtype=np.float32)
    other = pickle.loads(pickle.dumps(shot))
    assert not other.view._products
    np.testing.assert_array_equal(other.view.pinhole().color, shot.view.pinhole().color)
    np.testing.assert_array_equal(other.image, shot.image)
