"""Reference of the public interface, from its docstrings."""

from importlib import import_module

MODULES = ("pantocheck.conformance", "pantocheck.model")


def build_interface_page() -> str:
    """Page with every public class and function."""
    parts = ["# Python reference"]
    for name in MODULES:
        module = import_module(name)
        parts += [f"## {name}", (module.__doc__ or "").split("\n")[0]]
        parts += [_document(name, public, getattr(module, public)) for public in module.__all__]
    return "\n\n".join(parts) + "\n"


def _document(module: str, name: str, content: object) -> str:
    """Directive that shows the docstring of a public name."""
    home = f"{getattr(content, '__module__', module)}.{name}"
    directive = "autoclass" if isinstance(content, type) else "autofunction"
    members = "\n   :members:" if isinstance(content, type) else ""
    if not callable(content):
        return f"`{name}`"
    return f"### {name}\n\n```{{eval-rst}}\n.. {directive}:: {home}{members}\n```"
