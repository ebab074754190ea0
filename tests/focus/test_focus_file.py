"""focus.toml: written and read again, its schema, and what is wrong said in one line."""

import json
import tomllib
from importlib.resources import files

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st

from refdof import InputError
from refdof.focus.focus_file import focus_text, load_focus, parse_focus, save_focus
from refdof.focus.focus_lens import KINDS, Focus
from refdof.focus.point import FocusPoint

pytestmark = pytest.mark.fast

SCHEMA = json.loads(files("refdof.focus").joinpath("focus.schema.json").read_text())
POINT = "[[point]]\ntriangle = 3\nbarycentrics = [0.2, 0.3, 0.5]\n"
VALUES = st.floats(0.0, 1.0)
KEYED = VALUES | st.lists(
    st.tuples(st.integers(0, 99), VALUES), min_size=1, max_size=4, unique_by=lambda key: key[0]
).map(lambda keys: tuple(sorted(keys)))
RADII = st.integers(0, 1000).map(lambda k: k / 1000)  # controls are not as close as floats can be
CONTROLS = st.lists(st.tuples(RADII, st.floats(1e-3, 9.0)), min_size=1, max_size=4, unique_by=lambda key: key[0]).map(
    lambda keys: tuple(sorted(keys))
)
POINTS = st.builds(
    FocusPoint,
    st.integers(0, 10**6),
    st.tuples(VALUES, VALUES, st.floats(0.1, 1.0)),
    offset=KEYED,
    aperture=KEYED,
    weight=KEYED,
    falloff=st.floats(1.0, 8.0),
    image_offset=KEYED,
    keep=st.booleans(),
    name=st.text(max_size=9).filter(lambda text: text.isprintable()),
)


@given(
    st.builds(
        Focus,
        st.lists(POINTS, min_size=1, max_size=3).map(tuple),
        st.sampled_from(KINDS),
        st.none() | st.floats(1e-3, 9),
        st.just(()) | CONTROLS,
        st.just(()) | CONTROLS,
    )
)
def test_a_file_reads_back_as_itself_and_fits_the_schema(focus):
    text = focus_text(focus)
    again = parse_focus("focus.toml", text)
    assert focus_text(again) == text
    assert [point.triangle for point in again.points] == [point.triangle for point in focus.points]
    assert (again.kind, again.power, again.ray_weights) == (focus.kind, focus.power, focus.ray_weights)
    assert [point.image_offset for point in again.points] == [point.image_offset for point in focus.points]
    jsonschema.validate(tomllib.loads(text), SCHEMA)


def test_files_on_disk(tmp_path):
    focus = Focus((FocusPoint(3, (0.25, 0.25, 0.5), weight=((0, 1.0), (24, 0.0)), name='a "statue"'),), "plane", 0.05)
    save_focus(tmp_path / "focus.toml", focus)
    assert load_focus(tmp_path / "focus.toml") == focus
    with pytest.raises(InputError, match=r"focus-points: got '.*none\.toml': there is no such file; allowed is a file"):
        load_focus(tmp_path / "none.toml")
    (tmp_path / "bytes.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match=r"bytes\.toml: is no text in UTF-8"):
        load_focus(tmp_path / "bytes.toml")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "focus.toml: point: missing; needed are point"),
        ("point = 3", "focus.toml: point: got no tables; allowed are tables [[point]]"),
        ("point = []", "focus.toml: points: got 0; allowed are 1 to 256"),
        ("kind = ", "focus.toml: got Invalid value"),
        (POINT + "wieght = 1", "focus.toml: point 1: 'wieght': unknown; did you mean 'weight'? allowed are triangle"),
        ("[[point]]\ntriangle = 3", "focus.toml: point 1: barycentrics: missing"),
        (POINT + POINT.replace("3\n", "-3\n", 1), "focus.toml: point 2: triangle: got -3"),
        (POINT + "weight = [[0, 1], [1e-300, 2]]", "focus.toml: point 1: weight: frames of keyframes are too close"),
        (POINT + "weight = [[-1e300, 1], [1, 2]]", "focus.toml: point 1: weight: frames of keyframes are beyond 1e+06"),
        (POINT + "offset = [[0, 1e308], [1, -1e308]]", "focus.toml: point 1: offset: got 1e+308"),
        (POINT + "weight = [[0, 1], [0, 2]]", "focus.toml: point 1: weight: frames of keyframes do not grow"),
        (POINT + "keep = 1", "focus.toml: point 1: keep: got 1"),
        (POINT + "name = 1", "focus.toml: point 1: name: got int; allowed is text"),
        ("kind = 'tilt'\n" + POINT, "focus.toml: kind: got 'tilt'"),
        ("focal_length = 0\n" + POINT, "focus.toml: focal_length: got 0"),
        ("power = [1.0, 1.02]\n" + POINT, "focus.toml: power: got shape (2,)"),
        ("power = []\n" + POINT, "focus.toml: power: got shape (0,)"),
        ("power = [[0, 1], [2, 1]]\n" + POINT, "focus.toml: power: radii: largest value is 2"),
        ("power = [[0, 0]]\n" + POINT, "focus.toml: power: got 0; allowed is a finite number >= 0.001"),
        ("ray_weights = [[1, 1], [0, 1]]\n" + POINT, "focus.toml: ray_weights: radii of controls do not grow"),
        ("ray_weights = [[0, 0], [1, 0]]\n" + POINT, "focus.toml: ray_weights: all are 0"),
        (POINT + "image_offset = nan", "focus.toml: point 1: image_offset: got nan"),
        ("a = " + "[" * 5000, "focus.toml: "),
    ],
)
def test_what_is_wrong_is_said_in_one_line(text, message):
    with pytest.raises(InputError) as told:
        parse_focus("focus.toml", text)
    assert str(told.value).startswith(message)
    assert len(str(told.value).splitlines()) == 1
