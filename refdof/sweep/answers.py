"""Answers: what a sweep tells of a budget, of a quality, and of sizes that it did not measure.

1. the cost of each method                                       `models_of`
2. the point that answers a budget or a quality, in a sentence   `answers_of`
3. what such points, or the slowest, take at other sizes         `predictions_of`
"""

from collections.abc import Iterable, Sequence
from typing import Any

from refdof.sweep.cost import CostModel, fitted, lack
from refdof.sweep.front import fastest, nearest
from refdof.sweep.measured import Measured
from refdof.sweep.words import budget_answer, by_shot, quality_answer, setting, time_in_words

__all__ = ["answers_of", "in_words", "models_of", "predictions_of"]


def models_of(points: Sequence[Measured]) -> list[CostModel]:
    """The cost of each method where enough was varied."""
    return [model for model in map(fitted, _by_method(points).values()) if model is not None]


def answers_of(points: Sequence[Measured], budget: float | None, quality: float | None) -> list[dict[str, Any]]:
    """The answer for each shot to a budget [s] and to a quality [dB], where they are given."""
    found = []
    for name, own in by_shot(points).items():
        if budget is not None:
            found.append({"shot": name, "budget_s": budget, "words": budget_answer(own, budget)})
        if quality is not None:
            found.append({"shot": name, "quality_db": quality, "words": quality_answer(own, quality)})
    return found


def predictions_of(
    points: Sequence[Measured], sizes: Sequence[tuple[int, int]], budget: float | None, quality: float | None
) -> tuple[list[dict[str, Any]], list[str]]:
    """What is predicted at other sizes, and why nothing is of some methods, a line each.

    It is of the settings that answer the budget and the quality; without either, of each method's slowest.
    """
    if not sizes:
        return [], []
    asked = _asked(points, budget, quality)
    by_method = {name: own for name, own in _by_method(points).items() if any(one.method == name for one in asked)}
    models = {name: fitted(own) for name, own in by_method.items()}
    told = [
        _prediction(model, point, size)
        for point in asked
        if (model := models[point.method]) is not None
        for size in sizes
    ]
    lacks = [f"{name}: nothing is predicted; {lack(own)}" for name, own in by_method.items() if models[name] is None]
    return told, lacks


def in_words(predicted: dict[str, Any]) -> str:
    """A prediction as a line."""
    what = f"{predicted['method']} with {predicted['setting']} on {predicted['scene']}"
    return f"{what} at {predicted['size']}: {time_in_words(predicted['seconds'])} predicted"


def _by_method(points: Iterable[Measured]) -> dict[str, list[Measured]]:
    found: dict[str, list[Measured]] = {}
    for point in points:
        found.setdefault(point.method, []).append(point)
    return found


def _asked(points: Sequence[Measured], budget: float | None, quality: float | None) -> list[Measured]:
    """Points to predict, each setting once."""
    if budget is None and quality is None:
        return [max(own, key=lambda point: point.time_s) for own in _by_method(points).values()]
    found = []
    for own in by_shot(points).values():
        if budget is not None:
            found.append(nearest(own, budget) or min(own, key=lambda point: point.time_s))
        if quality is not None:
            found.append(fastest(own, quality) or max(own, key=lambda point: point.scores["psnr"]))
    return list({(one.method, one.scene, setting(one), one.lens_radius, one.focus): one for one in found}.values())


def _prediction(model: CostModel, point: Measured, size: tuple[int, int]) -> dict[str, Any]:
    """What a point takes at another size, its circles growing with the rows."""
    seconds = model.predict(point, size[0] * size[1], point.mean_coc_px * size[1] / point.height)
    return {
        "method": model.method,
        "scene": point.scene,
        "setting": setting(point),
        "size": f"{size[0]}x{size[1]}",
        "seconds": seconds,
    }
