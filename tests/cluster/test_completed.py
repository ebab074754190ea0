"""Tasks on two worker processes: their results, what travels, what is sent again, and what they raise."""

import os
import signal

import pytest

from refdof import InputError
from refdof._jit import thread_count
from refdof.cluster import completed, connected
from tests.cluster import work

pytestmark = pytest.mark.fast


def pids(cluster):
    return set(cluster.client.run(os.getpid).values())


def test_without_a_cluster_tasks_are_done_here_in_order(log):
    assert list(completed(work.add, work.Scene(5), range(3))) == [(0, 1005), (1, 1006), (2, 1007)]
    assert work.told() == [(os.getpid(), "made")]


def test_results_are_those_of_this_process_and_what_is_shared_travels_once_to_each_worker(two, log):
    found = dict(completed(work.add, work.Scene(5), range(40), two))
    assert found == {k: 1005 + k for k in range(40)}
    words = work.told()
    arrived = [process for process, said in words if said == "arrived"]
    assert sorted(arrived) == sorted(pids(two))  # each once
    made = [process for process, said in words if said == "made"]
    assert len(made) == len(set(made))  # what a task keeps in it is there for the next one
    assert os.getpid() not in arrived


def test_workers_share_the_processors(two):
    assert dict(completed(work.threads, None, [0], two)) == {0: max(1, thread_count() // 2)}


def test_tasks_are_read_a_few_ahead_of_the_workers(two, log):
    read = []

    def tasks():
        for k in range(30):
            read.append(k)
            yield k

    for count, _ in enumerate(completed(work.add, work.Scene(0), tasks(), two), 1):
        assert len(read) <= count + 4  # two for each of two workers


def test_what_a_task_raises_comes_back_as_it_is(two):
    with pytest.raises(InputError) as refused:
        list(completed(work.fail, None, ["input"], two))
    assert str(refused.value) == "samples: got -1; allowed is a whole number >= 1"
    with pytest.raises(ZeroDivisionError):
        list(completed(work.fail, None, ["other"], two))
    assert dict(completed(work.add, work.Scene(0), [1], two)) == {0: 1001}  # the workers are still there


def test_a_worker_that_dies_costs_its_own_tasks(log):
    with connected(workers=2) as cluster:
        victim = min(pids(cluster))
        found, before = {}, set()
        for number, result in completed(work.slow, work.Scene(7), range(24), cluster):
            found[number] = result
            if len(found) == 8:
                work.wait_until(lambda: work.is_at_work(victim))
                before = {said for process, said in work.told() if process == victim and said.startswith("end")}
                os.kill(victim, signal.SIGKILL)
                words_then = len(work.told())
        words = work.told()
        assert found == {k: 7 + k for k in range(24)}
        again = [task for task in range(24) if sum(said == f"begin {task}" for _, said in words) > 1]
        died = {said.split()[1] for process, said in words if process == victim and said.startswith("begin")}
        died -= {said.split()[1] for said in before}
        assert {str(task) for task in again} <= died  # only what the dead worker had not handed on
        assert 1 <= len(died) <= 2  # the one it did, and one that had ended and was not fetched yet
        assert len(words) > words_then
        assert victim not in pids(cluster)


def test_what_is_shared_is_sent_again_if_all_workers_die(log):
    with connected(workers=1) as cluster:
        found = {}
        for number, result in completed(work.slow, work.Scene(7), range(6), cluster):
            found[number] = result
            if len(found) == 2:
                (only,) = pids(cluster)
                os.kill(only, signal.SIGKILL)
        assert found == {k: 7 + k for k in range(6)}
        assert sum(said == "arrived" for _, said in work.told()) == 2


def test_a_task_that_kills_every_worker_is_one_line(log):
    with connected(workers=2) as cluster:
        with pytest.raises(InputError, match=r"^cluster: got workers that died while they had task \d,") as refused:
            list(completed(work.deadly, None, range(3), cluster))
        assert "\n" not in str(refused.value)


def test_a_worker_does_one_task_at_a_time_even_if_it_has_several_threads(log):
    from distributed import Client, LocalCluster

    from refdof.cluster import Cluster

    options = {"n_workers": 1, "threads_per_worker": 4, "dashboard_address": "127.0.0.1:0", "silence_logs": 50}
    with LocalCluster(**options) as several, Client(several, set_as_default=False) as client:
        assert len(dict(completed(work.alone, None, range(12), Cluster(client, "here")))) == 12
    said = [words for _, words in work.told()]
    assert said == ["begin", "end"] * 12
