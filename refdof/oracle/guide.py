"""Guide: what a pack says of itself: conventions for programs, and a README with which a port needs nothing else."""

from collections.abc import Sequence
from typing import Any

from refdof.oracle.cases import module_of
from refdof.oracle.device_depth import DEVICE_DEPTHS
from refdof.oracle.pictures import FAR

__all__ = ["PACK_CONVENTIONS", "README", "guide_of"]

PACK_CONVENTIONS: dict[str, Any] = {
    "color_space": "linear Rec.709, radiance; above 1 is allowed",
    "axis_y": "rows 'down': row 0 is the top row; rows 'up': row 0 is the bottom row; the same in all files of a case",
    "pixel_centre": "pixel (x, y) is sampled at (x + 0.5, y + 0.5)",
    "depth_kind": "planar distance along the optical axis, in scene units",
    "depth_empty_value": FAR,
    "device_depth": {name: f"{formula}; n and f are near and far" for name, formula in DEVICE_DEPTHS.items()},
    "coc_unit": "px_radius",
    "coc_sign": "negative_near",
    "coc": "coc_scale * (1 / focus - 1 / depth), in float64 from depth in float32, rounded once",
    "byte_order": "little",
    "memory_order": "C: the last axis runs fastest, so R G B of a pixel, pixels of a row, rows",
    "raw": "NAME.f32: the numbers only, float32",
}

README = """# A pack of refdof: what a correct port of a depth-of-field filter makes of small pictures

Each folder in `cases/` is one case:

    case.json     method, parameters, size [W, H], row order, files, tolerances with their reasons, tags, capabilities
    params.txt    the same numbers, one "key value" a line
    inputs/       color (H W 3), depth (H W), coc (H W): NAME.npy, and NAME.f32, the same numbers without a header
                  depth_device, depth_device_reversed, depth_device_infinite (H W): NAME.f32
    expected/     image (H W 3), .npy and .f32; low and high: its bounds; ambiguity (H W): where they differ; .npy
    expected/stages/  stages, if any, with bounds of their own: mean_16.npy, mean_16.f32, mean_16_low.npy and so on
    preview.png   for people: small, clipped, rows top-down; nothing is compared with it

All numbers are little-endian float32, rows one after another, R G B of a pixel together; ambiguity is of truth values.
Colour is linear. Depth is planar; the background has a far depth, no infinity. coc is the circle of confusion's signed
radius in pixels, negative before the focal plane. More in `conventions.json`.

## What to write

A program that is called with `--case CASE_FOLDER --out OUT_FOLDER`, reads `params.txt` and `inputs/`, and writes
`OUT_FOLDER/image.f32`, H W 3 float32 in the same row order as the inputs, or `image.npy`. One of the two, and nothing
else but stages under their names in `case.json`, such as `mean_16.f32`. A status of 77 says: not supported.

    refdof check --pack PACK --impl "./port --case {case} --out {out}"
    refdof check --pack PACK --results DIR        # DIR/CASE/image.f32, made elsewhere
    refdof check --pack PACK --shader FILE        # a fragment shader, GLSL or WGSL: refdof draws it

Among results made elsewhere, `not_supported.txt` alone in the folder of a case says so, and why in its first line. With
`--given STAGE` a program that fails is called once more, with expected stages in `inputs/` and a line `given STAGE` in
`params.txt` for each: it starts from them. `schemas/` holds JSON Schemas of all JSON files.

`capabilities` in `case.json` are the parameters that a case changes, and what else it needs; they are among its tags. A
port with constants of its own does not support cases that change them.

## Rows

Rows "down" begin with the top row of the picture, rows "up" with the bottom row, in all files of a case alike. Where
the order matters to a method, its section says how. Packs have pictures in both orders.

## Device depth

`near` (n) and `far` (f) in `params.txt` are the planes of three kinds of device depth, z the planar depth:

    depth_device            d = f (z - n) / (z (f - n))    0 near, 1 far             1 / z = 1/n - d (1/n - 1/f)
    depth_device_reversed   d = n (f - z) / (z (f - n))    1 near, 0 far             1 / z = 1/f + d (1/n - 1/f)
    depth_device_infinite   d = n / z                      1 near, no far plane      1 / z = d / n

The circle is then coc_scale (1 / focus - 1 / z), in float32, too. Decode to 1 / z, not to z: f n / (f - d (f - n))
cancels. `device_depth` in `case.json` has, for each, by how many pixels a circle is off at most for d's being float32,
and whether that is `enough`: at most 1e-5 px, which moves a picture by less than its tolerance. Where it is not, a port
that decodes device depth cannot be held to the case.

## Ties

A tap that lies exactly on a border of texels may read either. A value passes if it is within low .. high, and the
tolerance beyond; `image` is one picture between them, and where no bounds are given both are the picture itself.
In `case.json`, `ambiguous_share` is the share of pixels with bounds apart, and `wide_share` that of pixels with bounds
apart by more than the tolerance. NaN never passes.

## Circles

`coc` as a stage has bounds by interval arithmetic: 1 / depth and 1 / focus within 3 units in the last place, the rest
rounded. A number of units alone would not do, since the difference cancels near the focal plane.
"""


def guide_of(methods: Sequence[str]) -> str:
    """The README of a pack with these methods."""
    return "\n".join([README, *(module_of(method).GUIDE for method in methods)])
