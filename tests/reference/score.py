#!/usr/bin/env python3
"""Scores the program on a folder of tables with known answers.

    python3 tests/reference/score.py DIR [--binary PATH] [--jobs 1] [--timeout 60] [--only NAME ...]

For each DIR/<name>/table.csv of DIR/answers.json it runs

    PATH new table.csv -o TMP/scenario.toml
    PATH discover TMP/scenario.toml --json -

and calls the outcome right if nothing was planted and the verdict is `nothing-missing`, or if the verdict is
`effect-missing` and its effects are those planted, or the planted one stands in an `indistinguishable` group with one that is
named. Exit status: 0 if all are right, 1 if not, 2 for bad usage. Needs Python 3.9 or later and nothing else.
"""

import argparse
import collections
import concurrent.futures
import json
import os
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


def is_right(planted, found):
    verdict, effects = found.get("verdict"), found.get("effects", [])
    if not planted:
        return verdict == "nothing-missing"
    if verdict != "effect-missing":
        return False
    if set(effects) == set(planted):
        return True
    groups = found.get("indistinguishable", [])
    taken_for = [any(p in g and any(e in g for e in effects) for g in groups) or p in effects for p in planted]
    return len(effects) == len(planted) and all(taken_for)


def examine(binary, folder, name, planted, timeout):
    table = os.path.join(folder, name, "table.csv")
    start, found = time.monotonic(), {}
    with tempfile.TemporaryDirectory(prefix="stickslip-score-") as scratch:
        scenario = os.path.join(scratch, "scenario.toml")
        _, failure = call([binary, "new", table, "-o", scenario], timeout)
        if failure is None and not os.path.exists(scenario):
            failure = "new: no scenario written"
        if failure is None:
            output, failure = call([binary, "discover", scenario, "--json", "-"], timeout)
            if failure is None:
                try:
                    found = json.loads(output)
                    if not isinstance(found, dict) or "verdict" not in found:
                        failure = "discover: no verdict in its JSON"
                except ValueError as error:
                    failure = f"discover: not JSON: {error}"
    seconds = time.monotonic() - start
    right = failure is None and is_right(planted, found)
    return {
        "name": name, "planted": planted, "found": {} if failure else found, "failure": failure,
        "right": right, "seconds": seconds,
    }


def line(result):
    found = result["found"]
    mark = "right" if result["right"] else "FAILED" if result["failure"] else "wrong"
    planted = "+".join(result["planted"]) or "none"
    if result["failure"]:
        said = result["failure"]
    else:
        said = f"{found['verdict']:16s} {'+'.join(found.get('effects', [])) or '-'}"
        among = [g for g in found.get("indistinguishable", []) if set(g) & set(found.get("effects", []))]
        if among:
            said += "  (or " + "; ".join(" = ".join(g) for g in among) + ")"
    return f"{mark:6s} {result['name']:16s} {planted:18s} {said}  {result['seconds']:.1f} s"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", metavar="DIR")
    parser.add_argument("--binary", metavar="PATH", default=os.path.join("target", "release", "stickslip"))
    parser.add_argument("--jobs", type=int, default=1, help="tables at a time")
    parser.add_argument("--timeout", type=float, default=60.0, help="seconds for each of the two commands")
    parser.add_argument("--only", metavar="NAME", nargs="+", help="score these tables only")
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

    results = []
    with concurrent.futures.ThreadPoolExecutor(max(options.jobs, 1)) as pool:
        tasks = [
            pool.submit(examine, binary, options.folder, name, answers[name]["effects"], options.timeout) for name in names
        ]
        for task in tasks:
            results.append(task.result())
            print(line(results[-1]), flush=True)

    kinds = collections.defaultdict(list)
    for result in results:
        kinds["+".join(result["planted"]) or "none"].append(result)
    print()
    for kind, those in sorted(kinds.items()):
        missed = collections.Counter(
            "failed" if r["failure"] else f"{r['found']['verdict']} {'+'.join(r['found'].get('effects', []))}".strip()
            for r in those if not r["right"]
        )
        but = "; ".join(f"{count} x {what}" for what, count in missed.most_common())
        print(f"{kind:18s} {sum(r['right'] for r in those):3d}/{len(those)}" + (f"   not: {but}" if but else ""))
    right, failed = sum(r["right"] for r in results), sum(r["failure"] is not None for r in results)
    seconds = [r["seconds"] for r in results]
    slowest = max(results, key=lambda r: r["seconds"])
    print(
        f"right {right}/{len(results)}, failures {failed}, "
        f"median {statistics.median(seconds):.1f} s, slowest {slowest['seconds']:.1f} s ({slowest['name']})"
    )
    sys.exit(0 if right == len(results) else 1)


if __name__ == "__main__":
    main()
