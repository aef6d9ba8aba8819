#!/usr/bin/env python3
"""Scores the program on a folder of tables with known answers.

    python3 tests/reference/score.py DIR [--binary PATH] [--jobs 1] [--timeout 60] [--search NAME=VALUE ...] [--only NAME ...]
                                     [--all] [--json FILE]

For each DIR/<name>/table.csv of DIR/answers.json it runs

    PATH new table.csv -o TMP/scenario.toml
    PATH discover TMP/scenario.toml --json -

and calls the outcome

    right         nothing planted and `nothing-missing`, or `effect-missing` with the planted effects and no other
    tied          `effect-missing` with as many effects as planted, each planted one named or in an `indistinguishable` group with
                  one that is named
    part          `effect-missing` with one of the two that were planted and nothing else
    undecided     `unexplained`, whatever helps there; nothing, or an effect of the catalogue, was planted
    wrong         `effect-missing` with anything else
    missed        `nothing-missing` or `recalibrate`, and something was planted, or a cause from outside
    false alarm   an effect or a recalibration, and nothing was planted
    flagged       a cause from outside the catalogue and `unexplained`, or no effect named
    kin           a cause from outside, and every effect named is one that answers.json calls nearly the same, or all are of a pair
                  with such a one that it says to miss by less than four standard deviations
    named         a cause from outside, and an effect named that is not: a false name
    failed        no answer

right, tied, flagged and kin pass. Exit status: 0 if all pass, 1 if not, 2 for bad usage. Prints what does not pass table by table
(`--all`: every table), the counts, shares with Wilson's 95 % intervals, and how many of the program's 95 % intervals hold the
true value where the planted effects were named (f0 and Q also where nothing was). Needs Python 3.9 or later and nothing else.
"""

import argparse
import collections
import concurrent.futures
import json
import math
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time


def call(command, timeout):
    """(output, None) or (output, why it failed). Status 1 is a gate that failed: the output counts all the same."""
    try:
        done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, timeout=timeout)
    except subprocess.TimeoutExpired:
        return "", f"{command[1]}: no answer within {timeout:g} s"
    except OSError as error:
        return "", f"{command[0]}: {error.strerror}"
    output = done.stdout.decode("utf-8", "replace")
    if done.returncode in (0, 1):
        return output, None
    said = done.stderr.decode("utf-8", "replace").strip().splitlines()
    return output, f"{command[1]}: status {done.returncode}: {said[0] if said else 'nothing on standard error'}"


PASS = ("right", "tied", "flagged", "kin")
OUTCOMES = ("right", "tied", "part", "undecided", "wrong", "missed", "false alarm", "flagged", "kin", "named", "failed")
Z = 1.959964  # 95 %, two-sided


def outcome(answer, found):
    verdict, effects, planted = found.get("verdict"), found.get("effects", []), answer["effects"]
    named = verdict == "effect-missing" and effects
    if answer.get("outside"):
        if named:
            pairs = map(set, answer["truth"].get("kin_pairs", []))
            return "kin" if set(effects) <= set(answer.get("kin", [])) or set(effects) in pairs else "named"
        return "missed" if verdict in ("nothing-missing", "recalibrate") else "flagged"
    if not planted and verdict == "nothing-missing":
        return "right"
    if verdict == "unexplained":
        return "undecided"
    if not planted:
        return "false alarm"
    if not named:
        return "missed"
    if set(effects) == set(planted):
        return "right"
    groups = found.get("indistinguishable", [])
    taken_for = [any(p in g and any(e in g for e in effects) for g in groups) or p in effects for p in planted]
    if len(effects) == len(planted) and all(taken_for):
        return "tied"
    return "part" if set(effects) < set(planted) else "wrong"


def units(truth, scenario, parameters):
    """(alpha, beta): the program's force over the true one, and its motion over the true one; None where not to be told.

    Where drive or reading are in volts of unknown sensitivity the program takes a mass of 1 kg and writes what sensitivity it
    needs. M' = M alpha/beta then fixes what its units are."""

    def stated(key):
        found = re.search(rf'^{key} = "?([-+0-9.eE]+)', scenario, re.MULTILINE)
        return float(found.group(1)) if found else None

    if "rig.mass" in parameters or "rig.inertia" in parameters:
        return 1.0, 1.0
    mass = stated("mass") or stated("inertia") or 1.0
    if truth["drive"] == "base" or "instrument.drive_sensitivity" in parameters:
        return mass / truth["M"], 1.0
    alpha = 1.0
    if "drive_n_per_v" in truth:
        sensitivity = stated("drive_sensitivity")
        if sensitivity is None:
            return None
        alpha = 1.0 / (sensitivity * abs(truth["drive_n_per_v"]))
    return alpha, alpha * truth["M"] / mass


