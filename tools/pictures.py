#!/usr/bin/python3
"""Pictures and films of a run, drawn off-screen: ./embacle render RUN OPTIONS. The water, the bodies and the walls from the
front, as in laboratory photographs, and from above, or from any camera.

Writes RUN/pictures/<time>s.png, one for each time of the scene's `pictures` (without these: up to 12 frames),
contact-sheet.png, and a film of the same views if one is asked for.
"""
import argparse
import os

import matplotlib

matplotlib.use("Agg")
import matplotlib.patheffects as effects
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.colors import LinearSegmentedColormap, Normalize
from matplotlib.patches import Ellipse, Polygon, Rectangle
from matplotlib.path import Path
from matplotlib.transforms import Affine2D

from run_folder import Bodies, Frames, RunFolderError, body_names, program, read_shapes, up_axis, wall_angle, wall_box

WATER = LinearSegmentedColormap.from_list("water", ["#14467f", "#1f6fb2", "#4aa1d2", "#8dcde0", "#d0ebd6", "#fae48f"])
ICE, CONCRETE, EARTH = np.array([0.97, 0.955, 0.92]), np.array([0.62, 0.62, 0.6]), np.array([0.80, 0.74, 0.62])
EDGE, GATE = "#3b2f20", "#6e6e6e"
WIDTH, DPI = 8.0, 160  # of the front view [inch], and its resolution


class View:
    """An orthographic view: global coordinates to (right, up, towards the viewer)."""

    def __init__(self, right, up):
        self.axes = np.array([right, up, np.cross(right, up)])

    def __call__(self, points):
        return np.asarray(points, dtype=float) @ self.axes.T

    @classmethod
    def camera(cls, azimuth, elevation, up):
        """From a place in the direction of the azimuth (degrees from the second axis backwards to the right: 0 is the front)
        and that far over the horizon, for an `up` along one of the axes."""
        front = View(*up)
        a, e = np.radians([azimuth, elevation])
        right = np.cos(a) * front.axes[0] + np.sin(a) * -front.axes[2]
        towards = np.cos(e) * np.cross(right, front.axes[1]) + np.sin(e) * front.axes[1]
        return cls(right, np.cross(towards, right))

    def box(self, lower, upper):
        corners = self(np.array([[(lower, upper)[k >> c & 1][c] for c in range(3)] for k in range(8)]))
        return corners.min(axis=0), corners.max(axis=0)


def views(shapes):
    """The front view (x, or y if x is vertical, to the right) and the view from above."""
    axis, sign = up_axis(shapes)
    up = sign * np.eye(3)[axis]
    right = np.eye(3)[0 if axis != 0 else 1]
    return View(right, up), View(right, np.cross(up, right))


def faces_of(shape):
    """Faces of a shape as a list of (corners, 3) arrays in the body frame [m], counter-clockwise from outside."""
    size = np.array(shape["size"], dtype=float)
    if shape["kind"] == "box":
        corner = np.array([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)]) * size / 2
        return [corner[k] for k in ([0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5])]
    turn = np.linspace(0, 2 * np.pi, 25)
    if shape["kind"] == "cylinder":
        rim = np.stack([size[0] * np.cos(turn[:-1]), size[0] * np.sin(turn[:-1])], axis=1)
        half = size[1] / 2
        bottom, top = (np.column_stack([rim, np.full(len(rim), z)]) for z in (-half, half))
        around = np.roll(np.arange(len(rim)), -1)
        return [bottom[::-1], top] + [np.array([bottom[i], bottom[j], top[j], top[i]]) for i, j in enumerate(around)]
    if shape["kind"] == "sphere":
        tilt = np.linspace(0, np.pi, 13)
        grid = size[0] * np.array([[[np.sin(a) * np.cos(b), np.sin(a) * np.sin(b), np.cos(a)] for b in turn] for a in tilt])
        return [np.array([grid[i, j], grid[i + 1, j], grid[i + 1, j + 1], grid[i, j + 1]])
                for i in range(len(tilt) - 1) for j in range(len(turn) - 1)]
    if shape["kind"] in ("prism", "surface"):
        return flat_faces(np.array(shape["triangles"], dtype=float).reshape(-1, 3, 3))
    raise RunFolderError(f"shapes.json: cannot draw a shape of kind {shape['kind']!r} "
                         "(box, sphere, cylinder, prism, surface)")


