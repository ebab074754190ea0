"""The built-in scenes: what their files promise, looked at through Embree's own rays."""

from pathlib import Path

import numpy as np
import pytest
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene

from refdof._check import InputError
from refdof.optics.lens import ThinLens
from refdof.scene.builtin import SCENES, built_in, shot_of
from refdof.scene.kit.mesh import join, rotation
from refdof.scene.kit.noise import Noise3, fractal
from refdof.scene.kit.sculpt import sculpt, soft_union
from refdof.scene.kit.shapes import arch, box, lathe, leaf, plane, sphere, torus, tube
from refdof.scene.kit.shot import parse_shot
from refdof.scene.kit.studio import directions
from refdof.scene.kit.textures import bricks, paint

TRIANGLES = {"town": (80_000, 130_000), "figures": (500_000, 700_000)}  # what the papers' tables speak of
WIDTH, HEIGHT = 160, 120  # rays per picture: enough for shares of the picture, quick to trace


@pytest.fixture(scope="module")
def made():
    """Every scene, made once when first asked for."""
    found = {}

    def get(name):
        if name not in found:
            found[name] = built_in(name)
        return found[name]

    return get


class Rays:
    """Pixel-centre rays through a scene; built on Embree alone, without the package's own ray caster."""

    def __init__(self, scene, width=WIDTH, height=HEIGHT):
        self.camera = scene.camera.with_size((width, height))
        points = scene.vertices - np.array(self.camera.eye)
        self.scene = EmbreeScene()
        TriangleMesh(self.scene, (points @ self.camera.rotation.T).astype(np.float32), scene.faces.astype(np.int32))
        x, y = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
        tangent = self.camera.pixels_per_tangent
        to = np.stack([(x - width / 2) / tangent, (height / 2 - y) / tangent, -np.ones_like(x)], axis=-1)
        self.directions = to.reshape(-1, 3).astype(np.float32)

    def depth(self):
        """Planar depth (N,) of the nearest surface, inf where there is none: a ray's z is -1."""
        hit = self.scene.run(np.zeros_like(self.directions), self.directions, output=1)
        return np.where(hit["primID"] >= 0, hit["tfar"], np.inf)

    def surfaces(self):
        """How many surfaces (N,) each ray crosses."""
        count = np.zeros(len(self.directions), dtype=int)
        active, far = np.arange(len(count)), np.zeros(len(count))
        while len(active):
            along = self.directions[active]
            # Start past the last surface by about 20 float32 roundings of its distance, or it is met again.
            start = along * (far[active] * (1 + 2e-6))[:, None].astype(np.float32)
            hit = self.scene.run(start, along, output=1)
            met = hit["primID"] >= 0
            active = active[met]
            count[active] += 1
            far[active] = far[active] * (1 + 2e-6) + hit["tfar"][met]
        return count


def coc(scene, depth):
    """Signed circle of confusion at 800 x 600, from the formula P E (1 / focus - 1 / depth) itself."""
    tangent = 600.0 / (2.0 * np.tan(np.radians(scene.camera.fov_y) / 2.0))
    return tangent * scene.lens.radius * (1.0 / scene.lens.focus_distance - 1.0 / depth)


NINE = ("cans", "atrium", "fence", "branches", "lights", "mirrors", "foliage", "town", "figures")


def test_names_and_order():
    assert SCENES[:9] == NINE
    assert list(SCENES[9:]) == sorted(SCENES[9:])  # those without an order come last, by name
    folder = Path(__file__).parents[2] / "data" / "scenes"
    assert {file.stem for file in folder.glob("*.toml")} == set(SCENES)  # no file without its module
    assert [shot_of(name).order for name in NINE] == list(range(1, 10))


def test_an_unknown_scene_is_named():
    with pytest.raises(InputError, match=r"^scene: got 'fense'; did you mean 'fence'\?"):
        built_in("fense")


