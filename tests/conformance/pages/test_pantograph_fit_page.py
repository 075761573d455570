"""Report on a fitted pantograph: parameters with intervals, candidates, caveats."""

from helpers.page_blocks import find_blocks
from pantocheck.conformance.pages import document as doc
from pantocheck.conformance.pages.pantograph_pages import build_pantograph_fit_document
from pantocheck.conformance.results.pantograph_fit_format import PantographFit


def build_fit() -> PantographFit:
    """Two masses, of which the first stiffness is fixed and the second damper is not distinguished from zero."""
    parameters = [
        ("masses_kg", 1, 15.0, 0.06, "determined"), ("masses_kg", 2, 7.2, 0.014, "determined"),
        ("stiffness_N_m", 1, 50.0, 0.0, "fixed"), ("stiffness_N_m", 2, 15581.0, 243.0, "determined"),
        ("damping_N_s_m", 1, 90.0, 0.4, "determined"), ("damping_N_s_m", 2, 0.0, 6.5, "not_distinguished_from_zero"),
    ]  # fmt: skip
    keys = ("key", "number", "value", "half_width", "determination")
    candidate = {
        "masses": 2, "complex_deviation_pct": 1.2, "variance_ratio": 0.98, "information_criterion": -7.0,
        "free_parameters": 5, "starts": 10, "best_starts": 9,
    }  # fmt: skip
    suite = {"version": "1", "commit": None, "digest": "sha256:c"}
    comparison = {
        "suite": suite, "model": {"name": "Rig 12", "digest": "a"}, "verdict": "info", "criteria": [], "warnings": [],
        "responses": [],
    }  # fmt: skip
    content = {
        "suite": suite, "title": "Rig 12", "masses": 2,
        "band_Hz": [0.5, 50.0], "rows": 120, "is_noise_stated": True,
        "parameters": [dict(zip(keys, item, strict=True)) for item in parameters],
        "natural_frequencies_Hz": [0.2386, 4.66],
        "correlations": [{"first": "masses_kg.1", "second": "masses_kg.2", "correlation": -0.981}],
        "candidates": [
            candidate, candidate | {"masses": 3, "variance_ratio": None, "information_criterion": 9.0},
        ],
        "comparison": comparison, "warnings": ["a caveat"],
    }  # fmt: skip
    return PantographFit.model_validate(content)


def test_page_states_parameters_candidates_and_caveats() -> None:
    document = build_pantograph_fit_document(build_fit())
    assert isinstance(document.header, doc.PlainHeader)
    assert document.header.headline == "Rig 12: chain of 2 masses, RMS deviation 1.20 % from 0.500 to 50.0 Hz."
    assert document.blocks[0] == doc.WarningBox(("a caveat",))
    parameters, candidates = find_blocks(document.blocks, doc.Table)
    assert parameters.rows[0] == ("Mass 1 [kg]", "15", "0.06", "0.4", "determined")
    assert parameters.rows[2] == ("Stiffness 1 [N/m]", "50", "–", "–", "fixed")
    assert parameters.rows[3] == ("Stiffness 2 [N/m]", "15580", "240", "1.6", "determined")
    assert parameters.rows[5] == ("Damping 2 [N s/m]", "0", "6.5", "–", "not distinguished from zero")
    assert candidates.rows[0] == ("2 (chosen)", "5", "1.20", "0.980", "−7.000", "9 of 10")
    assert candidates.rows[1][3] == "–"
    section = document.blocks[2]
    assert isinstance(section, doc.Section)
    assert doc.SmallPrint("Correlated parameters: masses_kg.1 and masses_kg.2 (−0.981).") in section.blocks
