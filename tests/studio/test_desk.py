"""The desk: one thread, newest request first, errands before steps, and errors end nothing."""

import threading

import pytest

from refdof.studio.desk import Desk

pytestmark = pytest.mark.fast
WAIT = 20.0  # s: a busy machine


@pytest.fixture
def errors():
    return []


@pytest.fixture
def desk(errors):
    desk = Desk(errors.append)
    yield desk
    desk.close()


def counting(done, name, count, gate=None):
    def steps(newer):
        for k in range(count):
            done.append((name, k, threading.get_ident()))
            if gate is not None and k == 0:
                assert gate.wait(WAIT)
            yield

    return steps


def started(desk, work):
    """Ask for a page's steps, and wait until the first has begun."""
    first = threading.Event()

    def steps(newer):
        first.set()
        yield from work(newer)

    desk.ask("page", steps)
    assert first.wait(WAIT)


def finished(desk, who="last"):
    """Wait until everything asked for so far has been done."""
    event = threading.Event()

    def steps(newer):
        event.set()
        yield

    desk.ask(who, steps)
    assert event.wait(WAIT)


def test_the_newest_request_of_everyone_wins(desk):
    done, gate = [], threading.Event()
    started(desk, counting(done, "old", 3, gate))
    for name in ("lost", "lost too", "new"):  # while the old one is in its first step
        desk.ask("page", counting(done, name, 2))
    gate.set()
    finished(desk)
    ended = threading.Event()
    desk.errand(ended.set)
    assert ended.wait(WAIT)
    assert [(name, k) for name, k, _ in done if name != "new"] == [("old", 0)]
    assert ("new", 0) in [(name, k) for name, k, _ in done]


def test_pages_take_turns_in_one_thread(desk):
    done, ends = [], threading.Event()
    hold = threading.Event()
    desk.errand(lambda: hold.wait(WAIT))
    desk.ask("a", counting(done, "a", 3))

    def last(newer):
        yield from counting(done, "b", 3)(newer)
        ends.set()

    desk.ask("b", last)
    hold.set()
    assert ends.wait(WAIT)
    assert [(name, k) for name, k, _ in done] == [("a", 0), ("b", 0), ("a", 1), ("b", 1), ("a", 2), ("b", 2)]
    assert len({thread for _, _, thread in done}) == 1


def test_errands_come_first_and_steps_hear_of_them(desk):
    done, heard, ended = [], [], threading.Event()

    def steps(newer):
        heard.append(newer())
        desk.errand(lambda: done.append("errand"))
        heard.append(newer())
        yield
        done.append("second step")
        ended.set()

    desk.ask("page", steps)
    assert ended.wait(WAIT)
    assert heard == [False, True]
    assert done == ["errand", "second step"]


def test_an_error_is_reported_and_the_desk_works_on(desk, errors):
    def broken(newer):
        yield
        raise MemoryError("too much")

    desk.ask("page", broken)
    desk.errand(lambda: 1 / 0)
    finished(desk)
    assert {type(error) for error in errors} <= {MemoryError, ZeroDivisionError}
    finished(desk)
    assert {type(error) for error in errors} == {MemoryError, ZeroDivisionError}


def test_who_leaves_gets_no_more_steps(desk):
    done, gate = [], threading.Event()
    started(desk, counting(done, "gone", 3, gate))
    desk.leave("page")
    gate.set()
    finished(desk)
    assert [(name, k) for name, k, _ in done] == [("gone", 0)]


def test_many_errands_let_steps_through(desk):
    done, hold = [], threading.Event()
    desk.errand(lambda: hold.wait(WAIT))
    for _ in range(100):
        desk.errand(lambda: done.append("errand"))
    desk.ask("page", counting(done, "page", 2))
    hold.set()
    finished(desk)
    steps = [k for k, what in enumerate(done) if what != "errand"]
    assert 0 < steps[0] <= 16
    assert steps[1] - steps[0] <= 2 * 17  # another takes its turn between
