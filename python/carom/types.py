"""Types of what kernels take and give, for signatures. Type checkers read them; nothing is checked
by them at run time, where errors name the argument."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, TypeAlias

import numpy as np
import numpy.typing as npt

__all__ = ["Array", "Ball", "Balls", "Friction", "Normal", "Statuses", "Table"]

Array: TypeAlias = npt.NDArray[np.float64]
Statuses: TypeAlias = npt.NDArray[np.uint8]
_Numbers: TypeAlias = npt.NDArray[np.floating[Any] | np.integer[Any]]
_Row: TypeAlias = Sequence[float] | _Numbers
Ball: TypeAlias = _Numbers | Sequence[_Row]  # 3 by 3; of a cushion 2 by 3
Balls: TypeAlias = _Numbers | Sequence[Ball]  # n of them
Normal: TypeAlias = _Row  # 2
Table: TypeAlias = _Numbers | Sequence[_Row]  # 18 by n, or n by 18; of a cushion 8
Friction: TypeAlias = float | Sequence[float] | _Numbers
