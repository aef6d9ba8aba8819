#!/usr/bin/env python3
"""Steady states of every effect of the catalogue, by integration in time.

    python3 tests/reference/effects.py --check        a sample of the rows of all tables, integrated again (a minute or two)
    python3 tests/reference/effects.py --check all    every row
    python3 tests/reference/effects.py --write        makes every row of all tables anew (half an hour)

The paper's rig (Eqs. 1-8): J th'' + C th' + K th = drive + b F, bristles F = kc x + cc x' in series with friction mu(s) N:
`tests/data/effects.csv`. Most of the rows there of the catalogue's first effects come from a third program, and are checked here. An
oscillator without a contact: M x'' + C x' + K x = f sin(w t) + force of the effect: `tests/data/effects-alone.csv`. The laws are stated
below and in effects.c. Rows of a drift are of the second series. `tests/data/branches.csv`: three relaxations side by side, on the
paper's rig.
Shares no code with the program; needs Python 3.9 and a C compiler.
"""

import argparse
import cmath
import ctypes
import math
import os
import subprocess
import sys
import tempfile

HERE = os.path.dirname(os.path.abspath(__file__))
DATA = os.path.join(HERE, "..", "data")
BESIDE, ALONE = os.path.join(DATA, "effects.csv"), os.path.join(DATA, "effects-alone.csv")
BRANCHES = os.path.join(DATA, "branches.csv")

STEPS, CYCLES, CYCLES_OF_BERG = 4000, 110, 600
POT, POT_STEP, POT_RANGE = 48, 0.5, 1e4
STEPS_ALONE = 20000
ELEMENTS, STEPS_OF_JOINT = 200, 4000
BRUSH, CYCLES_OF_STATE = 1000, 400
CLOSE = 1e-4

PAPER = dict(J=5.0e-3, K0=990.0, C0=0.43, k0=1.6e4, c0=12.0, a=0.030, b=0.060, kc=8.9e4, cc=26.0, mu=0.5)
CONDITIONS = [(0.0, 20.0, 2.5e-6), (5e-5, 20.0, 2.5e-6), (1e-4, 10.0, 2.5e-6), (0.02, 20.0, 2.5e-6), (0.0, 0.1, 7.5e-6)]
FREQUENCIES = [58.0, 70.0, 74.0, 82.0, 94.0]
ON_CONTACT = [
    ("none", {}),
    ("stribeck", dict(delta_mu=0.15, v_s=0.15)),
    ("rate-strengthening", dict(beta=0.12, v_0=0.001)),
    ("grosch", dict(delta_mu=0.5, v_m=0.1, h=1)),
    ("rate-and-state", dict(a=0.1, B=0.08, v_0=0.0001, D_c=6e-05)),
    ("frictional-heating", dict(P_0=10, tau=0.003)),
    ("normal-coupling", dict(k_n=40000)),
    ("maxwell-branch", dict(k_1=30000, tau=0.002)),
    ("partial-slip", dict(n=2)),
    ("contact-renewal", dict(len=9e-05)),
    ("lugre", dict(sigma_2=8)),
    ("cubic-stiffness", dict(K_3=8e+07)),
    ("quadratic-damping", dict(D_2=40)),
    ("structural-damping", dict(eta=0.03)),
    ("actuator-lag", dict(tau=0.0004)),
    ("roller-compliance", dict(m_r=0.3, k_r=120000, zeta_r=0.05)),
    ("sensor-delay", dict(tau=0.0003)),
    ("viscous-film", dict(b=1.5)),
    ("load-stiffening", dict(m=0.4, N_ref=12.0)),
    ("spring-pot", dict(c_a=3e4, a=0.3, t_0=0.002)),
    ("spring-pot", dict(c_a=15000.0, a=0.65, t_0=0.003)),
    ("berg-friction", dict(F_max=0.01, x_2=3e-7)),
    ("berg-friction", dict(F_max=0.005, x_2=3e-8)),
    ("quintic-stiffness", dict(K_5=1.2e15)),
    ("asymmetric-stiffness", dict(K_2=1.5e5)),
    ("asymmetric-stiffness", dict(K_2=-1e5)),
    ("residual-modes", dict(R_c=2e-4, R_m=-30.0)),
    ("crosstalk", dict(b_r=-0.4, b_i=0.7)),
    ("drift", dict(d_2=0.06, g_2=-0.05)),
]
PRONY_SERIES = [("maxwell-branch", dict(k_1=30000, tau=0.002, k_1_2=20000, tau_2=0.0004, k_1_3=10000, tau_3=0.02))]

