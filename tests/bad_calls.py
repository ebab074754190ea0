"""Every public door with one valid call, and the values that nobody should hand to it.

`DOORS` maps a name to a call and to its arguments, all of them. `INNER` names what stands after validation: helpers of
kernels and methods, and records that come out. `tests/test_bad_calls.py` runs the table and fails for a public name in
neither.
"""

import contextlib
import importlib
import inspect
import math
import pkgutil
from collections.abc import Callable
from dataclasses import fields, replace
from inspect import signature
from typing import Any, NamedTuple
from unittest import mock

import numpy as np

import refdof
from refdof import METHODS, Aperture, Camera, ExpressiveLens, Light, Material, Part, Scene, ThinLens, View
from refdof.cluster import connected
from refdof.compare import compare
from refdof.filtering import methods_of_frame
from refdof.focus.focus_lens import Focus, focus_lens
from refdof.focus.point import FocusPoint, pick
from refdof.frame.depth_kinds import planar_depth
from refdof.frame.files import load_frame
from refdof.frame.frame import Frame, frame_camera
from refdof.image.file import load_image, png_bytes, save_image
from refdof.kernel_shape import kernel_shape
from refdof.methods import cascaded, poisson, singlepass
from refdof.methods.cascaded import matting
from refdof.methods.multiview import coverage
from refdof.metrics.artefacts import ArtefactMaps, artefacts, flicker, moments
from refdof.motion import flickers, moved_views
from refdof.optics.lens import photographic_share
from refdof.optics.pixel_samples import lens_point_sets
from refdof.optics.systems import glass, lens_map, paraxial, pupil, spectrum, system, trace
from refdof.optics.systems.glass import glass_of
from refdof.optics.systems.height_lens import HeightLens
from refdof.optics.systems.prescription import load_lens, save_lens
from refdof.optics.systems.system import ThickLens
from refdof.optics.systems.system_lens import SystemLens
from refdof.raster.filters import mip_chain, n_buffer
from refdof.raster.gpu import ambiguity, gpu_model, texture
from refdof.raster.gpu.depth_peeling import peel_raster
from refdof.raster.gpu.gpu_model import EXACT, GpuModel
from refdof.raster.gpu.rasterize import rasterize
from refdof.raster.materials.cutouts import OPAQUE
from refdof.raster.rays import umbra
from refdof.rendering import make_params, render_view
from refdof.scene.limits import Limits
from refdof.scene.load import load_scene
from refdof.scene.mesh_file import load_mesh
from refdof.stages import StageRecorder
from refdof.testing import check_properties
from refdof.truth.forecast import forecast_of_view
from refdof.truth.reference import reference_of_view
from tests.testing.filters import gather

NAN, INF = math.nan, math.inf


class Door(NamedTuple):
    """A call and its arguments. Results may hold infinities or NaN only if `any_result` says that they are documented.

    `says` names, for an argument, what else an error may begin with.
    """

    call: Callable[..., Any]
    base: dict[str, Any]
    says: dict[str, tuple[str, ...]] = {}  # noqa: RUF012
    any_result: bool = False


CAMERA = Camera((0.0, 0.0, 4.0), (0.0, 0.0, 0.0), fov_y=40.0, size=(3, 2))
LARGER = CAMERA.with_size((11, 11))  # the window of SSIM
LENS, PINHOLE = ThinLens(0.25, 3.0), ThinLens(0.0, 3.0)
POINT = FocusPoint(0, (1.0, 1.0, 1.0), keep=True)
EXPRESSIVE = ExpressiveLens(0.25, 3.0, 0.5, power=(1.0, 1.1), image_offset=(0.0, 0.1))
CORNERS = np.array([[-9.0, -9.0, 0.0], [9.0, -9.0, 0.0], [0.0, 9.0, 1.0]])
FACES = np.array([[0, 1, 2]])
UV = np.array([[0.0, 0.0], [1.0, 0.0], [0.5, 1.0]])
NORMAL = np.array([[0.0, 0.0, 1.0]] * 3)
TEXELS = np.linspace(0.0, 1.0, 12).reshape(2, 2, 3)
MATERIAL = Material(
    "phong",
    (0.5, 0.5, 0.5),
    TEXELS,
    (0.0, 0.1, 0.0),
    (0.2, 0.2, 0.2),
    8.0,
    TEXELS,
    0.9,
    1.0 - 0.25 * TEXELS[..., 0],
    0.5,
)
# Of one colour: it meets any tolerance at once.
EVEN = Scene.from_parts("even", [Part(CORNERS, FACES, Material("unlit"))], CAMERA, LENS, (1.0, 1.0, 1.0))
LIGHT = Light(environment=np.full((2, 2, 3), 0.5))
PART = Part(CORNERS, FACES, MATERIAL, UV, np.full((3, 3), 0.5), NORMAL)
SCENE = Scene.from_parts("stage", [PART], CAMERA, LENS, (0.1, 0.2, 0.3), LIGHT)
MOVING = SCENE.with_frames(np.stack([SCENE.vertices, SCENE.vertices + 0.5]))
COLOR = np.linspace(0.1, 1.0, 18).reshape(2, 3, 3).astype(np.float32)
WIDE = np.linspace(0.0, 1.0, 363).reshape(11, 11, 3)
FRAME = Frame(WIDE, np.full((11, 11), 2.0), LARGER, LENS)
DEPTH = np.array([[1.0, 2.0, 3.0], [4.0, 5.0, INF]])
COC = np.array([[-2.0, -1.0, 0.0], [0.5, 1.0, 1.5]])
CAMERA_SPACE = np.array([[-9.0, -9.0, -4.0], [9.0, -9.0, -4.0], [0.0, 9.0, -3.0]])
PLACES = np.array([0.25, 0.5])
INDICES = np.array([0, 1])


def _view() -> View:
    return View(SCENE, CAMERA, LENS)


def _with(call: Callable[..., Any], **fixed: Any) -> Callable[..., Any]:
    return lambda **words: call(**fixed, **words)


def _unwarmed(**words: Any) -> Any:
    """`compare` without compiling first: where nothing is compiled, that takes longer than the rest."""
    with mock.patch("refdof.compare.warm_up"):
        return compare(**words)


def _unwarmed_filter(**words: Any) -> Any:
    """`filter_frame` in the same way."""
    with mock.patch("refdof.compare.warm_up"):
        return refdof.filter_frame(**words)


def _rendered(name: str) -> Callable[..., Any]:
    return lambda **words: refdof.render(name, SCENE, stages=True, **words)


def _connected(**words: Any) -> None:
    """Without starting workers that are allowed."""
    with (
        mock.patch("refdof.cluster.by_dask.started", return_value=contextlib.nullcontext()),
        connected(**words),
    ):
        pass


