"""Page templates: Jinja2 for HTML and Markdown, Typst for PDF."""
