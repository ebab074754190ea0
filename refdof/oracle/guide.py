"""Guide: what a pack says of itself: conventions for programs, and a README with which a port needs nothing else."""

from typing import Any

from refdof.oracle.inputs import FAR

__all__ = ["PACK_CONVENTIONS", "README"]

PACK_CONVENTIONS: dict[str, Any] = {
    "color_space": "linear Rec.709, radiance; above 1 is allowed",
    "axis_y": "rows 'down': row 0 is the top row; rows 'up': row 0 is the bottom row; the same in all files of a case",
    "pixel_centre": "pixel (x, y) is sampled at (x + 0.5, y + 0.5)",
    "depth_kind": "planar distance along the optical axis, in scene units",
    "depth_empty_value": FAR,
    "coc_unit": "px_radius",
    "coc_sign": "negative_near",
    "coc": "coc_scale * (1 / focus - 1 / depth), in float64 from depth in float32, rounded once",
    "byte_order": "little",
    "memory_order": "C: the last axis runs fastest, so R G B of a pixel, pixels of a row, rows",
    "raw": "NAME.f32: the numbers only, float32",
}

README = """# A pack of refdof: what a correct port of a depth-of-field filter makes of small pictures

Each folder in `cases/` is one case:

    case.json     method, parameters, size [W, H], row order, files, tolerances with their reasons, tags
    params.txt    the same numbers, one "key value" a line
    inputs/       color (H W 3), depth (H W), coc (H W): NAME.npy, and NAME.f32, the same numbers without a header
    expected/     image (H W 3); low and high: its bounds; ambiguity (H W): where they differ; stages, if any

All numbers are little-endian float32, rows one after another, R G B of a pixel together. Colour is linear. Depth is
planar; the background has a far depth, no infinity. coc is the circle of confusion's signed radius in pixels, negative
before the focal plane. More in `conventions.json`.

## What to write

A program that is called with `--case CASE_FOLDER --out OUT_FOLDER`, reads `params.txt` and `inputs/`, and writes
`OUT_FOLDER/image.f32`, H W 3 float32 in the same row order as the inputs, or `image.npy`. One of the two, and nothing
else but stages under their names in `case.json`, such as `mean_16.f32`. A status of 77 says: not supported.

    refdof check --pack PACK --impl "./port --case {case} --out {out}"
    refdof check --pack PACK --results DIR        # DIR/CASE/image.f32, made elsewhere

## Rows

The spiral turns, so the order of rows matters. `row_step` in `params.txt` is where the sine of a tap's angle points to
in the files: +1 to later rows, -1 to earlier ones. A texture whose row 0 is texture coordinate 0 has +1: with rows "up"
that is a bottom-up upload as OpenGL's. The cases tagged `mirrored_spiral` have -1.

## Ties

A tap that lies exactly on a border of texels may read either. A value passes if it is within low .. high, and the
tolerance beyond; `image` is one picture between them. NaN never passes.

## singlepass

The loop of Gustafsson (2018), "Bokeh Depth of Field in a Single Pass". `size(c) = min(|c|, max_blur_size)`:

    color, total, radius, angle = color of the pixel, 1, radius_start, angle_start
    while radius < loop_bound:
        tap at pixel + scale * radius * (cos angle, row_step * sin angle)
        its color: bilinear, clamped to the edge; its depth and coc: of the nearest texel, clamped to the edge
        s = size(coc of tap); if depth of tap > depth of pixel: s = min(s, behind_factor * size(coc of pixel))
        m = smoothstep(radius - 0.5, radius + 0.5, s)
        color += mix(color / total, color of tap, m);  total += 1
        angle += angle_step;  radius += rad_scale / radius
    image = color / total

Stages, where a case has them: `size`, `limit` = behind_factor * size, and `mean_K`, color / total after K taps.
"""
