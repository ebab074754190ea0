"""Promises: the properties a method may claim. The contract test checks every claim of every method.

A promise holds in every scene: with things before, in and behind the focal plane, across the border of the picture, and
lights brighter than white. It holds but for roundings, and, where a method samples the lens, for the error of so many
samples. "Near" is measured in the largest circle of confusion of the picture, see `REACH`.
"""

__all__ = ["PROMISES", "REACH"]

REACH = 5.0
"""How far blurs may spread, in radii of the largest circle of confusion. A disc has 1; a Gaussian that is cut at three
standard deviations 1.5; pyramids of 4 x 4 means up to 12 / 2.55 = 4.7: n levels, which spread over 3 2^n px to a side,
are for circles above 2.55 2^(n - 2) px."""

PROMISES: dict[str, str] = {
    "constant": "where all surfaces and the background have one colour, every pixel has it, whatever their depths",
    "pinhole": "with a lens of radius 0, every pixel has the colour of the surface that the pinhole sees",
    "focus": "a pixel that sees the focal plane keeps its colour, unless something out of focus is near",
    "convexity": "no channel is below its least or above its greatest value among surfaces, lights and background",
    "energy": "a light that nothing hides adds the same total to the picture, wherever the lens is focused",
    "symmetry": "the scene mirrored from left to right gives the picture mirrored from left to right",
    "occlusion": "what only parts of the lens see past a nearer thing shows by that share of the lens, within a tenth",
}