def hull(points):
    """The convex outline of points in the plane (Andrew's monotone chain)."""
    def chain(ordered):
        kept = []
        for p in ordered:
            while len(kept) > 1:
                a, b = kept[-1] - kept[-2], p - kept[-2]
                if a[0] * b[1] - a[1] * b[0] > 0:
                    break
                kept.pop()
            kept.append(p)
        return kept[:-1]

    ordered = np.unique(points, axis=0)
    return np.array(chain(ordered) + chain(ordered[::-1]))


def flat_faces(triangles):
    """Triangles of a plane joined where they make a convex polygon, in the sense of the triangles."""
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    areas = np.linalg.norm(normals, axis=1)
    planes = np.column_stack([normals / areas[:, None], np.einsum("ij,ij->i", normals, triangles[:, 0]) / areas])
    faces = []
    size = np.ptp(triangles.reshape(-1, 3), axis=0).max()
    _, group = np.unique(np.round(planes / [1e-6, 1e-6, 1e-6, 1e-6 * size]).astype(np.int64), axis=0, return_inverse=True)
    for k in range(group.max() + 1):
        members = np.flatnonzero(group == k)
        normal = planes[members[0], :3]
        across = triangles[members[0], 1] - triangles[members[0], 0]
        across = across / np.linalg.norm(across)
        axes = np.array([across, np.cross(normal, across)])
        outline = hull(np.round(triangles[members].reshape(-1, 3) @ axes.T / (1e-9 * size)) * 1e-9 * size)
        x, y = outline.T
        area = np.dot(x, np.roll(y, -1)) - np.dot(np.roll(x, -1), y)
        if abs(area) > (1 + 1e-6) * areas[members].sum():
            faces += list(triangles[members])
        else:
            outline = outline if area > 0 else outline[::-1]
            faces.append(outline @ axes + normal * planes[members[0], 3])
    return faces


class Scene:
    """What stays the same from picture to picture."""

    def __init__(self, folder):
        self.shapes = read_shapes(folder)
        self.frames = Frames(folder)
        if len(self.frames.times) == 0:
            raise RunFolderError(f"{folder}/fields.h5 holds no frame yet")
        self.bodies = Bodies(folder)
        self.names = body_names(self.shapes, self.bodies)
        self.flat = self.shapes.get("dimension") == 2
        self.l0 = float(self.shapes["particle_distance"])
        self.front, self.above = views(self.shapes)
        self.camera = None  # instead of both
        tanks = [wall for wall in self.shapes.get("walls", []) if wall["kind"] == "tank"]
        bounds = tanks or [self.shapes["domain"]]
        self.lower = np.min([wall["lower"] for wall in bounds], axis=0)
        self.upper = np.max([wall["upper"] for wall in bounds], axis=0)
        meshes = [faces_of(shape) for shape in self.shapes.get("shapes", [])]
        smooth = [shape["kind"] == "sphere" for shape in self.shapes.get("shapes", [])]
        # Walls that a camera sees as solids: (wall, faces about the middle of its box).
        self.solid_walls = [(wall, faces_of({"kind": "box", "size": np.subtract(wall["upper"], wall["lower"])}))
                            for wall in self.shapes.get("walls", []) if wall["kind"] == "box" and "angles" not in wall]
        self.grounds = [np.array(wall["triangles"], dtype=float).reshape(-1, 3, 3)
                        for wall in self.shapes.get("walls", []) if "triangles" in wall]
        self.meshes = {body["tag"]: (meshes[body["shape"]], smooth[body["shape"]])
                       for body in self.shapes.get("bodies", [])}

    def water(self, index, quantity):
        """Positions [m] and the coloured quantity of the water's particles of a frame."""
        position, kind = self.frames.read(index, "position", "type")
        fluid = kind == 0
        if quantity == "speed":
            (velocity,) = self.frames.read(index, "velocity")
            return position[fluid], np.linalg.norm(velocity[fluid], axis=1)
        (pressure,) = self.frames.read(index, "pressure")
        return position[fluid], pressure[fluid] / 1000


def visible(points, l0):
    """Indices, from far to near, of the particles that are not well behind another one in the picture."""
    if len(points) == 0:
        return np.empty(0, dtype=int)
    cell = np.floor(points[:, :2] / (0.5 * l0)).astype(np.int64)
    key = (cell[:, 0] - cell[:, 0].min()) * (np.ptp(cell[:, 1]) + 1) + cell[:, 1] - cell[:, 1].min()
    _, group = np.unique(key, return_inverse=True)
    nearest = np.full(group.max() + 1, -np.inf)
    np.maximum.at(nearest, group, points[:, 2])
    seen = np.flatnonzero(points[:, 2] >= nearest[group] - 2 * l0)
    return seen[np.argsort(points[seen, 2], kind="stable")]


