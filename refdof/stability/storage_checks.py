"""Checks of what is stored: half floats, depth buffers, and pixels that are no number."""

from collections.abc import Callable

import numpy as np

from refdof.stability.checks import Check
from refdof.stability.run import Run, bright
from refdof.stability.twins import narrow_of_half
from refdof.stability.verdict import Figure
from refdof.view import View

__all__ = ["contamination", "in_half", "stored_circles", "stored_picture"]

_EIGHT_BIT = 1.0 / 255.0


def contamination(at: tuple[int, int], reach: Callable[[Run], tuple[float, str]]) -> Check:
    """A pixel that is no number shows, and spreads no farther than `reach(run)` [px], whose reason that gives, too."""

    def check(run: Run) -> Figure:
        spoiled = ~np.isfinite(run.image).all(axis=-1)
        bound, reason = reach(run)
        if not spoiled.any():
            return Figure("contamination", float("nan"), bound, "px", "what is no number must show")
        y, x = np.nonzero(spoiled)
        return Figure("contamination", float(np.hypot(x - at[0], y - at[1]).max()), bound, "px", reason)

    return check


def in_half(what: str) -> Check:
    """Depth or circles stored as half floats change no step of an 8-bit display."""

    def check(run: Run) -> Figure | None:
        stored = narrow_of_half(run.method, run.view, run.params, what)
        if stored is None:
            return None
        error = float(np.abs(stored.image.astype(np.float64) - run.image).max()) / bright(run.image)
        return Figure("half", error, _EIGHT_BIT, "of the brightest", "a step of an 8-bit display")

    return check


def stored_circles(exact: Callable[[], View], room: float, reason: str) -> Check:
    """Circles of a stored depth are off by no more than `room` [px]."""

    def check(run: Run) -> Figure:
        error = float(np.abs(run.view.coc_px() - exact().coc_px()).max())
        return Figure("circles", error, room * (1.0 + 1e-6), "px", reason)

    return check


def stored_picture(exact: Callable[[], View]) -> Check:
    """The picture of a stored depth is no step of an 8-bit display off."""

    def check(run: Run) -> Figure:
        image = run.of(exact())
        error = float(np.abs(image.astype(np.float64) - run.image).max()) / bright(image)
        return Figure("picture", error, _EIGHT_BIT, "of the brightest", "a step of an 8-bit display")

    return check
