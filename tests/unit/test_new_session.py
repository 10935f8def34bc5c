"""``ident new``: guesses by content, questions for the rest, files that ``ident fit`` takes, nothing overwritten."""

from __future__ import annotations

import hashlib
from pathlib import Path

import numpy as np
import pytest

from ssmr_ident.core.errors import InputError
from ssmr_ident.core.recording import Channel, Provenance, Recording
from ssmr_ident.experiments import FORCED, FREE_RESPONSE, Conditions
from ssmr_ident.readers import read_one, writers
from ssmr_ident.session import read_session
from ssmr_ident.session.parameters_file import read_parameters
from ssmr_ident.workflows.fit.run import fit_session
from ssmr_ident.workflows.new.log import DIES_AWAY, guess_log
from ssmr_ident.workflows.new.run import Told, draft_session
from ssmr_ident.workflows.simulate.request import Request
from ssmr_ident.workflows.simulate.run import simulate_to_file


def _recording(rate: float, **channels: tuple[np.ndarray, str]) -> Recording:
    made = tuple(Channel(name, samples, unit, name) for name, (samples, unit) in channels.items())
    return Recording(np.arange(len(made[0].samples)) / rate, made, Provenance("log.csv", "", "csv"))


def _decay(rate: float, seconds: float, fall: float, hertz: float = 5.0) -> np.ndarray:
    """A free response that falls to ``fall`` of its start over the record."""
    time = np.arange(round(rate * seconds)) / rate
    return np.exp(np.log(fall) * time / seconds) * np.sin(2 * np.pi * hertz * time)


@pytest.mark.parametrize(("fall", "dies"), [(0.01, True), (0.05, True), (0.5, False), (1.0, False)])
def test_a_free_response_falls_below_a_tenth(fall: float, dies: bool) -> None:
    course = _decay(1000.0, 4.0, fall)
    guess = guess_log("log.csv", _recording(1000.0, ax=(0.1 * course, "m/s^2"), ay=(course, "m/s^2")))
    assert (guess.fields["experiment"] == "free_response") == dies
    assert ("yaw_rate_deg_s" in guess.fields) != dies
    if dies:  # roll and yaw both show in ay
        assert guess.fields["motion"] == "TODO"
        assert "roll or yaw" in guess.reasons["motion"]


def test_the_bound_is_the_closed_form() -> None:
    """Share of an exponential that holds 90 % of its energy when it falls to a tenth."""
    assert np.log(1 / (1 - 0.9 * 0.99)) / (2 * np.log(10)) == pytest.approx(DIES_AWAY, abs=0.02)


def test_a_pitch_is_told_by_its_axis_and_a_name_fills_in_the_rest() -> None:
    course = _decay(1000.0, 4.0, 0.01)
    recording = _recording(1000.0, ax=(course, "m/s^2"), ay=(0.1 * course, "m/s^2"), az=(course, "m/s^2"))
    assert guess_log("log.csv", recording).fields["motion"] == "pitch"
    named = guess_log("roll-carpet-3.csv", recording)
    assert (named.fields["motion"], named.fields["floor"], named.fields["trial"]) == ("roll", "carpet", 3)
    assert "largest in" in named.reasons["motion"]


def test_gyroscopes_tell_the_motion_and_the_yaw_rate() -> None:
    course = _decay(500.0, 4.0, 0.01)
    quiet = 0.01 * course
    rates = {"wx": (quiet, "rad/s"), "wy": (quiet, "rad/s"), "wz": (course, "rad/s")}
    guess = guess_log("a.csv", _recording(500.0, ay=(course, "m/s^2"), **rates))
    assert guess.fields["motion"] == "yaw"
    random = np.random.default_rng(1)
    turning = _recording(
        500.0, ay=(random.normal(size=4000), "m/s^2"), wz=(0.5 + 0.1 * random.normal(size=4000), "rad/s")
    )
    guess = guess_log("a.csv", turning)
    assert guess.fields["experiment"] == "swivel"
    assert guess.fields["yaw_rate_deg_s"] == pytest.approx(np.rad2deg(0.5), abs=0.5)


def test_machine_logs_by_their_position_and_force() -> None:
    time = np.arange(1600) / 100
    head = 2e-3 * time
    pull = _recording(100.0, position=(head, "m"), force=(np.minimum(18e3 * head, 200.0), "N"))
    guess = guess_log("one.csv", pull)
    assert guess.fields["experiment"] == "pull"
    assert guess.fields["speed_mm_s"] == pytest.approx(2.0)
    assert {key for key, value in guess.fields.items() if value == "TODO"} == {"direction", "height_m"}
    press = _recording(100.0, position=(head, "m"), force=(8e4 * head**1.1, "N"))
    assert guess_log("two.csv", press).fields["experiment"] == "vertical_compression"
    assert guess_log("wheel-drag-1.csv", pull).fields["experiment"] == "wheel_drag"