def draw_bodies(axes, scene, view, time):
    """Draws the bodies as solids, and before a camera walls of kind box; returns their depths, by which the water is layered
    around them, and the faces that look at the viewer."""
    light = np.array([-0.25, 0.57, 0.78])
    placed, fronts = [], []
    if view is scene.camera:
        for wall, mesh in scene.solid_walls:
            middle = np.mean(wall_box(wall, time), axis=0)
            placed.append((view(middle), (middle, np.eye(3)), mesh))
    for tag in scene.bodies.tags:
        pose = scene.bodies.pose(tag, time)
        if pose is not None and tag in scene.meshes:
            placed.append((view(pose[0]), pose, tag))
    placed.sort(key=lambda item: item[0][2])
    for layer, (centre, (position, turned), tag) in enumerate(placed):
        mesh, smooth, colour = (*scene.meshes[tag], ICE) if isinstance(tag, int) else (tag, False, CONCRETE)
        polygons, colours = [], []
        for face in mesh:
            corners = view(face @ turned.T + position)
            normal = np.cross(corners[1] - corners[0], corners[2] - corners[1])
            length = np.linalg.norm(normal)
            if length > 0 and normal[2] > 1e-9 * length:
                polygons.append(corners[:, :2])
                fronts.append(corners)
                colours.append(np.minimum(colour * (0.74 + 0.34 * max(0.0, normal @ light / length)), 1))
        edges = colours if smooth else EDGE
        axes.add_collection(PolyCollection(polygons, facecolors=colours, edgecolors=edges, linewidths=0.7,
                                           joinstyle="round", zorder=10 + 2 * layer))
        if not smooth and view is not scene.camera:  # what the water hides still shows as a faint outline
            outline = hull(np.concatenate(polygons))
            axes.add_collection(PolyCollection([outline], facecolors="none", edgecolors="white", linewidths=0.5,
                                               linestyles=(0, (4, 2)), alpha=0.7, zorder=9000))
        behind = any(np.hypot(*(nearer[:2] - centre[:2])) < 0.03 * np.ptp(axes.get_xlim())
                     for nearer, _, _ in placed[layer + 1:])
        if len(placed) <= 40 and not behind and isinstance(tag, int):
            axes.text(centre[0], centre[1], scene.names[tag], ha="center", va="center", fontsize=7.5, weight="bold",
                      color="#7a1f12", zorder=9002, clip_on=True,
                      path_effects=[effects.withStroke(linewidth=2, foreground="white")])
    return [centre[2] for centre, _, _ in placed], fronts


def hidden(points, fronts, margin):
    """Which points (in view coordinates) are behind a face by more than the margin."""
    result = np.zeros(len(points), dtype=bool)
    for face in fronts:
        near = np.flatnonzero(np.all((points[:, :2] >= face[:, :2].min(axis=0)) & (points[:, :2] <= face[:, :2].max(axis=0)), axis=1))
        if not len(near):
            continue
        near = near[Path(face[:, :2]).contains_points(points[near, :2])]
        normal = np.cross(face[1] - face[0], face[2] - face[1])
        depth = face[0, 2] - (points[near, :2] - face[0, :2]) @ normal[:2] / normal[2]
        result[near[points[near, 2] < depth - margin]] = True
    return result


def draw_water(axes, scene, view, position, value, norm, depths, fronts):
    """Draws the particles in layers between the bodies, far to near; `depths` of the bodies, sorted. Before a camera, less what
    faces hide (`fronts`)."""
    points = view(position)
    order = visible(points, scene.l0)
    if view is scene.camera:
        order = order[~hidden(points[order], fronts, 0.3 * scene.l0)]
    points, colours = points[order], WATER(norm(value[order]))
    if len(points):
        depth = (points[:, 2].max() - points[:, 2]) / max(np.ptp(view.box(scene.lower, scene.upper), axis=0)[2], scene.l0)
        colours[:, :3] *= (1 - 0.12 * np.clip(depth, 0, 1))[:, None]
    box = axes.get_window_extent()
    points_per_metre = box.width * 72 / axes.figure.dpi / np.ptp(axes.get_xlim())
    size = (1.4 * scene.l0 * points_per_metre) ** 2
    layer = np.searchsorted(depths, points[:, 2]) if depths else np.zeros(len(points), dtype=int)
    for k in np.unique(layer):
        chosen = layer == k
        axes.scatter(points[chosen, 0], points[chosen, 1], s=size, c=colours[chosen], linewidths=0, zorder=9 + 2 * k)


