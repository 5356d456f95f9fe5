"""Turns: readers side by side, a change alone and before those who come after it."""

from __future__ import annotations

from threading import Event, Thread

import pytest

from terrain_lod.terrain.turns import Turns


def test_many_read_at_a_time() -> None:
    turns, inside, leave = Turns(), Event(), Event()

    def read() -> None:
        with turns.reading():
            inside.set()
            leave.wait(10)

    with turns.reading():
        other = Thread(target=read)
        other.start()
        assert inside.wait(10)
    leave.set()
    other.join()


def test_a_change_waits_for_readers_and_goes_before_new_ones() -> None:
    turns, order, waits = Turns(), [], Event()

    def change() -> None:
        waits.set()
        with turns.changing():
            order.append("changed")

    def read() -> None:
        with turns.reading():
            order.append("read")

    threads = [Thread(target=change), Thread(target=read)]
    with turns.reading():
        threads[0].start()
        waits.wait(10)
        while not turns._waiting:
            pass
        threads[1].start()
        threads[1].join(0.1)
        assert order == []
    for thread in threads:
        thread.join()
    assert order == ["changed", "read"]


@pytest.mark.parametrize("turn", ["reading", "changing"])
def test_an_error_ends_a_turn(turn: str) -> None:
    turns = Turns()
    with pytest.raises(ZeroDivisionError), getattr(turns, turn)():
        1 / 0  # noqa: B018
    with turns.changing():
        pass
    with turns.reading():
        pass
