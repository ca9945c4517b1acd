"""What is stable: coefficients, resolutions and scenes driven to extremes, 2-D. Each run must either end well or stop
with status 3 and say at which step, where and by which quantity; a wrong answer must never be silent.

Ended well: no NaN, every particle kept, and at no step more energy than at the start (kinetic, potential and elastic; no
wall moves, so no work is done) but for 1 % of what the water can lose. A run that says itself that it is not to be trusted
is not silent. The largest rise over the lowest energy before must be nothing as well; what the pressure of wall points
stores is counted (`output.audit`).
"""

import dataclasses
import math
import re

from validate import Bar

TITLE = "stiff and extreme, 2-D: stable, or stopped with a clear message"
# Status 3 names step, place and quantity.
STOPPED = re.compile(r"mps: step \d+, t = \S+ s: .* at \(.*\) m.*(unstable|left the domain).*speed .*"
                     r" density \S+ of rest", re.DOTALL)
SOUND = math.sqrt(2 * 9.81 * 0.2)  # [m/s]: a factor of one


@dataclasses.dataclass
class Extreme:
    """A scene and what is driven to an extreme in it."""

    name: str
    scene: str
    settings: dict = dataclasses.field(default_factory=dict)
    efforts: tuple = ("quick", "normal", "full")


def collapse(name, key, value, *efforts):
    return Extreme(f"{name} {value:g}", "collapse.toml", {key: value}, efforts or ("quick", "normal", "full"))


def extremes():
    for value in (0.1, 0.5, 0.8, 1.0, 1.2, 1.4, 1.6, 1.8, 2.0):
        yield collapse("CFL", "numerics.cfl", value)
    for value in (5, 10, 20, 50):
        yield Extreme(f"c0 factor {value}", "collapse.toml", {"numerics.sound_speed": value * SOUND})
    for value in (0, 0.05, 0.15, 0.5, 1):
        yield collapse("density diffusion", "numerics.density_diffusion", value)
    for value in (0, 1):
        yield collapse("artificial viscosity", "numerics.artificial_viscosity", value)
    for value in (1, 1e2, 1e4, 1e6):
        yield Extreme(f"viscosity {value:g} times water's", "collapse.toml",
                      {"fluid.kinematic_viscosity": 1e-6 * value})
    for layers in (1, 2, 5, 10, 20, 40):
        yield Extreme(f"{layers} layers", "collapse.toml", {"parameters.l0": 0.2 / layers})
    for layers, efforts in ((100, ("normal", "full")), (200, ("full",))):
        yield Extreme(f"{layers} layers, 1 m deep", "collapse.toml",
                      {"parameters.l0": 1 / layers, "parameters.height": 1}, efforts)
    for value in (0, 0.8):
        yield collapse("restitution", "numerics.collision_restitution", value)
    yield collapse("collision distance", "numerics.collision_distance", 0)
    yield Extreme("100 g, impact of a slab", "slab.toml")
    yield Extreme("100 g, impact of a slab, finer", "slab.toml", {"parameters.l0": 0.005}, ("normal", "full"))
    yield Extreme("100 g, impact, c0 twice", "slab.toml", {"numerics.reference_speed": 56})
    yield Extreme("jet at 50 m/s on a wall", "jet.toml")
    yield Extreme("jet at 50 m/s on a wall, finer", "jet.toml", {"parameters.l0": 0.005}, ("normal", "full"))
    yield Extreme("jet at 50 m/s, sound speed of 60 m/s", "jet.toml", {"numerics.sound_speed": 60})
    yield Extreme("a single particle", "drop.toml")
    yield Extreme("water of no volume", "drop.toml", {"parameters.top": 0.5, "numerics.reference_speed": 3})
    yield Extreme("no water", "empty.toml", {"numerics.reference_speed": 3})
    yield Extreme("no water, no speed given", "empty.toml")


def judge(run):
    """(sound, verdict) of a run: sound is False for silent nonsense or an unclear message."""
    if run.status == 3:
        found = STOPPED.search(run.message)
        return found is not None, "stopped: " + (found.group(0) if found else run.message)
    if run.status == 2:
        return "mps: " in run.message, "refused: " + run.message.split("mps: ", 1)[-1].split("\n")[0].rsplit("/", 1)[-1]
    if run.status != 0:
        return False, f"**ended with status {run.status}: {run.message.splitlines()[-1]}**"
    table = run.table("energies.csv")
    totals, masses = table["total"], table["mass"]
    numbers = [value for name in ("kinetic", "potential", "elastic", "mass", "px", "py") for value in table[name]]
    lost = totals[0] - min(totals)
    gain, rise = (run.summary["energy"][name] for name in ("largest_gain", "largest_rise"))
    problems = []
    if not all(map(math.isfinite, numbers)):
        problems.append("NaN")
    if min(masses) < masses[0]:
        problems.append("particles lost")
    if gain > 0.01 * max(lost, max(table["kinetic"])):
        problems.append(f"gained {100 * gain / max(lost, max(table['kinetic'])):.1f} % of its energy")
    warnings = [text for text in run.summary["warnings"] if "do not trust" in text or "not weakly compressible" in text]
    if problems and warnings:
        return True, ", ".join(problems) + "; says so: " + "; ".join(warnings)
    if problems:
        return False, "**silent: " + ", ".join(problems) + "**"
    limits = run.summary["extremes"]
    mach = limits["speed"] / run.summary["sound_speed"]
    doubt = "; says that it was not weakly compressible" if warnings else ""
    gain, rise = (100 * value / lost if lost > 0 else 0 for value in (gain, rise))
    return True, (f"stable; gain {gain:.4f} %, rise {rise:.4f} %, Mach {mach:.2f}, density off by up to "
                  f"{100 * limits['compression']:.0f} %{doubt}")


def measure(context):
    context.note("Gain: of energy over the start; rise: over the lowest before; both in % of what was lost in all, seen at every "
                 "step, with what walls store.")
    context.note("")
    context.note("| run | outcome | run [s] |")
    context.note("|---|---|---|")
    silent, count, seconds = 0, 0, 0.0
    rises = {"collapse.toml": [], "slab.toml": [], "jet.toml": []}
    for extreme in extremes():
        if context.effort not in extreme.efforts:
            continue
        name = re.sub(r"[^a-z0-9.]+", "-", extreme.name.lower())
        run = context.run(name, context.folder / extreme.scene,
                          [f"{key}={value!r}" for key, value in extreme.settings.items()], allowed=range(256))
        sound, verdict = judge(run)
        context.note(f"| {extreme.name} | {verdict} | {run.seconds:.0f} |")
        silent, count, seconds = silent + (not sound), count + 1, seconds + run.seconds
        if run.status == 0 and extreme.scene in rises and extreme.settings.get("numerics.cfl", 0) <= 0.8:
            energy = run.summary["energy"]
            totals = run.table("energies.csv")["total"]
            rises[extreme.scene].append(100 * energy["largest_rise"] / (totals[0] - min(totals)))
    yield Bar(f"silent wrong answers, crashes and unclear messages in {count} runs", silent, 0, 0, "runs", seconds,
              "stable, or stopped in words")
    for scene, found in rises.items():
        yield Bar(f"{scene.removesuffix('.toml')}: largest rise of energy at CFL <= 0.8, {len(found)} runs", max(found), 0,
                  0.01, "% of the loss", seconds, "no work is done: none")
