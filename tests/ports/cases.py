"""Case folders for ports of the single pass: small pictures with ties, and bounds of what a right port makes of them.

A folder has params.txt, lines "key value"; inputs/ with color.f32 (H W 3), depth.f32 and coc.f32 (H W), raw
little-endian float32; and expected/image.f32, from `blur`. Where rows are "up", row 0 of every file is the bottom row:
the listing's second texture coordinate then grows upwards on the screen, and the expected picture is a mirrored one.
"""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from refdof.methods.singlepass import Params, blur, bounds

__all__ = ["CASES", "TOLERANCE", "Case", "lay_down", "mutated", "outside"]

# Of the largest colour. Bounds hold what ties allow, so that only roundings are left. Texture coordinates near 1 are
# rounded to 2^-24, 4e-6 px of 64, and a circle made of a depth in float32 errs by 1e-5 px where 22 px are the
# difference of 44 and 22; smoothstep has a slope of 1.5 and the first tap a share of 1/2: 1e-5. Outer taps are up to
# 0.0007 px off, angles being added up in float32, with shares of 1/100 and less and errors of either sign.
TOLERANCE = 2e-5

FAR, FOCUS = 100.0, 2.0  # [scene units]
_FOCUS_SCALE = 2.2  # per largest blur: circles of -22 .. 21.6 px of 20


@dataclass(frozen=True)
class Case:
    """One folder: size (W, H), "down" or "up", and three constants of the listing."""

    width: int
    height: int
    rows: str
    max_blur_size: float
    rad_scale: float
    behind_factor: float

    @property
    def name(self):
        return f"{self.width}x{self.height}-{self.rows}-{self.max_blur_size:g}-{self.rad_scale:g}"

    @property
    def params(self):
        return {
            "width": self.width,
            "height": self.height,
            "rows": self.rows,
            "near": 0.5,
            "far": FAR,
            "focus": FOCUS,
            "focus_scale": _FOCUS_SCALE,
            "max_blur_size": self.max_blur_size,
            "rad_scale": self.rad_scale,
            "behind_factor": self.behind_factor,
        }

    @cached_property
    def inputs(self):
        """Colour (H, W, 3), depth and circle (H, W), float32, rows in the order of the files."""
        return tuple(np.ascontiguousarray(self._ordered(image)) for image in self._picture)

    @cached_property
    def expected(self):
        return np.ascontiguousarray(self._ordered(blur(*self._picture, self._method)))

    @cached_property
    def bounds(self):
        """Least and greatest (H, W, 3), rows in the order of the files."""
        found = bounds(*self._picture, self._method)
        return self._ordered(found.low), self._ordered(found.high)

    @property
    def _method(self):
        return Params(
            max_blur_size=self.max_blur_size,
            rad_scale=self.rad_scale,
            behind_factor=self.behind_factor,
            row_order=self.rows,
        )

    @property
    def _picture(self):
        return _picture(self.width, self.height, self.max_blur_size * _FOCUS_SCALE)

    def _ordered(self, image):
        return image if self.rows == "down" else image[::-1]


@lru_cache
def _picture(width, height, fall):
    """Rows down: a near card, a sharp bar, a slope, background, and a band of noise; a few lights above 1."""
    random = np.random.default_rng(31)
    y, x = np.indices((height, width))
    depth = np.where(y < 0.6 * height, FAR, 2.0 + 0.05 * x)
    depth[height // 5 : height // 2, width // 3 : width // 3 + 3] = FOCUS
    depth[height // 8 : height // 3, width // 2 : -width // 6] = 1.0
    noise = slice(3 * height // 4, None)
    depth[noise] = random.uniform(0.9, 9.0, depth[noise].shape)
    depth = depth.astype(np.float32)
    coc = fall * (1.0 / FOCUS - 1.0 / depth.astype(np.float64))
    color = random.random((height, width, 3)) * np.where(random.random((height, width, 1)) < 0.02, 4.0, 0.8)
    return color.astype(np.float32), depth, coc.astype(np.float32)


CASES = [
    Case(width, height, rows, *constants)
    for width, height in ((64, 48), (61, 47))
    for rows in ("down", "up")
    for constants in ((20.0, 0.5, 2.0), (6.0, 1.0, 3.0))  # the listing's, and others
]


def lay_down(case, folder):
    """Write a case into a folder of its name and return that."""
    place = folder / case.name
    for part in ("inputs", "expected"):
        (place / part).mkdir(parents=True)
    lines = (
        f"{key} {value:.9g}" if isinstance(value, float) else f"{key} {value}" for key, value in case.params.items()
    )
    (place / "params.txt").write_text("\n".join(lines) + "\n")
    for name, image in zip(("color", "depth", "coc"), case.inputs, strict=True):
        image.astype("<f4").tofile(place / "inputs" / f"{name}.f32")
    case.expected.astype("<f4").tofile(place / "expected" / "image.f32")
    return place


def outside(image, case):
    """How far the worst value of a picture (H, W, 3) is outside of the bounds, in tolerances; inf where not finite."""
    low, high = case.bounds
    if image.shape != low.shape or not np.isfinite(image).all():
        return np.inf
    return np.maximum(low - image, image - high).max() / (TOLERANCE * case.inputs[0].max())


def mutated(text, old, new):
    """A port's text with one line changed."""
    assert text.count(old) == 1, f"{old!r} stands {text.count(old)} times in the port"
    assert "\n" not in old + new
    return text.replace(old, new)
