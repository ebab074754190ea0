"""Scenes, lenses and pictures with the largest, smallest and oddest numbers that validation lets through."""

import numpy as np

from refdof import Camera, Light, Material, Part, Scene, ThinLens

CAMERA = Camera((0.0, 0.0, 4.0), (0.0, 0.0, 0.0), fov_y=40.0, size=(3, 2))
_CORNERS = np.array([[-9.0, -9.0, 0.0], [9.0, -9.0, 0.0], [0.0, 9.0, 1.0]])
_FACES = np.array([[0, 1, 2]])
_TEXELS = np.linspace(0.125, 1.0, 18).reshape(3, 2, 3)
_ENVIRONMENT = Light(environment=np.linspace(0.0, 1.0, 27).reshape(3, 3, 3))


def _scene(corners=_CORNERS, camera=CAMERA, light=_ENVIRONMENT, lens=None, **words):
    material = Material("phong", (0.5, 0.5, 0.5), _TEXELS, specular=(0.5, 0.5, 0.5), shininess=1e6)
    part = Part(corners, _FACES, **({"material": material} | words))
    behind = Part(corners * (1.5, 1.5, -1.0), _FACES, Material("unlit"))
    return Scene.from_parts("hostile", [part, behind], camera, lens or ThinLens(0.25, 3.0), (0.1, 0.2, 0.3), light)


def _scaled(factor):
    camera = Camera((0.0, 0.0, 4.0 * factor), (0.0, 0.0, 0.0), fov_y=40.0, size=CAMERA.size)
    return _scene(_CORNERS * factor, camera, lens=ThinLens(0.25 * factor, 3.0 * factor))


def _uv(*places):
    return _scene(uv=np.array(places, dtype=float).reshape(3, 2))


_far = _CORNERS.copy()
_far[2] = (0.0, 5e99, 1e99)
_bright = Material("phong", (1e8,) * 3, np.full((2, 2, 3), 1e8), (1e8,) * 3, (1e8,) * 3, 1.0)
_sun = Light(sun=(1e8,) * 3, sky=(1e8,) * 3, ground=(1e8,) * 3, environment=np.full((2, 2, 3), 1e8))

SCENES = {
    "uv 1e25": _uv(1e25, -1e25, 1e25, 1e25, -1e25, 1e25),
    "uv 3e38": _uv(3e38, -3e38, -3e38, 3e38, 3e38, 3e38),
    "uv 2^63": _uv(2.0**63, -(2.0**63), 2.0**62, 2.0**31, -(2.0**31), 2.0**53),
    "uv just below whole": _uv(-1e-30, -1e-45, 1.0 - 2.0**-24, -1e-9, -1.0, 1.0),
    "normals of no length": _scene(normal=np.zeros((3, 3))),
    "normals 3e38": _scene(normal=np.array([[3e38, 0, 0], [-3e38, 0, 3e38], [0, 3e38, 1e-38]])),
    "colours 1e8": _scene(material=_bright, color=np.full((3, 3), 1e8), light=_sun, uv=np.eye(3)[:, :2]),
    "coordinates 1e39": _scaled(1e39),
    "coordinates 1e98": _scaled(1e98),
    "coordinates 1e-100": _scaled(1e-100),
    "one corner at 1e99": _scene(_far),
    "a needle": _scene(np.array([[-9.0, 0.0, 0.0], [9.0, 0.0, 0.0], [0.0, 1e-12, 0.0]])),
}
LENSES = [
    ThinLens(1e300, 3.0), ThinLens(1e300, 1e-300), ThinLens(1e-300, 3.0), ThinLens(0.25, 1e-300), ThinLens(0.25, 1e300),
    ThinLens(1e300, np.inf),
]  # fmt: skip

_RAMP = np.linspace(0.0, 1.0, 18).reshape(2, 3, 3)
_DEPTH = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, np.inf]])
_COC = np.array([[-2.0, -1.0, 0.0], [0.5, 1.0, 1.5]])
_MIX = np.array([[-3e38, 1e-40, 3e38], [1e300, -1e300, 0.0]])
PICTURES = {  # colour, depth, circle of confusion
    "colours 1e33": (_RAMP * 1e33, _DEPTH, _COC),
    "colours of both signs": ((_RAMP - 0.5) * 2e33, _DEPTH, _COC),
    "denormal colours": (_RAMP * 1e-44, _DEPTH, _COC),
    "circles of all sizes": (_RAMP, _DEPTH, _MIX),
    "circles 1e300": (_RAMP, _DEPTH, np.full((2, 3), 1e300)),
    "circles -1e300": (_RAMP, _DEPTH, np.full((2, 3), -1e300)),
    "depths 1e-300": (_RAMP, _DEPTH * 1e-300, _COC),
    "depths 1e300": (_RAMP, _DEPTH * 1e300, _COC),
    "depths of all sizes": (_RAMP, np.array([[5e-324, 1e-300, 1e-38], [1.0, 1e300, np.inf]]), _MIX),
    "nothing but background": (_RAMP, np.full((2, 3), np.inf), _COC),
    "one pixel": (_RAMP[:1, :1] * 1e33, _DEPTH[:1, :1] * 1e-300, _MIX[:1, :1]),
}
