"""A shot searched over 102,400 aims with noise: python shot_search.py shot_search.svg

The object ball lies 0.7 m from a pocket and is to be potted with a cut of about 30 degrees; the cue
ball is to come to rest within 0.2 m of a place. A plan is a speed, a spin and an aim; every plan is
played 16 times with the errors of a good player. The picture shows for each speed and spin how
often the best aim does both. Needs `pip install .` in the repository, and NumPy.
"""

from __future__ import annotations

import sys
import time
from pathlib import Path

import numpy as np
import numpy.typing as npt

import carom

Array = npt.NDArray[np.float64]

R, GRAVITY, SLIDING, ROLLING = 0.028575, 9.81, 0.2, 0.01  # m, m/s2, of the cloth
AWAY, POCKET, MOUTH = 1.0, 0.7, 0.032  # m: cue to object ball, on to the pocket, half its opening
CUT = np.radians(30.0)  # from the cue ball's path to the pocket
PLACE, NEAR = np.array([-0.5, 0.5]), 0.2  # m from the object ball, x and y; y is the path
ERRORS = (np.radians(0.08), 0.03, 0.05)  # of a player: direction, of the speed, spin in rolls
SPEEDS = np.linspace(0.4, 1.57, 40)  # m/s, at the object ball
SPINS = np.linspace(-1.0, 1.0, 40)  # 1: the ball rolls; -1: it turns back as fast
AIMS = CUT + np.radians(np.linspace(-5.0, 5.0, 64))  # of the line of centres, throw left for it
TRIES = 16


def balls(speed: Array, spin: Array, aim: Array, rng: np.random.Generator) -> Array:
    """Columns (18, n) of plans with errors: the cue ball touches the object ball at the origin."""
    n = len(speed)
    turned = rng.normal(0.0, ERRORS[0], n)
    offset = np.clip((2 * R * np.sin(aim) - AWAY * turned) / (2 * R), -0.999, 0.999)
    line = np.arcsin(offset)  # of centres, from the path
    speed = speed * (1 + rng.normal(0.0, ERRORS[1], n))
    columns = np.zeros((18, n))
    columns[0], columns[1] = -2 * R * np.sin(line), -2 * R * np.cos(line)
    columns[3], columns[4] = speed * np.sin(turned), speed * np.cos(turned)
    columns[6] = -(spin + rng.normal(0.0, ERRORS[2], n)) * speed / R
    return columns


def rest(velocity: Array, spin: Array) -> Array:
    """How far a ball goes that slides and then rolls to rest; velocities and spins are (2, n)."""
    slip = velocity + R * np.array([-spin[1], spin[0]])  # of its lowest point
    size = np.maximum(np.hypot(*slip), 1e-12)
    sliding = 2 / 7 * size / (SLIDING * GRAVITY)  # seconds
    rolls = velocity - 2 / 7 * slip
    way = velocity * sliding - 0.5 * SLIDING * GRAVITY * sliding**2 * slip / size
    return way + rolls * np.hypot(*rolls) / (2 * ROLLING * GRAVITY)


def successes(kernel: carom.Kernel, speed: Array, spin: Array, aim: Array, seed: int) -> Array:
    """Does each plan, played once, pot the ball and bring the cue ball to its place?"""
    columns = balls(speed, spin, aim, np.random.default_rng(seed))
    out, status = kernel.collide_batch(carom.Parameters(R=R, u_b=0.05), columns)
    goes = np.arctan2(out[6], out[7])
    potted = np.abs(goes - CUT) < np.arctan(MOUTH / POCKET)
    ends = columns[:2] + rest(out[:2], out[3:5])
    near = np.hypot(*(ends - PLACE[:, None])) < NEAR
    return potted & near & (status == carom.Status.OK)


def search(kernel: carom.Kernel) -> Array:
    """How often the plans succeed: (speeds, spins, aims)."""
    shape = len(SPEEDS), len(SPINS), len(AIMS)
    speed, spin, aim = (grid.ravel() for grid in np.meshgrid(SPEEDS, SPINS, AIMS, indexing="ij"))
    total = sum(successes(kernel, speed, spin, aim, seed) for seed in range(TRIES))
    return np.asarray(total, dtype=np.float64).reshape(shape) / TRIES


def picture(chance: Array, told: str) -> str:
    """An SVG of the best aim's chance over speed and spin; it follows the page's light or dark."""
    left, top, side = 70, 50, 12
    width, height = side * len(SPEEDS), side * len(SPINS)
    i, j = np.unravel_index(np.argmax(chance), chance.shape)
    marks = [
        "<style>text{font:15px system-ui,sans-serif;fill:#0f172a}.page{fill:#fff}.best{fill:none;"
        "stroke:#c2410c;stroke-width:3}rect{fill:#1d4ed8}@media (prefers-color-scheme: dark){text{"
        "fill:#e6edf3}.page{fill:#0d1117}rect{fill:#7aa2ff}.best{stroke:#fb923c}}</style>",
        f'<rect class="page" width="{width + 110}" height="{height + 120}"/>',
        f'<text x="{left}" y="28">{told}</text>',
    ]
    for a, b in zip(*np.nonzero(chance), strict=True):
        x, y = left + side * a, top + height - side * (b + 1)
        opacity = f'fill-opacity="{chance[a, b]:.2f}"'
        marks.append(f'<rect x="{x}" y="{y}" width="{side}" height="{side}" {opacity}/>')
    x, y = left + side * int(i), top + height - side * (int(j) + 1)
    marks.append(f'<rect class="best" x="{x}" y="{y}" width="{side}" height="{side}"/>')
    for k in range(0, len(SPEEDS), 13):
        marks.append(f'<text x="{left + side * k}" y="{top + height + 22}">{SPEEDS[k]:.1f}</text>')
    for k, name in ((0, "draw"), (len(SPINS) // 2 - 1, "stun"), (len(SPINS) - 2, "roll")):
        marks.append(f'<text x="18" y="{top + height - side * k}">{name}</text>')
    marks.append(f'<text x="{left}" y="{top + height + 48}">speed at the object ball, m/s</text>')
    box = f'viewBox="0 0 {width + 110} {height + 120}" role="img" aria-label="{told}"'
    return f'<svg xmlns="http://www.w3.org/2000/svg" {box}>\n' + "\n".join(marks) + "\n</svg>\n"


def main(out: Path) -> None:
    """Search, print the best plan and how long it took, and draw."""
    kernel = carom.Kernel("mathavan2014", max_error=1e-3)
    begun = time.perf_counter()
    chance = search(kernel)
    seconds = time.perf_counter() - begun
    i, j, k = np.unravel_index(np.argmax(chance), chance.shape)
    collisions = chance.size * TRIES
    print(f"{chance.size} aims, {collisions} collisions in {seconds:.1f} s; {kernel.name}")
    print(
        f"best: {SPEEDS[i]:.2f} m/s, spin {SPINS[j]:+.2f} of a roll, aim {np.degrees(AIMS[k]):.1f} "
        f"degrees: {chance.max():.0%}"
    )
    told = "How often the best aim pots the ball and leaves the cue ball well"
    out.write_text(picture(chance.max(axis=2), told), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "shot_search.svg"))