OSCILLATOR = dict(mass=2.0, f0=80.0, Q=30.0)
FORCES = [1.0, 3.0]
RATIOS = [0.6, 0.95, 1.0, 1.02, 1.2]
BY_ITSELF = [
    ("quintic-stiffness", dict(K_5=1.5e19)),
    ("asymmetric-stiffness", dict(K_2=6e8)),
    ("clearance", dict(k_g=2e4, g=2e-5)),
    ("power-damping", dict(D=0.3, p=0.5, v_0=0.02)),
    ("power-damping", dict(D=0.6, p=1.5, v_0=0.02)),
    ("power-damping", dict(D=0.5, p=3.2, v_0=0.03)),
    ("power-damping", dict(D=0.7, p=0.0, v_0=1.0)),
    ("friction-joint", dict(k_t=1.2e5, F_s=3.0, n=1.0)),
    ("friction-joint", dict(k_t=1.2e5, F_s=3.0, n=2.5)),
    ("friction-joint", dict(k_t=8e4, F_s=5.0, n=1.6)),
    ("pivot-friction", dict(F_c=0.4)),
    ("pivot-friction", dict(F_c=0.9)),
    ("pivot-friction", dict(F_c=1.2)),
    ("residual-modes", dict(R_c=3e-7, R_m=-0.4)),
    ("crosstalk", dict(b_r=1.5, b_i=-4.0)),
    ("drift", dict(d_2=-0.03, g_2=0.2)),
]


def library():
    folder = tempfile.mkdtemp()
    built = os.path.join(folder, "effects.so")
    subprocess.run(["cc", "-O2", "-shared", "-fPIC", os.path.join(HERE, "effects.c"), "-o", built, "-lm"], check=True)
    return ctypes.CDLL(built)


LIBRARY = library()
FRICTION = {"stribeck": (1, "delta_mu", "v_s"), "rate-strengthening": (2, "beta", "v_0"),
            "grosch": (3, "delta_mu", "v_m", "h"), "viscous-film": (4, "b"),
            "hump": (5, "delta_mu", "v_h", "b")}
SPRINGS = {"asymmetric-stiffness": "K_2", "cubic-stiffness": "K_3", "quintic-stiffness": "K_5"}


def read(amplitude, effect, p, omega, drive, stiffness):
    """What the instrument shows of a motion Im[A exp(i w t)]: amplitude and phase."""
    if effect == "crosstalk":
        amplitude += complex(p["b_r"], p["b_i"]) * drive / stiffness
    if effect == "drift":
        amplitude *= 1.0 + p["g_2"]
    if effect == "residual-modes":
        amplitude += (p["R_c"] + p["R_m"] / omega**2) * drive
    if effect == "sensor-delay":
        amplitude *= cmath.exp(-1j * omega * p["tau"])
    return abs(amplitude), cmath.phase(amplitude)


def spring_pot(size, order, w):
    """size (i w)^order as (spring, dashpot, relaxations): the integral over all rates r of r^(order - 1) i w/(i w + r), at equal
    steps of ln r from w/POT_RANGE to w POT_RANGE, what is slower as a spring, what is faster as a dashpot."""
    scale, steps = size * math.sin(math.pi * order) / math.pi * POT_STEP, round(2 * math.log(POT_RANGE) / POT_STEP)
    rates = [w / POT_RANGE * math.exp(POT_STEP * n) for n in range(steps + 1)]
    spring = scale * rates[0] ** order / (math.exp(POT_STEP * order) - 1.0)
    dashpot = scale * rates[-1] ** (order - 1.0) / (math.exp(POT_STEP * (1.0 - order)) - 1.0)
    return spring, dashpot, [number for r in rates for number in (scale * r**order, r)]


def further(effect, p, speed, load):
    """The numbers at the end of `rig` in effects.c."""
    leave = speed / p["len"] if effect == "contact-renewal" else 0.0
    heat = (p["P_0"], p["tau"]) if effect == "frictional-heating" else (0.0, 1.0)
    age = (p["a"], p["B"], p["v_0"], p["D_c"]) if effect == "rate-and-state" else (0.0, 0.0, 1.0, 0.0)
    surface = (0.0, 0.0, 0.0)
    if effect == "roller-compliance":
        surface = (p["m_r"], 2.0 * p["zeta_r"] * math.sqrt(p["m_r"] * p["k_r"]), p["k_r"])
    lugre = (1.0, p["sigma_2"]) if effect == "lugre" else (0.0, 0.0)
    slips, shares = [0.0] * BRUSH, [0.0] * BRUSH
    if effect == "partial-slip":
        # The finer the less they stretch before they slip: a small motion has elements enough.
        most, ends = p["n"] * PAPER["mu"] * load / PAPER["kc"], [(i / BRUSH) ** 4 for i in range(BRUSH + 1)]
        slips = [most * (1.0 - (1.0 - 0.5 * (a + b)) ** (1.0 / (p["n"] - 1.0))) for a, b in zip(ends, ends[1:])]
        shares = [b - a for a, b in zip(ends, ends[1:])]
    return [leave, *heat, *age, *surface, *lugre, BRUSH if effect == "partial-slip" else 0, *slips, *shares]


