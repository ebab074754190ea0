"""A comparison whose every number is known, its page, and what a page can know of it: float16."""

from dataclasses import replace

import numpy as np

from refdof.comparison import Box
from refdof.report.page import report_page
from tests.fake_comparison import SCORES, comparison

WIDTH, HEIGHT = SIZE = 40, 30
METHODS = tuple(f"method {k}" for k in range(12))  # more than there are number keys
FIRST = 2  # images before the methods
CROPS = (Box(3, 5, 8, 6), Box(20, 10, 20, 20))
SPOILT = FIRST + 1  # the image that has these
NAN_AT, INF_AT = ((5, 7), (6, 7), (30, 20)), ((9, 7), (31, 2))  # x, y
COMMAND = "refdof compare fence --size 40x30 --set 'method 1.samples=9' --out results"


def half(values):
    return np.asarray(values).astype(np.float16).astype(np.float64)


def luminance(image):
    red, green, blue = np.moveaxis(half(image), -1, 0)
    return 0.2126 * red + 0.7152 * green + 0.0722 * blue


def signed(image, reference):
    return luminance(image) - luminance(reference)


def relative(image, reference):
    return signed(image, reference) / (np.abs(luminance(reference)) + 0.01)


def made():
    """Random pictures; depth, circles and counts of which no two neighbours are alike."""
    given = comparison(WIDTH, HEIGHT, methods=METHODS)
    random = np.random.default_rng(5)
    depth = random.uniform(1.0, 3e6, (HEIGHT, WIDTH))
    depth[random.random(depth.shape) < 0.1] = np.inf
    rows = [
        replace(row, flip_map=random.random(depth.shape).astype(np.float32), scores={**SCORES, "psnr": 30.0 - k})
        for k, row in enumerate(given.rows)
    ]
    for x, y in NAN_AT:
        rows[SPOILT - FIRST].image[y, x, 1] = np.nan
    for x, y in INF_AT:
        rows[SPOILT - FIRST].image[y, x] = np.inf
    return replace(
        given,
        standard_error=random.uniform(0.0, 0.1, given.reference.shape).astype(np.float32),
        rows=tuple(rows),
        depth=depth,
        coc_px=random.normal(0.0, 7.0, depth.shape),
        surface_counts=random.integers(0, 9, depth.shape),
        crops=CROPS,
    )


GIVEN = made()
PAGE = report_page(GIVEN, COMMAND)
IMAGES = [GIVEN.reference, GIVEN.pinhole, *(row.image for row in GIVEN.rows)]
