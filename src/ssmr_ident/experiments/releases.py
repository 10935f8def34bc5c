"""A free response from each release to the next: a log begins before the mass is let go, and holds several hits."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.recording import Recording
from ssmr_ident.session.entry import MOTIONS
from ssmr_ident.signals.grid import even_samples
from ssmr_ident.signals.releases import Release, find_releases

FEWEST = 64
"""Samples that a decay is made of at least."""


@dataclass(frozen=True)
class Part:
    """One decay of a log.

    Parameters
    ----------
    release_s : float [s]
        In the log's own time.
    recording : Recording
        From there on, to before the next.
    """

    release_s: float
    recording: Recording


def parts_of(recording: Recording, given: Sequence[float] = ()) -> tuple[Part, ...]:
    """Decays of a log, none where it begins within its only one.

    Parameters
    ----------
    recording : Recording
        In SI and this package's words.
    given : sequence of float [s]
        Releases that are known; nothing is sought then.

    Raises
    ------
    InputError
        A given release outside the log, or without samples behind it.
    """
    time = recording.time
    releases = [Release(at, at) for at in sorted(given)] or list(releases_in(recording))
    if not releases:
        return ()
    ends = [release.at_s for release in releases[1:]] + [np.inf]
    parts = []
    for release, end in zip(releases, ends, strict=True):
        inside = (time >= release.settled_s - 1e-9) & (time < end - 1e-9)
        if np.count_nonzero(inside) < FEWEST:
            if not given:
                continue
            raise InputError(
                f"{recording.provenance.file}: release_s",
                f"{release.at_s:g} s leaves {np.count_nonzero(inside)} samples of {time[0]:g} to {time[-1]:g} s",
                "Give the log's own time in seconds",
            )
        parts.append(Part(release.at_s, cut(recording, inside)))
    return tuple(parts)


def releases_in(recording: Recording) -> tuple[Release, ...]:
    """Releases and hits, by the channel that shows most of them."""
    found: tuple[Release, ...] = ()
    for name in (*MOTIONS, "acceleration_2"):
        if name in recording and np.isfinite(recording[name]).sum() > FEWEST:
            even = even_samples(recording.time, recording[name][:, None])
            seen = find_releases(even.time, even.samples[:, 0])
            found = seen if len(seen) > len(found) else found
    return found


def cut(recording: Recording, inside: np.ndarray) -> Recording:
    """Some samples of a recording."""
    channels = tuple(replace(channel, samples=channel.samples[inside]) for channel in recording.channels)
    return replace(recording, time=recording.time[inside], channels=channels)


def release_sentence(name: str, parts: Sequence[Part], given: bool) -> str:
    """What was found, in words."""
    times = ", ".join(f"{part.release_s:.4g}" for part in parts)
    how = "by release_s" if given else "found"
    if len(parts) == 1:
        return f"{name}: let go at {times} s ({how}); what was before is left out"
    return f"{name}: {len(parts)} releases or hits at {times} s ({how}), each a decay with a start of its own"
