"""Embree's tree splits long thin triangles: no ray slips through their edges, and each is found."""

import numpy as np
import pytest

import refdof
from refdof import Part, ThinLens, View
from tests import flat_scene

P, SIZE, DEPTH = 64.0, 32, 2.0


def slanted_strips(step, tilt):
    """A wall through the focus, more or less tilted, of long thin triangles at 45 degrees.

    Strip k lies between the lines x + y = k step and (k + 1) step [px], which pass through pixel centres; it reaches
    far beyond the picture, and its diagonal passes through pixel centres, too.
    """
    along = np.arange(-4 * SIZE, 6 * SIZE + 1, step) * 0.5
    ends = np.stack([np.stack([along + far, along - far], axis=-1) for far in (-2.0 * SIZE, 2.0 * SIZE)], axis=1) + 0.5
    a, b, c, d = ends[:-1, 0], ends[:-1, 1], ends[1:, 1], ends[1:, 0]
    corners = np.stack([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)], axis=1).reshape(-1, 2)
    right, up = (corners[:, 0] - 0.5 * SIZE) / P, (0.5 * SIZE - corners[:, 1]) / P
    depth = DEPTH / (1.0 + tilt * (0.83 * right + 0.56 * up))
    return np.stack([right * depth, up * depth, -depth], axis=-1)


@pytest.mark.long
@pytest.mark.fast
@pytest.mark.parametrize("tilt", [0.0, 0.1, 0.31])
@pytest.mark.parametrize("step", [1, 2, 3])
def test_no_ray_slips_through_an_edge(step, tilt):
    vertices = slanted_strips(step, tilt)
    wall = Part(vertices, np.arange(len(vertices)).reshape(-1, 3), flat_scene.paint((1.0, 1.0, 1.0)))
    camera, lens = flat_scene.camera(SIZE, SIZE, P), ThinLens(0.3, DEPTH)
    scene = flat_scene.scene_of([wall], camera, lens, (1000.0, 1000.0, 1000.0))
    assert (View(scene, camera, lens).layers(1).triangle[0] >= 0).all()
    # Where the wall is in focus, every ray of a pixel meets it in the same point of an edge, from another side.
    assert (refdof.reference(scene, camera, lens, samples=16).image == 1.0).all()
