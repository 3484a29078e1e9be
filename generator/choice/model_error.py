"""How far llvm-mca's cycles are off, as records of CPUs tell: what it cannot tell apart.

`.venv/bin/python -m pytest -s -m long tests/choice/test_model_order.py` prints these figures and
fails where they are no longer true.
"""

from __future__ import annotations

from ..registry.variant import Variant

# By family and "is it a batch?": standard deviation of log(modelled / recorded) over the main job's
# kernels that take at most 1.25 of the fastest recorded, for the contact model where it is larger.
# Records of zen3 (2026-11-29, 30): 0.053, 0.033, 0.038 and 0.087.
_BANDS = {
    ("fixed", False): 0.06,
    ("exact", False): 0.04,
    ("fixed", True): 0.05,
    ("exact", True): 0.09,
}
# The most that modelled / recorded differed between two of a contest's candidates: 1.32 in fixed
# steps, 1.18 exact; in batches 1.27 and 1.29. All on zen3.
MODEL_ERROR = 1.35


def model_band(variant: Variant) -> float:
    """Kernels of one contest whose modelled cycles differ by no more are told apart by nothing."""
    return _BANDS[variant.stepper.family, variant.width > 1]
