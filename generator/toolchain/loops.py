"""Find the marked loop in assembly text and the straight paths through one trip of it.

A compiler may move arithmetic across the markers of llvm-mca, since they are empty asm statements,
and it may copy them when it unrolls. So the markers only say *which* loop is meant; what is
analysed is the loop itself, from its control flow, and a trip with k markers is k iterations.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, field

RARE = "CAROM-RARE"  # a comment in a block that hardly ever runs: no path goes through it

_LABEL = re.compile(r"^([.\w$@]+):")
_MARK = re.compile(r"LLVM-MCA-(BEGIN|END)[ \t]+(\S+)")
# GCC writes `bne`, Clang `b.ne`.
ARM_CONDITIONS = "eq|ne|cs|hs|cc|lo|mi|pl|vs|vc|hi|ls|ge|lt|gt|le"
_JUMP = re.compile(rf"^(j[a-z]+|b(?:\.?(?:{ARM_CONDITIONS}))?|cbn?z|tbn?z)\s+(.*)$")
_END = re.compile(r"^(ret[a-z]*|ud2|br)\b")
_ALWAYS = ("jmp", "b")
_MAX_PATHS = 4096


@dataclass
class Block:
    """Instructions that run together; `next` are the blocks that can follow."""

    lines: list[str] = field(default_factory=list)
    marks: list[str] = field(default_factory=list)  # names of LLVM-MCA-BEGIN in it
    labels: list[str] = field(default_factory=list)
    rare: bool = False
    jump: str | None = None
    falls: bool = True
    next: list[int] = field(default_factory=list)


@dataclass(frozen=True)
class Path:
    """One way through a trip of the loop."""

    lines: tuple[str, ...]
    iterations: int  # markers of the region met: an unrolled trip has several


@dataclass(frozen=True)
class Loop:
    """A marked loop: the ways from its head back to its head."""

    paths: tuple[Path, ...]
    complete: bool  # were all paths followed?


def parse_blocks(assembly: str) -> list[Block]:
    """Split AT&T x86 or AArch64 assembly into blocks in the order of the text."""
    blocks = [Block()]
    cold = False
    for raw in assembly.splitlines():
        line = raw.strip()
        if (mark := _MARK.search(line)) is not None:
            if mark[1] == "BEGIN":
                blocks[-1].marks.append(mark[2])
            continue
        if RARE in line:
            blocks[-1].rare = True
            continue
        if (label := _LABEL.match(line)) is not None:
            if blocks[-1].lines or blocks[-1].marks or blocks[-1].rare:
                blocks.append(Block(rare=cold))
            blocks[-1].labels.append(label[1])
            continue
        if line.startswith((".section", ".text")):
            cold = ".text.unlikely" in line
            blocks.append(Block(rare=cold))
            continue
        if not line or line[0] in "#./@":
            continue
        code = re.split(r"\s*(?:#|//)\s", line, maxsplit=1)[0].strip()
        blocks[-1].lines.append(code)
        if (jump := _JUMP.match(code)) is not None:
            blocks[-1].jump = jump[2].split(",")[-1].strip()
            blocks[-1].falls = jump[1] not in _ALWAYS
            blocks.append(Block(rare=cold))
        elif _END.match(code):
            blocks[-1].falls = False
            blocks.append(Block(rare=cold))
    _connect(blocks)
    return blocks


def _connect(blocks: list[Block]) -> None:
    place = {label: n for n, block in enumerate(blocks) for label in block.labels}
    for n, block in enumerate(blocks):
        if block.jump in place:
            block.next.append(place[block.jump])
        if block.falls and n + 1 < len(blocks):
            block.next.append(n + 1)


def _component(blocks: list[Block], within: set[int], start: int) -> set[int]:
    """The blocks that `start` reaches and that reach it, staying inside `within`."""

    def reach(edges: dict[int, list[int]]) -> set[int]:
        seen: set[int] = set()
        todo = [start]
        while todo:
            for n in edges.get(todo.pop(), ()):
                if n not in seen:
                    seen.add(n)
                    todo.append(n)
        return seen

    forward = {n: [m for m in blocks[n].next if m in within] for n in within}
    backward: dict[int, list[int]] = {}
    for n, followers in forward.items():
        for m in followers:
            backward.setdefault(m, []).append(n)
    return reach(forward) & reach(backward)


def _head(blocks: list[Block], body: set[int]) -> int:
    """Where the loop is entered from outside, or its first block."""
    entered = {m for n, b in enumerate(blocks) if n not in body for m in b.next if m in body}
    return min(entered, default=min(body))


def _innermost(blocks: list[Block], marked: int) -> tuple[int, set[int]] | None:
    """Head and blocks of the innermost loop around a block."""
    found = None
    within = set(range(len(blocks)))
    while body := _component(blocks, within, marked):
        head = _head(blocks, body)
        found = head, body
        if head == marked:
            break
        within = body - {head}
    return found


def _paths(blocks: list[Block], head: int, body: set[int], region: str) -> Loop:
    usable = {n for n in body if not blocks[n].rare} | {head}
    paths: list[Path] = []
    trail: list[list[int]] = [[head]]
    while trail and len(paths) < _MAX_PATHS:
        route = trail.pop()
        for n in blocks[route[-1]].next:
            if n == head:
                lines = tuple(line for m in route for line in blocks[m].lines)
                paths.append(Path(lines, sum(blocks[m].marks.count(region) for m in route)))
            elif n in usable and n not in route:
                trail.append([*route, n])
    return Loop(tuple(p for p in paths if p.iterations > 0), complete=not trail)


def _in_line(blocks: list[Block], body: set[int]) -> set[int]:
    """The blocks between a loop's first and last line as the compiler laid it out.

    What it thinks unlikely it puts elsewhere, with an unconditional jump back into the middle.
    """
    backward = [(n, m) for n in body for m in blocks[n].next if m in body and m <= n]
    bottoms = [(n, m) for n, m in backward if blocks[n].falls] or backward
    return {k for n, m in bottoms for k in range(m, n + 1)} & body


def marked_loops(assembly: str, region: str) -> list[Loop]:
    """The innermost loops with `LLVM-MCA-BEGIN region` in them, in the order of the text.

    Paths through blocks that the compiler moved out of the way count only where there is no other.
    """
    blocks = parse_blocks(assembly)
    loops: dict[int, Loop] = {}
    for n, block in enumerate(blocks):
        if region in block.marks and (found := _innermost(blocks, n)) is not None:
            head, body = found
            if head not in loops:
                likely = _paths(blocks, head, _in_line(blocks, body) | {head}, region)
                loops[head] = likely if likely.paths else _paths(blocks, head, body, region)
    return [loop for loop in loops.values() if loop.paths]


def marked_text(assembly: str, region: str) -> list[tuple[str, ...]]:
    """What stands between BEGIN and END of a region, for code that is in no loop."""
    regions: list[tuple[str, ...]] = []
    inside: list[str] | None = None
    for raw in assembly.splitlines():
        line = raw.strip()
        mark = _MARK.search(line)
        if mark is not None and mark[2] == region:
            if mark[1] == "END" and inside:
                regions.append(tuple(inside))
            inside = [] if mark[1] == "BEGIN" else None
        elif inside is not None and line and line[0] not in "#./@" and not _LABEL.match(line):
            inside.append(re.split(r"\s*(?:#|//)\s", line, maxsplit=1)[0].strip())
    return regions