@pytest.mark.parametrize("name", SCENES)
def test_arrays_are_sound(made, name):
    scene = made(name)
    assert scene.name == name
    assert scene.dropped_faces == 0
    for array in (scene.vertices, scene.uv, scene.color, scene.normal):
        assert np.isfinite(array).all()
    assert scene.faces.min() >= 0
    assert scene.faces.max() < len(scene.vertices)
    assert scene.color.min() >= 0.0
    # Normals are unit vectors stored as float32: three roundings of 6e-8 in the squared length.
    np.testing.assert_allclose(np.linalg.norm(scene.normal, axis=1), 1.0, atol=1e-6)
    for material in scene.materials:
        if material.texture is not None:
            assert max(material.texture.shape[:2]) <= 1024
    low, high = TRIANGLES.get(name, (10_000, 300_000))
    assert low <= len(scene.faces) <= high


@pytest.mark.parametrize("name", [n for n in SCENES if n != "figures"])
def test_the_same_bits_at_every_call(made, name):
    first, second = made(name), built_in(name)
    for key in ("vertices", "faces", "uv", "color", "normal", "face_material"):
        np.testing.assert_array_equal(getattr(first, key), getattr(second, key))
    for one, other in zip(first.materials, second.materials, strict=True):
        if one.texture is not None:
            np.testing.assert_array_equal(one.texture, other.texture)


@pytest.mark.parametrize("name", SCENES)
def test_the_camera_sees_no_holes(made, name):
    assert np.isfinite(Rays(made(name)).depth()).all()


@pytest.mark.parametrize("name", SCENES)
def test_blur_is_on_the_papers_scale(made, name):
    """Something is in focus; the rest is blurred by 10 to 30 pixels on average, at 800 x 600 or 1024 x 768."""
    scene = made(name)
    blur = coc(scene, Rays(scene).depth())
    assert (np.abs(blur) < 1.5).mean() > 0.015
    means = [np.abs(blur[side]).mean() for side in (blur < -3.0, blur > 3.0) if side.mean() > 0.05]
    # 1.28 = 1024 / 800: circles grow with the picture.
    assert any(10.0 <= mean * size <= 30.0 for mean in means for size in (1.0, 1.28))
    assert np.abs(blur).mean() < 30.0


def test_cans_recede_behind_the_first(made):
    blur = coc(made("cans"), Rays(made("cans")).depth())
    assert (blur > 3.0).mean() > 0.5
    assert blur.max() > 20.0


def test_atrium_is_blurred_in_front_only(made):
    blur = coc(made("atrium"), Rays(made("atrium")).depth()).reshape(HEIGHT, WIDTH)
    assert blur.min() < -20.0
    assert blur.max() < 3.0
    assert abs(blur[60, 80]) < 1.0  # the door in the far wall


def test_fence_hides_a_sharp_garden(made):
    blur = coc(made("fence"), Rays(made("fence")).depth())
    bars = blur < -15.0
    assert 0.2 < bars.mean() < 0.6
    assert np.abs(blur[~bars]).max() < 2.0  # nothing is half blurred


def test_branches_lie_on_both_sides_of_focus(made):
    scene = made("branches")
    depth, focus = Rays(scene).depth(), scene.lens.focus_distance
    before, screen = depth < 0.95 * focus, depth > 1.5 * focus
    behind = ~screen & (depth > 1.05 * focus)
    assert before.mean() > 0.03
    assert behind.mean() > 0.03
    # No part of either branch touches the focal plane: only the butterfly does.
    assert (np.abs(depth / focus - 1.0) < 0.05).mean() < 0.05


def test_lights_shine_before_and_behind(made):
    scene = made("lights")
    peak = scene.color.max(axis=1)
    shining = peak > 15.0
    # Lamps of radiance 20 to 200, and nothing between them and lit windows: float32 may round 20 down.
    assert peak[shining].min() >= 20.0 * (1 - 1e-6)
    assert peak.max() <= 200.0
    assert shining.mean() < 0.1
    depth = -scene.camera.camera_from_world(scene.vertices[shining])[:, 2]
    blur = coc(scene, depth)
    assert (blur < -10.0).any()
    assert (blur > 10.0).any()


