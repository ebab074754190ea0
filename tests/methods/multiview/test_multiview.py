"""Multiview synthesis against its naive twins, and what must not change a bit. Tiny pictures."""

from dataclasses import replace

import numpy as np
import pytest

from refdof import Aperture, InputError, Light, Material, Part, ThinLens, View, reference, render
from refdof.methods.multiview import Params
from refdof.methods.multiview.decomposition import decompose, layer_bounds
from refdof.methods.multiview.fields import Search, fields_of
from refdof.methods.multiview.gather import culled_layers, gather, trace_hits
from refdof.methods.multiview.method import _texel_bytes
from refdof.optics.pixel_samples import LensPointSets, lens_point_sets
from tests import flat_scene
from tests.methods.multiview import naive

pytestmark = pytest.mark.fast

SIZE, P = (14, 10), 14.0
SEARCH = Search(False, 3, 5, 0.5, False, True, True)


def random_scene(seed, count=12):
    """Triangles before, in and behind the focal plane, some of them steep, some crossing others."""
    random = np.random.default_rng([seed, 4])
    depth = random.uniform(0.6, 4.0, (count, 1)) * random.uniform(0.8, 1.25, (count, 3))
    tangent = random.uniform(-0.5, 0.5, (count, 1, 2)) + random.uniform(-0.8, 0.8, (count, 3, 2))
    corners = np.concatenate([tangent * depth[..., None], -depth[..., None]], axis=-1)
    parts = [Part(c, [[0, 1, 2]], flat_scene.paint(tuple(random.random(3)))) for c in corners]
    shot, lens = flat_scene.camera(*SIZE, P), ThinLens(0.35, 1.3)
    return View(flat_scene.scene_of(parts, shot, lens, (0.1, 0.2, 0.3)), shot, lens), corners


def random_fields(seed, count=4, width=13, height=11, smooth=False, full=False, dtype=np.float32):
    """Height fields of layers 2 px apart with 10 % overlap: noise with holes, or gentle slopes."""
    random = np.random.default_rng([seed, 5])
    bounds = -4.0 + 2.0 * np.arange(count + 1)
    near, far = bounds[:-1] - 0.2, bounds[1:] + 0.2
    y, x = np.mgrid[:height, :width]
    slope = random.uniform(-0.25, 0.25, (2, count, 1, 1))
    part = 0.5 + (slope[0] * (x - width / 2) + slope[1] * (y - height / 2)) / 2.4 if smooth else None
    part = random.random((count, height, width)) if part is None else np.clip(part, 0.01, 0.99)
    coc = near[:, None, None] + part * (far - near)[:, None, None]
    if not full:
        coc[random.random(coc.shape) < 0.5] = np.inf
    return coc.astype(dtype), near.astype(dtype), far.astype(dtype)


def one_set(points):
    return LensPointSets(points[None], np.ones((1, len(points))), np.zeros((1, 1), np.int32))


def lens(count, seed):
    points = lens_point_sets(count, Aperture.disc(), "none", "sobol", seed).points[0]
    return points.astype(np.float32).astype(np.float64)


def twin_hits(coc, near, far, points, wall, discard):
    height, width = coc.shape[1:]
    layer = np.empty((height, width, len(points)), np.int64)
    texel = np.empty_like(layer)
    for y, x, n in np.ndindex(layer.shape):
        k, j, i, _ = naive.ray_hit(coc, near, far, x + 0.5, y + 0.5, *points[n], wall, discard)
        layer[y, x, n], texel[y, x, n] = k, j * width + i if k >= 0 else -1
    return layer, texel


# --- decomposition


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("overlap", [0.0, 0.1])
def test_layers_match_the_twin(seed, overlap):
    view, corners = random_scene(seed)
    layers, _ = decompose(*view.triangles(), view.camera, view.lens, 1.5, overlap=overlap)
    depth = naive.fragments(corners, *flat_scene.tangents(*SIZE, P))

    def coc_of(d):
        return P * 0.35 * (1 / 1.3 - 1 / d)

    found = naive.layers_of(depth, -corners[..., 2].min(axis=1), coc_of, layers.bounds, overlap * 1.5)
    coc = np.full((len(layers.bounds) - 1, *SIZE[::-1]), np.inf)
    triangle = np.full(coc.shape, -1)
    coc[layers.layer], triangle[layers.layer] = layers.coc, layers.triangle
    wanted, number = np.full_like(coc, np.inf), np.full_like(triangle, -1)
    for key, (d, n) in found.items():
        wanted[key], number[key] = coc_of(d), n
    # The kernel snaps corners to 2^-12 px, the twin does not: at an edge one pixel in thousands may differ.
    same = triangle == number
    assert (~same).sum() <= 1
    filled = same & (number >= 0)
    assert filled.sum() > 100
    # Heights are float32 of numbers below 8.
    np.testing.assert_allclose(coc[filled], wanted[filled], rtol=0, atol=2e-6)


