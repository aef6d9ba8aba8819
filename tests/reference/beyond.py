#!/usr/bin/env python3
"""Measured tables with a law outside the program's catalogue, and the stiffness and damping that it truly has.

    python3 tests/reference/beyond.py --out tests/data/free-form
    python3 tests/reference/beyond.py --check

For the free form (docs/free-form.md): one mode, four drive levels, 41 frequencies each, noise of 0.5 % and 0.005 rad. In the units of
oscillators.py,

    u'' + u'/Q + u + g = p cos(W t)

    kind        g                                                       what is missing depends on
    hump        b exp(-((|u| - s)/(s/3))^2) u'                          the amplitude
    sawtooth    a spring whose stiffness is a sawtooth of |u|,          the amplitude
                from -b/2 up to b/2 over every s
    frequency   c(W) u' at one frequency, c a bell over the band        the frequency
                (a linear force, so that its response is exact)

The first two are integrated in time (oscillators.c). Further tables, friction-*.csv, are of the paper's rig (effects.c) at one load, ten
speeds of the roller and 21 frequencies, 0.5 % and 0.005 rad: mu(s) has a hump and a film, so what is missing depends on the speed.
 answers.json holds for every table what it depends on, mass, f0 and Q, and k and c
of g in SI over that variable: its first harmonic over u = a cos t by quadrature. Needs what oscillators.py needs.
"""

import argparse
import cmath
import json
import math
import os
import random

import effects
import oscillators

LEVELS, POINTS, NOISE = 4, 41, 0.005
KINDS = ("hump", "sawtooth", "frequency")
LAWS = {"sawtooth": 4, "hump": 5}


def force(kind, b, s, u, v):
    """g by its formula, written here a second time."""
    if kind == "hump":
        return b * math.exp(-((abs(u) - s) / (s / 3.0)) ** 2) * v
    x = abs(u) / s
    part = x - math.floor(x)
    return math.copysign(0.5 * b * s * (part * part - part), u)


def harmonic(kind, b, s, a, count=4000):
    """k and c of g over u = a cos t at W = 1."""
    k = c = 0.0
    for i in range(count):
        t = 2.0 * math.pi * (i + 0.5) / count
        g = force(kind, b, s, a * math.cos(t), -a * math.sin(t))
        k += 2.0 / count / a * g * math.cos(t)
        c -= 2.0 / count / a * g * math.sin(t)
    return k, c


def bell(b, at, width, W):
    return b * math.exp(-(((W - at) / width) ** 2))


def draw(kind, seed):
    """A table: rows (series, W, p, complex amplitude) in dimensionless units and the truth over its variable."""
    rng = random.Random(f"{kind} {seed}")
    Q = rng.uniform(30.0, 150.0)
    half = 0.5 / Q
    levels = [rng.uniform(2.0, 3.0) ** -i for i in range(LEVELS)][::-1]
    grid = [1.0 + half * (-4.0 + 8.0 * i / (POINTS - 1)) for i in range(POINTS)]
    rows = []
    if kind == "frequency":
        b, at, width = rng.uniform(0.5, 1.5) / Q, 1.0 + rng.uniform(-1.0, 1.0) * half, rng.uniform(1.2, 2.5) * half
        for series, level in enumerate(levels):
            for W in grid:
                p = level / Q
                rows.append((series, W, p, p / (1.0 - W * W + 1j * W * (1.0 / Q + bell(b, at, width, W)))))
        truth = [(W, 0.0, bell(b, at, width, W)) for W in (grid[0] + (grid[-1] - grid[0]) * i / 160 for i in range(161))]
    else:
        s = rng.uniform(0.15, 0.4) if kind == "sawtooth" else rng.uniform(0.2, 0.5)
        b = (rng.uniform(3.0, 6.0) * half if kind == "sawtooth" else rng.uniform(0.8, 2.0) / Q)
        mode = oscillators.Mode(Q, spring=(LAWS[kind], b, s), several=False)
        for series, level in enumerate(levels):
            p = level * (1.0 / Q + (harmonic(kind, b, s, level)[1] if kind == "hump" else 0.0))
            amplitudes, _ = oscillators.sweep(mode, [(W, p) for W in grid])
            rows += [(series, W, p, A) for W, A in zip(grid, amplitudes)]
        low, high = min(abs(r[3]) for r in rows), max(abs(r[3]) for r in rows)
        places = [low * (high / low) ** (i / 160) for i in range(161)]
        truth = [(a, *harmonic(kind, b, s, a)) for a in places]
    return rng, Q, rows, truth


