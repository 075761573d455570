"""Readers, quantities and systems of other distributions, registered by metadata in a folder on `sys.path`."""

import pickle
import sys
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from helpers.example_plug_in import install_example
from helpers.fake_distribution import write_distribution
from helpers.wave_system import Wave
from pantocheck.conformance import grade_cases, list_cases
from pantocheck.conformance.authenticity.outside_check import name_plug_ins
from pantocheck.conformance.cases.case import Case
from pantocheck.conformance.cases.library import select_cases
from pantocheck.conformance.cases.limits import Limit
from pantocheck.conformance.command_line.app import app
from pantocheck.conformance.grading.case_grading import grade_case
from pantocheck.conformance.input_files.input_error import InputError
from pantocheck.conformance.input_files.plug_in_reader import PlugInFormat
from pantocheck.conformance.input_files.table_formats import find_plug_in_reader, read_tables
from pantocheck.conformance.plug_ins.plug_in import GROUPS, find_plug_in
from pantocheck.conformance.quantities.plug_in_quantity import OWN
from pantocheck.conformance.quantities.registry import QUANTITIES, find_quantity
from pantocheck.conformance.records.record_writing import write_record
from pantocheck.conformance.results.outcome import Delivered, Errored
from pantocheck.conformance.results.results_format import Results
from pantocheck.conformance.runner import run_cases
from pantocheck.conformance.systems.plug_in_system import PlugInSystem
from pantocheck.conformance.systems.system_choice import choose_system

FAST = "own/acme-lines/fast"
BAND = "own_rms_5_10_N"
RAISES = "raise RuntimeError('loaded')\n"


@pytest.fixture
def example(site: Path) -> Path:
    """The example package of the documentation."""
    install_example(site)
    return site


def install(site: Path, name: str, kind: str, entry: str, code: str) -> None:
    """Install a distribution with one module, whose object `item` is the plug-in."""
    write_distribution(site, name, "2.0", {GROUPS[kind]: {entry: f"{name}:item"}}, {f"{name}.py": code})


def limited(case: Case, quantity: str) -> Case:
    return case.with_limits((Limit(quantity=quantity, pantograph=1, upper=1e3, trust="primary", source="own"),))


def test_no_plug_in_is_imported_before_it_is_used(site: Path) -> None:
    """Listing and grading without it load no code of a distribution."""
    for kind, entry in (("reader", "acq"), ("quantity", "own_x"), ("system", "sine")):
        install(site, f"lazy_{kind}", kind, entry, RAISES)
    done = CliRunner().invoke(app, ["doctor"])
    assert "reader 'acq' of lazy_reader 2.0" in done.output
    assert CliRunner().invoke(app, ["check", "--help"]).exit_code == 0
    list_cases()
    assert find_plug_in("system", "sine") is not None
    assert not {"lazy_reader", "lazy_quantity", "lazy_system"} & sys.modules.keys()


def test_names_of_the_suite_are_never_looked_up(site: Path, two_pantograph_case: Case, tmp_path: Path) -> None:
    """A plug-in with the suffix, quantity or word of the suite is not used, and `doctor` says so."""
    install(site, "shadow_reader", "reader", "csv", RAISES)
    install(site, "shadow_quantity", "quantity", "mean_force_N", RAISES)
    install(site, "shadow_system", "system", "builtin", RAISES)
    write_record(tmp_path / "run.csv", Wave().record(two_pantograph_case), two_pantograph_case.id)
    assert find_plug_in_reader(tmp_path / "run.csv") is None
    assert len(read_tables(tmp_path / "run.csv", (), 10**7)) == 1
    assert find_quantity("mean_force_N") is QUANTITIES["mean_force_N"]
    assert choose_system("builtin").kind == "builtin"
    output = " ".join(CliRunner().invoke(app, ["doctor"]).output.split())
    assert output.count("never used: the suite has this name") == 2
    assert "never used: its name does not begin with own_" in output


