"""A soak: floes enter and leave a small reach for 100 000 windows, in a run that is killed and continued five times on other numbers
of ranks and in the other layout. Measured: the books of the floes, their tags, memory and speed.

The first half of the windows is done in five parts, each ended by SIGKILL where it happens to be and continued from the last
checkpoint; the second half goes through on one rank and one core, so that memory and speed can be compared with themselves.
"""

import csv
import os
import pathlib
import re
import signal
import statistics
import subprocess
import time

import validate

TITLE = "soak: floes enter and leave, the run is killed and continued"
WINDOWS = {"quick": 10_000, "normal": 100_000, "full": 1_000_000}
SCENE = validate.ROOT / "tests" / "scenes" / "small-reach"
STEP = 1 / 1430  # [s], of the scene; a window is a step
PARTS = (["--fluid-ranks", "2"], ["--fluid-ranks", "1"], ["--layout", "separate", "--fluid-ranks", "2", "--solid-ranks", "1"],
         ["--fluid-ranks", "3"], ["--layout", "separate", "--fluid-ranks", "1", "--solid-ranks", "2"])
LAST = ["--fluid-ranks", "1"]
SETTINGS = ("output.checkpoint_every=1.4", "output.bodies_every=0.1", "output.gauges_every=0.1")
PROGRESS = re.compile(r"t = (\S+) s of")


def ranks_below(parent):
    """Processes that compute, below a process."""
    found = []
    for child in pathlib.Path(f"/proc/{parent}/task/{parent}/children").read_text().split():
        try:
            name = pathlib.Path(f"/proc/{child}/comm").read_text().strip()
            found += [int(child)] if name.startswith(("mps", "embacle-shared", "liggghts-mps")) else ranks_below(child)
        except OSError:
            pass  # it has ended
    return found


def resident(process):
    """Megabytes in memory of the ranks of a run."""
    total = 0
    for rank in ranks_below(process.pid):
        try:
            status = pathlib.Path(f"/proc/{rank}/status").read_text()
        except OSError:
            continue
        total += sum(int(kilobytes) for kilobytes in re.findall(r"VmRSS:\s+(\d+)", status)) / 1024
    return total


def reached(out):
    """Simulated seconds of the last row of the books."""
    try:
        rows = (out / "floes.csv").read_text().splitlines()
        return float(rows[-1].split(",")[0])
    except (OSError, ValueError, IndexError):
        return 0.0


def go(out, options, log, kill_at=None):
    """Starts or continues the run. Returns [(wall time, simulated time, megabytes)] and the status; kill_at: simulated time at
    which all its processes get SIGKILL."""
    start = [str(validate.ROOT / "embacle"), "run"]
    start += ["--restart", str(out)] if (out / "checkpoint.h5").exists() else [str(SCENE), "--out", str(out)]
    command = [*start, "--no-pictures", *options]
    samples = []
    with log.open("a") as stream:
        process = subprocess.Popen(command, stdout=stream, stderr=subprocess.STDOUT, start_new_session=True)
        while process.poll() is None:
            time.sleep(0.5)
            samples.append((time.monotonic(), reached(out), resident(process)))
            if kill_at is not None and samples[-1][1] >= kill_at and (out / "checkpoint.h5").exists():
                for rank in ranks_below(process.pid):
                    os.kill(rank, signal.SIGKILL)
                process.wait()
    return samples, process.returncode


def confused(out):
    """Rows of the books that do not add up, tracks of bodies that jump, go back or come twice."""
    with (out / "floes.csv").open() as stream:
        books = [[float(cell) for cell in row] for row in list(csv.reader(stream))[1:]]
    wrong_rows = sum(start + entered != present + left for _, start, entered, present, left, _ in books)
    wrong_rows += sum(later[0] <= row[0] or later[2] < row[2] or later[4] < row[4] for row, later in zip(books, books[1:]))
    table = validate.read_columns(out / "bodies.csv")
    tracks = {}
    for tag, moment, x in zip(table["tag"], table["t"], table["x"]):
        tracks.setdefault(int(tag), []).append((moment, x))
    wrong_tracks = sum(tag != number for number, tag in enumerate(sorted(tracks), 1))
    for track in tracks.values():
        steps = [(b[0] - a[0], b[1] - a[1]) for a, b in zip(track, track[1:])]
        wrong_tracks += any(t > 0.11 or t <= 0 or x < -0.01 or x > 0.6 * t + 0.01 for t, x in steps)
    return wrong_rows, wrong_tracks, books, len(tracks)


def measure(context):
    windows = WINDOWS[context.effort]
    end = windows * STEP
    out = context.results / context.case / "reach"
    out.mkdir(parents=True)
    log = out / "validate.log"
    common = ["--end-time", repr(end)]
    for setting in SETTINGS:
        common += ["--set", setting]
    start = time.monotonic()
    for number, options in enumerate(PARTS):
        print(f"  {context.case}/part {number + 1} ({' '.join(options)}) ...", flush=True)
        _, status = go(out, [*common, *options], log, kill_at=(number + 0.5) / len(PARTS) * end / 2)
        if status == 0:
            raise validate.CaseError(f"part {number + 1} came to its end before it was killed")
    print(f"  {context.case}/last part ({' '.join(LAST)}) ...", flush=True)
    samples, status = go(out, [*common, *LAST], log)
    if status != 0:
        raise validate.CaseError(f"the last part ended with status {status}: {log.read_text()[-500:]}")
    seconds = time.monotonic() - start

    def bar(name, value, lower, upper, unit, source="", required=True):
        return validate.Bar(name, float(value), lower, upper, unit, seconds, source, required, run=f"{context.case}/reach")

    wrong_rows, wrong_tracks, books, floes = confused(out)
    yield bar("windows done", round(books[-1][0] / STEP), 0.99 * windows, 1.01 * windows, "-", "as asked")
    yield bar("times killed and continued", len(PARTS), 5, 5, "-", "", False)
    yield bar("floes that entered", books[-1][2], 3 * end - 20, 6 * end + 20, "-", "six a second, some wait")
    yield bar("rows of the books that do not add up", wrong_rows, 0, 0, "-", "entered = present + left")
    yield bar("tags missing, tracks that jump, go back or come twice", wrong_tracks, 0, 0, "-", f"{floes} floes")
    # The first tenth of the last part is left out: caches and buffers fill.
    running = [sample for sample in samples if sample[1] > 0 and sample[2] > 0][len(samples) // 10:-2]
    third = len(running) // 3
    early, late = (statistics.median(memory for *_, memory in part) for part in (running[:third], running[-third:]))
    long = context.effort != "quick"  # seconds tell of the machine
    yield bar("memory, last third of the last part to its first", late / early, 0.95, 1.01, "-", "flat", long)
    speeds = []
    for part in (running[:third], running[-third:]):
        speeds.append((part[-1][1] - part[0][1]) / (part[-1][0] - part[0][0]))
    yield bar("speed, last third of the last part to its first", speeds[1] / speeds[0], 0.95, 2, "-", "no slow-down above 5 %",
              long)
    moments = [sample[0] - running[0][0] for sample in running]
    context.curve("memory of the last part; wall time [s]; MB", "resident", moments, [sample[2] for sample in running])
    context.curve("speed of the last part; wall time [s]; windows done", "windows", moments,
                  [sample[1] / STEP for sample in running])
    context.note(f"Last part: {early:.1f} MB, {speeds[0] / STEP:.0f} windows a second at its beginning; {late:.1f} MB, "
                 f"{speeds[1] / STEP:.0f} at its end.")
