#!/usr/bin/env python3
"""Runs validation cases and prints error against run time: ./embacle validate [CASE ...] [--quick|--full] [--report DIR].

A case is a folder here with case.py, which defines TITLE and measure(context), a generator of Bar objects: it runs scenes
through context.run and compares what came out with reference data in its folder. What it hands to context.curve and
context.note goes into the report. A report in DIR keeps the cases that are not run again, so that one can be made of several
runs, and one that was interrupted holds the cases that had ended. Here standard library only; cases may use numpy and h5py.
"""

import argparse
import csv
import dataclasses
import datetime
import importlib.util
import json
import os
import pathlib
import re
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
MPIRUN = ["mpirun", "-q", "--oversubscribe", "--bind-to", "none", "--mca", "btl_vader_single_copy_mechanism", "none",
          "--mca", "mpi_yield_when_idle", "1", "-n"]
CURVE_POINTS = 500  # of a curve in the report, about


class CaseError(Exception):
    """A run of a case failed or left out what the case needs."""


@dataclasses.dataclass
class Bar:
    """One measured quantity beside the range it must lie in."""

    name: str  # "variant: quantity"; the report plots a quantity over the variants
    value: float
    lower: float
    upper: float
    unit: str
    seconds: float  # wall time of the run it comes from
    source: str = ""  # of the range
    required: bool = True  # False: reported, but a miss does not fail the validation
    core_seconds: float = 0  # ranks times wall time of the simulation alone; 0: not for the work-precision plot
    run: str = ""  # folder of the run it comes from, below the results

    @property
    def inside(self):
        return self.lower <= self.value <= self.upper


@dataclasses.dataclass
class Run:
    """A run: its folder, its wall time, its summary.json (empty unless it finished) and how it ended."""

    folder: pathlib.Path
    seconds: float
    summary: dict
    status: int = 0
    message: str = ""  # last lines that the run printed

    def bar(self, name, value, lower, upper, unit, source, required=True):
        """A bar whose value comes from this run."""
        work = self.summary.get("wall_seconds", 0) * self.summary.get("fluid_ranks", 1)
        return Bar(name, float(value), lower, upper, unit, self.seconds, source, required, work,
                   f"{self.folder.parent.name}/{self.folder.name}")

    def table(self, name):
        """A CSV file of the run by column name without unit: energies.csv, gauges/NAME.csv. Lists of numbers."""
        return read_columns(self.folder / name)


