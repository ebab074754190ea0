"""Export: the files alone give the picture, to a program that has nothing but them."""

import json

import numpy as np
import pytest

import refdof
from refdof import InputError, Stages, View
from refdof.export import export_view, with_declared_stages
from tests.methods.singlepass import naive

pytestmark = pytest.mark.fast


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    folder = tmp_path_factory.mktemp("export") / "out"
    scene = refdof.load_scene("branches")
    view = View(scene, scene.camera.with_size((17, 13)), scene.lens)
    wanted = Stages((4,), ((3, 7), (16, 0)))
    export_view(view, folder, ["singlepass"], {"singlepass": {"loop_bound": 6.0, "row_order": "up"}}, 3, wanted)
    return view, folder


def read(folder, name):
    """An array by its raw file and the index, as a program in C would."""
    entry = json.loads((folder / "arrays.json").read_text())["arrays"][name]
    kind = {"float32": "<f4", "int32": "<i4"}[entry["raw_type"]]
    return np.frombuffer((folder / entry["raw"]).read_bytes(), dtype=kind).reshape(entry["shape"])


def test_the_naive_loop_makes_the_picture_and_its_stages_of_the_files(exported):
    _, folder = exported
    images = [read(folder, name) for name in ("color", "depth", "coc")]
    params = json.loads((folder / "arrays.json").read_text())["methods"]["singlepass"]["params"]
    assert np.array_equal(read(folder, "singlepass/coc"), images[2])
    changes = {name: value for name, value in params.items() if name != "depth_filter"}
    for table, (x, y) in zip(read(folder, "singlepass/probes"), ((3, 7), (16, 0)), strict=True):
        steps = naive.taps_at(x, y, *images, params["depth_filter"], **changes)
        mean = steps[-1]["total_color"] / steps[-1]["total"]
        assert np.array_equal(read(folder, "singlepass/image")[y, x], mean)
        assert np.array_equal(read(folder, "singlepass/mean_4")[y, x], steps[4]["total_color"] / steps[4]["total"])
        assert np.array_equal(table[1:, 8], [step["weight"] for step in steps[1:]])


def test_circles_and_layers_by_hand(exported):
    view, folder = exported
    index = json.loads((folder / "arrays.json").read_text())
    lens, scale = index["lens"], index["camera"]["pixels_per_tangent"]
    for depth, coc in (("depth", "coc"), ("layer_depth", "layer_coc")):
        with np.errstate(divide="ignore"):
            expected = scale * lens["radius"] * (1.0 / lens["focus_distance"] - 1.0 / read(folder, depth))
        np.testing.assert_allclose(read(folder, coc), expected, rtol=0, atol=1e-4)  # float32 of depths near 1
    hit = read(folder, "layer_triangle")[0] >= 0
    assert hit.any()
    assert np.array_equal(read(folder, "layer_color")[0][hit], read(folder, "color")[hit])
    assert np.array_equal(read(folder, "layer_depth")[0], read(folder, "depth"))
    assert np.array_equal(np.load(folder / "color.npy"), view.pinhole().color)


def test_every_array_is_listed_and_every_listed_one_is_there(exported):
    _, folder = exported
    listed = json.loads((folder / "arrays.json").read_text())["arrays"].values()
    files = {path.relative_to(folder).as_posix() for path in folder.rglob("*.*")}
    assert files == {name for entry in listed for name in (entry["npy"], entry["raw"])} | {"arrays.json"}
    for entry in listed:
        assert np.load(folder / entry["npy"]).shape == tuple(entry["shape"])
        assert len(entry["axes"].split()) == len(entry["shape"])


def test_bad_values_are_named_before_anything_is_drawn(tmp_path):
    scene = refdof.load_scene("branches")
    view = View(scene, scene.camera, scene.lens)
    with pytest.raises(InputError, match=r"^methods: got 'singlepas'"):
        export_view(view, tmp_path, ["singlepas"])
    with pytest.raises(InputError, match=r"^rad_scale: got 0"):
        export_view(view, tmp_path, ["singlepass"], {"singlepass": {"rad_scale": 0}})
    with pytest.raises(InputError, match=r"^layers: got 0"):
        export_view(view, tmp_path, ["singlepass"], layers=0)
    assert not list(tmp_path.iterdir())
    assert "singlepass" in with_declared_stages()