def wall_patch(wall, view, lower, upper, time):
    """The outline of a solid wall: its true one along the axis of a cylinder or prism, otherwise the box around it."""
    look = {"facecolor": GATE + "80", "edgecolor": "#333333", "linewidth": 0.7, "zorder": 9400}
    along = "axis" in wall and abs(view.axes[2][wall["axis"]]) > 0.5
    if wall["kind"] == "sphere" or (wall["kind"] == "cylinder" and along):
        return Ellipse((lower + upper)[:2] / 2, *(upper - lower)[:2], **look)
    if wall["kind"] == "prism" and along:
        place, _ = wall_box(wall, time)
        corners = np.tile(place, (len(wall["polygon"]), 1))
        across = [k for k in range(3) if k != wall["axis"]]
        corners[:, across] = np.array([row["point"] for row in wall["polygon"]]) + place[across] - np.array(
            wall["lower"])[across]
        return Polygon(view(corners)[:, :2], **look)
    return Rectangle(lower[:2], *(upper - lower)[:2], **look)


def wall_turn(wall, view, time):
    """The turn of a wall as it looks along its axis; from aside its box stays as it is."""
    along = view.axes[2] @ np.array(wall.get("turn_axis", [0, 0, 0]), dtype=float)
    if abs(along) < 0.5:
        return Affine2D()
    moved = wall_box(wall, time)[0] - np.array(wall["lower"], dtype=float)
    pivot = view(np.array(wall["pivot"], dtype=float) + moved)
    return Affine2D().rotate_around(pivot[0], pivot[1], np.sign(along) * wall_angle(wall, time))


def draw_grounds(axes, scene, view):
    """What of the walls of triangles looks at the viewer, below all else."""
    for triangles in scene.grounds:
        corners = view(triangles)
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normal /= np.maximum(np.linalg.norm(normal, axis=1), 1e-300)[:, None]
        seen = np.flatnonzero(normal[:, 2] > 1e-6)
        seen = seen[np.argsort(corners[seen, :, 2].mean(axis=1))]
        shade = 0.7 + 0.3 * np.clip(normal[seen] @ [-0.25, 0.57, 0.78], 0, 1)
        axes.add_collection(PolyCollection(corners[seen][:, :, :2], facecolors=shade[:, None] * EARTH, edgecolors="face",
                                           linewidths=0.4, zorder=1))


def draw_tanks(axes, scene, view, time):
    """The edges of tanks, before a camera."""
    for wall in scene.shapes.get("walls", []):
        if wall["kind"] != "tank":
            continue
        lower, upper = wall_box(wall, time)
        corners = view([[(lower, upper)[k >> c & 1][c] for c in range(3)] for k in range(8)])
        hidden = int(np.argmin(corners[:, 2]))
        for k in range(8):
            for c in range(3):
                if not k >> c & 1:
                    far = hidden in (k, k | 1 << c)
                    axes.plot(*corners[[k, k | 1 << c], :2].T, color="#777777", linewidth=0.8, zorder=2 if far else 9500)


def draw_walls(axes, scene, view, time):
    draw_grounds(axes, scene, view)
    if view is scene.camera:
        draw_tanks(axes, scene, view, time)
        return
    for wall in scene.shapes.get("walls", []):
        lower, upper = view.box(*wall_box(wall, time))
        turn = wall_turn(wall, view, time) + axes.transData
        if wall["kind"] == "tank":
            axis = int(np.argmax(np.abs(view.axes[1])))
            top = "xyz"[axis] + ("+" if view.axes[1][axis] > 0 else "-")
            top_open = top in wall["open"] if "open" in wall else view is scene.front
            x, y = [lower[0], lower[0], upper[0], upper[0]], [upper[1], lower[1], lower[1], upper[1]]
            if not top_open:
                x, y = x + [lower[0]], y + [upper[1]]
            axes.plot(x, y, color="#222222", linewidth=1.4, solid_joinstyle="miter", zorder=9500,
                      transform=turn)
        else:
            patch = wall_patch(wall, view, lower, upper, time)
            patch.set_transform(turn)
            axes.add_patch(patch)


