"""Recorded x86-64 instructions, written so that llvm-mca sees which of them waits for which.

What ran is simulated as one straight text, of which llvm-mca (14 to 19) mistakes three things:

- **Copies.** Where its model of a CPU makes copies of registers free, a copy stands for whatever
  its original holds when the copy is read. Compilers copy a register just before they overwrite
  it, so chains of results fall apart. Here the two registers change their names in time: what is
  overwritten is always the copy, never the original.
- **The stack.** No load waits for a store, so a value that is spilled in one iteration and loaded
  in the next seems to be there at once. Here a store becomes a move to a register that is part of
  the address of the loads after it: 8 or 9 cycles in all, as CPUs take (measured on a Zen 4: 8.8).
- **Constants.** An operand in memory is loaded when its instruction starts, and that starts no
  earlier than whatever makes its other operands. CPUs have loaded it long before. Here a constant
  is a register that is always there.

Each instruction stays one instruction.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import partial

# Registers and encodings that the text needs, whatever the CPU has; its timing stays its own.
ATTRIBUTES = "-mattr=+egpr,+avx512f,+avx512vl,+avx512dq,+avx512bw"
NEEDS_LLVM = 18  # to read %r16 to %r31

_ADDRESSES = tuple(f"%r{n}" for n in range(16, 32))  # no compiler uses them yet
_VECTOR = re.compile(r"%([xyz])mm(\d+)")
_GENERAL = re.compile(r"%r(?:[a-z]{2}|\d+)$")
_SLOT = re.compile(r"-?[\w.$+]*\((%r\w+)\)$")
_CONSTANT = re.compile(r"[\w.$+-]*\(%r(?:ip|sp|bp)\)(?:\{1to\d+\})?$")
_COPY = re.compile(r"v?mov(?:[au]p[sd]|dq[au]\d*)$")
_COMPARES = re.compile(r"(?:v?u?comis|v?p?test|cmp[bwlq]?$|test)")
_STORE = re.compile(r"v?mov(?:s[sd]|[au]p[sd]|dq[au]\d*|[lq]?)$")
_PACKED = "(?:add|sub|mul|div|min|max|sqrt)[sp][sd]|fn?m(?:add|sub)(?:132|213|231)[sp][sd]"
_BITS = "andn?p[sd]|x?orp[sd]|unpck[lh]p[sd]"
# What can be written with the registers of AVX-512 too, in the same words.
_ARITHMETIC = re.compile(rf"v(?:{_PACKED}|{_BITS}|u?comis[sd])$")
_MOVES = r"mov(?:s[sd]|[au]p[sd]|dq[au]\d*|ddup|[dql])?|broadcasts[sd]"
_LOADS = re.compile(rf"v?(?:{_PACKED}|{_BITS}|u?comis[sd]|{_MOVES})$")
_IMPLICIT = (
    "blendvp",
    "pblendvb",
)  # read %xmm0, whose name must stay; no free copies where they run


@dataclass(frozen=True)
class _Instruction:
    text: str
    op: str
    operands: tuple[str, ...]

    @property
    def writes_last(self) -> bool:
        return bool(self.operands) and _COMPARES.match(self.op) is None

    @property
    def written_vector(self) -> str:
        """The number of the vector register that it writes, or nothing."""
        found = _VECTOR.match(self.operands[-1]) if self.writes_last else None
        return found[2] if found else ""

    @property
    def copied(self) -> str:
        """The number of the vector register of which it makes a copy, or nothing."""
        if len(self.operands) != 2 or not _COPY.match(self.op) or not self.written_vector:
            return ""
        found = _VECTOR.fullmatch(self.operands[0])
        return found[2] if found and found[2] != self.written_vector else ""


def explicit(instructions: Sequence[str]) -> list[str]:
    """The same instructions as llvm-mca must read them, with `ATTRIBUTES`."""
    known: dict[str, _Instruction] = {}
    parse = partial(_parsed, known)
    implicit = any(text.startswith(_IMPLICIT) for text in set(instructions))
    texts = instructions if implicit else _with_copies(map(parse, instructions))
    told = _with_slots(texts, parse)
    return _with_constants(told, parse)


def _parsed(known: dict[str, _Instruction], text: str) -> _Instruction:
    if (found := known.get(text)) is None:
        op, _, rest = text.replace("\t", " ").partition(" ")
        operands = re.split(r",\s*(?![^(]*\))", rest.strip()) if rest.strip() else []
        found = known[text] = _Instruction(text, op, tuple(operands))
    return found


class _Names:
    """Which name each vector register has; `originals` and `copies` are names."""

    def __init__(self) -> None:
        self.name = {str(n): str(n) for n in range(32)}
        self.register = dict(self.name)
        self.original: dict[str, str] = {}  # of a copy
        self.copies: dict[str, list[str]] = {}

    def before_write(self, register: str) -> None:
        """Gives the register a name of which there is no copy; both hold the same value."""
        name = self.name[register]
        if copies := self.copies.get(name):
            copy, other = copies[0], self.register[copies[0]]
            self.name[register], self.name[other] = copy, name
            self.register[copy], self.register[name] = register, other
            name = copy
        if (original := self.original.pop(name, None)) is not None:
            self.copies[original].remove(name)

    def copied(self, source: str, register: str) -> bool:
        """Notes a copy. False where the two may not change their names: some instructions know
        only the first 16 registers."""
        name, copy = self.name[source], self.name[register]
        if (int(name) < 16) != (int(copy) < 16):
            return False
        original = self.original.get(name, name)
        self.original[copy] = original
        self.copies.setdefault(original, []).append(copy)
        return True

    def renamed(self, text: str) -> str:
        return _VECTOR.sub(lambda m: f"%{m[1]}mm{self.name[m[2]]}", text)


def _with_copies(instructions: Iterable[_Instruction]) -> list[str]:
    """The instructions with no original overwritten while a copy of it is in use."""
    names, told = _Names(), []
    for each in instructions:
        if register := each.written_vector:
            names.before_write(register)
        text = names.renamed(each.text)
        if (source := each.copied) and not names.copied(source, register):
            text = names.renamed("vorpd {0}, {0}, {1}".format(*each.operands))
        told.append(text)
    return told


def _with_slots(texts: Iterable[str], parse: partial[_Instruction]) -> list[str]:
    """The instructions with loads that wait for the latest store to the same place.

    The same place: the same words, the registers in it unchanged. No more than the last few
    stores are known, what is older has long been there.
    """
    slots: dict[str, str] = {}  # the register that stands for what was stored, the oldest first
    told = []
    for text in texts:
        each = parse(text)
        place = each.operands[-1] if each.operands else ""
        if _is_store(each):
            register = slots.pop(place, "") or _free(slots)
            slots[place] = register
            text = _to_address(each, register)
        elif loaded := _loaded(each, slots):
            text = re.sub(r"^vmovdq([au])\b", r"vmov\1pd", text)
            text = text.replace(loaded, f"{loaded[:-1]},{slots[loaded]})")
        elif each.writes_last:
            slots.pop(place, None)  # stored in a way that is not followed
        told.append(text)
        if each.writes_last and _GENERAL.match(place):
            for slot in [s for s in slots if s.endswith(f"({place})")]:
                del slots[slot]
    return told


def _is_store(each: _Instruction) -> bool:
    if len(each.operands) != 2 or not _STORE.match(each.op) or not _SLOT.match(each.operands[1]):
        return False
    source = each.operands[0]
    return _VECTOR.fullmatch(source) is not None or _GENERAL.match(source) is not None


def _free(slots: dict[str, str]) -> str:
    unused = [register for register in _ADDRESSES if register not in slots.values()]
    return unused[0] if unused else slots.pop(next(iter(slots)))


def _to_address(each: _Instruction, register: str) -> str:
    source = each.operands[0]
    if (vector := _VECTOR.fullmatch(source)) is None:
        return f"movq {source}, {register}"
    return f"{'v' * each.op.startswith('v')}movq %xmm{vector[2]}, {register}"


def _loaded(each: _Instruction, slots: dict[str, str]) -> str:
    if not _LOADS.match(each.op):
        return ""
    return next((place for place in each.operands if place in slots), "")


def _with_constants(texts: Sequence[str], parse: partial[_Instruction]) -> list[str]:
    """The instructions with a register that nothing else uses where an operand is constant."""
    used = {found[2] for text in set(texts) for found in _VECTOR.finditer(text)}
    free = next((n for n in range(31, -1, -1) if str(n) not in used), None)
    if free is None:
        return list(texts)
    told = []
    for text in texts:
        each = parse(text)
        if _ARITHMETIC.match(each.op) and _CONSTANT.match(each.operands[0]):
            kind = _VECTOR.match(each.operands[-1])
            if kind is not None:
                text = text.replace(each.operands[0], f"%{kind[1]}mm{free}")
        told.append(text)
    return told
