"""Expressive lens: a thin lens with intuitive controls of focus, aperture and aberrations, for every pixel, [1].

- focus: a focal surface, the distance in focus of every pixel
- depth of field: the aperture's size for every pixel
- spherical aberration: refractive power by the place in the aperture, a spline
- bokeh: the weight of rays by the place in the aperture, a spline
- curvature of field: how far the image plane is displaced, a spline over the field, or a surface over the picture
- chromatic aberration: an index of refraction for each of red, green and blue

Departures from the paper
-------------------------
- The paper gives no formulas. Here the image plane is where the thin lens's equation puts it for the focus distance,
  and power, index and offset change that equation: a ray of the aperture's point v and a pixel's chief ray meet at the
  distance d with 1/d = s(|v|) (n_c - 1) / (n_g - 1) / F - 1 / (u + offset), where 1/u = 1/F - 1/focus. With a focal
  surface, focus and u are each pixel's own: it bends the image plane, and the offset goes on from there.
- Chief rays stay: an offset or another power moves no image, it only blurs it.
- Splines are monotone between their values (no overshoot, so a weight is never negative) and even about the middle.
- Weights are divided by their mean over the aperture: an even scene keeps its brightness.

References
----------
.. [1] Lee, Eisemann & Seidel (2010), Real-Time Lens Blur Effects and Focus Control, sections 5.2 and 5.3.
"""

import math
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from refdof._check import Float, InputError, as_depth, as_float, as_instance, as_number, shape_of
from refdof.optics.aperture import Aperture
from refdof.optics.aperture_sampling import aperture_sampler_of
from refdof.optics.camera import Camera
from refdof.optics.expressive_map import ExpressiveMap
from refdof.optics.lens import ThinLens, rounded
from refdof.optics.projection import projection_of

__all__ = ["ExpressiveLens"]

_GRID = 64  # points a side of the unit square over which the aperture is averaged
_MOST = 64  # values of a spline
_LEAST_LENGTH = 1e-30  # [scene units]: powers of shorter ones leave float32


