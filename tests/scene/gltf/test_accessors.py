"""Accessors of every type, component, stride and normalisation, sparse or not, against a reader by struct."""

import struct

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from refdof import InputError
from refdof.scene.gltf.file import GltfFile, Numbers
from refdof.scene.limits import Limits, Meter

pytestmark = pytest.mark.fast
CODES = {5120: "b", 5121: "B", 5122: "h", 5123: "H", 5125: "I", 5126: "f"}
MOST = {5120: 127, 5121: 255, 5122: 32767, 5123: 65535, 5125: 4294967295}
COLUMNS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}


def by_struct(data, accessor, views):
    """The rows of an accessor, number by number, as the specification has them."""
    code, columns = CODES[accessor["componentType"]], COLUMNS[accessor["type"]]

    def rows(place, code, columns, count):
        view = views[place["bufferView"]]
        start = view.get("byteOffset", 0) + place.get("byteOffset", 0)
        size = struct.calcsize("<" + code)
        step = view.get("byteStride", size * columns)
        return [
            [struct.unpack_from("<" + code, data, start + k * step + c * size)[0] for c in range(columns)]
            for k in range(count)
        ]

    count = accessor["count"]
    found = rows(accessor, code, columns, count) if "bufferView" in accessor else [[0] * columns for _ in range(count)]
    if "sparse" in accessor:
        sparse = accessor["sparse"]
        where = rows(sparse["indices"], CODES[sparse["indices"]["componentType"]], 1, sparse["count"])
        what = rows(sparse["values"], code, columns, sparse["count"])
        for (k,), row in zip(where, what, strict=True):
            found[k] = row
    if accessor.get("normalized") and code != "f":
        most = MOST[accessor["componentType"]]
        found = [[max(value / most, -1.0) for value in row] for row in found]
    return found


@st.composite
def files(draw):
    """An accessor, its buffer views and their bytes."""
    component, kind = draw(st.sampled_from(sorted(CODES))), draw(st.sampled_from(sorted(COLUMNS)))
    count = draw(st.integers(1, 6))
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    row = struct.calcsize("<" + CODES[component]) * COLUMNS[kind]
    data, views = b"", []

    def view(size, stride=None):
        nonlocal data
        data += bytes(draw(st.integers(0, 5)))  # before it
        start = len(data)
        if component == 5126:
            part = rng.normal(size=size // 4 + 1).astype("<f4").tobytes()[:size]
        else:
            part = rng.bytes(size)
        data += part
        views.append(
            {"buffer": 0, "byteOffset": start, "byteLength": size} | ({} if stride is None else {"byteStride": stride})
        )
        return len(views) - 1

    accessor = {"componentType": component, "type": kind, "count": count, "normalized": draw(st.booleans())}
    is_sparse = draw(st.booleans())
    if not is_sparse or draw(st.booleans()):
        # Strides of floats are multiples of their size, so that all of the part's bytes are numbers.
        stride = draw(st.sampled_from([None, row, row + 4, row + 12]))
        offset = draw(st.sampled_from([0, 4, 8]))
        accessor |= {"bufferView": view(offset + (count - 1) * (stride or row) + row, stride), "byteOffset": offset}
    if is_sparse:
        many = draw(st.integers(1, count))
        code = draw(st.sampled_from([5121, 5123, 5125]))
        where = sorted(rng.choice(count, many, replace=False).tolist())
        start = len(data)
        data += struct.pack(f"<{many}{CODES[code]}", *where)
        views.append({"buffer": 0, "byteOffset": start, "byteLength": len(data) - start})
        indices = {"bufferView": len(views) - 1, "componentType": code}
        accessor["sparse"] = {"count": many, "indices": indices, "values": {"bufferView": view(many * row)}}
    return data, accessor, views


def numbers_of(data, accessor, views):
    header = {"accessors": [accessor], "bufferViews": views, "buffers": [{"byteLength": len(data)}]}
    return Numbers(GltfFile(header, data), lambda name: b"", Meter(Limits()))


@settings(deadline=None, max_examples=300)
@given(files())
def test_numbers_are_those_of_struct(made):
    data, accessor, views = made
    found = numbers_of(data, accessor, views).floats("a", 0, accessor["type"])
    np.testing.assert_array_equal(found, by_struct(data, accessor, views))


@settings(deadline=None, max_examples=100)
@given(files(), st.integers(1, 64))
def test_files_that_are_too_short_are_refused(made, cut):
    """Every byte counts: without the last ones of the last view, a number is missing."""
    data, accessor, views = made
    used = max(view["byteOffset"] + view["byteLength"] for view in views)
    with pytest.raises(InputError, match=r"a(: sparse indices)?: needs"):
        numbers_of(data[: max(0, used - min(cut, views[-1]["byteLength"]))], accessor, views).floats(
            "a", 0, accessor["type"]
        )


@pytest.mark.parametrize("component", [5121, 5123, 5125])
def test_indices(component):
    values = [0, 3, 2, 1]
    data = struct.pack(f"<4{CODES[component]}", *values)
    accessor = {"componentType": component, "type": "SCALAR", "count": 4, "bufferView": 0}
    numbers = numbers_of(data, accessor, [{"buffer": 0, "byteLength": len(data)}])
    assert numbers.indices("a", 0, "SCALAR", 4).ravel().tolist() == values
    with pytest.raises(InputError, match=r"a: index 3 is outside 0 \.\. 2"):
        numbers.indices("a", 0, "SCALAR", 3)


@pytest.mark.parametrize(("component", "least"), [(5120, -128), (5122, -32768)])
def test_the_least_whole_number_is_minus_one(component, least):
    """As the one above it is: fractions are symmetric."""
    data = struct.pack(f"<3{CODES[component]}", least, least + 1, 0)
    accessor = {"componentType": component, "type": "SCALAR", "count": 3, "bufferView": 0, "normalized": True}
    numbers = numbers_of(data, accessor, [{"buffer": 0, "byteLength": len(data)}])
    assert numbers.floats("a", 0, "SCALAR").ravel().tolist() == [-1.0, -1.0, 0.0]
