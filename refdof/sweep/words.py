"""Words: the results of a sweep as tables and sentences for people."""

import math
from collections.abc import Sequence

from refdof.report.table import aligned
from refdof.sweep.cost import CostModel
from refdof.sweep.front import fastest, front, nearest
from refdof.sweep.measured import Measured

__all__ = ["budget_answer", "by_shot", "front_table", "quality_answer", "shot_name", "time_in_words"]


def by_shot(points: Sequence[Measured]) -> dict[str, list[Measured]]:
    """The points of each shot, by its name."""
    found: dict[str, list[Measured]] = {}
    for point in points:
        found.setdefault(shot_name(point), []).append(point)
    return found


def shot_name(point: Measured) -> str:
    """The scene, the size, and what else of the shot was varied."""
    other = [f"{name}={value}" for name, value in point.varied.items() if name not in point.params and name != "size"]
    return ", ".join([point.scene, f"{point.width} x {point.height}", *other])


def setting(point: Measured) -> str:
    """What was varied of the method."""
    return " ".join(f"{name}={point.params[name]}" for name in point.varied if name in point.params) or "defaults"


def front_table(points: Sequence[Measured]) -> str:
    """The front of one shot, from fast to slow, in 80 characters."""
    head = ["method", "setting", "time", "PSNR [dB]", "FLIP", "memory", "note"]
    body = []
    for point in front(points):
        noisy = point.scores["psnr"] > point.quality
        body.append(
            [
                point.method,
                setting(point),
                time_in_words(point.time_s),
                f"{point.scores['psnr']:.2f}",
                f"{point.scores['flip']:.3f}",
                memory_in_words(point.peak_bytes),
                "noise floor" if noisy else "",
            ]
        )
    return aligned(head, body)


def quality_answer(points: Sequence[Measured], quality: float) -> str:
    """The fastest point of a shot with at least this PSNR [dB], in a sentence, and the command that renders it."""
    found, shot = fastest(points, quality), shot_name(points[0])
    floor = points[0].noise_floor_psnr
    if quality > floor:
        best = found or max(points, key=lambda point: point.scores["psnr"])
        above = f"{quality:g} dB lies above the reference's noise floor of {floor:.1f} dB"
        return f"{shot}: {above}: more --samples are needed; the best is {_told(best)}.\n    {best.command}"
    if found is None:
        best = max(points, key=lambda point: point.scores["psnr"])
        return f"{shot}: nothing has {quality:g} dB; the best is {_told(best)}.\n    {best.command}"
    return f"{shot}: the fastest with at least {quality:g} dB is {_told(found)}.\n    {found.command}"


def budget_answer(points: Sequence[Measured], budget: float) -> str:
    """The best point of a shot that takes at most so many seconds, in a sentence, and the command that renders it."""
    found, shot, limit = nearest(points, budget), shot_name(points[0]), time_in_words(budget)
    if found is None:
        quick = min(points, key=lambda point: point.time_s)
        return f"{shot}: nothing takes {limit} or less; the fastest is {_told(quick)}.\n    {quick.command}"
    return f"{shot}: the nearest to the reference in {limit} is {_told(found)}.\n    {found.command}"


def _told(point: Measured) -> str:
    return (
        f"{point.method} with {setting(point).replace(' ', ' and ')}: {point.scores['psnr']:.2f} dB "
        f"in {time_in_words(point.time_s)}"
    )


def cost_lines(models: Sequence[CostModel]) -> str:
    """How time grows, a line for each method."""
    return "\n".join(str(model) for model in models)


def time_in_words(seconds: float) -> str:
    """In ms below a second."""
    return f"{seconds:.2f} s" if seconds >= 1.0 else f"{1000.0 * seconds:.{1 if seconds < 0.1 else 0}f} ms"


def memory_in_words(size: float) -> str:
    """In MiB."""
    return "-" if math.isnan(size) else f"{size / 2**20:.1f} MiB"
