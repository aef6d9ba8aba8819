#!/usr/bin/env python3
"""Measured tables of bare oscillators with planted effects, integrated in time by a separate program.

    python3 tests/reference/oscillators.py --out DIR --seed 1 --count 64
    python3 tests/reference/oscillators.py --out DIR --seed 1 --count 80 --kind random
    python3 tests/reference/oscillators.py --out DIR --seed 1 --count 70 --kind further
    python3 tests/reference/oscillators.py --check

The rig is one mode (SI units; an angle and a torque take the place of displacement and force in some tables):

    M x'' + C x' + K x + g(x, x', history) = f cos(w t),   K = M (2 pi f0)^2,  C = 2 pi f0 M/Q

    effect             g
    (none)             0
    cubic-stiffness    K_3 x^3                      softening K_3 < 0, hardening K_3 > 0
    quadratic-damping  D_2 |x'| x'
    friction-joint     slip elements in parallel from the mass to ground whose monotonic force is
                       F_s [1 - (1 - x/x_m)^n],  x_m = n F_s/k_t;  n = 1 is one Jenkins element
    clearance          k_g sign(x) max(0, |x| - g)
    quintic-stiffness  K_5 x^5                      softening or hardening
    asymmetric-stiffness  K_2 x^2                   either sign
    power-damping      D |x'|^p sign(x')
    pivot-friction     one Jenkins element of 20 000 K, which slips at once
    residual-modes     reading + (R_c + R_m/w^2) f
    (outside)          what the program's catalogue does not hold; see OUTSIDE
    base drive         f = -M y''; the table states the amplitude of y'' and x is relative to the base.
                       Phases are relative to y'', so the force's sign adds pi.

It is solved in the units that the oscillator itself gives, u = x/X with X about the largest motion, t in 1/(2 pi f0):

    u'' + u'/Q + u + kappa u^3 + d |u'| u' + sum_i k_i clip(u - z_i, -y_i, y_i) + s(u) = p cos(W t),   W = w/(2 pi f0)
    kappa = K_3 X^2/K,   d = D_2 X/M,   p = f/(K X)

by integration in time (oscillators.c) up to the periodic state, which is verified over a further period. The reading is
the component of x, x' or x'' at the drive's frequency by Fourier projection over one period: x = Re[A exp(i w t)], phase
relative to the drive, a lag negative. Needs Python 3.9 or later and a C compiler called cc; nothing else.
"""

import argparse
import cmath
import ctypes
import json
import math
import multiprocessing
import os
import random
import subprocess
import sys
import tempfile
import time

import laws

GRAVITY = 9.80665  # m/s^2
EFFECTS = ["none", "cubic-stiffness", "quadratic-damping", "friction-joint"]
PAIRS = [(EFFECTS[1], EFFECTS[2]), (EFFECTS[1], EFFECTS[3]), (EFFECTS[2], EFFECTS[3])]
FURTHER = ["clearance", "quintic-stiffness", "asymmetric-stiffness", "power-damping", "pivot-friction", "residual-modes"]
OUTSIDE = {
    "one-sided-stop": "a spring in reach beyond a gap on one side: b max(0, u - s)",
    "exponential-spring": "a spring that stiffens exponentially: b (s sinh(u/s) - u)",
    "saturating-spring": "a spring beside the other whose force saturates, without loss: b s tanh(u/s)",
    "tuned-mass": "a second, linear mode on the first, inside the band",
    "reading-compression": "a reading that falls short of large motions: |A| / sqrt(1 + (|A|/a_s)^2)",
}
KIN = {  # laws of the catalogue that may say nearly the same: not called false, and not held against a draw
    "one-sided-stop": ["clearance", "drift"], "exponential-spring": ["quintic-stiffness", "clearance", "drift"],
    "saturating-spring": ["drift"], "tuned-mass": [], "reading-compression": ["drift"],
}
LAWS = {
    "one-sided-stop": 1, "exponential-spring": 2, "saturating-spring": 3, "clearance": 6, "quintic-stiffness": 7,
    "asymmetric-stiffness": 8, "power-damping": 9,
}
PERIODIC = 1e-7  # change of the state over one period, relative to its amplitude, that passes for periodic


class Rejected(Exception):
    """A draw that is no use: too weak, too strong, or beyond a softening spring's barrier. Another is drawn."""


# ---------------------------------------------------------------------------------------------------- integration


def compile_library():
    here = os.path.dirname(os.path.abspath(__file__))
    with tempfile.TemporaryDirectory() as folder:
        target = os.path.join(folder, "oscillators.so")
        flags = ["-O3", "-shared", "-fPIC", "-ffp-contract=off"]
        subprocess.run(["cc", *flags, "-o", target, os.path.join(here, "oscillators.c"), "-lm"], check=True)
        return ctypes.CDLL(target)


LIBRARY = compile_library()
DOUBLE = ctypes.c_double


def array(values):
    return (DOUBLE * max(len(values), 1))(*values)


class Mode:
    """A dimensionless mode. `elements` lists (k_i, y_i): stiffness and the stretch at which the element slips.

    `spring` is (law, b, s) of oscillators.c. `several`: more than one state may be stable at one frequency."""

    def __init__(self, Q, kappa=0.0, d=0.0, elements=(), spring=(0, 0.0, 1.0), several=None):
        self.Q, self.kappa, self.d, self.spring = Q, kappa, d, spring
        self.several = kappa != 0.0 or spring[0] != 0 if several is None else several
        elements = list(elements)
        elements += [(0.0, 1e9)] * (-len(elements) % 4)  # the C code takes four at a time
        self.elements = elements
        self.k, self.y = array([k for k, _ in elements]), array([y for _, y in elements])
        self.steps = 768 if spring[0] in (1, 6, 9) else 384 if elements or spring[0] else 128

    def at_rest(self):
        return [0.0] * (2 + len(self.elements))

    def run(self, state, W, p, cycles, steps=None):
        """State after whole periods from phase 0 of the drive; complex amplitude and largest |u| of the last period."""
        buffer, out = array(state), (DOUBLE * 3)()
        LIBRARY.run(
            array([self.Q, self.kappa, self.d, p, W, *self.spring]), len(self.elements), self.k, self.y, buffer,
            ctypes.c_long(int(cycles)), steps or self.steps, out,
        )
        if not 0.0 < out[2] < math.inf:
            raise Rejected("escaped")
        return list(buffer)[: len(state)], complex(out[0], -out[1]), out[2]

    def barrier(self):
        """Displacement beyond which a spring of LAWS no longer pulls back."""
        law, b, _ = self.spring
        return (-b) ** -0.25 if law == 7 and b < 0.0 else 1.0 / abs(b) if law == 8 else math.inf

    def harmonic(self, a):
        """First harmonic of the effect at amplitude a near W = 1: stiffness and loss (k', k''). Only places the grid."""
        stiffness, loss = 0.75 * self.kappa * a * a, 8.0 / (3.0 * math.pi) * self.d * a
        for k, y in self.elements:
            if a <= y:
                stiffness += k
            else:
                psi = math.acos(1.0 - 2.0 * y / a)
                stiffness += k / math.pi * (psi - 0.5 * math.sin(2.0 * psi))
                loss += 4.0 * k * y * (a - y) / (math.pi * a * a)
        if self.spring[0] == 9:
            loss += self.spring[1] * power_share(self.spring[2]) * a ** (self.spring[2] - 1.0)
        return stiffness + spring_harmonic(self.spring, a), loss

    def peak(self, p):
        """Amplitude, frequency and half-width at the resonance under the drive p, one harmonic."""
        low, high = 0.0, p * self.Q
        for _ in range(60):
            a = 0.5 * (low + high)
            if a * (1.0 / self.Q + self.harmonic(a)[1]) < p:
                low = a
            else:
                high = a
        stiffness, loss = self.harmonic(low)
        if 1.0 + stiffness < 0.3:
            raise Rejected("softens too far")
        return low, math.sqrt(1.0 + stiffness), 0.5 * (1.0 / self.Q + loss)


def power_share(p):
    """First harmonic of |sin|^p sign(sin)."""
    return 2.0 / math.sqrt(math.pi) * math.gamma(0.5 * p + 1.0) / math.gamma(0.5 * p + 1.5)


