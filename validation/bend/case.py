"""A channel 32 cm wide with a bend of 90 degrees and, behind it, a contraction to 24 cm, 3-D; 10 cm of water at first at rest,
6.4 l/s (0.2 m/s) come in. The ground is one closed surface made by ./embacle reach. Does any water leave the channel; do the
discharges balance?"""

import sys

import h5py
import numpy as np
from validate import ROOT

sys.path.insert(0, str(ROOT / "tools"))
import reach  # noqa: E402

TITLE = "bend and contraction, 3-D: no leaks, discharges balance"
SECONDS = {"quick": 10, "normal": 120, "full": 120}
SPACING = {"quick": (0.02,), "normal": (0.02,), "full": (0.02, 0.01)}  # l0 [m]
PATH, WIDTH, LEVEL, DISCHARGE = "straight 0.9; left 90 radius 0.7; straight 1.5", 0.32, 0.1, 6.4e-3
THROAT = (2.6, 0.8, 0.24)  # along the path [m], length [m], width [m]


def outside(water):
    """How far [m] places are outside the channel, at most."""
    stations, _ = reach.path_of(PATH, 0.01)
    s, x, y, heading = stations.T
    half = 0.5 * (WIDTH + (THROAT[2] - WIDTH) * reach.hump(s, *THROAT[:2]))
    farthest = -1.0
    for part in np.array_split(water, max(1, len(water) // 2000)):
        nearest = np.argmin((part[:, :1] - x)**2 + (part[:, 1:2] - y)**2, axis=1)
        n = -(part[:, 0] - x[nearest]) * np.sin(heading[nearest]) + (part[:, 1] - y[nearest]) * np.cos(heading[nearest])
        farthest = max(farthest, (abs(n) - half[nearest]).max(), (-part[:, 2]).max())
    return farthest


def measure(context):
    seconds = SECONDS[context.effort]
    folder = context.results / context.case
    folder.mkdir(parents=True, exist_ok=True)
    context.tool("reach.py", "channel", "--path", PATH, "--width", WIDTH, "--height", 0.22, "--depth", LEVEL, "--thickness", 0.08,
                 "--contraction", *THROAT, "--out", folder / "ground.stl")
    for spacing in SPACING[context.effort]:
        name = f"l0 {100 * spacing:g} cm, {seconds} s"
        run = context.run(f"l0-{100 * spacing:g}cm", context.folder / "scene.toml",
                          [f"run.end_time={seconds}", f"parameters.l0={spacing}", f'parameters.ground="{folder}/ground.stl"',
                           f'parameters.water="{folder}/ground-water.stl"'])
        farthest = -1.0
        with h5py.File(run.folder / "fields.h5") as file:
            for number in range(len(file["times"])):
                frame = file[f"frame_{number:06}"]
                farthest = max(farthest, outside(frame["position"][...][frame["type"][...] == 0].astype(float)))
        yield run.bar(f"{name}: farthest water outside the channel, any frame", farthest / spacing, -1, 0.3, "l0", "no leak")
        inlet, outlet = ({key: np.array(values) for key, values in run.table(f"openings/{end}.csv").items()}
                         for end in ("inlet", "outlet"))
        mass = np.array(run.table("energies.csv")["mass"])
        stored = (mass[-1] - mass[0]) / 1000
        lost = np.ptp(inlet["volume"]) - np.ptp(outlet["volume"]) - stored
        yield run.bar(f"{name}: volume that is not accounted for", 100 * lost / (mass[0] / 1000), -0.1, 0.1, "% of the water",
                      "inflow = outflow + what is held")
        late = inlet["t"] > 0.5 * seconds
        rates = [np.polyfit(end["t"][late], end["volume"][late], 1)[0] for end in (inlet, outlet)]
        yield run.bar(f"{name}: inflow less what was asked, second half", 100 * (rates[0] / DISCHARGE - 1), -0.5, 0.5, "%",
                      "conservation", seconds >= 60)
        yield run.bar(f"{name}: outflow less inflow, second half", 100 * (rates[1] / rates[0] - 1), -0.5, 0.5, "%", "conservation",
                      seconds >= 60)
        panel = "levels; t [s]; m"
        for gauge in ("before", "throat"):
            table = run.table(f"gauges/{gauge}.csv")
            time, level = np.array(table["t"]), np.array(table["level"])
            context.curve(panel, f"{gauge}, {name}", time, np.convolve(level, np.ones(20) / 20, "same")[: len(time)])
            yield run.bar(f"{name}: level {gauge}, mean of the second half", level[time > 0.5 * seconds].mean(), 0.09, 0.12, "m",
                          "outlet at 0.1 m", False)
