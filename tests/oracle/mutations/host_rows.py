"""Wrong hosts of the GLSL port: textures, uniforms, what is read back and what is written."""

from tests.oracle.mutations.row import Row

__all__ = ["ROWS"]

_COLOR = "texture_of(context, color, linear=True)"
_DEPTH = "texture_of(context, stored, linear=False)"
_IMAGE = "image = texels[..., :3]"
_NEAR = 'float(numbers["near"])'
_STORED = "stored = depth / far"
_WRITTEN = 'image.astype("<f4").tofile(out / "image.f32")'
_ASLANT = "np.hypot(1.0, np.hypot(*(np.indices(depth.shape)[axis] / width - 0.5 for axis in (0, 1))))"

_ROWS = (
    # Textures and uniforms
    ("colour at the nearest texel", "taps", "color_filter",
     _COLOR, "texture_of(context, color, linear=False)"),
    ("depth blends between texels", "taps", "depth_filter",
     _DEPTH, "texture_of(context, stored, linear=True)"),
    ("colour wraps", "taps", "border",
     "repeat_x = False", "repeat_x = True"),
    ("rows of depth are flipped", "coc", "depth_flipped",
     _DEPTH, "texture_of(context, stored[::-1], linear=False)"),
    ("rows of colour are flipped", "image", "flipped or depth_flipped",
     _COLOR, "texture_of(context, color[::-1], linear=True)"),
    ("colour is decoded from sRGB", "image", "gamma",
     _COLOR, "texture_of(context, color**2.2, linear=True)"),
    ("depth has 8 bits", "coc", "depth_quantized",
     _STORED, "stored = np.round(depth / far * 255.0) / 255.0"),
    ("a z-buffer is taken as linear", "coc", "depth_device",
     _STORED, f"stored = (1.0 - {_NEAR} / depth) / (1.0 - {_NEAR} / far)"),
    ("a reversed z-buffer is taken as linear", "coc", "depth_reversed or depth_device",
     _STORED, f"stored = {_NEAR} / depth"),
    ("depth is the distance from the eye", "coc", "depth_radial",
     _STORED, f"stored = depth / far * {_ASLANT}"),
    ("no depth is bound", "coc", "depth_constant",
     _STORED, "stored = np.ones_like(depth)"),
    ("depth is scaled by another far plane", "coc", "depth_scale",
     '"uFar": far,', '"uFar": 2.0 * far,'),
    ("the focus is 5 % off", "coc", "focus",
     '"focusPoint": focus,', '"focusPoint": 1.05 * focus,'),
    ("the focus is measured from the near plane", "coc", "focus_from_near or focus",
     '"focusPoint": focus,', f'"focusPoint": focus - 0.5 * {_NEAR},'),
    ("focusScale is in pixels", "coc", "coc_scale",
     '"focusScale": scale / blur_size,', '"focusScale": scale,'),
    ("circles are of another resolution", "coc", "coc_scale",
     '"focusScale": scale / blur_size,', '"focusScale": scale / blur_size * 240.0 / 1080.0,'),
    ("the pixel size has width and height swapped", "taps", "pixel_size",
     "(1.0 / width, 1.0 / height)", "(1.0 / height, 1.0 / width)"),
    # What is read back
    ("the picture is upside down", "image", "flipped",
     _IMAGE, "image = texels[::-1, :, :3]"),
    ("the picture is mirrored", "image", "flipped",
     _IMAGE, "image = texels[:, ::-1, :3]"),
    ("blue, green, red", "image", "channels",
     _IMAGE, "image = texels[..., 2::-1]"),
    ("red goes to all channels", "image", "channels",
     _IMAGE, "image = texels[..., [0, 0, 0]]"),
    ("one row up", "image", "image_shift",
     _IMAGE, "image = np.roll(texels, -1, axis=0)[..., :3]"),
    ("one column to the right", "image", "image_shift",
     _IMAGE, "image = np.roll(texels, 1, axis=1)[..., :3]"),
    ("half the resolution", "image", "half_resolution",
     _IMAGE, "image = texels[::2, ::2, :3].repeat(2, axis=0).repeat(2, axis=1)[:height, :width]"),
    ("the last odd row and column are not drawn", "image", "unexplained",
     _IMAGE, "image = np.pad(texels[: height & ~1, : width & ~1, :3], ((0, height & 1), (0, width & 1), (0, 0)))"),
    ("rows are padded, which is passed over", "image", "unexplained",
     _IMAGE, "texels = np.pad(texels, ((0, 0), (0, -width % 16), (0, 0))); "
     "image = texels.ravel()[: 4 * height * width].reshape(height, width, 4)[..., :3]"),
    ("a target of half floats", "image", "quantized",
     _IMAGE, 'image = texels[..., :3].astype("f2")'),
    ("a target of 8 bits", "image", "quantized",
     _IMAGE, "image = np.round(np.clip(texels[..., :3], 0.0, 1.0) * 255.0) / 255.0"),
    ("the picture is encoded as sRGB", "image", "gamma",
     _IMAGE, "image = np.maximum(texels[..., :3], 0.0) ** (1.0 / 2.2)"),
    ("half a per cent brighter", "image", "gain",
     _IMAGE, "image = texels[..., :3] * 1.005"),
    ("a veil", "image", "offset",
     _IMAGE, "image = texels[..., :3] + 0.002"),
    ("one pixel is NaN", "image", "not_finite",
     _IMAGE, "image = np.where(np.arange(texels.size).reshape(texels.shape) == 0, np.nan, texels)[..., :3]"),
    ("all is NaN", "image", "not_finite",
     _IMAGE, "image = np.full_like(texels, np.nan)[..., :3]"),
    ("all is infinite", "image", "not_finite",
     _IMAGE, "image = np.full_like(texels, np.inf)[..., :3]"),
    ("read back before it was drawn", "image", "constant",
     _IMAGE, "image = np.zeros_like(texels)[..., :3]"),
    ("read back one picture late", "image", "other_case",
     "_frames[texels.shape][-1]", "_frames[texels.shape][-2:][0]"),
    # What is written
    ("channels are written as planes", "image", "unexplained",
     _WRITTEN, 'image.transpose(2, 0, 1).astype("<f4").tofile(out / "image.f32")'),
    ("columns are written as rows", "image", "unexplained",
     _WRITTEN, 'image.transpose(1, 0, 2).astype("<f4").tofile(out / "image.f32")'),
    ("big-endian numbers", "image", "unexplained",
     _WRITTEN, 'image.astype(">f4").tofile(out / "image.f32")'),
    ("double precision", "", "error",
     _WRITTEN, 'image.astype("<f8").tofile(out / "image.f32")'),
    ("alpha is written too", "", "error",
     _IMAGE, "image = texels"),
    ("nothing is written", "", "error",
     _WRITTEN, "pass"),
    ("an empty file", "", "error",
     _WRITTEN, '(out / "image.f32").touch()'),
    ("another name", "", "error",
     _WRITTEN, 'image.astype("<f4").tofile(out / "result.f32")'),
)  # fmt: skip

ROWS = tuple(Row("host", *row) for row in _ROWS)
