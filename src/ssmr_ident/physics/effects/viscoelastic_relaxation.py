"""Viscoelastic rubber: a spring in series with a dashpot beside the tire."""

from __future__ import annotations

from ssmr_ident.core.exponential import exp
from ssmr_ident.core.kernel import kernel
from ssmr_ident.core.parameter import Parameter
from ssmr_ident.physics.effect import Effect, Site, Sized


@kernel
def force(z, stiffness):
    """K_m·z [N]; z : float [m], stiffness : float [N/m]."""
    return stiffness * z


@kernel
def advance(z, v, step, tau):
    """dz/dt = v - z/tau over one step at constant v, exactly; z : float [m], v : float [m/s], tau : float [s]."""
    end = v * tau
    return end + (z - end) * exp(-step / tau)


EFFECT = Effect(
    id="viscoelastic_relaxation",
    sentence="The rubber creeps: pressed quickly it is stiffer, and held still its force relaxes.",
    equation=r"F = K s + D v + K_m z,\quad \dot z = v - z/\tau",
    source="J. C. Maxwell, Phil. Trans. R. Soc. 157, 1867; W. N. Findley, Creep and Relaxation, Dover 1989, chapter 5",
    signature="ramps steeper at higher speed; the force sags while the head stands still",
    parameters=(
        Parameter("K_m_N_m", "N/m", 5e3, 0.0, 1e12, "of the branch, lateral; along x and z in the ratio of K", off=0.0),
        Parameter("tau_s", "s", 0.5, 1e-6, 1e5, "time constant of the branch"),
    ),
    experiments=("free_response", "pull", "wheel_drag", "vertical_compression", "forced"),
    acts={Site.ELEMENT: force, Site.STATE: advance},
    rig=True,
    probes=(
        {"K_m_N_m": Sized(0.2, "stiffness"), "tau_s": Sized(1.0, "time")},
        {"K_m_N_m": Sized(0.2, "stiffness"), "tau_s": Sized(0.05, "duration")},
        {"K_m_N_m": Sized(0.2, "stiffness"), "tau_s": Sized(0.3, "duration")},
    ),
)
