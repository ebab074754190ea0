"""
Aberrations
===========

Seven faults of simple lenses, each beside a lens that does not have it: a thin lens, or one that was corrected. All of
them come from the lens's surfaces and glasses. Lenses have focal lengths of about 50 mm, and a picture is a part of the
film: its size is said in millimetres. Glass has one index except where colour is the subject.
"""

import math
from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np

import refdof
from refdof.optics.systems.glass import AIR, Glass, glass_of
from refdof.optics.systems.system import LensSystem, Surface, ThickLens
from refdof.scene.lens_chart import patch

CROWN = Glass("a crown of one index", 1.5168)


def camera_of(lens, film_height, size):
    """The camera of a film of a height [mm] behind a lens; a thin lens gets that of its real one."""
    whole = lens.seen_by(refdof.Camera.look_at((0, 0, 0), (0, 0, -1), size=size))
    tangent = math.tan(math.radians(whole.fov_y) / 2.0) * film_height / 24.0
    return replace(whole, fov_y=math.degrees(2.0 * math.atan(tangent)))


def thin_of(lens, focus_distance=None):
    """The thin lens with the same pupil, focused at the same distance or at another."""
    return refdof.ThinLens(lens.radius, focus_distance or lens.focus_distance)


def picture(parts, camera, lens, samples=256, pixel_filter="centre"):
    """Light on the film, for the eye."""
    scene = refdof.Scene.from_parts("chart", parts, camera, lens, background=(0.0, 0.0, 0.0))
    image = refdof.reference(scene, camera, lens, samples=samples, pixel_filter=pixel_filter).image
    return np.clip(image, 0.0, 1.0) ** (1 / 2.2)