def test_bounds_are_evenly_spaced_in_circle_of_confusion_by_hand():
    # Eq. (4): from -4 to 3.5 px at 3 px each: 2.5 layers, so three, the last one cut.
    np.testing.assert_array_equal(layer_bounds(-4.0, 3.5, 3.0), np.float32([-4, -1, 2, 3.5]))
    np.testing.assert_array_equal(layer_bounds(-4.0, 4.0, 3.0, 2), np.float32([-4, 0, 4]))


@pytest.mark.parametrize("depth", [0.7, 1.3, 5.0])
def test_a_scene_with_one_depth_gets_one_layer(depth):
    shot, thin = flat_scene.camera(*SIZE, P), ThinLens(0.5, 1.3)
    view = View(flat_scene.scene_of([flat_scene.rectangle(-9, 9, -9, 9, depth)], shot, thin), shot, thin)
    layers, _ = decompose(*view.triangles(), shot, thin, 0.01)
    assert len(layers.bounds) == 2
    assert np.isfinite(layers.coc).all()


def test_a_fragment_on_a_bound_belongs_to_the_layer_behind_it():
    shot, thin = flat_scene.camera(*SIZE, 8.0), ThinLens(1.0, 1.0)
    # Circles of confusion 8 (1 - 1 / d): -8, -4 and 4, exactly.
    cards = [flat_scene.rectangle(-9, 9, -9, 9, d) for d in (0.5, 2 / 3, 2.0)]
    view = View(flat_scene.scene_of(cards, shot, thin), shot, thin)
    layers, _ = decompose(*view.triangles(), shot, thin, 4.0, overlap=0.0)
    np.testing.assert_array_equal(layers.bounds, np.float32([-8, -4, 0, 4]))
    assert layers.layer.tolist() == [0, 1, 2]


def test_colours_are_the_pinholes_where_the_nearest_surface_is_in_its_layer():
    view, _ = random_scene(5)
    stages = render("multiview", view.scene, view.camera, view.lens, stages=True, samples=1, spacing_px=1.0).stages
    pinhole, coc = view.pinhole(), view.coc_px()
    compared = 0
    for k in range(len(stages["layer_coc"])):
        same = np.abs(stages["layer_coc"][k] - coc) < 1e-5  # float32 heights
        compared += same.sum()
        np.testing.assert_array_equal(stages["layer_surface"][k][same], pinhole.color[same])
    assert compared > 50


# --- rays


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    ("wall", "discard"), [(0.5, True), (1.0, True), (np.inf, True), (0.0, True), (1.0, False), (0.0, False)]
)
def test_march_hits_what_the_twin_hits(seed, wall, discard):
    coc, near, far = random_fields(seed)
    points = lens(5, seed)
    search = SEARCH._replace(wall=wall, march=True, discard=discard)
    hits = trace_hits(fields_of(coc, near, far, 1.0, wall=wall), one_set(points), search)
    layer, texel = twin_hits(coc, near, far, points, wall, discard)
    np.testing.assert_array_equal(hits.layer, layer)
    np.testing.assert_array_equal(hits.texel, texel)
    assert len(np.unique(layer)) > 3


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize("smooth", [False, True])
@pytest.mark.parametrize(
    ("wall", "middle", "discard"), [(0.5, False, True), (1.0, True, True), (np.inf, False, True), (1.0, False, False)]
)
def test_false_position_hits_what_the_twin_hits_where_not_ambiguous(seed, smooth, wall, middle, discard):
    coc, near, far = random_fields(seed, smooth=smooth, full=smooth)
    points = lens(5, seed)
    search = SEARCH._replace(wall=wall, middle=middle, discard=discard)
    hits = trace_hits(fields_of(coc, near, far, 1.0, wall=wall), one_set(points), search)
    layer, texel = twin_hits(coc, near, far, points, wall, discard)
    sure = ~hits.ambiguous
    np.testing.assert_array_equal(hits.layer[sure], layer[sure])
    np.testing.assert_array_equal(hits.texel[sure], texel[sure])
    # In noise with holes many rays are ambiguous; slopes are what scenes are made of.
    assert sure.mean() > (0.8 if smooth else 0.2)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("wall", [0.5, np.inf])
