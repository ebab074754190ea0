"""Params of the circular method: numbers of components, and the constants that ports change."""

from dataclasses import dataclass

from refdof._check import as_bool, as_choice, as_integer, as_number
from refdof.methods.circular.coefficients import FITTED

__all__ = ["FIELDS", "Params"]

FIELDS = ("own", "near_far")


@dataclass(frozen=True)
class Params:
    """What ports change.

    Parameters
    ----------
    components : int
        Complex kernels, 1 .. 5; more are closer to a disc. Where `fields` is "near_far" they are the far field's.
    transition : float
        Taps reach this share of the radius beyond it, 0 .. 1; the paper has 0, a later script 0.2.
    fitted_radius : float
        Where the fitted disc ends, 0.5 .. 2, in radii of the taps' reach; ports take 1.
    fields : {"own", "near_far"}
        "own": every pixel is blurred by its own circle. "near_far": far and near fields are laid over the picture.
    misprinted : bool
        The generator's wrong sign in four components, which ports copied.
    largest_px : float
        Circles of confusion are cut at this radius [px], 0 .. 1024.
    """

    components: int = 2
    transition: float = 0.0
    fitted_radius: float = FITTED
    fields: str = "own"
    misprinted: bool = False
    largest_px: float = 32.0

    def __post_init__(self) -> None:
        object.__setattr__(self, "components", as_integer("components", self.components, minimum=1, maximum=5))
        for name, least, most in (("transition", 0.0, 1.0), ("fitted_radius", 0.5, 2.0), ("largest_px", 0.0, 1024.0)):
            object.__setattr__(self, name, as_number(name, getattr(self, name), minimum=least, maximum=most))
        as_choice("fields", self.fields, FIELDS)
        object.__setattr__(self, "misprinted", as_bool("misprinted", self.misprinted))
