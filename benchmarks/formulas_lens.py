"""Formulas of the lens: circles of confusion, focus and image distance, and surfaces of real lenses."""

import numpy as np
from formula import Formula, beside, near_one, product_plus, spread_over, sqrt, wide

from refdof import Camera, ThinLens
from refdof.frame.depth_kinds import planar_of
from refdof.optics.expressive_lens import ExpressiveLens
from refdof.optics.lens import photographic_share
from refdof.optics.systems.glass import AIR
from refdof.optics.systems.system import Surface

__all__ = ["FORMULAS"]

_ONE_PIXEL = Camera((0.0, 0.0, 0.0), (0.0, 0.0, -1.0), fov_y=90.0, size=(2, 2))  # P = 1 but for a rounding


def _circle_naive(scale, focus, depth):
    return scale * (1 / focus - 1 / depth)


def _circle_ours(scale, focus, depth):
    far = depth >= 2 * focus
    near = np.where(far, focus, depth)
    return scale / focus * np.where(far, 1 - focus / depth, (near - focus) / near)


def _circle_code(scale, focus, depth):
    rows = zip(scale, focus, depth, strict=True)
    return np.array([ThinLens(float(s), float(f)).coc_px(np.array([d]), _ONE_PIXEL)[0] for s, f, d in rows])


def _draw_circle(random, count):
    focus = spread_over(random, 1e-3, 1e6, count)
    return spread_over(random, 1e-2, 1e4, count), focus, beside(random, focus)


def _photographic_naive(aperture, focal, focus, depth):
    image_of_focus = focal * focus / (focus - focal)
    image_of_depth = focal * depth / (depth - focal)
    return aperture * (image_of_focus - image_of_depth) / image_of_depth


def _photographic_ours(aperture, focal, focus, depth):
    return aperture * (focal / (focus - focal)) * ((depth - focus) / depth)


def _photographic_code(aperture, focal, focus, depth):
    rows = zip(aperture, focal, focus, depth, strict=True)
    return np.array(
        [
            ThinLens(float(a), float(s)).coc_px(np.array([d], dtype=np.float64), _ONE_PIXEL)[0]
            * float(f)
            / photographic_share(float(f), float(s))
            for a, f, s, d in rows
        ]
    )


def _draw_photographic(random, count):
    focal = spread_over(random, 0.01, 0.2, count)
    focus = (focal * near_one(random, count, 1e-2, 1e4)).astype(np.float32)
    depth = beside(random, focus)
    kept = depth > 1.001 * focal
    return spread_over(random, 1e-3, 0.1, count)[kept], focal[kept], focus[kept], depth[kept]


def _buffer_naive(scale, focus, near, device):
    slope, offset = -scale / near, scale / focus
    return device * slope + offset


def _buffer_ours(scale, focus, near, device):
    return scale / (focus * near) * product_plus(-device, focus, near)


def _buffer_code(scale, focus, near, device):
    depth = [
        planar_of(wide([d]), "reversed-infinite", np.ones(1), float(n), None)[0]
        for d, n in zip(device, near, strict=True)
    ]
    return _circle_code(scale, focus, np.array(depth))


def _draw_buffer(random, count):
    near = spread_over(random, 1e-2, 1.0, count)
    focus = (near * near_one(random, count, 1e-1, 1e4)).astype(np.float32)
    device = np.minimum(near / beside(random, focus), 1).astype(np.float32)
    return spread_over(random, 1e-2, 1e4, count), focus, near, device


def _focus_naive(focal, image):
    return 1 / (1 / focal - 1 / image)


def _focus_ours(focal, image):
    return focal * (image / (image - focal))


def _draw_focus(random, count):
    focal = spread_over(random, 1e-3, 1.0, count)
    return focal, (focal * near_one(random, count, 3e-7)).astype(np.float32)


def _extension_naive(focal, focus):
    return focal * focus / (focus - focal) - focal


def _extension_ours(focal, focus):
    return focal * (focal / (focus - focal))


def _draw_extension(random, count):
    focal = spread_over(random, 1e-3, 1.0, count)
    return focal, (focal * near_one(random, count, 1e-2, 1e7)).astype(np.float32)


def _displaced_naive(focal, focus, offset):
    image = 1 / (1 / focal - 1 / focus)
    return 1 / (1 / focal - 1 / (image + offset))


def _displaced_ours(focal, focus, offset):
    strength = (focus - focal) / (focal * focus)
    return 1 / (1 / focus + offset * strength * strength / (1 + offset * strength))


def _displaced_code(focal, focus, offset):
    lenses = [
        ExpressiveLens(0.1, float(s), float(f), image_offset=(float(o), float(o)))
        for f, s, o in zip(focal, focus, offset, strict=True)
    ]
    return np.array([1.0 / lens.inverse_focus(_ONE_PIXEL)[0, 0] for lens in lenses])