def test_without_bisection_a_crossing_inside_the_layer_is_in_doubt(seed, wall):
    coc, near, far = random_fields(seed, smooth=True, full=True)
    fields, pattern = fields_of(coc, near, far, 1.0, wall=wall), one_set(lens(5, seed))
    search = SEARCH._replace(wall=wall, bisections=0, steps=1, discard=False)
    hits = trace_hits(fields, pattern, search)
    exact = trace_hits(fields, pattern, search._replace(march=True))
    sure = ~hits.ambiguous
    np.testing.assert_array_equal(hits.texel[sure], exact.texel[sure])
    np.testing.assert_array_equal(hits.layer[sure], exact.layer[sure])
    assert hits.layer.dtype == np.int32


@pytest.mark.parametrize("largest", [1e6, 1e20, 4e37])
@pytest.mark.parametrize("march", [False, True])
def test_rays_far_outside_the_image_see_its_border(largest, march):
    # Every ray strays so far that it sees one of the four corners; y is up in the lens.
    coc = np.full((1, 4, 5), -largest, np.float32)
    points = np.array([[0.5, 0.25], [-0.5, 0.25], [0.5, -0.25], [-0.5, -0.25]])
    bound = coc[:, 0, 0].copy()
    search = SEARCH._replace(march=march, discard=False)
    hits = trace_hits(fields_of(coc, bound, bound, 1.0), one_set(points), search)
    np.testing.assert_array_equal(hits.texel, np.broadcast_to([4, 0, 19, 15], (4, 5, 4)))
    # From one end of a layer to the other the walk crosses the image; all of it is empty but one corner.
    coc[:] = np.inf
    coc[0, 3, 4] = largest
    wide = trace_hits(fields_of(coc, bound, -bound, 1.0), one_set(points), search)
    np.testing.assert_array_equal(wide.texel, np.broadcast_to([-1, 19, -1, -1], (4, 5, 4)))


@pytest.mark.parametrize("radius", [1e15, 1e38, 1e40, 1e300])
@pytest.mark.parametrize("layers", [1, 2])
def test_circles_of_confusion_beyond_float32_are_the_largest_that_it_holds(radius, layers):
    shot = flat_scene.camera(4, 3, 4.0)
    cards = [flat_scene.rectangle(-99, 99, -99, 99, depth, (depth, 0, 0)) for depth in (2.0, 3.0)]
    scene = flat_scene.scene_of(cards, shot, background=(0, 1, 0))
    words = {"samples": 4, "layers": layers, "offscreen": "clamp", "stages": True}
    done = render("multiview", scene, shot, ThinLens(radius, 1.0), **words)
    assert np.isfinite(done.stages["layer_coc"]).all()
    np.testing.assert_array_equal(done.image[..., 1], 0.0)


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("march", [False, True])
def test_culling_changes_no_bit(seed, march):
    coc, near, far = random_fields(seed, width=23, height=19)
    coc[:, :, :12] = np.inf
    fields, pattern = fields_of(coc, near, far, 1.0), one_set(lens(6, seed))
    on = SEARCH._replace(march=march)
    assert 0.1 < culled_layers(fields, on).mean() < 0.9
    assert not culled_layers(fields, on._replace(culling=False)).any()
    for a, b in zip(
        trace_hits(fields, pattern, on), trace_hits(fields, pattern, on._replace(culling=False)), strict=True
    ):
        np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("slope", [(0.25, 0.0), (0.0, -0.125), (0.125, 0.25)])