def spring_harmonic(spring, a):
    """First harmonic of the force of a spring of oscillators.c over the amplitude a, about u = 0."""
    law, b, s = spring
    if law == 1:
        return b * 0.5 * laws.gap_share(s / a) if a > 0.0 else 0.0
    if law == 2:  # 2 I_1(z)/z - 1 by its series
        term, total, quarter = 1.0, 0.0, 0.25 * (a / s) ** 2
        for k in range(1, 60):
            term *= quarter / (k * (k + 1))
            total += term
        return b * total
    if law == 3:
        if a < 1e-6 * s:
            return b
        count = 256
        mean = sum(math.tanh(a / s * c) * c for c in (math.cos(0.5 * math.pi * (i + 0.5) / count) for i in range(count))) / count
        return b * s * 2.0 * mean / a
    if law == 6:
        return b * laws.gap_share(s / a) if a > 0.0 else 0.0
    if law == 7:
        return 0.625 * b * a**4
    if law == 8:  # by its offset and second harmonic
        return -5.0 / 6.0 * (b * a) ** 2
    return 0.0


def joint_elements(k_t, x_m, n, reach, count=128):
    """Elements whose sum is the chord polygon of F_s [1 - (1 - x/x_m)^n], finer towards x = 0 and towards x_m.

    Beyond `reach` nothing is expected to slip, so that a few elements suffice there."""
    if n == 1.0:
        return [(k_t, x_m)]
    force_s = k_t * x_m / n
    inner = min(reach, x_m)
    ends = 3.0 if inner == x_m else 1.0
    nodes = [inner * (j / count) ** 2 * (ends - (ends - 1.0) * j / count) for j in range(count + 1)]
    if inner < x_m:
        nodes += [inner + (x_m - inner) * j / 8 for j in range(1, 9)]
    force = [force_s * (1.0 - max(0.0, 1.0 - x / x_m) ** n) for x in nodes]
    slope = [(force[j + 1] - force[j]) / (nodes[j + 1] - nodes[j]) for j in range(len(nodes) - 1)] + [0.0]
    return [(slope[j] - slope[j + 1], nodes[j + 1]) for j in range(len(nodes) - 1)]


def steady(mode, W, p, state, steps=None, transient=True):
    """The periodic state that the motion runs into from `state` at phase 0: (state, amplitude, residual, multiplier).

    First the motion runs freely. Then the map over one period is found from three runs that differ in u and u' (each after
    one period in which the sliders forget the difference) and its fixed point is taken. With a cubic stiffness, where
    more than one state may be stable, the fixed point is believed only if it lies next to where the free motion had arrived."""
    several = mode.several
    cycles = (2.0 if several else 0.1) * mode.Q + 10
    multiplier = 0.0
    if transient:
        state = mode.run(state, W, p, cycles, steps)[0]
    for attempt in range(200):
        first = mode.run(state, W, p, 1, steps)[0]
        after, amplitude, top = mode.run(first, W, p, 1, steps)
        if mode.kappa < 0.0 and top > 0.85 / math.sqrt(-mode.kappa) or top > 0.85 * mode.barrier():
            raise Rejected("beyond the barrier")
        residual = max(abs(b - a) for a, b in zip(first, after)) / top
        if residual < max(1e-8 / mode.Q, 2e-13) and multiplier < 1.0:
            break
        starts, ends = [], []
        for moved in (0, 1):
            trial = list(state)
            trial[moved] += 1e-5 * top
            a = mode.run(trial, W, p, 1, steps)[0]
            b = mode.run(a, W, p, 1, steps)[0]
            starts.append((a[0] - first[0], a[1] - first[1]))
            ends.append((b[0] - after[0], b[1] - after[1]))
        # B maps differences at the start of the period to differences at its end
        (s11, s21), (s12, s22) = starts
        (e11, e21), (e12, e22) = ends
        det = s11 * s22 - s12 * s21
        b11, b12 = (e11 * s22 - e12 * s21) / det, (e12 * s11 - e11 * s12) / det
        b21, b22 = (e21 * s22 - e22 * s21) / det, (e22 * s11 - e21 * s12) / det
        trace, product = b11 + b22, b11 * b22 - b12 * b21
        root = cmath.sqrt(trace * trace / 4.0 - product)
        multiplier = max(abs(trace / 2.0 + root), abs(trace / 2.0 - root))
        r1, r2 = after[0] - first[0], after[1] - first[1]
        d11, d22 = 1.0 - b11, 1.0 - b22
        det = d11 * d22 - b12 * b21
        step = ((r1 * d22 + b12 * r2) / det, (d11 * r2 + b21 * r1) / det)
        if several and (multiplier >= 1.0 or math.hypot(*step) > 0.02 * top):
            state = mode.run(after, W, p, cycles, steps)[0]
        else:
            state = [first[0] + step[0], first[1] + step[1]] + after[2:]
            if math.hypot(*step) < 1e-10 * top:
                state = after  # as near as the fixed point can be told: let the sliders settle
    after = mode.run(after, W, p, 1, steps)[0]
    again, amplitude, top = mode.run(after, W, p, 1, steps)
    residual = max(abs(b - a) for a, b in zip(after, again)) / top
    return again, amplitude, residual, multiplier


def sweep(mode, points, steps=None):
    """Complex amplitudes at (W, p) one after the other, each from where the motion before it ended, the first from rest.

    With a cubic stiffness the frequency glides from one point to the next."""
    if isinstance(mode, TwoModes):
        return mode.sweep(points, steps)
    state, before, amplitudes, worst = mode.at_rest(), points[0], [], 0.0
    for W, p in points:
        if mode.several:
            for i in range(1, 9):
                glide = [b + (a - b) * i / 8 for a, b in zip((W, p), before)]
                state = mode.run(state, *glide, 0.25 * mode.Q + 1, steps)[0]
        state, amplitude, residual, _ = steady(mode, W, p, state, steps)
        if residual > min(PERIODIC, 1e-5 / mode.Q):  # what a period leaves adds up over Q/pi of them
            raise Rejected(f"not periodic: {residual:.1e} at W = {W:.6f}")
        worst, before = max(worst, residual), (W, p)
        amplitudes.append(amplitude)
    return amplitudes, worst


class TwoModes(Mode):
    """The linear mode with a second one on it: mass mu, frequency a and quality factor b by itself, relative to the first."""

    def __init__(self, Q, mu, a, b):
        super().__init__(Q)
        self.mu, self.a, self.b = mu, a, b

    def one_period(self, state, W, p, steps):
        buffer, out = array(state), (DOUBLE * 3)()
        LIBRARY.run_pair(array([self.Q, self.mu, self.a, self.b, p, W]), buffer, ctypes.c_long(1), steps, out)
        return list(buffer), complex(out[0], -out[1]), out[2]

    def sweep(self, points, steps=None):
        """The map over one period is affine, so that five runs give its fixed point."""
        steps, amplitudes, worst = steps or self.steps, [], 0.0
        for W, p in points:
            start = self.one_period([0.0] * 4, W, p, steps)[0]
            columns = [self.one_period([float(i == j) for i in range(4)], W, 0.0, steps)[0] for j in range(4)]
            matrix = [[float(i == j) - columns[j][i] for j in range(4)] for i in range(4)]
            state = solve(matrix, start)
            after, amplitude, top = self.one_period(state, W, p, steps)
            residual = max(abs(x - y) for x, y in zip(after, state)) / top
            if residual > min(PERIODIC, 1e-5 / self.Q):
                raise Rejected(f"not periodic: {residual:.1e} at W = {W:.6f}")
            worst = max(worst, residual)
            amplitudes.append(amplitude)
        return amplitudes, worst

    def closed(self, W, p):
        share = self.a**2 + 1j * W * self.a / self.b
        return p / (1.0 - W * W + 1j * W / self.Q + self.mu * share * (1.0 - share / (share - W * W)))


# ---------------------------------------------------------------------------------------------------- linear fit


