"""What a kernel does not use is not in its text."""

from __future__ import annotations

import re

import pytest

from generator.emission.kernel_source import emit
from generator.emission.unused import without_unused
from generator.registry.names import variant_named

TEXT = """
namespace {
struct Parameters {
  [[maybe_unused]] static constexpr double R = 1.0;
  [[maybe_unused]] static constexpr double M = 2.0;
};
[[maybe_unused]] inline int both(int a) { return a; }
// Of the outer one.
[[maybe_unused]] inline int inner_only(int a) {
  return a;
}

constexpr int kFirst = 1, kSecond = 2;
constexpr int kTable[2] = {1, 2};
[[maybe_unused]] inline int from_table(int i) { return kTable[i]; }
namespace lanes {
[[maybe_unused]] inline int inner_only(int a) { return both(a); }
[[maybe_unused]] inline int opened_again(int a) { return a; }
int use(int both_of) { return inner_only(both_of) + kSecond + Parameters::R; }
}  // namespace lanes
namespace lanes {
int again(int a) { return opened_again(a) + std::from_table(a); }
}  // namespace lanes
}  // namespace
"""


def test_what_nothing_uses_is_left_out_with_its_comment() -> None:
    text = without_unused(TEXT)
    print(text)
    assert text.count("inner_only(int") == 1 and "Of the outer one" not in text
    assert "both(int a)" in text and "opened_again(int a)" in text and "kFirst = 1" in text
    assert "kTable" not in text and "double R" in text and "double M" not in text
    assert "maybe_unused" not in text


@pytest.mark.parametrize(
    "name",
    [
        "ball-ball/zen3/any/mathavan2014-e1m06-x8f dp54 root=est1 lane_root=est1",
        "ball-ball/zen3/any/pooltool-n1000-x4 fixed",
        "ball-cushion/zen3/any/clamped-e1m06-x1 dp54",
    ],
)
def test_a_kernel_has_neither_the_attribute_nor_macros_that_it_does_not_use(name: str) -> None:
    source = emit(variant_named(name)).source
    macros = set(re.findall(r"#define (\w+)", source))
    unused = [m for m in macros if not re.search(rf"(?<!define )\b{m}\b", source)]
    print(f"{len(source.splitlines())} lines, macros {sorted(macros)}, unused {unused}")
    assert "maybe_unused" not in source and "//@" not in source and not unused
