# Made by nanobind: python tools/stubs.py. Signatures and texts are in _carom.cpp.
from collections.abc import Sequence
import enum
from typing import overload

import carom.types


version: str = '0.1.0'

class Status(enum.IntEnum):
    """
    What became of a collision; anything but OK leaves velocities as they came.
    """

    OK = 0
    """they have collided"""

    SEPARATING = 1
    """they do not approach each other"""

    BAD_INPUT = 2
    """
    not finite, coincident centres, no normal, or a friction of a batch out of range
    """

    TILTED = 3
    """the line of centres rises by more than 1e-6 of its length"""

class Parameters:
    """
    What a collision is given besides the balls: radius R (m) and mass M (kg) of both, sliding
    friction u_s1 of ball 1 and u_s2 of ball 2 with the table, friction u_b and restitution e_b
    between the balls, each from 0 to 1. M1 is the mass of ball 1 where it is another than M, from
    a tenth of M to ten times as much; it is for kernels with max_error of the models mathavan2014
    and bottom_slip, whose batches then go call by call. ValueError names a number that is out of
    its range. Parameters do not change; they compare, hash, copy and pickle by value.
    """

    def __init__(self, R: float = 0.028575, M: float = 0.170097, u_s1: float = 0.2, u_s2: float = 0.2, u_b: float = 0.05, e_b: float = 0.95, *, M1: float | None = None) -> None: ...

    @property
    def R(self) -> float:
        """radius of both balls, m"""

    @property
    def M(self) -> float:
        """mass of both balls, or of ball 2, kg"""

    @property
    def M1(self) -> float:
        """mass of ball 1, kg"""

    @property
    def u_s1(self) -> float:
        """sliding friction of ball 1 and the table"""

    @property
    def u_s2(self) -> float:
        """sliding friction of ball 2 and the table"""

    @property
    def u_b(self) -> float:
        """friction between the balls"""

    @property
    def e_b(self) -> float:
        """restitution between the balls"""

    def replace(self, *, R: float = ..., M: float = ..., u_s1: float = ..., u_s2: float = ..., u_b: float = ..., e_b: float = ..., M1: float = ...) -> Parameters:
        """The same with some numbers replaced."""

    def __replace__(self, **changes: float) -> Parameters: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> tuple[list[float], float]: ...

    def __setstate__(self, arg: tuple[Sequence[float], float], /) -> None: ...

    def __repr__(self) -> str: ...

class Kernel:
    """
    A collision kernel, chosen by contact model and by error budget or number of steps.

    model: mathavan2014, bottom_slip or pooltool. max_error: budget relative to the relative
    speed of the balls (default 1e-6); the fastest kernel that keeps it is taken. steps:
    instead of a budget, N of the fixed-step scheme of pooltool, 1 to 100000000. target:
    the CPU whose code runs, as x86-64-v3 or armv8; by default the best that this one runs.
    Raises ValueError naming what there is, RuntimeError where the CPU lacks the target.
    Kernels compare, hash, copy and pickle by what they were asked for.
    """

    def __init__(self, model: str = 'mathavan2014', *, max_error: float | None = None, steps: int | None = None, target: str | None = None) -> None: ...

    def collide(self, parameters: Parameters, ball1: carom.types.Ball, ball2: carom.types.Ball) -> tuple[carom.types.Array, carom.types.Array, Status]:
        """
        One collision: (ball1, ball2, status). A ball is 3 by 3 numbers, an array or lists:
        position (m), velocity (m/s), angular velocity (rad/s), z up. What came in is left as
        it is. Anything but status OK leaves velocities as they came. The interpreter lock is
        released for 10000 steps and more.
        """

    def collide_into(self, parameters: Parameters, ball1: carom.types.Ball, ball2: carom.types.Ball, out1: carom.types.Array, out2: carom.types.Array) -> Status:
        """
        As collide, into float64 arrays (3, 3) of the caller's, which may be those that come in.
        """

    @overload
    def collide_batch(self, parameters: Parameters, balls: carom.types.Table, *, u_b: carom.types.Friction | None = None, out: carom.types.Array | None = None, status: carom.types.Statuses | None = None) -> tuple[carom.types.Array, carom.types.Statuses]:
        """
        n collisions: (out, status). balls: numbers of shape (18, n), rows r1x to w2z, or (n, 18);
        out: (12, n), rows v1x to w2z, or (n, 12); status: uint8 of n. 18 by 18 numbers are taken
        as (18, n). u_b: friction of all, or of each collision. out and status may be given.
        Columns that are contiguous are not copied, all others are in blocks. The interpreter lock
        is released meanwhile. Batches go in lanes (other numbers of steps than 1000: call by call):
        as exact as collide, though rounded otherwise; what a collision gives depends on itself
        alone, to the last bit. The kernel keeps the memory of the results that were dropped last
        for those of the next batch, as long as it lives itself; a result holds its own size alone.
        """

    @overload
    def collide_batch(self, parameters: Parameters, ball1: carom.types.Balls, ball2: carom.types.Balls, *, u_b: carom.types.Friction | None = None, status: carom.types.Statuses | None = None) -> tuple[carom.types.Array, carom.types.Array, carom.types.Statuses]:
        """
        n collisions of two arrays (n, 3, 3) of balls, as collide takes them: (ball1, ball2, status).
        """

    @property
    def model(self) -> str:
        """the contact model"""

    @property
    def target(self) -> str:
        """the CPU whose code runs"""

    @property
    def name(self) -> str:
        """in the grammar of kernel names"""

    @property
    def lanes(self) -> int:
        """collisions that a vector of collide_batch holds"""

    @property
    def steps(self) -> int | None:
        """N, or None"""

    @property
    def max_error(self) -> float | None:
        """the budget that the kernel keeps, or None"""

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> tuple[str, float | None, int | None, str | None]: ...

    def __setstate__(self, arg: tuple[str, float | None, int | None, str | None], /) -> None: ...

    def __repr__(self) -> str: ...

