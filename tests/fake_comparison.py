"""Fake comparisons for the tests of the report: random pictures and scores that float32 holds exactly."""

import numpy as np

from refdof.comparison import Comparison, Row
from refdof.metrics import artefacts as metrics
from refdof.optics.camera import Camera
from refdof.optics.lens import ThinLens

SCORES = {
    "psnr": 31.25,
    "psnr_8bit": 31.125,
    "ssim": 0.9375,
    "flip": 0.0625,
    "rmse": 0.015625,
    "rel_mse": 0.00390625,
    "max_abs": 0.5,
}
ARTEFACTS = {name: 0.25 + k / 64.0 for k, name in enumerate(metrics.LOCATED)}


def comparison(
    width=40, height=30, methods=("multiview", "mipmap"), scene="fence", scores=SCORES, focus=2.0, artefacts=ARTEFACTS
):
    random = np.random.default_rng(width * 1000 + height)
    reference, pinhole = random.uniform(0.0, 1.5, (2, height, width, 3)).astype(np.float32)
    rows = []
    for k, name in enumerate(methods):
        image = (reference + random.normal(0.0, 0.1, reference.shape)).astype(np.float32)
        params, timed = {"samples": 64 + k, "pattern": "halton"}, (0.5, 0.125, "best", 3, 0.0625)
        rows.append(Row(name, params, image, dict(scores), *timed, dict(artefacts)))
    return Comparison(
        scene=scene,
        camera=Camera((0, 0, 1), (0, 0, 0), size=(width, height)),
        lens=ThinLens(0.25, focus),
        pinhole=pinhole,
        reference=reference,
        standard_error=np.full_like(reference, 0.001),
        samples=1024.0,
        seconds=12.5,
        noise_floor_psnr=55.5,
        rows=tuple(rows),
    )
