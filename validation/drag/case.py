"""Drag of bodies that move along the middle of a closed channel full of water, 2-D.

- Cylinder, channel four diameters high, without inertia (Re = 0.1): Faxen's series for a cylinder between plates (1946), which
  the finite elements of reference.py confirm to 1e-5.
- Cylinder at Re 20 and 100, same channel, started at once (the water has the velocity of the potential flow around a cylinder
  between plates): drag over time by reference.py, incompressible, means over t U/D of 2 to 8.
- Plate, without inertia, as thick as the gaps above and below: fully developed flow in the gaps, from how much the drag
  grows with the length (so that the ends cancel). Over U mu: 2/h from the sliding, and since what the plate displaces
  returns through the gaps, G = 6 (h + t)/h^3 of pressure gradient, whose share is G h along both faces and G t on the ends.

The water starts under a pressure, which is to keep suction from making it negative (not checked). Drag: the water's load on the body.
"""

import numpy as np
from validate import CaseError

TITLE = "drag of a cylinder and a plate in a channel, 2-D, against Faxen, finite elements and channel flow"
SIZE, SPEED, DENSITY = 0.1, 1.0, 1000.0  # diameter or thickness [m], [m/s], [kg/m3]
CREEPING = 0.1  # Re without inertia
RESOLUTIONS = {"quick": (10,), "normal": (10, 20), "full": (10, 20, 40)}  # size/l0
HELD = 20  # size/l0 from which on the bars must be met
BAR = 5  # [%]
BETWEEN = (2, 8)  # t U/D of the means at Re 20 and 100
LENGTHS = (0.2, 0.4)  # of the plates [m]


def faxen(k):
    """Drag over mu U of a cylinder midway between plates; k: diameter over the distance of the plates."""
    return 4 * np.pi / (-0.9157 - np.log(k) + 1.7244 * k**2 - 1.7302 * k**4 + 2.4056 * k**6 - 4.5913 * k**8)


def write_water(path, spacing, length, height, inside, velocity, pressure):
    """The lattice in the channel outside of the body; velocity: complex, u - iv of complex places from the body's centre."""
    x, y = (np.arange(spacing / 2, extent, spacing) for extent in (length, height))
    places = (x[:, None] + 1j * y[None, :]).ravel()
    places = places[~inside(places)]
    u = velocity(places)
    path.parent.mkdir(parents=True, exist_ok=True)
    np.savetxt(path, np.column_stack([places.real, places.imag, u.real, -u.imag, np.full(len(places), pressure)]),
               delimiter=",", header="x [m], y [m], vx [m/s], vy [m/s], p [Pa]", comments="", fmt="%.9g")


def move(context, label, count, reynolds, body, length, height, start, end, script, **water):
    """Runs a body; time [s] and drag [N/m]."""
    spacing, viscosity = SIZE / count, SPEED * SIZE / reynolds
    creeping = reynolds < 1
    # Pressures that the motion makes are a few of these; the water gets a multiple of it.
    pressure = 15 * DENSITY * viscosity * SPEED / SIZE if creeping else 1.5 * DENSITY * SPEED**2
    if script == "in.plate":
        pressure *= 5  # in the narrow gaps
    file = context.results / context.case / f"{label}.csv"
    write_water(file, spacing, length, height, pressure=pressure, **water)
    settings = [f"water.water.file={file}", f"parameters.l0={spacing!r}", f"parameters.length={length!r}",
                f"parameters.height={height!r}", f"parameters.start={start!r}", f"parameters.body_length={body!r}",
                f"fluid.kinematic_viscosity={viscosity!r}", f"coupling.script={context.folder / script}",
                f"run.end_time={end!r}", f"output.bodies_every={end / 400!r}"]
    if creeping:  # so that sound and viscosity ask for steps of one length
        settings.append(f"numerics.sound_speed={4 * viscosity / spacing!r}")
    run = context.run(label, context.folder / "scene.toml", settings)
    table = {name: np.array(values) for name, values in run.table("bodies.csv").items()}
    return run, table["t"], -table["fx"]


