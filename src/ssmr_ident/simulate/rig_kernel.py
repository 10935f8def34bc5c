"""A rig's motion with its slopes, stretch by stretch: exact linear steps, kicks of the forces beside them.

Strang splitting about the exact propagator, with what kicks leave of a smooth force (``simulate.kicks``), and the mean
of the force in steps near rest, where it may jump. One loop simulates and fits: every state carries its derivatives
with respect to where its stretch begins, to the model's parameters and to what else drives it (forward sensitivities).
"""

from __future__ import annotations

import math

import numpy as np

from ssmr_ident.core.kernel import inlined, kernel
from ssmr_ident.physics.effects import load_dependent_friction, unlisted
from ssmr_ident.physics.element import STATES, element_force, element_next, free_slots, inner_slots, spring_force
from ssmr_ident.physics.slots import LOAD_FRICTION, LOAD_ROUNDING, LOAD_SHARE
from ssmr_ident.physics.voltage_drive import torque, voltage

_unlisted, _gears = unlisted.force, load_dependent_friction.force

TINY = 1e-6
"""Relative step of the differences that give a law's slopes; laws are scalar functions, run in double precision."""

NEWTON = 30
"""Iterations at the most for the velocity after a kick, whose force depends on it."""

NEAR = 1e-5
"""Of the largest velocity, how near the first guess is where a straight line goes the rest of the way, and what a force
that bends near rest does to it that is not counted."""

NOTHING = (0.0, 0.0, 0.0, 0.0, 0.0)
"""What ``_along_speed`` has of a force that does not bend."""

GRADES = 5
"""Parts of a velocity, each a quarter of the one before, in which a force that may jump at nought is averaged."""

TIMED = 1e-3
"""Of the size of the speed, how far that of a run is off where a force jumps, as a stiff solver tells: a tenth of it
for dry friction of a fortieth of what drives, all of it where friction holds the rig for most of the time."""

HELD = 0.1
"""Of that size, the largest speed within the last period or so below which it is that speed which counts: what holds a
rig at rest leaves nothing unsure."""

VALUE, BY_SPEED, ALL = range(3)
"""What is wanted of a force: itself, its slope over speed, all its slopes."""

BY_POSITION, BY_VELOCITY, CONSTANT, BY_INERTIA = range(4)
"""What a course over time multiplies."""


@kernel
def _cell(table, place):
    """Cell and share of a table that is even over -1 … 1; beyond, the last straight line goes on."""
    cells = table.shape[0] - 1
    at = 0.5 * (place + 1.0) * cells
    index = min(max(math.floor(at), 0), cells - 1)
    return index, at - index, 0.5 * cells


@kernel
def law_force(x, v, z, time, stiffness, drive, e, terms, gears):
    """Force of the laws [N]; ``drive`` : what drives [N], where ``gears`` carry it."""
    f = element_force(x, v, z, stiffness, 1.0, 1.0, True, inner_slots(e))
    if gears:
        carried = drive + spring_force(x, stiffness, e)
        f += _gears(v, carried, e[LOAD_FRICTION], e[LOAD_SHARE], e[LOAD_ROUNDING])
    return f + _unlisted(x, v, time, 1.0, free_slots(e)) if terms else f


@inlined
def _of_motor(x, v, given, motor, linear, slopes, first):
    """Torque of a motor [N m], its slopes over angle, rate and what it is given; those over its constant and resistance
    are taken off those of the force beside."""
    signal, on = given[1], given[2]
    _, gain, limit, ratio, _ = motor
    constant, resistance = linear[0, 3], linear[0, 4]
    volts = voltage(signal, x, gain, limit)
    by_volts, braking = ratio * constant / resistance, (ratio * constant) ** 2 / resistance
    own = torque(volts, v, on, by_volts, braking)
    slopes[first + 3] -= on * (by_volts * volts - 2.0 * braking * v) / constant * linear[1, 3]
    slopes[first + 4] += own / resistance * linear[1, 4]
    within = gain * abs(signal - x) < limit
    return (
        own,
        -on * by_volts * gain if within else 0.0,
        -on * braking,
        on * by_volts * (gain if within else 0.0) + (on * by_volts if gain == 0.0 else 0.0),
    )


