"""docs/reference.md: interfaces of all languages, from their sources.

python tools/reference_page.py
"""

from __future__ import annotations

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT))

from generator import api  # noqa: E402

PAGE = ROOT / "docs" / "reference.md"
HEAD = """# Reference

Written by `.venv/bin/python tools/reference_page.py` from the header, the stub and the types; a
test compares. SI units, z up. A ball is its position (m), velocity (m/s) and angular velocity
(rad/s): nine numbers, or 3 by 3. A batch in columns has 18 of them, `r1x r1y r1z v1x ... w2z`, and
gives 12, `v1x v1y v1z w1x ... w2z`.

| status | means |
|---|---|
| 0 `OK` | the balls have collided |
| 1 `SEPARATING` | they do not approach each other |
| 2 `BAD_INPUT` | not finite, coincident centres, or a parameter out of range |
| 3 `TILTED` | the line of centres rises by more than 1e-6 of its length |

Anything but `OK` leaves velocities as they came. [Quick start](quick-start.md) shows each language
at work; the generator's own functions are on [another page](api.md).
"""


def _code(language: str, text: str) -> str:
    return f"```{language}\n{text.strip()}\n```\n"


def _header() -> str:
    """What a user of carom.h reads, from the parameters to the functions."""
    text = api.header("any")
    begin = text.index("/* Parameters of the scene")
    found = text[begin : text.index("#ifdef __cplusplus\n}", begin)].replace("CAROM_API ", "")
    return re.sub(r"\n {28,}", "\n" + 18 * " ", found)


def _typed() -> str:
    """What carom.hpp declares; a function's body is no part of it."""
    shared, own = (
        (ROOT / "templates" / room / "typed.hpp.j2").read_text("utf-8")
        for room in ("vendor", "ball_ball")
    )
    text = shared[shared.index("struct Vector {") : shared.index("}  // namespace")]
    text = text.replace("{% include p.typed %}\n", own.split("\n", 2)[2])
    text = re.sub(r"^\{% else %\}\n(.*\n)*?\{% endif %\}\n", "", text, flags=re.MULTILINE)
    text = re.sub(r"^\{%.*%\}\n", "", text, flags=re.MULTILINE)
    text = re.sub(r"^// \{%.*\n", "", text, flags=re.MULTILINE)
    text = text.replace(" {{ p.varied_text }};", " `u_b` may be empty and")
    text = re.sub(
        r"(^inline .*?noexcept) \{(?: [^\n]*|.*?\n)\}$",
        r"\1;",
        text,
        flags=re.MULTILINE | re.DOTALL,
    )
    return re.sub(r"\{\{ [vp]\.prefix \}\}", "carom", text).replace("{{ p.upper }}", "CAROM")


def page() -> str:
    """The text of docs/reference.md."""
    stub = (ROOT / "python" / "carom" / "_carom.pyi").read_text("utf-8").split("\n\n\n", 1)[1]
    types = (ROOT / "js" / "carom.d.mts").read_text("utf-8")
    parts = [
        HEAD,
        "## C: `carom.h`\n",
        _code("c", _header()),
        "## C++17: `carom.hpp`, namespace `carom`\n",
        _code("cpp", _typed()),
        "## Python: `carom`\n",
        "`carom.types` names what is taken: arrays or lists. `carom.columns(ball1, ball2)` makes "
        "columns of two arrays `(n, 3, 3)`.\n",
        _code("python", stub),
        "## JavaScript: `carom.mjs`\n",
        _code("ts", types),
    ]
    return "\n".join(parts)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
