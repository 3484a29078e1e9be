"""The tableaus that there are, by name.

A tableau is data: an impact's exact stepper turns it into statements. To add one: a `Tableau` in
the module of its order; tests check its order conditions and its convergence
(docs/adding-a-stepper.md).
"""

from __future__ import annotations

from .dop853 import DOP853
from .high_orders import HIGH_ORDERS
from .low_orders import LOW_ORDERS
from .tableau import Tableau

TABLEAUS: dict[str, Tableau] = {t.name: t for t in (*LOW_ORDERS, *HIGH_ORDERS, DOP853)}
