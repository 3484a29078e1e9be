"""Which instructions a kernel executes on real cases: its assembly with a recorder in each block.

A recorder stores the block's number and leaves every register, flag and byte of the stack as it
was, so that the kernel computes what it computes without. There is one for x86-64 and one for
AArch64.
"""

from __future__ import annotations

import re
from collections import OrderedDict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from ..errors import KernelError
from .build import BuildJob
from .compilers import Compiler
from .loops import ARM_CONDITIONS
from .mca import assembly_of

MOST_BLOCKS = 1 << 22  # that one trace holds; 32 collisions in 1000 steps run some 600,000
_LABEL = re.compile(r"^[.\w$@]+:")


@dataclass(frozen=True)
class Recorder:
    """How blocks of an architecture's assembly are told apart, and what is put before each."""

    text: str  # `{number}` is the block's
    asm: str  # what it calls; empty where nothing
    comment: str
    leaves: re.Pattern[str]  # instructions after which control may be elsewhere
    no_work: re.Pattern[str]  # of which llvm-mca knows nothing


# 128 bytes below the stack pointer may hold the kernel's own values (the red zone).
_X86 = """\
 lea -128(%rsp), %rsp
 pushfq
 pushq %rax
 movq carom_trace_at(%rip), %rax
 cmpq carom_trace_end(%rip), %rax
 jae 77f
 movl ${number}, (%rax)
 addq $4, %rax
 movq %rax, carom_trace_at(%rip)
77:
 popq %rax
 popfq
 lea 128(%rsp), %rsp"""

# Short, since TBZ reaches no further than 32 KiB. The number is not executed: the call skips it.
_ARM = """\
 str x30, [sp, #-16]!
 bl carom_record
 .word {number}
 ldr x30, [sp], #16"""

_ARM_CALLED = """\
 .text
 .p2align 2
 .hidden carom_record
 .globl carom_record
 .type carom_record, %function
carom_record:
 stp x14, x15, [sp, #-48]!
 stp x16, x17, [sp, #16]
 mrs x14, nzcv
 str x14, [sp, #32]
 ldr w17, [x30], #4
 adrp x14, carom_trace_at
 ldr x15, [x14, :lo12:carom_trace_at]
 adrp x16, carom_trace_end
 ldr x16, [x16, :lo12:carom_trace_end]
 cmp x15, x16
 b.hs 77f
 str w17, [x15], #4
 str x15, [x14, :lo12:carom_trace_at]
77:
 ldr x14, [sp, #32]
 msr nzcv, x14
 ldp x16, x17, [sp, #16]
 ldp x14, x15, [sp], #48
 ret
"""

RECORDERS = {
    "x86_64": Recorder(
        _X86,
        "",
        "#",
        re.compile(r"^(?:notrack\s+|bnd\s+)?(?:j[a-z]+|loopn?[ez]*|callq?|retq?|ud2)\b"),
        re.compile(r"^(?:callq?|retq?)\b"),
    ),
    "aarch64": Recorder(
        _ARM,
        _ARM_CALLED,
        "//",
        re.compile(rf"^(?:b\.?(?:{ARM_CONDITIONS})?|cbn?z|tbn?z|blr?|br|ret|brk|udf)\b"),
        re.compile(r"^(?:blr?|ret)\b"),
    ),
}

_STORE = f"""\
#include <cstddef>
#include <cstdint>
namespace {{
std::uint32_t blocks[{MOST_BLOCKS}];
}}
extern "C" {{
__attribute__((visibility("hidden"))) std::uint32_t* carom_trace_at = blocks;
__attribute__((visibility("hidden"))) std::uint32_t* carom_trace_end = blocks + {MOST_BLOCKS};
std::size_t carom_trace(const std::uint32_t** first) {{
  *first = blocks;
  return static_cast<std::size_t>(carom_trace_at - blocks);
}}
}}
"""


@dataclass(frozen=True)
class TracedKernel:
    """A library to be built, and the instructions of the blocks that its trace numbers."""

    job: BuildJob
    blocks: tuple[tuple[str, ...], ...]

    def instructions(self, trace: Path) -> list[str]:
        """What ran, one after the other. Raises KernelError where the trace is full or empty."""
        numbers = np.fromfile(trace, dtype=np.uint32)
        if not 0 < len(numbers) < MOST_BLOCKS:
            raise KernelError(f"{self.job.label}: a trace of {len(numbers)} blocks is of no use")
        return [line for n in numbers for line in self.blocks[n]]

    def decoded_again(self, trace: Path, capacity: int) -> int:
        """How many of the instructions that ran a cache of `capacity` decoded ones does not hold.

        It keeps whole blocks, those that ran last; 0 where the capacity is not known.
        """
        if not capacity:
            return 0
        sizes = [len(block) for block in self.blocks]
        kept: OrderedDict[int, None] = OrderedDict()
        held = again = 0
        for number in np.fromfile(trace, dtype=np.uint32).tolist():
            if number in kept:
                kept.move_to_end(number)
                continue
            kept[number] = None
            again += sizes[number]
            held += sizes[number]
            while held > capacity:
                held -= sizes[kept.popitem(last=False)[0]]
        return again


def instrumented(assembly: str, arch: str) -> tuple[str, tuple[tuple[str, ...], ...]]:
    """Assembly (x86: AT&T's) with a recorder before each block, and what stands in the blocks.

    A block ends at a label, a jump, a call or a return. Calls and returns are left out of the
    blocks, and what is called beyond this text is not seen.
    """
    recorder = RECORDERS[arch]
    out: list[str] = []
    blocks: list[list[str]] = []
    begins = True
    for raw in assembly.splitlines():
        code = raw.split(recorder.comment, maxsplit=1)[0].strip()
        if _LABEL.match(code):
            begins = True
        elif code and not code.startswith((".", "#")):
            if begins:
                out.append(recorder.text.format(number=len(blocks)))
                blocks.append([])
            begins = recorder.leaves.match(code) is not None
            if not recorder.no_work.match(code):
                blocks[-1].append(code)
        out.append(raw)
    return "\n".join(out) + "\n", tuple(tuple(block) for block in blocks)


def traced(
    sources: Mapping[str, str],
    adapter: Mapping[str, str],
    compiler: Compiler,
    flags: Iterable[str],
    label: str,
    arch: str = "x86_64",
) -> TracedKernel:
    """The kernel `sources` with recorders; `adapter`: what else its library needs, without them.

    Raises KernelError where the kernel does not compile.
    """
    own: Sequence[str] = tuple(flags)
    text = assembly_of(sources, (), compiler, (*own, "-fPIC"), label)
    marked, blocks = instrumented(text, arch)
    headers = {name: text for name, text in sources.items() if name.endswith(".h")}
    files = {**headers, **adapter, "kernel.s": marked, "trace.cpp": _STORE}
    if called := RECORDERS[arch].asm:
        files["record.s"] = called
    return TracedKernel(BuildJob(f"{label} (traced)", files, compiler, tuple(own)), blocks)
