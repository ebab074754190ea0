"""Selection: patterns, shards and tags; the exit status of a check with nothing to say."""

import pytest

from refdof import InputError
from refdof.oracle import Plan, check, check_results
from refdof.oracle.selection import as_shard, select
from tests.oracle.small_pack import port, statuses

pytestmark = pytest.mark.fast

NAMES = tuple(f"case_{k}" for k in range(10))


@pytest.mark.parametrize("count", [1, 2, 3, 7, 10])
def test_every_case_is_in_exactly_one_shard(count):
    shards = [select(NAMES, Plan(shard=(part, count))) for part in range(1, count + 1)]
    assert sorted(case for shard in shards for case in shard) == list(NAMES)
    assert max(map(len, shards)) - min(map(len, shards)) <= 1


def test_shards_are_of_the_cases_chosen(pack):
    parts = [check(port, pack, plan=Plan(only="noise*", shard=(k, 2))).outcomes for k in (1, 2)]
    assert [[outcome.case for outcome in part] for part in parts] == [["noise"], ["noise_up"]]


@pytest.mark.parametrize("text", ["", "1", "0/2", "3/2", "1/0", "-1/2", "1/2/3", "a/b", "1 / 2", "٣/٣"])
def test_shards_that_are_none(text):
    with pytest.raises(InputError, match=r"^shard: got "):
        as_shard(text)


def test_plans_that_fit_no_pack(pack):
    for words, said in [
        ({"only": "nois"}, "only: got 'nois', which is no case; the first of the pack is cards"),
        ({"shard": (4, 4)}, "shard: got 4/4, which holds no case; allowed are up to 3 parts"),
        ({"not_supported": ("stage",)}, "not_supported: got 'stage'; did you mean 'staged'"),
        ({"given": ("sizes",)}, "given: got 'sizes'; did you mean 'size'"),
    ]:
        with pytest.raises(InputError) as error:
            check(port, pack, plan=Plan(**words))
        assert str(error.value).startswith(said)
    for words in ({"shard": (0, 1)}, {"shard": (1,)}, {"only": 7}, {"given": "coc"}, {"waivers": ("x",)}):
        with pytest.raises(InputError):
            Plan(**words)


def test_files_made_elsewhere_take_no_stages(pack, tmp_path):
    with pytest.raises(InputError, match=r"^given"):
        check_results(tmp_path, pack, plan=Plan(given=("coc",)))


def test_tags_that_a_port_does_not_do(pack):
    called = []

    def counted(*words):
        called.append(1)
        return port(*words)

    report = check(counted, pack, plan=Plan(not_supported=("staged",)))
    assert statuses(report) == ["not supported", "pass", "not supported"]
    assert report.outcomes[0].message == "tagged staged"
    assert (report.passed, len(called)) == (True, 1)
    assert not check(counted, pack, plan=Plan(not_supported=("singlepass",))).passed
