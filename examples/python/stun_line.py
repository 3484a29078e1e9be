"""Where the cue ball goes over the cut angle: a stun shot and a rolling one, a batch of both.

python stun_line.py after `pip install .` in the repository.
"""

from __future__ import annotations

import numpy as np

import carom

R, SPEED = 0.028575, 2.0  # m, m/s


def shots(cuts: np.ndarray, roll: float) -> np.ndarray:
    """Balls in columns: the cue ball runs along y at SPEED and meets the object ball at each cut.

    cuts: angles in rad between the cue ball's path and the line of centres; roll: 1 rolls, 0 stuns.
    """
    balls = np.zeros((18, len(cuts)))
    balls[4] = SPEED
    balls[6] = -roll * SPEED / R
    balls[9], balls[10] = 2 * R * np.sin(cuts), 2 * R * np.cos(cuts)
    return balls


def main() -> None:
    """Print the angle between both paths just after the collision."""
    kernel = carom.Kernel("mathavan2014", max_error=1e-6)
    cuts = np.radians(np.arange(10, 81, 10))
    angles = {}
    for name, roll in (("stun", 0.0), ("roll", 1.0)):
        out, status = kernel.collide_batch(carom.Parameters(R=R), shots(cuts, roll))
        assert (status == carom.Status.OK).all()
        paths = np.arctan2(out[0], out[1]), np.arctan2(out[6], out[7])
        angles[name] = np.degrees(np.abs(paths[0] - paths[1]))
    print(kernel.name)
    print("cut, degrees   stun   roll: degrees between the paths")
    for cut, stun, roll in zip(np.degrees(cuts), angles["stun"], angles["roll"], strict=True):
        print(f"{cut:12.0f} {stun:6.1f} {roll:6.1f}")


if __name__ == "__main__":
    main()
