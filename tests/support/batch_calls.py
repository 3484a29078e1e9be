"""Batch functions called as a user calls them: arrays of doubles, any n, anywhere in memory."""

from __future__ import annotations

import ctypes
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from generator.evidence.verification.errors import Array

_DOUBLES = ctypes.POINTER(ctypes.c_double)
PARAMETERS = (0.028575, 0.170097, 0.2, 0.25, 0.05, 0.93)  # R M u_s1 u_s2 u_b e_b
VELOCITIES = (3, 4, 5, 6, 7, 8, 12, 13, 14, 15, 16, 17)  # of the 18 inputs, as outputs are ordered


@dataclass(frozen=True)
class Outcome:
    """What a call gave: rows of 12 velocities, a status each, and the count it returned."""

    velocities: Array
    status: np.ndarray
    good: int

    def same(self, other: Outcome, rows: slice | np.ndarray = slice(None)) -> bool:
        """Bit for bit, NaN too."""
        mine = np.ascontiguousarray(self.velocities[rows]).view(np.uint64)
        theirs = np.ascontiguousarray(other.velocities[rows]).view(np.uint64)
        return bool((mine == theirs).all() and (self.status[rows] == other.status[rows]).all())


def _pointer(array: np.ndarray) -> ctypes.Array | ctypes._Pointer:
    return array.ctypes.data_as(_DOUBLES)


class BatchFunction:
    """carom_probe_batch of a library; `parameters` where a call names none."""

    def __init__(self, library: Path, parameters: tuple[float, ...] = PARAMETERS) -> None:
        self.parameters = parameters
        self._function = ctypes.CDLL(str(library)).carom_probe_batch
        self._function.restype = ctypes.c_size_t

    def __call__(
        self,
        inputs: Array,
        u_b: Array | None = None,
        offset: int = 0,
        in_place: bool = False,
        parameters: tuple[float, ...] | None = None,
    ) -> Outcome:
        """`inputs`: rows of 18. `offset`: doubles by which every array is off its alignment."""
        n = len(inputs)
        guard, margin = 123.25, 3
        columns = np.full((30, offset + n + margin), guard)
        columns[:18, offset : offset + n] = np.asarray(inputs).T
        given = [columns[j, offset:] for j in range(18)]
        places = [given[j] for j in VELOCITIES] if in_place else list(columns[18:, offset:])
        status = np.full(n + margin, 77, dtype=np.uint8)
        each = None if u_b is None else np.ascontiguousarray(np.append(u_b, [guard] * margin))
        good = self._function(
            (ctypes.c_double * 6)(*(parameters or self.parameters)),
            None if each is None else _pointer(each),
            ctypes.c_size_t(n),
            (_DOUBLES * 18)(*(_pointer(c) for c in given)),
            (_DOUBLES * 12)(*(_pointer(c) for c in places)),
            status.ctypes.data_as(ctypes.c_char_p),
        )
        out = np.array([place[: n + margin] for place in places]).T
        assert (out[n:] == guard).all() and (status[n:] == 77).all(), "written beyond n"
        return Outcome(out[:n].copy(), status[:n].copy(), good)


def inputs_of(cases: Array) -> Array:
    """The 18 inputs of rows of 24, spins scaled so that R w stays what it was."""
    inputs = np.array(cases[:, 6:24])
    scale = (cases[:, 0] / PARAMETERS[0])[:, None]
    inputs[:, 6:9] *= scale
    inputs[:, 15:18] *= scale
    return inputs