@inlined
def _force(x, v, z, time, row, given, g, slopes, wanted):
    """Force beside the linear rig [N], its slopes over x and v; those over hidden states and parameters into
    ``slopes``, (hidden + parameters,); as far as they are ``wanted``. ``given`` : what drives [N], what a motor is
    given, whether it is connected."""
    (reach, steep, tab_x, tab_v, tab_xv, courses, course_kind, c, linear, yields, has_law, e, law_index, law_scale,
     size_x, size_v, uses, motor) = g  # fmt: skip
    jenkins = len(yields)
    remembers = uses[3] or uses[4] or uses[5]
    hidden = jenkins + (STATES if remembers else 0)
    f, fx, fv = 0.0, 0.0, 0.0
    at = 0
    first = hidden + linear.shape[1]
    drive, drive_x, drive_v, drive_zero = steep[2] * given[0], 0.0, 0.0, steep[2]
    if motor[0]:
        own, drive_x, drive_v, drive_zero = _of_motor(x, v, given, motor, linear, slopes, hidden)
        drive += own
        f, fx, fv = -own, -drive_x, -drive_v
    pulls, pulls_x = f, fx
    n = tab_x.shape[1]
    if n:
        i, share, per = _cell(tab_x, x / reach)
        for k in range(n):
            slope = tab_x[i + 1, k] - tab_x[i, k]
            value = tab_x[i, k] + share * slope
            f += c[at] * value
            fx += c[at] * slope * per / reach
            if wanted == ALL:
                slopes[first + at] = value
            at += 1
    pulls, pulls_x = f - pulls, fx - pulls_x  # what a spring of any shape pulls
    n, products = tab_v.shape[1], tab_xv.shape[2]
    if n or products:
        low, top, _ = steep
        place = math.asinh(v / low) / top
        change = 1.0 / (top * math.sqrt(v * v + low * low))
        i, share, per = _cell(tab_v if n else tab_xv[1], place)
        for k in range(n):
            slope = tab_v[i + 1, k] - tab_v[i, k]
            value = tab_v[i, k] + share * slope
            f += c[at] * value
            fv += c[at] * slope * per * change
            if wanted == ALL:
                slopes[first + at] = value
            at += 1
        if products:
            i_x, share_x, per_x = _cell(tab_xv[0], x / reach)
            for k in range(products):
                slope_x = tab_xv[0, i_x + 1, k] - tab_xv[0, i_x, k]
                slope_v = tab_xv[1, i + 1, k] - tab_xv[1, i, k]
                of_x = tab_xv[0, i_x, k] + share_x * slope_x
                of_v = tab_xv[1, i, k] + share * slope_v
                f += c[at] * of_x * of_v
                fv += c[at] * of_x * slope_v * per * change
                fx += c[at] * slope_x * per_x / reach * of_v
                if wanted == ALL:
                    slopes[first + at] = of_x * of_v
                at += 1
    for k in range(courses.shape[1]):
        psi = courses[row, k]
        kind = course_kind[k]
        if kind == BY_POSITION:
            value = psi * x
            fx += c[at] * psi
        elif kind == BY_VELOCITY:
            value = psi * v
            fv += c[at] * psi
        elif kind == CONSTANT:
            value = psi
        else:  # the mass is another: what acts on it moves it by another share
            value = psi * (linear[0, 2] * x + linear[0, 1] * v - drive)
            fx += c[at] * psi * (linear[0, 2] - drive_x)
            fv += c[at] * psi * (linear[0, 1] - drive_v)
            if wanted == ALL:
                slopes[hidden + 2] += c[at] * psi * x * linear[1, 2]
                slopes[hidden + 1] += c[at] * psi * v * linear[1, 1]
        f += c[at] * value
        if wanted == ALL:
            slopes[first + at] = value
        at += 1
    for k in range(jenkins):
        f += c[at] * z[k]
        if wanted == ALL:
            slopes[k] = c[at]
            slopes[first + at] = z[k]
        at += 1
    if motor[0] and wanted == ALL:
        slopes[first + at + len(law_index)] -= drive_zero
    if has_law:
        h = (z[jenkins], z[jenkins + 1], z[jenkins + 2]) if remembers else (0.0, 0.0, 0.0)
        stiffness = linear[0, 2]
        dx, dv = TINY * size_x, TINY * size_v
        dk = TINY * stiffness if stiffness > 0.0 else TINY
        gears = uses[7]
        d_drive = TINY * motor[4]
        centre, by_drive = 0.0, 0.0
        # one place from which the law is called, or the compiler writes it out a dozen times
        for q in range(8 + len(law_index) if wanted == ALL else 1 + wanted):
            if (1 <= q < 7 and not uses[q - 1]) or (q == 7 and not gears):
                continue
            was = e[law_index[q - 8]] if q >= 8 else 0.0
            if q >= 8:
                e[law_index[q - 8]] = was + TINY * law_scale[q - 8]
            at_v = v + dv if q == 1 else v
            at_x = x + dx if q == 2 else x
            at_k = stiffness + dk if q == 3 else stiffness
            at_h = (h[0] + dx if q == 4 else h[0], h[1] + dx if q == 5 else h[1], h[2] + dx if q == 6 else h[2])
            carried = drive + pulls + (d_drive if q == 7 else 0.0)
            value = law_force(at_x, at_v, at_h, time, at_k, carried, e, uses[6], gears)
            if q == 0:
                centre = value
                f += value
            elif q == 1:
                fv += (value - centre) / dv
            elif q == 2:
                fx += (value - centre) / dx
            elif q == 3:
                slopes[hidden + 2] += (value - centre) / dk * linear[1, 2]
            elif q < 7:
                slopes[jenkins + q - 4] = (value - centre) / dx
            elif q == 7:
                by_drive = (value - centre) / d_drive
            else:
                slopes[first + at + q - 8] = (value - centre) / (TINY * law_scale[q - 8])
                e[law_index[q - 8]] = was
        if wanted == ALL and gears:  # what drives is carried by the gears, too
            fx += by_drive * (drive_x + pulls_x)
            fv += by_drive * drive_v
            for k in range(tab_x.shape[1]):
                slopes[first + k] *= 1.0 + by_drive
            if motor[0]:
                slopes[hidden + 3] *= 1.0 - by_drive
                slopes[hidden + 4] *= 1.0 - by_drive
            slopes[first + at + len(law_index)] += by_drive * drive_zero
    return f, fx, fv