def test_mirrors_see_soft_boxes_and_hard_lamps(made):
    environment = made("mirrors").light.environment
    brightest = environment.max(axis=2)
    assert brightest.max() > 10.0
    assert 0.01 < (brightest > 2.0).mean() < 0.3
    assert sum(m.shading == "phong" for m in made("mirrors").materials) >= 8


def test_foliage_is_about_a_hundred_surfaces_deep(made):
    assert 80 <= Rays(made("foliage"), 640, 480).surfaces().max() <= 130


def test_town_is_deep(made):
    depth = Rays(made("town")).depth()
    assert depth.max() / depth.min() > 15.0


def test_figures_stand_before_and_behind(made):
    blur = coc(made("figures"), Rays(made("figures")).depth())
    assert (blur < -10.0).mean() > 0.1
    assert (blur > 10.0).mean() > 0.3


# --- the files ------------------------------------------------------------------------------------------

FILE = """
title = "t"
shows = "s"
inspired_by = "i"
seed = 1
background = [0, 0, 0]
[light]
sun_direction = [0, 1, 0]
sun = [1, 1, 1]
sky = [1, 1, 1]
ground = [1, 1, 1]
[camera]
eye = [0, 0, 0]
target = [0, 0, -1]
up = [0, 1, 0]
fov_y = 40.0
size = [64, 48]
[lens]
radius = 0.1
focus_distance = 2.0
[numbers]
count = 3
"""


def test_a_file_is_read():
    shot = parse_shot("a.toml", FILE, ("count",))
    assert (shot.title, shot.seed, shot.numbers) == ("t", 1, {"count": 3.0})
    assert shot.camera.size == (64, 48)
    assert isinstance(shot.lens, ThinLens)
    blades = parse_shot("a.toml", FILE.replace("radius = 0.1", "radius = 0.1\nblades = 6"), ("count",))
    assert len(blades.lens.aperture.boundary) == 6


@pytest.mark.parametrize("name", SCENES)
def test_every_file_tells_what_it_shows(name):
    shot = shot_of(name)
    assert shot.shows.endswith(".")
    assert "figure" in shot.inspired_by or "table" in shot.inspired_by


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("seed = 1", "", "a.toml: seed: missing"),
        ("seed = 1", "seed = -1", "a.toml: seed: got -1"),
        ("seed = 1", "seed = 1\ncolour = 3", "a.toml: colour: unknown"),
        ("seed = 1", "seed = 1\norder = 0", "a.toml: order: got 0"),
        ("fov_y = 40.0", "", "a.toml: camera: fov_y: missing"),
        ("fov_y = 40.0", "fov_y = 400.0", "a.toml: fov_y: got 400"),
        ("radius = 0.1", "radius = 0.1\nf_number = 2", "a.toml: lens: f_number: unknown"),
        ("radius = 0.1", "radius = -0.1", "a.toml: radius: got -0.1"),
        ("radius = 0.1", "radius = 0.1\ncurvature = 0.5", "a.toml: lens: curvature: needs blades"),
        ("sun = [1, 1, 1]", "sun = [1, 1]", "a.toml: sun: got shape"),
        ("count = 3", "", "a.toml: numbers: count: missing"),
        ("count = 3", "count = 3\nheight = 1", "a.toml: numbers: height: unknown"),
        ("count = 3", "count = 'many'", "a.toml: count: got 'many'"),
        ('title = "t"', "title = 3", "a.toml: title: got 3"),
        ("[lens]", "[lens", "a.toml: got"),
        ("seed = 1", "seed = " + "9" * 5000, "a.toml: got"),
        ("seed = 1", "seed = " + "[" * 5000, "a.toml: is nested too deep"),
    ],
)
def test_a_bad_file_is_refused_by_name(old, new, words):
    with pytest.raises(InputError) as caught:
        parse_shot("a.toml", FILE.replace(old, new), ("count",))
    assert str(caught.value).startswith(words)
    assert "\n" not in str(caught.value)


