"""Files of a frame: colour, depth and circles of confusion, flat or deep, as other programs write them."""

import os

import numpy as np

from refdof._check import Float, InputError, as_image, as_path
from refdof.frame.depth_kinds import planar_depth, planar_of, ray_lengths
from refdof.frame.frame import Frame, frame_camera
from refdof.frame.samples import flat_samples, surfaces_of_samples
from refdof.image.channel_choice import Layers, color_of, depth_of, sample_layer, split_layer
from refdof.image.exr import is_deep, read_layers
from refdof.image.file import read_color, read_numbers
from refdof.optics.lens import ThinLens
from refdof.raster.rays.exact_layers import Layers as Surfaces

__all__ = ["load_frame"]


def load_frame(
    color: str | os.PathLike[str],
    depth: str | os.PathLike[str] | None = None,
    fov_y: float = 40.0,
    lens: ThinLens | None = None,
    coc: str | os.PathLike[str] | None = None,
    depth_kind: str = "planar",
    near: float | None = None,
    far: float | None = None,
) -> Frame:
    """Read a frame.

    Parameters
    ----------
    color : path
        .exr, .png, .hdr or .npy; "FILE.exr:LAYER" says which layer, where several are plausible. A deep .exr has all
        surfaces of every pixel.
    depth : path, optional
        .exr or .npy; None: in the file of the colour.
    fov_y : float
        Vertical field of view [degrees].
    lens : ThinLens, optional
    coc : path, optional
        Signed circles of confusion, radii [px], negative in front of the focal plane, .exr or .npy; instead of a lens.
    depth_kind, near, far
        What the depths are, see `refdof.frame.depth_kinds`.

    Raises
    ------
    InputError
        If a file cannot be read, sizes differ, a channel is missing or not the only one, or a value is not allowed.
    """
    path, layer = split_layer(str(as_path("color", color)))
    layers = read_layers("color", path) if path.lower().endswith(".exr") else None
    surfaces = None
    if layers is not None and any(is_deep(channel) for channels in layers.values() for channel in channels.values()):
        for name, given in (("depth", depth), ("color", layer)):
            if given is not None:
                raise InputError(f"{name}: got {str(given)!r} with a deep file; allowed is none, it has its own")
        surfaces, pixels = _surfaces(path, layers, fov_y, depth_kind, near, far)
        planar = surfaces.depth[0]
        camera = frame_camera(fov_y, (pixels.shape[1], pixels.shape[0]))
    else:
        pixels = read_color("color", path) if layers is None else color_of("color", path, layers, layer)
        pixels = as_image("color", pixels, dtype=np.float32)
        camera = frame_camera(fov_y, (pixels.shape[1], pixels.shape[0]))
        planar = planar_depth(_stored_depth(path, layers, depth), depth_kind, camera, near, far)
    circles = None if coc is None else read_numbers("coc", coc, by_name=False)
    name = os.path.splitext(os.path.basename(path))[0]
    return Frame(pixels, planar, camera, lens, circles, surfaces, name=name)


def _stored_depth(path: str, layers: Layers | None, depth: str | os.PathLike[str] | None) -> np.ndarray:
    if depth is not None:
        return read_numbers("depth", depth)
    if layers is None:
        raise InputError(f"depth: got none, and {path!r} holds none; allowed is an .exr or .npy file")
    return depth_of("depth", path, layers)


def _surfaces(
    path: str, layers: Layers, fov_y: float, kind: str, near: float | None, far: float | None
) -> tuple[Surfaces, Float]:
    color, depth, opacity = sample_layer("color", path, layers)
    height, width = depth.shape
    camera = frame_camera(fov_y, (width, height))
    samples = flat_samples(color, depth, opacity)
    lengths: Float = ray_lengths(camera).reshape(-1)[samples.pixel]
    planar = planar_of(samples.depth, kind, lengths, near, far)
    return surfaces_of_samples(samples._replace(depth=planar), camera.size)
