"""Measured: a point of a sweep, as a row of the results."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

__all__ = ["Measured"]


@dataclass(frozen=True)
class Measured:
    """A method with its settings, before a scene: what it took and how near it came.

    Attributes
    ----------
    key : str
        A digest of scene, camera, lens, parameters, reference, sources and machine.
    params, varied : {name: value}
        All parameters of the method, and what was varied, of the method and of the shot.
    mean_coc_px, max_coc_px : float
        Of the circles of confusion of the pinhole picture, as radii [px].
    prepare_s, layers_s, blur_s, spread_s, runs
        Seconds as of `refdof.comparison.Row`; `layers_s` is the part of `prepare_s` that goes beyond the scene and its
        pinhole picture.
    peak_bytes : float
        Most memory that was held above what was held before: layers and the method; NaN where it cannot be told.
    reads_per_pixel, rays_per_pixel : float
        Texture reads, `Method.texture_reads`, or lens rays; NaN where they depend on the scene, or there are none.
    scores : as of `refdof.metrics.METRICS`
    artefacts : further numbers, where the error lies
    noise_floor_psnr : float [dB], of the reference
    command : str
        What renders the picture.
    machine, threads : the processor, and how many threads ran
    version, sources : of refdof; a digest of its files
    measured_at : str, UTC, ISO 8601
    """

    key: str
    scene: str
    method: str
    params: Mapping[str, Any]
    varied: Mapping[str, Any]
    width: int
    height: int
    lens_radius: float
    focus: float
    mean_coc_px: float
    max_coc_px: float
    prepare_s: float
    layers_s: float
    blur_s: float
    spread_s: float
    runs: int
    peak_bytes: float
    reads_per_pixel: float
    rays_per_pixel: float
    scores: Mapping[str, float]
    noise_floor_psnr: float
    command: str
    machine: str
    threads: int
    version: str
    sources: str
    measured_at: str
    artefacts: Mapping[str, float] = field(default_factory=dict)

    @property
    def time_s(self) -> float:
        """Seconds from the pinhole picture to the blurred one: layers, and the method itself."""
        return self.layers_s + self.blur_s

    @property
    def setting(self) -> str:
        """What was varied, in words."""
        return " ".join(f"{name}={value}" for name, value in self.varied.items()) or "defaults"

    @property
    def quality(self) -> float:
        """PSNR [dB]; at most 3 dB below the noise floor, above which scores mean nothing."""
        psnr = float(self.scores.get("psnr", math.nan))
        return psnr if math.isnan(self.noise_floor_psnr) else min(psnr, self.noise_floor_psnr - 3.0)
