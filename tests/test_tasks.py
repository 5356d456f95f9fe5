"""Tasks come back with their results whoever does them, and nobody works on afterwards."""

from __future__ import annotations

import threading
from concurrent.futures import Executor, ProcessPoolExecutor, ThreadPoolExecutor
from itertools import islice
from pathlib import Path

import pytest

from support import work
from terrain_lod import InputError, WorkerError
from terrain_lod.tasks import Workers, run_tasks

SQUARES = {number: number * number for number in range(9)}


@pytest.fixture(params=["here", "processes", "threads"])
def workers(request: pytest.FixtureRequest) -> Workers:
    return {"here": None, "processes": 2, "threads": ThreadPoolExecutor(2)}[request.param]


def test_tasks_come_with_their_results(workers: Workers) -> None:
    seen: list[tuple[int, int]] = []
    done = run_tasks(
        work.square, range(9), workers=workers, progress=lambda *steps: seen.append(steps)
    )
    assert dict(done) == SQUARES
    assert seen == [(done, 9) for done in range(1, 10)]


def test_an_error_of_a_task_is_raised(workers: Workers) -> None:
    with pytest.raises(ValueError, match="not 0"):
        list(run_tasks(work.refuse, [0], workers=workers))


@pytest.mark.slow
def test_a_task_whose_process_dies_is_done_again(tmp_path: Path) -> None:
    tasks = [(tmp_path, number) for number in range(9)]
    done = dict(run_tasks(work.square_or_die_once, tasks, workers=2))
    assert (tmp_path / "died").exists()
    assert {number: result for (_, number), result in done.items()} == SQUARES


@pytest.mark.slow
def test_a_task_that_kills_every_process_is_named() -> None:
    with pytest.raises(WorkerError, match="3 that died over 7"):
        list(run_tasks(work.die, [7], workers=1))


def test_a_broken_executor_is_one_line() -> None:
    with ProcessPoolExecutor(1) as pool, pytest.raises(WorkerError, match="a number for workers="):
        list(run_tasks(work.die, [7], workers=pool))


def test_few_tasks_are_in_flight() -> None:
    begun: list[int] = []
    with ThreadPoolExecutor(2) as pool:
        done = run_tasks(begun.append, range(100), workers=pool)
        assert len(list(islice(done, 3))) == 3
        # three were yielded, and two a worker may be on their way
        assert len(begun) <= 3 + 4
        done.close()  # type: ignore[attr-defined]
        assert len(begun) <= 3 + 4


@pytest.mark.slow
@pytest.mark.parametrize("threads", [False, True])
def test_what_is_stopped_leaves_nobody_at_work(tmp_path: Path, threads: bool) -> None:
    pool: Executor | None = ThreadPoolExecutor(2) if threads else None
    tasks = [(tmp_path, number) for number in range(20)]

    def interrupt(done: int, total: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        list(run_tasks(work.write_slowly, tasks, workers=pool or 2, progress=interrupt))
    begun = {path.stem for path in tmp_path.glob("*.begun")}
    assert begun == {path.stem for path in tmp_path.glob("*.ended")}
    assert len(begun) < 10


def test_a_thread_may_hand_out_tasks() -> None:
    found: list[dict[int, int]] = []
    thread = threading.Thread(target=lambda: found.append(dict(run_tasks(work.square, range(9)))))
    thread.start()
    thread.join()
    assert found == [SQUARES]


@pytest.mark.parametrize("wrong", [0, -1, True, "dask", 2.5])
def test_others_than_workers_are_refused(wrong: Workers) -> None:
    with pytest.raises(InputError, match="worker"):
        list(run_tasks(work.square, range(2), workers=wrong))
