"""A dam breaks at once in a long channel, 2-D: bore and plateau against Stoker (wet bed), profile against Ritter (dry).

Shallow water theory wants a hydrostatic pressure, so it holds late (t sqrt(g/h0) > 8, the bore has gone many depths) and
away from steep places: the front of the bore itself, and the tip on a dry bed, where water is thinner than the particles.
Its own bores are sharp; water makes an undular or breaking one, of the same mean speed and depth. Where such a bore is: at
the step in depth that holds as much water (a level of a front that spreads has its own speed; that at half the height is
reported beside it). Depth is the volume of water per length of channel. Exact states: stoker.csv (rarefaction and Rankine-Hugoniot), ritter.csv (self-similar).
"""

import sys

import numpy as np
from validate import ROOT, CaseError, read_columns

sys.path.insert(0, str(ROOT / "tools"))

from run_folder import Frames, RunFolderError  # noqa: E402

TITLE = "dam break on a wet and on a dry bed, 2-D, against shallow water theory"
DEPTH = 0.15  # [m]
WAVE = np.sqrt(9.81 * DEPTH)  # [m/s]
STOKER = {0.025: "thesis_Hdo2.5cm", 0.05: "thesis_Hdo5cm"}  # downstream depth [m] to the row of stoker.csv
BEGIN = 1.0  # [s]: eight depths of time
RUNS = {"quick": [(15, 0.05), (15, 0)], "normal": [(15, 0.05), (30, 0.05), (30, 0.025), (15, 0), (30, 0)],
        "full": [(15, 0.05), (30, 0.05), (60, 0.05), (30, 0.025), (60, 0.025), (15, 0), (30, 0), (60, 0)]}


class Profiles:
    """Depth and mean velocity along the channel at every frame of a run, in bins of a fifth of h0."""

    def __init__(self, folder, distance):
        try:
            frames = Frames(str(folder))
            self.times = np.array(frames.times)
            rows = [frames.read(k, "position", "velocity", "type") for k in range(len(self.times))]
        except RunFolderError as error:
            raise CaseError(str(error)) from None
        width = 0.2 * DEPTH
        lower = width * np.floor(min(row[0][row[2] == 0, 0].min() for row in rows) / width)
        upper = max(row[0][row[2] == 0, 0].max() for row in rows)
        edges = np.arange(lower, upper + 2 * width, width)
        self.x, self.width = 0.5 * (edges[1:] + edges[:-1]), width
        self.depth, self.velocity = [], []
        for position, velocity, kind in rows:
            place, speed = position[kind == 0, 0], velocity[kind == 0, 0]
            count = np.histogram(place, edges)[0]
            self.depth.append(count * distance**2 / width)
            self.velocity.append(np.histogram(place, edges, weights=speed)[0] / np.maximum(count, 1))

    def farthest(self, frame, level):
        """Farthest place where the depth falls through a level."""
        depth = self.depth[frame]
        k = np.nonzero((depth[:-1] >= level) & (depth[1:] < level))[0][-1]
        return self.x[k] + (depth[k] - level) / (depth[k] - depth[k + 1]) * (self.x[k + 1] - self.x[k])

    def step(self, frame, begin, level, downstream):
        """Place of the step from a level down to the depth downstream that holds the water beyond `begin`."""
        depth = self.depth[frame]
        beyond = np.nonzero((self.x > begin) & (depth > 0))[0][:-1]  # the end of the channel cuts the last bin
        volume = (depth[beyond] - downstream).sum() * self.width
        return self.x[beyond[0]] - 0.5 * self.width + volume / (level - downstream)



def exact(folder, downstream):
    """Row of stoker.csv by column name."""
    with (folder / "stoker.csv").open(encoding="utf-8") as stream:
        names, *rows = [line.strip().split(",") for line in stream if line.strip()]
    row = next(row for row in rows if row[0] == STOKER[downstream])
    return dict(zip(names[1:], map(float, row[1:])))


