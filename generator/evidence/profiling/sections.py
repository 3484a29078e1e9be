"""Which part of a collision each line of a generated kernel belongs to.

Pre-loop: all until the first step. Impulse: slips' lengths, directions and impulses of a step, or
the rates of an exact one. Update: what the loop carries, its control, its ends. Post-loop: from the
impulses to the velocities that the caller gets. Helpers belong to whoever calls them.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

SECTIONS = ("pre-loop", "impulse", "update", "post-loop")
PRE, IMPULSE, UPDATE, POST = SECTIONS

_FUNCTION = re.compile(r"^[A-Za-z_][\w:<>,&* ]*?\b(\w+)\([^;]*$")
_PRE = re.compile(
    r"enter|valid|in_range|finite9|moderate|of_scene|fast_as_scene|contact_friction|parameters_of"
    r"|step|collide_one|begin|complete|step_limit|\w+_collide(?:_steps|_batch)?"
    r"|load_some|read_\w+|friction_of|per_distance_of|contact_of|status_of|take_up|refill"
)
_POST = re.compile(r"leave|copy_\w+|step_level|put_down|store_some|origin_of|after_loops|finish")
_IMPULSE = re.compile(r"rates_at|rates_at_rest|select_rates|tail_rates")
_UPDATE = re.compile(
    r"advance|finish_sticking|remaining_impulse|interpolant|joint_error"
    r"|pass_zero|plan_step|make_steps?|stage_[0-9]+|begin_turn|put_aside|end_turn|step_lanes|step_pair"
    r"|stick_lanes|work_through|step_once|run|halt|stop|push"
    r"|read|ahead|steps_ahead|go_on|after_chatter|collide_block|collide_all"
)
_STEPPED = re.compile(r"iterate\w*|step_pressed")
_LOOP = re.compile(r"^\s*(?:while|for) \(")
# Velocities, slips, work and the count: what a loop carries from one iteration to the next.
_CARRIED = re.compile(
    r"^\s*(?:[vow]\d(?:[xyz]|\[\d\])|s\d(?:[xy]|\[\d\])|c_[xz]|c\[\d\]|v_n|W|W_f|compressed"
    r"|[xz]_lane|[vo]_[xyz](?:\[\d\])?|sum_\w+)\s*(?:=|\+=|-=)[^=]"
)
_CONTROL = re.compile(r"^\s*(?:while|for) \(|\+\+count|compressed|steady|break;")


def sections_of(text: str) -> list[str | None]:
    """The section of each line, first line first; None where the caller's counts."""
    found: list[str | None] = []
    name, loop, inside = "", _Loop(), False
    for line in text.splitlines():
        if not inside and line[:1] not in ("", " ", "#", "/", "}"):
            match = _FUNCTION.match(line)
            name, loop = (match[1], _Loop()) if match else (name, loop)
        found.append(_section(name, line, loop))
        if line.endswith("{") and line[:1] not in ("", "#", "/"):
            inside = inside or not line.startswith("namespace")
        if line.startswith("}"):
            inside, name = False, ""
    return found


class _Loop:
    """Where in a function with a loop the lines stand."""

    def __init__(self) -> None:
        self.indent: int | None = None  # of the loop that is open
        self.seen = False
        self.last: str | None = None
        self.open_statement = False

    def section(self, line: str) -> str | None:
        indent = len(line) - len(line.lstrip())
        if self.indent is None and _LOOP.match(line):
            self.indent, self.seen = indent, True
        if self.indent is None:
            return POST if self.seen and not self._phase(line) else UPDATE if self.seen else PRE
        if line.strip() == "}" and indent == self.indent:
            self.indent = None
            return UPDATE
        if not self.open_statement:
            carried = _CARRIED.match(line) or _CONTROL.search(line)
            self.last = UPDATE if carried else IMPULSE
        code = line.split("//")[0].rstrip()
        self.open_statement = bool(code) and code[-1] not in ";{}:"
        return self.last

    @staticmethod
    def _phase(line: str) -> bool:
        """Between the loops of two phases."""
        return "W_f = " in line


def _section(name: str, line: str, loop: _Loop) -> str | None:
    if not name:
        return None
    if _STEPPED.fullmatch(name):
        return loop.section(line)
    for pattern, section in ((_PRE, PRE), (_POST, POST), (_IMPULSE, IMPULSE), (_UPDATE, UPDATE)):
        if pattern.fullmatch(name):
            return section
    return None


def section_of(frames: Sequence[int], by_line: Sequence[str | None]) -> str | None:
    """The section of an instruction from the lines it was inlined through, innermost first."""
    for line in frames:
        if 0 < line <= len(by_line) and (section := by_line[line - 1]) is not None:
            return section
    return None
