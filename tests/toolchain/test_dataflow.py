"""What llvm-mca is told so that it sees which instruction waits for which."""

from __future__ import annotations

import pytest

from generator.targets.target import find_target
from generator.toolchain.dataflow import explicit
from generator.toolchain.mca import find_mca
from generator.toolchain.replay import replayed_cycles

ROUNDS = 400
CPUS = ("zen3", "zen4", "x86-64-v3", "sapphirerapids")


def cycles_a_round(cpu: str, *instructions: str) -> float:
    if find_mca() is None:
        pytest.skip("no llvm-mca on this machine")
    found = replayed_cycles(instructions * ROUNDS, find_target(cpu)) / ROUNDS
    print(f"{cpu}: {found:.1f} cycles a round of {'; '.join(instructions)}")
    return found


@pytest.mark.parametrize("cpu", CPUS)
def test_a_copy_holds_what_its_original_held(cpu: str) -> None:
    """llvm-mca took %xmm6 for the newer %xmm1, that waits for nothing: 4 cycles instead of 8."""
    chain = cycles_a_round(
        cpu,
        "vfmadd213sd %xmm2, %xmm6, %xmm1",
        "vmovapd %xmm1, %xmm6",
        "vmulsd %xmm5, %xmm5, %xmm1",
        "vfmadd213sd %xmm2, %xmm1, %xmm6",
    )
    assert 7.9 <= chain <= 10.1  # two FMAs


@pytest.mark.parametrize("cpu", CPUS)
def test_a_spilled_value_is_waited_for(cpu: str) -> None:
    """A Zen 4 takes 8.8 cycles for the store and the load and 3 for the product, measured."""
    chain = cycles_a_round(cpu, "vmulsd 24(%rsp), %xmm1, %xmm0", "vmovsd %xmm0, 24(%rsp)")
    elsewhere = cycles_a_round(cpu, "vmulsd 24(%rsp), %xmm1, %xmm0", "vmovsd %xmm0, 32(%rsp)")
    assert 9.9 <= chain <= 14.1
    assert elsewhere < 3


@pytest.mark.parametrize("cpu", CPUS)
def test_a_constant_has_long_been_loaded(cpu: str) -> None:
    chain = cycles_a_round(
        cpu, "vaddsd %xmm1, %xmm0, %xmm0", "vfmadd231sd .LC0(%rip), %xmm2, %xmm0"
    )
    assert chain <= 8.1


def test_each_instruction_stays_one() -> None:
    some = [
        "vmovapd %ymm1, %ymm3",
        "vmovdqa %xmm3, -24(%rbp)",
        "vmovdqa -24(%rbp), %xmm5",
        "vblendvpd %ymm1, -24(%rbp), %ymm3, %ymm1",
        "vaddpd .LC1(%rip){1to8}, %zmm17, %zmm17 {%k1}{z}",
        "vucomisd 8(%rsp), %xmm1",
        "leaq 8(%rsp), %rbp",
        "vmovsd -24(%rbp), %xmm0",
        "vzeroupper",
    ]
    told = explicit(some)
    print("\n".join(told))
    assert len(told) == len(some)
    assert told[1] == "vmovq %xmm3, %r16"
    assert told[2] == "vmovapd -24(%rbp,%r16), %xmm5"
    assert told[4] == "vaddpd %zmm31, %zmm17, %zmm17 {%k1}{z}"
    assert told[7] == some[7], "%rbp is another address now"
