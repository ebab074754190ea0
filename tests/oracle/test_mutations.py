"""The checker, tested by mutation: no wrong port passes, no right one fails, and most are told what is wrong.

Wrong ports are rows of `tests.oracle.mutations`. Their truth was written down from what each change does.
REFDOF_REQUIRE_CC=1, REFDOF_REQUIRE_GL=1 and REFDOF_REQUIRE_VULKAN=1 make what is missing a failure.
"""

import os
import shutil
from functools import lru_cache

import pytest

from refdof.oracle.diagnosis.causes import STAGES, cause_of
from tests.gl.shader import GLMissing, open_context
from tests.oracle.mutations import ROWS, VARIANTS
from tests.oracle.mutations.row import text_of
from tests.oracle.mutations.runs import Bench
from tests.oracle.mutations.table import shares
from tests.oracle.shader_cases import need


def _missing(variable, reason):
    """Skip, or fail where CI requires what is missing."""
    if os.environ.get(variable) == "1":
        pytest.fail(f"{variable} is set, but {reason}", pytrace=False)
    pytest.skip(reason)


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    need("wgsl", tmp_path_factory.mktemp("wgsl"))
    if shutil.which("cc") is None:
        _missing("REFDOF_REQUIRE_CC", "no C compiler: there is no `cc`")
    try:
        context = open_context()
    except GLMissing as missing:
        _missing("REFDOF_REQUIRE_GL", str(missing))
    with Bench(context) as opened:
        yield opened


@pytest.fixture(scope="module")
def result_of(bench):
    """The result of a row; each is made once."""
    return lru_cache(bench.result_of)


@pytest.mark.fast
def test_every_change_is_one_and_every_name_another():
    for row in ROWS:
        assert row.text != text_of(row.port)
    for variant in VARIANTS:
        assert (variant.text != text_of(variant.port)) == bool(variant.changes)
    for rows in (ROWS, VARIANTS):
        assert len({(row.port, row.name) for row in rows}) == len(rows)
    assert len(ROWS) >= 75


@pytest.mark.fast
def test_the_truth_is_said_in_known_words():
    for row in ROWS:
        if row.cause == "error":
            assert row.stage == ""
        else:
            assert row.stage in STAGES
            assert all(cause_of(key) for key in row.cause.split(" or "))


@pytest.mark.gl
@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"{row.port}: {row.name}")
def test_a_wrong_port_does_not_pass(row, result_of):
    result = result_of(row)
    print(result)
    assert result.status == ("fail" if result.drawn else "error")


@pytest.mark.gl
def test_most_are_told_what_is_wrong(result_of):
    stage, cause = shares(result_of(row) for row in ROWS)
    print(f"{stage:.1%} of stages, {cause:.1%} of causes")
    assert stage >= 0.9
    assert cause >= 0.7


@pytest.mark.gl
@pytest.mark.parametrize("variant", VARIANTS, ids=lambda variant: f"{variant.port}: {variant.name}")
def test_a_right_port_passes(variant, bench):
    outcomes = bench.report_of(variant.port, variant.text).outcomes
    assert {outcome.status for outcome in outcomes} == {"pass"}, outcomes
