#!/usr/bin/env python3
"""Drag of a circular cylinder that starts at once to move along the middle of a channel, 2-D: writes cylinder.csv.

Incompressible Navier-Stokes equations in the frame of the cylinder, on one half of the channel: finite elements with quadratic
velocities and linear pressures on curved quadrilaterals (Q2/Q1), BDF2 in time with convection by the extrapolated velocity;
drag from the residual of the momentum equation on the cylinder's nodes. Fluid and walls pass with U; upstream it is uniform
(the channel is closed far away), downstream free of stress. Needs scipy; cases read the file only.
"""

import pathlib

import numpy as np
import scipy.sparse as sparse
from scipy.sparse.linalg import splu

HEIGHT, UPSTREAM, DOWNSTREAM = 4.0, 8.0, 20.0  # channel's height, and distances of its ends from the middle, over D


def quadratic(s):
    """Values and derivatives of the three shape functions at s."""
    return (np.array([s * (s - 1) / 2, 1 - s * s, s * (s + 1) / 2]), np.array([s - 0.5, -2 * s, s + 0.5]))


def block(places):
    """Nodes (2 a + 1, 2 b + 1, 2) to elements (a b, 9, 2)."""
    a, b = (places.shape[0] - 1) // 2, (places.shape[1] - 1) // 2
    return np.array([places[2 * i:2 * i + 3, 2 * j:2 * j + 3].reshape(9, 2) for i in range(a) for j in range(b)])


def mesh(n):
    """Coordinates of nodes, elements' nodes (9 each), from blocks around the half cylinder and up and down the channel."""
    half, blocks = HEIGHT / 2, []
    radial = np.linspace(0, 1, 4 * n + 1)**1.6
    for side, start, stop in (("right", 0, 0.25), ("top", 0.25, 0.75), ("left", 0.75, 1)):
        count = 4 * n if side == "top" else 2 * n
        angle = np.pi * np.linspace(start, stop, count + 1)
        direction = np.column_stack([np.cos(angle), np.sin(angle)])
        inner = 0.5 * direction
        outer = half * direction / np.abs(direction).max(axis=1)[:, None]
        if side != "top":
            outer[:, 1] = np.abs(outer[:, 1])
        blocks.append(block(inner[None] + radial[:, None, None] * (outer - inner)[None]))
    heights = half * np.tan(np.pi / 4 * np.linspace(0, 1, 2 * n + 1))
    for first, last, count, power in ((half, DOWNSTREAM, 6 * n, 1.3), (-half, -UPSTREAM, 2 * n, 1.3)):
        x = first + (last - first) * np.linspace(0, 1, count + 1)**power
        places = np.stack(np.meshgrid(x, heights, indexing="ij"), axis=-1)
        blocks.append(block(places))
    points = np.concatenate(blocks).reshape(-1, 2)
    _, first, number = np.unique(np.round(points, 7), axis=0, return_index=True, return_inverse=True)
    return points[first], number.reshape(-1, 9)


