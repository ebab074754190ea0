"""Search: which changes of a right model give what a port gave.

1. Try every switch with every value on a few pixels            `_first_look`
2. Try the best ones on more pixels, and fit their numbers       `_best_values`, `_fitted`
3. Rank on many pixels; do it again on top of the best ones       `search`
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from refdof._check import Float
from refdof.oracle.diagnosis.causes import cause_of
from refdof.oracle.diagnosis.emulate import emulator
from refdof.oracle.diagnosis.model import Model
from refdof.oracle.diagnosis.samples import Samples, Shot, choose, samples_of
from refdof.oracle.diagnosis.switches import Switch
from refdof.oracle.diagnosis.wording import tell_something

__all__ = ["Found", "Step", "search"]

_BENCHES = (2, 40), (4, 120), (8, 480)  # pictures and pixels: for a first look, for fits, for the ranking
_LOOKED_AT = 24  # switches that pass the first look
_VALUES = 4  # of each switch, in further rounds
_FITTED = 5  # switches whose numbers are fitted, of each round
_BASES = 3  # what a next round begins with
_ROUNDS = 3  # changes at once
_CLOSE = 4.0  # tolerances: what is reproduced; pixels at ties are beyond
_EXACT = 0.96  # of pixels
_CUT = 1e6  # tolerances: NaN and more
_MARGIN = 0.03  # of a score: what a fitted number has to win
_GAIN = 0.15  # of a score: what a further change has to win


class Step(NamedTuple):
    """A switch and its value."""

    switch: Switch
    value: Any


@dataclass(frozen=True)
class Found:
    """Changes of a right model, and how well they give what the port gave.

    steps : the changes, first the one that explains most
    score : mean of log(1 + error in tolerances)
    exact : share of pixels that are reproduced
    explained : share of the error that is gone
    worst : the largest error that is left
    """

    steps: tuple[Step, ...]
    score: float
    exact: float
    explained: float
    worst: float

    @property
    def is_exact(self) -> bool:
        """Whether all but ties is reproduced."""
        return self.exact >= _EXACT


class _Bench:
    """The pixels, and what keeps the texels that models read."""

    def __init__(self, shots: Sequence[Shot], count: int) -> None:
        each = -(-count // len(shots))
        self.samples: list[Samples] = [samples_of(shot, *choose(shot.off, each)) for shot in shots]
        self._run: list[Callable[[Model], Float]] = [emulator(samples) for samples in self.samples]

    def errors(self, steps: tuple[Step, ...]) -> list[Float]:
        """|got - emulated| (P, 3) of each picture, in tolerances, at most `_CUT`; 0 where neither is a number."""
        found = []
        for samples, run in zip(self.samples, self._run, strict=True):
            model = samples.right
            for step in steps:
                model = step.switch.change(model, step.value)
            image = run(model)
            with np.errstate(invalid="ignore", over="ignore"):
                off = np.abs(samples.got - image) / samples.tolerance
            off = np.where(np.isfinite(samples.got) | np.isfinite(image), off, 0.0)
            found.append(np.minimum(np.nan_to_num(off, nan=_CUT, posinf=_CUT), _CUT))
        return found

    def score(self, steps: tuple[Step, ...]) -> float:
        """Mean of log(1 + error in tolerances), of each picture alike."""
        return float(np.mean([np.log1p(off).mean() for off in self.errors(steps)]))

    def found(self, steps: tuple[Step, ...]) -> Found:
        """How well the changes give what the port gave."""
        errors, before = self.errors(steps), self.errors(())
        close = np.concatenate([off.max(axis=1) <= _CLOSE for off in errors])
        rest, all_of_it = (sum(float(off.mean()) for off in part) for part in (errors, before))
        worst = max(float(off.max()) * samples.tolerance for off, samples in zip(errors, self.samples, strict=True))
        share = 1.0 - rest / all_of_it if all_of_it > 0.0 else 1.0
        return Found(steps, self.score(steps), float(close.mean()), share, worst)


def search(shots: Sequence[Shot], switches: Sequence[Switch]) -> list[Found]:
    """The changes that give best what a port gave, best first; one of them is none at all."""
    first, few, many = (_Bench(shots[:most], count) for most, count in _BENCHES)
    ranked = bases = [many.found(())]
    trials = [
        [Step(switch, value) for value in switch.values if _can_be_told(shots, switch, value)] for switch in switches
    ]
    for _ in range(_ROUNDS):
        found: list[Found] = []
        for base in bases:
            looked = _first_look(first, base.steps, trials)
            steps = _best_values(few, base.steps, [group[:2] for group in looked[:_LOOKED_AT]])[:_FITTED]
            if not many.found((*base.steps, steps[0])).is_exact:
                steps = [_fitted(few, shots, base.steps, step) for step in steps]
            found += [many.found((*base.steps, step)) for step in steps]
            if not base.steps:
                trials = [group[:_VALUES] for group in looked]
            if any(one.is_exact for one in found):
                break
        before = ranked[0].score
        ranked = sorted([*ranked, *found], key=_rank)
        bases = sorted(found, key=_rank)[:_BASES]
        if ranked[0].is_exact or bases[0].score > before * (1.0 - _GAIN):
            break
    return ranked


def _rank(found: Found) -> float:
    """Fewer changes are better where scores are about the same."""
    return found.score * (1.0 + _MARGIN * len(found.steps)) + 0.01 * len(found.steps)


def _first_look(bench: _Bench, base: tuple[Step, ...], trials: list[list[Step]]) -> list[list[Step]]:
    """The values of each switch that is not in `base`, best first; and the switches, too."""
    used = {step.switch.key for step in base}
    best: list[tuple[float, int, list[Step]]] = []
    for number, steps in enumerate(trials):
        if steps and steps[0].switch.key not in used:
            scores = [bench.score((*base, step)) for step in steps]
            ranked = [steps[k] for k in np.argsort(scores, kind="stable")]
            best.append((min(scores), number, ranked))
    return [steps for _, _, steps in sorted(best, key=lambda entry: entry[:2])]


def _best_values(bench: _Bench, base: tuple[Step, ...], groups: list[list[Step]]) -> list[Step]:
    """The better value of each, the best first."""
    scored = [min((bench.score((*base, step)), k) for k, step in enumerate(steps)) for steps in groups]
    order = sorted(range(len(groups)), key=lambda number: (scored[number][0], number))
    return [groups[number][scored[number][1]] for number in order]


def _can_be_told(shots: Sequence[Shot], switch: Switch, value: Any) -> bool:
    """Whether the value is another than a right port's, for some picture."""
    return any(tell_something(cause_of(switch.key), switch.words(shot, value)) for shot in shots)


