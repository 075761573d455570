"""TOML files: pathological content is refused at once, with the reason and the line."""

import time
from pathlib import Path

import pytest

from pantocheck.conformance.core.input_error import InputError
from pantocheck.conformance.core.toml_file import MAX_TOML_BYTES, MOST_PARTS, read_toml


def dotted(parts: int, separator: str = ".") -> str:
    return separator.join(["a"] * parts)


@pytest.mark.parametrize(
    "line",
    [
        f"{dotted(20_000)} = 1", f"{dotted(500_000)} = 1", f"{dotted(20_000, ' . ')} = 1", f"[{dotted(20_000)}]",
        f"[[{dotted(20_000)}]]", f"b = {{ {dotted(20_000)} = 1 }}", ".".join(['"a b"'] * 20_000) + " = 1",
        ".".join(["'a'"] * 20_000) + " = 1", f"{dotted(MOST_PARTS + 1)} = 1",
    ],
)  # fmt: skip
def test_key_of_many_parts_is_refused_quickly(line: str, tmp_path: Path) -> None:
    """The parser took 20 s and 2 GB for 20 000 parts."""
    (tmp_path / "a.toml").write_text(f"x = 1\n{line}\n")
    start = time.process_time()
    with pytest.raises(
        InputError, match=rf"case 'a\.toml', line 2: has a key with .*\n  .* at most {MOST_PARTS} parts"
    ):
        read_toml(tmp_path / "a.toml", "case")
    assert time.process_time() - start < 1.0


def test_usual_keys_numbers_and_texts_are_read_up_to_a_limit(tmp_path: Path) -> None:
    """Dots of a sentence, of a version and of a long list of numbers are no parts of a key."""
    numbers = ", ".join(["1.5"] * 1000)
    text = "One. Two. Three. " * 20 + "..." * 50
    content = f'{dotted(MOST_PARTS)} = 1\nb = [{numbers}]\nc = "{text}"\nd = "1.2.3"\n'
    (tmp_path / "a.toml").write_text(content)
    tree = read_toml(tmp_path / "a.toml", "case")
    assert tree["b"] == [1.5] * 1000
    assert tree["c"] == text
    (tmp_path / "a.toml").write_bytes(b"#" * (MAX_TOML_BYTES + 1))
    with pytest.raises(InputError, match=r"case 'a\.toml': has 5000001 bytes\.\n  At most 5000000 bytes are accepted"):
        read_toml(tmp_path / "a.toml", "case")


def test_file_without_a_key_is_searched_in_linear_time(tmp_path: Path) -> None:
    """The search for long keys must not be slow itself."""
    for content in ("a" * 4_000_000, '"' * 4_000_000, "a. " * 1_000_000, "a\n" * 1_000_000):
        (tmp_path / "a.toml").write_text(content)
        start = time.process_time()
        with pytest.raises(InputError):
            read_toml(tmp_path / "a.toml", "case")
        assert time.process_time() - start < 5.0


@pytest.mark.parametrize("content", ["a = " + "9" * 5000, "a = " + "[" * 5000, "a = " + "{b=" * 5000])
def test_long_number_and_deep_nesting_are_refused(content: str, tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text(content)
    with pytest.raises(InputError, match="a number that is too long, or tables nested too deeply"):
        read_toml(tmp_path / "a.toml", "case")


@pytest.mark.parametrize(
    ("line", "found", "hint"),
    [
        ("mass_kg_m = 1,07", "'mass_kg_m = 1,07'", "Write a decimal point: 1.07 in place of 1,07 ."),
        ("spans = [{ length_m = -60,5 }]", "'spans = [{ length_m = -60,5 }]'", "-60.5 in place of -60,5 ."),
        ("tension_N = 21 kN  # each", "'tension_N = 21 kN  # each'", "Write 21 without 'kN': the end of the key"),
        ("area_mm2 = 1.2e2mm²", "'area_mm2 = 1.2e2mm²'", "Write 1.2e2 without 'mm²'"),
        ("x_m = [5.0 m, 15.0 m]", "'x_m = [5.0 m, 15.0 m]'", "Write 5.0 without 'm'"),
        ("title = My line", "'title = My line'", "Correct this line"),
        ("title = \x1b]m", r"'title = \x1b]m'", "Correct this line"),
        ("x_m = [5,15 m]", "'x_m = [5,15 m]'", "Write 15 without 'm'"),
        ("a" * 200 + " 1", f"'{'a' * 80}...'", "Correct this line"),
        ("x_m = [1.0", "(at end of document)", "Complete the end of the file"),
    ],
)
def test_line_with_a_syntax_error_is_quoted(line: str, found: str, hint: str, tmp_path: Path) -> None:
    (tmp_path / "a.toml").write_text(f"x = 1\n{line}")
    with pytest.raises(InputError) as caught:
        read_toml(tmp_path / "a.toml", "line")
    assert f"{found}.\n" in str(caught.value)
    assert hint in str(caught.value)