def frame_axes(axes, scene, view):
    lower, upper = view.box(scene.lower, scene.upper)
    if view is scene.camera:
        axes.set_xticks([])
        axes.set_yticks([])
    margin = 0.015 * (upper[0] - lower[0])
    axes.set_xlim(lower[0] - margin, upper[0] + margin)
    axes.set_ylim(lower[1] - margin, upper[1] + margin)
    axes.set_aspect("equal")
    axes.tick_params(labelsize=8, direction="out", length=3)
    for side in ("top", "right", "left", "bottom"):
        axes.spines[side].set_visible(False)
    axes.set_facecolor("#fbfbfa")


def label(view, k):
    axis = int(np.argmax(np.abs(view.axes[k])))
    return f"{'xyz'[axis]} [m]"


def picture(scene, index, quantity, norm, path, from_above=False):
    """Draws one frame into a PNG; returns the part of the image with the front view (or the one from above), and the part
    with the colour bar."""
    time = float(scene.frames.times[index])
    position, value = scene.water(index, quantity)
    panels = [scene.camera] if scene.camera else [scene.front] if scene.flat else [scene.front, scene.above]
    extents = [np.subtract(*view.box(scene.lower, scene.upper)[::-1]) for view in panels]
    width = WIDTH if extents[0][1] <= 0.9 * extents[0][0] else WIDTH * 0.9 * extents[0][0] / extents[0][1]
    heights = [width * (extent[1] / extent[0] + 0.03) / 1.03 for extent in extents]
    left, right, top, bottom, gap = 0.62, 1.0, 0.36, 0.5, 0.5
    total = (left + width + right, top + sum(heights) + gap * (len(heights) - 1) + bottom)
    figure = plt.figure(figsize=total, dpi=DPI)
    at = total[1] - top
    for k, (view, height) in enumerate(zip(panels, heights)):
        at -= height
        axes = figure.add_axes([left / total[0], at / total[1], width / total[0], height / total[1]])
        frame_axes(axes, scene, view)
        depths, fronts = draw_bodies(axes, scene, view, time)
        draw_water(axes, scene, view, position, value, norm, depths, fronts)
        draw_walls(axes, scene, view, time)
        if view is not scene.camera:
            axes.set_ylabel(label(view, 1), fontsize=8.5)
        if k == 0:
            axes.set_title(f"t = {time:.2f} s", fontsize=11, loc="left", pad=5)
            bar_at = [(left + width + 0.18) / total[0], (at + 0.1 * height) / total[1], 0.13 / total[0],
                      0.8 * height / total[1]]
            front_bottom = at - gap
        if k == len(panels) - 1 and view is not scene.camera:
            axes.set_xlabel(label(view, 0), fontsize=8.5)
        if k == 1:
            axes.set_title("from above", fontsize=8.5, loc="left", pad=3, color="#444444")
        at -= gap
    bar = figure.colorbar(plt.cm.ScalarMappable(norm=norm, cmap=WATER), cax=figure.add_axes(bar_at), extend="max")
    bar.set_label("speed [m/s]" if quantity == "speed" else "pressure [kPa]", fontsize=8.5)
    bar.ax.tick_params(labelsize=8)
    figure.savefig(path, dpi=DPI)
    image = np.asarray(figure.canvas.buffer_rgba())[:, :, :3].copy()
    plt.close(figure)
    front_end = int((total[1] - max(front_bottom + 0.25, 0)) * DPI)
    split = int((left + width + 0.1) * DPI)
    if not from_above or scene.flat or scene.camera:
        return image[:front_end, :split], image[:front_end, split:]
    head = image[:int(top * DPI)]  # with the time
    view = np.concatenate([head, image[front_end:]])[:, :split]
    return view, image[:front_end, split:]


