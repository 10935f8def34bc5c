"""Bodies with one coordinate each, and springs with dampers between them: M q'' + C q' + K q = force."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ssmr_ident.core.parameter import GROUND, ParameterSet
from ssmr_ident.physics.rig import RIG_KEYS

Array = np.ndarray

NETWORK = "network"
"""The baseline of a session whose parameter file has bodies and springs."""

BODY_KEY = {False: "mass_kg", True: "inertia_kg_m2"}
SPRING_KEYS = {False: ("damping_N_s_m", "stiffness_N_m"), True: ("damping_N_m_s_rad", "stiffness_N_m_rad")}


@dataclass(frozen=True)
class Layout:
    """Which bodies there are, and what each spring joins.

    Parameters
    ----------
    bodies, springs : tuple of str
    ends : tuple of pair of int
        Of each spring, by the numbers of the bodies; -1 is the ground.
    rotary : bool
        Read inertia, moment and angle then.
    """

    bodies: tuple[str, ...]
    springs: tuple[str, ...]
    ends: tuple[tuple[int, int], ...]
    rotary: bool = False

    @cached_property
    def stretch(self) -> Array:
        """(springs, bodies) float: how far each spring is stretched by the bodies' coordinates."""
        rows = np.zeros((len(self.springs), len(self.bodies)))
        for row, (first, second) in zip(rows, self.ends, strict=True):
            for end, sign in ((first, -1.0), (second, 1.0)):
                if end >= 0:
                    row[end] += sign
            if second < 0:  # away from the ground counts, whichever end it is
                row *= -1.0
        rows.flags.writeable = False
        return rows

    @property
    def keys(self) -> tuple[str, ...]:
        """Paths in a parameter file: every body's mass, then damping and stiffness spring by spring."""
        masses = [f"bodies.{name}.{BODY_KEY[self.rotary]}" for name in self.bodies]
        return (*masses, *(f"springs.{name}.{key}" for name in self.springs for key in SPRING_KEYS[self.rotary]))

    @property
    def grounded(self) -> bool:
        """Whether a spring leads to the ground."""
        return any(-1 in ends for ends in self.ends)

    def matrices(self, values: Array) -> tuple[Array, Array, Array]:
        """Mass, damping and stiffness matrices, (…, n, n) float each, of the values of ``keys``, (…, k) float."""
        n, stretch = len(self.bodies), self.stretch
        damping, stiffness = values[..., None, n::2], values[..., None, n + 1 :: 2]
        mass = values[..., :n, None] * np.eye(n)
        return mass, (stretch.T * damping) @ stretch, (stretch.T * stiffness) @ stretch


ONE = Layout(("body",), ("spring",), ((-1, 0),))
"""A rig: one mass on one spring."""


@dataclass(frozen=True, eq=False)
class Network:
    """A layout with its numbers.

    Parameters
    ----------
    layout : Layout
    values : (k,) float
        SI, in the order of ``layout.keys``.
    """

    layout: Layout
    values: Array

    @property
    def state_matrix(self) -> Array:
        """A of d(q, q')/dt = A (q, q') + B force, (2n, 2n) float."""
        mass, damping, stiffness = self.layout.matrices(self.values)
        n = len(mass)
        lower = -np.linalg.solve(mass, np.hstack([stiffness, damping]))
        return np.vstack([np.eye(2 * n)[n:], lower])

    def modes(self) -> tuple[Array, Array, Array]:
        """Natural frequencies [Hz], damping ratios, and shapes scaled to 1 at their largest, columns by frequency.

        A mode that does not swing (a network that nothing holds, more than critical damping) is left out.
        """
        n = len(self.layout.bodies)
        poles, vectors = np.linalg.eig(self.state_matrix)
        chosen = np.flatnonzero(poles.imag > 1e-9 * np.abs(poles).max())
        chosen = chosen[np.argsort(np.abs(poles[chosen]))]
        shapes = vectors[:n, chosen]
        largest = shapes[np.argmax(np.abs(shapes), axis=0), np.arange(len(chosen))]
        size = np.abs(poles[chosen])
        return size / (2.0 * np.pi), -poles[chosen].real / size, (shapes / largest).real


def bodies_of(parameters: ParameterSet) -> tuple[str, ...]:
    """Names of a network's bodies, in the file's order; none for anything else."""
    return tuple(key.split(".")[1] for key in parameters if key.startswith("bodies."))


def layout_of(parameters: ParameterSet) -> Layout:
    """The layout that a parameter file describes."""
    bodies = bodies_of(parameters)
    number = {name: index for index, name in enumerate((GROUND, *bodies), start=-1)}
    ends = tuple((number[first], number[second]) for first, second in parameters.between.values())
    rotary = any(key.endswith(f".{BODY_KEY[True]}") for key in parameters)
    return Layout(bodies, tuple(parameters.between), ends, rotary)


def network_from_parameters(parameters: ParameterSet) -> Network:
    """The network of a parameter file that has been read; of a rig's file that of one body."""
    if not parameters.between:
        return Network(ONE, np.array([float(parameters[key].value) for key in RIG_KEYS["inertia_kg_m2" in parameters]]))
    layout = layout_of(parameters)
    return Network(layout, np.array([float(parameters[key].value) for key in layout.keys]))
