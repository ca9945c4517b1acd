#!/usr/bin/env python3
"""Runs validation cases and prints error against run time: ./embacle validate [CASE ...] [--quick|--full] [--json FILE].

A case is a folder here with case.py, which defines TITLE and measure(context), a generator of Bar objects: it runs scenes
through context.run and compares what came out with reference data in its folder. Standard library only, except where a
case reads fields (h5py, numpy).
"""

import argparse
import dataclasses
import datetime
import importlib.util
import json
import os
import pathlib
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent


class CaseError(Exception):
    """A run of a case failed or left out what the case needs."""


@dataclasses.dataclass
class Bar:
    """One measured quantity beside the range it must lie in."""

    name: str
    value: float
    lower: float
    upper: float
    unit: str
    seconds: float  # wall time of the run it comes from
    source: str = ""  # of the range
    required: bool = True  # False: reported, but a miss does not fail the validation

    @property
    def inside(self):
        return self.lower <= self.value <= self.upper


@dataclasses.dataclass
class Run:
    """A finished run: its folder, its wall time and its summary.json."""

    folder: pathlib.Path
    seconds: float
    summary: dict


class Context:
    """What a case gets: the effort asked for, and the way to run scenes."""

    def __init__(self, case, effort, results):
        self.case, self.effort, self.results = case, effort, results
        self.folder = ROOT / "validation" / case

    def run(self, name, scene, settings=(), options=()):
        """Runs a scene into results/NAME; settings are key.path=value. Raises CaseError if it fails."""
        out = self.results / self.case / name
        command = [str(ROOT / "embacle"), "run", str(scene), "--out", str(out), "--no-pictures", *options]
        for setting in settings:
            command += ["--set", setting]
        print(f"  {self.case}/{name} ...", flush=True)
        out.mkdir(parents=True, exist_ok=True)
        start = time.monotonic()
        with (out / "validate.log").open("w") as log:
            status = subprocess.run(command, stdout=log, stderr=subprocess.STDOUT).returncode
        seconds = time.monotonic() - start
        if status != 0:
            tail = (out / "validate.log").read_text().splitlines()[-5:]
            raise CaseError(f"{name}: the run ended with status {status}:\n    " + "\n    ".join(tail))
        return Run(out, seconds, json.loads((out / "summary.json").read_text()))

    def tool(self, name, *arguments):
        """Output of a program of tools/. Raises CaseError if it fails."""
        done = subprocess.run(["/usr/bin/python3", str(ROOT / "tools" / name), *map(str, arguments)],
                              capture_output=True, text=True)
        if done.returncode != 0:
            raise CaseError(f"tools/{name}: {done.stderr.strip()}")
        return done.stdout


def cases():
    return sorted(path.parent.name for path in (ROOT / "validation").glob("*/case.py"))


def load(case):
    path = ROOT / "validation" / case / "case.py"
    spec = importlib.util.spec_from_file_location("case_" + case.replace("-", "_"), path)
    module = importlib.util.module_from_spec(spec)
    sys.modules.setdefault("validate", sys.modules[__name__])
    spec.loader.exec_module(module)
    return module


def number(value):
    return "inf" if value == float("inf") else "-inf" if value == float("-inf") else f"{value:.4g}"


def table(bars):
    """Markdown, one row a bar."""
    lines = ["| quantity | value | allowed | unit | inside | run [s] | reference |", "|---|---|---|---|---|---|---|"]
    for bar in bars:
        verdict = "yes" if bar.inside else ("**no**" if bar.required else "no (reported only)")
        lines.append(f"| {bar.name} | {number(bar.value)} | {number(bar.lower)} .. {number(bar.upper)} | {bar.unit} | "
                     f"{verdict} | {bar.seconds:.0f} | {bar.source} |")
    return "\n".join(lines)


def parse(arguments):
    parser = argparse.ArgumentParser(prog="./embacle validate", description="Validation: error against run time.")
    parser.add_argument("cases", nargs="*", metavar="CASE", help="default: all; " + ", ".join(cases()))
    effort = parser.add_mutually_exclusive_group()
    effort.add_argument("--quick", dest="effort", action="store_const", const="quick", help="minutes")
    effort.add_argument("--full", dest="effort", action="store_const", const="full", help="also finer resolutions: hours")
    parser.add_argument("--json", type=pathlib.Path, metavar="FILE", help="write the results there as well")
    parser.set_defaults(effort="normal")
    options = parser.parse_args(arguments)
    for case in options.cases:
        if case not in cases():
            parser.error(f"there is no case '{case}'; there are: {', '.join(cases())}")
    return options


def validate(options):
    stamp = datetime.datetime.now().strftime("%Y%m%d-%H%M%S")
    results = ROOT / "runs" / f"validation-{stamp}"
    report, failed = {"effort": options.effort, "cases": {}}, False
    for case in options.cases or cases():
        module = load(case)
        print(f"\n## {case}: {module.TITLE}\n", flush=True)
        bars, error = [], None
        try:
            for bar in module.measure(Context(case, options.effort, results)):
                bars.append(bar)
        except CaseError as problem:
            error = str(problem)
        print("\n" + table(bars))
        if error:
            print(f"\n{case}: not finished: {error}", file=sys.stderr)
        failed |= error is not None or any(bar.required and not bar.inside for bar in bars)
        report["cases"][case] = {
            "title": module.TITLE, "error": error,
            "bars": [dataclasses.asdict(bar) | {"inside": bar.inside} for bar in bars]}
    print(f"\nResults: {results}")
    results.mkdir(parents=True, exist_ok=True)
    for path in filter(None, (results / "validation.json", options.json)):
        beside = path.with_name(path.name + ".part")
        beside.write_text(json.dumps(report, indent=2) + "\n")
        os.replace(beside, path)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(validate(parse(sys.argv[1:])))