def test_a_header_without_a_quantity_is_taken_by_its_unit() -> None:
    random = np.random.default_rng(2)
    recording = _recording(1000.0, shaker=(random.normal(size=2000), "N"), enc=(random.normal(size=2000), "m"))
    guess = guess_log("a.csv", recording)
    assert guess.fields["experiment"] == "forced"
    assert guess.fields["channels"] == {"force": "shaker", "position": "enc"}


def test_of_two_columns_of_one_unit_the_first_is_taken_and_said(tmp_path: Path) -> None:
    random = np.random.default_rng(4)
    columns = {name: (random.normal(size=2000), unit) for name, unit in (("push", "N"), ("enc", "m"), ("lvdt", "m"))}
    writers.write_csv(tmp_path / "a.csv", _recording(500.0, **columns))
    draft = draft_session(tmp_path, Told(mass=3.0))
    assert draft.guesses[0].fields["experiment"] == "forced"
    assert draft.guesses[0].fields["channels"] == {"force": "push", "position": "enc"}
    assert "which of enc, lvdt is the position?" in draft.session_text
    assert not draft.questions


def test_letters_without_units_are_guessed_and_said(tmp_path: Path) -> None:
    random = np.random.default_rng(4)
    rows = "".join(f"{k / 500},{a:.4f},{b:.4f}\n" for k, (a, b) in enumerate(random.normal(size=(500, 2))))
    (tmp_path / "a.csv").write_text("t,F,x\n" + rows)
    draft = draft_session(tmp_path, Told(mass=3.0))
    assert draft.guesses[0].fields["channels"] == {"force": "F", "position": "x"}
    assert "the file has no units" in draft.session_text


@pytest.fixture(scope="module")
def robot_logs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("my logs")
    for index, motion in enumerate(("roll", "pitch", "yaw")):
        request = Request(FREE_RESPONSE, Conditions(motion=motion), noise=True, seed=40 + index)
        simulate_to_file("p3at-extended", request, folder / f"{motion}-1.lvm")
    (folder / "notes.md").write_text("not a log")
    (folder / "broken.csv").write_text("time,force\n0,1\n0.1,zero\n0.2,3\n")
    return folder


@pytest.mark.slow
def test_a_robot_s_folder_becomes_a_session_that_fit_takes(robot_logs: Path) -> None:
    before = {path.name: hashlib.sha256(path.read_bytes()).digest() for path in robot_logs.iterdir()}
    draft = draft_session(robot_logs, Told(robot="p3at-extended"))
    assert not draft.questions
    assert [name for name, _ in draft.aside] == ["broken.csv"]
    assert "broken.csv: " in draft.session_text
    draft.write()
    after = {path.name: hashlib.sha256(path.read_bytes()).digest() for path in robot_logs.iterdir()}
    assert set(after) - set(before) == {"session.yaml", "robot.yaml"}
    assert all(after[name] == digest for name, digest in before.items())
    session = read_session(robot_logs)
    assert [(e.file, e.motion, e.trial) for e in session.entries] == [
        ("pitch-1.lvm", "pitch", 1),
        ("roll-1.lvm", "roll", 1),
        ("yaw-1.lvm", "yaw", 1),
    ]
    fit = fit_session(robot_logs, method="modal")
    assert fit.parameters["tire.stiffness_y_N_m"].std is not None
    with pytest.raises(InputError, match="is not overwritten"):
        draft.write()


def test_an_open_question_is_named_with_its_line(robot_logs: Path, tmp_path: Path) -> None:
    (tmp_path / "roll-1.lvm").write_bytes((robot_logs / "roll-1.lvm").read_bytes())
    draft = draft_session(tmp_path)
    draft.write()
    asked = {question.text.split(":")[0] for question in draft.questions}
    assert {"mass_kg", "contact_points_m", "position_m", "volts_zero", "volts_per_m_s2"} <= asked
    first = draft.questions[0]
    with pytest.raises(InputError, match=rf"robot.yaml:{first.line}: still says TODO: mass_kg"):
        fit_session(tmp_path)


