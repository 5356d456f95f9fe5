"""What a check is: a kernel's cases, how it is compared with its reference, and its bounds."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import numpy.typing as npt

from ..device.device import Device

Array = npt.NDArray[Any]
Cases = Callable[[], Mapping[str, Any]]

_LARGEST: Final = float(np.finfo(np.float32).max)


def ulp(values: Any) -> Array:
    """Return the distance from float32 `values` to the next; in float64."""
    size = np.minimum(np.abs(np.asarray(values, np.float64)), _LARGEST)
    return np.spacing(size.astype(np.float32)).astype(np.float64)


def highest_of(values: Any) -> float:
    """Return the largest size among `values`; 0 if there are none."""
    return float(np.nanmax(np.abs(np.asarray(values, np.float64)), initial=0.0))


@dataclass(frozen=True)
class Bound:
    """How far a kernel may be off in one quantity.

    Attributes
    ----------
    quantity : str
        What is compared.
    unit : str
    limit : str
        The bound in words.
    reason : str
        Why rounding comes to this much, and what slack there is.
    """

    quantity: str
    unit: str
    limit: str
    reason: str

    def met_by(self, found: Any, expected: Any, allowed: Any = 0.0) -> Difference:
        """Return how far `found` is from `expected`, where that is most of what is `allowed`.

        No number where none is expected is right; anywhere else it is infinitely wrong.
        """
        found, expected = (np.asarray(each, np.float64) for each in (found, expected))
        if found.size != expected.size:
            return Difference(self, np.inf, 0.0)
        found = found.reshape(expected.shape)
        with np.errstate(invalid="ignore"):  # infinity from infinity
            error = np.where(found == expected, 0.0, np.abs(found - expected))
        error = np.where(np.isnan(found) & np.isnan(expected), 0.0, error)
        error = np.where(np.isnan(error), np.inf, error).ravel()
        if not error.size:
            return Difference(self, 0.0, 0.0)
        allowed = np.nan_to_num(np.broadcast_to(allowed, expected.shape)).ravel()
        shares = np.divide(error, allowed, out=np.where(error > 0, np.inf, 0.0), where=allowed > 0)
        worst = int(np.argmax(shares))
        return Difference(self, float(error[worst]), float(allowed[worst]))

    def met_by_rows(self, found: Array, expected: Array) -> Difference:
        """Return how many rows differ, none of which may; all where there are more or fewer."""
        if found.shape != expected.shape:
            return Difference(self, float(max(len(found), len(expected))), 0.0)
        unlike = (found != expected).any(axis=tuple(range(1, found.ndim)))
        return Difference(self, float(np.count_nonzero(unlike)), 0.0)


@dataclass(frozen=True)
class Difference:
    """A kernel's answer beside its reference's, at the place that is nearest to the bound.

    Attributes
    ----------
    bound : Bound
    error, allowed : float
        In the bound's unit.
    """

    bound: Bound
    error: float
    allowed: float

    @property
    def share(self) -> float:
        """Of what is allowed; the bound is met up to 1."""
        if self.allowed > 0:
            return self.error / self.allowed
        return 0.0 if self.error == 0 else np.inf

    @property
    def is_met(self) -> bool:
        return self.share <= 1.0


@dataclass(frozen=True)
class Check:
    """A kernel against its reference.

    A comparison uploads all that its kernel reads, so that another kernel's fault is not taken for
    its own.

    Attributes
    ----------
    compare : callable
        Takes a case and a device, and yields differences.
    plain : callable
        Returns ordinary cases by name, small enough for the doctor: whatever the kernel is built
        differently for is among them.
    hard : callable, optional
        Returns those that are hard on 32-bit floats, or at the ends of what is allowed.
    """

    compare: Callable[[Any, Device], Iterable[Difference]]
    plain: Cases
    hard: Cases = dict

    @property
    def cases(self) -> dict[str, Any]:
        """All of them, by name."""
        return {**self.plain(), **self.hard()}

    def differences(self, case: str, device: Device) -> list[Difference]:
        """Return what comes of the case of this name."""
        with warnings.catch_warnings():
            # the references overflow where the kernels are not allowed to
            warnings.simplefilter("ignore", RuntimeWarning)
            return list(self.compare(self.cases[case], device))

    def worst(self, device: Device) -> Difference:
        """Return the difference that is nearest to its bound, over the ordinary cases."""
        found = (each for case in self.plain() for each in self.differences(case, device))
        return max(found, key=lambda each: each.share)
