"""Times of one steady state: stickslip beside what one would use instead, in one run on one machine.

    python benches/peers/peers.py          (from anywhere; see README.md beside this file)

Every method solves the base law of the rig at the same three operating points in partial stick and is set to the
cheapest of its settings that keeps the relative error of alpha within 1e-4. Times are the smallest of several repeats.
"""

import contextlib
import json
import math
import os
import platform
import subprocess
import sys
import time
from importlib.metadata import version
from pathlib import Path

for threads in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS"):
    os.environ[threads] = "1"

import numpy as np  # noqa: E402
from harmonicbalance.fourier import Fourier  # noqa: E402
from harmonicbalance.solvers import fouriersolve_ode  # noqa: E402
from numba import njit  # noqa: E402
from scipy.integrate import solve_ivp  # noqa: E402

ROOT = Path(__file__).resolve().parents[2]
TAU = 2 * math.pi
# The paper's rig and contact, SI.
J, K0, C0, K1, C1, A, B = 5.0e-3, 990.0, 0.43, 1.6e4, 12.0, 0.030, 0.060
KC, CC, MU = 8.9e4, 26.0, 0.5
K, C = K0 + 2 * A * A * K1, C0 + 2 * A * A * C1
SPEED, LOAD, DRIVE = 5e-5, 20.0, 2.5e-6
FREQUENCIES = (60.0, 74.0, 82.0)
DEMANDED = 1e-4
EQUAL = 1e-10  # about the error of the program
SETTLED = 1e-6  # change of the fundamental over a cycle at which a transient counts as dead
MAX_CYCLES = 500


def best_of(work, repeats):
    """Smallest processor time of several calls after one that does not count: `repeats` of them, fewer (at least 3) after 3 s."""
    work()
    times, began = [], time.perf_counter()
    while len(times) < repeats and (len(times) < 3 or time.perf_counter() - began < 3.0):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return min(times)


# --- (a) the published procedure, compiled -----------------------------------------------------------------------


@njit
def euler(frequency, steps):
    """Explicit Euler with the paper's trial force until the fundamental is steady: (re, im, cycles)."""
    w = TAU * frequency
    dt = TAU / w / steps
    sine, cosine = np.empty(steps), np.empty(steps)
    for i in range(steps):
        sine[i], cosine[i] = math.sin(w * dt * i), math.cos(w * dt * i)
    torque_re, torque_im = A * K1 * DRIVE, A * C1 * w * DRIVE
    limit = MU * LOAD
    th, speed, force = B * limit / K, 0.0, limit  # the start is full slip
    before_re, before_im = 0.0, 0.0
    for cycle in range(1, MAX_CYCLES + 1):
        re, im = 0.0, 0.0
        for i in range(steps):
            re += th * sine[i]
            im += th * cosine[i]
            torque = torque_re * sine[i] + torque_im * cosine[i]
            acceleration = (torque + B * force - C * speed - K * th) / J
            slip = SPEED - B * speed
            trial = force + (KC * slip - CC * B * acceleration) * dt
            th += speed * dt
            speed += acceleration * dt
            force = trial if abs(trial) < limit else math.copysign(limit, slip)
        re, im = 2 * re / steps, 2 * im / steps
        if math.hypot(re - before_re, im - before_im) < SETTLED * math.hypot(re, im):
            return re, im, cycle
        before_re, before_im = re, im
    return re, im, -1


def euler_converged(frequency):
    """Amplitude of the published formulation at vanishing step, extrapolated from two step sizes (first order)."""
    fine, finer = (math.hypot(*euler(frequency, n)[:2]) for n in (800_000, 1_600_000))
    return 2 * finer - fine


def euler_steps(frequency, converged):
    """Fewest steps a cycle, on a grid of ratio 1.1, from which on the error stays within the demand."""
    steps = 400_000
    while True:
        fewer = int(steps / 1.1)
        if abs(math.hypot(*euler(frequency, fewer)[:2]) / converged - 1) > DEMANDED:
            return steps
        steps = fewer


