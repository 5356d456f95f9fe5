"""Seconds of device time by stage."""

from __future__ import annotations

from typing import Any


class Timeline:
    """Device time of the launches inside ``with device.timed() as timeline``.

    A stage is a kernel file's stem: ``"hull"``, ``"tessellator"``.
    """

    def __init__(self) -> None:
        self._events: list[tuple[str, Any]] = []

    def add(self, stage: str, event: Any) -> None:
        """Count a launch by its profiling event."""
        self._events.append((stage, event))

    @property
    def launches(self) -> int:
        """How many there were."""
        return len(self._events)

    @property
    def seconds(self) -> dict[str, float]:
        """Sum of kernel times a stage, in order of first launch; waits for them to end."""
        total: dict[str, float] = {}
        for stage, event in self._events:
            event.wait()
            elapsed = (event.profile.end - event.profile.start) * 1e-9
            total[stage] = total.get(stage, 0.0) + elapsed
        return total
