"""A page's state: what is read is what was written, and every fault is one line that names it."""

import copy
import json
import math

import pytest

from refdof import InputError
from refdof.studio.state import parse_state, state_as_json
from tests.studio import flat

pytestmark = pytest.mark.fast

POINT = {"triangle": 1, "barycentrics": [0.5, 0.25, 0.25], "weight": [[0, 1.0], [24, 0.5]], "name": "a"}


def test_json_and_back():
    raw = flat.state(7, points=[POINT], overlay="coc", lens_focus=None, frame=2.5)
    state = parse_state(raw)
    assert math.isinf(state.lens.focus)
    assert state.points[0].value("weight", 24) == 0.5
    again = json.loads(json.dumps(state_as_json(state), allow_nan=False))
    assert parse_state(again) == state
    assert again["lens"] == raw["lens"]


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        (["method"], "blurr", "method: got 'blurr'"),
        (["overlay"], 3, "overlay"),
        (["id"], -1, "id: got -1"),
        (["id"], 1e300, "id"),
        (["size"], [0, 5], "size"),
        (["size"], [8000, 8000], "size: got 8000x8000; allowed are at most"),
        (["size"], "64x48", "size"),
        (["camera"], [], "camera: got list"),
        (["camera", "eye"], [0, 0], "eye"),
        (["camera", "eye"], [0, 0, math.nan], "eye"),
        (["camera", "target"], [0, 0, 0], "target"),
        (["camera", "fov_y"], 181, "fov_y"),
        (["camera", "fov_y"], "wide", "fov_y"),
        (["lens", "kind"], "fish", "kind: got 'fish'"),
        (["lens", "radius"], -0.1, "radius"),
        (["lens", "radius"], math.inf, "radius"),
        (["lens", "focus"], 0, "focus"),
        (["lens", "file"], {}, "file: got dict"),
        (["lens", "f_number"], 0, "f_number"),
        (["points"], {}, "points: got dict"),
        (["points"], [POINT] * 257, "points"),
        (["points"], [{**POINT, "weigth": 1}], "point 1: 'weigth': unknown; did you mean 'weight'"),
        (["points"], [POINT, {"triangle": 0}], "point 2: barycentrics: missing"),
        (["points"], [{**POINT, "offset": [[1, 0], [0, 1]]}], "point 1: offset"),
        (["frame"], math.nan, "frame"),
        (["moving"], 1, "moving"),
        (["extra"], 1, "state: 'extra': unknown"),
    ],
)
def test_faults_are_named(path, value, words):
    raw = copy.deepcopy(flat.state())
    place = raw
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    with pytest.raises(InputError) as caught:
        parse_state(raw)
    assert words in str(caught.value)
    assert len(str(caught.value)) < 500


@pytest.mark.parametrize("raw", [None, 3, [], "state", {}, {1: 2}])
def test_what_is_no_state_is_refused(raw):
    with pytest.raises(InputError, match="state"):
        parse_state(raw)
