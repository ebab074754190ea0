"""PNG files of 16 bits a channel, which Pillow would round to 8.

1. chunks; what is unpacked is as long as the header says, or it is an error     `read_png16`
2. each row is stored as the difference from its neighbours                      `_unfilter`
3. interlaced files are seven pictures in one                                    `_PASSES`

References
----------
.. [1] W3C (2025), Portable Network Graphics (PNG) Specification, third edition: 7, 8 (interlacing), 9 (filters).
"""

import struct
import zlib

import numpy as np

from refdof._jit import tile_kernel

__all__ = ["depth_of_png", "read_png16", "refuse_lies"]

_SIGNATURE = b"\x89PNG\r\n\x1a\n"
_MOST_RATIO = 1032  # of bytes that deflate unpacks to one
_CHANNELS = {0: 1, 2: 3, 4: 2, 6: 4}  # by colour type: grey, RGB, grey and alpha, RGBA
# First column and row, and steps, of each pass, [1] 8.2.
_PASSES = ((0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2), (0, 1, 1, 2))


def depth_of_png(data: bytes) -> tuple[int, int, int] | None:
    """Width, height and bits a channel that a PNG file's header states; None of any other file."""
    if data[:8] != _SIGNATURE or data[12:16] != b"IHDR" or len(data) < 33:
        return None
    width, height, depth = struct.unpack(">IIB", data[16:25])
    return width, height, depth


def refuse_lies(data: bytes) -> None:
    """Raise a ValueError if a PNG file is too small for what its header says: it would be made up as zeros."""
    width, height, depth, kind = struct.unpack(">IIBB", data[16:26])
    needed = height * (width * _CHANNELS.get(kind, 1) * depth // 8)
    if needed > _MOST_RATIO * len(data):
        raise ValueError(f"it has {len(data)} bytes; its header says {width} x {height} pixels of {depth} bits")


def read_png16(data: bytes) -> np.ndarray:
    """(h, w, 3 or 4) uint16, as stored; what is no such file raises a ValueError."""
    width, height, depth, kind, _, _, interlaced = struct.unpack(">IIBBBBB", data[16:29])
    refuse_lies(data)
    if depth != 16 or kind not in _CHANNELS or interlaced > 1 or not width * height:
        raise ValueError(f"a PNG file of {depth} bits, kind {kind}; allowed are 16 bits of kinds 0, 2, 4, 6")
    channels = _CHANNELS[kind]
    passes = _PASSES if interlaced else ((0, 0, 1, 1),)
    sizes = [(max(0, -(-(height - y) // dy)), max(0, -(-(width - x) // dx))) for x, y, dx, dy in passes]
    needed = sum(h * (1 + 2 * channels * w) for h, w in sizes if w)
    packed, clear = _chunks(data)
    unpacked = zlib.decompressobj().decompress(packed, needed)
    if len(unpacked) < needed:
        raise ValueError(f"it has {len(unpacked)} bytes of pixels; its header says {needed}")
    out = np.zeros((height, width, channels), dtype=np.uint16)
    stored, start = np.frombuffer(unpacked, dtype=np.uint8), 0
    for (x, y, dx, dy), (h, w) in zip(passes, sizes, strict=True):
        if h and w:
            row = 1 + 2 * channels * w
            rows = stored[start : start + h * row].reshape(h, row).copy()
            start += h * row
            if (rows[:, 0] > 4).any():
                raise ValueError("a row has an unknown filter")
            _unfilter(rows, 2 * channels)
            out[y::dy, x::dx] = np.ascontiguousarray(rows[:, 1:]).view(">u2").reshape(h, w, channels)
    return _with_colors(out, clear, kind)


def _with_colors(out: np.ndarray, clear: bytes, kind: int) -> np.ndarray:
    """Grey becomes RGB; a colour that stands for nothing becomes opacity 0."""
    if len(clear) >= 2 * out.shape[2] and kind in (0, 2):
        key = np.frombuffer(clear[: 2 * out.shape[2]], dtype=">u2")
        opacity = np.where((out == key).all(axis=2), 0, 65535).astype(np.uint16)
        out = np.concatenate([out, opacity[:, :, None]], axis=2)
    return out if out.shape[2] > 2 else np.concatenate([np.repeat(out[:, :, :1], 3, axis=2), out[:, :, 1:]], axis=2)


def _chunks(data: bytes) -> tuple[bytes, bytes]:
    """The packed pixels, and the colour that stands for nothing."""
    packed, clear, at = [], b"", 8
    while at + 12 <= len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        name, body = data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        if name == b"IDAT":
            packed.append(body)
        elif name == b"tRNS":
            clear = body
        elif name == b"IEND":
            break
        at += 12 + length
    return b"".join(packed), clear


@tile_kernel
def _unfilter(rows, step):
    """Turn rows (h, 1 + bytes) uint8 of a filter's number and differences into bytes, in place, [1] 9.2."""
    height, width = rows.shape
    for y in range(height):
        kind = rows[y, 0]
        for x in range(1, width):
            left = np.int64(rows[y, x - step]) if x > step else np.int64(0)
            above = np.int64(rows[y - 1, x]) if y > 0 else np.int64(0)
            corner = np.int64(rows[y - 1, x - step]) if x > step and y > 0 else np.int64(0)
            guess = np.int64(0)
            if kind == 1:
                guess = left
            elif kind == 2:
                guess = above
            elif kind == 3:
                guess = (left + above) // 2
            elif kind == 4:
                # Paeth: of the three neighbours, the one nearest to left + above - corner.
                a, b, c = abs(above - corner), abs(left - corner), abs(left + above - 2 * corner)
                guess = left if a <= b and a <= c else (above if b <= c else corner)
            rows[y, x] = np.uint8((np.int64(rows[y, x]) + guess) & 255)