# --- the series contact, without dimensions ----------------------------------------------------------------------


class Series:
    """Motion about full slip in units of L = Gamma/K and 1/w: y = (angle, angular velocity, stretch)."""

    def __init__(self, frequency):
        w = TAU * frequency
        self.unit = A * DRIVE * math.hypot(K1, C1 * w) / K
        self.lead = math.atan2(C1 * w, K1)
        self.stiffness = K / (J * w * w)
        self.damping = C / (J * w)
        self.coupling = B * B * KC / (J * w * w)
        self.retardation = CC * w / KC
        self.roller = SPEED / (B * w * self.unit)
        self.limit = MU * LOAD / (KC * B * self.unit)
        self.weights = np.empty(2)

    def rates(self, t, y, mode):
        """`mode` 0 sticks, 1 slips forwards, -1 backwards; the last two of y gather the fundamental."""
        th, speed, stretch = y[0], y[1], y[2]
        if mode == 0:
            d = self.roller - speed
        elif mode == 1:
            d = -stretch / self.retardation
        else:
            d = (-stretch - 2 * self.limit) / self.retardation
        force = stretch + self.retardation * d
        acceleration = self.stiffness * (math.sin(t + self.lead) - th) - self.damping * speed + self.coupling * force
        return (speed, acceleration, d, th * math.sin(t) / math.pi, th * math.cos(t) / math.pi)

    def clipped(self, t, y, _mode=None):
        """The same without modes: the stretch rate is the relative speed, limited by what friction can carry."""
        upper = -y[2] / self.retardation
        d = min(max(self.roller - y[1], upper - 2 * self.limit / self.retardation), upper)
        force = y[2] + self.retardation * d
        acceleration = self.stiffness * (math.sin(t + self.lead) - y[0]) - self.damping * y[1] + self.coupling * force
        return (y[1], acceleration, d, y[0] * math.sin(t) / math.pi, y[0] * math.cos(t) / math.pi)

    def events(self, mode):
        """Ends of a mode: friction is exceeded (while sticking) or the slip rate returns to zero."""
        if mode == 0:

            def forwards(_t, y, _mode):
                return y[2] + self.retardation * (self.roller - y[1])

            def backwards(_t, y, _mode):
                return y[2] + self.retardation * (self.roller - y[1]) + 2 * self.limit

            forwards.direction, backwards.direction = 1, -1
            ends = [forwards, backwards]
        else:
            offset = 0.0 if mode == 1 else -2 * self.limit

            def rest(_t, y, _mode):
                return self.roller - y[1] - (-y[2] + offset) / self.retardation

            rest.direction = -mode
            ends = [rest]
        for end in ends:
            end.terminal = True
        return ends


def by_events(frequency, method, rtol, settled=SETTLED):
    """solve_ivp from event to event, from full slip until the fundamental is steady: (alpha, cycles)."""
    series = Series(frequency)
    events = {mode: series.events(mode) for mode in (-1, 0, 1)}
    y, mode, before = np.zeros(5), 1, np.zeros(2)
    t = 0.0
    for cycle in range(1, MAX_CYCLES + 1):
        y[3:] = 0.0
        end = TAU * cycle
        while t < end:
            part = solve_ivp(
                series.rates, (t, end), y, method, rtol=rtol, atol=rtol, events=events[mode], args=(mode,)
            )
            if not part.success:
                return math.nan, cycle
            t, y = part.t[-1], part.y[:, -1].copy()
            if part.status == 1:
                if mode != 0:
                    mode = 0
                else:
                    mode = 1 if len(part.t_events[0]) else -1
                # The state at the event satisfies the new mode up to rounding.
                if t < end:
                    t = np.nextafter(t, math.inf)
        if math.hypot(*(y[3:] - before)) < settled * math.hypot(*y[3:]):
            return math.hypot(*y[3:]) * series.unit, cycle
        before = y[3:].copy()
    return math.nan, MAX_CYCLES


