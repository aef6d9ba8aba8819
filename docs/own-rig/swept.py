#!/usr/bin/env python3
"""Makes swept.csv: a hardening oscillator swept up and down at four drives, integrated in time by `tests/reference`.

    python3 docs/own-rig/swept.py      # writes the table beside this file; needs Python 3.9 or later and cc
"""

import pathlib
import random
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "tests/reference"))

import oscillators  # noqa: E402

RESONANCE = 38.0  # Hz
QUALITY = 110.0
HARDENING = 0.235  # K_3 X^2/K, X about the largest motion
READING = 193.0  # mV at the motion X
NOISE = 0.005
LEVELS = {"1": (0.5, 40.0), "2": (1.0, 40.0), "3": (1.5, 41.5), "4": (2.0, 43.0)}  # drive in V, last frequency in Hz
FIRST, STEP = 37.0, 0.1  # Hz


def rows():
    rng = random.Random(1)
    mode = oscillators.Mode(QUALITY, kappa=HARDENING)
    for level, (drive, last) in LEVELS.items():
        up = [FIRST + STEP * i for i in range(round((last - FIRST) / STEP) + 1)]
        force = drive / 2.0 / QUALITY
        for way, frequencies in (("up", up), ("down", up[::-1])):
            amplitudes, _ = oscillators.sweep(mode, [(f / RESONANCE, force) for f in frequencies])
            for f, amplitude in zip(frequencies, amplitudes):
                reading = READING * abs(amplitude) * (1.0 + NOISE * rng.gauss(0.0, 1.0))
                yield f"{level} {way}", way, f"{f:.1f}", f"{drive:g}", f"{reading:.5g}"


def main():
    lines = ["series;sweep;f (Hz);drive (V);amplitude (mV)"]
    lines += [";".join(cell.replace(".", ",") for cell in row) for row in rows()]
    (HERE / "swept.csv").write_text("\n".join(lines) + "\n", encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
