"""A centre of mass that is off, told as one place."""

from __future__ import annotations

from ssmr_ident.identify.fitting.joint import JointFit, evaluate

OFFSET = "com_offset"


def gathered(fit: JointFit) -> JointFit:
    """The same robot, with all that its centre of mass is off by in the offset that has no prior.

    Contacts and sensor that the baseline had moved against what is known, and an offset, add up to one place. The
    recordings know only that, and a descent does not go along a valley so flat; least of all in pulls, whose slopes are
    rough where wheels let go: a centre of mass 36 mm off (bank 5018) was contacts 40 mm off at 8 deviations, and an
    offset begun beside them stayed below a millimetre.
    """
    if OFFSET not in fit.model.held:
        return fit
    columns = {unknown.name: (k, unknown) for k, unknown in enumerate(fit.model.unknowns)}
    best = fit
    for moved in ((f"{OFFSET}.offset_{{}}_m", "accelerometer.position_m.{}"), (f"{OFFSET}.offset_{{}}_m",)):
        point = fit.point.copy()
        for axis in "xy":
            own = columns.get(f"contact_shift_{axis}_m")
            if own is None:
                continue
            shift = own[1].value(float(fit.point[own[0]]))
            others = [columns[n.format(axis)] for n in moved if n.format(axis) in columns]
            for k, unknown in (own, *others):
                point[k] = unknown.scaled(unknown.value(float(fit.point[k])) - shift)
        other = evaluate(fit.trials, fit.model, point, fit.nuisances, fit.slopes)
        best = min((best, other), key=lambda f: f.cost(fit.counted))
    return best
