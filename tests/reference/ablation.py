#!/usr/bin/env python3
"""What each option of the search is worth: the score of a folder of tables with each changed by itself.

    python3 tests/reference/ablation.py DIR [--binary PATH] [--jobs 1] [--only NAME ...]

Prints a Markdown table: verdicts that pass (as `score.py` counts them), processor time, and the tables that passed by default
and do not now. `docs/search.md` holds it. Needs Python 3.9 or later and nothing else.
"""

import argparse
import concurrent.futures
import json
import os
import resource

import score

# Each option far enough from its default to tell, where it is of use, what would be lost.
CHANGES = (
    "", "starts=3", "entrants=1", "first_points=16", "first_points=32", "first_evaluations=1", "kept=0.1", "survivors=1", "beam=1",
    "max_effects=1", "budget=50000",
)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", metavar="DIR")
    parser.add_argument("--binary", metavar="PATH", default=os.path.join("target", "release", "stickslip"))
    parser.add_argument("--jobs", type=int, default=1, help="tables at a time")
    parser.add_argument("--timeout", type=float, default=600.0, help="seconds for each command")
    parser.add_argument("--only", metavar="NAME", nargs="+", help="these tables only")
    options = parser.parse_args()
    with open(os.path.join(options.folder, "answers.json"), encoding="utf-8") as file:
        answers = json.load(file)
    names = [name for name in sorted(answers) if not options.only or name in options.only]
    binary, by_default = os.path.abspath(options.binary), set()
    print("| changed | right | processor time | lost |\n|---|---|---|---|")
    for change in CHANGES:
        def examine(name, search=[change] if change else []):
            return score.examine(binary, options.folder, name, answers[name], options.timeout, search)

        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
            right = {result["name"] for result in pool.map(examine, names) if result["right"]}
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        by_default = by_default or right
        lost = ", ".join(sorted(by_default - right)) or "none"
        print(f"| {f'`{change}`' if change else 'nothing'} | {len(right)}/{len(names)} | {spent:.0f} s | {lost} |", flush=True)


if __name__ == "__main__":
    main()