@dataclass(frozen=True, init=False, eq=False)
class ExpressiveLens(ThinLens):
    """A thin lens whose focus and aberrations are set directly. Left out, each is none, and the lens is the thin one.

    The reference, `accumulation` and `lensblur` trace its rays. All other methods take circles of confusion, with the
    mean power over aperture and colours: each pixel's own; `multiview` takes those of the picture's middle.

    Parameters
    ----------
    radius, focus_distance, aperture
        As of `ThinLens`.
    focal_length : float
        [scene units], at least 1e-30 and below the focus distance.
    power : sequence of 2 to 64 floats
        Refractive power over that of the nominal lens, > 0, at equal steps from the middle of the lens to its rim.
    ray_weights : sequence of 2 to 64 floats
        Weights of rays, >= 0 and not all 0, at equal steps from the middle of the lens to its rim.
    image_offset : sequence of 2 to 64 floats, or (h, w) floats
        How far the image plane is displaced away from the lens [scene units], above minus its distance: at equal steps
        from the middle of the picture to its corner; or over the picture, row 0 at the top, values at the centres of
        equal cells, bilinear between them. With a focal surface, from where this has it; all of it must then lie
        beyond the focal length.
    indices : 3 floats
        Index of refraction, > 1, for red, green and blue; the focal length is that of green.
    focal_surface : (h, w) floats
        Distance in focus [scene units], > 0, ``inf`` is allowed: over the picture, as `image_offset`; bilinear in
        1 / distance, so that planes stay planes. Left out: the focus distance everywhere.
    aperture_scale : (h, w) floats
        Radius of the aperture over the lens radius, 0 to 1, over the picture.

    Raises
    ------
    InputError
        If a number is out of range or the focus distance is not above the focal length.
    """

    radius: float
    focus_distance: float
    aperture: Aperture
    focal_length: float
    power: tuple[float, ...]
    ray_weights: tuple[float, ...]
    image_offset: Float
    indices: tuple[float, float, float]
    focal_surface: Float
    aperture_scale: Float

    def __init__(
        self,
        radius: float,
        focus_distance: float,
        focal_length: float,
        *,
        power: Sequence[float] = (1.0, 1.0),
        ray_weights: Sequence[float] = (1.0, 1.0),
        image_offset: Any = (0.0, 0.0),
        indices: Sequence[float] = (1.5, 1.5, 1.5),
        focal_surface: Any = None,
        aperture_scale: Any = ((1.0,),),
        aperture: Aperture | None = None,
    ) -> None:
        super().__init__(radius, focus_distance, Aperture.disc() if aperture is None else aperture)
        focal_length = as_number("focal_length", focal_length, minimum=_LEAST_LENGTH)
        if not self.focus_distance > focal_length:
            raise InputError(
                f"focal_length: got {focal_length:g}; allowed is less than the focus distance {self.focus_distance:g}"
            )
        object.__setattr__(self, "focal_length", focal_length)
        object.__setattr__(self, "power", _values("power", power, least=1e-3))
        object.__setattr__(self, "ray_weights", _values("ray_weights", ray_weights, least=0.0))
        if not any(self.ray_weights):
            raise InputError("ray_weights: all are 0; at least one must be above 0")
        colors = as_float("indices", indices, (3,), dtype=np.float64, maximum=10.0)
        if not colors.min() > 1.0:
            raise InputError(f"indices: smallest value is {colors.min():g}; allowed are values above 1")
        object.__setattr__(self, "indices", tuple(colors.tolist()))
        surface = [[self.focus_distance]] if focal_surface is None else focal_surface
        _picture_shape("focal_surface", surface)
        surface = as_float("focal_surface", surface, (None, None), dtype=np.float64, finite=False)
        if not surface.min() > 0.0:
            raise InputError(f"focal_surface: smallest value is {surface.min():g}; allowed are values above 0")
        object.__setattr__(self, "focal_surface", surface)
        object.__setattr__(self, "image_offset", self._offset(image_offset))
        _picture_shape("aperture_scale", aperture_scale)
        scale = as_float("aperture_scale", aperture_scale, (None, None), dtype=np.float64, minimum=0.0, maximum=1.0)
        object.__setattr__(self, "aperture_scale", scale)

    def _offset(self, given: Any) -> Float:
        shape = (None,) if len(shape_of("image_offset", given)) == 1 else (None, None)
        offset = as_float("image_offset", given, shape, dtype=np.float64)
        if offset.ndim == 1:
            _values("image_offset", given, least=-math.inf)
        if not offset.size:
            raise InputError("image_offset: got none; allowed are 2 to 64 numbers, or some over the picture")
        if offset.any() and not self.focal_surface.min() > self.focal_length:
            raise InputError(
                f"focal_surface: smallest value is {self.focal_surface.min():g}; with an image_offset, allowed is more "
                f"than the focal length {self.focal_length:g}: nearer, there is no image plane"
            )
        nearest = 1.0 / (1.0 / self.focal_length - 1.0 / self.focal_surface.max())
        if offset.any() and not offset.min() > -nearest:
            raise InputError(
                f"image_offset: smallest value is {offset.min():g}; allowed is more than {-nearest:g}: "
                "the image plane stays behind the lens"
            )
        return offset

    def inverse_focus(self, camera: Camera) -> Float:
        """(H, W) float64: one over the distance at which rays of the lens's middle meet [1 / scene unit]; green."""
        as_instance("camera", camera, Camera)
        focus, offset = over_picture(1.0 / self.focal_surface, camera), self._offset_of(camera)
        strength = 1.0 / self.focal_length - focus  # 1 / u
        return focus + offset * strength**2 / (1.0 + offset * strength)

    def coc_px(self, depth: Any, camera: Camera) -> Float:
        """Signed circle of confusion [px], as `ThinLens.coc_px`, with the mean power over aperture and colours.

        Of an array whose last two axes are the picture's rows and columns, each pixel has its own focus; of all others,
        it is that of the picture's middle.
        """
        as_instance("camera", camera, Camera)
        array = as_depth(depth, shape_of("depth", depth))
        if self.radius == 0.0 or self._is_plain():
            return super().coc_px(depth, camera)
        focus = self._mean_inverse_focus(camera)
        wide = over_picture(self.aperture_scale, camera)
        if array.shape[-2:] != wide.shape:
            focus, wide = (values[camera.height // 2, camera.width // 2] for values in (focus, wide))
        scale = min(camera.pixels_per_tangent * self.radius, sys.float_info.max)
        with np.errstate(over="ignore"):
            return rounded(scale * wide * (focus - 1.0 / array.astype(np.float64)), array.dtype)

    def as_thin(self, depth: Float, camera: Camera) -> tuple[Float, ThinLens]:
        """Depths (..., H, W) at which the plain thin lens has each pixel's circle of confusion, and that lens.

        NaN stays. Circles larger than the thin lens's of the background become that.
        """
        plain = ThinLens(self.radius, self.focus_distance, self.aperture)
        if self._is_plain():
            return depth, plain
        circle = over_picture(self.aperture_scale, camera) * (self._mean_inverse_focus(camera) - 1.0 / depth)
        inverse = 1.0 / self.focus_distance - circle
        with np.errstate(divide="ignore"):
            return (1.0 / np.maximum(inverse, 0.0)).astype(depth.dtype), plain

    def _mean_inverse_focus(self, camera: Camera) -> Float:
        """(H, W): of the mean power over the light of the aperture, and colours."""
        points = self._points()
        weights = _at(_spline(self.ray_weights), points)
        added = self._added() @ np.stack([_at(_spline(self.power), points), np.ones(len(points))])
        return self.inverse_focus(camera) + float((added * weights).mean() / weights.mean())

    def largest_circle_px(self, depth: Float, camera: Camera) -> float:
        """The largest circle of confusion of these depths, of any pixel, part of the aperture and colour [px]."""
        spline = _at(_spline(self.power), np.linspace(0.0, 1.0, 1025))
        ends = np.array([[spline.min(), spline.max()], [1.0, 1.0]])
        added, focus = self._added() @ ends, self.inverse_focus(camera)
        low, high = focus.min() + added.min(), focus.max() + added.max()
        inverse = 1.0 / np.asarray(depth)
        scale = min(camera.pixels_per_tangent * self.radius, sys.float_info.max)
        return float(scale * max(np.abs(low - inverse).max(), np.abs(high - inverse).max()))

    def map_of(self, camera: Camera, exponent: int = 0) -> ExpressiveMap:
        """The lens before a camera, for kernels; lengths are in 2^exponent scene units."""
        weight = _spline(self.ray_weights)
        mean = _at(weight, self._points()).mean()
        power = self._added()[:, :1, None] * _spline(self.power)
        power[:, :, 0] += self._added()[:, 1:]
        return ExpressiveMap(
            projection_of(camera, self, exponent),
            aperture_sampler_of(self.aperture),
            np.ldexp(self.inverse_focus(camera), exponent),
            over_picture(self.aperture_scale, camera) if self.aperture_scale.min() < 1.0 else np.ones((1, 1)),
            np.ldexp(power, exponent),
            weight / mean,
        )

    def _is_plain(self) -> bool:
        """Whether all rays of a pixel meet where those of the thin lens do."""
        even = (self.focal_surface == self.focus_distance).all() and self.aperture_scale.min() == 1.0
        return bool(even and set(self.power) == {1.0} and not self.image_offset.any() and len(set(self.indices)) == 1)

    def _added(self) -> Float:
        """(C, 2): power at r times the first plus the second is what is added to each colour's inverse focus."""
        factors = np.array([(index - 1.0) / (self.indices[1] - 1.0) for index in self.indices])
        factors = factors[:1] if len(set(self.indices)) == 1 else factors
        return np.stack([factors / self.focal_length, np.full(len(factors), -1.0 / self.focal_length)], axis=1)

    def _points(self) -> Float:
        """Shares of the lens radius (N,) of points that are even over the aperture's light."""
        middle = (np.arange(_GRID) + 0.5) / _GRID
        square = np.stack(np.meshgrid(middle, middle), axis=-1).reshape(-1, 2)
        return np.minimum(np.hypot(*self.aperture.from_square(square).T), 1.0)

    def _offset_of(self, camera: Camera) -> Float:
        """(H, W) offset of the image plane at pixel centres."""
        if self.image_offset.ndim == 2:
            return over_picture(self.image_offset, camera)
        x, y = np.arange(camera.width) + 0.5, np.arange(camera.height) + 0.5
        field = np.hypot(x - 0.5 * camera.width, (y - 0.5 * camera.height)[:, None])
        return _at(_spline(self.image_offset), field / (0.5 * math.hypot(camera.width, camera.height)))


def over_picture(values: Float, camera: Camera) -> Float:
    """Values (h, w) at the centres of equal cells of the picture, at its pixels' centres (H, W): bilinear."""
    return _between(_between(values, camera.height).T, camera.width).T


def _between(values: Float, count: int) -> Float:
    """Values (n, m) at n places as (count, m): linear between the centres of equal parts, constant beyond."""
    place = np.clip((np.arange(count) + 0.5) * (len(values) / count) - 0.5, 0.0, len(values) - 1.0)
    first = np.minimum(place.astype(np.int64), max(len(values) - 2, 0))
    part = (place - first)[:, None]
    return (1.0 - part) * values[first] + part * values[np.minimum(first + 1, len(values) - 1)]


def _picture_shape(name: str, given: Any) -> None:
    """Raise if this does not lie over the picture: (h, w), at least one by one."""
    shape = shape_of(name, given)
    if len(shape) != 2 or 0 in shape:
        raise InputError(f"{name}: got shape {shape}; allowed is (h, w), at least (1, 1)")


def _values(name: str, given: Any, least: float) -> tuple[float, ...]:
    values = as_float(name, given, (None,), dtype=np.float64, minimum=least)
    if not 2 <= len(values) <= _MOST:
        raise InputError(f"{name}: got {len(values)} numbers; allowed are 2 to {_MOST}")
    return tuple(values.tolist())


def _spline(values: Any) -> Float:
    """Coefficients (parts, 4), lowest power first, of a monotone cubic through values at equal steps of 0 .. 1, [2].

    It is even about 0: the derivative there is 0.
    """
    from scipy.interpolate import PchipInterpolator  # slow to import

    both = np.concatenate([np.asarray(values)[:0:-1], values])
    return np.ascontiguousarray(PchipInterpolator(np.arange(len(both)), both).c.T[len(values) - 1 :, ::-1])


def _at(spline: Float, places: Float) -> Float:
    """A spline's values at places 0 .. 1."""
    scaled = places * len(spline)
    part = np.minimum(scaled.astype(np.int64), len(spline) - 1)
    t = scaled - part
    return ((spline[part, 3] * t + spline[part, 2]) * t + spline[part, 1]) * t + spline[part, 0]