def by_clipping(frequency, method, rtol, settled=SETTLED):
    """solve_ivp of the law without modes: (alpha, cycles)."""
    series = Series(frequency)
    y, before = np.zeros(5), np.zeros(2)
    for cycle in range(1, MAX_CYCLES + 1):
        y[3:] = 0.0
        part = solve_ivp(series.clipped, (TAU * (cycle - 1), TAU * cycle), y, method, rtol=rtol, atol=rtol)
        if not part.success:
            return math.nan, cycle
        y = part.y[:, -1].copy()
        if math.hypot(*(y[3:] - before)) < settled * math.hypot(*y[3:]):
            return math.hypot(*y[3:]) * series.unit, cycle
        before = y[3:].copy()
    return math.nan, MAX_CYCLES


# --- (c) harmonic balance ----------------------------------------------------------------------------------------


def by_harmonic_balance(frequency, harmonics):
    """The package harmonicbalance, alternating frequency and time, from full slip: (alpha, evaluations)."""
    series = Series(frequency)
    drive = Fourier(omega=1.0, n=harmonics)
    drive[1], drive[harmonics + 1] = math.sin(series.lead), math.cos(series.lead)
    width = 2 * series.limit / series.retardation

    def positive(x):
        return x.nonlinearity(lambda x: np.maximum(x, 0.0))

    def rates(y):
        th, speed, stretch = y
        relative, upper = series.roller - speed, stretch * (-1.0 / series.retardation)
        d = relative - positive(relative - upper) + positive(upper - width - relative)
        force = stretch + d * series.retardation
        acceleration = (drive - th) * series.stiffness - speed * series.damping + force * series.coupling
        return [speed, acceleration, d]

    # The linear response in full slip is the start.
    free = series.stiffness / complex(series.stiffness - 1.0, series.damping)
    start = [Fourier(omega=1.0, n=harmonics) for _ in range(3)]
    swing = free * complex(math.cos(series.lead), math.sin(series.lead))  # th = Im(swing e^{it})
    start[0][1], start[0][harmonics + 1] = swing.imag, swing.real
    start[1] = start[0].dt()
    with contextlib.redirect_stdout(open(os.devnull, "w")):
        found, solution = fouriersolve_ode(rates, start, tol=1e-8)
    if not solution.success:
        return math.nan, solution.nfev
    return math.hypot(found[0][1], found[0][harmonics + 1]) * series.unit, solution.nfev


# --- the table ---------------------------------------------------------------------------------------------------


def cheapest(solve, settings, reference, repeats=5, demanded=DEMANDED):
    """Of the settings that meet the demand the fastest: (seconds, setting, alpha, count); None where none does."""
    best = None
    for setting in settings:
        began = time.perf_counter()
        alpha, count = solve(*setting)
        if not abs(alpha / reference - 1) <= demanded:
            continue
        once = time.perf_counter() - began
        if best is None or once < 1.3 * best[0]:
            seconds = best_of(lambda: solve(*setting), repeats)
            if best is None or seconds < best[0]:
                best = (seconds, setting, alpha, count)
    return best


def stickslip():
    """The example of the repository, on one core: the program has no threads outside a sweep."""
    command = ["cargo", "run", "--quiet", "--release", "--locked", "--example", "steady_time"]
    output = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    return {point["frequency"]: point for point in json.loads(output)["base"]}


def tabulated(frequency):
    """Amplitude of the reference table of the tests, where it has the point."""
    for line in (ROOT / "tests/data/effects.csv").read_text().splitlines()[1:]:
        name, _, speed, load, _, f, alpha, *_ = line.split(",")
        if name == "none" and (float(speed), float(load), float(f)) == (SPEED, LOAD, frequency):
            return float(alpha)
    return None


