"""Every number that the decision rests on, in natural units of log evidence unless said otherwise."""

UNIT = 1.0
"""A gain that counts as one at all: what is smaller is not followed."""

SECOND = 10.0
"""By which a second effect gains on the first one in any shape; the same odds."""

HALVED = 0.5
"""Of the variance beyond noise that the first effect leaves in any shape, the share that a second one may leave: what
gains less is the first one's formula."""

CERTAIN = 10.0
"""By which an explanation beats the baseline before anything is said to be missing: odds of 22,000 to one. With some
twenty looks a session that is one false alarm in a thousand if noise is as it is taken to be; not yet calibrated on
drawn nulls."""

TIE = 5.0
"""Within which two explanations fit alike: odds of 150 to one."""

FORMULA = 0.02
"""Share of the baseline's misfit, in squares, that a named law may leave beside the best of any shape and still be that
law: a seventh in size. Set by judgement, like ``HALVED``; not yet calibrated."""

OVER_NOISE = 1.6
"""Ratio of what is left to white noise from which it is asked whether it follows the motion."""

FOLLOWS = 4.0
"""Standard deviations of the rank correlation of what is left with the motion from which something is missing even if
nothing names it: one in thirty thousand under noise that knows nothing of the motion."""

UNEVEN = 10.0
"""Standard deviations in Gaussian noise by which the loudest window of what is left stands out of the mean one, from
which something happened that no noise is. Set by judgement; heavy tails not calibrated."""
