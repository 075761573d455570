"""Case files from outside: the 250 km/h case of the library under another id, on the line of the library."""

from pathlib import Path

from pantocheck.conformance.line.library_folder import library_folder


def outside_case(name: str, speed_km_h: float = 250.0) -> str:
    """Text of a case file with an id and a speed; line, pantograph and limits are those of the library case."""
    text = (library_folder() / "en50318-2002" / "250.toml").read_text("utf-8")
    for before, after in {
        '"en50318-2002/250"': f'"{name}"',
        '"line.toml"': '"en50318-2002/line.toml"',
        '"pantograph.toml"': '"en50318-2002/pantograph.toml"',
        "speed_km_h = 250.0": f"speed_km_h = {speed_km_h}",
    }.items():
        assert before in text
        text = text.replace(before, after)
    return text


def write_case(path: Path, name: str, speed_km_h: float = 250.0) -> Path:
    """Write a case file, as `outside_case`; returns its path."""
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(outside_case(name, speed_km_h), encoding="utf-8")
    return path