def _params_base(name: str) -> dict[str, Any]:
    base = {field.name: getattr(METHODS[name].Params(), field.name) for field in fields(METHODS[name].Params)}
    return base | ({"samples": 4} if "samples" in base else {})


_PICTURES = {"color": COLOR, "depth": DEPTH, "coc": COC}
_PAIR = {"reference": WIDE, "image": WIDE**2}
_SIZES = {"reference": ("image", "second_reference")}  # the reference has the say
_RASTER = {
    "vertices": CAMERA_SPACE,
    "faces": FACES,
    "camera": CAMERA,
    "near": 0.1,
    "far": 100.0,
    "model": EXACT,
    "precision": "float64",
    "depth_format": "linear",
}
_TEXTURE = {"image": COLOR, "model": EXACT}
_REFERENCE = {
    "camera": CAMERA,
    "lens": LENS,
    "samples": 16,
    "replicates": 16,
    "seed": 0,
    "tolerance": None,
    "pixel_filter": "centre",
    "shared_pattern": False,
    "progress": None,
    "max_samples": 64,
    "cluster": None,
}
_SHOT = {"scene": SCENE, "camera": CAMERA, "lens": LENS}
_APERTURE = {"boundary": np.zeros((0, 2)), "weights": np.zeros((0, 0)), "scale": (1.0, 1.0), "deviation": INF}