def test_no_quantity_of_the_suite_has_the_beginning_of_names_from_outside() -> None:
    assert not [name for name in QUANTITIES if name.startswith(OWN)]


@pytest.mark.parametrize("kind", ["reader", "quantity", "system"])
@pytest.mark.parametrize(
    ("code", "found"),
    [
        (RAISES, r"failed \(RuntimeError: loaded\)"),
        ("raise SystemExit(3)", r"failed \(SystemExit: 3\)"),
        ("import no_such_package", "ModuleNotFoundError"),
        ("item = 5", "is a int"),
        ("other = 5", "AttributeError"),
    ],
)
def test_a_bad_plug_in_is_one_message_that_names_the_distribution(
    site: Path, tmp_path: Path, kind: str, code: str, found: str
) -> None:
    name = f"bad_{kind}_{abs(hash(code)) % 10**6}"
    install(site, name, kind, "own_bad", code)
    (tmp_path / "file.own_bad").write_text("1")
    use = {
        "reader": lambda: read_tables(tmp_path / "file.own_bad", (), 10),
        "quantity": lambda: find_quantity("own_bad"),
        "system": lambda: choose_system("own_bad:text"),
    }[kind]
    with pytest.raises(InputError, match=f"{kind} 'own_bad' of {name} 2.0: .*{found}"):
        use()


def test_a_name_of_two_distributions_is_an_error(site: Path) -> None:
    for name in ("first", "second"):
        install(site, name, "system", "sine", RAISES)
    with pytest.raises(InputError, match=r"system 'sine': offered by first 2.0 and by second 2.0"):
        choose_system("sine:")


def test_a_command_reports_a_bad_plug_in_without_a_traceback(site: Path) -> None:
    install(site, "bad_command", "system", "sine", RAISES)
    done = CliRunner().invoke(app, ["run", "en50318-2002/250", "--system", "sine:1"])
    assert (done.exit_code, "Traceback" in done.stderr) == (2, False)
    assert "system 'sine' of bad_command 2.0: failed (RuntimeError: loaded)" in done.stderr


def test_a_system_of_a_plug_in_is_graded_like_a_foreign_one(example: Path) -> None:
    system = choose_system("acme-sine:28")
    assert isinstance(system, PlugInSystem)
    assert pickle.loads(pickle.dumps(system)) == system  # other processes receive it
    results = run_cases(select_cases([FAST]), system)
    (case,) = results.cases
    assert (results.system.kind, results.system.name) == ("plugin", "ACME sine")
    assert results.system.plug_in is not None
    assert (results.system.plug_in.distribution, results.system.plug_in.version) == ("acme-lines", "1.0")
    # A sine of amplitude 28 N: sigma = 28 / sqrt(2); the filter leaves 1.2 Hz unchanged.
    assert case.quantities["1"]["std_force_N"] == pytest.approx(28 / np.sqrt(2), rel=1e-3)
    assert case.verdict == "unverified"  # no height, no uplift: the checks of consistency cannot be made


def test_a_system_never_sees_limits(site: Path, case_250: Case) -> None:
    code = """
from pantocheck.conformance.extension import CaseSkipped, CaseSystem, SystemFactory
item = SystemFactory(lambda text: CaseSystem("spy", "1", lambda case: CaseSkipped(str(sorted(case)))))
"""
    install(site, "spy_system", "system", "spy", code)
    outcome = choose_system("spy:").run(case_250)
    assert "'line', 'pantographs'" in outcome.reason
    assert "limit" not in outcome.reason