def test_false_position_is_exact_in_one_step_on_a_plane(slope):
    # Heights slope . (x, y) from the middle. Through lens point (1, 1), between bounds at whole px, both ends of a ray
    # pass texel centres, where the nearest texel is the plane itself. So is the crossing, for some pixels.
    size, near, far = 17, -4.0, 4.0
    y, x = np.mgrid[:size, :size]
    coc = slope[0] * (x - 8) + slope[1] * (y - 8)
    fields = fields_of(coc[None], np.array([near]), np.array([far]), 1.5)
    once = SEARCH._replace(steps=1, bisections=0, wall=0.0)
    hits = trace_hits(fields, one_set(np.array([[1.0, 1.0]])), once)
    # On the plane c = slope . (x - c - 8, y + c - 8).
    c = coc / (1.0 + slope[0] - slope[1])
    centred = (c == np.rint(c)) & (np.abs(x - 8) <= 4) & (np.abs(y - 8) <= 4)
    assert centred.sum() >= 5
    np.testing.assert_array_equal(hits.layer[centred], 0)
    np.testing.assert_array_equal(hits.coc[..., 0][centred], c[centred])
    np.testing.assert_array_equal(hits.texel[..., 0][centred], ((y + c) * size + x - c)[centred])


@pytest.mark.parametrize("seed", range(3))
def test_on_planes_the_first_step_is_within_a_texel(seed):
    coc, near, far = random_fields(seed, count=1, width=21, height=19, smooth=True, full=True)
    coc = np.clip(coc, near[0], far[0])
    points = lens(5, seed)
    fields = fields_of(coc, near, far, 1.0)
    once = trace_hits(fields, one_set(points), SEARCH._replace(steps=1, bisections=0, wall=np.inf))
    exact = trace_hits(fields, one_set(points), SEARCH._replace(march=True, wall=np.inf))
    both = (once.layer == 0) & (exact.layer == 0)
    assert both.mean() > 0.4
    apart = np.abs(np.array(np.divmod(once.texel, 21)) - np.array(np.divmod(exact.texel, 21)))
    # Heights of the nearest texel are off by half a texel's slope at each end: 1/4 px of c, so less than a texel.
    assert apart[:, both].max() <= 1


def test_float32_and_float64_agree():
    coc, near, far = random_fields(8, smooth=True, full=True)
    pattern = one_set(lens(6, 8))
    narrow = trace_hits(fields_of(coc, near, far, 1.0), pattern, SEARCH)
    wide = trace_hits(fields_of(*(a.astype(np.float64) for a in (coc, near, far)), 1.0), pattern, SEARCH)
    sure = ~narrow.ambiguous & ~wide.ambiguous
    np.testing.assert_array_equal(narrow.texel[sure], wide.texel[sure])


def test_mean_over_the_lens_matches_the_twin():
    view, _ = random_scene(6)
    coc, near, far = random_fields(3, width=SIZE[0], height=SIZE[1])
    color = np.random.default_rng(3).random((*coc.shape, 3)).astype(np.float32)
    points = lens(4, 3)
    background = (0.25, 0.5, 0.75)
    search = SEARCH._replace(march=True)
    image = gather(
        fields_of(coc, near, far, 1.0), color, one_set(points), search, view.projection(), view.surfaces(), background
    )
    wanted = naive.mean_over_lens(coc, near, far, color, background, points, 0.5, True)
    alone = np.isnan(wanted[..., 0])
    # Means of four colours, rounded to float32 once.
    np.testing.assert_allclose(image[~alone], wanted[~alone], rtol=2e-7)
    nearest = np.full((*SIZE[::-1], 3), background)
    for k in range(len(coc))[::-1]:
        nearest[np.isfinite(coc[k])] = color[k][np.isfinite(coc[k])]
    np.testing.assert_allclose(image[alone], nearest[alone], rtol=2e-7)
    assert alone.any()


# --- the method