DOORS: dict[str, Door] = {
    "refdof.optics.aperture.Aperture": Door(Aperture, _APERTURE),
    "refdof.optics.aperture.Aperture.disc": Door(Aperture.disc, {"ratio": 1.0}),
    "refdof.optics.aperture.Aperture.gaussian": Door(Aperture.gaussian, {"deviation": 0.5, "ratio": 1.0}),
    "refdof.optics.aperture.Aperture.polygon": Door(
        Aperture.polygon, {"blades": 5, "rotation": 10.0, "curvature": 0.5, "ratio": 1.0}
    ),
    "refdof.optics.aperture.Aperture.image": Door(Aperture.image, {"weights": np.ones((2, 2)), "ratio": 1.0}),
    "refdof.optics.aperture.Aperture.from_square": Door(Aperture.polygon(5).from_square, {"square": UV}),
    "refdof.optics.aperture.Aperture.transmission": Door(Aperture.image(np.ones((2, 2))).transmission, {"points": UV}),
    "refdof.optics.camera.Camera": Door(
        Camera,
        {"eye": (0.0, 0.0, 4.0), "target": (0.0, 0.0, 0.0), "up": (0.0, 1.0, 0.0), "fov_y": 40.0, "size": (3, 2)},
        {"eye": ("target", "up"), "target": ("up",)},
    ),
    "refdof.optics.camera.Camera.look_at": Door(
        Camera.look_at,
        {"eye": (0.0, 0.0, 4.0), "target": (0.0, 0.0, 0.0), "up": (0.0, 1.0, 0.0), "fov_y": 40.0, "size": (3, 2)},
        {"eye": ("target", "up"), "target": ("up",)},
    ),
    "refdof.optics.camera.Camera.with_size": Door(CAMERA.with_size, {"size": (3, 2)}),
    "refdof.optics.camera.Camera.camera_from_world": Door(CAMERA.camera_from_world, {"points": CORNERS}),
    "refdof.optics.camera.Camera.project": Door(
        CAMERA.project, {"points": CORNERS}, any_result=True
    ),  # NaN behind the eye
    "refdof.compare.compare": Door(
        _unwarmed,
        {
            "scene": SCENE,
            "methods": ["scatter"],
            "params": {"scatter": {"order": "none"}},
            "camera": LARGER,
            "lens": PINHOLE,
            "samples": 16,
            "tolerance": None,
            "seed": 0,
            "progress": None,
            "preset": "best",
            "max_samples": 64,
            "announce": None,
            "cluster": None,
        },
        {"methods": ("params",), "camera": ("size",)},
        any_result=True,  # PSNR of identical pictures
    ),
    "refdof.cluster.connection.connected": Door(_connected, {"scheduler": None, "workers": None, "wait_s": 1.0}),
    "refdof.filtering.filter_frame": Door(
        _unwarmed_filter,
        {
            "frame": FRAME,
            "methods": ["scatter"],
            "params": {"scatter": {}},
            "preset": "best",
            "reference": WIDE,
            "progress": None,
        },
        {"params": ("order",), "methods": ("params",), "frame": ("reference",)},
        True,
    ),
    "refdof.filtering.methods_of_frame": Door(methods_of_frame, {"frame": FRAME}),
    "refdof.frame.depth_kinds.planar_depth": Door(
        planar_depth,
        {"values": np.minimum(DEPTH, 6.0) / 8.0, "kind": "device", "camera": CAMERA, "near": 1.0, "far": 9.0},
        {"values": ("depth",), "camera": ("depth",), "kind": ("depth", "near", "far"), "near": ("far",)},
        True,
    ),
    "refdof.frame.files.load_frame": Door(
        load_frame,
        {
            "color": "picture.npy",
            "depth": "depth.npy",
            "fov_y": 40.0,
            "lens": LENS,
            "coc": None,
            "depth_kind": "planar",
            "near": None,
            "far": None,
        },
        {"depth_kind": ("kind", "depth", "near", "far"), "color": ("depth",), "coc": ("lens",)},
    ),
    "refdof.frame.frame.Frame": Door(
        Frame,
        {
            "color": COLOR,
            "depth": DEPTH,
            "camera": CAMERA,
            "lens": LENS,
            "coc": None,
            "layers": None,
            "background": (0.0, 0.0, 0.0),
            "name": "frame",
        },
        {"camera": ("color",), "coc": ("lens",)},
    ),
    "refdof.frame.frame.frame_camera": Door(frame_camera, {"fov_y": 40.0, "size": (3, 2)}),
    "refdof.image.display.display": Door(refdof.image.display.display, {"linear": COLOR}, {"linear": ("image",)}),
    "refdof.image.display.display_slope": Door(
        refdof.image.display.display_slope, {"linear": COLOR}, {"linear": ("image",)}
    ),
    "refdof.image.display.linear_from_display": Door(refdof.image.display.linear_from_display, {"encoded": COLOR}),
    "refdof.image.display.to_8_bit": Door(refdof.image.display.to_8_bit, {"linear": COLOR}, {"linear": ("image",)}),
    "refdof.truth.forecast.forecast": Door(
        refdof.forecast, {"scene": EVEN, "tolerance": 0.1, "max_samples": 64, "seed": 0, "camera": CAMERA, "lens": LENS}
    ),
    "refdof.truth.forecast.forecast_of_view": Door(
        forecast_of_view, {"view": View(EVEN, CAMERA, LENS), "tolerance": 0.1, "max_samples": 64, "seed": 0}
    ),
    "refdof.image.file.load_image": Door(load_image, {"path": "picture.npy"}),
    "refdof.image.file.png_bytes": Door(png_bytes, {"linear": COLOR}, {"linear": ("image",)}),
    "refdof.image.file.save_image": Door(
        save_image, {"path": "new.npy", "linear": COLOR}, {"path": ("out",), "linear": ("image", "out")}
    ),
    "refdof.optics.lens.ThinLens": Door(ThinLens, {"radius": 0.25, "focus_distance": 3.0, "aperture": Aperture.disc()}),
    "refdof.optics.lens.ThinLens.from_f_number": Door(
        ThinLens.from_f_number,
        {"focal_length": 0.05, "f_number": 2.0, "focus_distance": 3.0, "aperture": None},
        {"focal_length": ("focus_distance", "f_number")},
    ),
    "refdof.optics.expressive_lens.ExpressiveLens": Door(
        ExpressiveLens,
        {
            "radius": 0.25,
            "focus_distance": 3.0,
            "focal_length": 0.5,
            "power": (1.0, 1.1),
            "ray_weights": (1.0, 2.0),
            "image_offset": (0.0, 0.1),
            "indices": (1.5, 1.5, 1.5),
            "focal_surface": ((2.0, 3.0),),
            "aperture_scale": ((0.5, 1.0),),
            "aperture": Aperture.disc(),
        },
        {"focus_distance": ("focal_length",), "focal_length": ("image_offset", "focal_surface")},
    ),
    "refdof.optics.expressive_lens.ExpressiveLens.coc_px": Door(EXPRESSIVE.coc_px, {"depth": DEPTH, "camera": CAMERA}),
    "refdof.optics.expressive_lens.ExpressiveLens.inverse_focus": Door(EXPRESSIVE.inverse_focus, {"camera": CAMERA}),
    "refdof.optics.lens.ThinLens.coc_px": Door(LENS.coc_px, {"depth": DEPTH, "camera": CAMERA}),
    "refdof.optics.pixel_samples.lens_point_sets": Door(
        lens_point_sets, {"count": 4, "aperture": Aperture.disc(), "jitter": "noise", "pattern": "sobol", "seed": 0}
    ),
    "refdof.optics.systems.prescription.load_lens": Door(load_lens, {"name": "biconvex"}, {"name": ("lens",)}),
    "refdof.optics.systems.prescription.save_lens": Door(
        save_lens, {"path": "new.toml", "system": load_lens("biconvex")}
    ),
    "refdof.optics.systems.system_lens.SystemLens": Door(
        SystemLens,
        {
            "system": load_lens("biconvex"),
            "focus_distance": 3.0,
            "f_number": 8.0,
            "mm_per_unit": 1000.0,
            "wavelengths": 3,
            "vignetting": True,
        },
        {"mm_per_unit": ("focus_distance",)},
    ),
    "refdof.optics.systems.system_lens.SystemLens.seen_by": Door(
        SystemLens(load_lens("biconvex"), 3.0).seen_by, {"camera": CAMERA}
    ),
    "refdof.scene.limits.Limits": Door(Limits, {f.name: getattr(Limits(), f.name) for f in fields(Limits)}),
    "refdof.scene.limits.Limits.with_words": Door(
        Limits().with_words, {"words": ["pixels=1e9"]}, {"words": ("limit",)}
    ),
    "refdof.scene.load.load_scene": Door(
        load_scene,
        {"name": "triangle.obj", "shading": None, "background": None, "limits": Limits(), "file_camera": True},
        {"name": ("scene",)},
    ),
    "refdof.scene.mesh_file.load_mesh": Door(
        load_mesh,
        {
            "path": "triangle.obj",
            "shading": None,
            "background": (0.0, 0.0, 0.0),
            "limits": Limits(),
            "file_camera": True,
        },
        {"path": ("scene",)},
    ),
    "refdof.methods.cascaded.method.blur_buffers": Door(
        cascaded.blur_buffers,
        {
            "color": COLOR[None],
            "depth": DEPTH[None],
            "camera": CAMERA,
            "lens": LENS,
            "params": cascaded.Params(),
            "recorder": None,
        },
        {"camera": ("color",)},
    ),
    "refdof.kernel_shape.kernel_shape": Door(
        kernel_shape,
        {"method": "separable", "circle": 2.0, "light": 1, "in_front": False, "preset": "best", "params": {}},
        {"params": ("parameter", "values")},
        True,  # NaN of a light that is lost
    ),
    "refdof.testing.check.check_properties": Door(
        check_properties,
        {
            "function": gather,
            "promises": ["pinhole"],
            "inputs": ["color", "depth", "coc"],
            "channels": 3,
            "tolerance": 1e-5,
            "reach": 1.0,
            "circle": 1.0,
            "examples": 2,
        },
    ),
    "refdof.motion.moved_views": Door(moved_views, {"view": View(SCENE, CAMERA, LENS), "frames": 3}),
    "refdof.motion.flickers": Door(
        flickers,
        {
            "view": View(SCENE, CAMERA, LENS),
            "methods": ["separable"],
            "params": {"separable": {}},
            "preset": "best",
            "samples": 16,
            "frames": 3,
            "seed": 0,
            "progress": None,
        },
        {"methods": ("params",)},
        True,  # NaN where all is sharp
    ),
    "refdof.metrics.artefacts.artefacts": Door(
        artefacts,
        {"maps": ArtefactMaps(DEPTH, COC, COLOR), "reference": COLOR, "image": 2.0 * COLOR},
        {"reference": ("image",)},
        True,  # NaN where there are no such pixels
    ),
    "refdof.metrics.artefacts.flicker.flicker": Door(
        flicker,
        {
            "frames": np.stack([COLOR, 2.0 * COLOR, COLOR]),
            "region": COC > 0.0,
            "second": np.stack([COLOR, COLOR, 3.0 * COLOR]),
        },
        {"frames": ("region", "second")},
        True,  # NaN of no pixel
    ),
    "refdof.metrics.artefacts.maps.ArtefactMaps": Door(
        lambda **words: artefacts(ArtefactMaps(**words), COLOR, 2.0 * COLOR),
        {"depth": DEPTH, "coc": COC, "color": COLOR, "standard_error": 0.1 * COLOR},
        {"coc": ("depth",)},
        True,  # as above
    ),
    "refdof.metrics.artefacts.moments.moments": Door(moments, {"spot": COLOR}, any_result=True),  # NaN without light
    "refdof.metrics.scores": Door(refdof.metrics.scores, _PAIR, _SIZES, True),
    "refdof.metrics.perceptual.flip": Door(refdof.metrics.flip, _PAIR, _SIZES),
    "refdof.metrics.pointwise.max_abs": Door(refdof.metrics.max_abs, _PAIR, _SIZES),
    "refdof.metrics.pointwise.psnr": Door(refdof.metrics.psnr, _PAIR, _SIZES, True),
    "refdof.metrics.pointwise.psnr_8bit": Door(refdof.metrics.psnr_8bit, _PAIR, _SIZES, True),
    "refdof.metrics.pointwise.rel_mse": Door(refdof.metrics.rel_mse, _PAIR | {"second_reference": WIDE}, _SIZES),
    "refdof.metrics.pointwise.rmse": Door(refdof.metrics.rmse, _PAIR | {"second_reference": WIDE}, _SIZES),
    "refdof.metrics.structural.ssim": Door(refdof.metrics.ssim, _PAIR, _SIZES),
    "refdof.image.noise_floor.noise_floor_of_pair": Door(
        refdof.metrics.noise_floor_of_pair,
        {"reference": COLOR, "second": COLOR / 2},
        {"reference": ("second",)},
        True,
    ),
    "refdof.image.noise_floor.noise_floor_psnr": Door(
        refdof.metrics.noise_floor_psnr,
        {"reference": COLOR, "standard_error": COLOR / 100},
        {"reference": ("standard_error",)},
        True,
    ),
    "refdof.raster.gpu.ambiguity.ambiguous_pixels": Door(
        ambiguity.ambiguous_pixels,
        {"vertices": CAMERA_SPACE, "faces": FACES, "camera": CAMERA, "depth": DEPTH[None], "model": EXACT},
        {"vertices": ("faces",), "camera": ("depth",)},
    ),
    "refdof.raster.gpu.ambiguity.near_edges": Door(
        ambiguity.near_edges,
        {"vertices": CAMERA_SPACE, "faces": FACES, "camera": CAMERA, "reach_px": 0.5},
        {"vertices": ("faces",)},
    ),
    "refdof.methods.multiview.coverage.average_color": Door(coverage.average_color, {"texels": COLOR}, any_result=True),
    "refdof.methods.multiview.coverage.coverage_mipmaps": Door(
        coverage.coverage_mipmaps,
        {"color": COLOR, "covered": DEPTH < 5, "model": EXACT},
        {"covered": ("color",)},
        any_result=True,
    ),
    "refdof.raster.gpu.depth_peeling.peel_raster": Door(
        peel_raster,
        {"vertices": CAMERA_SPACE, "faces": FACES, "camera": CAMERA, "count": 2, "umbra": 0.0},
        {"vertices": ("faces",)},
        any_result=True,
    ),
    "refdof.raster.gpu.gpu_model.GpuModel": Door(GpuModel, {f.name: getattr(EXACT, f.name) for f in fields(GpuModel)}),
    "refdof.raster.gpu.gpu_model.store": Door(
        gpu_model.store, {"values": COLOR, "texture_format": "f16", "model": EXACT}, any_result=True
    ),
    "refdof.methods.cascaded.matting.layer_coordinate": Door(
        matting.layer_coordinate,
        {"depth": DEPTH, "bounds": np.array([1.0, 2.0, 5.0]), "boundary": "extrapolate", "dtype": np.float32},
    ),
    "refdof.methods.cascaded.matting.ramp_code": Door(matting.ramp_code, {"ramp": "none"}),
    "refdof.raster.filters.mip_chain.box_mipmaps": Door(mip_chain.box_mipmaps, {"image": COLOR}, any_result=True),
    "refdof.raster.filters.mip_chain.extreme_mipmaps": Door(
        mip_chain.extreme_mipmaps, {"depth": DEPTH}, any_result=True
    ),
    "refdof.raster.filters.mip_chain.gaussian_mipmaps": Door(
        mip_chain.gaussian_mipmaps, _TEXTURE | {"deviation": 1.0}, any_result=True
    ),
    "refdof.raster.filters.mip_chain.generate_mipmaps": Door(mip_chain.generate_mipmaps, _TEXTURE, any_result=True),
    "refdof.raster.filters.n_buffer.n_buffer": Door(
        n_buffer.n_buffer, {"depth": DEPTH, "extremes": "both", "largest": 2, "block": 1}, any_result=True
    ),
    "refdof.raster.filters.n_buffer.query": Door(
        n_buffer.query,
        {
            "nbuffer": n_buffer.n_buffer(DEPTH),
            "x0": INDICES,
            "y0": INDICES,
            "x1": INDICES,
            "y1": INDICES,
            "exact": False,
        },
        {"x0": ("x1", "y0", "x1", "y1"), "y0": ("y1",)},
        any_result=True,
    ),
    "refdof.raster.gpu.texture.bilinear": Door(
        texture.bilinear, _TEXTURE | {"u": PLACES, "v": PLACES, "border": None}, {"u": ("u, v",), "v": ("u, v",)}, True
    ),
    "refdof.raster.gpu.texture.fetch": Door(
        texture.fetch, _TEXTURE | {"x": INDICES, "y": INDICES}, {"x": ("x, y",), "y": ("x, y",)}, True
    ),
    "refdof.raster.gpu.texture.level_of_detail": Door(
        texture.level_of_detail,
        {"squared": PLACES, "model": EXACT, "bias": 0.5},
        {"squared": ("squared, bias",), "bias": ("squared, bias",)},
    ),
    "refdof.raster.gpu.texture.trilinear": Door(
        texture.trilinear,
        {"levels": [COLOR, COLOR[:1, :1]], "u": PLACES, "v": PLACES, "lod": PLACES, "model": EXACT, "border": None},
        {"u": ("u, v, lod",), "v": ("u, v, lod",), "lod": ("u, v, lod",)},
        True,
    ),
    "refdof.raster.gpu.rasterize.rasterize": Door(
        _with(rasterize),
        _RASTER | {"previous_depth": None, "cutouts": OPAQUE},
        {"vertices": ("faces",), "near": ("far",), "model": ("precision",)},
        True,
    ),
    "refdof.raster.rays.umbra.survivors": Door(
        umbra.survivors, {"depth": np.stack([DEPTH, DEPTH]), "camera": CAMERA, "lens": LENS, "extent_px": 2}
    ),
    "refdof.raster.rays.umbra.umbra_step": Door(
        umbra.umbra_step, {"camera": CAMERA, "lens": LENS, "extent_px": 2}, any_result=True
    ),
    "refdof.raster.rays.umbra.worst_case_layers": Door(
        umbra.worst_case_layers,
        {"camera": CAMERA, "lens": LENS, "near": 1.0, "far": 9.0, "extent_px": 2},
        {"near": ("far",)},
    ),
    "refdof.truth.reference.reference": Door(refdof.reference, {"scene": EVEN} | _REFERENCE, any_result=True),
    "refdof.truth.reference.reference_of_view": Door(
        reference_of_view,
        {"view": View(EVEN, CAMERA, LENS)} | {k: v for k, v in _REFERENCE.items() if k not in ("camera", "lens")},
        any_result=True,  # no noise: a floor of infinity
    ),
    "refdof.rendering.make_params": Door(
        make_params,
        {"method": "scatter", "values": {"order": "none"}, "preset": "best"},
        {"values": ("parameter of scatter",)},
    ),
    "refdof.rendering.render": Door(refdof.render, {"method": "scatter", "stages": False, "preset": "best"} | _SHOT),
    "refdof.rendering.render_view": Door(
        render_view, {"method": "scatter", "view": _view(), "stages": False, "preset": "best"}
    ),
    "refdof.optics.lens_samples.lens_samples": Door(
        refdof.lens_samples, {"count": 4, "pattern": "sobol", "seed": 0, "aperture": Aperture.disc()}
    ),
    "refdof.scene.material.Light": Door(Light, {f.name: getattr(LIGHT, f.name) for f in fields(Light)}),
    "refdof.optics.lens.photographic_share": Door(
        photographic_share,
        {"focal_length": 0.05, "focus_distance": 3.0},
        {"focus_distance": ("focal_length",)},
    ),
    "refdof.scene.material.Material": Door(Material, {f.name: getattr(MATERIAL, f.name) for f in fields(Material)}),
    "refdof.scene.scene.Part": Door(
        Part, {f.name: getattr(PART, f.name) for f in fields(Part)}, {"vertices": ("faces", "uv", "color", "normal")}
    ),
    "refdof.scene.scene.Scene": Door(
        Scene,
        {f.name: getattr(SCENE, f.name) for f in fields(Scene)},
        {"vertices": ("faces", "uv", "color", "normal"), "faces": ("face_material",), "materials": ("face_material",)},
    ),
    "refdof.scene.scene.Scene.at_frame": Door(MOVING.at_frame, {"frame": 0.5}),
    "refdof.scene.scene.Scene.with_frames": Door(SCENE.with_frames, {"vertices": np.stack([SCENE.vertices] * 2)}),
    "refdof.scene.scene.Scene.from_parts": Door(
        Scene.from_parts,
        {"name": "a", "parts": [PART], "camera": CAMERA, "lens": LENS, "background": (0.0, 0.0, 0.0), "light": LIGHT},
    ),
    "refdof.scene.scene.Scene.scaled": Door(SCENE.scaled, {"factor": 2.0}),
    "refdof.scene.scene.Scene.with_background": Door(SCENE.with_background, {"background": (0.0, 0.0, 0.0)}),
    "refdof.scene.scene.Scene.with_shading": Door(SCENE.with_shading, {"shading": "unlit"}),
    "refdof.stages.Stages": Door(refdof.Stages, {"steps": (1, 2), "pixels": ((0, 1),)}),
    "refdof.view.View": Door(View, _SHOT),
    "refdof.view.View.at_frame": Door(View(MOVING, CAMERA, LENS).at_frame, {"frame": 0.5}),
    "refdof.view.View.with_lens": Door(lambda **words: _view().with_lens(**words), {"lens": LENS}),
    "refdof.view.View.with_size": Door(lambda **words: _view().with_size(**words), {"size": (32, 24)}),
    "refdof.focus.point.FocusPoint": Door(
        FocusPoint,
        {
            "triangle": 0,
            "barycentrics": (0.5, 0.25, 0.25),
            "offset": 0.1,
            "aperture": 0.5,
            "weight": 2.0,
            "falloff": 3.0,
            "image_offset": 0.001,
            "keep": False,
            "name": "door",
        },
    ),
    "refdof.focus.point.FocusPoint.value": Door(POINT.value, {"word": "weight", "frame": 3.0}),
    "refdof.focus.point.pick": Door(
        pick, {"view": _view(), "pixel": tuple(size // 2 for size in CAMERA.size), "name": "door"}, any_result=True
    ),
    "refdof.focus.focus_lens.Focus": Door(
        Focus,
        {
            "points": (POINT,),
            "kind": "surface",
            "focal_length": 0.05,
            "power": ((0.0, 1.0), (1.0, 1.02)),
            "ray_weights": ((0.0, 0.5), (1.0, 2.0)),
        },
    ),
    "refdof.focus.focus_lens.focus_lens": Door(
        focus_lens, {"focus": Focus((POINT,)), "view": _view(), "frame": 0.0}, {"frame": ("points", "triangle")}
    ),
    "refdof.view.View.layers": Door(lambda **words: _view().layers(**words), {"count": 1}, any_result=True),
    "refdof.view.View.surface_counts": Door(lambda **words: _view().surface_counts(**words), {"extent_px": 0}),
    "refdof.view.View.umbra_layers": Door(
        lambda **words: _view().umbra_layers(**words), {"count": 1, "extent_px": 2}, any_result=True
    ),
    "refdof.view.view_of": Door(refdof.view.view_of, _SHOT),
}
DOORS["refdof.methods.singlepass.ties.bounds"] = Door(
    singlepass.bounds,
    _PICTURES | {"params": singlepass.Params(max_taps=9), "epsilon": 1e-3, "hair": 1e-6},
    {"color": ("depth", "coc")},
)
DOORS["refdof.methods.poisson.ties.bounds"] = Door(
    poisson.bounds, _PICTURES | {"params": poisson.Params(), "hair": 1e-5}, {"color": ("depth", "coc")}
)
for _name, _module in METHODS.items():
    DOORS[f"{_module.Params.__module__}.Params"] = Door(
        _rendered(_name),
        _params_base(_name),
        {"near": ("near, far", "spacing_px"), "far": ("near", "near, far", "spacing_px")},
        any_result=True,
    )
    if _module.METHOD.kind == "single image":
        DOORS[f"{_module.blur.__module__}.blur"] = Door(
            _module.blur,
            _PICTURES
            | {"params": _module.Params()}
            | ({"stages": False} if "stages" in signature(_module.blur).parameters else {}),
            {"color": ("depth", "coc")},
        )

LENS_SYSTEM = ThickLens(60.0, -80.0, 6.0, 25.0, glass_of("N-BK7")).system()
_SURFACE = {"radius": 60.0, "thickness": 6.0, "glass": glass_of("N-BK7"), "semi_diameter": 12.5, "is_stop": True}
_THICK = {"radius1": 60.0, "radius2": -80.0, "thickness": 6.0, "diameter": 25.0, "glass": glass_of("N-BK7")}
_HEIGHTS = {
    "front": np.zeros((9, 9)),
    "back": np.zeros((9, 9)),
    "thickness": 3.0,
    "diameter": 10.0,
    "glass": glass_of("N-BK7"),
}
_RAYS = {
    "system": LENS_SYSTEM,
    "origins": np.array([[0.0, 1.0, -9.0], [2.0, 0.0, -8.0]]),
    "directions": np.array([[0.0, 0.1, 1.0], [0.1, 0.0, 1.0]]),
    "wavelength_um": 0.5,
    "reverse": False,
}
_LENS = {"system": LENS_SYSTEM, "wavelength_um": 0.5}
_FOCUS = _LENS | {"focus_distance": 900.0}
_PUPIL = {"system": LENS_SYSTEM, "reach": 2.0, "sensor": 80.0, "wavelength_um": 0.5, "intervals": 1, "rims": True}
_LENS_MAP = {
    "system": LENS_SYSTEM,
    "camera": CAMERA,
    "focus_distance": 2.0,
    "wavelengths_um": (0.5,),
    "sensor_height": 4.0,
    "millimetres": 1000.0,
    "rims": True,
}


def _coarse(call: Callable[..., Any]) -> Callable[..., Any]:
    """A search for pupils on small grids: interpreted, the others take seconds."""

    def search(**words: Any) -> Any:
        with mock.patch("refdof.optics.systems.pupil._GRIDS", (8, 4)):
            return call(**words)

    return search


DOORS |= {
    f"refdof.optics.systems.{name}": door
    for name, door in {
        "glass.Glass": Door(
            glass.Glass,
            {"name": "crown", "n_d": 1.5, "v_d": 60.0, "b": (), "c": (), "source": ""},
            {"b": ("n_d", "c")},
        ),
        "glass.Glass.index": Door(glass_of("N-BK7").index, {"wavelength_um": 0.5}),
        "glass.glass_of": Door(glass_of, {"name": "N-BK7"}, {"name": ("glass",)}),
        "system.Surface": Door(system.Surface, _SURFACE, {"radius": ("semi_diameter",)}),
        "system.Surface.sag": Door(LENS_SYSTEM.surfaces[0].sag, {"height": 1.0}),
        "system.LensSystem": Door(
            system.LensSystem, {"name": "lens", "surfaces": LENS_SYSTEM.surfaces, "source": "catalogue"}
        ),
        "system.LensSystem.indices": Door(LENS_SYSTEM.indices, {"wavelength_um": 0.5}),
        "system.LensSystem.with_stop": Door(LENS_SYSTEM.with_stop, {"semi_diameter": 3.0}),
        "system.ThickLens": Door(
            ThickLens,
            _THICK,
            {"radius1": ("thickness",), "radius2": ("thickness",), "diameter": ("radius1", "radius2", "thickness")},
        ),
        "system.ThickLens.system": Door(ThickLens(**_THICK).system, {"name": "lens"}),
        "height_lens.HeightLens": Door(
            HeightLens,
            _HEIGHTS | {"stop_diameter": 4.0, "name": "lens"},
            {
                "front": ("back", "thickness"),
                "back": ("thickness",),
                "diameter": ("front", "back", "stop_diameter", "thickness"),
                "stop_diameter": ("front",),
            },
        ),
        "height_lens.HeightLens.from_functions": Door(
            HeightLens.from_functions,
            _HEIGHTS | {"front": lambda x, y: x * x / 40.0, "back": lambda x, y: 0.0 * x, "samples": 9},
            {"diameter": ("front", "back", "thickness")},
        ),
        "height_lens.HeightLens.of": Door(HeightLens.of, {"lens": ThickLens(**_THICK), "samples": 9}),
        "height_lens.HeightLens.with_stop": Door(HeightLens(**_HEIGHTS).with_stop, {"semi_diameter": 2.0}),
        "trace.trace": Door(trace.trace, _RAYS, {"origins": ("directions",)}),
        "trace.trace_path": Door(
            trace.trace_path, _RAYS, {"origins": ("directions",)}, any_result=True
        ),  # NaN: stopped
        "paraxial.cardinal_points": Door(paraxial.cardinal_points, _LENS),
        "paraxial.entrance_pupil": Door(paraxial.entrance_pupil, _LENS),
        "paraxial.exit_pupil": Door(paraxial.exit_pupil, _LENS),
        "paraxial.f_number": Door(paraxial.f_number, _LENS),
        "paraxial.focal_length": Door(paraxial.focal_length, _LENS),
        "paraxial.image_scale": Door(paraxial.image_scale, _FOCUS),
        "paraxial.nearest_focus": Door(paraxial.nearest_focus, _LENS),
        "paraxial.sensor_for": Door(paraxial.sensor_for, _FOCUS),
        "paraxial.stopped_down": Door(paraxial.stopped_down, _LENS | {"f_stop": 8.0}),
        "paraxial.transmission": Door(paraxial.transmission, _LENS),
        "spectrum.color_matching": Door(spectrum.color_matching, {"wavelength_um": 0.5}),
        "spectrum.wavelengths_of": Door(spectrum.wavelengths_of, {"count": 5}, {"count": ("wavelengths",)}),
        "pupil.pupil_bounds": Door(_coarse(pupil.pupil_bounds), _PUPIL),
        "lens_map.lens_map_of": Door(_coarse(lens_map.lens_map_of), _LENS_MAP, {"millimetres": ("focus_distance",)}),
    }.items()
}

# After validation: helpers of kernels and methods, and records that come out.
INNER_MODULES = {
    "claims", "claims_cli", "stability", "stability_cli",
    "testing.compared", "testing.filter", "testing.metamorphic", "testing.picture", "testing.plugin",
    "testing.pointwise", "testing.properties", "testing.report", "testing.search", "testing.shrink",
    "cli", "command_group", "comparison", "explain", "explain_cli", "field_strip", "report", "metrics.flip_worker",
    "optics.lens_maps", "optics.lens_shape", "optics.aperture_sampling", "optics.owen_sobol", "optics.poisson_disc",
    "optics.projection", "optics.expressive_map", "optics.ray_map",
    "focus.aperture_spline", "focus.fading", "focus.focus_file", "focus.keys", "focus.moving_least_squares",
    "focus_cli", "frame_cli", "machine", "sweep", "sweep_cli", "compare_cli", "listing_cli", "main_cli", "lens_cli",
    "optics.systems.data_sheet", "optics.systems.field", "optics.systems.height_field",
    "optics.systems.lens_toml", "optics.systems.pbrt_file", "optics.systems.rows", "optics.systems.zemax_file",
    "image.arrays", "image.atomic", "image.channel_choice", "image.exr", "image.radiance",
    "export", "options", "settings", "shot", "progress", "typed", "warm", "oracle", "oracle_cli",
    "scene.builtin", "scene.beside", "scene.formats", "launch",
    "raster.materials.cutouts", "raster.materials.texel", "raster.rays.ray_filters",
    "frame.samples", "score",
    "scene.animation", "scene.gltf", "scene.kit", "scene.lens_chart", "scene.smooth_normals",
    "scene.framing",
    "raster.rays.gbuffer", "raster.rays.layer_color", "raster.rays.exact_layers", "raster.rays.embree",
    "raster.rays.shading", "raster.rays.surfaces",
    "raster.gpu.tile_bins", "raster.gpu.tile_drawing", "raster.gpu.clip", "raster.gpu.depth_format",
    "raster.gpu.texture_sampling", "raster.gpu.texture_reads", "image.bilinear", "image.channels",
    "raster.filters.downsample", "raster.filters.n_buffer_levels", "raster.filters.median", "raster.filters.resize",
    "raster.filters.tiles",
    "cluster.by_dask", "cluster.build", "cluster.completed", "truth.tile_tasks",
    "truth.error_bar", "truth.lens_rays", "truth.emitters", "truth.tile_sampler",
    "methods.circular.coefficients", "methods.circular.passes", "methods.filament.gather", "methods.filament.half",
    "methods.filament.alike", "methods.filament.background", "methods.filament.combine", "methods.filament.foreground",
    "methods.filament.lanes", "methods.filament.rings",
    "methods.halfres.circles", "methods.halfres.gather", "methods.ringgather.gather",
    "methods.ringgather.prefilter", "methods.ringgather.taken", "methods.ringgather.upsample",
    "methods.cascaded.blend", "methods.cascaded.gaussian", "methods.cascaded.layers", "methods.cascaded.fast_blurs",
    "methods.lensblur.footprint", "methods.lensblur.layer_trace", "methods.lensblur.texel_walk",
    "methods.lensblur.tile_color", "methods.lensblur.tile_rays", "methods.lensblur.tile_walk",
    "methods.mipmap.anisotropic", "methods.mipmap.upsample",
    "methods.multiview.cones", "methods.multiview.decomposition", "methods.multiview.fields",
    "methods.multiview.first_hits", "methods.multiview.gather", "methods.multiview.height_field",
    "methods.multiview.ambiguous_rays",
    "methods.poisson.coding", "methods.poisson.gather",
    "methods.pyramidal.pyramid",
    "methods.scatter.disc",
    "methods.singlepass.planar", "methods.singlepass.trace", "methods.singlepass.walk",
}  # fmt: skip
INNER = {
    "refdof.truth.reference.samples_taken",
    "refdof.testing.promises.chosen",
    "refdof.methods.halfres.params.points",
    "refdof.methods.ringgather.params.points",
    "refdof.methods.ringgather.params.from_working",
    "refdof.methods.ringgather.params.to_working",
    "refdof.frame.depth_kinds.planar_of",
    "refdof.frame.depth_kinds.ray_lengths",
    "refdof.frame.frame.FrameView",
    "refdof.compare.as_settings",
    "refdof.compare.check_window",
    "refdof.compare.distinct",
    "refdof.compare.kept_reference",
    "refdof.compare.rows_of",
    "refdof.compare.timed",
    "refdof.compare.warm_up",
    "refdof.compare.warming_up",
    "refdof.image.display.levels",
    "refdof.metrics.perceptual.flip_here",
    "refdof.metrics.perceptual.flip_processes",
    "refdof.metrics.Scored",
    "refdof.metrics.scored_of_many",
    "refdof.metrics.scores_of_many",
    "refdof.kernel_shape.KernelShape",
    "refdof.kernel_shape.kept_kernel_shapes",
    "refdof.motion.blurred_in_all",
    "refdof.motion.small_size",
    "refdof.motion.with_motion",
    "refdof.metrics.artefacts.Artefact",
    "refdof.metrics.artefacts.artefacts_of_many",
    "refdof.metrics.artefacts.excess.boundary_step",
    "refdof.metrics.artefacts.excess.circle_range",
    "refdof.metrics.artefacts.excess.leakage",
    "refdof.metrics.artefacts.excess.neighbour_range",
    "refdof.metrics.artefacts.excess.ringing",
    "refdof.metrics.artefacts.lamps.Lamp",
    "refdof.metrics.artefacts.lamps.bokeh",
    "refdof.metrics.artefacts.lamps.lamps",
    "refdof.metrics.artefacts.maps.Edges",
    "refdof.metrics.artefacts.moments.Moments",
    "refdof.metrics.artefacts.moments.disc_radius",
    "refdof.metrics.artefacts.reach.within",
    "refdof.metrics.artefacts.regions.region_rmse",
    "refdof.scene.limits.Meter",
    "refdof.scene.material.as_colors",
    "refdof.scene.material.as_opacity",
    "refdof.image.display.encode",
    "refdof.image.file.read_color",
    "refdof.image.file.read_numbers",
    "refdof.image.display.encode_one",
    "refdof.truth.forecast.Forecast",
    "refdof.optics.pixel_samples.LensPointSets",
    "refdof.optics.pixel_samples.mean_nearest_distance",
    "refdof.methods.cascaded.method.layering_of",
    "refdof.methods.poisson.ties.bounds_of_coded",
    "refdof.methods.singlepass.ties.Start",
    "refdof.methods.singlepass.ties.bounds_from",
    "refdof.methods.multiview.method.cone_width",
    "refdof.methods.poisson.method.coded_and_small",
    "refdof.metrics.Metric",
    "refdof.image.noise_floor.floor_of_moments",
    "refdof.image.noise_floor.noise_moments",
    "refdof.raster.gpu.ambiguity.tied_depths",
    "refdof.methods.cascaded.matting.matte",
    "refdof.raster.filters.n_buffer.Extremes",
    "refdof.raster.filters.n_buffer.NBuffer",
    "refdof.raster.filters.n_buffer.highest_in",
    "refdof.raster.filters.n_buffer.lowest_in",
    "refdof.raster.gpu.texture.as_texture",
    "refdof.raster.gpu.texture.at_texels",
    "refdof.raster.gpu.rasterize.Raster",
    "refdof.raster.rays.umbra.reach_beyond",
    "refdof.truth.reference.Reference",
    "refdof.truth.reference.as_most",
    "refdof.truth.reference.as_seed",
    "refdof.rendering.Result",
    "refdof.stages.Bounds",
    "refdof.stages.Stage",
    "refdof.stages.StageRecorder",
    "refdof.stages.Staged",
    "refdof.stages.as_stages",
    "refdof.view.Booking",
    "refdof.view.Pinhole",
    "refdof.optics.lens_samples.square_points",
    "refdof.view.Triangles",
    "refdof.view.View.booking",
    "refdof.view.View.product",
    "refdof.optics.expressive_lens.ExpressiveLens.as_thin",
    "refdof.optics.expressive_lens.ExpressiveLens.largest_circle_px",
    "refdof.optics.expressive_lens.ExpressiveLens.map_of",
    "refdof.optics.lens.ThinLens.as_thin",
    "refdof.optics.expressive_lens.over_picture",
    "refdof.focus.point.Placed",
    "refdof.focus.point.placed",
    "refdof.focus.focal_plane.FocalPlane",
    "refdof.focus.focal_plane.FocalPlane.inverse_focus",
    "refdof.focus.focal_plane.FocalPlane.image_plane",
    "refdof.focus.focal_plane.focal_plane",
    "refdof.optics.lens.ThinLens.largest_circle_px",
    "refdof.optics.lens.rounded",
}
INNER |= {
    f"refdof.optics.systems.{word}"
    for word in (
        "trace.SurfaceTable", "trace.Traced", "trace.table_of", "trace.trace_ray", "trace.traced",
        "trace.refract_all", "trace.part_of", "pupil.light_through", "pupil.PupilBounds",
        "paraxial.CardinalPoints", "paraxial.Pupil",
        "pupil.bounds_at", "pupil.joined_boxes", "lens_map.LensMap", "lens_map.lens_map_block",
        "lens_map.new_scratch", "lens_map.borrow_lens_map", "system_lens.SystemLens.map_of",
        "lens_map.lens_map_ray", "lens_map.lens_map_rays", "spectrum.add_wave", "spectrum.channel_weights",
    )
}  # fmt: skip
INNER |= {
    "refdof.methods.cascaded.method.buffers_of",
    *(f"refdof.methods.lensblur.method.{word}" for word in ("Prepared", "prepare", "trace")),
    *(f"refdof.methods.multiview.method.{word}" for word in ("Prepared", "prepare", "send_rays")),
}
INNER |= {  # their input is checked in tests/studio: it comes from a page
    f"refdof.studio{word}"
    for word in (
        ".command.command_of", ".desk.Desk", ".folder.Folder", ".notebook.StudioWidget", ".overlays.Legend",
        ".overlays.draw_overlay", ".overlays.error_map", ".page.page_file", ".page.view_module", ".pictures.Picture",
        ".pictures.Pictures", ".pictures.settings_of_method", ".server.application", ".server.serve",
        ".session.Session", ".state.LensSetting", ".state.State", ".state.parse_state", ".state.point_as_json",
        ".state.state_as_json", ".widget", "_cli.add_studio",
    )
}  # fmt: skip
INNER |= {f"{module.render.__module__}.{word}" for module in METHODS.values() for word in ("render", "texture_reads")}

SCALARS = [
    None, "no", "", "no\nno", b"no", NAN, INF, -INF, -1, 0, 1e300, -1e300, 1e-300, 20.5, True, 1j, 10**400, -(10**400),
    np.complex64(1), np.datetime64("2020-01-01"), np.array(2.0), np.array([2.0]), np.float32(NAN), np.uint8(200),
]  # fmt: skip
THINGS = [
    [], (), {}, {"no": 1}, [1.0, 2.0], (1e300, 0.0, 0.0), (NAN, 0.0, 0.0), (-1, 0.0, 0.0), (0.0, 0.0, 0.0), "abc",
    ["no"], [[1.0], [1.0, 2.0]], [None, 1.0, 2.0], (10**400, 0, 0), object(), len, float, range(3),
    np.zeros((2, 2)), np.zeros(0), np.zeros((0, 3)), np.array([None, None, None]), np.array([1j, 0, 0]),
    np.array(["no", "1", "2"]),
    np.zeros((2, 2, 3), dtype=np.uint8), np.full((3, 2, 3), NAN), CAMERA, LENS, SCENE, MATERIAL, EXACT, {1, 2},
]  # fmt: skip


def variants(base: Any) -> list[Any]:
    """Arrays that almost fit: other values, types, shapes and layouts than the valid one."""
    if not isinstance(base, np.ndarray):
        return []
    out = [base.tolist(), np.asfortranarray(base), base[:0], base[:1], base[..., :1], base[None], base.T, base[::-1]]
    for kind in (np.uint8, np.uint16, np.int64, np.bool_, np.float16, np.float32, np.float64, np.longdouble, ">f4",
                 np.complex128, object, "U8"):  # fmt: skip
        with np.errstate(all="ignore"):
            out.append(np.nan_to_num(base).astype(kind) if base.dtype.kind == "f" else base.astype(kind))
    if base.size:
        for value in (NAN, INF, -INF, -1.0, 0.0, 1e-300, 1e300, -1e300, 3e38, 1e39, 1e25, -1e25, 2.0**31, 2.0**63):
            for kind in (np.float32, np.float64):
                with np.errstate(all="ignore"):
                    bad = base.astype(kind)
                    bad[(0,) * bad.ndim] = value
                    out += [bad, np.full_like(bad, value)]
        whole = base.astype(np.int64) if base.dtype.kind in "iu" else None
        for index in (-1, -(2**63), 2**31, 2**62, 99) if whole is not None else ():
            bad = whole.copy()
            bad[(0,) * bad.ndim] = index
            out.append(bad)
    return out


def public_names() -> dict[str, Any]:
    """Functions, classes and methods in `__all__` of every module but `INNER_MODULES`, by dotted name."""
    found = {}
    for info in pkgutil.walk_packages(refdof.__path__, "refdof."):
        if info.name.startswith("refdof.explain."):
            continue
        short = info.name.removeprefix("refdof.")
        if any(part.startswith("_") for part in info.name.split(".")) or short in INNER_MODULES:
            continue
        rooms = (
            "scene.builtin",
            "scene.formats",
            "scene.gltf",
            "scene.kit",
            "claims",
            "stability",
            "report",
            "sweep",
            "oracle",
            "data",
        )
        if short == "data" or short.startswith(tuple(f"{room}." for room in rooms)):
            continue
        module = importlib.import_module(info.name)
        for name in getattr(module, "__all__", ()):
            thing = getattr(module, name)
            if not callable(thing) or not getattr(thing, "__module__", info.name).startswith("refdof"):
                continue
            if thing.__module__ != info.name:  # stands in another module's table
                continue
            found[f"{info.name}.{name}"] = thing
            if inspect.isclass(thing) and f"{info.name}.{name}" in DOORS:
                for word, member in vars(thing).items():
                    function = getattr(member, "__func__", member)
                    if not word.startswith("_") and inspect.isfunction(function) and arguments_of(function):
                        found[f"{info.name}.{name}.{word}"] = function
    return found


def arguments_of(thing: Any) -> set[str]:
    """The names of a function's arguments, without `self`, `cls` and free words."""
    signature = inspect.signature(thing).parameters.values()
    return {p.name for p in signature if p.kind is not p.VAR_KEYWORD} - {"self", "cls"}


__all__ = [
    "DOORS", "INNER", "SCALARS", "THINGS", "Door", "StageRecorder", "arguments_of", "public_names", "replace",
    "variants",
]  # fmt: skip