def _draw_displaced(random, count):
    focal = spread_over(random, 1e-2, 1.0, count)
    focus = (focal * near_one(random, count, 1.0, 1e5)).astype(np.float32)
    share = np.exp(random.uniform(np.log(1e-7), np.log(0.1), count))
    return focal, focus, (focal * share).astype(np.float32)


def _sag_naive(radius, height):
    return radius - sqrt(radius * radius - height * height)


def _sag_ours(radius, height):
    curved = height / radius
    return height * curved / (1 + sqrt(1 - curved * curved))


def _sag_code(radius, height):
    return np.array([Surface(float(r), 1.0, AIR, float(h)).sag(float(h)) for r, h in zip(radius, height, strict=True)])


def _draw_sag(random, count):
    radius = spread_over(random, 1.0, 1e5, count)
    return radius, (radius * np.exp(random.uniform(np.log(1e-6), np.log(0.9), count))).astype(np.float32)


FORMULAS = [
    Formula(
        "circle",
        "Circle of confusion",
        "`scale` is P E [px scene units]; `depth` lies near `focus`.",
        "Near focus both inverses are alike, and their difference keeps the roundings of each. In pixels that is up to "
        "2^-23 of P E / focus: harmless as a blur, but the sign and the order of circles are lost.",
        _circle_naive,
        _circle_ours,
        """float circle(float scale, float focus, float depth) {
    float share = depth >= 2.0 * focus ? 1.0 - focus / depth : (depth - focus) / depth;
    return scale / focus * share;
}""",
        _draw_circle,
        2.5,
        7.0,
        "`ThinLens.coc_px`, in float64 and rounded once",
        _circle_code,
    ),
    Formula(
        "photographic_circle",
        "Circle of confusion by image distances",
        "`aperture` is the lens's diameter; the circle is one on the sensor, in the unit of `focal`.",
        "Both image distances come near the focal length; their difference keeps their roundings.",
        _photographic_naive,
        _photographic_ours,
        """float photographic_circle(float aperture, float focal, float focus, float depth) {
    return aperture * (focal / (focus - focal)) * ((depth - focus) / depth);
}""",
        _draw_photographic,
        4.0,
        10.0,
        "`photographic_share`, with `ThinLens.coc_px`",
        _photographic_code,
    ),
    Formula(
        "buffer_circle",
        "Circle of confusion of a depth buffer",
        "`device` is reversed and without a far plane: `near / depth`. The naive form is the usual scale and bias.",
        "Near focus scale and bias cancel. To decode the depth first is no better: its rounding is as large.",
        _buffer_naive,
        _buffer_ours,
        """float buffer_circle(float scale, float focus, float near, float device) {
    return scale / (focus * near) * product_plus(-device, focus, near);
}""",
        _draw_buffer,
        3.0,
        8.0,
        "`refdof.frame.depth_kinds.planar_depth` and `ThinLens.coc_px`, in float64, whose digits are enough",
        _buffer_code,
    ),
    Formula(
        "focus_of_image",
        "Focus distance of an image distance",
        "`image` is the distance of the sensor, a little above `focal`.",
        "For a far focus the image lies near the focal point.",
        _focus_naive,
        _focus_ours,
        """float focus_of_image(float focal, float image) {
    return focal * (image / (image - focal));
}""",
        _draw_focus,
        2.0,
        4.5,
        "nowhere, since focus is given as a distance; paraxial lenses take Newton's equation, next",
    ),
    Formula(
        "extension",
        "How far the sensor moves to focus",
        "From its place for infinity.",
        "For a far focus the image distance is the focal length but for its last digits.",
        _extension_naive,
        _extension_ours,
        """float extension(float focal, float focus) {
    return focal * (focal / (focus - focal));
}""",
        _draw_extension,
        2.5,
        5.0,
        "`refdof.optics.systems.paraxial.sensor_for`, as Newton's equation f^2 / x",
    ),
    Formula(
        "displaced_focus",
        "Focus distance of a displaced sensor",
        "The sensor is moved `offset` away from where it has `focus` sharp: curvature of field, or another power.",
        "The image distance is taken back from nearly the focal length.",
        _displaced_naive,
        _displaced_ours,
        """float displaced_focus(float focal, float focus, float offset) {
    float strength = (focus - focal) / (focal * focus);
    return 1.0 / (1.0 / focus + offset * strength * strength / (1.0 + offset * strength));
}""",
        _draw_displaced,
        7.0,
        18.0,
        "`ExpressiveLens.inverse_focus`",
        _displaced_code,
    ),
    Formula(
        "sag",
        "Depth of a lens surface",
        "`height` above the axis, on a sphere.",
        "A surface that is nearly flat is a small difference of two long radii.",
        _sag_naive,
        _sag_ours,
        """float sag(float radius, float height) {
    float curved = height / radius;
    return height * curved / (1.0 + sqrt(1.0 - curved * curved));
}""",
        _draw_sag,
        6.0,
        14.0,
        "`refdof.optics.systems.system.Surface.sag`; rays meet spheres in the same form, `refdof.optics.systems.trace`",
        _sag_code,
    ),
]
