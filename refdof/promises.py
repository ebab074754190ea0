"""Promises: the properties a method may claim. The contract test checks every claim of every method."""

__all__ = ["PROMISES"]

PROMISES: dict[str, str] = {
    "constant": "a scene of one colour stays that colour",
    "pinhole": "a lens of radius 0 gives the pinhole picture",
    "focus": "what lies in the focal plane stays sharp",
    "convexity": "no value leaves the range of the colours that went in",
    "energy": "an isolated light keeps its total, wherever it is focused",
    "symmetry": "a mirrored scene gives the mirrored picture",
    "occlusion": "what a near object hides is seen past its blurred edge",
}