def show(pictures, width, height, columns=None):
    """Pictures side by side, or one below the other, with their names."""
    columns = columns or len(pictures)
    _, axes = plt.subplots(-(-len(pictures) // columns), columns, figsize=(width, height), layout="constrained")
    for panel, (title, image) in zip(np.ravel(axes), pictures.items(), strict=True):
        panel.imshow(image, interpolation="nearest")
        panel.set_title(title, fontsize=10)
        panel.axis("off")


# %%
# Spherical aberration
# --------------------
#
# The rim of a simple lens bends light too much. A lamp in front of the plane in focus (left) is then a disc with a
# bright rim, one behind it (right) a disc that is brightest in the middle, and one in focus (middle) has a halo. f/4, a
# film of 3.6 x 1.2 mm.

singlet = ThickLens(50.814, -50.814, 5.0, 12.5, CROWN).system("biconvex singlet")
lens = refdof.SystemLens(singlet, 0.8)
camera = camera_of(lens, 1.2, (132, 44))
places = ((-40, 0.45, 14.0), (0, 0.8, 4.0), (40, 1.6, 18.0))
lamps = [patch(camera, x, 0.0, depth, 1.5, light) for x, depth, light in places]
images = {"thin lens": picture(lamps, camera, thin_of(lens), 2048), singlet.name: picture(lamps, camera, lens, 2048)}
show(images, 9, 2.0)

# %%
# Coma
# ----
#
# Off the axis, each ring of the pupil makes a ring of light of its own, beside that of the ring before: a comet, which
# grows with the distance from the axis. The lens is flat towards the scene. Film heights of 4, 6 and 8 mm, f/5.

comet = LensSystem(
    "plano-convex singlet, the wrong way round",
    (
        Surface(math.inf, 3.0, AIR, 5.0, is_stop=True),
        Surface(math.inf, 5.0, CROWN, 12.0),
        Surface(-25.84, 50.0, AIR, 12.0),
    ),
)
lens = refdof.SystemLens(comet, 4.0)
camera = camera_of(lens, 1.44, (460, 36))
lamps = [patch(camera, x, 0.0, 1.55, 1.2, 12.0) for x in (100, 150, 200)]
images = {"thin lens": picture(lamps, camera, thin_of(lens, 1.55)), comet.name: picture(lamps, camera, lens, 1024)}
show({name: image[:, 310:] for name, image in images.items()}, 9, 4.6, columns=1)

# %%
# Astigmatism
# -----------
#
# Off the axis, rays above and below the chief ray meet nearer to the lens than rays beside it. Lamps on a circle about
# the axis, of which a quarter is shown, are drawn out along it where the former are sharp, and across it where the
# latter are. f/4, a film height of 11 mm.

best = ThickLens(30.4, -172.0, 5.0, 12.5, CROWN).system("singlet with little coma")
lens = refdof.SystemLens(best, math.inf)
camera = camera_of(lens, 26.0, (260, 260))
images = {}
for name, given, depth in (
    ("thin lens", thin_of(lens, 0.58), 0.58),
    ("singlet, lamps at 0.58 m", lens, 0.58),
    ("singlet, lamps at 1.25 m", lens, 1.25),
):
    angles = 2.0 * np.pi * np.arange(12) / 12
    lamps = [patch(camera, 110.0 * np.cos(a), 110.0 * np.sin(a), depth, 1.0, 12.0) for a in angles]
    images[name] = picture(lamps, camera, given)
show({name: image[:140, 120:] for name, image in images.items()}, 9, 3.2)

# %%
# Curvature of field
# ------------------
#
# A simple lens is sharp on a bent surface: of a flat chart either the middle or the edge is in focus. f/5.6, on a film
# of 24 x 24 mm.

near = refdof.SystemLens(best, 0.8, f_number=5.6)
far = refdof.SystemLens(best, 5.4, f_number=5.6)
images = {}
for name, given in (
    ("thin lens", thin_of(near)),
    ("singlet, focused in the middle", near),
    ("singlet, focused at the edge", far),
):
    camera = camera_of(far if given is far else near, 24.0, (200, 200))
    steps = (np.arange(15) - 7.0) * 13.3
    chart = [patch(camera, x, y, 0.8, 1.5) for x in steps for y in steps]
    images[name] = picture(chart, camera, given, pixel_filter="box")
show(images, 9, 3.2)

# %%
# Distortion
# ----------
#
# Behind a stop, the rim of a lens pulls the edge of the picture inwards (barrel); in front of one, it pushes it
# outwards (pincushion). f/20, 24 x 24 mm.

glass = (Surface(50.814, 9.0, CROWN, 14.0), Surface(-50.814, 50.0, AIR, 14.0))
in_front = LensSystem("stop in front", (Surface(math.inf, 24.0, AIR, 1.3, is_stop=True), *glass))
behind = LensSystem("stop behind", (Surface(math.inf, 7.0, AIR, 1.3, is_stop=True), *glass)).reversed()
images = {}
for name, system in (("thin lens", in_front), (in_front.name, in_front), (behind.name, behind)):
    lens = refdof.SystemLens(system, 1.0)
    camera = camera_of(lens, 24.0, (200, 200))
    steps = np.linspace(-80.0, 80.0, 9)
    grid = [patch(camera, x, 0.0, 1.0, 0.6, half_y=80.6) for x in steps]
    grid += [patch(camera, 0.0, y, 1.0, 80.6, half_y=0.6) for y in steps]
    images[name] = picture(grid, camera, thin_of(lens) if name == "thin lens" else lens, 128, "box")
show(images, 9, 3.2)

# %%
# Axial colour
# ------------
#
# Glass bends blue more than red, so blue is sharp nearer to the lens. A disc in front of the plane in focus gets a red
# rim, one behind it a blue one. A cemented doublet brings the colours together. f/5.6, 1.8 x 0.6 mm.

crown = ThickLens(30.4, -172.0, 5.0, 12.5, glass_of("N-BK7")).system("singlet of N-BK7")
images = {}
for system in (refdof.load_lens("achromat"), crown):
    lens = refdof.SystemLens(system, 0.8, f_number=5.6)
    camera = camera_of(lens, 0.6, (132, 44))
    places = ((-40, 0.55, 6.0), (0, 0.8, 4.0), (40, 1.25, 14.0))
    lamps = [patch(camera, x, 0.0, depth, 1.5, light) for x, depth, light in places]
    images[system.name] = picture(lamps, camera, lens, 1024)
show(images, 9, 2.0)

# %%
# Lateral colour
# --------------
#
# Blue's picture is smaller than red's, where the stop is far from the lens: white bars get coloured edges, more so
# towards the right. Film heights of 6 to 16 mm, f/16.

flint = LensSystem(
    "flint behind a stop",
    (
        Surface(math.inf, 16.0, AIR, 1.6, is_stop=True),
        Surface(-200.0, 7.0, glass_of("N-SF11"), 14.0),
        Surface(-33.0, 50.0, AIR, 14.0),
    ),
)
images = {}
for system in (refdof.load_lens("cooke_triplet"), flint):
    lens = refdof.SystemLens(system, 1.0, f_number=16.0)
    camera = camera_of(lens, 0.8, (800, 20))
    bars = [patch(camera, x, 0.0, 1.0, 6.0, half_y=7.0) for x in np.arange(160.0, 400.0, 24.0)]
    images[system.name] = picture(bars, camera, lens, 64, "box")[:, 550:]
show(images, 9, 2.0, columns=1)

# %%
# Vignetting and breathing
# ------------------------
#
# The double Gauss, wide open, cuts the light of its corners. Focused nearer, it moves away from the film, and the wall
# far behind is drawn larger.

system = refdof.load_lens("double_gauss")
whole = refdof.SystemLens(system, math.inf, f_number=8.0)
chart_camera = camera_of(whole, 24.0, (180, 120))
columns, rows = (np.arange(12) - 5.5) * 15.0, (np.arange(8) - 3.5) * 15.0
wall = [patch(chart_camera, x, y, 50.0, 6.0, 0.7) for x in columns for y in rows]
images = {}
for name, distance, f_number in (
    ("f/8, focused at infinity", math.inf, 8.0),
    ("f/2, focused at infinity", math.inf, 2.0),
    ("f/8, focused at 0.6 m", 0.6, 8.0),
):
    lens = refdof.SystemLens(system, distance, f_number=f_number)
    images[name] = picture(wall, camera_of(lens, 24.0, (180, 120)), lens, 64, "box")
show(images, 9, 2.4)
