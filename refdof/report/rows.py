"""Rows: a comparison as plain values for JSON, CSV and the tables.

Strict JSON has no infinity and no NaN: an infinite number (the PSNR of identical images, focus at infinity)
becomes the string "inf" or "-inf", a NaN or a missing score becomes null.
"""

import math
import shlex
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np

from refdof._check import Float
from refdof.comparison import Comparison, Motion, Row
from refdof.metrics import FLIP_PPD, METRICS
from refdof.metrics.artefacts import LOCATED
from refdof.optics.expressive_lens import ExpressiveLens
from refdof.optics.lens import ThinLens
from refdof.optics.systems.paraxial import f_number
from refdof.optics.systems.system_lens import SystemLens

__all__ = [
    "DISPLAY",
    "PHOTOGRAPHIC",
    "at_noise_floor",
    "command_of",
    "is_at_floor",
    "lens_as_json",
    "plain",
    "rows_as_json",
]

# What a score of the display image needs beside it to mean anything.
DISPLAY = {"peak": 1.0, "tone_map": "clip to [0, 1], sRGB", "flip_ppd": FLIP_PPD}

# What has to be known to compare our circles of confusion with a photographer's.
PHOTOGRAPHIC = "coc is a radius, (s - f) / s of the photographic circle's; f: focal length, s: focus distance"

_FLOOR_MARGIN_DB = 3.0  # here the reference's noise makes up half of the error or more


def rows_as_json(comparison: Comparison, command: str = "") -> dict[str, Any]:
    """The content of ``table.json``: strings, numbers, null, lists and dicts only.

    Parameters
    ----------
    comparison : Comparison
    command : str
        What reproduces it; empty: the nearest `refdof compare` line, made from what the comparison holds.
    """
    lens = comparison.lens
    return {
        "scene": comparison.scene,
        "camera": {"size": plain(comparison.camera.size)} if lens is None else plain(asdict(comparison.camera)),
        "lens": None if lens is None else {**lens_as_json(lens), "coc_photographic": PHOTOGRAPHIC},
        "reference": None
        if comparison.reference is None
        else {
            "samples": plain(comparison.samples),
            "seconds": plain(comparison.seconds),
            "kept": comparison.kept,
            "noise_floor_psnr": plain(comparison.noise_floor_psnr),
        },
        "motion": None if comparison.motion is None else _motion_as_json(comparison.motion),
        "display": dict(DISPLAY),
        "command": command or command_of(comparison),
        "rows": [
            {
                "method": row.method,
                "preset": row.preset,
                "params": plain(row.params),
                **{name: plain(row.scores.get(name)) for name in METRICS},
                "prepare_s": plain(row.prepare_s),
                "blur_s": plain(row.blur_s),
                "spread_s": plain(row.spread_s),
                "runs": row.runs,
                "at_noise_floor": at_noise_floor(row, comparison),
                **{name: plain(row.artefacts.get(name)) for name in LOCATED},
            }
            for row in comparison.rows
        ],
    }


def _motion_as_json(motion: Motion) -> dict[str, Any]:
    """How flicker was measured: columns and rows of the frames, their number, and by how much each moves on."""
    return {
        "frames": motion.frames,
        "size": plain(motion.size),
        "step_px": motion.step_px,
        "samples": motion.samples,
        "reference_flicker": plain(motion.flicker["reference"]),
        "strip_row": motion.row,
    }


def at_noise_floor(row: Row, comparison: Comparison) -> bool:
    """True if the PSNR is within 3 dB of the noise floor: the reference's noise is then half of the error."""
    return is_at_floor(row.scores, comparison.noise_floor_psnr)


def is_at_floor(scores: Mapping[str, float], floor: float) -> bool:
    """`at_noise_floor` of scores and a floor [dB]; NaN: unknown."""
    return math.isfinite(floor) and bool(scores.get("psnr", math.nan) >= floor - _FLOOR_MARGIN_DB)


def command_of(comparison: Comparison) -> str:
    """A `refdof compare` line for this shot, empty for a frame made elsewhere; of a lens system, focus points and an
    aperture, the thin lens is said.
    """
    camera, lens = comparison.camera, comparison.lens
    if lens is None or math.isnan(comparison.samples):
        return ""  # of a frame, whose files are not known here
    words = ["refdof", "compare", comparison.scene, "--size", f"{camera.width}x{camera.height}"]
    for name in ("eye", "target", "up"):
        words += [f"--{name}", ",".join(map(repr, getattr(camera, name)))]
    words += ["--fov", repr(camera.fov_y), "--lens-radius", repr(lens.radius), "--focus", repr(lens.focus_distance)]
    words += ["--samples", str(round(comparison.samples))]
    words += [] if comparison.motion is None else ["--motion", str(comparison.motion.frames)]
    words += ["--methods", ",".join(dict.fromkeys(row.method for row in comparison.rows))]
    words += ["--preset", ",".join(dict.fromkeys(row.preset for row in comparison.rows))]
    for method in dict.fromkeys(row.method for row in comparison.rows):
        first, *others = [row.params for row in comparison.rows if row.method == method]
        for key, value in first.items():
            if all(params[key] == value for params in others):  # else the presets tell
                text = str(value).lower() if isinstance(value, bool) else value
                words += ["--set", f"{method}.{key}={text}"]
    return shlex.join([*words, "--out", "DIR"])


def plain(value: Any) -> Any:
    """`value` in JSON's own types; what JSON cannot say becomes its text."""
    if isinstance(value, np.ndarray | np.generic):
        value = value.tolist()
    if value is None or isinstance(value, bool | int | str):
        return value
    if isinstance(value, float):
        if math.isnan(value):
            return None
        return value if math.isfinite(value) else str(value)
    if isinstance(value, dict):
        return {str(key): plain(entry) for key, entry in value.items()}
    if isinstance(value, list | tuple):
        return [plain(entry) for entry in value]
    return str(value)


def lens_as_json(lens: ThinLens) -> dict[str, Any]:
    """A lens in JSON's own types."""
    aperture = lens.aperture
    if aperture.is_image:
        shape = f"image of {aperture.weights.shape[1]} x {aperture.weights.shape[0]} texels"
    elif len(aperture.boundary):
        shape = f"polygon of {len(aperture.boundary)} corners"
    else:
        shape = "disc"
    facts = {
        "radius": plain(lens.radius),
        "focus_distance": plain(lens.focus_distance),
        "aperture": {"shape": shape, "scale": plain(aperture.scale)},
    }
    if isinstance(lens, SystemLens):
        facts["system"] = {
            "name": lens.system.name,
            "f_number": plain(f_number(lens.stopped)),
            "mm_per_unit": plain(lens.mm_per_unit),
            "wavelengths": lens.wavelengths,
            "vignetting": lens.vignetting,
        }
    if isinstance(lens, ExpressiveLens):
        facts["expressive"] = {
            "focal_length": plain(lens.focal_length),
            "power": plain(lens.power),
            "ray_weights": plain(lens.ray_weights),
            "image_offset": plain(lens.image_offset)
            if lens.image_offset.ndim == 1
            else _over_picture(lens.image_offset),
            "focal_surface": _over_picture(lens.focal_surface),
            "aperture_scale": _over_picture(lens.aperture_scale),
            "indices": plain(lens.indices),
        }
    return facts


def _over_picture(values: Float) -> dict[str, Any]:
    """What lies over the picture, in short."""
    return {"shape": plain(values.shape), "from": plain(values.min()), "to": plain(values.max())}