@kernel
def _toward_rest(x, v, z, time, row, given, g, slopes, mean_slopes, with_slopes):
    """The force's mean over the velocities from 0 to ``v`` and its slope over x, and what ``_force`` says at ``v``;
    ``mean_slopes`` : those of the mean, ``slopes`` those at ``v``."""
    mean, mean_x, f, fx, fv = 0.0, 0.0, 0.0, 0.0, 0.0
    for q in range(2 * GRADES + 1):  # from rest, so that what is left in ``slopes`` is that of ``v``; Simpson's rule
        at = 4.0 ** (q // 2 - GRADES)
        weight = at if q == 0 else 0.75 * at / 6.0
        if q % 2:  # the middle of a part
            at, weight = 2.5 * at, 2.0 * at
        elif q < 2 * GRADES:
            weight += 0.5 * at
        slopes[:] = 0.0
        wanted = ALL if with_slopes else BY_SPEED if q == 2 * GRADES else VALUE
        f, fx, fv = _force(x, v * at, z, time, row, given, g, slopes, wanted)
        mean += weight * f
        mean_x += weight * fx
        if with_slopes:
            for k in range(len(slopes)):
                mean_slopes[k] += weight * slopes[k]
    return mean, mean_x, f, fx, fv


@kernel
def _between(next_v, v, away, low, high):
    """The next guess of a velocity, and what brackets it: where Newton's lies outside, the middle."""
    if away > 0.0:
        high = v
    else:
        low = v
    beyond = (next_v <= low or next_v >= high) and math.isfinite(high - low)
    return (0.5 * (low + high) if beyond else next_v), low, high


@kernel
def _nears_rest(v_was, v):
    """Whether a step comes from rest, goes to it or passes through: only there does a force jump with speed."""
    return abs(v - v_was) > 0.5 * max(abs(v), abs(v_was))


@kernel
def _course(v, v_was, f, f_was, fv, fv_was, mean, mean_was, kick):
    """Force over a step near rest, by those at both velocities and their means from rest to there.

    Velocity goes along two straight lines, whose slopes differ as much as the forces on them: to rest and on; or to
    rest, where it stays, if what holds it there takes the rest of the step. Else it goes along one.

    Returns
    -------
    more, late : (4,) float
        As ``_along_speed`` has them, but for x.
    more_of, late_of : (4,) float
        How both go with the force at begin and end, and with its mean there.
    """
    change = v - v_was
    between = (v * mean - v_was * mean_was) / change
    by_end = (f - mean) / v if v != 0.0 else 0.5 * fv
    by_begin = (f_was - mean_was) / v_was if v_was != 0.0 else 0.5 * fv_was
    if v * v_was < 0.0:  # share·(change + jump·(1 - share)) = -v_was, the jump as a change of velocity
        held = mean - mean_was
        jump = 2.0 * kick * held
        whole = change + jump
        root = math.sqrt(max(whole * whole + 4.0 * jump * v_was, 0.0))
        share = min(max(-2.0 * v_was / (whole + (root if change > 0.0 else -root)), 0.0), 1.0)
        rest, rate = 1.0 - share, change + jump * (1.0 - 2.0 * share)
        moves = 2.0 * kick * share * rest / rate
        before, after = share - moves * held, rest**2 + 2.0 * rest * moves * held
        more = (
            2.0 * (share * mean_was + rest * mean) - f_was - f,
            2.0 * (share * held / rate + (1.0 - before) * by_end) - fv,
            2.0 * (rest * held / rate + before * by_begin) - fv_was,
            2.0 * moves * held**2 / kick,
        )
        late = (
            held * rest**2,
            2.0 * held * rest * share / rate + after * by_end,
            2.0 * held * rest**2 / rate - after * by_begin,
            2.0 * rest * moves * held**2 / kick,
        )
        return more, late, (-1.0, -1.0, 2.0 * before, 2.0 * (1.0 - before)), (0.0, 0.0, -after, after)
    less = f - between
    if abs(v) < abs(v_was) and 2.0 * kick * less / change > 1.0:
        share = change / (2.0 * kick * less)
        rest, after = 1.0 - share, 1.0 - share**2
        more = (f - f_was - change / kick, fv - 1.0 / kick, 1.0 / kick - fv_was, change / kick**2)
        late = (
            less * rest**2,
            after * (fv - less / change) - rest / kick,
            after * (f_was - between) / change + rest / kick,
            2.0 * rest * share * less / kick,
        )
        return more, late, (-1.0, 1.0, 0.0, 0.0), (0.0, after, after * v_was / change, -after * v / change)
    more = (
        2.0 * between - f_was - f,
        2.0 * (f - between) / change - fv,
        2.0 * (between - f_was) / change - fv_was,
        0.0,
    )
    none = (0.0, 0.0, 0.0, 0.0)
    return more, none, (-1.0, -1.0, -2.0 * v_was / change, 2.0 * v / change), none


@kernel
def _along_speed(v, v_was, moved, kick, x, z, time, row, given, g, slopes, more_slopes, late_slopes, mean_slopes):
    """What a force that jumps with speed does over a step beyond its mean of begin and end.

    Velocity goes from ``v_was`` to what is returned as ``_course`` has it, so that the jump lies within the step where
    it does, and not at its middle.

    Returns
    -------
    v : float [m/s]
    f, fx, fv : float
        The force there, with its slopes; those over states and parameters in ``slopes``.
    more, late : (5,) float
        Force [N] that the kick at the end has besides; and that which, over the whole step, would have moved the rig as
        what came later did beyond what came before. Each with its slopes over both velocities, the later first, over
        the kick and over x; those over parameters in ``more_slopes`` and ``late_slopes``.
    jump : float
        Share of the change of the force over the step that is a jump.
    """
    mean_was, _, f_was, _, fv_was = _toward_rest(x, v_was, z, time, row, given, g, slopes, mean_slopes, False)
    low, high = -math.inf, math.inf
    turn = 0
    while True:
        mean, _, f, _, fv = _toward_rest(x, v, z, time, row, given, g, slopes, mean_slopes, False)
        more, late, more_of, late_of = _course(v, v_was, f, f_was, fv, fv_was, mean, mean_was, kick)
        off = v - moved + kick * (f + more[0])
        away = off / max(1.0 + kick * (fv + more[1]), 0.1)
        if abs(away) <= 1e-7 * g[15] or turn == NEWTON:
            break
        v, low, high = _between(v - away, v, off, low, high)
        turn += 1
    mean_slopes[:] = 0.0
    _, mean_x_was, _, fx_was, _ = _toward_rest(x, v_was, z, time, row, given, g, slopes, mean_slopes, True)
    for k in range(len(slopes)):
        more_slopes[k] = more_of[0] * slopes[k] + more_of[2] * mean_slopes[k]
        late_slopes[k] = late_of[0] * slopes[k] + late_of[2] * mean_slopes[k]
    mean_slopes[:] = 0.0
    _, mean_x, f, fx, _ = _toward_rest(x, v, z, time, row, given, g, slopes, mean_slopes, True)
    for k in range(len(slopes)):
        more_slopes[k] += more_of[1] * slopes[k] + more_of[3] * mean_slopes[k]
        late_slopes[k] += late_of[1] * slopes[k] + late_of[3] * mean_slopes[k]
    more_x = more_of[0] * fx_was + more_of[1] * fx + more_of[2] * mean_x_was + more_of[3] * mean_x
    late_x = late_of[0] * fx_was + late_of[1] * fx + late_of[2] * mean_x_was + late_of[3] * mean_x
    rise = f - f_was
    jump = min(max(2.0 * (mean - mean_was) / rise - 1.0, 0.0), 1.0) if rise != 0.0 else 0.0
    return v, f, fx, fv, (*more, more_x), (*late, late_x), jump


@kernel
def _advance(z, tangents, change, change_slopes, step, first, by_v, g):
    """Hidden states one step later, with their slopes; ``change`` : deflection over the step,
    ``first`` : column of the first parameter of a law; ``by_v`` : (3,) float to work in."""
    (_, _, _, _, _, _, _, _c, _linear, yields, has_law, e, law_index, law_scale, size_x, size_v, uses, _motor) = g
    jenkins = len(yields)
    columns = tangents.shape[1]
    for k in range(jenkins):
        moved = z[k] + change
        if abs(moved) <= yields[k]:
            z[k] = moved
            for j in range(columns):
                tangents[k, j] += change_slopes[j]
        else:
            z[k] = yields[k] if moved > 0.0 else -yields[k]
            tangents[k, :] = 0.0
    if has_law and (uses[3] or uses[4] or uses[5]):
        v = change / step
        h = (z[jenkins], z[jenkins + 1], z[jenkins + 2])
        dx, dv = TINY * size_x, TINY * size_v
        new = h
        for q in range(3 + len(law_index)):
            was = e[law_index[q - 3]] if q >= 3 else 0.0
            difference = TINY * law_scale[q - 3] if q >= 3 else dv if q == 1 else dx
            if q >= 3:
                e[law_index[q - 3]] = was + difference
            begun = (h[0] + dx, h[1] + dx, h[2] + dx) if q == 2 else h
            other = element_next(begun, v + dv if q == 1 else v, step, True, inner_slots(e))
            if q == 0:
                new = other
            elif q == 1:
                for k in range(STATES):
                    by_v[k] = (other[k] - new[k]) / dv / step
            elif q == 2:
                for k in range(STATES):
                    by_z = (other[k] - new[k]) / dx
                    for j in range(columns):
                        tangents[jenkins + k, j] = by_z * tangents[jenkins + k, j] + by_v[k] * change_slopes[j]
            else:
                e[law_index[q - 3]] = was
                for k in range(STATES):
                    tangents[jenkins + k, first + q - 3] += (other[k] - new[k]) / difference
        for k in range(STATES):
            z[jenkins + k] = new[k]


@kernel
def run(
    lin, slopes_lin, rows, slopes_rows, g, beside, starts, places, times, drive, lines, drives, motor, every, step,
    y, dy, ends, dends, unsure,
):  # fmt: skip
    """Simulate stretches of recordings that stand one behind the other.

    Parameters
    ----------
    lin, slopes_lin : tuples of float
        (T, now, later, kick, aside), and the same with a first axis over the linear parameters: the exact step of the
        linear states, what the drive at its begin and end adds, what one newton takes away in half a step, and how far
        from the state kicks then leave it (``simulate.kicks``).
    rows, slopes_rows : tuples of float
        (C, from_drive, from_force, from_rise): channels over states, drive, force beside and its rise over a step.
    g : tuple
        The forces beside, as ``_force`` unpacks them: its last is (whether there is a motor, gain and limit of its
        controller, its gear ratio, size of what drives).
    beside : bool
        Whether there are any.
    starts : (s, states) float
        Linear states, then hidden ones, at the begin of each stretch.
    places : (s, 5) int
        Of each stretch: its first sample and that after its last one, the last sample of its recording; on the fine
        grid where the drive is at its begin, and the recording's last value, which goes on.
    times : (s,) float [s]
        At which stretches begin.
    drive, drives : (m,), (e, m) float
        On the fine grid. ``drives`` are its slopes over what may change in it: 1 for its zero, which with a motor is
        that of what the motor is given.
    lines : (m,) float
        Corners of straight lines that move the rig as the drive does: ``drive`` is what its instruments see.
    motor : pair of (m,) float
        What a motor is given, and whether it is connected, on the fine grid; a single number each where there is none.
    every : int
        Steps a sample.
    step : float [s]
        Of the fine grid.
    y, dy : (n, channels), (n, channels, columns) float
        Filled. Columns are starts, parameters (linear, beside), slopes of the drive.
    ends, dends : (s, states), (s, states, columns) float
        Filled: the state at each border's end.
    unsure : (n, channels) float
        Filled: how far channels are off for a speed that is, where forces beside are steep.
    """
    transition, now, later, kick, aside = lin
    d_transition, d_now, d_later, d_kick, d_aside = slopes_lin
    c, from_drive, from_force, from_rise = rows
    d_c, d_from_drive, d_from_force, _ = slopes_rows
    states = starts.shape[1]
    n_lin = transition.shape[0]
    hidden = states - n_lin
    n_par = d_transition.shape[0]
    columns = dy.shape[2]
    extra = drives.shape[0]
    zero = columns - extra
    channels = c.shape[0]
    s, new = np.empty(n_lin), np.empty(n_lin)
    z = np.zeros(max(hidden, 1))
    ds, dnew = np.zeros((n_lin, columns)), np.zeros((n_lin, columns))
    dz = np.zeros((max(hidden, 1), columns))
    df, change = np.zeros(columns), np.zeros(columns)
    slopes, by_v = np.zeros(hidden + columns), np.zeros(STATES)
    was, df_was, beyond, later_on = np.zeros(columns), np.zeros(columns), np.zeros(columns), np.zeros(columns)
    slopes_now = np.zeros(hidden + columns)
    more_slopes, late_slopes = np.zeros(hidden + columns), np.zeros(hidden + columns)
    mean_slopes = np.zeros(hidden + columns)
    moved_by = np.zeros(n_lin)  # what one newton beside, as a kick before a step, has taken away at its end
    for k in range(n_lin):
        for i in range(n_lin):
            moved_by[k] += transition[k, i] * kick[i]
    away_from, d_away = -aside, -d_aside
    late_share = math.exp(-step * g[15] / (2.0 * math.pi * g[14]))  # of a speed that is a step old: 1/e after a period
    jumps = g[16][0] or g[3].shape[1] > 0 or g[4].shape[2] > 0  # what does not look at speed does not jump with it
    for stretch in range(starts.shape[0]):
        ds[:], dz[:], df[:] = 0.0, 0.0, 0.0
        for k in range(n_lin):
            s[k] = starts[stretch, k]
            ds[k, k] = 1.0
        for k in range(hidden):
            z[k] = starts[stretch, n_lin + k]
            dz[k, n_lin + k] = 1.0
        f, fx, fv, x_was, v_was, f_was, rise, fastest = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        first, after, last_row, driven_from, last = places[stretch]
        total = (after - first) * every
        for n in range(total + 1):
            at = min(driven_from + n, last)
            here, turned = drive[at], at if g[17][0] else 0
            given = here, motor[0][turned], motor[1][turned]
            if beside:
                moved = s[1]
                row = min(first + n // every, last_row)
                time = times[stretch] + n * step
                half = 1.0 if n else 0.0
                v, f_was = moved, f
                if n:  # as the last force goes on, to first order
                    f += (fx * (s[0] - x_was) + fv * (moved - kick[1] * f - v_was)) / max(1.0 + kick[1] * fv, 0.1)
                    v -= kick[1] * f
                turn, low, high = 0, -math.inf, math.inf
                while True:
                    slopes[:] = 0.0
                    guess = f
                    f, fx, fv = _force(s[0] - half * aside[0] * guess, v, z, time, row, given, g, slopes, ALL)
                    met = 1.0 / (1.0 + half * aside[0] * fx)
                    f, fx, fv = guess + met * (f - guess), met * fx, met * fv
                    off = half * (v - moved + kick[1] * f)
                    away = off / max(1.0 + kick[1] * fv, 0.1)
                    flat = turn == 0 and fv == 0.0 and v * (v - away) > 0.0  # a force of this velocity's sign alone
                    if flat or abs(away) <= NEAR * g[15]:
                        f -= fv * away
                        v -= away
                        break
                    if turn == NEWTON:
                        break
                    turn += 1
                    v, low, high = _between(v - away, v, off, low, high)
                for j in range(len(slopes)):
                    slopes[j] *= met
                more, late, jump = NOTHING, NOTHING, 0.0
                leaps = n > 0 and jumps and _nears_rest(v_was, v)
                if leaps:  # a quarter of the way a smooth force is on a straight line
                    x = s[0] - aside[0] * f_was
                    begun, _, _ = _force(x, v_was, z, time, row, given, g, slopes_now, VALUE)
                    at_v = 0.75 * v_was + 0.25 * v
                    at_f, _, _ = _force(x, at_v, z, time, row, given, g, slopes_now, VALUE)
                    leaps = kick[1] * abs(at_f - 0.75 * begun - 0.25 * f) > NEAR * g[15]
                if leaps:
                    at_v, at_f, at_fx, at_fv, more, late, jump = _along_speed(
                        v, v_was, moved, kick[1], x, z, time, row, given, g, slopes_now, more_slopes, late_slopes,
                        mean_slopes,
                    )  # fmt: skip
                    v, f, fx, fv = at_v, at_f, at_fx, at_fv
                    slopes[:] = slopes_now
                    for j in range(columns):
                        beyond[j] = more[2] * was[j] + more[4] * ds[0, j]
                        later_on[j] = late[2] * was[j] + late[4] * ds[0, j]
                    for p in range(columns - states):
                        beyond[states + p] += more_slopes[hidden + p]
                        later_on[states + p] += late_slopes[hidden + p]
                    for p in range(n_par):
                        beyond[states + p] += more[3] * d_kick[p, 1]
                        later_on[states + p] += late[3] * d_kick[p, 1]
                v_was = v
                fastest = max(abs(v), late_share * fastest)
                taken = half * kick[1]
                share = 1.0 / (1.0 + taken * (fv + more[1]))
                for j in range(columns):
                    df[j] = fx * ds[0, j]
                for p in range(columns - states):
                    df[states + p] += slopes[hidden + p]
                for p in range(n_par):
                    df[states + p] -= half * fx * d_aside[p, 0] * f
                for k in range(hidden):
                    for j in range(columns):
                        df[j] += slopes[k] * dz[k, j]
                if leaps:
                    for j in range(columns):
                        dv = ds[1, j] - taken * (df[j] + beyond[j])
                        if states <= j < states + n_par:
                            dv -= half * d_kick[j - states, 1] * (f + more[0])
                        df[j] += fv * dv * share
                        beyond[j] += more[1] * dv * share
                        for k in range(n_lin):
                            ds[k, j] -= kick[k] * beyond[j]
                        ds[0, j] -= step * kick[1] * (later_on[j] + late[1] * dv * share)
                    for k in range(n_lin):
                        s[k] -= kick[k] * more[0]
                    for p in range(n_par):
                        for k in range(n_lin):
                            ds[k, states + p] -= d_kick[p, k] * more[0]
                        ds[0, states + p] -= step * d_kick[p, 1] * late[0]
                    s[0] -= step * kick[1] * late[0]
                    for k in range(n_lin):  # where kicks put it, of the force that is now
                        s[k] += jump * aside[k] * (f - f_was)
                        for j in range(columns):
                            ds[k, j] += jump * aside[k] * (df[j] - df_was[j])
                        for p in range(n_par):
                            ds[k, states + p] += jump * d_aside[p, k] * (f - f_was)
                elif fv != 0.0:
                    own, other = 1.0 - fv * share * taken, fv * share
                    for j in range(columns):
                        df[j] = own * df[j] + other * ds[1, j]
                    for p in range(n_par):
                        df[states + p] -= other * half * d_kick[p, 1] * f
                rise = 0.0 if leaps or n == 0 else f - f_was
                own, d_own = (kick, d_kick) if n else (away_from, d_away)
                for k in range(n_lin):
                    s[k] -= own[k] * f
                    if own[k] != 0.0:
                        for j in range(columns):
                            ds[k, j] -= own[k] * df[j]
                    for p in range(n_par):
                        ds[k, states + p] -= d_own[p, k] * f
            if n % every == 0 and n < total:
                row = first + n // every
                apart = 0.0
                if beside and jumps:
                    off = TIMED * min(g[15], fastest / HELD)
                    above, _, _ = _force(s[0], v + off, z, time, row, given, g, slopes_now, VALUE)
                    below, _, _ = _force(s[0], v - off, z, time, row, given, g, slopes_now, VALUE)
                    apart = 0.5 * (above - below)
                for k in range(channels):
                    value = from_drive[k] * here + from_force[k] * f + from_rise[k] * rise
                    for i in range(n_lin):
                        value += c[k, i] * s[i]
                    y[row, k] = value
                    unsure[row, k] = from_force[k] * apart
                    out = dy[row, k]
                    by_0, by_1, by_f = c[k, 0], c[k, 1], from_force[k]
                    if beside and by_f != 0.0:
                        for j in range(columns):
                            out[j] = by_0 * ds[0, j] + by_1 * ds[1, j] + by_f * df[j]
                    else:
                        for j in range(columns):
                            out[j] = by_0 * ds[0, j] + by_1 * ds[1, j]
                    for i in range(2, n_lin):
                        weight = c[k, i]
                        if weight != 0.0:
                            for j in range(columns):
                                out[j] += weight * ds[i, j]
                    for p in range(n_par):
                        own = d_from_drive[p, k] * here + d_from_force[p, k] * f
                        for i in range(n_lin):
                            own += d_c[p, k, i] * s[i]
                        out[states + p] += own
                    for q in range(extra):
                        out[zero + q] += from_drive[k] * drives[q, at]
            if n == total:
                break
            if jumps:
                for j in range(columns):
                    was[j], df_was[j] = ds[1, j], df[j]
            x_was = s[0]
            if hidden:
                for j in range(columns):
                    change[j] = ds[0, j]
            next_at = min(at + 1, last)
            line, there = lines[at], lines[next_at]
            if beside:
                for k in range(n_lin):
                    s[k] -= kick[k] * f
                    for p in range(n_par):
                        ds[k, states + p] -= d_kick[p, k] * f
            for k in range(n_lin):
                value = now[k] * line + later[k] * there
                for i in range(n_lin):
                    value += transition[k, i] * s[i]
                new[k] = value
                by_0, by_1, by_f = transition[k, 0], transition[k, 1], moved_by[k]
                if beside:
                    for j in range(columns):
                        dnew[k, j] = by_0 * ds[0, j] + by_1 * ds[1, j] - by_f * df[j]
                else:
                    for j in range(columns):
                        dnew[k, j] = by_0 * ds[0, j] + by_1 * ds[1, j]
                for i in range(2, n_lin):
                    weight = transition[k, i]
                    for j in range(columns):
                        dnew[k, j] += weight * ds[i, j]
                for p in range(n_par):
                    own = d_now[p, k] * line + d_later[p, k] * there
                    for i in range(n_lin):
                        own += d_transition[p, k, i] * s[i]
                    dnew[k, states + p] += own
                for q in range(extra):
                    dnew[k, zero + q] += now[k] * drives[q, at] + later[k] * drives[q, next_at]
            ds, dnew = dnew, ds
            for k in range(n_lin):
                s[k] = new[k]
            if hidden:
                for j in range(columns):
                    change[j] = ds[0, j] - change[j]
                _advance(z, dz, s[0] - x_was - aside[0] * rise, change, step, zero - len(g[12]), by_v, g)
        for k in range(n_lin):
            ends[stretch, k] = s[k] - aside[k] * f + kick[k] * rise / 6.0
            for j in range(columns):
                dends[stretch, k, j] = ds[k, j] - aside[k] * df[j]
            for p in range(n_par):
                dends[stretch, k, states + p] -= d_aside[p, k] * f
        for k in range(hidden):
            ends[stretch, n_lin + k] = z[k]
            for j in range(columns):
                dends[stretch, n_lin + k, j] = dz[k, j]