@pytest.mark.slow
def test_a_rig_gets_its_first_values_from_the_logs(tmp_path: Path) -> None:
    """8 kg, 20 kN/m, 50 N s/m, pushed by noise: found within a few percent, without a word from the user."""
    (tmp_path / "rig.yaml").write_text(
        "schema: ssmr-ident/parameters/1\nmass_kg: {value: 8.0, unit: kg}\nstiffness_N_m: {value: 20000, unit: N/m}\n"
        "damping_N_s_m: {value: 50, unit: N s/m}\n"
    )
    random = np.random.default_rng(5)
    logs = tmp_path / "logs"
    logs.mkdir()
    writers.write_csv(tmp_path / "force.csv", _recording(1000.0, force=(50 * random.normal(size=8000), "N")))
    simulate_to_file(str(tmp_path / "rig.yaml"), Request(FORCED, force=str(tmp_path / "force.csv")), logs / "run.csv")
    for kept in ("position", "velocity", "acceleration"):
        recording = read_one(logs / "run.csv")
        only = tuple(c for c in recording.channels if c.name in ("force", kept))
        folder = tmp_path / kept
        folder.mkdir()
        writers.write_csv(folder / "run.csv", recording.with_channels(only))
        draft = draft_session(folder)
        assert draft.baseline == "sdof"
        assert not draft.questions
        draft.write()
        known = read_parameters(folder / "rig.yaml")
        assert known.number("mass_kg") == pytest.approx(8.0, rel=0.1)
        assert known.number("stiffness_N_m") == pytest.approx(20000, rel=0.1)
    assert fit_session(folder).parameters.number("stiffness_N_m") == pytest.approx(20000, rel=0.02)


def test_a_free_rig_without_a_mass_is_one_of_a_kilogram_and_says_so(tmp_path: Path) -> None:
    course = 1e-3 * _decay(1000.0, 4.0, 0.01, hertz=7.0)
    writers.write_csv(tmp_path / "ring.csv", _recording(1000.0, position=(course, "m")))
    bare = draft_session(tmp_path)
    assert not bare.questions
    assert [(guess.key, guess.value) for guess in bare.suggestions] == [("mass_kg", 1.0)]
    assert "nobody said" in bare.parameters_text
    draft = draft_session(tmp_path, Told(mass=2.0))
    assert not draft.questions
    assert not draft.suggestions
    draft.write()
    known = read_parameters(tmp_path / "rig.yaml")
    assert known.number("stiffness_N_m") == pytest.approx(2.0 * (2 * np.pi * 7.0) ** 2, rel=0.02)


def test_answers_go_to_every_recording_that_asks(tmp_path: Path) -> None:
    head = 1e-3 * np.arange(800) / 100
    log = _recording(100.0, position=(head, "m"), force=(np.minimum(18e3 * head, 60.0), "N"))
    for trial in (1, 2):
        writers.write_csv(tmp_path / f"pull-lateral-{trial}.csv", log)
    draft = draft_session(tmp_path, Told(robot="p3at-platform", answers={"height_m": "0.05"}))
    assert not draft.questions
    assert draft.session_text.count("height_m: 0.05") == 2
    with pytest.raises(InputError, match="Did you mean 'height_m'"):
        draft_session(tmp_path, Told(answers={"heigt_m": "0.05"}))


@pytest.mark.parametrize(
    ("call", "told"),
    [({"robot": "p3at-extendd"}, "Did you mean"), ({"baseline": "sdoff"}, "sdof"), ({"mass": -1.0}, "more than 0")],
)
def test_a_wrong_call_is_refused(robot_logs: Path, call: dict, told: str) -> None:
    with pytest.raises(InputError, match=told):
        draft_session(robot_logs, Told(**call))


def test_a_folder_without_logs_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="without logs"):
        draft_session(tmp_path)
    (tmp_path / "runs").mkdir()
    (tmp_path / "runs" / "a.csv").write_text("time,force\n0,1\n")
    with pytest.raises(InputError, match=r"Name a folder in it: .*runs"):
        draft_session(tmp_path)
    with pytest.raises(InputError, match="is no folder"):
        draft_session(tmp_path / "nowhere")


@pytest.mark.slow
@pytest.mark.shared
def test_practice_sessions_are_guessed_as_their_makers_wrote_them(shared: Path, tmp_path: Path) -> None:
    """What the samples and names can tell is told as in the makers' session.yaml, in every practice session."""
    keys = ("experiment", "motion", "direction", "yaw_rate_deg_s", "speed_mm_s", "role")
    for practice in sorted((shared / "practice").glob("practice-*")):
        source = practice / "session"
        folder = tmp_path / practice.name
        folder.mkdir()
        for log in source.iterdir():
            if log.suffix != ".yaml":
                (folder / log.name).write_bytes(log.read_bytes())
        draft = draft_session(folder)
        truth = {entry.file: entry for entry in read_session(source).entries}
        assert {guess.file for guess in draft.guesses} == set(truth)
        for guess in draft.guesses:
            for key in keys:
                wanted = getattr(truth[guess.file], key)
                if key in guess.fields and wanted is not None:
                    found = guess.fields[key]
                    same = found == wanted if isinstance(wanted, str) else found == pytest.approx(wanted, rel=0.02)
                    assert same, (practice.name, guess.file, key, found, wanted)
