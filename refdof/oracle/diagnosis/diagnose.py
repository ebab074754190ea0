"""Diagnose: run a port on a pack, and say in a sentence what is wrong with it.

1. Run it on the cases that tell most                            `refdof.oracle.diagnosis.shots`
2. Look at the pictures as a whole                               `refdof.oracle.diagnosis.whole`
3. Look for changes of a right port that give the same results    `refdof.oracle.diagnosis.search`
4. Show its taps, if it can be run on other pictures             `refdof.oracle.diagnosis.probes`
5. Say what was found, or that nothing was                       `Diagnosis`
"""

import inspect
import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from refdof._check import InputError
from refdof.oracle.diagnosis.beyond import in_place, turned
from refdof.oracle.diagnosis.causes import NONE, UNEXPLAINED, cause_of
from refdof.oracle.diagnosis.image_switches import image_switches
from refdof.oracle.diagnosis.probes import probe
from refdof.oracle.diagnosis.samples import Shot
from refdof.oracle.diagnosis.search import Found, search
from refdof.oracle.diagnosis.shots import METHOD, probed, shots_of, telling
from refdof.oracle.diagnosis.switches import size_switches
from refdof.oracle.diagnosis.tap_switches import tap_switches
from refdof.oracle.diagnosis.whole import is_finite, whole_cause
from refdof.oracle.diagnosis.wording import sentence_of
from refdof.oracle.files import Pack, open_pack
from refdof.oracle.sources import Source, of_function

__all__ = ["Diagnosis", "Named", "diagnose", "diagnose_source"]

_ENOUGH = 0.6  # of the error: less is no explanation
_SAME = 0.999  # of the error: as good a cause
_SURE = 0.9  # of the error: less is the nearest known mistake rather than the cause
_SOMETHING = 0.1
_OTHERS = 3


@dataclass(frozen=True)
class Named:
    """A cause with its values: key, stage and sentence."""

    key: str
    stage: str
    sentence: str


@dataclass(frozen=True)
class Diagnosis:
    """What is wrong with a port.

    Attributes
    ----------
    causes : tuple of Named
        First the one that explains most; one of key "none" or "unexplained" where there is nothing to name. The stage
        of the latter is that of the known mistake which comes nearest.
    evidence : str
        What the causes explain, in a line.
    exact : float
        Share of the pixels that the causes reproduce.
    explained : float
        Share of the error that they explain.
    others : tuple of (Named, float)
        What else was looked at, and the share of the error that each explains.
    cases : tuple of names
        The cases that were looked at.
    probes : tuple of lines
        The port's taps beside those expected, where it could be run on other pictures.
    """

    causes: tuple[Named, ...]
    evidence: str
    exact: float = 0.0
    explained: float = 0.0
    others: tuple[tuple[Named, float], ...] = ()
    cases: tuple[str, ...] = ()
    probes: tuple[str, ...] = ()

    @property
    def key(self) -> str:
        """Of the first cause."""
        return self.causes[0].key

    @property
    def stage(self) -> str:
        """Of the first cause."""
        return self.causes[0].stage

    def lines(self) -> list[str]:
        """The sentence, further causes, and the evidence."""
        also = [f"and {cause.sentence}" for cause in self.causes[1:]]
        near = [f"{_beside(share)}: {one.sentence} ({share:.0%} of the error)" for one, share in self.others]
        unsure = self.key != UNEXPLAINED.key and 0.0 < self.explained < _SURE
        return ["most likely: " * unsure + self.causes[0].sentence, *also, f"({self.evidence})", *near, *self.probes]

    def as_json(self) -> dict[str, Any]:
        """Plain data, as `refdof diagnose --json` writes it."""

        def plain(cause: Named) -> dict[str, str]:
            return {"key": cause.key, "stage": cause.stage, "sentence": cause.sentence}

        return {
            "schema": "refdof-diagnosis-1",
            "causes": [plain(cause) for cause in self.causes],
            "evidence": self.evidence,
            "exact": self.exact,
            "explained": self.explained,
            "others": [{**plain(cause), "explained": share} for cause, share in self.others],
            "cases": list(self.cases),
            "probes": list(self.probes),
        }


def _beside(share: float) -> str:
    return "or" if share >= _SAME else "not as good"


def diagnose(function: Callable[..., Any], pack: str | os.PathLike[str], case: str | None = None) -> Diagnosis:
    """Say what is wrong with a port of the single pass.

    Parameters
    ----------
    function : (color, depth, coc, params) -> image, or Source
        The port, as for `refdof.oracle.check`; or what makes results of a task, as `refdof.oracle.sources` has them.
    pack : path
        A folder that `refdof golden` has written.
    case : str, optional
        Look at this case only.

    Raises
    ------
    InputError
        If the function is none, the pack is not as it was written, or has no case of that name.

    Notes
    -----
    Some seconds. Causes are those of `refdof.oracle.diagnosis.causes`, up to three at once.
    """
    if not callable(function):
        raise InputError(f"function: got {type(function).__name__}; allowed is a function or a source")
    return diagnose_source(function if _takes_one(function) else of_function(function), pack, case)


def _takes_one(function: Callable[..., Any]) -> bool:
    """Whether a callable takes a task, and not color, depth, coc and params: a source."""

    def takes(count: int) -> bool:
        try:
            inspect.signature(function).bind(*(None,) * count)
        except (TypeError, ValueError):
            return False
        return True

    return takes(1) and not takes(4)


