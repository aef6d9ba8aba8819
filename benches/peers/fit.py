"""One effect fitted to one table of measurements as one would do it by hand: scipy `least_squares` over a simulator compiled
with numba, beside the program's own fit from the same start (`examples/fit_time.rs`). See README.md."""

import csv
import json
import math
import subprocess
import time
from pathlib import Path

import numpy as np
from numba import njit
from scipy.optimize import least_squares

ROOT = Path(__file__).resolve().parents[2]
TABLE = ROOT / "scenarios/practice/1/measurements.csv"
TAU = 2 * math.pi
# The rig of the scenario, SI.
J, K0, C0, K1, C1, A, B, MU = 5.0e-3, 990.0, 0.43, 1.6e4, 12.0, 0.030, 0.060, 0.5
# Where both fits begin: kc, cc, beta, v_0; the last two are the geometric means of the catalogue's ranges.
START = (8.9e4, 26.0, math.sqrt(0.002 * 0.5), math.sqrt(1e-6 * 1e-1))
BOUNDS = ((8.9e3, 2.6, 0.002, 1e-6), (8.9e5, 260.0, 0.5, 1e-1))
SETTLED = 1e-5  # change of the fundamental over a cycle at which a transient counts as dead
MAX_CYCLES = 400
ERROR = 1e-4  # of an amplitude, largest over the table


@njit
def slip_rate(pull, limit, slope, v0, cc):
    """Slip rate s >= 0 of pull - cc s = limit + slope ln(1 + s/v0), by Newton's method; 0 where the contact sticks."""
    if pull <= limit:
        return 0.0
    s = 0.0
    for _ in range(50):
        step = (pull - cc * s - limit - slope * math.log1p(s / v0)) / (cc + slope / (v0 + s))
        s += step
        if abs(step) < 1e-12 * (s + v0):
            break
    return s


@njit
def rates(th, speed, x, torque, p):
    v = p[5] - B * speed
    pull = p[0] * x + p[1] * v
    s = slip_rate(abs(pull), MU * p[4], p[2] * p[4], p[3], p[1])
    s = math.copysign(s, pull)
    force = pull - p[1] * s
    k, c = K0 + 2 * A * A * K1, C0 + 2 * A * A * C1
    return speed, (torque - k * th - c * speed + B * force) / J, v - s


@njit
def fundamental(p, drive, frequency, steps):
    """Runge-Kutta of order 4 until the fundamental is steady: (amplitude, phase)."""
    w = TAU * frequency
    h = TAU / w / steps
    gain, lead = A * drive * math.hypot(K1, C1 * w), math.atan2(C1 * w, K1)
    th, speed, x = 0.0, 0.0, 0.0
    if p[5] > 0.0:
        x = MU * p[4] / p[0]
        th = B * MU * p[4] / (K0 + 2 * A * A * K1)
    rest, before_re, before_im = th, 0.0, 0.0
    for _ in range(MAX_CYCLES):
        re, im = 0.0, 0.0
        for i in range(steps):
            t = i * h
            swing = th - rest
            re += swing * math.sin(w * t)
            im += swing * math.cos(w * t)
            g0 = gain * math.sin(w * t + lead)
            g1 = gain * math.sin(w * (t + 0.5 * h) + lead)
            g2 = gain * math.sin(w * (t + h) + lead)
            a0, b0, c0 = rates(th, speed, x, g0, p)
            a1, b1, c1 = rates(th + 0.5 * h * a0, speed + 0.5 * h * b0, x + 0.5 * h * c0, g1, p)
            a2, b2, c2 = rates(th + 0.5 * h * a1, speed + 0.5 * h * b1, x + 0.5 * h * c1, g1, p)
            a3, b3, c3 = rates(th + h * a2, speed + h * b2, x + h * c2, g2, p)
            th += h / 6 * (a0 + 2 * a1 + 2 * a2 + a3)
            speed += h / 6 * (b0 + 2 * b1 + 2 * b2 + b3)
            x += h / 6 * (c0 + 2 * c1 + 2 * c2 + c3)
        re, im = 2 * re / steps, 2 * im / steps
        if math.hypot(re - before_re, im - before_im) < SETTLED * math.hypot(re, im):
            break
        before_re, before_im = re, im
    return math.hypot(re, im), math.atan2(im, re)


@njit
def predictions(parameters, points, steps):
    out = np.empty((points.shape[0], 2))
    p = np.empty(6)
    p[:4] = parameters
    for i in range(points.shape[0]):
        p[4], p[5] = points[i, 1], points[i, 0]
        out[i] = fundamental(p, points[i, 2], points[i, 3], steps)
    return out


def residuals(logarithms, points, steps):
    predicted = predictions(np.exp(logarithms), points, steps)
    turn = (predicted[:, 1] - points[:, 6] + math.pi) % TAU - math.pi
    return np.concatenate([(predicted[:, 0] - points[:, 4]) / points[:, 5], turn / points[:, 7]])


def main():
    with open(TABLE, newline="") as file:
        points = np.array([[float(cell) for cell in row] for row in list(csv.reader(file))[1:]])
    exact = predictions(np.array(START), points, 1600)[:, 0]
    for steps in (50, 100, 200, 400, 800):
        error = np.max(np.abs(predictions(np.array(START), points, steps)[:, 0] / exact - 1))
        if error <= ERROR:
            break
    started, cpu = time.perf_counter(), time.process_time()
    fit = least_squares(
        residuals, np.log(START), bounds=np.log(BOUNDS), loss="huber", f_scale=4.0, diff_step=1e-5, args=(points, steps)
    )
    seconds, cpu = time.perf_counter() - started, time.process_time() - cpu
    count = fit.nfev + len(START) * fit.njev
    print(f"scipy over numba: {steps} steps a cycle (amplitudes within {error:.1e}), {count} times all {len(points)} points")
    command = ["cargo", "run", "--quiet", "--release", "--locked", "--example", "fit_time"]
    own = json.loads(subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout)
    print("| fit | chi2 | kc / (N/m) | cc / (N s/m) | beta | v_0 / (m/s) | processor time / s |")
    print("|---|---|---|---|---|---|---|")
    chi2 = float(np.sum(residuals(fit.x, points, steps) ** 2))
    row = lambda name, chi2, v, s: print(f"| {name} | {chi2:.1f} | {v[0]:.4g} | {v[1]:.4g} | {v[2]:.4g} | {v[3]:.3g} | {s:.3g} |")
    row("least_squares over numba", chi2, np.exp(fit.x), cpu)
    row("stickslip, one thread", own["chi2"], own["values"], own["seconds"])
    print(f"ratio {cpu / own['seconds']:.0f}; wall time of the peer {seconds:.1f} s")


if __name__ == "__main__":
    main()
