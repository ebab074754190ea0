"""The JSON Schemas take what is written, and refuse documents that are broken."""

import copy
import json
from pathlib import Path

import numpy as np
import pytest
from jsonschema import Draft202012Validator

import refdof.oracle
from refdof.oracle import Plan, check
from tests.oracle.small_pack import CASES, of_case, staged_port, stages_of

pytestmark = pytest.mark.fast

FOLDER = Path(refdof.oracle.__file__).parent / "schemas"
KINDS = ("manifest", "case", "conventions", "check")


def validator(kind):
    schema = json.loads((FOLDER / f"{kind}.schema.json").read_text())
    Draft202012Validator.check_schema(schema)
    assert schema["$schema"] == "https://json-schema.org/draft/2020-12/schema"
    return Draft202012Validator(schema)


@pytest.fixture(scope="module")
def documents(pack):
    """A written document of each kind; the report has own, inherited and unknown causes, NaN, and an error."""

    def function(color, depth, coc, params):
        if depth.shape == (18, 24):
            return staged_port(color, depth, coc, params, {"coc": lambda s: 2 * s})
        if params["row_order"] == "up":
            return staged_port(color, depth, coc, params, {"coc": lambda s: np.full_like(s, np.nan)})
        raise ValueError

    report = check(of_case(function, stages_of), pack, plan=Plan())
    return {
        "manifest": json.loads((pack / "manifest.json").read_text()),
        "case": json.loads((pack / "cases" / "cards" / "case.json").read_text()),
        "conventions": json.loads((pack / "conventions.json").read_text()),
        "check": json.loads(json.dumps(report.as_json(), allow_nan=False)),
    }


@pytest.mark.parametrize("kind", KINDS)
def test_what_is_written_is_valid(documents, kind):
    assert list(validator(kind).iter_errors(documents[kind])) == []


def test_all_cases_are_valid(pack):
    for case in CASES:
        about = json.loads((pack / "cases" / case.name / "case.json").read_text())
        assert list(validator("case").iter_errors(about)) == []


def test_packs_hold_the_schemas(pack):
    for kind in KINDS:
        name = f"{kind}.schema.json"
        assert (pack / "schemas" / name).read_bytes() == (FOLDER / name).read_bytes()
    assert len(list((pack / "schemas").iterdir())) == len(KINDS)


GONE = object()
BROKEN = [
    *[("manifest", key, GONE) for key in ("schema", "refdof", "level", "cases", "files")],
    ("manifest", "schema", "refdof-pack-2"),
    ("manifest", "cases", []),
    ("manifest", "cases", ["cards", "cards"]),
    ("manifest", "cases", ["../cards"]),
    ("manifest", "files", {"../x": "0" * 64}),
    ("manifest", "files", {"/x": "0" * 64}),
    ("manifest", "files", {"a/../../x": "0" * 64}),
    ("manifest", "files", {"a\\b": "0" * 64}),
    ("manifest", "files", {"README.md": "0" * 63}),
    ("manifest", "files", {"README.md": 7}),
    *[("case", key, GONE) for key in ("schema", "name", "method", "input", "size", "rows", "params", "lens", "tags")],
    *[("case", key, GONE) for key in ("inputs", "expected", "expected.image", "expected.stages", "inputs.coc")],
    ("case", "size", [24]),
    ("case", "size", [24, 0]),
    ("case", "size", [24, 18.5]),
    ("case", "rows", "bottom"),
    ("case", "lens.focus", 0.0),
    ("case", "inputs.color.npy", "../color.npy"),
    ("case", "inputs.color.raw", "/dev/zero"),
    ("case", "inputs.color.shape", [18, 24, 3, 1]),
    ("case", "expected.image.low", GONE),
    ("case", "expected.image.tolerance", GONE),
    ("case", "expected.image.tolerance.reason", ""),
    ("case", "expected.image.tolerance.max_abs", -1),
    ("case", "expected.image.tolerance.max_failing_fraction", 1.5),
    ("case", "expected.image.tolerance.nan", "ignore"),
    ("case", "expected.image.tolerance.maxabs", 1.0),
    ("case", "expected.stages.size.meaning", GONE),
    ("case", "tags", "cards"),
    *[("conventions", key, GONE) for key in ("axis_y", "coc_unit", "depth_empty_value", "pixel_centre")],
    ("conventions", "coc_unit", "px_diameter"),
    ("conventions", "depth_empty_value", 0),
    ("conventions", "byte_order", "big"),
    ("conventions", "raw", ""),
    *[("check", key, GONE) for key in ("schema", "passed", "counts", "warnings", "cases")],
    ("check", "passed", 1),
    ("check", "counts", {"passed": 1}),
    ("check", "cases.0.status", "failed"),
    ("check", "cases.0.first_wrong", GONE),
    ("check", "cases.0.parts.coc.cause", "foreign"),
    ("check", "cases.0.parts.coc.isolated", GONE),
    ("check", "cases.0.parts.coc.cumulative", None),
    ("check", "cases.0.parts.coc.cumulative.pixel", [1]),
    ("check", "cases.0.parts.coc.cumulative.worst", "nan"),
    ("check", "cases.0.parts.coc.cumulative.more", 1),
]


@pytest.mark.parametrize(("kind", "path", "value"), BROKEN)
def test_a_broken_document_is_refused(documents, kind, path, value):
    document = copy.deepcopy(documents[kind])
    *keys, last = path.split(".")
    part = document
    for key in keys:
        part = part[int(key) if isinstance(part, list) else key]
    if value is GONE:
        del part[last]
    else:
        part[last] = value
    assert not validator(kind).is_valid(document)