def diagnose_source(
    source: Source, pack: str | os.PathLike[str], case: str | None = None, probes: bool = True
) -> Diagnosis:
    """`diagnose` of a source, with or without probes, which run it on other pictures."""
    opened = open_pack(pack)
    if case is not None and case not in opened.cases:
        raise InputError(f"case: got {case!r}; allowed are {', '.join(opened.cases)}")
    shots, faults = shots_of(opened, source, case)
    if case is not None and not shots and not faults:
        raise InputError(f"case: got {case!r}; allowed is one of {METHOD} that the port does")
    found = _diagnosis(opened, shots, faults)
    flat = probed(opened, shots) if probes and found.key != NONE.key else None
    return replace(found, probes=tuple(probe(source, *flat))) if flat else found


def _diagnosis(opened: Pack, shots: list[Shot], faults: list[str]) -> Diagnosis:
    names = tuple(shot.name for shot in shots)
    if not shots:
        said = f"no case of {METHOD} could be compared" + (f": {faults[0]}" if faults else "")
        return Diagnosis((_named(UNEXPLAINED.key, {}),), said)
    failing = [shot for shot in shots if not (shot.off <= 1.0).all()]
    if not failing and faults:
        said = f"{len(shots)} cases are right, {len(faults)} could not be compared: {faults[0]}"
        return Diagnosis((_named(UNEXPLAINED.key, {}),), said, cases=names)
    if not failing:
        return Diagnosis((_named(NONE.key, {}),), f"{len(shots)} cases compared", 1.0, 1.0, cases=names)
    whole = whole_cause(opened, failing)
    if whole is not None:
        key, words = whole
        return Diagnosis((_named(key, words),), f"in {len(failing)} of {len(shots)} cases", cases=names)
    chosen = telling(shots)
    right = chosen[0].right
    ranked = search(chosen, [*size_switches(), *tap_switches(right), *image_switches()])
    return _told(ranked, chosen, names)


def _told(ranked: list[Found], shots: Sequence[Shot], names: tuple[str, ...]) -> Diagnosis:
    best, nothing = ranked[0], next(found for found in ranked if not found.steps)
    reproduced = best.explained >= _ENOUGH or (best.is_exact and not nothing.is_exact)
    beyond = None if best.is_exact else _beyond(shots)
    if beyond is not None and beyond.explained > best.explained:
        return replace(beyond, cases=names)
    if not best.steps or not reproduced:
        others = _others([found for found in ranked if found.steps], shots)
        if not is_finite(shots):
            return Diagnosis((_named("not_finite", {}),), "unexplained otherwise", others=tuple(others), cases=names)
        stage = others[0][0].stage if others else ""
        said = f"the best explains {max(0.0, best.explained):.0%} of the error" + (f": {stage}" if stage else "")
        unexplained = Named(UNEXPLAINED.key, stage, UNEXPLAINED.sentence)
        return Diagnosis((unexplained,), said, best.exact, best.explained, tuple(others), names)
    before, after = f"{nothing.worst:.3g}", f"{best.worst:.3g}"
    worst = f"{before} before, {after}" if before != after else f"{before} as before"
    evidence = (
        f"worst error {worst} with this change of a right port: "
        f"{best.explained:.1%} of the error, {best.exact:.1%} of the pixels looked at"
    )
    keys = {step.switch.key for step in best.steps}
    rest = [found for found in ranked if len(found.steps) == 1 and found.steps[0].switch.key not in keys]
    others = _others(rest, shots)
    return Diagnosis(_causes(best, shots), evidence, best.exact, best.explained, tuple(others), names)


def _others(ranked: Sequence[Found], shots: Sequence[Shot]) -> list[tuple[Named, float]]:
    """The best of what explains something, each sentence once."""
    told: dict[str, tuple[Named, float]] = {}
    for found in ranked:
        cause = _causes(found, shots)[0]
        if found.explained > _SOMETHING:
            told.setdefault(cause.sentence, (cause, found.explained))
    return list(told.values())[:_OTHERS]


def _beyond(shots: Sequence[Shot]) -> Diagnosis | None:
    """A cause that no single model gives."""
    share = in_place(shots)
    if share is not None:
        return Diagnosis((_named("in_place", {}),), f"gives {share:.1%} of the pixels", share, share)
    share = turned(shots)
    if share is not None:
        said = f"the best angle of each pixel explains {share:.1%} of the error"
        return Diagnosis((_named("angle_noise", {}),), said, explained=share)
    return None


def _causes(found: Found, shots: Sequence[Shot]) -> tuple[Named, ...]:
    """With the numbers of the picture that shows most, or of one whose parameters differ more from what was fitted."""
    ranked = sorted(shots, key=lambda shot: -float(np.minimum(shot.off, 1e6).mean()))
    return tuple(
        _named(step.switch.key, *(step.switch.words(shot, step.value) for shot in ranked)) for step in found.steps
    )


def _named(key: str, *pictures: dict[str, Any]) -> Named:
    """A cause with the words for pictures, the one that shows most first."""
    cause = cause_of(key)
    return Named(key, cause.stage, sentence_of(cause, pictures))
