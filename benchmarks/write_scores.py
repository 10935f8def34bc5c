"""Write docs/theory/diagnosis_scores.md from the result files of the benchmarks.

make bench-doctor
python benchmarks/bench_power.py --family forced --sessions 8 --out benchmarks/results/power.jsonl
python benchmarks/bench_peers.py --out out/peers.jsonl
(python benchmarks/bench_cost.py --whole; python benchmarks/bench_cost.py) > out/cost.txt
python benchmarks/write_scores.py --results benchmarks/results
"""

from __future__ import annotations

import argparse
import contextlib
import io
from collections.abc import Callable, Sequence
from pathlib import Path

import bench_peers
import bench_power
import bench_scale
from bench_doctor import RESULTS
from doctor.tables import answers, table
from doctor.unseen import with_unseen
from scoring import Row, read

PAGE = Path(__file__).resolve().parents[1] / "docs" / "theory" / "diagnosis_scores.md"

HEAD = """# What the diagnosis is worth

Written by `python benchmarks/write_scores.py` from the results of the benchmarks named below; nothing here is typed by
hand but the words. An engine's commit stands with each table; a + means that files were changed beside it. Rows of
counts that take hours, and go on where they stopped, are in `benchmarks/results/`.

## How it is judged
**Sessions.** `benchmarks/bank` draws random sessions with known answers, each from its seed: nine decays of a robot and
four held out; pulls; bench tests of one wheel; a dragged block; rigs driven by a measured force, or let go. Masses,
stiffnesses, dampings, inertias, geometry, the place, gains and bandwidth of the accelerometers are drawn so that the
parameter file is honest: the truth lies about what the file says with the standard deviations that the file states.
Noise is white with an autoregressive part of up to 60 % of its variance, a mains line of 60 and 180 Hz, a zero that
wanders (accelerometers by 2 mg, load cells by 0.05 N within a recording at most), and 12 to 16 bits.

**What is left out.** Nothing; one effect of the catalogue, in a size that is drawn evenly between the limit of what
the session can show and plain sight; two of them; an effect in a formula that the catalogue does not have (hardening
as two slopes or a sinh, softening as a tanh; friction as a tanh, as a spring in series with a slider, or larger near
rest; play with sharp or softplus corners; Bouc-Wen with another exponent, or three sliders in parallel; damping with
|v|^1.8; relaxation with two branches); something that is in no list (a damper that resists one way more than the
other, a spring that touches on one side, a stiffness that changes over each recording, dry friction on one side).
Other formulas come from plants of the bank's own, integrated by another method; where both can (the catalogue's
formulas), they agree with the simulator to 0.03 % (`tests/unit/test_session_bank.py`). Not drawn so far: pulls in
other formulas (the robot's pull has one plant only), rolling resistance in pulls (along the robot the fixture of a
spinning pull holds what it would do), and nulls of the baseline `decoupled`, which no such robot has.

**Outcomes.** *right*: verdict and every name, or nothing where nothing is missing; *tie*: every true name is named or
in the reported tie of a name, three at most; *unseen*: missed where the baseline explains even recordings it never
saw to within 2 % of what the true signals leave, or missed, or named in part, where the truth itself, refitted from the
true values, has no more log evidence over the truth without what was not named than the 6.9 that an effect needs, so
that nobody could gain by knowing (`doctor/visible.py`). Wheels that lift slide axis by axis in the bank and
along both axes together in fits of decays, so for them this is judged under a law that they were not made with;
*part*: some of the right names; *wrong*: a name that does not belong, beside right ones too; *failed*: a crash, or no
answer within 300 s of processor; the rest speaks for itself. The noise floor is that of the true
signals, not the one that the diagnosis states.
"""


def versions(rows: Sequence[Row]) -> str:
    """Which engines the rows are from, and how many processors each session had."""
    found = sorted({row["engine"] for row in rows if "engine" in row})
    shared = sorted({str(row["processors"]) for row in rows if "processors" in row})
    had = f", processors for a session: {' or '.join(shared)}" if shared else ""
    return f"Engine {', '.join(found)}{had}.\n\n" if found else ""


def block(text: str) -> str:
    return f"```\n{text.strip()}\n```\n"


def printed(run: Callable[[], None]) -> str:
    stream = io.StringIO()
    with contextlib.redirect_stdout(stream):
        run()
    return stream.getvalue()


