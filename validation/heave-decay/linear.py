"""Linear potential flow around a heaving rectangle in a closed tank, in time, 2-D.

Laplace's equation for the potential under still water, with eta_t = phi_z and phi_t = -g eta on the surface, no flow through
walls, bottom and sides of the body, and phi_z = V on the body's bottom; of the body m V_t = -rho g B zeta - rho INT phi_t dx.
Walls reflect, the water keeps its volume, and added mass and damping come out by themselves. Bilinear finite elements on one
half of the (symmetric) tank, graded towards the body's edge; what remains are the surface's and the body's unknowns, a
linear system of ordinary differential equations, which a matrix exponential steps exactly.
"""

import numpy as np

GRAVITY = 9.81  # [m/s2]


def graded(length, count, towards_end=False, power=1.8):
    """Places from 0 to length, closest at 0 (or at the end)."""
    places = length * np.linspace(0, 1, count + 1)**power
    return length - places[::-1] if towards_end else places


def grid(half_breadth, half_length, draft, depth, n):
    """Coordinates of a grid that is finest at the body's edge: x from the middle, z from the still surface down."""
    mirrored = lambda span: np.concatenate([graded(span / 2, n // 2), span / 2 + graded(span / 2, n // 2, True)[1:]])
    x = np.concatenate([graded(half_breadth, n, True), half_breadth + graded(half_length - half_breadth, 2 * n)[1:]])
    z = np.concatenate([mirrored(draft), draft + graded(depth - draft, n)[1:]])
    return x, z


def system(breadth, length, draft, depth, n):
    """Matrix A of y' = A y with y = (phi on the surface, eta, zeta, V), eta and zeta [m] of half the tank, and the added mass
    over rho at infinite frequency [m2] of the whole body."""
    half = breadth / 2
    x, z = grid(half, length / 2, draft, depth, n)
    number = -np.ones((len(x), len(z)), dtype=int)
    wet = (x[:, None] >= half - 1e-12) | (z[None, :] >= draft - 1e-12)
    number[wet] = np.arange(wet.sum())
    stiffness = np.zeros((wet.sum(), wet.sum()))
    a1, m1 = np.array([[1, -1], [-1, 1]]), np.array([[2, 1], [1, 2]]) / 6
    for i in range(len(x) - 1):
        for j in range(len(z) - 1):
            if 0.5 * (x[i] + x[i + 1]) < half and 0.5 * (z[j] + z[j + 1]) < draft:
                continue
            dx, dz = x[i + 1] - x[i], z[j + 1] - z[j]
            nodes = number[i:i + 2, j:j + 2].ravel()
            stiffness[np.ix_(nodes, nodes)] += np.kron(a1 / dx, m1 * dz) + np.kron(m1 * dx, a1 / dz)
    edge = int(np.argmin(abs(x - half)))

    def line(places):
        """Mass matrix of linear elements."""
        result = np.zeros((len(places), len(places)))
        for k in range(len(places) - 1):
            result[k:k + 2, k:k + 2] += m1 * (places[k + 1] - places[k])
        return result

    surface = number[edge:, 0]
    mass = line(x[edge:])
    inner = np.setdiff1d(np.arange(len(stiffness)), surface)
    push = np.zeros(len(stiffness))
    push[number[:edge + 1, int(np.argmin(abs(z - draft)))]] = line(x[:edge + 1]).sum(axis=1)
    coupled = stiffness[np.ix_(inner, surface)]
    solved = np.linalg.solve(stiffness[np.ix_(inner, inner)], np.column_stack([coupled, push[inner]]))
    dirichlet = stiffness[np.ix_(surface, surface)] - coupled.T @ solved[:, :-1]
    lowered = coupled.T @ solved[:, -1]  # INT w phi_z dx on the surface for V = 1
    added = push[inner] @ solved[:, -1]
    m = half * draft + added  # mass over rho, of half the body
    count = len(surface)
    matrix = np.zeros((2 * count + 2, 2 * count + 2))
    phi, eta, zeta, v = slice(0, count), slice(count, 2 * count), 2 * count, 2 * count + 1
    matrix[phi, eta] = -GRAVITY * np.eye(count)
    matrix[eta, phi] = np.linalg.solve(mass, dirichlet)
    matrix[eta, v] = np.linalg.solve(mass, lowered)
    matrix[zeta, v] = 1
    matrix[v, zeta] = -GRAVITY * half / m
    matrix[v, eta] = -GRAVITY * lowered / m
    return matrix, 2 * added


def exponential(matrix):
    """By scaling, a Taylor series and squaring."""
    squarings = max(0, int(np.ceil(np.log2(np.abs(matrix).sum(axis=1).max()))) + 2)
    scaled = matrix / 2**squarings
    result = term = np.eye(len(matrix))
    for k in range(1, 20):
        term = term @ scaled / k
        result = result + term
    for _ in range(squarings):
        result = result @ result
    return result


def heave(breadth, length, draft, depth, start, times, n=24):
    """Height [m] over its rest of a body that weighs what it displaces at `draft`, let go at `start` at t = 0 while the water
    is level; `times` are evenly spaced."""
    matrix, _ = system(breadth, length, draft, depth, n)
    step = exponential(matrix * (times[1] - times[0]))
    state = np.zeros(len(matrix))
    state[-2] = start
    result = []
    for _ in times:
        result.append(state[-2])
        state = step @ state
    return np.array(result)