def machine():
    """Processor, load, versions."""
    model = platform.processor()
    with contextlib.suppress(OSError):
        lines = Path("/proc/cpuinfo").read_text().splitlines()
        model = next((line.split(":")[1].strip() for line in lines if line.startswith("model name")), model)
    packages = ", ".join(f"{name} {version(name)}" for name in ("numpy", "numba", "scipy", "harmonicbalance"))
    load = os.getloadavg()[0]
    return (
        f"{time.strftime('%Y-%m-%d %H:%M UTC', time.gmtime())}, {model}, {os.cpu_count()} cores, "
        f"load average at the start {load:.2f}; Python {platform.python_version()}, {packages}"
    )


def main():
    print(machine() + "\n")
    ours = stickslip()
    rows = []
    for f in FREQUENCIES:
        reference, _ = by_events(f, "DOP853", 1e-12, 1e-10)
        check = tabulated(f)
        note = f", reference table {check / reference - 1:+.1e}" if check else ""
        print(f"{f:g} Hz: alpha {reference:.8e} rad (DOP853 at 1e-12{note})", file=sys.stderr)
        own = ours[f]
        cold, warm = own["cold"], own["warm"]

        def row(method, setting, alpha, error, seconds):
            rows.append((f, method, setting, alpha, error, seconds, seconds / cold))

        error = own["amplitude"] / reference - 1
        row("stickslip, cold start", f"{own['cycles']} cycles", own["amplitude"], error, cold)
        row("stickslip, warm start (0.5 Hz away)", "", own["amplitude"], error, warm)
        row("stickslip, cold, all derivatives", "", own["amplitude"], error, own["derivatives"])

        converged = euler_converged(f)
        print(f"    published formulation against series: {converged / reference - 1:+.2e}", file=sys.stderr)
        steps = euler_steps(f, converged)
        re, im, cycles = euler(f, steps)
        alpha = math.hypot(re, im)
        seconds = best_of(lambda: euler(f, steps), 7)
        row("published Euler, numba", f"{steps} steps, {cycles} cycles", alpha, alpha / converged - 1, seconds)

        tolerances = [10.0**-k for k in (3, 3.5, 4, 4.5, 5, 5.5, 6, 7)]
        methods = ("RK45", "DOP853", "LSODA", "Radau")
        for name, solve in (("events", by_events), ("clipped", by_clipping)):
            settings = [(f, method, rtol) for method in methods for rtol in tolerances]
            found = cheapest(solve, settings, reference)
            if found:
                seconds, (_, method, rtol), alpha, cycles = found
                setting = f"{method}, rtol {rtol:.0e}, {cycles} cycles"
                row(f"scipy solve_ivp, {name}", setting, alpha, alpha / reference - 1, seconds)

        # The same at an error nearer that of the program: the settings hold until the fundamental is as steady.
        settings = [(f, method, 10.0**-k, EQUAL / 10) for method in ("DOP853", "LSODA") for k in (8, 9, 10, 11)]
        found = cheapest(by_events, settings, reference, demanded=EQUAL)
        if found:
            seconds, (_, method, rtol, _), alpha, cycles = found
            setting = f"{method}, rtol {rtol:.0e}, {cycles} cycles"
            row(f"scipy solve_ivp, events, error below {EQUAL:.0e}", setting, alpha, alpha / reference - 1, seconds)

        settings = [(f, harmonics) for harmonics in (8, 12, 16, 24, 32, 48, 64, 96)]
        found = cheapest(by_harmonic_balance, settings, reference, 3)
        if found:
            seconds, (_, harmonics), alpha, count = found
            row("harmonicbalance", f"{harmonics} harmonics, {count} iterations", alpha, alpha / reference - 1, seconds)

    print("| Hz | method | setting | alpha / rad | relative error | time / us | times stickslip |")
    print("|---|---|---|---|---|---|---|")
    for f, method, setting, alpha, error, seconds, ratio in rows:
        print(f"| {f:g} | {method} | {setting} | {alpha:.7e} | {error:+.1e} | {1e6 * seconds:.1f} | {ratio:.1f} |")


if __name__ == "__main__":
    main()