def test_a_table_that_is_no_table_is_refused():
    text = FILE.replace("[numbers]\ncount = 3", "").replace("seed = 1", "seed = 1\nnumbers = 3")
    with pytest.raises(InputError, match=r"^a.toml: numbers: got 3; allowed is a table"):
        parse_shot("a.toml", text, ())


# --- shapes, noise, textures against closed forms -------------------------------------------------------


def area_and_volume(mesh):
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    return np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2, (a * np.cross(b, c)).sum() / 6


def test_solids_have_their_area_and_volume():
    area, volume = area_and_volume(box(2.0, 3.0, 4.0))
    assert area == pytest.approx(52.0, rel=1e-14)
    assert volume == pytest.approx(24.0, rel=1e-14)
    # Inscribed meshes of 64 by 128 cells: too small by about (pi / 64)^2 / 4 = 6e-4; twice that is allowed.
    area, volume = area_and_volume(sphere(2.0, 64, 128))
    assert area == pytest.approx(16 * np.pi, rel=1.2e-3)
    assert volume == pytest.approx(32 / 3 * np.pi, rel=1.2e-3)
    # Pappus: 2 pi R times the circle; 96 segments of 48 sides are too small by (pi / 48)^2 * 2 / 3 = 3e-3.
    area, volume = area_and_volume(torus(3.0, 1.0, 96, 48))
    assert area == pytest.approx(12 * np.pi**2, rel=6e-3)
    assert volume == pytest.approx(6 * np.pi**2, rel=6e-3)


def test_a_lathe_is_a_cone():
    cone = lathe([[(0.0, 0.0), (1.0, 0.0)], [(1.0, 0.0), (0.0, 2.0)]], 96)
    assert len(cone.faces) == 2 * 96  # the poles leave one triangle of every square
    # Inscribed in the circle: too small by (2 pi / 96)^2 / 6 = 7e-4.
    assert abs(area_and_volume(cone)[1]) == pytest.approx(2 * np.pi / 3, rel=1e-3)


@pytest.mark.parametrize(
    "mesh",
    [
        box(1, 2, 3),
        sphere(1.0),
        torus(2.0, 0.5),
        leaf(),
        arch(3.0, 2.0, 5.0, 0.5, 0.4),
        plane((0, 0, 0), (1, 0, 0), (0, 1, 0), (3, 2)),
        lathe([[(0.0, 0.0), (1.0, 0.0)], [(1.0, 0.0), (0.5, 1.0)]]),
        tube(np.array([(0.0, 0, 0), (1, 0.2, 0), (2, 0, 1)]), 0.1),
    ],
    ids=["box", "sphere", "torus", "leaf", "arch", "plane", "lathe", "tube"],
)
def test_meshes_have_unit_normals_along_their_faces(mesh):
    # Sums of three squares of rounded quotients.
    np.testing.assert_allclose(np.linalg.norm(mesh.normal, axis=1), 1.0, rtol=1e-12)
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    cross = np.cross(b - a, c - a)
    assert (np.linalg.norm(cross, axis=1) > 0).all()
    mean = mesh.normal[mesh.faces].mean(axis=1)
    assert ((cross * mean).sum(axis=1) > 0).mean() > 0.98 or ((cross * mean).sum(axis=1) < 0).mean() > 0.98


