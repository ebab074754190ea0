"""Preview: a small PNG for people, never compared. Not compressed, for packers differ in what they make of the same."""

import struct
import zlib

import numpy as np

from refdof._check import Float

__all__ = ["preview_of"]

_LONGEST = 48  # px


def preview_of(image: Float) -> bytes:
    """A PNG of every k-th pixel of a linear image (H, W, 3), the longer side at most 48 px, clipped to 0 .. 1.

    Encoded by a square root, which all processors round alike, and near enough to sRGB.
    """
    step = -(-max(image.shape[:2]) // _LONGEST)
    levels = np.floor(255.0 * np.sqrt(np.clip(image[::step, ::step].astype(np.float64), 0.0, 1.0)) + 0.5)
    rows = levels.astype(np.uint8)
    height, width = rows.shape[:2]
    plain = b"".join(b"\0" + row.tobytes() for row in rows)  # each row begins with its filter: none
    header = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    chunks = ((b"IHDR", header), (b"IDAT", _stored(plain)), (b"IEND", b""))
    return b"\x89PNG\r\n\x1a\n" + b"".join(_chunk(name, content) for name, content in chunks)


def _chunk(name: bytes, content: bytes) -> bytes:
    return struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(name + content))


def _stored(plain: bytes) -> bytes:
    """A zlib stream of one stored block: a preview has at most 48 (1 + 3 48) bytes, and one holds 65535."""
    size = len(plain)
    return b"\x78\x01\x01" + struct.pack("<HH", size, size ^ 0xFFFF) + plain + struct.pack(">I", zlib.adler32(plain))