def write(folder, name, kind, seed):
    for attempt in range(20):
        try:
            rng, Q, rows, truth = draw(kind, f"{seed} {attempt}")
            break
        except oscillators.Rejected:
            continue
    mass, f0, X = 10 ** rng.uniform(-3.0, 1.0), 10 ** rng.uniform(0.5, 3.0), 10 ** rng.uniform(-7.0, -3.0)
    mass, f0 = float(f"{mass:.4g}"), float(f"{f0:.5g}")
    w0 = 2.0 * math.pi * f0
    K, C = mass * w0 * w0, mass * w0
    stated = rng.random() < 0.5
    with open(os.path.join(folder, name + ".csv"), "w") as file:
        file.write("series,frequency_hz,force_n,amplitude_m,phase_rad" + (",amplitude_sd_percent,phase_sd_rad\n" if stated else "\n"))
        for series, W, p, A in rows:
            a = abs(A) * X * (1.0 + NOISE * rng.gauss(0.0, 1.0))
            phase = math.remainder(cmath.phase(A) + NOISE * rng.gauss(0.0, 1.0), 2.0 * math.pi)
            tail = f",{100 * NOISE:g},{NOISE:g}" if stated else ""
            file.write(f"{series + 1},{W * f0:.8g},{p * K * X:.7g},{a:.6e},{phase:.5f}{tail}\n")
    unit = f0 if kind == "frequency" else X
    return {
        "kind": kind, "variable": "frequency" if kind == "frequency" else "amplitude", "mass": mass, "f0": f0, "Q": Q,
        "truth": [[float(f"{x:.6g}") for x in (v * unit, k * K, c * C)] for v, k, c in truth],
    }


def write_friction(folder, name, seed):
    """The paper's rig on a roller whose friction has a hump over the slip rate, at the speeds about it."""
    rng = random.Random(f"friction {seed}")
    p = {"delta_mu": rng.uniform(0.1, 0.25), "v_h": 10 ** rng.uniform(-2.3, -1.5), "b": 0.0}
    # Falling friction alone would make the contact squeal.
    p["b"] = 2.2 * p["delta_mu"] / p["v_h"]
    p = {key: float(f"{value:.4g}") for key, value in p.items()}
    load, drive = float(f"{rng.uniform(10.0, 30.0):.3g}"), float(f"{10 ** rng.uniform(-6.0, -5.6):.3g}")
    with open(os.path.join(folder, name + ".csv"), "w") as file:
        file.write("speed_m_s,load_n,drive_m,frequency_hz,amplitude_rad,phase_rad,amplitude_sd_percent,phase_sd_rad\n")
        for i in range(10):
            speed = float(f"{p['v_h'] * 0.3 * 10 ** (i / 9):.4g}")
            for j in range(21):
                frequency = 58.0 + 1.8 * j
                amplitude, phase, _ = effects.beside("hump", p, speed, load, drive, frequency, 1000)
                amplitude *= 1.0 + NOISE * rng.gauss(0.0, 1.0)
                phase += NOISE * rng.gauss(0.0, 1.0)
                file.write(f"{speed},{load},{drive},{frequency:.1f},{amplitude:.6e},{phase:.5f},{100 * NOISE:g},{NOISE:g}\n")


def check():
    """The integration against one harmonic, which the answers are, as Q grows."""
    failed = 0
    for kind, b, s in (("sawtooth", 4.0, 0.3), ("hump", 1.5, 0.4)):
        Q = 5e4
        mode = oscillators.Mode(Q, spring=(LAWS[kind], b / Q, s), several=False)
        points = [(1.0 + d / Q, 1.2 / Q) for d in (-1.5, -0.5, 0.0, 0.5, 1.5)]
        for (W, p), A in zip(points, oscillators.sweep(mode, points)[0]):
            k, c = harmonic(kind, b / Q, s, abs(A))
            left = abs(A * (1.0 - W * W + k + 1j * W * (1.0 / Q + c)) / p - 1.0)
            failed += left > 2e-3
            print(f"{'ok  ' if left <= 2e-3 else 'FAIL'} {kind}, W - 1 = {W - 1.0:+.1e}: one harmonic left {left:.1e}")
    return not failed


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--out", metavar="DIR")
    parser.add_argument("--count", type=int, default=20)
    parser.add_argument("--friction", type=int, default=1)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    if options.check:
        raise SystemExit(0 if check() else 1)
    if not options.out:
        parser.error("--out DIR is needed")
    os.makedirs(options.out, exist_ok=True)
    for number in range(options.friction):
        write_friction(options.out, f"friction-{number + 1}", f"{options.seed} {number}")
    answers = {}
    for number in range(options.count):
        kind = KINDS[number % len(KINDS)]
        name = f"{number + 1:02d}"
        answers[name] = write(options.out, name, kind, f"{options.seed} {number}")
    with open(os.path.join(options.out, "answers.json"), "w") as file:
        json.dump(answers, file)
        file.write("\n")


if __name__ == "__main__":
    main()