class CushionParameters:
    """
    What an impact on a cushion is given besides the ball: its radius R (m) and mass M (kg),
    sliding friction u_s with the table, friction u_w and restitution e_c with the cushion, each
    from 0 to 1, and the height h (m) of the cushion's nose above the table, from R to below 2 R.
    The nose's angle above the centre, asin(h/R - 1), and atan u_s and atan u_w are below 90
    degrees together: else compression need not end. ValueError names a number that is out of
    its range. Parameters do not change; they compare, hash, copy and pickle by value.
    """

    def __init__(self, R: float = 0.028575, M: float = 0.170097, u_s: float = 0.2, u_w: float = 0.2, e_c: float = 0.85, h: float = 0.036576) -> None: ...

    @property
    def R(self) -> float:
        """radius of the ball, m"""

    @property
    def M(self) -> float:
        """mass of the ball, kg"""

    @property
    def u_s(self) -> float:
        """sliding friction of the ball and the table"""

    @property
    def u_w(self) -> float:
        """friction of the ball and the cushion"""

    @property
    def e_c(self) -> float:
        """restitution between the ball and the cushion"""

    @property
    def h(self) -> float:
        """height of the cushion's nose above the table, m"""

    def replace(self, *, R: float = ..., M: float = ..., u_s: float = ..., u_w: float = ..., e_c: float = ..., h: float = ...) -> CushionParameters:
        """The same with some numbers replaced."""

    def __replace__(self, **changes: float) -> CushionParameters: ...

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> list[float]: ...

    def __setstate__(self, arg: Sequence[float], /) -> None: ...

    def __repr__(self) -> str: ...

class CushionKernel:
    """
    A kernel of impacts on a cushion, chosen by contact model and by error budget or number of
    steps.

    model: clamped, printed or pooltool. max_error: budget relative to the ball's speed (default
    1e-6); the fastest kernel that keeps it is taken; pooltool has none. steps: instead of a
    budget, max_steps of the fixed-step scheme of pooltool, 1 to 100000000. target: the CPU
    whose code runs, as x86-64-v3 or armv8; by default the best that this one runs.
    Raises ValueError naming what there is, RuntimeError where the CPU lacks the target.
    Kernels compare, hash, copy and pickle by what they were asked for.
    """

    def __init__(self, model: str = 'clamped', *, max_error: float | None = None, steps: int | None = None, target: str | None = None) -> None: ...

    def collide(self, parameters: CushionParameters, ball: carom.types.Ball, normal: carom.types.Normal) -> tuple[carom.types.Array, Status]:
        """
        One impact: (ball, status). A ball is 2 by 3 numbers, an array or lists: velocity (m/s) and
        angular velocity (rad/s), z up. The normal is 2: level, into the cushion, of any length. What
        came in is left as it is. Anything but status OK leaves velocities as they came.
        """

    @overload
    def collide_batch(self, parameters: CushionParameters, columns: carom.types.Table, *, u_w: carom.types.Friction | None = None, out: carom.types.Array | None = None, status: carom.types.Statuses | None = None) -> tuple[carom.types.Array, carom.types.Statuses]:
        """
        n impacts: (out, status). columns: numbers of shape (8, n), rows vx to wz, nx, ny, or (n, 8);
        out: (6, n), rows vx to wz, or (n, 6); status: uint8 of n. 8 by 8 numbers are taken as (8, n).
        u_w: friction of all, or of each impact. out and status may be given. The interpreter lock is
        released meanwhile. What an impact gives depends on itself alone, to the last bit.
        """

    @overload
    def collide_batch(self, parameters: CushionParameters, balls: carom.types.Balls, normals: carom.types.Table, *, u_w: carom.types.Friction | None = None, status: carom.types.Statuses | None = None) -> tuple[carom.types.Array, carom.types.Statuses]:
        """
        n impacts of an array (n, 2, 3) of balls, as collide takes them, with normals (n, 2): (balls,
        status).
        """

    @property
    def model(self) -> str:
        """the contact model"""

    @property
    def target(self) -> str:
        """the CPU whose code runs"""

    @property
    def name(self) -> str:
        """in the grammar of kernel names"""

    @property
    def lanes(self) -> int:
        """collisions that a vector of collide_batch holds"""

    @property
    def steps(self) -> int | None:
        """N, or None"""

    @property
    def max_error(self) -> float | None:
        """the budget that the kernel keeps, or None"""

    def __eq__(self, other: object, /) -> bool: ...

    def __hash__(self) -> int: ...

    def __getstate__(self) -> tuple[str, float | None, int | None, str | None]: ...

    def __setstate__(self, arg: tuple[str, float | None, int | None, str | None], /) -> None: ...

    def __repr__(self) -> str: ...
