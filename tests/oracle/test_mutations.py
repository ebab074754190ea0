"""The checker, tested by mutation: no wrong port passes, and no right one fails.

Wrong ports are rows of `tests.oracle.mutations`. REFDOF_REQUIRE_CC=1, REFDOF_REQUIRE_GL=1 and REFDOF_REQUIRE_VULKAN=1
make what is missing a failure.
"""

import pytest

from refdof.oracle.diagnosis.causes import STAGES, cause_of
from tests.oracle.mutations import ROWS, VARIANTS
from tests.oracle.mutations.needs import need_all
from tests.oracle.mutations.row import text_of
from tests.oracle.mutations.runs import Bench, write_small_pack


@pytest.fixture(scope="module")
def bench(tmp_path_factory):
    need_all(tmp_path_factory.mktemp("plain"))
    opened = Bench(write_small_pack(tmp_path_factory.mktemp("mutations") / "pack"))
    yield opened
    opened.close()


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
def test_a_wrong_port_does_not_pass(row, bench):
    assert bench.status_of(row) == ("error" if row.cause == "error" else "fail")


@pytest.mark.gl
@pytest.mark.parametrize("variant", VARIANTS, ids=lambda variant: f"{variant.port}: {variant.name}")
def test_a_right_port_passes(variant, bench):
    outcomes = bench.report_of(variant.port, variant.text).outcomes
    assert {outcome.status for outcome in outcomes} == {"pass"}, outcomes
