"""Every number that the decision rests on, in natural units of log evidence unless said otherwise."""

UNIT = 1.0
"""A gain that counts as one at all: what is smaller is not followed."""

SECOND = 10.0
"""By which a second effect gains on the first one in any shape; the same odds."""

HALVED = 0.5
"""Of the variance beyond noise that the first effect leaves in any shape, the share that a second one may leave: what
gains less is the first one's formula."""

CERTAIN = 20.0
"""By which an explanation beats the baseline before anything is said to be missing: odds of 100,000 to one (11.5), some
twenty members (3), some hundred places in the band where an extra mode could lie (5). Of 116 nulls drawn from
``benchmarks/bank`` (coloured noise, hum, jitter, steps of gain, heavy tails) one reached 18.6, all others less than
10: a rate below one in forty is not measured."""

STATED = 8.0
"""The same of a displaced place alone: the file states a deviation of it, and there is no band to look in. One in
200,000 of files whose deviations are true, one in 400 of those that state 0.7 of them."""

TIE = 5.0
"""Within which two explanations fit alike: odds of 150 to one."""

FORMULA = 0.02
"""Share of the baseline's misfit, in squares, that a named law may leave beside the best of any shape and still be that
law: a seventh in size. Set by judgement, like ``HALVED``; not yet calibrated."""

GRAIN = 1e-4
"""Share of the baseline's misfit, in squares, that a second effect takes at the least: a hundredth in size. What drives
between two samples, and how instruments see it, is known to some per mille only."""

MORE_OVER = 1.1
"""RMS of whitened residuals from which more than noise is left: 1,500 samples at rest tell its size to 5 % (300 drawn
sensors), twice that."""

OVER_NOISE = 1.6
"""Ratio of what is left to white noise from which it is asked whether it follows the motion."""

FOLLOWS = 4.0
"""Standard deviations of the rank correlation of what is left with the motion from which something is missing even if
nothing names it: one in thirty thousand under noise that knows nothing of the motion."""

UNEVEN = 10.0
"""Standard deviations in Gaussian noise by which the loudest window of what is left stands out of the mean one, from
which something happened that no noise is. Set by judgement; heavy tails not calibrated."""

LOOP = 0.5
"""Travel of Dahl's friction, in RMS deflections, from which it is a loop as well: a swing from one end to the other,
2.8 of these, no longer brings it within 1 % of what it slides at (5.3 travels); Dahl's law is Bouc's with n = 1."""

SEEN = 2.0
"""Standard deviations from which a share of the load is one, in the friction of gears: with less it is dry friction,
which is the same law without it."""
