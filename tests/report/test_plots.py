"""The plot of errors over times: ticks that can be read, and names that are their own points'."""

import itertools
from dataclasses import replace

import numpy as np
import pytest

from refdof.report.log_ticks import ticks_between
from refdof.report.plots import _MARKER, _figure
from tests.fake_comparison import comparison

pytestmark = pytest.mark.fast


def figure(points):
    """The plot of some points (seconds, error), each with a name as long as those of methods."""
    given = comparison(methods=[f"{k}-singlepass"[: 5 + k % 8] for k in range(len(points))])
    rows = [
        replace(row, blur_s=seconds, scores={"rmse": error})
        for row, (seconds, error) in zip(given.rows, points, strict=True)
    ]
    drawn = _figure(replace(given, rows=tuple(rows)))
    drawn.draw_without_rendering()
    return drawn


def shown(labels):
    return [label.get_window_extent() for label in labels if label.get_text() and label.get_visible()]


def overlaps(boxes):
    return [pair for pair in itertools.combinations(boxes, 2) if pair[0].overlaps(pair[1])]


CLOSE = [(0.010, 0.02), (0.0102, 0.0201), (0.0104, 0.0199), (0.011, 0.0202), (0.03, 0.05), (0.0101, 0.0205)]


def crowd(seed, spread):
    random = np.random.default_rng(seed)
    return [tuple(pair) for pair in np.exp(random.normal(np.log([0.02, 0.03]), spread, (15, 2)))]


@pytest.mark.parametrize("span", [1.0, 1.02, 1.3, 2.0, 4.0, 9.0, 20.0, 31.0, 100.0, 1e3, 1e5, 1e7])
def test_names_of_ticks_do_not_overlap(span):
    for first in (2e-5, 0.0011, 0.07, 0.9, 13.0):
        drawn = figure([(first, 0.031), (first * span, 0.031 * span**0.4)])
        (axes,) = drawn.axes
        for axis in (axes.xaxis, axes.yaxis):
            low, high = sorted(axis.get_view_interval())
            labels = [
                tick.label1
                for tick in (*axis.get_major_ticks(), *axis.get_minor_ticks())
                if low <= tick.get_loc() <= high
            ]
            assert len({label.get_text() for label in labels}) == len(shown(labels)) in range(2, 7), (axis, first)
            assert not overlaps(shown(labels)), [label.get_text() for label in labels]
        words = [label.get_text() for label in axes.get_xticklabels()]
        assert all(word.endswith((" s", " ms", " us")) for word in words)


def test_ticks_are_round():
    assert ticks_between(0.012, 0.9) == pytest.approx([0.02, 0.05, 0.1, 0.2, 0.5])
    assert ticks_between(0.009, 0.05) == pytest.approx([0.01, 0.015, 0.02, 0.03, 0.05])
    assert ticks_between(1e-5, 150.0) == pytest.approx([1e-5, 1e-3, 0.1, 10.0])
    assert ticks_between(0.1002, 0.1036) == pytest.approx([0.101, 0.102, 0.103])


@pytest.mark.parametrize("points", [CLOSE, crowd(1, 0.1), crowd(2, 0.3), crowd(3, 1.0), [(0.01, 0.02)] * 4])
def test_a_name_is_nearest_to_its_own_point_or_has_a_line_to_it(points):
    drawn = figure(points)
    (axes,) = drawn.axes
    places = axes.transData.transform(sorted(points))
    lined = {tuple(text.xy): text for text in axes.texts if not text.get_text()}
    names = [text for text in axes.texts if text.get_text()]
    assert len(names) == len(points)
    boxes = [text.get_window_extent() for text in names]
    for text, box in zip(names, boxes, strict=True):
        if tuple(text.xy) in lined:
            continue
        own = axes.transData.transform(text.xy)
        distances = np.hypot(*(places - np.clip(places, box.min, box.max)).T)
        others = distances[np.any(places != own, axis=1)]
        assert distances.min() < others.min(initial=np.inf), text.get_text()
        assert distances.min() < 12.0  # beside it [px]
    assert not overlaps(boxes)
    half = 0.5 * _MARKER * drawn.dpi / 72.0
    for box in boxes:
        covered = np.all((places > box.min - half) & (places < box.max + half), axis=1)
        assert not covered.any()
