"""The light that leaves a point, against the formulas of `refdof.scene` taken in world space, point by point."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from refdof import Camera, Light, Material, Part, Scene, ThinLens
from refdof._jit.compile import tile_kernel
from refdof.raster.rays.shading import lit, shade
from refdof.raster.rays.surfaces import surfaces_of

pytestmark = pytest.mark.fast
COUNT = 40  # points per material
CAMERA = Camera.look_at((3.0, 2.0, 1.0), (-1.0, 0.5, 0.2), (0.1, 1.0, 0.3), 40.0, (8, 6))
RANDOM = np.random.default_rng(6)
TEXTURE, PAINTED = RANDOM.random((3, 4, 3)).astype(np.float32), RANDOM.random((5, 5, 3)).astype(np.float32)


@tile_kernel
def shade_all(surfaces, faces, places, directions):
    out = np.empty((len(faces), 3))
    for k in range(len(faces)):
        dx, dy, dz = directions[k]
        out[k, 0], out[k, 1], out[k, 2] = shade(surfaces, faces[k], places[k, 0], places[k, 1], dx, dy, dz)
    return out


@tile_kernel
def lit_in(surfaces, dx, dy, dz):
    return lit(surfaces, (0.0, 0.0, 1.0), (dx, dy, dz), (0.2, 0.3, 0.4), (0.5, 0.6, 0.7), 5.0)


MATERIALS = [
    Material("phong", (0.6, 0.5, 0.3), TEXTURE, specular=(0.4, 0.3, 0.5), shininess=5.0, emission=(0.0, 0.2, 0.1)),
    Material("lambert", (0.2, 0.8, 0.4), specular=(0.4, 0.3, 0.5)),  # specular is used by phong only
    Material("unlit", (0.5, 0.7, 0.9), TEXTURE, emission=(0.1, 0.0, 0.3)),
    Material("lambert", (0.5, 0.7, 0.9), TEXTURE, (0.1, 2.0, 0.3), emission_texture=PAINTED, wrap=("mirror", "clamp")),
    Material("unlit", (0.5, 0.7, 0.9), PAINTED, wrap=("clamp", "mirror")),
]


def tents(place, count):
    """Weights of texels 0 .. count - 1 with centres at whole numbers, at `place`."""
    return np.maximum(0.0, 1.0 - np.abs(place - np.arange(count)))


def texel(image, s, t, wrap=("repeat", "repeat")):
    """An endless wall of copies of the image, of mirrored copies, or of its rim, seen at (s, t), t up."""
    height, width = image.shape[:2]
    modes = [{"repeat": "wrap", "mirror": "symmetric", "clamp": "edge"}[word] for word in wrap]
    wall = np.pad(image.astype(float), ((3 * height,) * 2, (0, 0), (0, 0)), modes[1])  # three copies to each side
    wall = np.pad(wall, ((0, 0), (3 * width,) * 2, (0, 0)), modes[0])
    across, down = tents((s + 3.0) * width - 0.5, 7 * width), tents((4.0 - t) * height - 0.5, 7 * height)
    return np.einsum("y,x,yxc->c", down, across, wall)


def environment(light, direction):
    """The dome, or the octahedral map: its faces side by side, the lower half folded outwards."""
    if light.environment is None:
        return light.ground + (np.array(light.sky) - light.ground) * (1.0 + direction[1]) / 2.0
    x, y, z = direction / np.abs(direction).sum()
    if y < 0.0:
        x, z = np.copysign(1.0 - abs(z), x), np.copysign(1.0 - abs(x), z)
    size = len(light.environment)
    p, q = (np.clip((v + 1.0) / 2.0 * size - 0.5, 0.0, size - 1.0) for v in (x, z))
    return np.einsum("y,x,yxc->c", tents(q, size), tents(p, size), light.environment.astype(float))


def expected(part, light, u, v, direction):
    """Colour at barycentrics (u, v) of a part's only triangle, seen along `direction` in world space."""
    weights, material = np.array([1.0 - u - v, u, v]), part.material
    albedo = np.array(material.base_color) * (weights @ part.color)
    if material.texture is not None:
        albedo = albedo * texel(material.texture, *(weights @ part.uv), material.wrap)
    emission = np.array(material.emission)
    if material.emission_texture is not None:
        emission = emission * texel(material.emission_texture, *(weights @ part.uv), material.wrap)
    if material.shading == "unlit":
        return albedo + emission
    direction = direction / np.linalg.norm(direction)
    a, b, c = part.vertices
    flat = np.cross(b - a, c - a)
    flat = flat if flat @ direction < 0.0 else -flat  # the side that the ray meets
    normal = weights @ part.normal
    normal = normal / np.linalg.norm(normal) * (1.0 if normal @ flat > 0.0 else -1.0)
    sun, ground, sky = np.array(light.sun), np.array(light.ground), np.array(light.sky)
    to_sun = np.array(light.sun_direction)
    light_in = sun * max(0.0, normal @ to_sun) + ground + (sky - ground) * (1.0 + normal[1]) / 2.0
    color = albedo * light_in + emission
    if material.shading == "phong":
        mirrored = direction - 2.0 * (direction @ normal) * normal
        lobe = max(0.0, mirrored @ to_sun) ** material.shininess
        color = color + np.array(material.specular) * (sun * lobe + environment(light, mirrored))
    return color