class Context:
    """What a case gets: the effort asked for, and the way to run scenes."""

    def __init__(self, case, effort, results, options=()):
        self.case, self.effort, self.results, self.options = case, effort, results, options
        self.folder = ROOT / "validation" / case
        self.curves, self.notes = [], []

    def run(self, name, scene, settings=(), options=(), allowed=(0,)):
        """Runs a scene into results/NAME; settings are key.path=value. Raises CaseError if it ends with another status
        than the allowed ones."""
        out = self.results / self.case / name
        command = [str(ROOT / "embacle"), "run", str(scene), "--out", str(out), "--no-pictures", *self.options, *options]
        for setting in settings:
            command += ["--set", setting]
        print(f"  {self.case}/{name} ...", flush=True)
        status, seconds = finished_before(out, command)
        if status is None:
            out.mkdir(parents=True, exist_ok=True)
            (out / RECORD).unlink(missing_ok=True)
            start = time.monotonic()
            with (out / "validate.log").open("w") as log:
                status = subprocess.run(command, stdout=log, stderr=subprocess.STDOUT).returncode
            seconds = time.monotonic() - start
            (out / RECORD).write_text(json.dumps(record_of(command) | {"status": status, "seconds": seconds}) + "\n")
        tail = (out / "validate.log").read_text().splitlines()[-5:]
        if status not in allowed:
            raise CaseError(f"{name}: the run ended with status {status}:\n    " + "\n    ".join(tail))
        summary = json.loads((out / "summary.json").read_text()) if status == 0 else {}
        return Run(out, seconds, summary, status, "\n".join(tail))

    def liggghts(self, name, script, ranks=1, **variables):
        """Runs a LIGGGHTS script without water, in results/NAME; variables are those of the script. The summary has what
        the log says of its last `run`. Raises CaseError if it fails."""
        out = self.results / self.case / name
        out.mkdir(parents=True, exist_ok=True)
        programs = pathlib.Path(os.environ.get("EMBACLE_BUILD", ROOT / "build")) / "bin"
        command = [*([*MPIRUN, str(ranks)] if ranks > 1 else []), str(programs / "liggghts-mps"), "-in", str(script)]
        for key, value in variables.items():
            command += ["-var", key, *(map(str, value) if isinstance(value, (list, tuple)) else [str(value)])]
        environment = dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
        start = time.monotonic()
        with (out / "validate.log").open("w") as log:
            status = subprocess.run(command, stdout=log, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL, cwd=out,
                                    env=environment).returncode
        seconds = time.monotonic() - start
        text = (out / "validate.log").read_text()
        if status != 0:
            reasons = [line for line in text.splitlines() if "error:" in line] or text.splitlines()[-5:]
            raise CaseError(f"{name}: the run ended with status {status}: " + "\n    ".join(reasons))
        summary = {"wall_seconds": seconds, "fluid_ranks": ranks}
        for key, pattern in (("loop_seconds", r"Loop time of (\S+)"), ("megabytes", r"processor = (\S+) Mbytes")):
            found = re.findall(pattern, text)
            summary[key] = float(found[-1]) if found else 0.0
        return Run(out, seconds, summary)

    def curve(self, panel, label, x, y, reference=False, points=False):
        """A curve of the report's picture. Panel: "title; x axis; y axis" says where it goes."""
        x, y = ([float(f"{float(value):.6g}") for value in values] for values in (x, y))
        every = 1 if points else max(1, len(x) // CURVE_POINTS)
        self.curves.append({"panel": panel, "label": label, "x": x[::every], "y": y[::every], "reference": reference,
                            "points": points})

    def note(self, line):
        """A line of Markdown under the table of the case."""
        self.notes.append(line)

    def tool(self, name, *arguments):
        """Output of a program of tools/. Raises CaseError if it fails."""
        done = subprocess.run(["/usr/bin/python3", str(ROOT / "tools" / name), *map(str, arguments)],
                              capture_output=True, text=True)
        if done.returncode != 0:
            raise CaseError(f"tools/{name}: {done.stderr.strip()}")
        return done.stdout


RECORD = "validate.json"  # in the folder of a run that has ended


def record_of(command):
    return {"command": command, "revision": revision()}


def finished_before(out, command):
    """Status and wall time of a run in this folder that ended by itself, by the same command and commit; None, None without one."""
    try:
        record = json.loads((out / RECORD).read_text())
    except (OSError, ValueError):
        return None, None
    known = record["revision"] != "unknown" and not record["revision"].endswith("-dirty")
    same = known and record.items() >= record_of(command).items() and record["status"] in (0, 2, 3, 5)
    return (record["status"], record["seconds"]) if same else (None, None)


def read_columns(path):
    """A CSV file with a header of `name [unit]` columns: dictionary of name (no unit) to a list of numbers."""
    with path.open(encoding="utf-8") as stream:
        rows = list(csv.reader(stream))
    names = [column.split("[")[0].strip() for column in rows[0]]
    return {name: [float(row[k]) for row in rows[1:]] for k, name in enumerate(names)}


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
    parser.add_argument("--fluid-ranks", metavar="N", help="ranks of each run")
    parser.add_argument("--json", type=pathlib.Path, metavar="FILE", help="write the results there as well")
    parser.add_argument("--resume", type=pathlib.Path, metavar="DIR",
                        help="results of a validation that was interrupted: runs that ended there, by the same commit, are taken as they are")
    parser.add_argument("--report", type=pathlib.Path, metavar="DIR",
                        help="write report.md, report.html and a picture a case there; other cases of a report that is there stay")
    parser.set_defaults(effort="normal")
    options = parser.parse_args(arguments)
    for case in options.cases:
        if case not in cases():
            parser.error(f"there is no case '{case}'; there are: {', '.join(cases())}")
    if options.resume and not options.resume.is_dir():
        parser.error(f"--resume {options.resume}: there is no such folder; allowed: one that a validation has named under 'Results'")
    return options


def validate_case(case, options, results):
    """Runs a case; its results as they stand in validation.json."""
    module = load(case)
    print(f"\n## {case}: {module.TITLE}\n", flush=True)
    context = Context(case, options.effort, results, ["--fluid-ranks", options.fluid_ranks] if options.fluid_ranks else [])
    bars, error = [], None
    try:
        for bar in module.measure(context):
            bars.append(bar)
    except CaseError as problem:
        error = str(problem)
    text = "\n".join([table(bars), *([""] + context.notes if context.notes else [])])
    print("\n" + text, flush=True)
    if error:
        print(f"\n{case}: not finished: {error}", file=sys.stderr)
    return {"title": module.TITLE, "effort": options.effort, "revision": revision(), "error": error, "text": text,
            "curves": context.curves,
            "missed": error is not None or any(bar.required and not bar.inside for bar in bars),
            "bars": [dataclasses.asdict(bar) | {"value": float(bar.value), "inside": bool(bar.inside)} for bar in bars]}


def revision():
    """The commit of the sources, with a mark if they differ from it."""
    try:
        return subprocess.run(["git", "-C", str(ROOT), "describe", "--always", "--dirty"], capture_output=True, text=True,
                              check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


def front_page(cases):
    """One row a case: how many of its required bars hold, and which do not, by how much."""
    lines = ["| case | required bars that hold | reported only | falls short |", "|---|---|---|---|"]
    for case, result in sorted(cases.items()):
        required = [bar for bar in result["bars"] if bar["required"]]
        missed = [f"{bar['name']}: {number(bar['value'])} {bar['unit']} (allowed {number(bar['lower'])} .. {number(bar['upper'])})"
                  for bar in required if not bar["inside"]]
        if result["error"]:
            missed.insert(0, f"**not finished**: {result['error'].splitlines()[0]}")
        lines.append(f"| [{case}](#{case}) | {len(required) - sum(not bar['inside'] for bar in required)} of {len(required)} | "
                     f"{len(result['bars']) - len(required)} | {'; '.join(missed)} |")
    return "\n".join(lines)


def write_report(case, result, folder):
    """Puts a case into report.md and report.html, with pictures beside them; all from validation.json there, which also says
    of which run each value is."""
    folder.mkdir(parents=True, exist_ok=True)
    data = folder / "validation.json"
    outcome = json.loads(data.read_text()) if data.exists() else {"cases": {}}
    outcome["cases"][case] = result
    write_whole(data, json.dumps(outcome, separators=(",", ":")) + "\n")
    plots = subprocess.run(["/usr/bin/python3", str(ROOT / "tools/validation_plots.py"), str(folder)]).returncode == 0
    lines = ["# Validation", "", front_page(outcome["cases"]), "",
             "Inside: the value lies in the allowed range. Run: wall time, on whatever else the machine had to do. Values to all "
             "digits, the run that each comes from, and all curves: [validation.json](validation.json).", ""]
    for case, result in sorted(outcome["cases"].items()):
        lines += [f"## {case}", "", f"{result['title'][0].upper()}{result['title'][1:]}.", "",
                  f"Effort: {result['effort']}; commit {result['revision']}.", "", result["text"], ""]
        if result["error"]:
            lines += [f"**Not finished**: {result['error']}", ""]
        if plots and (folder / f"{case}.png").exists():
            lines += [f"![{result['title']}]({case}.png)", ""]
    write_whole(folder / "report.md", "\n".join(lines))
    subprocess.run(["/usr/bin/python3", str(ROOT / "tools/report_page.py"), str(folder)])


def write_whole(path, text):
    beside = path.with_name(path.name + ".part")
    beside.write_text(text)
    os.replace(beside, path)


def validate(options):
    stamp = datetime.datetime.now().strftime("%Y%m%d-%H%M%S")
    results = options.resume.resolve() if options.resume else ROOT / "runs" / f"validation-{stamp}"
    results.mkdir(parents=True, exist_ok=True)
    print(f"Results: {results} (if interrupted, continue with --resume)", flush=True)
    outcome = {"effort": options.effort, "cases": {}}
    for case in options.cases or cases():
        outcome["cases"][case] = validate_case(case, options, results)
        for path in filter(None, (results / "validation.json", options.json)):
            write_whole(path, json.dumps(outcome, indent=1) + "\n")
        if options.report:
            write_report(case, outcome["cases"][case], options.report)
    if options.report:
        print(f"Report: {options.report}/report.md")
    return 1 if any(result["missed"] for result in outcome["cases"].values()) else 0


if __name__ == "__main__":
    sys.exit(validate(parse(sys.argv[1:])))
