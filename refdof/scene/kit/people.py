"""People: standing figures of round cones, after classical statues, and draped cloth."""

import numpy as np

from refdof._check import Float
from refdof.scene.kit.mesh import Mesh, join, rotation
from refdof.scene.kit.noise import Noise3
from refdof.scene.kit.sculpt import Body, merged, sculpt, soft_union

__all__ = ["POSES", "draped", "figure", "head", "statue"]

# Joints of four poses [units: about metres]; x is the figure's left-right, +z its front.
POSES: dict[str, dict[str, tuple[float, float, float]]] = {
    "orator": {
        "elbow l": (0.34, 1.26, 0.12),
        "hand l": (0.42, 1.50, 0.30),
        "elbow r": (-0.30, 1.13, -0.05),
        "hand r": (-0.22, 0.93, 0.12),
        "knee l": (0.11, 0.50, 0.12),
        "foot l": (0.14, 0.06, 0.02),
        "knee r": (-0.10, 0.50, 0.02),
        "foot r": (-0.11, 0.06, -0.05),
    },
    "dancer": {
        "elbow l": (0.36, 1.58, 0.02),
        "hand l": (0.16, 1.84, 0.08),
        "elbow r": (-0.42, 1.32, 0.05),
        "hand r": (-0.66, 1.46, 0.12),
        "knee l": (0.09, 0.50, 0.02),
        "foot l": (0.05, 0.06, 0.0),
        "knee r": (-0.22, 0.60, 0.20),
        "foot r": (-0.10, 0.34, 0.02),
    },
    "thinker": {
        "elbow l": (0.27, 1.12, 0.12),
        "hand l": (0.06, 1.16, 0.24),
        "elbow r": (-0.20, 1.19, 0.20),
        "hand r": (-0.05, 1.42, 0.19),
        "knee l": (0.10, 0.50, 0.05),
        "foot l": (0.11, 0.06, -0.02),
        "knee r": (-0.12, 0.52, 0.12),
        "foot r": (-0.18, 0.06, 0.12),
    },
    "archer": {
        "elbow l": (0.46, 1.42, 0.10),
        "hand l": (0.72, 1.45, 0.14),
        "elbow r": (-0.42, 1.45, -0.06),
        "hand r": (-0.14, 1.47, 0.12),
        "knee l": (0.20, 0.52, 0.14),
        "foot l": (0.30, 0.06, 0.12),
        "knee r": (-0.18, 0.50, 0.0),
        "foot r": (-0.26, 0.06, -0.14),
    },
}


def head(at: tuple[float, float, float], size: float, turn: float = 0.0, nod: float = 0.0) -> Float:
    """Cones (K, 9) of a neck and a head: skull, jaw, brows, eyes, nose, lips, ears and curls.

    `size` 1 is a head 0.23 high; it is turned to its left and nods [degrees].
    """

    def cone(
        ax: float, ay: float, az: float, bx: float, by: float, bz: float, ra: float, rb: float
    ) -> tuple[float, ...]:
        return (ax, ay, az, bx, by, bz, ra, rb, 1.0)

    cones = [
        cone(0, 0.055, -0.02, 0, 0.055, 0.012, 0.084, 0.079),  # skull
        cone(0, 0.02, 0.025, 0, -0.045, 0.035, 0.068, 0.055),  # face
        cone(0, -0.05, 0.04, 0, -0.085, 0.058, 0.045, 0.024),  # jaw and chin
        cone(0, 0.03, 0.092, 0, -0.014, 0.112, 0.007, 0.012),  # nose
        cone(-0.013, -0.041, 0.089, 0.013, -0.041, 0.089, 0.007, 0.007),  # lips
        cone(-0.010, -0.053, 0.087, 0.010, -0.053, 0.087, 0.0075, 0.0075),
    ]
    for s in (-1, 1):  # brows, eyes, cheeks
        cones.append(cone(s * 0.012, 0.040, 0.091, s * 0.048, 0.038, 0.070, 0.009, 0.007))
        cones.append(cone(s * 0.031, 0.018, 0.077, s * 0.035, 0.018, 0.075, 0.0125, 0.0115))
        cones.append(cone(s * 0.040, -0.012, 0.062, s * 0.048, 0.0, 0.042, 0.028, 0.026))
    cones += [cone(s * 0.078, 0.02, 0.0, s * 0.08, -0.02, 0.002, 0.015, 0.009) for s in (-1, 1)]
    for k in range(26):
        a, b = 2.4 * k, 0.15 + 0.85 * (k + 0.5) / 26
        px, pz, py = np.sin(a) * np.sin(1.9 * b), -0.15 + np.cos(a) * np.sin(1.9 * b), np.cos(1.9 * b)
        if pz < 0.45 or py > 0.55:
            cones.append(
                cone(
                    0.082 * px,
                    0.06 + 0.088 * py,
                    -0.01 + 0.085 * pz,
                    0.09 * px,
                    0.05 + 0.09 * py,
                    -0.012 + 0.09 * pz,
                    0.019,
                    0.016,
                )
            )
    shape = np.array(cones)
    pose = rotation("y", turn) @ rotation("x", nod)
    for k in (0, 3):
        shape[:, k : k + 3] = shape[:, k : k + 3] @ pose.T
    shape = np.concatenate([shape, [(0, -0.19, -0.035, 0, -0.06, -0.01, 0.062, 0.056, 1.0)]])
    shape[:, :8] *= size
    shape[:, :6] += np.tile(at, 2)
    return shape


