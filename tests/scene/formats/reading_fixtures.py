"""What tests of readers look at: areas, colours and triangles of a loaded scene."""

import numpy as np


def area_of(scene):
    a, b, c = (scene.vertices[scene.faces[:, k]] for k in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2


def triangles(scene):
    """Each triangle's corners from its least one on: its way round stays."""
    return sorted(_turned(scene.vertices[face].tolist()) for face in scene.faces)


def _turned(triangle):
    first = triangle.index(min(triangle))
    return triangle[first:] + triangle[:first]


def material_at(scene, point):
    """The material of the triangle in whose plane box the point lies: tests place one there."""
    return scene.materials[scene.face_material[face_at(scene, point)]]


def face_at(scene, point):
    center = scene.vertices[scene.faces].mean(axis=1)
    return int(np.argmin(np.abs(center - point).sum(axis=1)))


def color_at(scene, corner):
    """Linear colours of all vertices at a place."""
    there = (scene.vertices == corner).all(axis=1)
    return np.unique(scene.color[there], axis=0).tolist()


def uv_of(scene, face):
    """Texture coordinates by corner, of one triangle."""
    return {tuple(scene.vertices[v].tolist()): tuple(scene.uv[v].tolist()) for v in scene.faces[face]}
