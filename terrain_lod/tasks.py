"""Many tasks, done by whoever is there: this process, others, threads, a cluster.

A task is worked on by a function of it alone that is found by its name, so that it can be sent to
another process. What a task leaves on a disk, it leaves whole or not at all, and it may be done
twice with the same result. Then nothing depends on who did what, or in which order.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, CancelledError, Future, ProcessPoolExecutor
from queue import SimpleQueue
from typing import Any, Final, Protocol, TypeVar

from .arguments import told, whole
from .errors import InputError, WorkerError

# a task whose worker died so often is what kills them
_ATTEMPTS: Final = 3
# processes on one machine: more is a slip
_MOST: Final = 1024
# tasks handed out beyond those that are worked on, so that no worker waits for its next one
_WAITING: Final = 2

Progress = Callable[[int, int], None]
"""Takes the steps done and the steps in all."""

Task = TypeVar("Task")
Result = TypeVar("Result")


class Submits(Protocol):
    """An executor of ``concurrent.futures``, or what behaves like one."""

    def submit(self, work: Callable[..., Any], /, *arguments: Any) -> Future[Any]: ...


Workers = int | Submits | None
"""Who works: None for this process, a number of processes made for the run, or what has `submit`:
an executor of ``concurrent.futures``, or a ``Client`` of ``dask.distributed``."""


def require_workers(workers: Workers) -> None:
    """Refuse what is no workers, before there is work."""
    if isinstance(workers, int) and not isinstance(workers, bool):
        if workers < 1:
            raise InputError(f"expected at least 1 worker, got {workers}")
        whole("workers", workers, 1, _MOST)
    elif workers is not None and not callable(getattr(workers, "submit", None)):
        raise InputError(
            "expected a number of workers, an executor or a client of dask for workers, "
            f"got {told(workers)}"
        )


def run_tasks(
    work: Callable[[Task], Result],
    tasks: Sequence[Task],
    *,
    workers: Workers = None,
    progress: Progress | None = None,
) -> Iterator[tuple[Task, Result]]:
    """Yield each task with its result, as they are finished.

    At most twice as many tasks as there are workers are handed out and not yet yielded, so that
    results never pile up.

    Parameters
    ----------
    work : callable
        Takes a task. For processes and clusters, it and the tasks have to be such as can be sent.
    tasks : sequence
        Handed out in this order.
    workers : int, executor or None, optional
        See :data:`Workers`. A number of processes is replaced when one of them dies, and what was
        lost is done again; a cluster of dask does so by itself.
    progress : callable, optional
        Called with the number of finished tasks and that of all.

    Raises
    ------
    InputError
        If `workers` is none of these.
    WorkerError
        If workers die over the same task again and again, or an executor that was given breaks.

    Notes
    -----
    Whatever ends this early, an error of a task or Ctrl-C, takes back what no worker has begun, and
    waits for what one has: afterwards nobody works on. Processes are spawned, not forked, as
    devices do not survive a fork; so a script has to start from ``if __name__ == "__main__"``.
    """
    require_workers(workers)
    results: Iterator[tuple[Task, Result]]
    if workers is None:
        results = ((task, work(task)) for task in tasks)
    elif isinstance(workers, int):
        results = _by_processes(work, tasks, workers)
    else:
        results = _by_executor(work, tasks, *_executor(workers))
    for done, result in enumerate(results, 1):
        if progress is not None:
            progress(done, len(tasks))
        yield result


def _executor(given: Any) -> tuple[Submits, Callable[[], int]]:
    """Return an executor of the standard kind, and what counts its workers."""
    if hasattr(given, "get_executor"):  # dask's client; what is not pure is never left out
        return given.get_executor(pure=False), lambda: sum(given.nthreads().values())
    count = getattr(given, "_max_workers", None) or os.cpu_count() or 1
    return given, lambda: count


def _by_processes(
    work: Callable[[Task], Result], tasks: Sequence[Task], count: int
) -> Iterator[tuple[Task, Result]]:
    """Work in processes of our own, and in others when one of them dies."""
    left, lost = dict(enumerate(tasks)), Counter[int]()
    while left:
        context = multiprocessing.get_context("spawn")
        begun: set[int] = set()
        with ProcessPoolExecutor(count, context, initializer=_leave_interrupts) as pool:
            try:
                for number, result in _numbered(work, left, pool, lambda: count, begun):
                    yield left.pop(number), result
            except BrokenExecutor:
                lost.update(begun & left.keys())
                if max(lost.values()) >= _ATTEMPTS:
                    task = tasks[lost.most_common(1)[0][0]]
                    raise WorkerError(
                        f"expected workers that live, got {_ATTEMPTS} that died over {task}: is "
                        "there memory for so many?"
                    ) from None


def _leave_interrupts() -> None:
    """Let the process that hands out the tasks alone hear Ctrl-C."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _by_executor(
    work: Callable[[Task], Result],
    tasks: Sequence[Task],
    executor: Submits,
    count: Callable[[], int],
) -> Iterator[tuple[Task, Result]]:
    try:
        for number, result in _numbered(work, dict(enumerate(tasks)), executor, count, set()):
            yield tasks[number], result
    except BrokenExecutor as error:
        raise WorkerError(
            f"expected an executor whose workers live, got one that broke ({error}): a number for "
            "workers= has them replaced"
        ) from None


def _numbered(
    work: Callable[[Task], Result],
    tasks: dict[int, Task],
    executor: Submits,
    count: Callable[[], int],
    begun: set[int],
) -> Iterator[tuple[int, Result]]:
    """Yield results by the tasks' numbers, and note those that were handed out in `begun`."""
    waiting, ready = iter(dict(tasks).items()), SimpleQueue[Future[Result]]()
    numbers: dict[Future[Result], int] = {}
    try:
        while True:
            while len(numbers) < max(_WAITING * count(), 1):
                number, task = next(waiting, (None, None))
                if number is None:
                    break
                future = executor.submit(work, task)
                numbers[future] = number
                begun.add(number)
                future.add_done_callback(ready.put)
            if not numbers:
                return
            future = ready.get()
            yield numbers[future], _result(future)
            del numbers[future]
    finally:
        for future in numbers:
            future.cancel()
        for future in numbers:
            # what is begun ends before we leave; how it ends is of no interest any more
            if not future.cancelled():
                future.exception()


def _result(future: Future[Result]) -> Result:
    """Return what a task came to, or raise what it raised."""
    try:
        return future.result()
    except CancelledError:
        raise WorkerError(
            "expected workers that stay, got tasks cancelled by their cluster"
        ) from None
    except Exception as error:
        if type(error).__name__ == "KilledWorker":
            raise WorkerError(f"expected workers that live, got some that died: {error}") from None
        raise