@pytest.mark.parametrize(
    ("body", "reason"),
    [
        ("1 / 0", "ZeroDivisionError: division by zero"),
        ("sys.exit(1)", "SystemExit: 1"),
        ("None", "returned a NoneType in place of a DeliveredPassage"),
        ("DeliveredPassage([0, 1], [0, 1], ['a', 'b'])", "ValueError"),
        ("DeliveredPassage([0, 1], [0, 1], [0, float('nan')])", "force"),
        ("InputError('file', 'is damaged', 'hint')", "returned a InputError"),
    ],
)
def test_a_failure_inside_a_system_ends_its_case_only(site: Path, case_250: Case, body: str, reason: str) -> None:
    name = f"failing_{abs(hash(body)) % 10**6}"
    code = f"""
import sys
from pantocheck.conformance.extension import *
item = SystemFactory(lambda text: CaseSystem("failing", "1", lambda case: {body}))
"""
    install(site, name, "system", "failing", code)
    outcome = choose_system("failing:").run(case_250)
    assert isinstance(outcome, Errored)
    assert f"system 'failing' of {name} 2.0" in outcome.reason
    assert reason in outcome.reason


def test_a_quantity_has_a_value_an_uncertainty_and_a_place_in_the_results(example: Path, case_250: Case) -> None:
    """The band of a wave with a known sine at 7 Hz: its RMS is the amplitude over the root of two."""
    wave = Wave().record(case_250)
    force = wave.force + 3.0 * np.sin(2 * np.pi * 7.0 * wave.time)
    record = type(wave)(wave.time, wave.speed, wave.position, force, wave.evaluated)
    result = grade_case(limited(case_250, BAND), Delivered(record), "secondary")
    # The section of 1.73 s is not a whole number of periods: part of the sine leaks out of the band.
    assert result.quantities["1"][BAND] == pytest.approx(3 / np.sqrt(2), rel=0.02)
    assert result.uncertainty_components["1"][BAND]["section"] > 0
    criterion = next(criterion for criterion in result.criteria if criterion.quantity == BAND)
    assert (criterion.unit, criterion.verdict) == ("N", "pass")
    (used,) = result.plug_ins or ()
    assert (used.kind, used.name, used.distribution) == ("quantity", BAND, "acme-lines")
    assert "5, 10" in used.definition


def test_a_quantity_is_computed_only_where_a_limit_names_it(example: Path, case_250: Case) -> None:
    result = grade_case(case_250, Delivered(Wave().record(case_250)), "secondary")
    assert BAND not in result.quantities["1"]
    assert result.plug_ins is None
    assert "acme_lines.band_5_10" not in sys.modules


@pytest.mark.parametrize("value", ["1 / 0", "float('nan')", "[1.0, 2.0]", "'text'"])
def test_a_failing_quantity_is_skipped_and_the_others_keep_their_values(site: Path, case_250: Case, value: str) -> None:
    code = f"""
from pantocheck.conformance.extension import ForceQuantity
item = ForceQuantity("N", "failing", "force", lambda signals, sampling: {value})
"""
    name = f"failing_{abs(hash(value)) % 10**6}"
    install(site, name, "quantity", "own_failing", code)
    without = grade_case(case_250, Delivered(Wave().record(case_250)), "secondary")
    result = grade_case(limited(case_250, "own_failing"), Delivered(Wave().record(case_250)), "secondary")
    assert result.quantities == without.quantities
    assert f"quantity 'own_failing' of {name} 2.0" in result.skipped["1"]["own_failing"]
    assert result.criteria[-1].verdict == "skip"
    assert result.verdict != "pass"


def test_a_limit_of_a_quantity_that_is_not_installed_is_refused() -> None:
    with pytest.raises(ValueError, match="there is no quantity 'own_rms_5_10_N'"):
        Limit(quantity=BAND, pantograph=1, upper=1.0)


def write_acq(folder: Path, case: Case) -> None:
    """Record of the wave as an ACQ file with its sidecar."""
    write_record(folder / "run.csv", Wave().record(case), case.id, further={"case_digest": case.digest})
    head, *rows = (folder / "run.csv").read_text("utf-8").splitlines()
    (folder / "run.acq").write_text("\n".join(["ACQ " + head.replace(",", " "), *(r.replace(",", " ") for r in rows)]))
    text = (folder / "run.toml").read_text("utf-8").replace("run.csv", "run.acq")
    kept = [line for line in text.splitlines() if not line.startswith("sha256")]
    (folder / "run.toml").write_text("\n".join(kept), "utf-8")
    (folder / "run.csv").unlink()


