"""proof.html: what was hidden, what was found, and how well it predicts."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from ssmr_ident.report.html import Fact, Page, Picture, Section, Table, Verdict, picture, write_page
from ssmr_proof.page.figures import concealment_figure, confusion_figure, heldout_figure, power_figure
from ssmr_proof.page.gallery import chosen, overlay
from ssmr_proof.run import Proof
from ssmr_proof.scores.intervals import between, share_interval
from ssmr_proof.scores.power import power
from ssmr_proof.scores.score import MEANING
from ssmr_proof.scores.summary import Share
from ssmr_proof.scores.table import Row


def write_proof_page(proof: Proof, command: str, further: tuple[Section, ...] = ()) -> Path:
    """Write ``proof.html``.

    Parameters
    ----------
    proof : Proof
    command : str
        The call that made it.
    further : tuple of Section
        Such as other programs on the same cases.
    """
    sections = (
        _marks(proof),
        *further,
        _heldout(proof),
        _concealed(proof),
        _power(proof),
        _gallery(proof),
        _all(proof),
        _seals(proof),
    )
    page = Page(
        "Physics concealed, found blind, unsealed",
        _lead(proof),
        sections,
        command,
        verdict=_verdict(proof),
        seed=proof.seed,
    )
    return write_page(proof.folder / "proof.html", page)


def _verdict(proof: Proof) -> Verdict:
    summary = proof.summary
    middle, low, high = summary.after_over_floor
    facts = (
        Fact("hidden effects named", f"{summary.named.hits} of {summary.named.total}", _range(summary.named)),
        Fact(
            "false alarms", f"{summary.false_alarms.hits} of {summary.false_alarms.total}", _range(summary.false_alarms)
        ),
        Fact("held-out error reduced", f"{summary.reduced.hits} of {summary.reduced.total}", _range(summary.reduced)),
        Fact(
            "error after, over the noise", "–" if math.isnan(middle) else f"{middle:.2f}", f"median{between(low, high)}"
        ),
    )
    sentence = (
        f"{summary.named.hits} of {summary.named.total} hidden effects were named, right or within a tie of three, "
        f"and {summary.false_alarms.hits} of {summary.false_alarms.total} sessions in which nothing was missing gave a "
        "false alarm."
    )
    return Verdict(f"{len(proof.rows)} sealed cases, opened", "found", sentence, facts)


def _range(share: Share) -> str:
    if not share.total:
        return ""
    low, high = share_interval(share.hits, share.total)
    return f"{share.value:.0%}, 95 % interval {low:.0%} … {high:.0%}"


def _lead(proof: Proof) -> tuple[str, ...]:
    return (
        "The recordings come from a robot and a rig in MuJoCo, an engine that shares no law with the simulator under "
        "test. Physics that the baseline model lacks was hidden in most of them, at sizes from the limit of what can "
        "be seen upwards. The truth and the held-out recordings were sealed by SHA-256 before the first diagnosis "
        "began; every diagnosis ran as a process of its own on a copy of the session folder alone.",
    )


def _marks(proof: Proof) -> Section:
    outcomes = proof.summary.outcomes
    rows = tuple((name, str(outcomes[name]), MEANING[name]) for name in MEANING if outcomes[name])
    caption = "Hidden physics down, what was named across. A tie that holds the hidden id counts under it."
    return Section(
        "Hidden and named",
        tables=(Table("How the answers fare.", ("outcome", "cases", "meaning"), rows),),
        figures=(picture(confusion_figure(proof.rows), caption, "confusion matrix"),),
    )


def _heldout(proof: Proof) -> Section:
    caption = (
        "Error on recordings that no diagnosis ever had, over what noise alone leaves there: of the baseline at its "
        "best (open) and with the physics that the diagnosis named (full; green where it was named rightly)."
    )
    text = (
        "These recordings were under seal with the truth. Only the starting state of a decay, the slack of a pull and "
        "the zero of a sensor are fitted to them, the same for both models."
    )
    return Section("Held out", (text,), figures=(picture(heldout_figure(proof.rows), caption, "held out"),))


def _concealed(proof: Proof) -> Section:
    missing = [row for row in proof.rows if row.missing and row.heldout.before]
    ratios = [row.heldout.means[0] / row.heldout.means[2] for row in missing]
    moved = [abs(row.heldout.shifts[0].sigmas) for row in missing if row.heldout.shifts]
    text = (
        "A refitted baseline hides missing physics in its own parameters: its fit looks better than it deserves, and "
        "its parameters move. "
        + (
            f"Its held-out error was {np.median(ratios):.1f} times the noise floor in the median case (from "
            f"{min(ratios):.2f} to {max(ratios):.0f}), and its most shifted parameter lay {np.median(moved):.1f} "
            "standard deviations from what was known of it."
            if missing
            else "No case here has hidden physics."
        )
    )
    rows = tuple(_shift_row(row) for row in sorted(missing, key=lambda row: row.heldout.excess)[:20])
    header = ("case", "hidden", "error over noise", "parameter moved most", "standard deviations", "off the truth")
    caption = "How well each case was concealed, the best concealed first (twenty at most)."
    figure = picture(
        concealment_figure(proof.rows), "Each dot is a case: error and shift of the refitted baseline.", "concealment"
    )
    return Section("How well it was concealed", (text,), (Table(caption, header, rows),), (figure,))


def _shift_row(row: Row) -> tuple[str, ...]:
    before, _, floor = row.heldout.means
    shift = row.heldout.shifts[0]
    off = "" if shift.off is None else f"{shift.off:+.0%}"
    hidden = "+".join(row.mark.hidden)
    return row.case, hidden, f"{before / floor:.2f}", shift.parameter, f"{shift.sigmas:+.1f}", off


def _power(proof: Proof) -> Section:
    found = power(proof.rows)
    rows = tuple((label, str(cases), str(seen), str(named)) for label, cases, seen, named in found.rows() if cases)
    half = "" if np.isnan(found.half) else f" Half of the cases are named from {found.half:.2g} on."
    text = (
        "What the refitted baseline leaves beyond the noise, over the noise: √(before² − floor²)/floor on the held-out "
        "recordings. Below about 0.2 a misfit is lost in the noise of one recording." + half
    )
    caption = "Cases with hidden physics by what the baseline leaves."
    table = Table(caption, ("left over the noise", "cases", "said to be missing", "named"), rows)
    return Section(
        "Near the limit", (text,), (table,), (picture(power_figure(found), "Share of cases named.", "power"),)
    )


def _gallery(proof: Proof) -> Section:
    pictures: list[Picture] = []
    paragraphs = [
        "Four that were named, the best concealed first, one where nothing was missing, and one that went wrong."
    ]
    for row in chosen(proof.rows):
        pictures.append(overlay(row, proof.folder / "opened"))
        sentence = row.answer.claims[0].sentence if row.answer.claims else row.answer.summary
        where = f" Where: {row.answer.located}" if row.answer.located else ""
        paragraphs.append(f"{row.case} ({row.mark.outcome}): {sentence}{where}")
    return Section("Six cases", tuple(paragraphs), figures=tuple(pictures))


def _all(proof: Proof) -> Section:
    header = ("case", "hidden", "outcome", "named", "before", "after", "noise", "before − after (95 %)", "parameters")
    rows = []
    for row in proof.rows:
        cells = row.as_dict()
        interval = f"{cells['improvement_low']} … {cells['improvement_high']}" if cells["improvement_low"] else ""
        rows.append(
            (
                row.case, cells["hidden"] or "nothing", cells["outcome"], cells["named"] or "nothing",
                cells["before_percent"], cells["after_percent"], cells["noise_floor_percent"], interval,
                cells["parameter_errors"] or cells["problem"],
            )
        )  # fmt: skip
    return Section(
        "Every case", tables=(Table("Held-out errors in percent; the same as proof.csv.", header, tuple(rows)),)
    )


def _seals(proof: Proof) -> Section:
    text = (
        "SHA-256 over a nonce of 32 random bytes, the truth and the held-out files of each case, as they were written "
        "to seals.csv before the first diagnosis began. The folder opened/ holds what they were taken over: "
        f"ident proof --unseal {proof.folder.name} takes them again."
    )
    return Section("Seals", (text,), listings=(proof.seals.read_text(encoding="utf-8").strip(),))