def solve(matrix, right):
    """Gaussian elimination with pivoting, for the three unknowns of the fit."""
    n = len(right)
    rows = [list(matrix[i]) + [right[i]] for i in range(n)]
    for i in range(n):
        pivot = max(range(i, n), key=lambda j: abs(rows[j][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        for j in range(i + 1, n):
            factor = rows[j][i] / rows[i][i]
            rows[j] = [a - factor * b for a, b in zip(rows[j], rows[i])]
    x = [0.0] * n
    for i in reversed(range(n)):
        x[i] = (rows[i][n] - sum(rows[i][j] * x[j] for j in range(i + 1, n))) / rows[i][i]
    return x


def linear_miss(points, amplitudes, Q, noise, with_phase, noise_phase=None):
    """How far a linear oscillator (f0, Q, gain free, all series at once) misses: (largest, rms) in noise standard deviations."""
    noise_phase = noise if noise_phase is None else noise_phase

    def residuals(v):
        out = []
        for (W, p), a in zip(points, amplitudes):
            r = W / math.exp(v[0])
            model = math.exp(v[2]) * p / (1.0 - r * r + 1j * r / math.exp(v[1]))
            ratio = cmath.log(a / model)
            out += [ratio.real / noise] + ([ratio.imag / noise_phase] if with_phase else [])
        return out

    def cost(r):
        return sum(x * x for x in r)

    best = None
    for shift, widen in ((0.0, 1.0), (0.0, 2.5), (-1.0, 1.5), (1.0, 1.5)):
        v, damping = [shift / Q, math.log(Q / widen), 0.0], 1e-3
        r = residuals(v)
        for _ in range(80):
            slopes = []
            for j, h in enumerate((1e-4 / Q, 1e-5, 1e-5)):
                w = list(v)
                w[j] += h
                slopes.append([(b - a) / h for a, b in zip(r, residuals(w))])
            normal = [[sum(a * b for a, b in zip(x, y)) for y in slopes] for x in slopes]
            for i in range(3):
                normal[i][i] *= 1.0 + damping
            step = solve(normal, [-sum(a * b for a, b in zip(x, r)) for x in slopes])
            step = [max(-c, min(c, s)) for s, c in zip(step, (1.0 / Q, 0.5, 0.5))]
            w = [a + b for a, b in zip(v, step)]
            s = residuals(w)
            if cost(s) < cost(r):
                done = cost(r) - cost(s) < 1e-9 * cost(r)
                v, r, damping = w, s, damping / 5.0
                if done:
                    break
            else:
                damping *= 8.0
                if damping > 1e9:
                    break
        if best is None or cost(r) < cost(best):
            best = r
    return max(abs(x) for x in best), math.sqrt(cost(best) / len(best))


# ---------------------------------------------------------------------------------------------------- drawing a table


def log_uniform(rng, low, high):
    return math.exp(rng.uniform(math.log(low), math.log(high)))


def significant(value, digits):
    return float(f"{value:.{digits - 1}e}")


def draw_mode(rng, effect):
    """A dimensionless mode whose largest amplitude is about 1, and the drive that leads there."""
    Q = significant(log_uniform(rng, 3.0, 1e4), 4)
    if effect == "none":
        return Mode(Q), 1.0 / Q, {}
    if effect == "cubic-stiffness":
        strength = log_uniform(rng, 0.7, 8.0)  # 3/4 K_3 X^2/K in half-widths 1/(2Q)
        softening = rng.random() < 0.7
        kappa = min(strength / (2.0 * Q) / 0.75, 0.2 if softening else 0.5)
        return Mode(Q, kappa=-kappa if softening else kappa), 1.0 / Q, {}
    if effect == "quadratic-damping":
        ratio = log_uniform(rng, 0.2, 4.0)  # its damping at the largest motion over the viscous one
        d = ratio / Q * 3.0 * math.pi / 8.0
        return Mode(Q, d=d), (1.0 + ratio) / Q, {}
    k_t = min(log_uniform(rng, 0.5, 6.0) / Q, 1.0)
    n = 1.0 if rng.random() < 0.5 else significant(rng.uniform(1.5, 4.0), 3)
    if n == 1.0:
        x_m = 1.0 / log_uniform(rng, 1.3, 8.0)
    else:
        x_m = 1.0 / log_uniform(rng, 0.15, 1.5)
    mode = Mode(Q, elements=joint_elements(k_t, x_m, n, reach=1.3))
    return mode, 1.0 / Q + mode.harmonic(1.0)[1], {"k_t": k_t, "x_m": x_m, "n": n}


def draw_conditions(rng):
    """How a table of the random kind is measured. Drawn once per table: what is rejected later does not change it."""
    noise = significant(log_uniform(rng, 0.001, 0.05), 2)
    other = significant(log_uniform(rng, 0.001, 0.05), 2)
    return {
        "noise": noise,
        "noise_phase": other if rng.random() < 0.5 else noise,
        "with_phase": rng.random() < 0.85,
        "sd_stated": rng.random() < 0.5,
        "outliers": rng.uniform(0.01, 0.1) if rng.random() < 1.0 / 3.0 else 0.0,
        "sensor_volts": rng.random() < 0.4,  # beside those whose drive is in volts too: half of all
    }


def draw_random_mode(rng, effects, outside, conditions):
    """A mode with up to two effects or with a cause from outside, as strong as the noise asks for: (mode, drive, planted)."""
    smaller = min(conditions["noise"], conditions["noise_phase"] if conditions["with_phase"] else 1.0)
    scale = smaller / 0.01
    Q = significant(log_uniform(rng, 3.0, 1e4), 4)
    if outside:
        return draw_outside(rng, outside, scale, Q)
    if effects and effects[0] in (*FURTHER, "drift"):
        return draw_further(rng, effects[0], scale, Q)
    pair = len(effects) == 2
    scale *= 1.5 if pair else 1.0
    kappa = d = ratio = k_t = 0.0
    elements, joint, several = [], {}, None
    if "friction-joint" in effects:
        k_t = min(log_uniform(rng, 0.5, 6.0) * scale, 12.0) / Q
        k_t = min(k_t, 1.0)
        n = 1.0 if rng.random() < 0.5 else significant(rng.uniform(1.5, 4.0), 3)
        x_m = 1.0 / (log_uniform(rng, 1.3, 8.0) if n == 1.0 else log_uniform(rng, 0.15, 1.5))
        elements, joint = joint_elements(k_t, x_m, n, reach=1.3), {"k_t": k_t, "x_m": x_m, "n": n}
    if "quadratic-damping" in effects:
        ratio = min(log_uniform(rng, 0.2, 4.0) * scale, 8.0)
        d = ratio / Q * 3.0 * math.pi / 8.0
    loss = (1.0 + ratio) / Q + Mode(Q, elements=elements).harmonic(1.0)[1]
    if "cubic-stiffness" in effects:
        strength = min(log_uniform(rng, 0.7, 8.0) * scale, 10.0)
        if elements:  # one state only: what several would cost with that many sliders is out of reach
            strength, several = min(strength, 2.0), False
        softening = rng.random() < 0.5
        kappa = min(strength * 0.5 * loss / 0.75, 0.2 if softening else 0.5) * (-1.0 if softening else 1.0)
    return Mode(Q, kappa=kappa, d=d, elements=elements, several=several), loss, joint


def draw_further(rng, effect, scale, Q):
    """One effect of FURTHER alone, as strong as the noise asks for; several states only where Q lets the free runs end."""
    if effect == "residual-modes":
        r_c, r_m = (rng.choice((-1.0, 1.0)) * min(log_uniform(rng, 0.02, 0.3) * scale, 0.5) for _ in range(2))
        both = rng.random() < 0.5
        return Mode(Q), 1.0 / Q, {"r_c": r_c, "r_m": r_m if both else 0.0}
    if effect == "drift":  # numbers of every series but the first, in widths and shares
        change = lambda low, high, most: rng.choice((-1.0, 1.0)) * min(log_uniform(rng, low, high) * scale, most)
        return Mode(Q), 1.0 / Q, {f"{key}_{n}": value for n in range(2, 10) for key, value in (
            ("d", max(change(0.2, 2.0, 8.0) / Q, -0.5)), ("g", change(0.03, 0.3, 0.5)))}
    if effect == "pivot-friction":
        friction = min(log_uniform(rng, 0.05, 1.0) * scale, 2.0) / Q
        mode = Mode(Q, elements=[(2e4, 5e-5 * friction)])  # as stiff as that many steps bear
        mode.steps = 1536
        return mode, 1.0 / Q + mode.harmonic(1.0)[1], {"f_c": friction}
    law = LAWS[effect]
    if effect == "power-damping":
        p, ratio = significant(rng.choice((rng.uniform(0.3, 0.7), rng.uniform(1.4, 1.7), rng.uniform(2.4, 4.0))), 3), 0.0
        ratio = min(log_uniform(rng, 0.2, 4.0) * scale, 8.0)
        return Mode(Q, spring=(law, ratio / Q / power_share(p), p), several=False), (1.0 + ratio) / Q, {"p": p}
    Q = significant(log_uniform(rng, 3.0, 1e3), 4)
    strength = min(log_uniform(rng, 0.7, 8.0) * scale, 10.0)
    sign = rng.choice((-1.0, 1.0))
    if effect == "clearance":
        s = rng.uniform(0.2, 0.85)
        b = strength * 0.5 / Q / spring_harmonic((law, 1.0, s), 1.0)
    elif effect == "quintic-stiffness":
        s, b = 1.0, sign * min(strength * 0.5 / Q / 0.625, 0.2 if sign < 0.0 else 1.0)
    else:
        s, b = 1.0, sign * min(math.sqrt(strength * 0.5 / Q * 1.2), 0.45)
    if b > 20.0:
        raise Rejected("too stiff")
    return Mode(Q, spring=(law, b, s), several=strength > 1.5), 1.0 / Q, {"b": b, "s": s}


def draw_outside(rng, outside, scale, Q):
    if outside == "tuned-mass":
        a = 1.0 + rng.uniform(-1.5, 1.5) / Q * 0.5
        mu = min((log_uniform(rng, 0.3, 1.6) / Q) ** 2, 0.3) * min(max(scale, 0.2), 2.0)
        b = Q * log_uniform(rng, 0.5, 6.0)
        return TwoModes(Q, mu, a, b), 1.0 / Q, {"mass_ratio": mu, "frequency_ratio": a, "Q": b}
    if outside == "reading-compression":
        short = min(log_uniform(rng, 0.1, 0.5) * scale, 0.6)
        return Mode(Q), 1.0 / Q, {"a_s": 1.0 / math.sqrt((1.0 - short) ** -2 - 1.0)}
    Q = significant(log_uniform(rng, 3.0, 1e3), 4)  # the free runs of stiffer steps would take minutes
    strength = min(log_uniform(rng, 1.0, 10.0) * scale, 12.0)
    s = {
        "one-sided-stop": rng.uniform(0.2, 0.85), "exponential-spring": 1.0 / log_uniform(rng, 3.0, 8.0),
        "saturating-spring": 1.0 / log_uniform(rng, 5.0, 40.0),
    }[outside]
    law = LAWS[outside]
    b = strength * 0.5 / Q / (1.0 if law == 3 else spring_harmonic((law, 1.0, s), 1.0))
    if spring_harmonic((law, b, s), 1.0) > 1.0 or b > 20.0:
        raise Rejected("too stiff")
    return Mode(Q, spring=(law, b, s), several=strength > 2.0), 1.0 / Q, {"b": b, "s": s}


def draw_levels(rng):
    """Three or four drive levels relative to the largest, as round numbers with round ratios."""
    count = rng.choice((3, 3, 4))
    span = log_uniform(rng, 4.0, 25.0)
    base = rng.choice((1.0, 1.0, 2.0, 5.0, 10.0))
    exact = [base * span ** (i / (count - 1) - 1.0) for i in range(count)]
    for digits in (1, 2):
        levels = [significant(level, digits) for level in exact]
        if min(b / a for a, b in zip(levels, levels[1:])) > 1.25:
            return levels
    return exact


def draw_grids(rng, mode, drives):
    """Frequencies of every level around where it resonates, as wide as the damping that acts there."""
    margin = rng.uniform(2.5, 5.0)
    peaks = [mode.peak(p) for p in drives]
    ends = []
    for _, W, half in peaks:
        low, high = W - margin * half, W + margin * half
        if mode.kappa or mode.spring[0]:  # the bent resonance reaches from the unbent to the bent frequency
            low, high = min(low, 1.0 - 2.5 * half), max(high, 1.0 + 2.5 * half)
        ends.append((max(low, 0.35), high))
    low, high = min(e[0] for e in ends), max(e[1] for e in ends)
    count = rng.randrange(31, 62)
    narrowest = min(half for _, _, half in peaks)
    if rng.random() < 0.6 and (high - low) / narrowest < 0.45 * count:
        ends = [(low, high)] * len(drives)
    return [[a + (b - a) * i / (count - 1) for i in range(count)] for a, b in ends]


def prefixed(rng, units, value):
    """One of `units` [(suffix, bracket text, factor to SI)]: mostly one that gives numbers of a common size."""
    fitting = [u for u in units if 0.5 <= abs(value) / u[2] < 2000.0]
    return rng.choice(fitting if fitting and rng.random() < 0.7 else units[:1])


UNITS = {  # suffix, the same in brackets, factor to SI; SI first
    "force": [("n", "N", 1.0), ("kn", "kN", 1e3), ("mn", "mN", 1e-3), ("un", "µN", 1e-6), ("nn", "nN", 1e-9)],
    "torque": [("n_m", "N m", 1.0), ("mn_m", "mN m", 1e-3), ("un_m", "µN m", 1e-6)],
    "base": [("m_s2", "m/s^2", 1.0), ("g", "g", GRAVITY)],
    "volts": [("v", "V", 1.0), ("mv", "mV", 1e-3)],
    "x": [("m", "m", 1.0), ("mm", "mm", 1e-3), ("um", "µm", 1e-6), ("nm", "nm", 1e-9)],
    "v": [("m_s", "m/s", 1.0), ("mm_s", "mm/s", 1e-3), ("um_s", "µm/s", 1e-6)],
    "a": [("m_s2", "m/s^2", 1.0), ("g", "g", GRAVITY)],
    "angle x": [("rad", "rad", 1.0), ("mrad", "mrad", 1e-3), ("urad", "µrad", 1e-6)],
    "angle v": [("rad_s", "rad/s", 1.0), ("mrad_s", "mrad/s", 1e-3)],
    "angle a": [("rad_s2", "rad/s^2", 1.0)],
}


def draw_size(rng):
    """Mass, frequency and largest motion of something that could exist: no larger than sound travels in a period,
    and with a speed that a solid bears."""
    while True:
        mass, f0 = significant(log_uniform(rng, 1e-9, 1e4), 4), significant(log_uniform(rng, 0.1, 1e6), 5)
        length = 0.14 * mass ** (1.0 / 3.0)
        if f0 * length < 1500.0:
            break
    motion = min(length * log_uniform(rng, 1e-5, 1e-2), log_uniform(rng, 0.01, 5.0) / (2.0 * math.pi * f0))
    return mass, f0, length, motion


def predicted(mode, points):
    """One harmonic in place of the integration, only to drop hopeless draws early; None where it could not tell."""
    top = max(p for _, p in points)
    bend = 2.0 * abs(0.75 * mode.kappa + spring_harmonic(mode.spring, 1.0)) / (top or 1.0)
    if isinstance(mode, TwoModes):
        return [mode.closed(W, p) for W, p in points]
    return None if bend > 2.5 else [one_harmonic(mode, p, W, 45) for W, p in points]


def judge(points, amplitudes, numbers, mode, effects, outside, conditions):
    """Compares with the catalogue's laws in one harmonic. Raises Rejected unless each effect of a pair is needed, and unless
    a cause from outside lies beyond every law and the pairs of laws.PAIRED with any other. What came near, for the answers."""
    fit = laws.Fit(
        points, amplitudes, numbers, mode.Q, conditions["noise"], conditions["noise_phase"] if conditions["with_phase"] else None
    )
    if not effects and not outside:
        return {}
    kin = KIN.get(outside, [])
    if len(effects) == 2:
        needed = [laws.alone(fit, [e])[e] for e in effects]
        if min(needed) < 4.0:
            raise Rejected(f"one effect alone misses by {min(needed):.1f}")
    elif outside:
        for law in laws.ALONE:
            if law not in kin and min(laws.alone(fit, [law]).values(), default=math.inf) < 5.0:
                raise Rejected(f"{law} comes near")
    near = {law: round(miss, 1) for law, miss in laws.alone(fit).items()}
    told = {"one_law_misses_sd": near}
    if outside:
        miss, pair = laws.in_pairs(fit, kin)[0]
        if miss < 4.0:
            raise Rejected(f"{' and '.join(pair)} come near")
        told["best_pair"] = {"laws": pair, "largest_sd": round(miss, 1)}
        told["kin_pairs"] = [pair for miss, pair in laws.in_pairs(fit, of=kin) if miss < 4.0] if kin else []
    return told


def draw_table(rng, effects, outside=None, conditions=None):
    """One table: (rows of physical values, style, truth). Raises Rejected where the draw is of no use.

    Without conditions it is one of the single kind."""
    effect = effects[0] if effects else "none"
    if conditions is None:
        mode, p_top, joint = draw_mode(rng, effect)
    else:
        mode, p_top, joint = draw_random_mode(rng, effects, outside, conditions)
    levels = draw_levels(rng)
    if conditions is None:
        noise = noise_phase = significant(log_uniform(rng, 0.005, 0.03), 2)
        with_phase = rng.random() < 0.9
    else:
        noise, noise_phase, with_phase = (conditions[key] for key in ("noise", "noise_phase", "with_phase"))
    planted = bool(effects) or outside is not None
    most = 250.0 if outside else 80.0 if len(effects) == 2 else 50.0
    drives = [p_top * level / levels[-1] for level in levels]
    grids = draw_grids(rng, mode, drives)
    mass, f0, length, motion = draw_size(rng)
    w0 = 2.0 * math.pi * f0
    kind = rng.choices(("force", "torque", "base", "volts"), (0.55, 0.12, 0.15, 0.18))[0]
    if kind == "torque":
        mass, motion = significant(mass * length**2, 4), min(motion / length, 0.3)
    reading = rng.choice("xva")

    # drive: constant along a series, or from row to row a little different
    varies = rng.random() < 1.0 / 3.0
    drop = rng.choice((0.0, rng.uniform(0.05, 0.4))) if varies else 0.0
    has_series = rng.random() < 0.82
    if not has_series:
        drop = min(drop, 0.1)
    downward = rng.random() < 0.15
    series = []  # label index, direction, [(W, p)]
    for index, (grid, p) in enumerate(zip(grids, drives)):
        _, W0, half = mode.peak(p)
        points = []
        for W in grid:
            W = significant(W * f0, 8) / f0  # the frequency as it will be written
            row = p
            if varies:
                row *= (1.0 - drop / (1.0 + ((W - W0) / half) ** 2)) * (1.0 + 0.003 * rng.gauss(0.0, 1.0))
            points.append((W, row))
        series.append([index, "up", points])

    beside = {"residual-modes", "drift"} & {*effects}
    if conditions is not None and planted and outside != "reading-compression" and not beside:
        along = [point for _, _, points in series for point in points]
        guess = predicted(mode, along)
        if guess is not None and not 3.5 < linear_miss(along, guess, mode.Q, noise, with_phase, noise_phase)[0] < 1.5 * most:
            raise Rejected("one harmonic foretells too little or too much")

    folds = False
    if mode.several:
        top = series[-1][2]
        up, down = sweep(mode, top)[0], sweep(mode, top[::-1])[0][::-1]
        folds = any(abs(a - b) > 0.05 * abs(a) for a, b in zip(up, down))
        if folds:
            downward = rng.random() < 0.5
            if rng.random() < 0.25:
                series = series[-3:] + [[len(levels) - 1, "down", top]]
    both = len({s[0] for s in series}) < len(series)
    if downward and not both:
        for entry in series:
            entry[1] = "down"
    for entry in series:
        if entry[1] == "down":
            entry[2] = entry[2][::-1]
    if rng.random() < 0.15 and not both:
        series.reverse()
    has_series = has_series or both
    has_sweep = both or rng.random() < (0.5 if folds else 0.1)

    points, amplitudes, worst = [], [], 0.0
    for _, _, along in series:
        found, residual = sweep(mode, along)
        points += along
        amplitudes += found
        worst = max(worst, residual)
    if outside == "reading-compression":
        amplitudes = [a / math.sqrt(1.0 + (abs(a) / joint["a_s"]) ** 2) for a in amplitudes]
    if "drift" in effects:  # each series is linear
        numbers = [index for index, _, along in series for _ in along]  # by level, however they are listed
        change = lambda key, number: joint.get(f"{key}_{number + 1}", 0.0)
        amplitudes = [(1.0 + change("g", n)) * p / (1.0 + change("d", n) - W * W + 1j * W / mode.Q) for n, (W, p) in zip(numbers, points)]
    if "residual-modes" in effects:
        amplitudes = [a + (joint["r_c"] + joint["r_m"] / W**2) * p for a, (W, p) in zip(amplitudes, points)]
    miss, miss_rms = linear_miss(points, amplitudes, mode.Q, noise, with_phase, noise_phase)
    if not planted:
        if miss > 0.01:
            raise AssertionError(f"a linear oscillator that a linear fit misses by {miss}")
    elif miss < 5.0 or (miss > most and not folds):
        raise Rejected(f"the linear fit misses by {miss:.1f}")
    told = {}
    if conditions is not None:
        numbers = [number for number, (_, _, along) in enumerate(series) for _ in along]
        told = judge(points, amplitudes, numbers, mode, effects, outside, conditions)

    # physical units
    X = motion
    K = mass * w0**2
    force = K * X
    truth = {
        "M": mass, "f0": f0, "Q": mode.Q, "K": K, "C": mass * w0 / mode.Q, "noise": noise,
        "coordinate": "angle" if kind == "torque" else "displacement", "drive": "base" if kind == "base" else "force",
        "reading": {"x": "displacement", "v": "velocity", "a": "acceleration"}[reading],
        "largest_motion": max(abs(a) for a in amplitudes) * X,
    }
    if "cubic-stiffness" in effects:
        truth["K_3"] = mode.kappa * K / X**2
    if "quadratic-damping" in effects:
        truth["D_2"] = mode.d * mass / X
    if "friction-joint" in effects:
        truth["k_t"], truth["n"] = joint["k_t"] * K, joint["n"]
        truth["F_s"] = joint["k_t"] * joint["x_m"] / joint["n"] * force
    law, b, s = mode.spring
    truth.update({
        "clearance": lambda: {"k_g": b * K, "g": s * X}, "quintic-stiffness": lambda: {"K_5": b * K / X**4},
        "asymmetric-stiffness": lambda: {"K_2": b * K / X}, "power-damping": lambda: {"p": s},
        "pivot-friction": lambda: {"F_c": joint["f_c"] * force},
        "residual-modes": lambda: {"R_c": joint["r_c"] / K, "R_m": joint["r_m"] * w0**2 / K},
        "drift": lambda: {key: value for key, value in joint.items() if int(key[2:]) <= len(series)},
    }.get(effect, dict)())
    per_drive = -1.0 / mass if kind == "base" else 1.0  # stated drive per force
    per_motion = 1.0
    largest = max(abs(a) * X * (W * w0) ** "xva".index(reading) for a, (W, _) in zip(amplitudes, points))
    if kind == "volts":
        per_drive = significant(log_uniform(rng, 0.005, 10.0) / (p_top * force), 4)
        per_motion = significant(log_uniform(rng, 0.01, 5.0) / largest, 4)
        truth["sensitivity_v_per_reading"], truth["drive_n_per_v"] = per_motion, 1.0 / per_drive
    sensor_volts = kind == "volts"
    if conditions is not None and conditions["sensor_volts"] and not sensor_volts:
        sensor_volts, per_motion = True, significant(log_uniform(rng, 0.01, 5.0) / largest, 4)
        truth["sensitivity_v_per_reading"] = per_motion
    prefix = "angle " if kind == "torque" else ""
    drive_unit = prefixed(rng, UNITS[kind], p_top * force * per_drive)
    reading_unit = prefixed(rng, UNITS["volts" if sensor_volts else prefix + reading], largest * per_motion)
    drive_name = {"force": "force", "torque": "torque", "base": "drive", "volts": "drive"}[kind]
    hertz = ("khz", "kHz", 1e3) if f0 > 5e3 and rng.random() < 0.4 else ("hz", "Hz", 1.0)
    angle = ("deg", "deg", math.pi / 180.0) if rng.random() < 0.3 else ("rad", "rad", 1.0)

    labels = rng.choice(("level", "level", "level", "number", "letter", "word"))
    rows = []
    at = 0
    for number, (index, direction, along) in enumerate(series):
        label = {
            "level": f"{levels[index]:g}", "number": str(number + 1), "letter": "ABCDE"[number],
            "word": f"{['low', 'medium', 'high', 'full'][index - len(levels)]}",
        }[labels]
        if both and labels in ("level", "word"):
            label += f" {direction}"
        for W, p in along:
            a = amplitudes[at] * X * (1j * W * w0) ** "xva".index(reading) * per_motion * (1.0 if per_drive > 0 else -1.0)
            at += 1
            amplitude = abs(a) * (1.0 + noise * rng.gauss(0.0, 1.0))
            phase = cmath.phase(a * cmath.exp(1j * noise_phase * rng.gauss(0.0, 1.0)))
            rows.append({
                "series": label, "sweep": direction, "frequency": W * f0 / hertz[2],
                "drive": p * force * abs(per_drive) / drive_unit[2], "amplitude": amplitude / reading_unit[2],
                "phase": phase / angle[2],
            })
    states_sd = conditions is not None and conditions["sd_stated"]
    if conditions is not None:
        percent = rng.random() < 0.5
        for row in rows:  # before any outlier; a share of the reading, or of its noise-free value would be as good
            row["amplitude_sd"] = 100.0 * noise if percent else noise * row["amplitude"]
            row["phase_sd"] = noise_phase / angle[2]
        sd_unit = ("percent", "%", None) if percent else reading_unit
        truth["outliers"] = throw_outliers(rng, rows, conditions, angle[2])
        truth.update(noise_phase=noise_phase, sd_stated=states_sd)
    columns = [("series", "series", None)] if has_series else []
    columns += [("sweep", "sweep", None)] if has_sweep else []
    columns += [("frequency", "frequency", hertz), ("drive", drive_name, drive_unit), ("amplitude", "amplitude", reading_unit)]
    columns += [("phase", "phase", angle)] if with_phase else []
    if states_sd:
        columns += [("amplitude_sd", "amplitude_sd", sd_unit)]
        columns += [("phase_sd", "phase_sd", angle)] if with_phase else []
    style = {"columns": columns, "separator": ",", "comma": False, "bom": False, "brackets": None, "end": "\n"}
    style["digits"] = rng.choice((7, 7, 7, 5))
    look = rng.random()
    if look < 0.14:
        style.update(separator=";", comma=True, bom=rng.random() < 0.5, end=rng.choice(("\n", "\r\n")))
    elif look < 0.20:
        style.update(separator="\t")
    if rng.random() < 0.16:
        style["brackets"] = rng.choice(("[]", "()", "/", "mixed"))
        if style["brackets"] == "/" and any(unit and "/" in unit[1] for _, _, unit in columns):
            style["brackets"] = "[]"
    truth["units"] = [heading(style, key, name, unit) for key, name, unit in columns]
    truth.update(
        series=len(series), levels=levels, sweep=sorted({s[1] for s in series}), folds=folds,
        drive_varies=varies, linear_miss_sd={"largest": round(miss, 2), "rms": round(miss_rms, 2)},
        dimensionless={
            "largest": max(abs(a) for a in amplitudes), "kappa": mode.kappa, "d": mode.d,
            **({f"{'outside' if outside else 'joint'}_{k}": v for k, v in joint.items()}),
        },
        residual=float(f"{worst:.1e}"),
        **told,
    )
    return rows, style, truth


def throw_outliers(rng, rows, conditions, per_angle):
    """Moves the amplitude or the phase of some rows by 10 to 40 standard deviations: how many.

    Downward an amplitude goes by 0.8 of itself at most; where that is less, it goes upward."""
    count = round(conditions["outliers"] * len(rows))
    for index in rng.sample(range(len(rows)), count):
        row, far, sign = rows[index], rng.uniform(10.0, 40.0), rng.choice((-1.0, 1.0))
        if conditions["with_phase"] and rng.random() < 0.5:
            moved = row["phase"] * per_angle + sign * far * conditions["noise_phase"]
            row["phase"] = cmath.phase(cmath.exp(1j * moved)) / per_angle
        else:
            change = far * conditions["noise"]
            row["amplitude"] *= 1.0 + (change if change > 0.8 else sign * change)
    return count


# ---------------------------------------------------------------------------------------------------- writing


def heading(style, key, name, unit):
    if unit is None:
        return name
    if style["brackets"] is None:
        return f"{name}_{unit[0]}"
    form = style["brackets"]
    if form == "mixed":
        form = "()" if key == "frequency" else "[]"
    return f"{name} / {unit[1]}" if form == "/" else f"{name} {form[0]}{unit[1]}{form[1]}"


def write_table(path, rows, style):
    def text(key, value):
        if isinstance(value, str):
            number = value.replace(".", "", 1).isdigit()
        else:
            value, number = f"{value:.{10 if key == 'frequency' else style['digits']}g}", True
        return value.replace(".", ",") if style["comma"] and number else value

    lines = [style["separator"].join(heading(style, *column) for column in style["columns"])]
    lines += [style["separator"].join(text(key, row[key]) for key, _, _ in style["columns"]) for row in rows]
    with open(path, "w", encoding="utf-8-sig" if style["bom"] else "utf-8", newline="") as file:
        file.write(style["end"].join(lines) + style["end"])


def single_order(seed, count):
    """[(effects, outside)]: every block of four tables holds each effect once, in an order drawn."""
    order, found = random.Random(f"{seed}/order"), []
    while len(found) < count:
        found += [([] if e == "none" else [e], None) for e in order.sample(EFFECTS, 4)]
    return found[:count]


def random_order(seed, count):
    """[(effects, outside)]: every block of ten holds two tables with nothing, four with one effect, two with a pair and two
    with a cause from outside, in an order drawn; effects, pairs and causes go round in an order drawn once."""
    order, found = random.Random(f"{seed}/random/order"), []
    rounds = [order.sample(list(what), len(what)) for what in (EFFECTS[1:], PAIRS, OUTSIDE)]
    used = [0, 0, 0]

    def following(i):
        used[i] += 1
        return rounds[i][(used[i] - 1) % len(rounds[i])]

    while len(found) < count:
        block = [([], None)] * 2 + [([following(0)], None) for _ in range(4)]
        block += [(list(following(1)), None) for _ in range(2)] + [([], following(2)) for _ in range(2)]
        found += order.sample(block, 10)
    return found[:count]


def further_order(seed, count):
    """[(effects, outside)]: every block of seven holds a table with nothing and one with each effect of FURTHER, in an order drawn."""
    order, found = random.Random(f"{seed}/further/order"), []
    while len(found) < count:
        found += [([] if e == "none" else [e], None) for e in order.sample(["none", *FURTHER], 7)]
    return found[:count]


def drift_order(seed, count):
    """[(effects, outside)]: a drift, but for every third table, where nothing is planted."""
    return [([] if index % 3 == 2 else ["drift"], None) for index in range(count)]


ORDERS = {
    "single": ("osc", single_order), "random": ("rnd", random_order), "further": ("fur", further_order), "drift": ("dri", drift_order),
}


def make(task):
    """One table from its seed alone, so that tables may be made side by side: what `generate` writes and says."""
    seed, index, kind, effects, outside = task
    start, rejected = time.time(), 0
    if kind == "single":
        rng, conditions = random.Random(f"{seed}/{index}"), None
    else:
        rng = random.Random(f"{seed}/{kind}/{index}")
        conditions = draw_conditions(rng)
    while True:
        try:
            return (*draw_table(rng, effects, outside, conditions), rejected, time.time() - start)
        except Rejected:
            rejected += 1
            if conditions and rejected % 60 == 0:
                conditions = draw_conditions(rng)  # nothing visible and distinct can be drawn under these


def generate(folder, seed, count, only=None, kind="single", jobs=1):
    """Table i does not depend on `count` or `jobs`."""
    answers, began = {}, time.time()
    os.makedirs(folder, exist_ok=True)
    prefix, order = ORDERS[kind]
    tasks = []
    for index, (effects, outside) in enumerate(order(seed, count)):
        name = f"{prefix}-{seed}-{index + 1:03d}"
        if not only or name in only:
            tasks.append((name, (seed, index, kind, effects, outside)))
    pool = multiprocessing.Pool(jobs) if jobs > 1 else None
    made = (pool.imap if pool else map)(make, [task for _, task in tasks])
    for (name, (_, _, _, effects, outside)), (rows, style, truth, rejected, seconds) in zip(tasks, made):
        os.makedirs(os.path.join(folder, name), exist_ok=True)
        write_table(os.path.join(folder, name, "table.csv"), rows, style)
        answers[name] = {"effects": effects, **({"outside": outside} if kind != "single" else {}), "truth": truth}
        what = outside or "+".join(effects) or "none"
        if outside:
            answers[name]["kin"] = KIN[outside]
        print(
            f"{name}  {what:{18 if kind == 'single' else 34}s} Q {truth['Q']:8g}  f0 {truth['f0']:10g} Hz  rows {len(rows):3d}  "
            f"miss {truth['linear_miss_sd']['largest']:6.1f} sd  folds {truth['folds']!s:5s}  residual {truth['residual']:.0e}  "
            f"rejected {rejected:3d}  {seconds:5.1f} s", file=sys.stderr, flush=True,
        )
        with open(os.path.join(folder, "answers.json"), "w", encoding="utf-8") as file:
            json.dump(answers, file, indent=1)
            file.write("\n")
    print(f"{len(answers)} tables in {time.time() - began:.0f} s", file=sys.stderr)


# ---------------------------------------------------------------------------------------------------- self-checks


def follow(elements, path):
    """Force of slip elements alone, moved along a path from rest."""
    mode = Mode(1.0, elements=elements)
    z, force = array([0.0] * len(mode.elements)), array(path)
    LIBRARY.follow(len(mode.elements), mode.k, mode.y, z, ctypes.c_long(len(path)), array(path), force)
    return list(force)


def roots_duffing(Q, kappa, p, W):
    """Squared amplitudes of one harmonic: [(1 - W^2) + 3/4 kappa s]^2 s + (W/Q)^2 s = p^2, by scanning and bisection."""

    def f(s):
        return ((1.0 - W * W + 0.75 * kappa * s) ** 2 + (W / Q) ** 2) * s - p * p

    grid = [1.2 * (p * Q) ** 2 * i / 4000 for i in range(4001)]
    found = []
    for low, high in zip(grid, grid[1:]):
        if f(low) * f(high) <= 0.0:
            for _ in range(80):
                middle = 0.5 * (low + high)
                low, high = (low, middle) if f(low) * f(middle) <= 0.0 else (middle, high)
            found.append(low)
    return found


def one_harmonic(mode, p, W, halvings=200):
    """Amplitude where the effect is a stiffness and a loss that depend on amplitude alone (no folds), by bisection."""
    low, high = 0.0, p * mode.Q * 2.0
    for _ in range(halvings):
        a = 0.5 * (low + high)
        stiffness, loss = mode.harmonic(a)
        loss *= W * W if mode.d else 1.0
        low, high = (a, high) if abs(1.0 - W * W + stiffness + 1j * (W / mode.Q + loss)) * a < p else (low, a)
    stiffness, loss = mode.harmonic(low)
    loss *= W * W if mode.d else 1.0
    return p / (1.0 - W * W + stiffness + 1j * (W / mode.Q + loss))


def check():
    failures = []

    def report(what, error, bound):
        print(f"{'ok  ' if error <= bound else 'FAIL'} {what:92s} {error:.1e} (bound {bound:.0e})")
        if error > bound:
            failures.append(what)

    def grid(Q, width=3.0, count=13):
        return [1.0 + width * (i / (count - 1) - 0.5) / Q for i in range(count)]

    def difference(a, b):
        """Largest difference of two curves relative to the value there."""
        return max(abs(x - y) / abs(y) for x, y in zip(a, b))

    for Q in (3.0, 100.0, 1e4):
        points = [(W, 1.0 / Q) for W in grid(Q, 2.0)]
        exact = [p / (1.0 - W * W + 1j * W / Q) for W, p in points]
        report(f"viscous linear, closed form, Q = {Q:g}", difference(sweep(Mode(Q), points)[0], exact), 1e-7)

    Q = 5e4
    for strength in (2.0, -8.0, 8.0):  # 3/4 kappa a^2 in half-widths; a fold appears beyond 3.08
        kappa = strength / (2.0 * Q) / 0.75
        mode = Mode(Q, kappa=kappa)
        bend = math.copysign(0.5 / Q, strength)
        frequencies = [1.0 + bend * ((abs(strength) / 2.0 + 3.0) * i / 20.0 - 1.0) for i in range(21)]
        worst, branches = 0.0, set()
        for points in (frequencies, frequencies[::-1]):
            for W, a in zip(points, sweep(mode, [(W, 1.0 / Q) for W in points])[0]):
                roots = roots_duffing(Q, kappa, 1.0 / Q, W)
                s = min(roots, key=lambda s: abs(s - abs(a) ** 2))
                if len(roots) == 3:
                    branches.add(roots.index(s))
                closed = (1.0 / Q) / (1.0 - W * W + 0.75 * kappa * s + 1j * W / Q)
                worst = max(worst, abs(a - closed) / abs(closed))
        report(f"Duffing, one harmonic as Q grows, 3/4 kappa a^2 = {strength:g} half-widths", worst, 1e-4)
        if abs(strength) > 4.0:
            report("  both stable branches found, by sweeping up and down, and no other", float(branches != {0, 2}), 0.0)

    Q = 5e4
    mode = Mode(Q, d=2.0 / Q * 3.0 * math.pi / 8.0)
    points = [(W, 3.0 / Q) for W in grid(Q, 8.0)]
    report("quadratic damping, one harmonic as Q grows", difference(sweep(mode, points)[0], [one_harmonic(mode, p, W) for W, p in points]), 1e-4)

    for stroke, stiffness, quadrature in ((1.2, 0.89045, 0.17684), (2.0, 0.5, 1.0 / math.pi), (5.0, 0.142378, 0.203719)):
        count = 20000
        path = [stroke * math.sin(2.0 * math.pi * i / count) for i in range(2 * count)]
        force = follow([(1.0, 1.0)], path)[count:]
        s = 2.0 / count / stroke * sum(f * math.sin(2.0 * math.pi * i / count) for i, f in enumerate(force))
        c = 2.0 / count / stroke * sum(f * math.cos(2.0 * math.pi * i / count) for i, f in enumerate(force))
        report(f"Jenkins element, Caughey's k_eq and quadrature, stroke {stroke:g}", max(abs(s - stiffness), abs(c - quadrature)), 1e-5)
    Q = 5e4
    for ratio in (1.5, 4.0):
        mode = Mode(Q, elements=[(3.0 / Q, 1.0 / ratio)])
        p = 1.0 / Q + mode.harmonic(1.0)[1]
        points = [(W, p) for W in grid(Q, 6.0)]
        report(f"Jenkins element on the mode, one harmonic as Q grows, peak stroke {ratio:g} x_c",
               difference(sweep(mode, points)[0], [one_harmonic(mode, p, W) for W, p in points]), 1e-4)

    for q, energy in ((0.3, 0.0075251), (0.7, 0.1498266), (0.95, 0.6775315)):
        stroke = 1.5 * (1.0 - (1.0 - q) ** (2.0 / 3.0))
        count = 20000
        path = [stroke * math.sin(2.0 * math.pi * i / count) for i in range(3 * count + 1)]
        force = follow(joint_elements(1.0, 1.5, 1.5, reach=stroke * 1.3), path)
        loop = sum((path[i + 1] - path[i]) * 0.5 * (force[i] + force[i + 1]) for i in range(2 * count, 3 * count))
        report(f"slip elements, n = 3/2: loop of Hertz, Mindlin, Cattaneo at q = {q:g}", abs(loop / energy - 1.0), 1e-3)

    cases = [
        ("cubic, softening", lambda f: Mode(20.0, kappa=-0.06), 1.0 / 20.0, 20.0),
        ("cubic, Q = 4", lambda f: Mode(4.0, kappa=-0.25), 1.0 / 4.0, 4.0),
        ("cubic, Q = 10000, folds", lambda f: Mode(1e4, kappa=3e-4), 1e-4, 1e4),
        ("quadratic damping", lambda f: Mode(30.0, d=0.1), 0.12, 30.0),
        ("quadratic damping, Q = 3", lambda f: Mode(3.0, d=0.8), 1.0, 3.0),
        ("Jenkins element", lambda f: Mode(50.0, elements=[(0.08, 0.3)]), 0.04, 50.0),
        ("Jenkins element, Q = 4", lambda f: Mode(4.0, elements=[(0.8, 0.3)]), 0.5, 4.0),
        ("Jenkins element, Q = 10000", lambda f: Mode(1e4, elements=[(5e-4, 0.3)]), 2e-4, 1e4),
        ("slip elements, n = 1.5", lambda f: Mode(50.0, elements=joint_elements(0.08, 1.5, 1.5, 1.3, 128 * f)), 0.04, 50.0),
        ("slip elements, n = 1.5, x_m within the stroke", lambda f: Mode(50.0, elements=joint_elements(0.08, 0.6, 1.5, 1.3, 128 * f)), 0.04, 50.0),
        ("slip elements, n = 4, Q = 1000", lambda f: Mode(1e3, elements=joint_elements(5e-3, 2.0, 4.0, 1.3, 128 * f)), 2e-3, 1e3),
    ]
    for what, make, p, Q in cases:
        points = [(W, p) for W in grid(Q, 6.0 if Q > 10 else 2.0, 9)]
        coarse = sweep(make(1), points)[0]
        fine = sweep(make(1), points, 2 * make(1).steps)[0]
        report(f"{what}: half the time step", difference(coarse, fine), 1e-4)
        if "slip elements" in what:
            report(f"{what}: twice the elements", difference(coarse, sweep(make(2), points)[0]), 1e-4)
        if Q <= 50.0:
            mode = make(1)
            for W, p in points[::4]:
                plain = mode.run(mode.at_rest(), W, p, 30 * Q)[1]
                report(f"{what}: 30 Q periods from rest instead of the fixed point, W = {W:.3f}",
                       abs(steady(mode, W, p, mode.at_rest())[1] / plain - 1.0), 1e-6)
    check_outside(report, grid, difference)
    print(f"{len(failures)} failed")
    return not failures


def check_outside(report, grid, difference):
    """The springs, the second mode, two effects at once, and laws.py."""
    for W1, b in ((1.0, 0.5), (1.0, 3.0)):  # a stop without a gap: half a period each at W1 and at sqrt(1 + b)
        W2 = math.sqrt(1.0 + b)
        mode = Mode(1e12, spring=(1, b, 0.0))
        W = 2.0 * W1 * W2 / (W1 + W2)
        state = mode.run([1.0, 0.0], W, 0.0, 20)[0]
        report(f"stop without a gap, b = {b:g}: back after 20 free periods at 2 w1 w2/(w1 + w2)",
               max(abs(state[0] - 1.0), abs(state[1])), 2e-3)
        fine = mode.run([1.0, 0.0], W, 0.0, 20, 4 * mode.steps)[0]
        report("  the same with a quarter of the time step", max(abs(fine[0] - 1.0), abs(fine[1])), 1e-4)
    Q = 5e4
    for what, spring in (
        ("one-sided stop", (1, 6.0 / Q, 0.4)), ("exponential spring", (2, 0.2 / Q, 0.2)), ("saturating spring", (3, 1.0 / Q, 0.05)),
        ("stops to both sides", (6, 1.0 / Q, 0.4)), ("quintic spring", (7, 0.3 / Q, 1.0)),
        ("asymmetric spring", (8, math.sqrt(0.3 / Q), 1.0)), ("damping of the power 2.5", (9, 0.5 / Q, 2.5)),
        ("damping of the power 0.5", (9, 0.5 / Q, 0.5)),
    ):
        mode = Mode(Q, spring=spring, several=False)
        points = [(W, 1.0 / Q) for W in grid(Q, 6.0)]
        points = [(W, p) for W, p in points if W < 1.0 or what != "exponential spring"]
        found = sweep(mode, points)[0]
        report(f"{what}: one harmonic as Q grows", difference(found, [one_harmonic(mode, p, W) for W, p in points]), 1e-4)
    for what, spring, W in (("one-sided stop", (1, 0.6, 0.4), 1.1), ("exponential spring", (2, 0.02, 0.2), 1.1), ("saturating spring", (3, 0.3, 0.05), 1.1),
                            ("stops to both sides", (6, 0.3, 0.4), 1.1), ("quintic spring", (7, 0.02, 1.0), 1.1), ("asymmetric spring", (8, 0.1, 1.0), 1.1),
                            ("damping of the power 0.5", (9, 0.02, 0.5), 1.1)):
        mode, p = Mode(20.0, spring=spring), 0.05
        points = [(1.0 + 0.01 * i, p) for i in range(-10, 11)]
        coarse, fine = sweep(mode, points)[0], sweep(mode, points, 2 * mode.steps)[0]
        report(f"{what}: half the time step", difference(coarse, fine), 1e-4)
    soft = Mode(100.0, spring=(2, 6.0, 100.0), several=False)
    cubic = Mode(100.0, kappa=1e-4, several=False)  # b/(6 s^2)
    points = [(W, 0.05) for W in grid(100.0)]
    report("exponential spring within a twentieth of its length: cubic with b/(6 s^2)",
           difference(sweep(soft, points)[0], sweep(cubic, points, soft.steps)[0]), 1e-4)

    for Q, mu, a, b in ((4.0, 0.1, 1.1, 6.0), (100.0, 1e-4, 0.997, 80.0), (1e4, 1e-8, 1.00003, 3e4)):
        mode = TwoModes(Q, mu, a, b)
        points = [(W, 1.0 / Q) for W in grid(Q)]
        exact = [mode.closed(W, p) for W, p in points]
        alone = [p / (1.0 - W * W + 1j * W / Q) for W, p in points]
        report(f"second mode, closed form, Q = {Q:g} (it changes the curve by up to {difference(alone, exact):.0%})",
               difference(sweep(mode, points)[0], exact), 1e-6)
        if Q < 1e3:
            W, p = points[3]
            state = [0.0] * 4
            for _ in range(int(30 * max(Q, b))):
                state, amplitude, _ = mode.one_period(state, W, p, mode.steps)
            report("  from rest, 30 Q periods", abs(amplitude / mode.closed(W, p) - 1.0), 1e-6)

    Q = 5e4
    several = [
        ("cubic and quadratic", Mode(Q, kappa=1.0 / Q, d=1.0 / Q)), ("cubic and Jenkins", Mode(Q, kappa=-1.0 / Q, elements=[(2.0 / Q, 0.3)], several=False)),
        ("quadratic and Jenkins", Mode(Q, d=1.0 / Q, elements=[(2.0 / Q, 0.3)])),
    ]
    for what, mode in several:
        points = [(W, 2.0 / Q) for W in grid(Q, 8.0)]
        found = sweep(mode, points)[0]
        report(f"{what}: one harmonic as Q grows", difference(found, [one_harmonic(mode, p, W) for W, p in points]), 1e-4)

    for n, ratio in ((1.0, 2.0), (2.0, 0.7), (4.0, 3.0)):
        mode = Mode(1.0, elements=joint_elements(1.0, 1.0 / ratio, n, reach=1.0))
        found = laws.Interpolated(n)(ratio)
        report(f"laws.py: stiffness and loss of a joint by Masing's rule against its elements, n = {n:g}",
               abs(found - complex(*mode.harmonic(1.0))), 2e-3)
    drives = (0.25 / 200.0, 0.5 / 200.0, 1.0 / 200.0)
    for what, mode, law in (
        ("cubic", Mode(200.0, kappa=2e-3), "cubic-stiffness"), ("quadratic", Mode(200.0, d=4e-3), "quadratic-damping"),
        ("joint", Mode(200.0, elements=joint_elements(0.01, 0.8, 2.0, 1.3)), "friction-joint"),
    ):
        points = [(W, p) for p in drives for W in grid(200.0, 6.0, 21)]
        fit = laws.Fit(points, sweep(mode, points)[0], [p for _, p in points], 200.0, 0.01, 0.01)
        told = laws.alone(fit, laws.ALONE[:3])
        report(f"laws.py: what the planted law leaves, {what} (the others: {', '.join(f'{m:.0f}' for k, m in told.items() if k != law)})",
               told[law], 0.3)


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--out", metavar="DIR", help="folder for NAME/table.csv and answers.json")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=64)
    parser.add_argument("--kind", choices=tuple(ORDERS), default="single", help="what is drawn [default: single]")
    parser.add_argument("--jobs", type=int, default=1, help="tables at a time")
    parser.add_argument("--only", metavar="NAME", nargs="+", help="generate these tables only")
    parser.add_argument("--check", action="store_true", help="compare with closed forms and exit")
    options = parser.parse_args()
    if options.check:
        sys.exit(0 if check() else 1)
    if not options.out:
        parser.error("--out DIR is needed")
    generate(options.out, options.seed, options.count, options.only, options.kind, options.jobs)


if __name__ == "__main__":
    main()