def stoker(context, run, label, profiles, downstream, held):
    state = exact(context.folder, downstream)
    depth, velocity, bore = state["h_mid_m"], state["u_mid_m_s"], state["shock_speed_m_s"]
    late = [k for k, time in enumerate(profiles.times) if time >= BEGIN]
    half = [profiles.farthest(k, 0.5 * (depth + downstream)) for k in late]
    steps, depths, velocities = [], [], []
    for k in late:
        plateau = (profiles.x > 0.2 * bore * profiles.times[k]) & (profiles.x < 0.8 * bore * profiles.times[k])
        depths.append(profiles.depth[k][plateau].mean())
        steps.append(profiles.step(k, 0.8 * bore * profiles.times[k], depths[-1], downstream))
        velocities.append(profiles.velocity[k][plateau].mean())
    panel = f"{100 * downstream:g} cm downstream, {profiles.times[-1]:.1f} s; x / (c0 t); h / h0"
    end = profiles.times[-1] * WAVE
    if not any(curve["panel"] == panel for curve in context.curves):
        fan = np.linspace(-1, state["tail_speed_m_s"] / WAVE, 30)
        context.curve(panel, "Stoker", [-1.4, *fan, bore / WAVE, bore / WAVE, 1.6],
                      [1, *((2 - fan) ** 2 / 9), depth / DEPTH, downstream / DEPTH, downstream / DEPTH], reference=True)
    shown = (profiles.x > -1.4 * end) & (profiles.x < 1.6 * end)
    context.curve(panel, label, profiles.x[shown] / end, profiles.depth[-1][shown] / DEPTH)
    source = f"Stoker: {bore:.3f} m/s, {depth:.4f} m, {velocity:.3f} m/s"
    for name, places, required in (("", steps, held), (" at half its height", half, False)):
        speed = np.polyfit(profiles.times[late], places, 1)[0]
        yield run.bar(f"{label}: speed of the bore{name}", 100 * (speed / bore - 1), -2, 2, "%", source, required)
    for name, values, theory in (("depth", depths, depth), ("velocity", velocities, velocity)):
        yield run.bar(f"{label}: {name} of the plateau", 100 * (np.mean(values) / theory - 1), -3, 3, "%", source, held)


def ritter(context, run, label, profiles, distance, held):
    curve = read_columns(context.folder / "ritter.csv")
    place, depth = np.array(curve["x/(c0 t)"]), np.array(curve["h/h0"])
    late = [k for k, time in enumerate(profiles.times) if time >= BEGIN]
    gate = np.abs(profiles.x) < 0.1
    depths = np.mean([profiles.depth[k][gate].mean() for k in late]) / DEPTH
    velocities = np.mean([profiles.velocity[k][gate].mean() for k in late]) / WAVE
    errors = []
    for k in late:
        scaled = profiles.x / (WAVE * profiles.times[k])
        inside = (scaled > -0.6) & (scaled < 1)
        theory = np.interp(scaled[inside], place, depth)
        errors.append(np.sqrt(np.mean((profiles.depth[k][inside] / DEPTH - theory) ** 2)))
    tips = [profiles.farthest(k, distance) for k in late]
    tip = np.polyfit(profiles.times[late], tips, 1)[0] / WAVE
    panel = f"dry bed, {profiles.times[-1]:.1f} s; x / (c0 t); h / h0"
    if not any(curve["panel"] == panel for curve in context.curves):
        context.curve(panel, "Ritter", place, depth, reference=True)
    end = profiles.times[-1] * WAVE
    context.curve(panel, label, profiles.x / end, profiles.depth[-1] / DEPTH)
    yield run.bar(f"{label}: depth at the dam", 100 * (depths * 9 / 4 - 1), -3, 3, "%", "Ritter: 4/9 h0", held)
    yield run.bar(f"{label}: velocity at the dam", 100 * (velocities * 3 / 2 - 1), -3, 3, "%", "Ritter: 2/3 c0", held)
    yield run.bar(f"{label}: RMS of the profile, x/(c0 t) from -0.6 to 1", 100 * np.mean(errors), 0, 3, "% of h0",
                  "Ritter", held)
    yield run.bar(f"{label}: speed of the tip (one layer deep)", tip, 1.94, 2.06, "c0", "Ritter: 2 c0, without friction",
                  required=False)


def measure(context):
    for layers, downstream in RUNS[context.effort]:
        distance = DEPTH / layers
        bed = f"{100 * downstream:g} cm" if downstream else "dry"
        label = f"{bed}, h0/l0 {layers}"
        settings = [f"parameters.l0={distance!r}", f"parameters.downstream={downstream}"]
        if not downstream:
            settings += ["parameters.channel=5", "run.end_time=2"]
        run = context.run(f"{bed.replace(' ', '-')}-{layers}", context.folder / "scene.toml", settings)
        profiles = Profiles(run.folder, distance)
        held = layers >= 30  # the thinnest water of the coarser runs is five particles deep
        if downstream:
            yield from stoker(context, run, label, profiles, downstream, held)
        else:
            yield from ritter(context, run, label, profiles, distance, held)
