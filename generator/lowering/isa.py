"""What an instruction set gives to emitted code: pragmas, estimates, 128-bit lanes."""

from __future__ import annotations

import re
from dataclasses import dataclass

from ..targets.target import FRSQRTE_ERROR, RSQRT14_ERROR, RSQRTSS_ERROR, Target

# Features that compilers take by name in a target pragma, in a fixed order.
_PRAGMA_FEATURES = (
    "sse3",
    "ssse3",
    "sse4.1",
    "sse4.2",
    "popcnt",
    "avx",
    "avx2",
    "fma",
    "f16c",
    "bmi",
    "bmi2",
    "avx512f",
    "avx512vl",
    "avx512dq",
    "avx512bw",
    "avx512cd",
)


# Intrinsics whose results a specification leaves open; it does not for NEON's vrsqrte.
_OPEN = re.compile(r"\b_mm\w*_(?:rsqrt|rcp)\w*(?=\()")
_COMMENT = re.compile(r"//[^\n]*")


@dataclass(frozen=True)
class Estimate:
    """How a scalar reciprocal square root is estimated."""

    text: str
    scalar: tuple[str, ...]
    newton: int
    relative_error: float


def compiled_features(target: Target) -> tuple[str, ...]:
    """What code for a target may use beyond its architecture's baseline."""
    if target.row.arch != "x86_64":
        return ()
    return tuple(feature for feature in _PRAGMA_FEATURES if target.has(feature))


def pragma_target(target: Target) -> str:
    """Comma-separated features for a target pragma; empty where none is needed."""
    return ",".join(compiled_features(target))


def pragmas(target: Target, contract: bool) -> tuple[str, str]:
    """Lines that begin and end code for a target, so that a user needs no compiler flags.

    They also decide on contraction: compilers never fuse a product and a sum unseen. GCC 12.2 does
    so even with contraction off where its SLP vectoriser meets an alternating sum (bug 106902), so
    that is off too then.
    """
    features = pragma_target(target)
    off = "fast" if contract else "off"
    clang = [f"#pragma clang fp contract({off})"]
    optimize = f'"fp-contract={off}"' + ("" if contract else ', "no-tree-slp-vectorize"')
    gcc = ["#pragma GCC push_options", f"#pragma GCC optimize({optimize})"]
    clang_end, gcc_end = [], ["#pragma GCC pop_options"]
    if features:
        gcc.append(f'#pragma GCC target("{features}")')
        attribute = f'__attribute__((target("{features}")))'
        clang.append(f"#pragma clang attribute push({attribute}, apply_to = function)")
        clang_end = ["#pragma clang attribute pop"]
    begin = ["#if defined(__clang__)", *clang, "#elif defined(__GNUC__)", *gcc, "#endif"]
    end = ["#if defined(__clang__)", *clang_end, "#elif defined(__GNUC__)", *gcc_end, "#endif"]
    return "\n".join(begin), "\n".join(end)


_ARCHITECTURES = {  # what compilers define for it, and its name in an error
    "x86_64": ("__x86_64__", "x86-64"),
    "aarch64": ("__aarch64__", "64-bit ARM"),
    "wasm32": ("__wasm__", "WebAssembly"),
}


def refusal(target: Target) -> tuple[str, str]:
    """When code for a target cannot be compiled, as a condition, and what an error says then."""
    macro, name = _ARCHITECTURES[target.row.arch]
    unfit = f"!(defined(__GNUC__) || defined(__clang__)) || !defined({macro})"
    return unfit, f"This is for {name}, and for GCC or Clang (on Windows: clang-cl, MinGW)."


def root_itself(real: str, newton: int = 0) -> Estimate:
    """In place of an estimate: the same on every CPU, since IEEE 754 says what it is."""
    one, error = ("1.0f", 2.0**-23) if real == "float" else ("1.0", 2.0**-52)
    return Estimate("the root itself", (f"return {one} / std::sqrt(n);",), newton, error)


