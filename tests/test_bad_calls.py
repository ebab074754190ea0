"""Bad calls: every public door times every argument times values that do not belong there.

A call succeeds, or raises exactly `InputError` with one line that begins with the argument's name. Warnings are errors.
"""

import re
import warnings
from dataclasses import fields, is_dataclass

import numpy as np
import pytest

from refdof import InputError
from refdof.image.file import save_image
from tests.bad_calls import DOORS, INNER, SCALARS, THINGS, arguments_of, public_names, variants

pytestmark = pytest.mark.fast

CASES = [(name, argument) for name, door in DOORS.items() for argument in door.base]


@pytest.fixture(autouse=True)
def _files(tmp_path, monkeypatch):
    """A folder with a picture, its depth and a mesh, so that paths in the table are valid."""
    monkeypatch.chdir(tmp_path)
    save_image("picture.npy", np.full((2, 2, 3), 0.5))
    np.save("depth.npy", np.full((2, 2), 2.0))
    (tmp_path / "triangle.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")


def test_every_public_name_is_in_the_table():
    found = public_names()
    assert set(found) - set(DOORS) - INNER == set()
    assert set(DOORS) - set(found) == set()
    for name, thing in found.items():
        if name in DOORS:
            words = {f.name for f in fields(thing) if f.init} if is_dataclass(thing) else arguments_of(thing)
            assert set(words) == set(DOORS[name].base), name


@pytest.mark.parametrize("name", DOORS)
def test_the_valid_call_succeeds(name):
    door = DOORS[name]
    check_result(door.call(**door.base), door.any_result)


@pytest.mark.parametrize(("name", "argument"), CASES, ids=[f"{n}-{a}" for n, a in CASES])
def test_bad_values_are_refused_in_one_line_or_do_no_harm(name, argument):
    door, faults = DOORS[name], []
    for value in [*SCALARS, *THINGS, *variants(door.base[argument])]:
        if argument in ("progress", "function") and callable(value):
            continue  # what a function of the caller's raises is the caller's
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error")
                check_result(door.call(**(door.base | {argument: value})), door.any_result)
        except InputError as error:
            starts = (argument, *door.says.get(argument, ()))
            if (
                not re.match(rf"({'|'.join(map(re.escape, starts))})\b", str(error))
                or len(str(error).splitlines()) != 1
            ):
                faults.append(f"{shown(value)}: {error}")
        except Exception as error:
            faults.append(f"{shown(value)}: {type(error).__name__}: {error}")
    assert not faults, "\n".join(faults)


def check_result(result, anything):
    """Numbers that come out are finite, unless it is documented that they may not be."""
    if isinstance(result, np.ndarray) and result.dtype.kind == "f":
        assert anything or np.isfinite(result).all(), "result is not finite"
    elif isinstance(result, float):
        assert anything or np.isfinite(result), "result is not finite"
    elif isinstance(result, dict):
        for value in result.values():
            check_result(value, anything)
    elif isinstance(result, list | tuple):
        for value in result:
            check_result(value, anything)
    elif is_dataclass(result) and type(result).__name__ in ("Result", "Reference"):
        check_result(result.image, False)
        check_result([getattr(result, field.name) for field in fields(result)], anything)


def shown(value):
    words = " ".join(repr(value).split())
    return f"{type(value).__name__} {words[:90]}"