def beside(effect, p, speed, load, u0, frequency, steps=STEPS):
    """(amplitude, phase, mean) on the paper's rig, so many steps a cycle."""
    r, w = PAPER, 2.0 * math.pi * frequency
    stiffness, damping = r["K0"] + 2.0 * r["a"] ** 2 * r["k0"], r["C0"] + 2.0 * r["a"] ** 2 * r["c0"]
    drive = r["a"] * u0 * (r["k0"] + 1j * w * r["c0"])
    kc, cc = r["kc"], r["cc"]
    law, springs, extra = (0,), dict.fromkeys(SPRINGS.values(), 0.0), dict(D2=0.0, kn=0.0, k1=0.0, tau=1.0)
    if effect in FRICTION:
        law = (FRICTION[effect][0], *(p[key] for key in FRICTION[effect][1:]))
    elif effect in SPRINGS:
        springs = {**springs, **p}
    elif effect == "quadratic-damping":
        extra["D2"] = p["D_2"]
    elif effect == "structural-damping":
        damping += p["eta"] * stiffness / w
    elif effect == "normal-coupling":
        extra["kn"] = p["k_n"]
    elif effect == "maxwell-branch":
        extra.update(k1=p["k_1"], tau=p["tau"])
    elif effect == "drift":
        stiffness *= 1.0 + p["d_2"]
    elif effect == "actuator-lag":
        drive /= 1.0 + 1j * w * p["tau"]
    elif effect == "load-stiffening":
        kc, cc = kc * (load / p["N_ref"]) ** p["m"], cc * (load / p["N_ref"]) ** p["m"]
    berg, pot = (0.0, 1.0), [number for j in range(2, 9) if f"k_1_{j}" in p for number in (p[f"k_1_{j}"], 1.0 / p[f"tau_{j}"])]
    if effect == "berg-friction":
        berg = (p["F_max"], p["x_2"])
    elif effect == "spring-pot":
        spring, dashpot, pot = spring_pot(p["c_a"] * p["t_0"] ** p["a"], p["a"], w)
        kc, cc = kc + spring, cc + dashpot
    more = further(effect, p, speed, load)
    law = (*law, 1.0, 1.0, 1.0)[:4]
    numbers = [r["J"], damping, stiffness, drive.real, drive.imag, r["b"], kc, cc, r["mu"], speed, load, w, *law,
               springs["K_2"], springs["K_3"], springs["K_5"], *extra.values(), *berg, len(pot) // 2, *pot, *[0.0] * (2 * POT - len(pot)), *more]
    slow = dict.fromkeys(("rate-and-state", "contact-renewal", "lugre"), CYCLES_OF_STATE)
    cycles = {"berg-friction": CYCLES_OF_BERG, **slow}.get(effect, CYCLES)
    re, im, mean, change = integrate(LIBRARY.contact, numbers, steps, cycles)
    if change > 1e-6:
        raise ArithmeticError(f"{effect} {p} at {speed} {load} {u0} {frequency}: not settled, {change:.1e}")
    return *read(complex(re, im), effect, p, w, drive, stiffness), mean


def joint(p):
    """Elements of a joint with F_s (1 - (1 - x/x_m)^n) on the way out, x_m = n F_s/k_t: their stiffness and the stretch at which
    each slips, the middle ones of so many equal parts of k_t."""
    most, count = p["n"] * p["F_s"] / p["k_t"], 1 if p["n"] == 1.0 else ELEMENTS
    if count == 1:
        return p["k_t"], [most]
    shares = [(i + 0.5) / count for i in range(count)]
    return p["k_t"] / count, [most * (1.0 - (1.0 - share) ** (1.0 / (p["n"] - 1.0))) for share in shares]


def alone(effect, p, force, frequency):
    """(amplitude, phase, mean) of the oscillator."""
    mass, f0, quality = OSCILLATOR.values()
    w0, w = 2.0 * math.pi * f0, 2.0 * math.pi * frequency
    stiffness, damping = mass * w0**2, mass * w0 / quality
    stiffness *= 1.0 + (p["d_2"] if effect == "drift" else 0.0)
    springs = {**dict.fromkeys(SPRINGS.values(), 0.0), **(p if effect in SPRINGS else {})}
    stop = (p["k_g"], p["g"]) if effect == "clearance" else (0.0, 1.0)
    power, dry = (0.0, 1.0, 1.0), 0.0
    if effect == "pivot-friction":
        dry = p["F_c"]
    elif effect == "power-damping":
        dry, power = (p["D"], power) if p["p"] == 0.0 else (0.0, (p["D"], p["v_0"], p["p"]))
    numbers = [mass, damping, stiffness, force, w, springs["K_2"], springs["K_3"], springs["K_5"], *stop, *power, dry]
    k_e, slips = joint(p) if effect == "friction-joint" else (0.0, [])
    numbers += [len(slips), k_e, *slips, *[0.0] * (ELEMENTS - len(slips))]
    steps = STEPS_OF_JOINT if len(slips) > 1 else STEPS_ALONE
    re, im, mean, change = integrate(LIBRARY.alone, numbers, steps, int(9 * quality))
    if re == im == 0.0:
        return 0.0, 0.0, 0.0  # it sticks
    if change > 1e-7:
        raise ArithmeticError(f"{effect} {p} at {force} {frequency}: not settled, {change:.1e}")
    if effect == "friction-joint":
        mean = 0.0  # what the start leaves in elements that slip no more
    return *read(complex(re, im), effect, p, w, force, stiffness), mean


def integrate(run, numbers, steps, cycles):
    out = (ctypes.c_double * 4)(0.0, 0.0, 0.0, 1.0)
    run((ctypes.c_double * len(numbers))(*numbers), ctypes.c_long(steps), ctypes.c_long(cycles), out)
    return list(out)


def written(p):
    return " ".join(f"{key}={value:g}" for key, value in p.items())


def number(value, digits):
    return f"{value:.{digits}e}" if value else "0"


def rows_beside(effects=ON_CONTACT):
    for effect, p in effects:
        for speed, load, drive in CONDITIONS:
            for frequency in FREQUENCIES:
                try:
                    amplitude, phase, mean = beside(effect, p, speed, load, drive, frequency)
                except ArithmeticError as why:
                    print(f"left out: {why}", file=sys.stderr)
                    continue
                # What the start leaves in elements that slip no more is no mean.
                rests = effect == "partial-slip" and speed == 0.0
                mean = 0.0 if rests or abs(mean) < 1e-9 * amplitude else mean
                place = f"{speed},{load},{drive},{frequency}"
                yield f"{effect},{written(p)},{place},{amplitude:.8e},{phase:.7f},{number(mean, 8)}"


def rows_alone():
    for effect, p in BY_ITSELF:
        for force in FORCES:
            for ratio in RATIOS:
                frequency = ratio * OSCILLATOR["f0"]
                amplitude, phase, mean = alone(effect, p, force, frequency)
                mean = 0.0 if abs(mean) < 1e-7 * amplitude else mean
                yield f"{effect},{written(p)},{force},{frequency},{amplitude:.8e},{phase:.7f},{number(mean, 8)}"


def write():
    """Every row of all tables."""
    beside_header = "effect,parameters,speed_m_s,load_n,drive_m,frequency_hz,amplitude_rad,phase_rad,mean_rad"
    alone_header = "effect,parameters,force_n,frequency_hz,amplitude_m,phase_rad,mean_m"
    of_branches = rows_beside(PRONY_SERIES)
    for path, header, rows in ((BESIDE, beside_header, rows_beside()), (ALONE, alone_header, rows_alone()), (BRANCHES, beside_header, of_branches)):
        lines = [header, *rows]
        with open(path, "w", encoding="utf-8") as file:
            file.write("\n".join(lines) + "\n")


def check(every):
    """Whether every `every`-th row of each effect comes out again."""
    worst, failed = {}, 0
    for path, solve in ((BESIDE, beside), (ALONE, alone), (BRANCHES, beside)):
        with open(path, encoding="utf-8") as file:
            lines = file.read().splitlines()[1:]
        counts = {}
        for line in lines:
            effect, parameters, *fields = line.split(",")
            counts[effect] = counts.get(effect, 0) + 1
            if counts[effect] % every != (1 if every > 1 else 0):
                continue
            p = {key: float(value) for key, value in (pair.split("=") for pair in parameters.split())}
            *at, amplitude, phase, _ = map(float, fields)
            found = solve(effect, p, *at)
            error = max(abs(found[0] / amplitude - 1.0) if amplitude else found[0], abs(found[1] - phase) if amplitude else 0.0)
            key = ("several branches" if path == BRANCHES else effect, "on the contact" if solve is beside else "alone")
            worst[key] = max(worst.get(key, 0.0), error)
            failed += error > CLOSE
    for (effect, where), error in worst.items():
        print(f"{effect:22} {where:15} {error:.1e}")
    print(f"{failed} rows differ by more than {CLOSE}")
    return failed == 0


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--write", action="store_true", help="make every row of all tables anew")
    parser.add_argument("--check", nargs="?", const="sample", choices=("sample", "all"), help="integrate rows again")
    options = parser.parse_args()
    if options.write:
        write()
    if options.check:
        sys.exit(0 if check(7 if options.check == "sample" else 1) else 1)


if __name__ == "__main__":
    main()