def contact_sheet(tiles, bar, path):
    """All front views in two columns, half size, with one colour bar."""
    def halved(image):
        rows, columns = image.shape[0] // 2 * 2, image.shape[1] // 2 * 2
        return image[:rows, :columns].reshape(rows // 2, 2, columns // 2, 2, 3).mean(axis=(1, 3))

    small = [halved(tile) for tile in tiles]
    if len(small) % 2 and len(small) > 1:
        small.append(np.full_like(small[0], 255))
    rows = [np.concatenate(small[k:k + 2], axis=1) for k in range(0, len(small), 2)]
    sheet = np.concatenate(rows, axis=0)
    column = np.full((sheet.shape[0], bar.shape[1] // 2, 3), 255.0)
    bar = halved(bar)[:sheet.shape[0]]
    column[:bar.shape[0]] = bar
    plt.imsave(path, np.concatenate([sheet, column], axis=1).astype(np.uint8))


def film(tiles, path):
    """The tiles as a film: an animated GIF, half size, ten pictures a second."""
    from PIL import Image  # comes with matplotlib
    images = [Image.fromarray(tile).resize((tile.shape[1] // 2, tile.shape[0] // 2)) for tile in tiles]
    colours = images[-1].quantize(128)
    images = [image.quantize(palette=colours) for image in images]
    images[0].save(path, save_all=True, append_images=images[1:], duration=100, loop=0, optimize=True)


def colour_range(scene, indices, quantity):
    """One scale for all pictures: up to the 99.5th percentile of the liveliest, rounded up to two digits."""
    high = 0.0
    for index in indices:
        _, value = scene.water(index, quantity)
        if len(value):
            high = max(high, float(np.percentile(value, 99.5)))
    if high <= 0:
        return Normalize(0, 1, clip=True)
    digit = 10.0 ** (np.floor(np.log10(high)) - 1)
    return Normalize(0, np.ceil(high / digit) * digit, clip=True)


def chosen_frames(scene, times):
    if times == "all":
        return list(range(len(scene.frames.times)))
    wanted = scene.shapes.get("pictures") if times is None else times
    if not wanted:
        return sorted(set(np.linspace(0, len(scene.frames.times) - 1, 12).round().astype(int).tolist()))
    reached = [time for time in wanted if time <= scene.frames.times[-1] + 1e-9] or [scene.frames.times[-1]]
    return sorted({scene.frames.nearest(time) for time in reached})


def view_option(text):
    """`front`, `above` or an azimuth and an elevation."""
    if text in ("front", "above"):
        return text
    try:
        azimuth, elevation = map(float, text.split(","))
    except ValueError:
        elevation = np.nan
    if not -90 < elevation < 90:
        raise argparse.ArgumentTypeError(f"'{text}'; allowed: front, above, or two numbers as 30,40, the second between -90 and 90")
    return azimuth, elevation


def times_option(text):
    return text if text == "all" else [float(word) for word in text.split(",")]


def main():
    parser = argparse.ArgumentParser(prog="embacle render", description=__doc__.split("\n\n")[0])
    parser.add_argument("run", metavar="RUN", help="output folder of a run")
    parser.add_argument("--by", choices=["speed", "pressure"], default="speed", help="what colours the water")
    parser.add_argument("--times", type=times_option, help="times [s], separated by commas, or `all` for every frame; "
                        "default: the scene's `pictures`, or up to 12 frames spread over the run")
    parser.add_argument("--view", type=view_option, default="front", metavar="front|above|AZIMUTH,ELEVATION",
                        help="what contact sheet and film show; or all pictures from a camera far away: degrees to the right of "
                        "the front, and over the horizon, as 30,40 or --view=-30,40")
    parser.add_argument("--film", metavar="FILE.gif", help="a film of all these times")
    parser.add_argument("--out", help="folder for the pictures (default: RUN/pictures)")
    options = parser.parse_args()
    if options.film and not options.film.endswith(".gif"):
        raise RunFolderError(f"--film {options.film}: allowed: a name that ends with .gif")

    scene = Scene(options.run)
    if isinstance(options.view, tuple):
        scene.camera = View.camera(*options.view, scene.front.axes[:2])
    indices = chosen_frames(scene, options.times)
    norm = colour_range(scene, indices, options.by)
    out = options.out or os.path.join(options.run, "pictures")
    os.makedirs(out, exist_ok=True)
    tiles, bar = [], None
    for index in indices:
        tile, bar = picture(scene, index, options.by, norm, os.path.join(out, f"{scene.frames.times[index]:.3f}s.png"),
                            options.view == "above")
        tiles.append(tile)
    contact_sheet(tiles, bar, os.path.join(out, "contact-sheet.png"))
    if options.film:
        film(tiles, options.film)
    print(f"{len(indices)} pictures and contact-sheet.png in {out}")


if __name__ == "__main__":
    program(main)
