"""Definitions that a kernel does not use: templates have vocabularies, users get what is called.

Templates mark with `[[maybe_unused]]` what a kernel may do without; constants need no mark. What
nothing behind it names is left out, with the comment right above it, and the attribute goes from
all others. A name is looked for as far as the block of its definition reaches; where an inner
namespace defines it anew, it is another.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass

_MARK = "[[maybe_unused]] "
_BEGINS = re.compile(r"^ *(?:\[\[maybe_unused\]\] |constexpr )", re.MULTILINE)
_MEMBER = re.compile(r" +\[\[maybe_unused\]\] static constexpr ")
_DEFINES = r"^ *(?:\[\[maybe_unused\]\] )?(?:constexpr|inline|static|CAROM_)[^\n;({=]*\b%s *[(=[]"
_QUIET = re.compile(r"//[^\n]*|\"[^\"\n]*\"")
_NAMESPACE = re.compile(r"^namespace (\w+) \{", re.MULTILINE)
_VALUE = re.compile(r"(\w+)(?:\[[^\]]*\])*\s*=(?!=)")
_FUNCTION = re.compile(r"(\w+)\(")
_COMMENT = re.compile(r" *//[^@\n][^\n]*\n")
_SIGNS = re.compile(r"[()\[\]{};=]")
_BRACES = re.compile(r"[{}]")
_DEPTH = {"(": 1, "[": 1, "{": 1, ")": -1, "]": -1, "}": -1}


@dataclass
class _Namespace:
    """A part of one: it may be opened again."""

    path: tuple[str, ...]  # its name and those around it, the outermost first
    begin: int
    end: int


class _Text:
    """A text from which definitions are cut, the last one first."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.quiet = _QUIET.sub(lambda m: " " * len(m[0]), text)  # no comments, no strings
        self.namespaces: list[_Namespace] = []
        for found in _NAMESPACE.finditer(self.quiet):
            path = (*self.path(found.start()), found[1])
            self.namespaces.append(_Namespace(path, found.end(), self.close(found.end())))

    def path(self, place: int) -> tuple[str, ...]:
        """The namespaces with names around a place."""
        around = (n.path for n in reversed(self.namespaces) if n.begin < place < n.end)
        return next(around, ())

    def close(self, at: int) -> int:
        """Where the block around a place ends."""
        depth = 1
        for brace in _BRACES.finditer(self.quiet, at):
            depth += _DEPTH[brace[0]]
            if not depth:
                return brace.start()
        return len(self.quiet)

    def end(self, at: int) -> tuple[int, bool]:
        """Where the lines of a definition end, and whether it is one of a value."""
        depth, is_value = 0, False
        for sign in _SIGNS.finditer(self.quiet, at):
            if sign[0] == "{" and not depth and not is_value:
                return self.quiet.find("\n", self.close(sign.end())) + 1, False
            if sign[0] == ";" and not depth:
                return self.quiet.find("\n", sign.end()) + 1, is_value
            is_value |= sign[0] == "=" and not depth
            depth += _DEPTH.get(sign[0], 0)
        return len(self.quiet), is_value

    def cut(self, begin: int, end: int) -> None:
        """Take a definition out, and its comment unless that is on the next one, too."""
        while not _BEGINS.match(self.quiet, end):
            above = self.text.rfind("\n", 0, begin - 1) + 1
            if not _COMMENT.fullmatch(self.text, above, begin):
                break
            begin = above
        self.text, self.quiet = (t[:begin] + t[end:] for t in (self.text, self.quiet))
        for each in self.namespaces:
            each.begin -= (end - begin) * (each.begin > begin)
            each.end -= (end - begin) * (each.end > begin)

    def used(self, begin: int, end: int, name: str, call: str) -> bool:
        """Is a name of the definition from `begin` to `end` used behind it?"""
        whole = len(self.quiet)
        if _MEMBER.match(self.quiet, begin):
            return any(self.places(name, rf"(?:(?<=\.)|(?<=::)){name}\b", end, whole))
        own = self.path(begin)
        if own:
            named = f"{own[-1]}::{name}"
            if any(self.places(named, rf"\b{named}{call}", end, whole)):
                return True
        reach = self.close(end) if self.quiet[begin] == " " else whole
        anew: dict[tuple[str, ...], bool] = {}  # does an inner namespace define the name?
        for place in self.places(name, rf"(?<![\w.:>]){name}{call}", end, reach):
            path = self.path(place)
            inner = [path[:n] for n in range(len(own) + 1, len(path) + 1)]
            for each in inner:
                if each not in anew:
                    anew[each] = self.defines(each, name)
            if path[: len(own)] == own and not any(anew[each] for each in inner):
                return True
        return False

    def places(self, name: str, pattern: str, begin: int, end: int) -> Iterator[int]:
        """Where a pattern matches, which `name` begins: most names stand in few places."""
        compiled, at = re.compile(pattern), self.quiet.find(name, begin, end)
        while at >= 0:
            if compiled.match(self.quiet, at, end):
                yield at
            at = self.quiet.find(name, at + 1, end)

    def defines(self, path: tuple[str, ...], name: str) -> bool:
        defines = re.compile(_DEFINES % name, re.MULTILINE)
        parts = (n for n in self.namespaces if n.path == path)
        return any(defines.search(self.quiet, n.begin, n.end) for n in parts)


def without_unused(text: str) -> str:
    """The text without definitions that nothing uses, and without the attribute."""
    rest = _Text(text)
    for found in reversed(list(_BEGINS.finditer(rest.quiet))):  # what is used is defined before
        end, is_value = rest.end(found.end())
        own = rest.quiet[found.end() : end]
        names = _VALUE.findall(own) if is_value else _FUNCTION.findall(own)[:1]
        call = r"\b" if is_value else r"\("
        if not any(rest.used(found.start(), end, name, call) for name in names):
            rest.cut(found.start(), end)
    return rest.text.replace(_MARK, "")