def page(folder: Path) -> str:
    """The whole page; a benchmark without results keeps what the page said of it, or is said to be missing."""
    parts, before = [HEAD], _sections()

    def section(title: str, file: str, words: str, text: Callable[[list[Row]], str], dated: bool = True) -> None:
        rows = read(folder / file)
        if rows or title not in before:
            body = (versions(rows) if dated else "") + text(rows) if rows else "Not measured yet.\n"
            parts.append(f"## {title}\n{words}\n{body}")
        else:
            parts.append(before[title])

    parts.append(f"## The frozen set\n{FROZEN}\n{_frozen()}")
    section(
        "Robots of other sizes",
        "scale.jsonl",
        "`bench_scale.py`: the same sessions of decays asked of the robot as it is drawn, of one of 2 kg and 0.4 times "
        "the length, and of one of 470 kg and 2.5 times the length, which read the same over the square root of that "
        "time; noise and mains are the sensor's, so what is near the noise may differ.\n",
        lambda rows: block(bench_scale.summary(rows)),
    )
    section(
        "How large an effect must be",
        "power.jsonl",
        "`bench_power.py`: the size from which 95 % are named right or in a tie, by a logistic fit over the sessions; "
        "and the held-out error of the refitted baseline over the noise floor there. A block that is dragged at one "
        "speed shows one constant force, whose level the cell's zero takes: of a clip, a cable that gives little or "
        "friction that falls only the jolt is left, which no two pulls have alike and which counts for nothing. The "
        "same sessions are asked of every engine, in place of what the one before answered, and some have led to "
        "changes.\n",
        lambda rows: block(bench_power.report(rows)),
    )
    section(
        "Peers",
        "peers.jsonl",
        PEERS,
        lambda rows: block(printed(lambda: bench_peers.report(rows))),
    )
    cost = folder / "cost.txt"
    if cost.is_file() or "Cost" not in before:
        text = block(cost.read_text(encoding="utf-8")) if cost.is_file() else "Not measured yet.\n"
        parts.append(f"## Cost\n{COST}\n{text}")
    else:
        parts.append(before["Cost"])
    return "\n".join(parts)


def _sections() -> dict[str, str]:
    """The page as it stands, by title."""
    if not PAGE.is_file():
        return {}
    found = PAGE.read_text(encoding="utf-8").split("\n## ")[1:]
    return {text.split("\n", 1)[0]: f"## {text.rstrip()}\n" for text in found}


FROZEN = """`make bench-doctor`: drawn sessions of seeds that no tuning has seen, and the sessions and recordings that
lie beside the checkout ([why](../decisions/0026-a-frozen-set-for-every-engine.md)). Of practice sessions what is held
out is the further recordings that the diagnosis never sees, of the others what it keeps back. A later engine is laid
beside this one by `bench_doctor.py --between`; a run that was stopped goes on where it was, so a table may hold a part
of the set only. Seconds of processor are larger where the machine is shared.
"""


def _frozen() -> str:
    """A table for every engine that has been asked."""
    parts = []
    for file in sorted(RESULTS.glob("*-*.jsonl")):
        rows = with_unseen(read(file))
        took = sum(row["seconds"] for row in rows)
        parts.append(f"Engine {file.stem}, {len(rows)} sessions, {took:.0f} s of processor.\n")
        parts.append(f"{table(rows)}\n\n{block(answers(rows))}")
    return "\n".join(parts) or "Not measured yet.\n"


COST = """`bench_cost.py`: seconds over the number of recordings, and of sessions for which a time is promised
(`--whole`).
"""


PEERS = """`bench_peers.py`, on driven rigs: those of the practice sessions and random ones with plain sizes (0.7),
noise as above. *Least squares* is an output-error grey box of mass, damper and spring with the textbook's tests of its
residual (whiteness, independence of the input, 1 %). *PySINDy* regresses what mass, damper and spring leave of the
force on a library of fourteen terms with its default optimiser (STLSQ, threshold 0.1 of the residual's spread);
motions that were not measured are integrated or differentiated within 4 to 35 Hz. *mujoco.sysid* fits the same rig as
a sliding joint and its claims are the warnings of its own report. The first cannot name anything, and coloured noise
or mains make its residual coloured as well; the last warns only of parameters at their bounds. *diagnosis* is
`ident diagnose` on the same sessions.
"""


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--results", type=Path, default=Path("out"), help="folder with the result files")
    arguments = parser.parse_args()
    PAGE.write_text(page(arguments.results), encoding="utf-8")
    print(f"written: {PAGE}")


if __name__ == "__main__":
    main()
