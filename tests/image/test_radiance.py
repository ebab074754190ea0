"""Radiance pictures: bytes by hand, run lengths, and another library where it is installed."""

import numpy as np
import pytest

from refdof import InputError
from refdof.image.file import load_image

pytestmark = pytest.mark.fast
HEAD = b"#?RADIANCE\n# made by hand\nFORMAT=32-bit_rle_rgbe\nEXPOSURE=1\n\n"


def write(path, width, height, body, head=HEAD):
    path.write_bytes(head + f"-Y {height} +X {width}\n".encode() + body)
    return path


def test_values_by_hand(tmp_path):
    # 2^(129 - 136) = 1 / 128 for each step of the mantissa; an exponent of 0 is black, whatever the mantissas.
    body = bytes([128, 64, 32, 129]) + bytes([128, 0, 255, 137]) + bytes([9, 9, 9, 0])
    image = load_image(write(tmp_path / "a.hdr", 3, 1, body))
    assert image.dtype == np.float32
    assert image[0].tolist() == [[1.0, 0.5, 0.25], [256.0, 0.0, 510.0], [0.0, 0.0, 0.0]]


def test_runs_and_rows_from_the_top(tmp_path):
    # Two rows of 8: red 1 .. 8 in one piece, then green as a run of 8, blue as 3 and 5, exponent 136: one is one.
    row = bytes([2, 2, 0, 8]) + bytes([8, *range(1, 9)]) + bytes([136, 7]) + bytes([131, 1, 133, 2]) + bytes([136, 136])
    second = row.replace(bytes([8, *range(1, 9)]), bytes([136, 50]))
    image = load_image(write(tmp_path / "a.hdr", 8, 2, row + second))
    assert image[0, :, 0].tolist() == list(range(1, 9))
    assert image[1, :, 0].tolist() == [50] * 8
    assert (image[:, :, 1] == 7).all()
    assert image[0, :, 2].tolist() == [1, 1, 1, 2, 2, 2, 2, 2]


def test_another_library_reads_the_same(tmp_path):
    cv2 = pytest.importorskip("cv2")
    picture = np.random.default_rng(4).uniform(0, 1, (13, 40, 3)).astype(np.float32) ** 8 * 1000
    picture[3:6] = 0.25
    assert cv2.imwrite(str(tmp_path / "a.hdr"), picture)
    again = cv2.imread(str(tmp_path / "a.hdr"), cv2.IMREAD_UNCHANGED)[..., ::-1]
    np.testing.assert_array_equal(load_image(tmp_path / "a.hdr"), again)


ROW = bytes([2, 2, 0, 8]) + bytes([136, 7]) * 4


@pytest.mark.parametrize(
    ("width", "height", "body", "head", "said"),
    [
        (8, 2, ROW, HEAD, "is damaged"),
        (8, 1, ROW[:-1], HEAD, "is damaged"),
        (8, 1, bytes([2, 2, 0, 8, 0, 0]), HEAD, "is damaged"),
        (8, 1, bytes([2, 2, 0, 8, 137, 7]), HEAD, "is damaged"),
        (2, 1, bytes([9, 9, 9, 9, 1, 1, 1, 3]), HEAD, "is damaged"),
        (0, 1, b"", HEAD, "0x1 pixels"),
        (99999, 99999, b"", HEAD, "99999x99999 pixels"),
        (8, 1, ROW, HEAD.replace(b"rgbe", b"xyze"), "another header"),
        (8, 1, ROW, b"P6\n", "another header"),
        (8, 1, b"", b"", "another header"),
    ],
)
def test_bad_files_are_named(tmp_path, width, height, body, head, said):
    with pytest.raises(InputError, match=f"path: .*a.hdr.* {said}"):
        load_image(write(tmp_path / "a.hdr", width, height, body, head))


def test_a_missing_file_is_named(tmp_path):
    with pytest.raises(InputError, match=r"path: got .*: there is no such file; allowed is a file"):
        load_image(tmp_path / "a.hdr")


def test_exposures_are_divided_out(tmp_path):
    body = bytes((128, 64, 32, 129))
    plain = load_image(write(tmp_path / "a.hdr", 1, 1, body))
    twice = HEAD.replace(b"FORMAT", b"EXPOSURE=2.0\nEXPOSURE= 4e-1\nFORMAT")
    np.testing.assert_allclose(load_image(write(tmp_path / "b.hdr", 1, 1, body, twice)), plain / 0.8, rtol=1e-6)
    with pytest.raises(InputError, match="says EXPOSURE=0; allowed are finite numbers above 0"):
        load_image(write(tmp_path / "c.hdr", 1, 1, body, HEAD.replace(b"FORMAT", b"EXPOSURE=0\nFORMAT")))
