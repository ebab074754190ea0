"""Ray map: the rays of any lens that is not a plain thin lens, for kernels, from whichever map it has."""

from typing import NamedTuple

from refdof._jit import inline
from refdof.optics.expressive_map import ExpressiveMap, borrow_expressive_map, expressive_block
from refdof.optics.systems.lens_map import LensMap, borrow_lens_map, lens_map_block

__all__ = ["RayMap", "borrow_ray_map", "even_light", "ray_block"]


class RayMap(NamedTuple):
    """A lens system's map, or an expressive lens's; one of the two is None."""

    system: LensMap | None
    expressive: ExpressiveMap | None

    @property
    def waves(self) -> int:
        """How many wavelengths it has: one, or one for each of red, green and blue."""
        if self.expressive is not None:
            return len(self.expressive.power)
        assert self.system is not None
        return len(self.system.ratios)


@inline
def borrow_ray_map(o):
    """`RayMap` whose arrays are borrowed, for a tile kernel's inner loops."""
    return RayMap(_borrow_system(o.system), _borrow_expressive(o.expressive))


@inline
def _borrow_system(system):
    return None if system is None else borrow_lens_map(system)


@inline
def _borrow_expressive(expressive):
    return None if expressive is None else borrow_expressive_map(expressive)


@inline
def ray_block(ray_map, wavelength, scratch, columns, rows, x, y, dx, dy, weights):
    """Rays (x, y, dx, dy) and weights for arrays (N,) of places in the image and points (x, y) of the unit square.

    A ray starts at (x, y, 0) in camera space and runs along (dx, dy, -1). Arguments are those of
    `refdof.optics.systems.lens_map.lens_map_block`.
    """
    _block(ray_map.system, ray_map.expressive, wavelength, scratch, columns, rows, x, y, dx, dy, weights)


@inline
def _block(system, expressive, wavelength, scratch, columns, rows, x, y, dx, dy, weights):
    if system is not None:  # two questions: the compiler takes out what is asked of a None, not what is asked besides
        lens_map_block(system, wavelength, scratch, columns, rows, x, y, dx, dy, weights)
    if expressive is not None:
        expressive_block(expressive, wavelength, columns, rows, x, y, dx, dy, weights)


@inline
def even_light(ray_map):
    """Whether every pixel gets the light of the whole lens, so that weights count beside each other only."""
    return ray_map.system is None
