"""Selection: which cases of a pack a check runs, and what of an implementation is known beforehand."""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import date
from fnmatch import fnmatchcase

from refdof._check import InputError, as_instance, as_instances
from refdof.oracle.waivers import Waiver

__all__ = ["Plan", "as_shard", "select"]

_SHARD = re.compile(r"([0-9]{1,6})/([0-9]{1,6})")


@dataclass(frozen=True)
class Plan:
    """What is checked, and how.

    Parameters
    ----------
    only : str
        A pattern of case names; * stands for any letters.
    shard : (I, N)
        Part I, from 1, of N: every case is in exactly one of them.
    not_supported : tags
        Cases with one of these are not run.
    given : names of stages
        Those that the implementation can be handed. A case that is not right is then run once more, with the golden
        ones: isolated by the implementation itself.
    waivers : Waivers
    today : date
        Against which waivers expire.

    Raises
    ------
    InputError
        If a shard, or a name, is none.
    """

    only: str = "*"
    shard: tuple[int, int] = (1, 1)
    not_supported: tuple[str, ...] = ()
    given: tuple[str, ...] = ()
    waivers: tuple[Waiver, ...] = ()
    today: date = field(default_factory=date.today)

    def __post_init__(self) -> None:
        as_instance("only", self.only, str)
        for name in ("not_supported", "given"):
            object.__setattr__(self, name, as_instances(name, getattr(self, name), str))
        object.__setattr__(self, "waivers", as_instances("waivers", self.waivers, Waiver))
        as_shard("{}/{}".format(*self.shard) if len(self.shard) == 2 else "")


def as_shard(text: str) -> tuple[int, int]:
    """I and N of "I/N".

    Raises
    ------
    InputError
        If it is not of this form, or I is not in 1 .. N.
    """
    match = _SHARD.fullmatch(text)
    part, count = (int(number) for number in match.groups()) if match else (0, 0)
    if not 1 <= part <= count:
        raise InputError(f"shard: got {text[:80]!r}; allowed is I/N with I in 1 .. N, such as 1/4")
    return part, count


def select(cases: Sequence[str], plan: Plan) -> tuple[str, ...]:
    """The cases of a plan, in their order.

    Raises
    ------
    InputError
        If there is none.
    """
    chosen = [case for case in cases if fnmatchcase(case, plan.only)]
    if not chosen:
        raise InputError(f"only: got {plan.only[:80]!r}, which is no case; the first of the pack is {cases[0]}")
    part, count = plan.shard
    if part > len(chosen):
        raise InputError(f"shard: got {part}/{count}, which holds no case; allowed are up to {len(chosen)} parts")
    return tuple(chosen[part - 1 :: count])