def intervals(truth, found, scenario, planted):
    """{name: {value, low, high, true, covered}} in the program's units."""
    steps = found.get("steps") or [{}]
    parameters = steps[-1].get("parameters") or {}
    true = {"rig.natural_frequency": truth["f0"], "rig.quality_factor": truth["Q"]}
    true.update({f"effect.drift.{key}": value for key, value in truth.items() if "drift" in planted and key[:2] in ("d_", "g_")})
    scale = units(truth, scenario, parameters)
    if scale:
        alpha, beta = scale
        for effect, key, factor in (
            ("cubic-stiffness", "K_3", alpha / beta**3), ("quadratic-damping", "D_2", alpha / beta**2),
            ("friction-joint", "k_t", alpha / beta), ("friction-joint", "F_s", alpha), ("friction-joint", "n", 1.0),
            ("clearance", "k_g", alpha / beta), ("clearance", "g", beta), ("quintic-stiffness", "K_5", alpha / beta**5),
            ("asymmetric-stiffness", "K_2", alpha / beta**2), ("power-damping", "p", 1.0), ("pivot-friction", "F_c", alpha),
            ("residual-modes", "R_c", beta / alpha), ("residual-modes", "R_m", beta / alpha),
        ):
            if effect in planted:
                # The sign of an even law leaves no trace in a fundamental.
                true[f"effect.{effect}.{key}"] = (abs(truth[key]) if key == "K_2" else truth[key]) * factor
    told = {}
    for name, value in true.items():
        p = parameters.get(name)
        if p is None or p.get("low") is None or p.get("high") is None:
            continue
        slack = 1e-9 * abs(value)  # n = 1 lies on the bound of its interval
        told[name] = {
            "value": p.get("value"), "low": p["low"], "high": p["high"], "true": value,
            "covered": p["low"] - slack <= value <= p["high"] + slack,
        }
    return told


def wilson(hits, count):
    if count == 0:
        return 0.0, 1.0
    share, z2 = hits / count, Z * Z
    middle = (share + z2 / (2 * count)) / (1 + z2 / count)
    half = Z / (1 + z2 / count) * math.sqrt(share * (1 - share) / count + z2 / (4 * count * count))
    return max(0.0, middle - half), min(1.0, middle + half)


def examine(binary, folder, name, answer, timeout, search=()):
    table = os.path.join(folder, name, "table.csv")
    start, found, written = time.monotonic(), {}, ""
    with tempfile.TemporaryDirectory(prefix="stickslip-score-") as scratch:
        scenario = os.path.join(scratch, "scenario.toml")
        _, failure = call([binary, "new", table, "-o", scenario], timeout)
        if failure is None and not os.path.exists(scenario):
            failure = "new: no scenario written"
        if failure is None:
            with open(scenario, encoding="utf-8") as file:
                written = file.read()
            start = time.monotonic()
            settings = [word for setting in search for word in ("--search", setting)]
            output, failure = call([binary, "discover", scenario, "--json", "-", *settings], timeout)
            if failure is None:
                try:
                    found = json.loads(output)
                    if not isinstance(found, dict) or "verdict" not in found:
                        failure = "discover: no verdict in its JSON"
                except ValueError as error:
                    failure = f"discover: not JSON: {error}"
    seconds = time.monotonic() - start
    came_to = "failed" if failure else outcome(answer, found)
    told = intervals(answer["truth"], found, written, answer["effects"]) if came_to == "right" and "truth" in answer else {}
    return {
        "name": name, "planted": answer["effects"], "truth": answer.get("outside") or "+".join(answer["effects"]) or "none",
        "group": "outside" if answer.get("outside") else "+".join(answer["effects"]) or "none",
        "found": {} if failure else found, "failure": failure, "outcome": came_to, "right": came_to in PASS,
        "intervals": told, "seconds": seconds,
    }


def line(result, wide=18):
    found = result["found"]
    mark = "FAILED" if result["failure"] else result["outcome"]
    if result["failure"]:
        said = result["failure"]
    else:
        said = f"{found['verdict']:16s} {'+'.join(found.get('effects', [])) or '-'}"
        among = [g for g in found.get("indistinguishable", []) if set(g) & set(found.get("effects", []))]
        if among:
            said += "  (or " + "; ".join(" = ".join(g) for g in among) + ")"
    return f"{mark:11s} {result['name']:16s} {result['truth']:{wide}s} {said}  {result['seconds']:.1f} s"


def share(hits, count):
    low, high = wilson(hits, count)
    return {"hits": hits, "of": count, "share": hits / count if count else None, "low": low, "high": high}


