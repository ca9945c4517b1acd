"""The 3-D Taylor-Green vortices by a spectral method: the reference where there is no closed solution."""

import numpy as np

MODES = 32  # points each way; at Re = 100 the energy at t U/L = 1 is the same with 24 to 1e-6
STEP = 0.01  # [s]


class Spectral:
    """Incompressible flow in the unit box, periodic: Fourier modes, products freed of aliases (two thirds), RK4, the
    viscous term exact."""

    def __init__(self, viscosity):
        number = np.fft.fftfreq(MODES, 1 / MODES)
        self.wave = 2 * np.pi * np.stack(np.meshgrid(number, number, number, indexing="ij"))
        self.square = (self.wave**2).sum(axis=0)
        self.kept = (abs(self.wave) < 2 * np.pi * MODES / 3).all(axis=0)
        self.viscosity = viscosity
        places = np.arange(MODES) / MODES
        self.velocity = np.fft.fftn(start(*np.meshgrid(places, places, places, indexing="ij")), axes=(1, 2, 3))

    def rate(self, velocity):
        """Of the modes by convection, with the pressure that keeps them free of divergence."""
        here = np.fft.ifftn(velocity, axes=(1, 2, 3)).real
        slopes = np.fft.ifftn(1j * self.wave[None] * velocity[:, None], axes=(2, 3, 4)).real
        force = -np.fft.fftn((here[None] * slopes).sum(axis=1), axes=(1, 2, 3)) * self.kept
        along = (self.wave * force).sum(axis=0) / np.where(self.square > 0, self.square, 1)
        return force - self.wave * along

    def advance(self, time):
        """By `time`, a multiple of the step."""
        half = np.exp(-self.viscosity * self.square * STEP / 2)
        for _ in range(round(time / STEP)):
            v = self.velocity
            k1 = self.rate(v)
            k2 = self.rate(half * (v + STEP / 2 * k1))
            k3 = self.rate(half * v + STEP / 2 * k2)
            k4 = self.rate(half**2 * v + STEP * half * k3)
            self.velocity = half**2 * v + STEP / 6 * (half**2 * k1 + 2 * half * (k2 + k3) + k4)

    def energy(self):
        """Mean of |v|^2/2 [m^2/s^2]."""
        return 0.5 * (abs(self.velocity)**2).sum() / MODES**6

    def at(self, places):
        """Velocity [m/s] at places (rows of x, y, z), from the modes up to the tenth; higher ones hold nothing here."""
        number = np.arange(-10, 11)
        modes = self.velocity[:, number[:, None, None], number[None, :, None], number[None, None, :]] / MODES**3
        result = np.empty_like(places)
        for rows in np.array_split(np.arange(len(places)), max(1, len(places) // 2000)):
            x, y, z = (np.exp(2j * np.pi * np.outer(places[rows, axis], number)) for axis in range(3))
            for axis in range(3):
                along_z = np.einsum("pc,abc->pab", z, modes[axis])
                result[rows, axis] = np.einsum("pa,pb,pab->p", x, y, along_z).real
        return result


def start(x, y, z):
    """Velocity [m/s] at t = 0, components first."""
    k = 2 * np.pi
    u, v = np.sin(k * x) * np.cos(k * y) * np.cos(k * z), -np.cos(k * x) * np.sin(k * y) * np.cos(k * z)
    return np.stack([u, v, 0 * z])


def start_pressure(x, y, z):
    """Pressure over density [m^2/s^2] at t = 0."""
    k = 4 * np.pi
    return (np.cos(k * x) + np.cos(k * y)) * (np.cos(k * z) + 2) / 16