def parts_of(random, material):
    """Triangles anywhere, with normals up to 60 degrees from the flat one, on either side."""
    for _ in range(COUNT):
        corners = random.normal(0.0, 1.0, (3, 3))
        flat = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        lean = random.normal(0.0, 0.4, (3, 3)) + random.choice([-1.0, 1.0]) * flat / np.linalg.norm(flat)
        normal = lean / np.linalg.norm(lean, axis=1, keepdims=True)
        uv = random.uniform(-2.0, 3.0, (1, 2)) + random.uniform(-0.4, 0.4, (3, 2))
        yield Part(corners, [[0, 1, 2]], material, uv, random.uniform(0.2, 1.0, (3, 3)), normal)


@pytest.mark.parametrize("material", MATERIALS, ids=lambda material: material.shading)
@pytest.mark.parametrize("painted", [False, True])
def test_colours_by_the_formulas(material, painted):
    random = np.random.default_rng(9)
    light = Light((0.3, 0.5, -0.8), (2.0, 1.5, 1.0), (0.2, 0.4, 0.9), (0.5, 0.1, 0.2), PAINTED if painted else None)
    parts = list(parts_of(random, material))
    surfaces = surfaces_of(Scene.from_parts("triangles", parts, CAMERA, ThinLens(0.1, 2.0), light=light), CAMERA)
    places = random.dirichlet(np.ones(3), COUNT)[:, :2]
    directions = random.normal(0.0, 1.0, (COUNT, 3))  # world space
    turned = directions @ CAMERA.rotation.T
    found = shade_all(surfaces, np.arange(COUNT), places, turned)
    wanted = [expected(part, light, *uv, d) for part, uv, d in zip(parts, places, directions, strict=True)]
    # Attributes are float32: 6e-8 of a value up to 3, of normals and of texture coordinates. A texture of 4 texels and
    # a map of 5 grow by a few per unit, a lobe of exponent 5 by 5.
    assert_allclose(found, wanted, atol=2e-5)


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_length_of_a_direction_means_nothing(axis, sign):
    """Rays of a huge lens are so steep that their squares overflow, along whichever axis."""
    light = Light((0.3 * sign, 0.5 * sign, 0.8 * sign), (2.0, 1.5, 1.0), (0.2, 0.4, 0.9), (0.5, 0.1, 0.2), PAINTED)
    camera = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y=40.0, size=(8, 6))  # whose axes are the world's
    parts = [Part(np.eye(3), [[0, 1, 2]])]
    surfaces = surfaces_of(Scene.from_parts("one", parts, camera, ThinLens(0.1, 2.0), light=light), camera)
    short = sign * np.eye(3)[axis]
    look = [lit_in(surfaces, *(short * 2.0**power)) for power in (0, 600)]  # 4e180
    assert_allclose(look[1], look[0], rtol=1e-14)  # a division by the largest part rounds


def test_the_unit_of_length_is_a_power_of_two():
    corners = np.array([[100.0, 20.0, -3.0], [7.0, -90.0, 4.0], [0.5, 0.25, 30.0]])
    scene = Scene.from_parts("large", [Part(corners, [[0, 1, 2]])], CAMERA, ThinLens(0.1, 2.0))
    surfaces = surfaces_of(scene, CAMERA)
    seen = (corners - CAMERA.eye) @ CAMERA.rotation.T
    assert_allclose(surfaces.corner[0] * 2.0**surfaces.exponent, seen.ravel(), rtol=1e-13)
    assert 0.5 <= np.abs(surfaces.corner).max() < 1.0  # what float32 holds best


def test_a_shared_texture_is_stored_once():
    other = np.full((2, 5, 3), 0.5, dtype=np.float32)
    textures = [TEXTURE, None, other, TEXTURE]
    parts = [Part(np.eye(3) + k, [[0, 1, 2]], Material(texture=texture)) for k, texture in enumerate(textures)]
    surfaces = surfaces_of(Scene.from_parts("textures", parts, CAMERA, ThinLens(0.1, 2.0)), CAMERA)
    assert_array_equal(surfaces.texture, [[0, 4, 3, 0, 0], [0, 0, 0, 0, 0], [12, 5, 2, 0, 0], [0, 4, 3, 0, 0]])
    assert_array_equal(surfaces.texels, np.concatenate([TEXTURE.reshape(-1, 3), other.reshape(-1, 3)]))


def test_a_third_texture_starts_behind_the_second():
    sizes = [(1, 2), (3, 1), (2, 2)]
    textures = [np.full((*size, 3), k / 4, dtype=np.float32) for k, size in enumerate(sizes)]
    parts = [Part(np.eye(3) + k, [[0, 1, 2]], Material(texture=texture)) for k, texture in enumerate(textures)]
    surfaces = surfaces_of(Scene.from_parts("textures", parts, CAMERA, ThinLens(0.1, 2.0)), CAMERA)
    assert_array_equal(surfaces.texture[:, :3], [[0, 2, 1], [2, 1, 3], [5, 2, 2]])
    assert_array_equal(surfaces.texels[:, 0], [0.0] * 2 + [0.25] * 3 + [0.5] * 4)
