"""A column of water collapses on a dry bed, 2-D: front against experiments, volume, energy of the water once still.

The experiments' time starts when a gate or a diaphragm gives way, so the computed front may be late by one constant time
of at most 20 ms; where the gate is computed, also early, since no particle passes until it has risen by a spacing. The speed
of the surge is the slope of a straight line through the front beyond a place, at the measured times. README.md says which
series must be met and why.
"""

import dataclasses

import numpy as np

TITLE = "dam break on a dry bed, 2-D, against experiments"
LONGEST_LAG = 0.020  # [s]
GRAVITY = 9.81
INCH = 0.0254
RESOLUTIONS = {"quick": (16,), "normal": (16, 32), "full": (16, 32, 64)}  # a/l0, a the smaller side of the column
GATE_RESOLUTIONS = {"quick": (16,), "normal": (16, 32, 64), "full": (16, 32, 64, 128)}  # the gate is 1/30 of a thick


@dataclasses.dataclass
class Series:
    """Front Z = x/a over T = t sqrt(2g/a), from a column a wide and b high in a tank."""

    name: str
    file: str
    width: float  # a [m]
    height: float  # b [m]
    length: float  # of the tank [m]
    end: float  # [m/a]: measured so far
    fast: float  # [a]: from here on the front moves at a steady speed
    time_unit: float = 1.0  # T of one unit of the file's first column
    gate: float = 0.0  # [a]: where the file's second column starts
    unit: float = 1.0  # [a]: of the file's second column
    required: bool = True
    scene: str = "scene.toml"
    earliest: float = 0.0  # lag [s]
    held: int = 0  # a/l0 from which on the bars must be met

    def read(self, folder):
        table = np.loadtxt(folder / self.file, delimiter=",", skiprows=1)
        times, fronts = table[:, 0] * self.time_unit, self.gate + table[:, 1] * self.unit
        return times[fronts <= self.end], fronts[fronts <= self.end]

    @property
    def scale(self):
        """T of one second."""
        return np.sqrt(2 * GRAVITY / self.width)


TANK = [Series("Koshizuka & Oka", "koshizuka-oka-1996.csv", 0.146, 0.292, 0.584, 4, 2, time_unit=np.sqrt(2 * GRAVITY)),
        Series("Koshizuka & Oka, other digitisation", "koshizuka-oka-1996-other.csv", 0.146, 0.292, 0.584, 4, 2,
               required=False)]
COLUMN = (2.25 * INCH, 4.5 * INCH, 36 * INCH)
CHANNEL = [Series("Martin & Moyce 2.25 in", "martin-moyce-1952-a2.25in.csv", *COLUMN, 4.2, 2),
           Series("Martin & Moyce 2.25 in, to 14 a", "martin-moyce-1952-a2.25in.csv", *COLUMN, 14, 2, required=False),
           Series("Martin & Moyce 1.125 in", "martin-moyce-1952-a1.125in.csv", *COLUMN, 4.2, 2, required=False)]
GATE = [Series("Lobovsky", "lobovsky-2014.csv", 0.6, 0.3, 1.61, 2.68, 1.5, gate=1.0, unit=0.5, scene="scene-gate.toml",
               earliest=-LONGEST_LAG, held=64)]


def compare(context, run, layers, series):
    """Bars of the front against one experiment."""
    label, required = f"a/l0 {layers}", series.required and layers >= series.held
    times, fronts = series.read(context.folder)
    table = run.table("gauges/front.csv")
    t, z = np.array(table["t"]) * series.scale, np.array(table["front"]) / series.width
    lags = np.linspace(series.earliest, LONGEST_LAG, 401) * series.scale
    errors = [np.sqrt(np.mean((np.interp(times - lag, t, z) - fronts) ** 2)) for lag in lags]
    lag = lags[int(np.argmin(errors))]
    computed, fast = np.interp(times - lag, t, z), fronts >= series.fast
    measured_speed, speed = (np.polyfit(times[fast], values[fast], 1)[0] for values in (fronts, computed))
    panel = f"front, {series.name}; t sqrt(2g/a); x/a"
    if layers == RESOLUTIONS[context.effort][0]:
        context.curve(panel, "experiment", times, fronts, reference=True, points=True)
    shown = (t + lag >= 0) & (t + lag <= times[-1])
    context.curve(panel, f"{label}, lag {1000 * lag / series.scale:.0f} ms", t[shown] + lag, z[shown])
    yield run.bar(f"{label}: {series.name}, RMS of the front", min(errors), 0, 0.04, "a", series.file, required)
    yield run.bar(f"{label}: {series.name}, surge speed", 100 * (speed / measured_speed - 1), -3, 3, "%",
                  f"{series.file}: {measured_speed * series.width * series.scale:.2f} m/s", required)


def rest(context, run, label, series):
    """Bars of what must be kept, and of the water once it is still."""
    table = {name: np.array(values) for name, values in run.table("energies.csv").items()}
    time, volume = table["t"], 100 * (table["volume ratio"] / table["volume ratio"][0] - 1)
    level = series.width * series.height / series.length
    still = 0.5 * table["mass"][0] * GRAVITY * level
    energies = {name: 100 * table[name] / still for name in ("potential", "kinetic")}
    late, last = (time >= 5.5) & (time <= 6), time >= time[-1] - 5
    context.curve("volume; time [s]; change [%]", label, time, volume)
    for name in ("potential", "kinetic"):
        context.curve("energy; time [s]; energy / potential energy at rest", f"{label}, {name}", time,
                      energies[name] / 100)
    yield run.bar(f"{label}: largest change of the volume", np.nanmax(np.abs(volume)), 0, 1, "%", "conservation")
    # It sloshes for long, as a real tank of this size would; a wave has as much of either energy, so their difference is
    # what the potential energy will be once it is still.
    for name, when, required in (("5.5-6 s", late, True), ("last 5 s", last, False)):
        potential, kinetic = (energies[kind][when].mean() for kind in ("potential", "kinetic"))
        yield run.bar(f"{label}: potential energy, {name}", potential - 100, -1, 1, "%",
                      "m g h/2 of the same water at rest", required)
        yield run.bar(f"{label}: the same less the kinetic energy, {name}", potential - kinetic - 100, -1, 1, "%",
                      "sloshing has as much of either", not required)
    lost = table["total"][0] - table["total"].min()
    yield run.bar(f"{label}: largest rise of energy", 100 * run.summary["energy"]["largest_rise"] / lost, 0, 0.01,
                  "% of the loss", "no work is done: none")
    yield run.bar(f"{label}: water outside of the tank", run.summary["extremes"]["water_outside_tank"], 0, 0,
                  "particles", "conservation")


def collapse(context, name, series, layers, end_time):
    distance = min(series.width, series.height) / layers
    return context.run(f"{name}-{layers}", context.folder / series.scene, [
        f"parameters.column={series.width}", f"parameters.height={series.height}", f"parameters.length={series.length}",
        f"parameters.l0={distance!r}", f"run.end_time={end_time}"])


def measure(context):
    for name, group, end_time, resolutions in (("tank", TANK, 20, RESOLUTIONS), ("channel", CHANNEL, 0.8, RESOLUTIONS),
                                               ("gate", GATE, 0.6, GATE_RESOLUTIONS)):
        for layers in resolutions[context.effort]:
            run = collapse(context, name, group[0], layers, end_time)
            for series in group:
                yield from compare(context, run, layers, series)
            if name == "tank":
                yield from rest(context, run, f"a/l0 {layers}", group[0])