def _fitted(bench: _Bench, shots: Sequence[Shot], base: tuple[Step, ...], step: Step) -> Step:
    """The value between its neighbours, or near a pair, that is best; a round one where that is as good."""
    from scipy.optimize import minimize, minimize_scalar  # slow to import

    switch, start = step
    if not switch.fits:
        return step

    def score(value: Any) -> float:
        return bench.score((*base, Step(switch, value)))

    candidates: list[Any] = [start]
    if isinstance(start, tuple):
        least = score(start)
        if least < 0.1:
            return step
        result = minimize(
            lambda pair: score(tuple(pair)), start, method="Nelder-Mead", options={"maxfev": 40, "xatol": 1e-3}
        )
        candidates += [tuple(round(float(v), n) for v in result.x) for n in (1, 2, 3)]
    else:
        values = sorted({value for value in switch.values if np.isfinite(value)})
        if start not in values:
            return step
        at = values.index(start)
        low, high = values[max(at - 1, 0)], values[min(at + 1, len(values) - 1)]
        if switch.whole:
            candidates.append(_best_whole(score, int(low), int(start), int(high)))
        else:
            result = minimize_scalar(score, bounds=(low, high), method="bounded", options={"maxiter": 24})
            exact = float(result.x)
            candidates += [*(float(f"{exact:.{n}g}") for n in (1, 2, 3, 4, 6)), exact]
    candidates = [value for value in candidates if _can_be_told(shots, switch, value)]
    scores = [score(value) for value in candidates]
    good = min(scores) * (1.0 + _MARGIN) + 1e-3
    return Step(switch, next(value for value, found in zip(candidates, scores, strict=True) if found <= good))


def _best_whole(score: Callable[[int], float], low: int, middle: int, high: int) -> int:
    """The whole number in low .. high with the best score, by ever finer steps around the best so far."""
    best, stride = middle, max(1, (high - low) // 8)
    while True:
        near = sorted({k for k in range(best - 4 * stride, best + 4 * stride + 1, stride) if low <= k <= high})
        best = min(near, key=score) if near else best
        if stride == 1:
            return best
        stride = max(1, stride // 3)
