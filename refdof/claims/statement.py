"""Claims: the statements of data/claims.toml, read strictly.

Each is a table [[claim]]:

id = "reads-mipmap"                 # lower case, unique
source = "lee2009mipmap"            # a key of papers.bib, one of `SOURCES`
place = "Table 1, row Ours"
says = "Reads of textures per pixel at 1024 x 1024."
printed = "20.98"                   # as it is printed
measure = "texture_reads"           # one of `refdof.claims.measures.MEASURES`
arguments = { method = "mipmap" }   # of the measure
unit = "reads"                      # optional, as are digits = 3 and setting = "cans, 320x240"
within = [20.975, 20.985]           # or order = [...] (with main = ...), or not_testable = "why"
direction = [10, 40]                # optional
tolerance = "half of the last printed digit"
why = { reproduced = "..." }        # a sentence for the verdict that was found when it was written
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from importlib import resources
from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Any

from refdof._check import InputError, as_choice, as_integer
from refdof._toml import check_keys, parse
from refdof.claims.verdict import NOT_TESTABLE, VERDICTS, Rule

__all__ = ["FILE", "SOURCES", "Claim", "claims", "claims_of"]

SOURCES: dict[str, str] = {
    "lee2009multiview": "Lee, Eisemann & Seidel 2009, multiview synthesis",
    "schedl2012": "Schedl & Wimmer 2012, cascaded layers",
    "lee2009mipmap": "Lee, Kim & Choi 2009, anisotropic mipmaps",
    "lee2010": "Lee, Eisemann & Seidel 2010, lens blur",
    "gustafsson2018": "Gustafsson 2018, single pass",
}
FILE = "claims.toml"
_NEEDED = ("id", "source", "place", "says", "printed", "why")
_OPTIONAL = (
    "measure",
    "arguments",
    "unit",
    "digits",
    "setting",
    "within",
    "direction",
    "order",
    "main",
    "not_testable",
    "tolerance",
)
_WORDS = ("place", "says", "printed", "measure", "unit", "setting", "main", "not_testable", "tolerance")


@dataclass(frozen=True)
class Claim:
    """A statement of a paper, and how it is held against a measurement.

    Attributes
    ----------
    name : its id
    source : key in papers.bib
    place : figure, table, equation or section
    says : what is claimed, in our words
    printed : the figure as it is printed, or what the place shows
    measure, arguments : what measures it; "" where nothing does
    unit, digits : of our figure, and how many significant digits of it are shown and judged
    setting : scene and size, in words
    rule : how the figure is judged
    tolerance : why the rule's bounds are where they are
    why : a sentence for a verdict
    """

    name: str
    source: str
    place: str
    says: str
    printed: str
    rule: Rule
    why: Mapping[str, str]
    measure: str = ""
    arguments: Mapping[str, Any] = field(default_factory=dict)
    unit: str = ""
    digits: int = 3
    setting: str = ""
    tolerance: str = ""

    def sentence(self, verdict: str) -> str:
        """Why the verdict is what it is."""
        return self.why.get(verdict, f"The rule: {self.rule.in_words()}.")


def claims() -> tuple[Claim, ...]:
    """All claims, in the order of the file."""
    return claims_of(_file().read_text(encoding="utf-8"))


def claims_of(text: str) -> tuple[Claim, ...]:
    """The claims of a file's text.

    Raises
    ------
    InputError
        If a key is missing or unknown, a value is not as it should be, or two claims have one id.
    """
    table = parse(FILE, text, "claims")
    check_keys(FILE, table, ("claim",))
    found = tuple(_claim(number, entry) for number, entry in enumerate(table["claim"], 1))
    names = [claim.name for claim in found]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"{FILE}: id: got {name!r} twice; allowed is once")
    return found


def _claim(number: int, entry: Mapping[str, Any]) -> Claim:
    where = f"{FILE}: claim {entry.get('id', number)}"
    check_keys(where, entry, _NEEDED, _OPTIONAL)
    if not isinstance(entry["id"], str) or not re.fullmatch("[a-z0-9]+(-[a-z0-9]+)*", entry["id"]):
        raise InputError(f"{where}: id: got {entry['id']!r}; allowed are lower-case words with hyphens between")
    as_choice(f"{where}: source", entry["source"], SOURCES)
    for key in _WORDS:
        if key in entry and (not isinstance(entry[key], str) or not entry[key].strip()):
            raise InputError(f"{where}: {key}: got {entry[key]!r:.80}; allowed is text")
    rule = _rule(where, entry)
    if bool(rule.not_testable) == ("measure" in entry):
        raise InputError(f"{where}: measure: allowed is one with within or order, and none with not_testable")
    if not rule.not_testable and "tolerance" not in entry:
        raise InputError(f"{where}: tolerance: missing; allowed is a reason for the bounds")
    for verdict, sentence in entry["why"].items():
        as_choice(f"{where}: why", verdict, [_key(name) for name in VERDICTS])
        if not isinstance(sentence, str) or not sentence.endswith("."):
            raise InputError(f"{where}: why: got {sentence!r:.80}; allowed is a sentence")
    why = {name: entry["why"][_key(name)] for name in VERDICTS if _key(name) in entry["why"]}
    if rule.not_testable:
        why[NOT_TESTABLE] = rule.not_testable
    words = {
        key: entry[key]
        for key in ("place", "says", "printed", "measure", "unit", "setting", "tolerance")
        if key in entry
    }
    digits = as_integer(f"{where}: digits", entry.get("digits", 3), minimum=1, maximum=12)
    return Claim(
        entry["id"], entry["source"], rule=rule, why=why, arguments=entry.get("arguments", {}), digits=digits, **words
    )


def _key(verdict: str) -> str:
    return verdict.split()[0]


def _rule(where: str, entry: Mapping[str, Any]) -> Rule:
    kinds = [key for key in ("within", "order", "not_testable") if key in entry]
    if len(kinds) != 1:
        raise InputError(f"{where}: got {', '.join(kinds) or 'no rule'}; allowed is one of within, order, not_testable")
    order = tuple(entry.get("order", ()))
    main = entry.get("main", "")
    if main and main not in (order[:1] + order[-1:]):
        raise InputError(f"{where}: main: got {main!r}; allowed is the first or the last of order")
    ranges = {key: _range(f"{where}: {key}", entry[key]) for key in ("within", "direction") if key in entry}
    return Rule(order=order, main=main, not_testable=entry.get("not_testable", ""), **ranges)


def _range(where: str, value: Any) -> tuple[float, float]:
    if not isinstance(value, list) or len(value) != 2 or not all(type(v) in (int, float) for v in value):
        raise InputError(f"{where}: got {value!r:.80}; allowed are two numbers")
    least, greatest = float(value[0]), float(value[1])
    if not least <= greatest:
        raise InputError(f"{where}: got {value!r}; allowed are the least and the greatest number")
    return least, greatest


def _file() -> Traversable:
    """The file in data/ of a checkout, if this is one, or the installed one."""
    root = Path(__file__).parents[2]
    if (root / "pyproject.toml").is_file():
        return root / "data" / FILE
    return resources.files("refdof.data").joinpath(FILE)