def test_a_record_in_a_foreign_format_is_graded_and_names_its_reader(example: Path, tmp_path: Path) -> None:
    (case,) = select_cases(["en50318-2002/250"])
    write_acq(tmp_path / "records", case)
    graded = grade_cases("en50318-2002/250", system=f"record:{tmp_path / 'records'}")
    (result,) = graded.results.cases
    reference = grade_case(case, Delivered(Wave().record(case)), "secondary")
    assert result.quantities["1"]["std_force_N"] == pytest.approx(reference.quantities["1"]["std_force_N"], rel=1e-6)
    assert [(each.kind, each.name) for each in result.plug_ins or ()] == [("reader", "acq")]
    checked = CliRunner().invoke(app, ["check", str(tmp_path / "records" / "run.acq")])
    assert checked.exit_code == 0, checked.stderr
    assert "record:" in checked.output


def test_a_damaged_file_is_refused_with_the_name_of_the_reader(example: Path, tmp_path: Path) -> None:
    (tmp_path / "run.acq").write_text("other")
    with pytest.raises(InputError, match=r"reader 'acq' of acme-lines 1.0, record 'run.acq': does not begin with ACQ"):
        read_tables(tmp_path / "run.acq", (), 100)
    (tmp_path / "run.acq").write_text("ACQ a b\n1 2\n3\n")
    with pytest.raises(InputError, match=r"reader 'acq' of acme-lines 1.0: failed \(ValueError"):
        read_tables(tmp_path / "run.acq", (), 100)


@pytest.mark.parametrize(
    ("tables", "found"),
    [
        ("[]", "holds no run"),
        ("[5]", "returned a int in place of a MeasuredTable"),
        ("[MeasuredTable('x', np.zeros(3), ())]", "two axes"),
        ("[MeasuredTable('x', np.zeros((3, 2)), (TableColumn('a'),))]", "2 columns of values, 1 descriptions"),
        ("[MeasuredTable('x', np.zeros((99, 2)), (TableColumn('a'), TableColumn('b')))]", "at most 100"),
        ("[MeasuredTable('x', np.zeros((3, 1)), (TableColumn('a'),), rate=-1.0)]", "the sampling rate is -1.0"),
    ],
)
def test_a_reader_cannot_deliver_an_inconsistent_table(site: Path, tmp_path: Path, tables: str, found: str) -> None:
    name = f"reader_{abs(hash(tables)) % 10**6}"
    code = f"""
import numpy as np
from pantocheck.conformance.extension import MeasuredTable, TableColumn, TableReader
item = TableReader(lambda path: {tables})
"""
    install(site, name, "reader", "abc", code)
    (tmp_path / "run.abc").write_text("1")
    plug_in = find_plug_in_reader(tmp_path / "run.abc")
    assert plug_in is not None
    with pytest.raises(InputError, match=found):
        PlugInFormat(plug_in).read(tmp_path / "run.abc", (), 100)


def test_a_document_that_hides_a_plug_in_is_contradicted(example: Path) -> None:
    """Removing the names of plug-ins changes no verdict, and `verify` finds it."""
    results = run_cases(select_cases([FAST]), choose_system("acme-sine:"))
    (named,) = name_plug_ins(results)
    assert (named.outcome, len(named.details)) == ("open", 2)
    content = results.to_dict()
    del content["cases"][0]["plug_ins"], content["system"]["plug_in"]
    hidden = Results.model_validate(content)
    assert hidden.verdict == results.verdict != "pass"
    (check,) = name_plug_ins(hidden)
    assert (check.outcome, len(check.details)) == ("contradicted", 2)