def test_each_lens_ray_shades_along_its_own_direction():
    # The lens is open in its upper left quarter only, and the mirrored environment differs along x and along y.
    ramp = np.linspace(0.0, 1.0, 16, dtype=np.float32)
    environment = np.stack([*np.meshgrid(ramp, ramp**2), np.zeros((16, 16))], axis=-1).astype(np.float32)
    light = Light((0, 0, 1), sun=(0, 0, 0), sky=(0, 0, 0), ground=(0, 0, 0), environment=environment)
    corners = np.array([[-9, -9, -2.0], [9, -9, -2.0], [9, 9, -2.0], [-9, 9, -2.0]])
    mirror = Part(corners, [[0, 1, 2], [0, 2, 3]], Material("phong", (0, 0, 0), specular=(1, 1, 1)))
    shot, thin = flat_scene.camera(6, 4, 6.0), ThinLens(0.5, 1.5, Aperture.image(np.array([[1.0, 0.0], [0.0, 0.0]])))
    scene = flat_scene.scene_of([mirror], shot, thin, light=light)
    exact = reference(scene, samples=256).image
    words = {"offscreen": "clamp", "view_dependent": True}
    image = render("multiview", scene, samples=256, jitter="none", pattern="sobol", **words).image
    # About 64 of 256 points meet the aperture, over which the environment varies by less than 1: 64^-0.75.
    np.testing.assert_allclose(image, exact, rtol=0, atol=0.05)


def test_what_lies_beyond_the_far_plane_is_empty():
    view, _ = random_scene(3)
    stages = render("multiview", view.scene, stages=True, samples=1, near=0.9, far=2.0).stages
    np.testing.assert_array_equal(stages["source_triangle"] < 0, np.isinf(stages["source_coc"]))
    assert (stages["source_triangle"] >= 0).any()


def test_without_surfaces_there_are_no_layers():
    shot = flat_scene.camera(*SIZE, P)
    done = render("multiview", flat_scene.scene_of([], shot, background=(0.5, 0.25, 1)), shot, stages=True, samples=1)
    assert done.stages["bounds"].shape == (1,)
    np.testing.assert_array_equal(done.image, np.broadcast_to(np.float32([0.5, 0.25, 1]), done.image.shape))


def test_memory_per_texel_by_hand():
    # 20 bytes of heights, triangles and search structures, 4 per channel, and 11 per channel of the mipmaps: colour and
    # two coverages, and with finite walls once more colour and one.
    assert _texel_bytes(Params(cones="none")) == 20 + 4 * 3
    assert _texel_bytes(Params(cones="paper")) == 20 + 4 * 3 + 11 * (5 + 4)
    assert _texel_bytes(Params(cones="paper", wall_px=np.inf)) == 20 + 4 * 3 + 11 * 5
    assert _texel_bytes(Params(view_dependent=True, cones="none")) == 20 + 4 * 13
    assert _texel_bytes(Params(view_dependent=True, cones="text")) == 20 + 4 * 13 + 11 * (15 + 14)


def test_triangle_order_changes_no_bit():
    view, corners = random_scene(7)
    image = render("multiview", view.scene, samples=8, spacing_px=1.0).image
    order = np.random.default_rng(0).permutation(len(corners))
    scene = view.scene
    mixed = replace(scene, faces=scene.faces[order], face_material=scene.face_material[order])
    np.testing.assert_array_equal(render("multiview", mixed, samples=8, spacing_px=1.0).image, image)


@pytest.mark.parametrize("cones", ["none", "paper"])
def test_thread_count_changes_no_bit(cones):
    from refdof._jit import thread_count, use_threads

    view, _ = random_scene(9)
    before = thread_count()
    images = []
    for threads in (1, before):
        use_threads(threads)
        images.append(render("multiview", view.scene, samples=8, spacing_px=1.0, cones=cones).image)
    use_threads(before)
    np.testing.assert_array_equal(*images)


def test_order_of_the_depth_buffers_changes_no_bit():
    from refdof.methods.multiview.decomposition import _move

    random = np.random.default_rng(2)
    bounds = np.float32([0, 1, 2, 3])
    source = random.uniform(0, 3, (3, 6, 5)).astype(np.float32)
    triangle = np.arange(source.size, dtype=np.int32).reshape(source.shape)
    results = []
    for order in ([0, 1, 2], [2, 0, 1]):
        coc, number = np.full((3, 6, 5), np.inf, np.float32), np.full((3, 6, 5), -1, np.int32)
        _move(source[order], triangle[order], bounds, bounds[:-1] - 0.1, bounds[1:] + 0.1, np.arange(3), coc, number)
        results.append((coc, number))
    np.testing.assert_array_equal(results[0][0], results[1][0])
    np.testing.assert_array_equal(results[0][1], results[1][1])


