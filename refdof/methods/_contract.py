"""Method records: what the command line, the report, the docs and the tests know of a method, in one place.

Every module in `refdof/methods` has `METHOD`, a `Method`. Nothing else about a method is listed anywhere.

A promise holds in every scene: with things before, in and behind the focal plane, across the border of the picture, and
lights brighter than white. It holds but for roundings, and, where a method samples the lens, for the error of so many
samples. "Near" is measured in the largest circle of confusion of the picture, see `REACH`.

Texture reads are counted per pixel. A method whose reads follow from its parameters and the picture's
size counts its loops with the constants that they run with. As in [1], table 1, reads of textures inside filters count,
each bilinear or trilinear one as one; a pixel's own texel outside of a filter and what the driver does by itself do
not.

References
----------
.. [1] Lee, Kim, Choi (2009), Real-Time Depth-of-Field Rendering Using Anisotropically Filtered Mipmap Interpolation.
"""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field, fields
from typing import Any

from refdof._check import as_choice
from refdof.stages import Stage

__all__ = ["BASES", "KINDS", "LARGEST_RADIUS", "MEAN_RADIUS", "PROMISES", "REACH", "Method", "facts_of", "level_shares"]

REACH = 5.0
"""How far blurs may spread, in radii of the largest circle of confusion. A disc has 1; a Gaussian that is cut at three
standard deviations 1.5; pyramids of 4 x 4 means up to 12 / 2.55 = 4.7: n levels, which spread over 3 2^n px to a side,
are for circles above 2.55 2^(n - 2) px."""

LARGEST_RADIUS = 8.0  # px, [1], table 1: the largest circle of confusion is 16 px wide
MEAN_RADIUS = 4.0  # px, [1], table 1, note

KINDS: dict[str, str] = {
    "reference views": "averages pictures of the scene from points of the lens",
    "layers": "draws the scene once, as several surfaces per pixel",
    "single image": "filters the pinhole picture with its depth; hidden surfaces cannot be recovered",
}

BASES: dict[str, str] = {
    "paper": "its paper, or what its author published of it",
    "engine": "the source code of an engine that ships it",
    "reconstruction": "pieced together: the text of its source was not at hand",
}

PROMISES: dict[str, str] = {
    "constant": "where all surfaces and the background have one colour, every pixel has it, whatever their depths",
    "pinhole": "with a lens of radius 0, every pixel has the colour of the surface that the pinhole sees",
    "focus": "a pixel that sees the focal plane keeps its colour, unless something out of focus is near",
    "convexity": "no channel is below its least or above its greatest value among surfaces, lights and background",
    "energy": "a light that nothing hides adds the same total to the picture, wherever the lens is focused",
    "symmetry": "the scene mirrored from left to right gives the picture mirrored from left to right",
    "occlusion": "what only parts of the lens see past a nearer thing shows by that share of the lens, within a tenth",
}


@dataclass(frozen=True)
class Method:
    """A method's record.

    Attributes
    ----------
    citation : str
        Its key in papers.bib.
    source : str
        Authors and year, in words.
    kind : one of `KINDS`
        A "single image" method also has `blur(color, depth, coc, params)`, on plain arrays.
    inputs : raster products that it needs, in words
    params : type
        Its `Params`.
    promises : names in `PROMISES`
        What holds for it. The contract tests check every one.
    texture_reads : callable or None
        (params, width, height) -> texture reads per pixel; None: they depend on the scene.
    known_defects : one short sentence each
        What it gets wrong by design, its paper included.
    paper : {parameter: value}
        Where its paper's text differs from the defaults of `params`: the preset "paper".
    basis : one of `BASES`
        What it was written after.
    stages : Stages that it records; empty: not declared yet
    kernel : (radius, energy) or None
        What it makes of a light of one pixel behind focus where circles are 8 px: RMS radius over the disc's, and
        energy over the light's, as `refdof.kernel_shape.kernel_shape` measures them. None: not measured.
    tradeoff : (parameter, values) or None
        The parameter that trades speed for accuracy most, and values to try, from fast to slow. None: there is none.

    Raises
    ------
    InputError
        If the kind, the basis, a promise or a field of `paper` does not exist.
    """

    citation: str
    source: str
    kind: str
    inputs: tuple[str, ...]
    params: type[Any]
    promises: tuple[str, ...]
    texture_reads: Callable[[Any, int, int], float] | None
    known_defects: tuple[str, ...]
    paper: Mapping[str, Any] = field(default_factory=dict)
    basis: str = "paper"
    stages: tuple[Stage, ...] = ()
    tradeoff: tuple[str, tuple[Any, ...]] | None = None
    kernel: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        as_choice("kind", self.kind, KINDS)
        as_choice("basis", self.basis, BASES)
        for promise in self.promises:
            as_choice("promises", promise, PROMISES)
        for name in self.paper:
            as_choice("paper", name, self.defaults())
        if self.tradeoff is not None:
            as_choice("tradeoff", self.tradeoff[0], self.defaults())

    @property
    def origin(self) -> str:
        """`source`, and what it is, where it is no paper."""
        return self.source + ("" if self.basis == "paper" else f" ({self.basis})")

    @property
    def reconstruction(self) -> bool:
        """Whether the source was not at hand."""
        return self.basis == "reconstruction"

    def defaults(self) -> dict[str, Any]:
        """The default of every parameter."""
        params = self.params()
        return {entry.name: getattr(params, entry.name) for entry in fields(params)}

    def reads_per_pixel(self, width: int, height: int) -> float | None:
        """Texture reads per pixel with the default parameters, for a picture of this size [px]."""
        return None if self.texture_reads is None else float(self.texture_reads(self.params(), width, height))

    def reads_in_words(self, width: int, height: int) -> str:
        """`reads_per_pixel` for people."""
        reads = self.reads_per_pixel(width, height)
        if reads is None:
            return "reads depend on the scene"
        return f"{reads:.2f} texture reads per pixel" if reads else "no textures"


def facts_of(method: Method, width: int, height: int) -> dict[str, Any]:
    """The record as plain values, for a picture of this size [px]: what `refdof methods --json` tells."""
    return {
        "citation": method.citation,
        "source": method.source,
        "basis": method.basis,
        "reconstruction": method.reconstruction,
        "inputs": method.inputs,
        "texture_reads_per_pixel": method.reads_per_pixel(width, height),
        "paper": dict(method.paper),
        "params": method.defaults(),
        "kind": method.kind,
        "promises": method.promises,
        "kernel": None if method.kernel is None else dict(zip(("radius", "energy"), method.kernel, strict=True)),
        "known_defects": method.known_defects,
        "stages": [asdict(stage) for stage in method.stages],
        "tradeoff": None if method.tradeoff is None else {method.tradeoff[0]: method.tradeoff[1]},
    }


def level_shares(width: int, height: int, count: int) -> list[float]:
    """Texels of mip levels 1 .. `count` per pixel of the picture."""
    sizes = [max(1, width >> k) * max(1, height >> k) for k in range(1, count + 1)]
    return [size / (width * height) for size in sizes]
