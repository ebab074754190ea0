"""The statements: each has a source, a place, a printed figure and a measure that takes its arguments; bad files."""

import inspect
import re
from pathlib import Path

import pytest

from refdof import InputError
from refdof.claims import SOURCES, claims
from refdof.claims.bench import Bench
from refdof.claims.measures import MEASURES
from refdof.claims.statement import claims_of
from refdof.rendering import make_params
from refdof.scene.builtin import SCENES

pytestmark = pytest.mark.fast

ROOT = next(folder for folder in Path(__file__).parents if (folder / "pyproject.toml").exists())
CLAIMS = claims()
GOOD = """
[[claim]]
id = "a-claim"
source = "lee2010"
place = "Table 1"
says = "It is so."
printed = "4"
measure = "golden_angle"
within = [3, 5]
tolerance = "none"
why = { reproduced = "It is." }
"""


def test_there_are_enough_of_every_source():
    assert len(CLAIMS) >= 50
    for source in SOURCES:
        assert sum(claim.source == source for claim in CLAIMS) >= 8
    assert sum(bool(claim.rule.not_testable) for claim in CLAIMS) < len(CLAIMS) / 5


def test_sources_are_in_the_bibliography():
    keys = re.findall(r"^@\w+\{(\w+),", (ROOT / "papers.bib").read_text(encoding="utf-8"), flags=re.MULTILINE)
    assert set(SOURCES) <= set(keys)


def test_every_measure_is_used():
    assert {claim.measure for claim in CLAIMS} - {""} == set(MEASURES)


def found(value, key):
    """All values of a key in nested tables."""
    if isinstance(value, dict):
        own = [value[key]] if key in value else []
        return own + [one for part in value.values() for one in found(part, key)]
    return [one for part in value for one in found(part, key)] if isinstance(value, list) else []


@pytest.mark.parametrize("claim", CLAIMS, ids=lambda claim: claim.name)
def test_a_claim_is_whole(claim):
    assert claim.source in SOURCES
    assert re.search(r"Abstract|Section|Figure|Table|Eqs?\.|Text|Listing|trick", claim.place)
    assert claim.printed
    assert claim.says.endswith(".")
    if claim.rule.not_testable:
        return
    assert claim.tolerance
    assert claim.rule.in_words()
    inspect.signature(MEASURES[claim.measure].function).bind(Bench(), **claim.arguments)
    assert set(found(claim.arguments, "scene")) <= set(SCENES)
    shots = [*found(claim.arguments, "shots"), *found(claim.arguments, "shot")]
    assert bool(claim.setting) >= bool(shots)


def renders(value):
    if isinstance(value, dict):
        own = [value] if "method" in value else []
        return own + [one for part in value.values() for one in renders(part)]
    return [one for part in value for one in renders(part)] if isinstance(value, list) else []


@pytest.mark.parametrize("claim", [c for c in CLAIMS if renders(dict(c.arguments))], ids=lambda claim: claim.name)
def test_renders_have_parameters_that_exist(claim):
    for render in renders(dict(claim.arguments)):
        if render["method"] != "pinhole":
            given = {k: v for k, v in render.items() if k not in ("method", "preset")}
            made = make_params(render["method"], given)
            assert set(given) <= set(vars(made))


def test_a_good_claim():
    (claim,) = claims_of(GOOD)
    assert claim.rule.within == (3.0, 5.0)
    assert claim.sentence("reproduced") == "It is."
    assert claim.sentence("refuted") == "The rule: reproduced from 3 to 5."


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('id = "a-claim"', 'id = "A claim"', "id: got 'A claim'; allowed are lower-case words"),
        ('"lee2010"', '"lee2011"', "source: got 'lee2011'; did you mean 'lee2010'"),
        ("printed", "prnted", "'prnted': unknown; did you mean 'printed'"),
        ('place = "Table 1"', 'place = " "', "place: got ' '; allowed is text"),
        ("within = [3, 5]", "within = [5, 3]", "within: got"),
        ("within = [3, 5]", "within = [3]", "within: got"),
        ("within = [3, 5]", 'within = ["3", 5]', "within: got"),
        ("within = [3, 5]", "", "got no rule; allowed is one of within, order, not_testable"),
        ("within = [3, 5]", 'order = ["a", "b", "c"]\nmain = "b"', "main: got 'b'"),
        ("within = [3, 5]", 'not_testable = "no"', "measure: allowed is one with within or order"),
        ('measure = "golden_angle"', "", "measure: allowed is one with within or order"),
        ('tolerance = "none"', "", "tolerance: missing"),
        ('{ reproduced = "It is." }', '{ reproducd = "It is." }', "did you mean 'reproduced'"),
        ('{ reproduced = "It is." }', '{ reproduced = "It is" }', "allowed is a sentence"),
        ("within", "digits = 0\nwithin", "digits: got 0"),
        ("[[claim]]", "[[clam]]", "'clam': unknown; did you mean 'claim'"),
        ("[[claim]]", "[[claim", "allowed is a TOML file"),
    ],
)
def test_bad_files_are_named(old, new, words):
    assert old in GOOD
    with pytest.raises(InputError) as error:
        claims_of(GOOD.replace(old, new, 1))
    assert words in str(error.value)
    assert "claims.toml" in str(error.value)


def test_an_id_is_there_once():
    with pytest.raises(InputError, match="got 'a-claim' twice"):
        claims_of(GOOD + GOOD)
