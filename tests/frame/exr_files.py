"""EXR files as other programs write them, made with the OpenEXR package, which ignores strides: arrays are copied."""

import numpy as np
import OpenEXR


def write(path, channels, kind=OpenEXR.scanlineimage, **header):
    """One part; channels by their names."""
    plain = {name: _whole(values) for name, values in channels.items()}
    OpenEXR.File({"type": kind, "compression": OpenEXR.ZIPS_COMPRESSION, **header}, plain).write(str(path))


def write_parts(path, parts):
    """{part: {channel: values}}."""
    header = {"type": OpenEXR.scanlineimage, "compression": OpenEXR.ZIP_COMPRESSION}
    made = [
        OpenEXR.Part({**header, "name": name}, {key: _whole(values) for key, values in channels.items()})
        for name, channels in parts.items()
    ]
    OpenEXR.File(made).write(str(path))


def rgb(prefix, color):
    """R, G and B of a picture, named as of a layer."""
    return {f"{prefix}{letter}": color[..., k] for k, letter in enumerate("RGB")}


def write_blender(path, color, depth, letter="Z"):
    """As Blender does: one view layer, background 1e10, and passes that are no depth."""
    far = np.where(np.isinf(depth), 1e10, depth).astype(np.float32)
    mist = np.linspace(0, 1, far.size, dtype=np.float32).reshape(far.shape)
    combined = {**rgb("ViewLayer.Combined.", color), "ViewLayer.Combined.A": np.ones_like(far)}
    others = {"ViewLayer.Mist.Z": mist, "ViewLayer.Denoising Depth.Z": mist, **rgb("ViewLayer.DiffCol.", color + 1)}
    write(path, {**combined, f"ViewLayer.Depth.{letter}": far, **others})


def write_unreal(path, color, depth):
    """As its movie render queue does: plain R, G, B, A, and depth as a colour."""
    name = "FinalImageMovieRenderQueue_WorldDepth."
    depths = {f"{name}{letter}": depth.astype(np.float32) for letter in "RGBA"}
    velocity = rgb("FinalImageMovieRenderQueue_MotionVectors.", color * 2)
    write(path, {**rgb("", color), "A": np.ones(depth.shape, np.float32), **depths, **velocity})


def write_deep(path, pixels, letters="RGBAZ"):
    """pixels: rows of lists of samples, each a tuple by letters."""
    shape = len(pixels), len(pixels[0])
    channels = {letter: np.empty(shape, dtype=object) for letter in letters}
    for y, row in enumerate(pixels):
        for x, samples in enumerate(row):
            for k, letter in enumerate(letters):
                values = np.array([sample[k] for sample in samples], dtype=np.float32)
                channels[letter][y, x] = values if samples else None
    write(path, channels, OpenEXR.deepscanline)


def _whole(values):
    return values if values.dtype == object else np.ascontiguousarray(values)
