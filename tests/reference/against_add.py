#!/usr/bin/env python3
"""Holds `discover` against `add`: no effect added by hand, and none added to the best of these, may explain more.

    python3 tests/reference/against_add.py DIR [--binary PATH] [--jobs 1] [--only NAME ...]

For each DIR/<name>/table.csv (or DIR/<name>/scenario.toml, where there is one) the scenario that `discover -o` writes is compared with
every effect that `add` takes, and with every second effect beside the best of them, by Schwarz's criterion of what `compare` says of
each: squares over those of the noise - where `discover` leaves structure, over the mean square of what is left - and ln(readings) for
each free parameter. Prints a line where `add` is better by more than 0.5, and the counts. Needs Python 3.9 or later and nothing else.
"""

import argparse
import concurrent.futures
import json
import math
import os
import shutil
import sys
import tempfile

import score

MOST = 0.5


def compared(binary, scenario, timeout):
    """(chi2 per reading, parameters, readings, Schwarz's criterion), or None where nothing comes out."""
    output, failure = score.call([binary, "compare", scenario, "--json", "-"], timeout)
    if failure:
        return None
    told = json.loads(output)
    return told["chi2_per_point"], len(told["parameters"]), told["readings"], told["bic"]


def criterion(fit, unit):
    chi2, parameters, readings, bic = fit
    if unit == 1.0:
        return bic
    return chi2 / unit * readings + parameters * math.log(readings)


def added(binary, scenario, scratch, effects, timeout):
    """The scenario with a further effect each: [(fit, effect, file)]."""
    found = []
    for effect in effects:
        file = os.path.join(scratch, f"{len(os.listdir(scratch))}.toml")
        _, failure = score.call([binary, "add", effect, scenario, "-o", file], timeout)
        fit = None if failure or not os.path.exists(file) else compared(binary, file, timeout)
        if fit:
            found.append((fit, effect, file))
    return found


def examine(binary, folder, name, effects, timeout):
    """(name, what discover came to, its best, structured, best of add, its names) or (name, why not)."""
    with tempfile.TemporaryDirectory(prefix="stickslip-against-") as scratch:
        own = os.path.join(folder, name)
        scenario = os.path.join(scratch, "start.toml")
        if os.path.exists(os.path.join(own, "scenario.toml")):
            shutil.copytree(own, scratch, dirs_exist_ok=True)
            scenario = os.path.join(scratch, "scenario.toml")
        else:
            _, failure = score.call([binary, "new", os.path.join(own, "table.csv"), "-o", scenario], timeout)
            if failure:
                return name, failure
        start = compared(binary, scenario, timeout)
        explained = os.path.join(scratch, "explained.toml")
        output, failure = score.call([binary, "discover", scenario, "-o", explained, "--json", "-"], timeout)
        end = None if failure else compared(binary, explained, timeout)
        if not (start and end):
            return name, failure or "compare: no comparison"
        told = json.loads(output)
        structured, verdict, effects_found = told["steps"][-1]["structured"], told["verdict"], told["effects"]
        # What is listed above the explanation, since it is too little better to decide for it.
        last = set(told["steps"][-1]["parameters"])
        ahead = max((c["delta_bic"] for c in told["candidates"] if set(c["parameters"]) == last), default=0.0)
        once = added(binary, scenario, scratch, effects, timeout)
        twice = []
        if once:
            _, first, file = min(once, key=lambda found: criterion(found[0], 1.0))
            twice = [(fit, f"{first}+{second}", f) for fit, second, f in added(binary, file, scratch, effects, timeout)]
        by_hand = [(start, "nothing", "")] + once + twice
        unit = max(1.0, end[0]) if structured else 1.0
        reached = criterion(end, unit) - ahead
        fit, by, _ = min(by_hand, key=lambda found: criterion(found[0], unit))
        return name, verdict, "+".join(effects_found) or "-", reached, structured, criterion(fit, unit), by, end[0]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", metavar="DIR")
    parser.add_argument("--binary", metavar="PATH", default=os.path.join("target", "release", "stickslip"))
    parser.add_argument("--effects", metavar="LIST", required=True, help="names that `add` is asked for, with commas")
    parser.add_argument("--jobs", type=int, default=1, help="tables at a time")
    parser.add_argument("--timeout", type=float, default=120.0, help="seconds for each command")
    parser.add_argument("--only", metavar="NAME", nargs="+", help="these tables only")
    options = parser.parse_args()
    names = [n for n in sorted(os.listdir(options.folder)) if os.path.isdir(os.path.join(options.folder, n))]
    names = [n for n in names if not options.only or n in options.only]
    binary, effects = os.path.abspath(options.binary), options.effects.split(",")
    worse, compared_with = 0, 0
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        for told in pool.map(lambda n: examine(binary, options.folder, n, effects, options.timeout), names):
            if len(told) == 2:
                print(f"{told[0]}: {told[1]}", flush=True)
                continue
            name, verdict, found, reached, structured, best, by, chi2 = told
            compared_with += 1
            if best < reached - MOST:
                worse += 1
                print(f"{name}: {verdict} {found} chi2 {chi2:.3g}, `add {by}` better by {reached - best:.1f}"
                      f"{', beside structure' if structured else ''}", flush=True)
    print(f"add better by more than {MOST:g} in {worse} of {compared_with}")
    sys.exit(0 if worse == 0 else 1)


if __name__ == "__main__":
    main()