def test_turning_and_joining():
    np.testing.assert_allclose(rotation("y", 90.0) @ [0, 0, 1], [1, 0, 0], atol=1e-15)  # cos(90 deg) is 6e-17
    np.testing.assert_allclose(rotation("x", 90.0) @ [0, 1, 0], [0, 0, 1], atol=1e-15)
    np.testing.assert_allclose(rotation("z", 90.0) @ [1, 0, 0], [0, 1, 0], atol=1e-15)
    two = join([box(1, 1, 1), box(1, 1, 1).moved(5, 0, 0)])
    assert area_and_volume(two)[1] == pytest.approx(2.0, rel=1e-14)
    flat = plane((0, 0, 0), (1, 0, 0), (0, 0, -1)).scaled(2.0, 5.0, 1.0)
    np.testing.assert_array_equal(flat.normal, np.tile([0.0, 1.0, 0.0], (4, 1)))


def test_a_sculpted_ball_is_a_ball():
    ball = soft_union(np.array([[0.1, 0, 0, 0.1, 0, 0, 0.5, 0.5, 1.0]]), 0.02)
    mesh = sculpt(ball, (-0.6, -0.7, -0.7), (0.8, 0.7, 0.7), 0.12)
    distance = np.linalg.norm(mesh.vertices - [0.1, 0, 0], axis=1)
    # Newton's steps on a distance converge at once; the finite difference leaves about a step of 1e-3 times it.
    np.testing.assert_allclose(distance, 0.5, atol=1e-4)
    # Edges of 0.03 on a radius of 0.5 cut off about (0.03 / 0.5)^2 / 8 of the volume.
    assert area_and_volume(mesh)[1] == pytest.approx(4 / 3 * np.pi * 0.125, rel=2e-3)


def test_noise_tiles_and_keeps_its_range():
    noise = fractal((64, 64), (4, 4), np.random.default_rng(0), 3)
    # Across the seam values differ no more than between neighbours inside.
    assert np.abs(noise[0] - noise[-1]).max() <= 1.5 * np.abs(np.diff(noise, axis=0)).max()
    field = Noise3(np.random.default_rng(0))
    points = np.random.default_rng(1).uniform(-20, 20, (500, 3))
    assert np.abs(field(points)).max() <= 1.0
    # Period 16: the lattice index wraps; the offset is rounded at 20 + 16, hence a few 1e-14.
    np.testing.assert_allclose(field(points), field(points + 16.0), atol=1e-12)


def test_paint_is_srgb():
    # IEC 61966-2-1: 0x80 = 128 / 255 is 0.21586 linear (five digits).
    np.testing.assert_allclose(paint("#80ff00"), [0.21586, 1.0, 0.0], atol=5e-6)


def test_bricks_lie_in_rows_of_mortar():
    wall = bricks(128, 4, 2, ("#ffffff", "#ffffff"), "#000000", np.random.default_rng(0), 0.1).sum(axis=2)
    rows = wall.mean(axis=1)
    joints = np.flatnonzero(rows < 0.5 * rows.max())
    np.testing.assert_array_equal(np.unique(np.round(joints / 32)), [0, 1, 2, 3, 4])


def test_the_environment_covers_the_sphere_evenly_enough():
    vectors = directions(64)
    np.testing.assert_allclose(np.linalg.norm(vectors, axis=-1), 1.0, rtol=1e-12)  # a rounded quotient
    np.testing.assert_allclose(vectors.reshape(-1, 3).mean(axis=0), 0.0, atol=1e-12)  # symmetric sums cancel
    # The octahedral map, forwards: project onto |x| + |y| + |z| = 1, fold the lower half out.
    x, y, z = np.moveaxis(vectors, -1, 0)
    total = np.abs(x) + np.abs(y) + np.abs(z)
    p, q = x / total, z / total
    low = y < 0
    p, q = (
        np.where(low, (1 - np.abs(q)) * np.where(p < 0, -1, 1), p),
        np.where(low, (1 - np.abs(p)) * np.where(q < 0, -1, 1), q),
    )
    texel = (np.arange(64) + 0.5) / 32 - 1
    # Sums and quotients of numbers near 1.
    np.testing.assert_allclose(p, np.broadcast_to(texel[None, :], (64, 64)), atol=1e-12)
    np.testing.assert_allclose(q, np.broadcast_to(texel[:, None], (64, 64)), atol=1e-12)