class Flow:
    def __init__(self, n, reynolds):
        self.places, self.elements = mesh(n)
        self.nodes, self.viscosity = len(self.places), 1 / reynolds
        corners = self.elements[:, [0, 2, 6, 8]]
        used, number = np.unique(corners, return_inverse=True)
        self.pressure_nodes, self.pressures = number.reshape(-1, 4), len(used)
        gauss, weight = np.polynomial.legendre.leggauss(3)
        shapes, dx, dy, low, measure = [], [], [], [], []
        xy = self.places[self.elements]
        for s, ws in zip(gauss, weight):
            for t, wt in zip(gauss, weight):
                (a, da), (b, db) = quadratic(s), quadratic(t)
                value, by_s, by_t = np.outer(a, b).ravel(), np.outer(da, b).ravel(), np.outer(a, db).ravel()
                js, jt = np.einsum("k,ekd->ed", by_s, xy), np.einsum("k,ekd->ed", by_t, xy)
                det = js[:, 0] * jt[:, 1] - js[:, 1] * jt[:, 0]
                shapes.append(value)
                dx.append((by_s[None] * jt[:, 1:] - by_t[None] * js[:, 1:]) / det[:, None])
                dy.append((by_t[None] * js[:, :1] - by_s[None] * jt[:, :1]) / det[:, None])
                low.append(np.outer([1 - s, 1 + s], [1 - t, 1 + t]).ravel() / 4)
                measure.append(ws * wt * np.abs(det))
        self.shape, self.dx, self.dy = np.array(shapes), np.array(dx), np.array(dy)
        self.low, self.measure = np.array(low), np.array(measure)
        self.mass = self.matrix(np.einsum("qe,qi,qj->eij", self.measure, self.shape, self.shape))
        laplace = self.matrix(np.einsum("qe,qei,qej->eij", self.measure, self.dx, self.dx)
                              + np.einsum("qe,qei,qej->eij", self.measure, self.dy, self.dy))
        self.stiffness = self.viscosity * laplace
        rows = np.repeat(self.elements, 4, axis=1).ravel()
        columns = np.tile(self.pressure_nodes, (1, 9)).ravel()
        gradient = [sparse.csr_matrix((np.einsum("qe,qei,qk->eik", self.measure, d, self.low).ravel(), (rows, columns)),
                                      shape=(self.nodes, self.pressures)) for d in (self.dx, self.dy)]
        self.gradient = sparse.vstack(gradient).tocsr()  # INT dw/dx p
        x, y = self.places.T
        self.body = np.hypot(x, y) < 0.5 + 1e-6
        moving = (y > HEIGHT / 2 - 1e-6) | (x < -UPSTREAM + 1e-6)
        fixed_x, fixed_y = self.body | moving, self.body | moving | (y < 1e-6)
        self.free = np.flatnonzero(~np.concatenate([fixed_x, fixed_y, np.zeros(self.pressures, bool)]))
        self.given = np.concatenate([np.where(moving & ~self.body, 1.0, 0.0), np.zeros(self.nodes + self.pressures)])

    def matrix(self, values):
        rows, columns = np.repeat(self.elements, 9, axis=1).ravel(), np.tile(self.elements, (1, 9)).ravel()
        return sparse.csr_matrix((values.ravel(), (rows, columns)), shape=(self.nodes, self.nodes))

    def convection(self, velocity):
        u = np.einsum("qi,eid->qed", self.shape, velocity.reshape(2, -1).T[self.elements])
        along = u[:, :, :1] * self.dx + u[:, :, 1:] * self.dy
        return self.matrix(np.einsum("qe,qi,qej->eij", self.measure, self.shape, along))

    def solve(self, block_matrix, right):
        """(solution, drag of the whole cylinder over rho U2 D)."""
        whole = sparse.bmat([[sparse.block_diag([block_matrix] * 2), -self.gradient], [-self.gradient.T, None]]).tocsc()
        force = np.concatenate([right, np.zeros(self.pressures)])
        result = self.given.copy()
        rest = force - whole @ result
        result[self.free] = splu(whole[self.free][:, self.free].tocsc()).solve(rest[self.free])
        residual = whole @ result - force
        return result, -2 * residual[:self.nodes][self.body].sum()

    def march(self, step, end):
        """Times [D/U] and drag coefficients 2 F/(rho U2 D). The first two steps are implicit Euler."""
        velocity = self.given[:2 * self.nodes].copy()
        velocity[:self.nodes][~self.body] = 1.0
        old, times, drags = None, [], []
        for k in range(round(end / step)):
            euler = k < 2  # the velocity at the start is not free of divergence
            past, factor = (velocity, 1.0) if euler else (2 * velocity - 0.5 * old, 1.5)
            convecting = velocity if euler else 2 * velocity - old
            right = np.concatenate([self.mass @ part for part in past.reshape(2, -1)]) / step
            result, drag = self.solve(factor / step * self.mass + self.stiffness + self.convection(convecting), right)
            old, velocity = velocity, result[:2 * self.nodes]
            times.append((k + 1) * step)
            drags.append(2 * drag)
        return np.array(times), np.array(drags)

    def steady(self, rounds=12):
        velocity, drag = np.zeros(2 * self.nodes), 0.0
        for _ in range(rounds):
            result, drag = self.solve(self.stiffness + self.convection(velocity), np.zeros(2 * self.nodes))
            velocity = result[:2 * self.nodes]
        return 2 * drag


def faxen(ratio):
    """Drag coefficient times Re of a cylinder between plates, distance over diameter 1/ratio, without inertia (Faxen 1946)."""
    k = ratio
    return 8 * np.pi / (-0.9157 - np.log(k) + 1.7244 * k**2 - 1.7302 * k**4 + 2.4056 * k**6 - 4.5913 * k**8)


if __name__ == "__main__":
    print(f"Re 0: Cd Re = {1e-3 * Flow(8, 1e-3).steady(1):.4f}, Faxen {faxen(1 / HEIGHT):.4f}")
    path = pathlib.Path(__file__).with_name("cylinder.csv")
    rows = ["Re, t U/D, 2 F/(rho U2 D)"]
    for reynolds in (20, 100):
        times, drags = Flow(8, reynolds).march(0.05, 10)
        rows += [f"{reynolds}, {time:.2f}, {drag:.4f}" for time, drag in list(zip(times, drags))[9::2]]
    path.write_text("\n".join(rows) + "\n")