def cylinder(context, count, reynolds):
    height = 4 * SIZE
    length, start, end = (10 * SIZE, 4.95 * SIZE, 1.5 * SIZE * reynolds / SPEED) if reynolds < 1 else (
        16 * SIZE, 4 * SIZE, BETWEEN[1] * SIZE / SPEED)
    # A row of doublets, one in each mirror image of the channel, of the strength that lets the cylinder move by U.
    strength = SPEED / (4 / SIZE**2 - np.pi**2 / (3 * height**2))
    middle, wave = start + 0.5j * height, np.pi / height
    return move(context, f"cylinder-{reynolds:g}-{count}", count, reynolds, SIZE, length, height, start, end, "in.cylinder",
                inside=lambda z: abs(z - middle) < SIZE / 2,
                velocity=lambda z: strength * wave**2 / np.sinh(wave * (z - middle))**2)


def plate(context, count, body):
    height, length = 3 * SIZE, 1.0
    start, end = length / 2, SIZE * CREEPING / SPEED  # SIZE^2 over the viscosity: long enough
    middle = start + 0.5j * height
    return move(context, f"plate-{1000 * body:.0f}-{count}", count, CREEPING, body, length, height, start, end, "in.plate",
                inside=lambda z: (abs((z - middle).real) < body / 2) & (abs((z - middle).imag) < SIZE / 2),
                velocity=lambda z: 0 * z)


def measure(context):
    reference = np.loadtxt(context.folder / "cylinder.csv", delimiter=",", skiprows=1)
    for count in RESOLUTIONS[context.effort]:
        held = count >= HELD
        run, time, drag = cylinder(context, count, CREEPING)
        viscosity = SPEED * SIZE / CREEPING
        unit = DENSITY * viscosity * SPEED  # mu U
        scaled = time * viscosity / SIZE**2
        panel = "cylinder without inertia; t nu/D^2; drag over mu U"
        if count == RESOLUTIONS[context.effort][0]:
            context.curve(panel, "Faxen (steady)", (0.2, scaled[-1]), [faxen(0.25)] * 2, reference=True)
        shown = scaled > 0.2
        context.curve(panel, f"D/l0 {count}", scaled[shown], drag[shown] / unit)
        late = scaled > 1
        if not late.any():
            raise CaseError("the run without inertia is too short")
        error = 100 * (drag[late].mean() / unit / faxen(0.25) - 1)
        yield run.bar(f"cylinder, Re 0, D/l0 {count}: drag", error, -BAR, BAR, "%", f"Faxen: {faxen(0.25):.3f} mu U", held)
        for reynolds in (20, 100):
            _, places, expected = reference[reference[:, 0] == reynolds].T
            run, time, drag = cylinder(context, count, reynolds)
            scaled, coefficient = time * SPEED / SIZE, 2 * drag / (DENSITY * SPEED**2 * SIZE)
            panel = f"cylinder, Re {reynolds}; t U/D; drag coefficient"
            if count == RESOLUTIONS[context.effort][0]:
                context.curve(panel, "finite elements", places, expected, reference=True)
            context.curve(panel, f"D/l0 {count}", scaled[scaled >= places[0]], coefficient[scaled >= places[0]])
            inside = (scaled >= BETWEEN[0]) & (scaled <= BETWEEN[1])
            mean = np.interp(scaled[inside], places, expected).mean()
            error = 100 * (coefficient[inside].mean() / mean - 1)
            yield run.bar(f"cylinder, Re {reynolds}, D/l0 {count}: drag", error, -BAR, BAR, "%",
                          f"cylinder.csv: {mean:.3f}", held)
        drags = []
        for body in LENGTHS:
            run, time, drag = plate(context, count, body)
            context.curve(f"plate of {body:g} m; time [thickness^2/nu]; drag over mu U", f"gap/l0 {count}",
                          time[20:] * viscosity / SIZE**2, drag[20:] / unit)
            drags.append(drag[time > 0.6 * time[-1]].mean() / unit)
        gap = SIZE
        gradient = 6 * (gap + SIZE) / gap**3
        exact = 2 / gap + gradient * (gap + SIZE)
        growth = (drags[1] - drags[0]) / (LENGTHS[1] - LENGTHS[0])
        yield run.bar(f"plate, gap/l0 {count}: drag of a unit of length", 100 * (growth / exact - 1), -BAR, BAR, "%",
                      f"channel flow: {exact:.0f} mu U/m", held)
