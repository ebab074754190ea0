"""Points made by hand, and methods that take a known time."""

import time
from dataclasses import dataclass, replace
from types import SimpleNamespace

import numpy as np

from refdof import Camera, ThinLens
from refdof.methods._contract import Method
from refdof.scene.scene import Part, Scene
from refdof.sweep import Measured
from refdof.view import View

SCORES = {"psnr": 30.0, "psnr_8bit": 30.0, "ssim": 0.9, "flip": 0.1, "rmse": 0.02, "rel_mse": 0.01, "max_abs": 0.5}


def point(key="k", time_s=0.1, psnr=30.0, floor=60.0, **parts):
    made = Measured(
        key=key,
        scene="fence",
        method="lensblur",
        params={"samples": 16, "pattern": "vogel"},
        varied={"samples": 16},
        width=320,
        height=240,
        lens_radius=0.05,
        focus=2.0,
        mean_coc_px=3.0,
        max_coc_px=9.0,
        prepare_s=0.5,
        layers_s=0.25 * time_s,
        blur_s=0.75 * time_s,
        spread_s=0.01,
        runs=3,
        peak_bytes=2.0**20,
        reads_per_pixel=float("nan"),
        rays_per_pixel=16.0,
        scores={**SCORES, "psnr": psnr},
        noise_floor_psnr=floor,
        command="refdof render fence --method lensblur --set samples=16 -o lensblur.png",
        machine="a processor",
        threads=2,
        version="0.1.0",
        sources="abc",
        measured_at="2026-01-01T00:00:00+00:00",
    )
    return replace(made, **parts)


@dataclass(frozen=True)
class SleepParams:
    seconds: float = 0.0
    megabytes: int = 0
    samples: int = 1


def sleeping_method():
    """A method that sleeps for a known time, holds a known memory and returns the pinhole picture, dimmed."""

    def render(view, params, _recorder):
        held = np.ones(params.megabytes << 17)  # 8 bytes each
        time.sleep(params.seconds)
        return view.pinhole().color * np.float32(1.0 - 0.1 / params.samples + 0.0 * held[:1].sum())

    record = Method(
        citation="nobody2000",
        source="Nobody 2000",
        kind="single image",
        inputs=("pinhole colour",),
        params=SleepParams,
        promises=(),
        texture_reads=lambda params, _width, _height: 2.0 * params.samples,
        known_defects=("It sleeps.",),
        tradeoff=("samples", (1, 2, 3)),
    )
    return SimpleNamespace(METHOD=record, render=render, __doc__="Sleep.", __file__=__file__)


def small_view(size=(16, 12)):
    """One triangle out of focus."""
    camera = Camera(eye=(0.0, 0.0, 2.0), target=(0.0, 0.0, 0.0), size=size)
    lens = ThinLens(radius=0.1, focus_distance=1.0)
    part = Part(np.array([[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [0.0, 1.0, 0.0]]), np.array([[0, 1, 2]]))
    return View(Scene.from_parts("triangle", [part], camera, lens), camera, lens)