def estimate(target: Target, newton: int) -> Estimate:
    """The best scalar estimate that a target has."""
    if target.has("avx512f"):
        line = "return _mm_cvtsd_f64(_mm_rsqrt14_sd(_mm_setzero_pd(), _mm_set_sd(n)));"
        return Estimate("vrsqrt14sd (2^-14)", (line,), newton, RSQRT14_ERROR)
    if target.has("sse2"):
        lines = (
            "const __m128 low = _mm_cvtsd_ss(_mm_setzero_ps(), _mm_set_sd(n));",
            "return static_cast<double>(_mm_cvtss_f32(_mm_rsqrt_ss(low)));",
        )
        return Estimate("rsqrtss (1.5 * 2^-12)", lines, newton, RSQRTSS_ERROR)
    if target.has("neon"):
        return Estimate("frsqrte (2^-8)", ("return vrsqrted_f64(n);",), newton, FRSQRTE_ERROR)
    return root_itself("double", newton)


def float_estimate(target: Target, newton: int, lanes: bool = False) -> Estimate:
    """The best estimate in float arithmetic that a target has; `lanes`: that its vectors have."""
    if lanes and target.has("avx512vl"):
        return Estimate("vrsqrt14ps (2^-14)", (), newton, RSQRT14_ERROR)
    if target.has("sse2"):
        line = "return _mm_cvtss_f32(_mm_rsqrt_ss(_mm_set_ss(n)));"
        return Estimate("rsqrtss (1.5 * 2^-12)", (line,), newton, RSQRTSS_ERROR)
    if target.has("neon"):
        return Estimate("frsqrte (2^-8)", ("return vrsqrtes_f32(n);",), newton, FRSQRTE_ERROR)
    return root_itself("float", newton)


def pair_root(target: Target, method: str) -> tuple[str, ...]:
    """Lines of pair_rsqrt: `n` in, the two inverse roots out, 0 for 0."""
    newton = int(method[-1]) if method.startswith("est") else 0
    if not newton or not target.has("sse2"):
        return ("return Pair{exact_rsqrt(n[0]), exact_rsqrt(n[1])};",)
    check = (
        "if (__builtin_expect(!(n[0] > kEstimateLow && n[0] < kEstimateHigh && "
        "n[1] > kEstimateLow && n[1] < kEstimateHigh), 0)) {",
        "return Pair{exact_rsqrt(n[0]), exact_rsqrt(n[1])};",
        "}",
    )
    if target.has("avx512vl"):
        first = "Pair y = _mm_rsqrt14_pd(n);"
    else:
        first = "Pair y = _mm_cvtps_pd(_mm_rsqrt_ps(_mm_cvtpd_ps(n)));"
    steps = ("y = y + 0.5 * y * (1.0 - n * y * y);",) * newton
    return (*check, first, *steps, "return y;")


def pair_fma(target: Target) -> str:
    return "_mm_fmadd_pd" if target.has("fma") and target.row.arch == "x86_64" else ""


def intrinsics_headers(target: Target) -> tuple[str, ...]:
    headers = {"x86_64": ("immintrin.h",), "aarch64": ("arm_neon.h",)}
    return headers.get(target.row.arch, ())


def estimates_in(text: str) -> frozenset[str]:
    """The intrinsics in a kernel's text whose results differ from one maker's CPUs to another's."""
    return frozenset(_OPEN.findall(_COMMENT.sub("", text)))


def estimates_line(text: str) -> str:
    """What a kernel's header says of the estimates in its text; empty where there are none."""
    found = estimates_in(text)
    bounds = {"rsqrt14": "vrsqrt14 to 2^-14", "rsqrt_": "rsqrt to 1.5 * 2^-12"}
    says = [bound for part, bound in bounds.items() if any(part in name for name in found)]
    if not says:
        return ""
    return (
        f"Root estimates, which differ between CPUs: {' and '.join(says)}. What is chosen has held "
        "with estimates off by all of that, in several patterns, too (docs/accuracy.md)."
    )