# Where each looks: turn to its left, nod [degrees].
_LOOK = {"orator": (22.0, -4.0), "dancer": (-28.0, -8.0), "thinker": (-8.0, 16.0), "archer": (52.0, 0.0)}
_TORSO: list[tuple[float, ...]] = [
    (0, 0.96, 0, 0, 1.06, 0, 0.135, 0.115, 0.8),
    (0, 1.06, 0, 0, 1.33, 0, 0.115, 0.145, 0.75),
]
_TORSO += [(s * 0.07, 1.34, 0.06, s * 0.10, 1.32, 0.05, 0.062, 0.058, 1.0) for s in (-1, 1)]
_TORSO += [(s * 0.05, 1.46, -0.02, s * 0.18, 1.42, -0.01, 0.06, 0.068, 1.0) for s in (-1, 1)]


def figure(pose: str, mirrored: bool = False) -> Float:
    """Round cones (K, 9) of a standing person 1.8 high without the head, feet at y = 0."""
    joint = POSES[pose]
    cones: list[tuple[float, ...]] = []

    def limb(a: tuple[float, ...], b: tuple[float, ...], ra: float, rb: float, flat: float = 1.0) -> None:
        cones.append((*a, *b, ra, rb, flat))

    cones += _TORSO
    for s, side in ((1, "l"), (-1, "r")):
        shoulder, hip = (s * 0.18, 1.42, -0.01), (s * 0.085, 0.93, 0.0)
        elbow, hand, knee, foot = (joint[f"{part} {side}"] for part in ("elbow", "hand", "knee", "foot"))
        limb(shoulder, elbow, 0.058, 0.042)
        wrist = tuple(e + 0.92 * (h - e) for e, h in zip(elbow, hand, strict=True))
        limb(elbow, wrist, 0.046, 0.027)
        reach = np.subtract(hand, elbow) / np.linalg.norm(np.subtract(hand, elbow))
        palm = tuple((np.asarray(hand) + 0.05 * reach).tolist())
        limb(wrist, palm, 0.028, 0.036)
        for f in (-1.5, -0.5, 0.5, 1.5):
            tip = np.asarray(palm) + 0.085 * reach + 0.014 * f * np.array([0.5, -0.2, 0.84])
            limb(palm, tuple(tip.tolist()), 0.016, 0.0085)
        limb(hip, knee, 0.095, 0.058)
        calf = tuple((0.35 * np.asarray(foot) + 0.65 * np.asarray(knee) + [0, 0, -0.02]).tolist())
        limb(knee, calf, 0.056, 0.062)
        limb(calf, foot, 0.06, 0.036)
        limb(foot, (foot[0] + s * 0.03, foot[1] - 0.025, foot[2] + 0.15), 0.042, 0.028)
        limb((s * 0.075, 0.92, -0.06), (s * 0.07, 0.86, -0.05), 0.088, 0.07)
    limb((0, 1.45, -0.015), (0, 1.50, -0.01), 0.058, 0.05)
    shape = np.array(cones)
    if mirrored:
        shape[:, [0, 3]] *= -1.0
    return shape


def draped(body: Body, torso: Body, waist: float, hem: float, rng: np.random.Generator, folds: int = 17) -> Body:
    """The body with a skirt from the waist to the hem, in deep folds, and a sash about its torso."""
    noise, phase = Noise3(rng), rng.uniform(0, 6.28)

    def distance(points: Float) -> Float:
        x, y, z = points.T
        bare = body(points)
        angle = np.arctan2(x, z)
        t = np.clip((waist - y) / waist, 0.0, 1.0)
        wave = np.sin(folds * angle + phase + 2.5 * noise(points * [1.5, 1.0, 1.5])) + 0.4 * np.sin(9 * angle + 5 * y)
        radius = 0.155 + 0.13 * t**0.8 + (0.004 + 0.022 * t) * wave
        skirt = (np.hypot(x, z / 0.88) - radius) * 0.75
        skirt = np.maximum(skirt, np.maximum(y - waist - 0.02 * np.sin(3 * angle), hem - y))
        across = (0.62 * x + 0.78 * (y - 1.24)) + 0.02 * np.sin(8 * x + phase)
        sash = np.maximum(np.abs(across) - 0.065, torso(points) - 0.022 - 0.009 * np.sin(95 * across))
        bare = np.minimum(bare, sash)
        return merged(bare, skirt, 0.03)

    return distance


def statue(pose: str, hem: float, cell: float, rng: np.random.Generator, mirrored: bool = False) -> Mesh:
    """Draped person in a pose; the head is cut from a finer grid than the body, down to the neck."""
    sign = -1.0 if mirrored else 1.0
    turn, nod = _LOOK[pose]
    face = soft_union(head((0, 1.64, 0.02), 1.0, sign * turn, nod), 0.011)
    torso, limbs = soft_union(np.array(_TORSO), 0.03), soft_union(figure(pose, mirrored), 0.03)
    body = sculpt(draped(limbs, torso, 1.02, hem, rng), (-0.95, -0.05, -0.5), (0.95, 2.05, 0.55), cell)
    bust = sculpt(lambda p: np.maximum(face(p), 1.44 - p[:, 1]), (-0.16, 1.40, -0.16), (0.16, 1.84, 0.19), 0.33 * cell)
    return join([body, bust])