def summary(results):
    """What is printed after the tables, and what --json writes."""
    matrix = collections.defaultdict(collections.Counter)
    for r in results:
        matrix[r["truth"]][r["outcome"]] += 1
    groups = collections.defaultdict(list)
    for r in results:
        groups["outside" if r["group"] == "outside" else "none" if not r["planted"] else f"{len(r['planted'])} planted"].append(r)
    passed = {name: share(sum(r["right"] for r in those), len(those)) for name, those in sorted(groups.items())}
    planted = [r for r in results if r["planted"]]
    shares = {
        "planted: right or honestly tied": share(sum(r["right"] for r in planted), len(planted)),
        "nothing planted: nothing missing": passed.get("none", share(0, 0)),
        "outside: flagged": share(sum(r["outcome"] in ("flagged", "kin") for r in results if r["group"] == "outside"),
                                  sum(r["group"] == "outside" for r in results)),
        "a false name, of all": share(sum(r["outcome"] in ("wrong", "false alarm", "named") for r in results), len(results)),
        "all that pass": share(sum(r["right"] for r in results), len(results)),
    }
    held = collections.defaultdict(list)
    for r in results:
        for name, told in r["intervals"].items():
            held[name].append(told["covered"])
    seconds = [r["seconds"] for r in results]
    slowest = max(results, key=lambda r: r["seconds"])
    return {
        "confusion": {truth: dict(counts) for truth, counts in sorted(matrix.items())},
        "passed": passed, "shares": shares,
        "coverage": {name: share(sum(hits), len(hits)) for name, hits in sorted(held.items())},
        "seconds": {"median": statistics.median(seconds), "slowest": slowest["seconds"], "slowest_table": slowest["name"]},
    }


def show(told):
    matrix = told["confusion"]
    used = [o for o in OUTCOMES if any(o in row for row in matrix.values())]
    wide = max(len(truth) for truth in matrix)
    print(f"{'truth':{wide}s}  " + "  ".join(f"{o:>{max(len(o), 3)}s}" for o in used))
    for truth, row in matrix.items():
        print(f"{truth:{wide}s}  " + "  ".join(f"{row.get(o, 0) or '.':>{max(len(o), 3)}}" for o in used))
    print()
    for title, those in (("", told["shares"]), ("95 % intervals that hold the truth, where named rightly", told["coverage"])):
        if title and those:
            print(title)
        for name, s in those.items():
            if s["of"]:
                print(f"  {name:40s} {s['hits']:4d}/{s['of']:<4d} {s['share']:6.1%}  ({s['low']:.1%} to {s['high']:.1%})")
    print()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", metavar="DIR")
    parser.add_argument("--binary", metavar="PATH", default=os.path.join("target", "release", "stickslip"))
    parser.add_argument("--jobs", type=int, default=1, help="tables at a time")
    parser.add_argument("--timeout", type=float, default=60.0, help="seconds for each of the two commands")
    parser.add_argument("--search", metavar="NAME=VALUE", action="append", default=[], help="an option of the search (docs/search.md)")
    parser.add_argument("--only", metavar="NAME", nargs="+", help="score these tables only")
    parser.add_argument("--all", action="store_true", help="a line for every table, not only for those that do not pass")
    parser.add_argument("--json", metavar="FILE", help="write the scores and every table's outcome")
    options = parser.parse_args()
    try:
        with open(os.path.join(options.folder, "answers.json"), encoding="utf-8") as file:
            answers = json.load(file)
    except (OSError, ValueError) as error:
        parser.error(f"{options.folder}/answers.json: {error}")
    names = [name for name in sorted(answers) if not options.only or name in options.only]
    if not names:
        parser.error("no table to score")
    binary = options.binary if os.sep not in options.binary else os.path.abspath(options.binary)

    results, wide = [], max(len(answers[name].get("outside") or "+".join(answers[name]["effects"]) or "none") for name in names)
    with concurrent.futures.ThreadPoolExecutor(max(options.jobs, 1)) as pool:
        tasks = [
            pool.submit(examine, binary, options.folder, name, answers[name], options.timeout, options.search)
            for name in names
        ]
        for task in tasks:
            results.append(task.result())
            if options.all or not results[-1]["right"]:
                print(line(results[-1], wide), flush=True)

    told = summary(results)
    print()
    show(told)
    right, failed = sum(r["right"] for r in results), sum(r["failure"] is not None for r in results)
    seconds = told["seconds"]
    print(
        f"right {right}/{len(results)}, failures {failed}, "
        f"median {seconds['median']:.1f} s, slowest {seconds['slowest']:.1f} s ({seconds['slowest_table']})"
    )
    if options.json:
        told["tables"] = [
            {
                "name": r["name"], "truth": r["truth"], "outcome": r["outcome"], "verdict": r["found"].get("verdict"),
                "effects": r["found"].get("effects"), "indistinguishable": r["found"].get("indistinguishable"),
                "failure": r["failure"], "seconds": round(r["seconds"], 2), "intervals": r["intervals"],
            }
            for r in results
        ]
        with open(options.json, "w", encoding="utf-8") as file:
            json.dump(told, file, indent=1)
            file.write("\n")
    sys.exit(0 if right == len(results) else 1)


if __name__ == "__main__":
    main()
