"""Page: a check's findings as one self-contained HTML file, failing cases first, with pictures of what is off.

Pictures are made while the check runs, small, and only of parts that are off: what came, what was expected, and how
far it is beyond the bounds, in tolerances.
"""

import base64
from pathlib import Path
from typing import Any

import numpy as np

from refdof._check import Float
from refdof.image.display import linear_from_display
from refdof.image.file import png_bytes
from refdof.oracle.expectation import Part
from refdof.oracle.outcomes import STATUSES, Outcome, Report
from refdof.oracle.verdict import PASS, Finding, excess
from refdof.report.page import rendered

__all__ = ["Pictures", "check_page", "heat"]

_LONGEST_SIDE = 160  # px of an embedded picture
_MOST_PARTS = 200  # that have pictures
_MAGENTA = (1.0, 0.0, 1.0)  # NaN
_DECADES = 4.0  # of the difference's scale


class Pictures:
    """Embedded pictures of parts that are off: `add` is what `check_source` shows them to."""

    def __init__(self) -> None:
        self._made: dict[tuple[str, str], dict[str, Any]] = {}
        self.left_out = 0

    def add(self, case: str, part: str, values: Float, expected: Part) -> None:
        """Make the pictures of one part."""
        if len(self._made) >= _MOST_PARTS:
            self.left_out += 1
            return
        golden = expected.values.astype(np.float64)
        span = _span(golden)
        images = {
            "got": _shown(values, span),
            "expected": _shown(golden, span),
            "difference": heat(excess(values.astype(np.float64), *_double(expected), expected.tolerance)),
        }
        width = values.shape[1]
        self._made[case, part] = {
            "images": {name: _png(image) for name, image in images.items()},
            "width": min(2 * width, 2 * _LONGEST_SIDE) if width < _LONGEST_SIDE else _LONGEST_SIDE,
            "black": f"{span[0]:.4g}",
            "white": f"{span[1]:.4g}",
        }

    def of(self, case: str, part: str) -> dict[str, Any] | None:
        """What `add` has made of a part; None if nothing."""
        return self._made.get((case, part))


def check_page(report: Report, pictures: Pictures) -> str:
    """The page. No link, no outside resource."""
    worst_first = sorted(report.outcomes, key=lambda outcome: _ORDER[outcome.status])
    return rendered(
        "check.html",
        Path(__file__).parent,
        passed=report.passed,
        counts={status: count for status, count in report.counts().items() if count},
        warnings=report.warnings,
        cases=[_case(outcome, pictures) for outcome in worst_first],
        left_out=pictures.left_out,
        decades=int(_DECADES),
    )


_ORDER = {status: order for order, status in enumerate(("error", "fail", "quality warning", "waived"))}
_ORDER |= {status: len(_ORDER) + order for order, status in enumerate(s for s in STATUSES if s not in _ORDER)}


def _case(outcome: Outcome, pictures: Pictures) -> dict[str, Any]:
    parts = [
        {
            "name": part,
            "cumulative": finding.status,
            "isolated": _status(outcome.own(part)),
            "cause": outcome.causes.get(part, ""),
            "first": part == outcome.first_wrong,
            "waived": part in outcome.waived,
            "words": finding.words(),
            "pictures": pictures.of(outcome.case, part),
        }
        for part, finding in outcome.findings.items()
    ]
    return {
        "name": outcome.case,
        "status": outcome.status,
        "message": outcome.message,
        "seconds": f"{outcome.seconds:.2f}",
        "parts": parts,
        "open": outcome.status not in (PASS, "not supported"),
    }


def _status(finding: Finding | None) -> str:
    return "unknown" if finding is None else finding.status


def heat(ratio: Float) -> Float:
    """Excess in tolerances, (H, W) or (H, W, C), as colours (H, W, 3) in 0 .. 1: the worst channel of each pixel.

    Black: within the bounds. Blue: within the tolerance. From red over yellow to white: 1 to 10^4 times the tolerance
    and beyond. Magenta: NaN.
    """
    worst = ratio.reshape(*ratio.shape[:2], -1)
    none = np.isnan(worst).any(axis=-1)
    most = np.where(np.isnan(worst), 0.0, worst).max(axis=-1)
    with np.errstate(divide="ignore"):
        level = np.clip(np.log10(np.maximum(most, 1.0)) / _DECADES, 0.0, 1.0)
    ramp = np.stack([0.6 + 0.8 * level, 2.0 * level - 0.3, 3.0 * level - 2.0], axis=-1)
    colors = np.where((most > 1.0)[..., None], np.clip(ramp, 0.0, 1.0), 0.0)
    colors[(most > 0.0) & (most <= 1.0)] = (0.1, 0.2, 0.5)
    colors[none] = _MAGENTA
    return colors


def _double(part: Part) -> tuple[Float, Float]:
    return part.low.astype(np.float64), part.high.astype(np.float64)


def _span(golden: Float) -> tuple[float, float]:
    """What is black and what is white: light from 0 to all but the brightest; a map from its least to its greatest."""
    finite = golden[np.isfinite(golden)]
    if not finite.size:
        return 0.0, 1.0
    least, most = float(finite.min()), float(finite.max())
    if golden.ndim == 3:
        least, most = 0.0, float(np.quantile(finite, 0.995)) or most
    return least, most if most > least else least + 1.0


def _shown(values: Float, span: tuple[float, float]) -> Float:
    """Colours (H, W, 3) in 0 .. 1: light encoded for a display, other maps as they are; NaN is magenta."""
    low, high = span
    scaled = np.clip((values.astype(np.float64) - low) / (high - low), 0.0, 1.0)
    none = np.isnan(values.reshape(*values.shape[:2], -1)).any(axis=-1)
    colors = scaled.reshape(*scaled.shape[:2], -1)[..., :3]
    if colors.shape[2] != 3:
        colors = np.repeat(colors[..., :1], 3, axis=-1)
    shown: Float = colors ** (1.0 / 2.2) if values.ndim == 3 else colors.copy()
    shown[none] = _MAGENTA
    return shown


def _png(colors: Float) -> str:
    """Colours as a PNG file in base64; of large ones every n-th pixel, the brightest of each block."""
    step = -(-max(colors.shape[:2]) // _LONGEST_SIDE)
    height, width = (-(-side // step) for side in colors.shape[:2])
    padded = np.zeros((height * step, width * step, 3))
    padded[: colors.shape[0], : colors.shape[1]] = colors
    blocks = padded.reshape(height, step, width, step, 3).max(axis=(1, 3))
    return base64.b64encode(png_bytes(linear_from_display(blocks))).decode("ascii")