def test_a_pinhole_gives_the_pinhole_picture():
    view, _ = random_scene(10)
    image = render("multiview", view.scene, lens=ThinLens(0.0, 1.3), samples=3).image
    different = (image != view.pinhole().color).any(axis=-1)
    assert different.mean() < 0.01  # corners snap to 2^-12 px


def test_stages_are_those_of_the_docstring():
    from refdof.methods import multiview

    view, _ = random_scene(11)
    stages = render("multiview", view.scene, stages=True, samples=3, cones="paper").stages
    named = multiview.__doc__.split("Stages")[1].split("Departures")[0]
    for name in stages:
        assert f'"{name}"' in named
    assert named.count('"') == 2 * len(stages)


@pytest.mark.parametrize(
    ("words", "match"),
    [
        ({"near": 2.0, "far": 1.0}, "near: got 2 with far 1"),
        ({"near": 2.0, "far": 2.0}, "near"),
        ({"spacing_px": 0.0}, "spacing_px"),
        ({"spacing_px": -3.0}, "spacing_px"),
        ({"spacing_px": float("nan")}, "spacing_px"),
        ({"layers": 0}, "layers"),
        ({"overlap": 0.6}, "overlap"),
        ({"wall_px": -1}, "wall_px"),
        ({"steps": 0}, "steps"),
        ({"search": "guess"}, "search"),
        ({"start": "back"}, "start"),
        ({"cones": "wide"}, "cones"),
        ({"culling": "off"}, "culling"),
        ({"view_dependent": "false"}, "view_dependent"),
        ({"offscreen": "wrap"}, "offscreen"),
        ({"samples": 0}, "samples"),
        ({"seed": -1}, "seed"),
    ],
)
def test_bad_parameters(words, match):
    with pytest.raises(InputError, match=match):
        Params(**words)


def test_walls_from_nothing_to_infinity_are_allowed():
    assert [Params(wall_px=wall).wall_px for wall in (0.0, 0.5, 1e29, 1e31)] == [0.0, 0.5, 1e29, np.inf]


def test_no_geometry_in_the_range():
    view, _ = random_scene(1)
    with pytest.raises(InputError, match="near, far: got 50"):
        render("multiview", view.scene, near=50.0, far=60.0)
    with pytest.raises(InputError, match=r"near, far: got 0\.25"):
        render("multiview", view.scene, near=0.25, far=0.3)


def test_more_layers_than_memory_allows():
    view, _ = random_scene(1)
    with pytest.raises(InputError, match=r"spacing_px: got 1e-06 .* makes \S+ layers; allowed are at most 65536"):
        render("multiview", view.scene, spacing_px=1e-6)
    big = view.camera.with_size((20000, 15000))
    from refdof.methods.multiview.decomposition import _check_memory

    with pytest.raises(InputError, match=r"4 layers of 20000x15000 px, about 35.8 GiB; allowed are 8 GiB"):
        _check_memory(4, big, 32)


def test_near_and_far_cut_the_scene():
    shot = flat_scene.camera(*SIZE, P)
    colors = np.eye(3)
    cards = [flat_scene.rectangle(-9, 9, -9, 9, d, tuple(c)) for d, c in zip((1.0, 2.0, 3.0), colors, strict=True)]
    scene = flat_scene.scene_of(cards, shot, ThinLens(0.1, 1.3), (0.5, 0.5, 0.5))
    for words, wanted in (({}, colors[0]), ({"near": 1.5}, colors[1]), ({"near": 2.5, "far": 2.9}, None)):
        if wanted is None:
            with pytest.raises(InputError, match="near, far"):
                render("multiview", scene, **words)
            continue
        image = render("multiview", scene, **words, offscreen="clamp").image
        np.testing.assert_allclose(image, np.broadcast_to(wanted, image.shape), atol=1e-7)


def test_attributes_shade_as_colours_do_when_nothing_depends_on_the_view():
    view, corners = random_scene(12)
    parts = [Part(c, [[0, 1, 2]], Material("lambert", (0.4, 0.6, 0.8))) for c in corners]
    scene = flat_scene.scene_of(parts, view.camera, view.lens)
    plain = render("multiview", scene, samples=8, cones="none").image
    # Attributes are rounded to float32, and a few operations follow.
    np.testing.assert_allclose(
        render("multiview", scene, samples=8, cones="none", view_dependent=True).image, plain, rtol=2e-6
    )
